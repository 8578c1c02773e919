/* Pictures measured, and their tables as C. */
#include "train_picture.h"

#include "../../platform/sys.h"
#include "../bake/bake_say.h"
#include "train_picture_local.h"
#include "train_write.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define QUALITIES 5
#define JPEGS     20 /* qualities of JPEGs, 5 apart */
#define RGB       3

static const unsigned quality[QUALITIES] = { 48, 62, 75, 86, 93 };

/* Bytes and mean squares of a level, as JPEGs of each quality. */
typedef struct jpegs {
    double bytes[JPEGS], squares[JPEGS];
} jpegs;

static int add_jpeg(const train_pictures *from, const uint8_t *source, unsigned step, jpegs *sums)
{
    static uint8_t bytes[(4u << 2 * FF_PICTURE_LOG2_MAX) + 8192],
        decoded[RGB << 2 * FF_PICTURE_LOG2_MAX];
    uint32_t side = 1u << from->log2;
    int count = sys_jpeg_encode(source, side, side, (int)(5 * step + 3), bytes, sizeof bytes);
    if (count < 0 || sys_jpeg_decode(bytes, (size_t)count, side, side, decoded) < 0)
        return bake_fail("cannot encode a texture");
    sums->bytes[step] += count;
    for (uint32_t i = 0; i < RGB * side * side; i++) {
        int off = source[i] - decoded[i];
        sums->squares[step] += off * off;
    }
    return 0;
}

static int make_jpegs(const train_pictures *from, unsigned level, jpegs *sums)
{
    size_t count = (size_t)from->tiles << 2 * level, bytes = (size_t)RGB << 2 * from->log2;
    double texels = 0;
    memset(sums, 0, sizeof *sums);
    for (size_t i = 0; i < count; i++) {
        if (!from->has[level][i]) continue;
        texels += (double)bytes;
        for (unsigned step = 0; step < JPEGS; step++)
            if (add_jpeg(from, from->rgb[level] + i * bytes, step, sums)) return -1;
    }
    for (unsigned step = 0; step < JPEGS; step++) sums->squares[step] /= texels;
    return 0;
}

/* Bytes of JPEGs with this error, between two qualities; 0: no quality has it. */
static double bytes_at(const jpegs *sums, double squares)
{
    unsigned step = 0;
    while (step + 1 < JPEGS && sums->squares[step + 1] > squares) step++;
    if (step + 1 == JPEGS || sums->squares[step] < squares) return 0;
    double part = log(sums->squares[step] / squares) /
                  log(sums->squares[step] / sums->squares[step + 1]);
    return exp(log(sums->bytes[step]) * (1 - part) + log(sums->bytes[step + 1]) * part);
}

static double decibels(double squares) { return 10 * log10(255.0 * 255.0 / squares); }

int train_pictures_measure(const train_pictures *from, const ff_picture_tables *tables)
{
    static jpegs jpeg[TRAIN_PICTURE_LEVELS];
    for (unsigned l = 0; l < from->levels; l++)
        if (make_jpegs(from, l, &jpeg[l])) return -1;
    for (unsigned i = 0; i < QUALITIES; i++) {
        train_coded coded;
        double ours = 0, theirs = 0;
        if (train_pictures_code(from, tables, quality[i], &coded)) return -1;
        printf("%s, quality %u: level, bytes, PSNR, JPEG's bytes\n", from->path, quality[i]);
        for (unsigned l = 0; l < from->levels; l++) {
            double bytes = bytes_at(&jpeg[l], coded.squares[l]);
            printf("  %2u %9.0f %6.2f dB %9.0f  %+.1f %%\n", l, coded.bytes[l],
                   decibels(coded.squares[l]), bytes,
                   bytes > 0 ? 100 * (coded.bytes[l] / bytes - 1) : 0);
            if (bytes > 0) ours += coded.bytes[l];
            theirs += bytes;
        }
        printf("  of levels that JPEGs reach: %.0f, %.0f  %+.1f %%\n", ours, theirs,
               100 * (ours / theirs - 1));
    }
    return 0;
}

/* ---- as C ---- */

int train_pictures_write(const char *path, const ff_picture_tables *t)
{
    FILE *out = fopen(path, "w");
    if (!out) return bake_fail("cannot write %s: %s", path, strerror(errno));
    fputs("/* What farfield-train has learned of pictures: part of the format (SPEC.md, 5.2). */\n"
          "#include \"ff_picture_local.h\"\n\n"
          "/* clang-format off */\n"
          "const ff_picture_tables ff_picture_learned = {\n    .weight = {\n",
          out);
    for (unsigned row = 0; row < FF_PICTURE_ROWS; row++) {
        fputs("        {", out);
        train_put_numbers(out, t->weight[row], FF_PICTURE_KNOWN, 1);
        fputs("},\n", out);
    }
    fputs("    },\n    .corner = {", out);
    for (unsigned kind = 0; kind < FF_PICTURE_KINDS; kind++)
        fprintf(out, "%s%u", kind ? "," : "", t->corner[kind]);
    fputs("},\n    .one = {\n        ", out);
    train_put_numbers(out, t->one, FF_PICTURE_CONTEXTS, 0);
    fputs("},\n};\n/* clang-format on */\n", out);
    return fclose(out) ? bake_fail("cannot write %s: %s", path, strerror(errno)) : 0;
}
