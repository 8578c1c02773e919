/* Far sets measured, and their tables as C. */
#include "train_far.h"

#include "../../platform/sys.h"
#include "../bake/bake_say.h"
#include "train_write.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BYTES_MAX (1 << 20)
#define STEPS     12

static const unsigned quality[STEPS] = { 40, 48, 55, 60, 65, 70, 75, 80, 84, 88, 92, 96 };
static const int jpeg_quality[] = { 25, 40, 60 };

/* Bytes, and squares of what needed texels are off: of luma, and of all channels. */
typedef struct told {
    double bytes, luma, rgb, texels;
} told;

typedef struct compared {
    const train_vista *of;
    told *told;
} compared;

static void add_texel(told *t, const uint8_t *is, const uint8_t *should)
{
    int r = is[0] - should[0], g = is[1] - should[1], b = is[2] - should[2];
    double luma = 0.299 * r + 0.587 * g + 0.114 * b;
    t->luma += luma * luma;
    t->rgb += (r * r + g * g + b * b) / 3.0;
    t->texels++;
}

static void compare(void *context, unsigned column, unsigned row, uint8_t rgb[64][3])
{
    const compared *c = context;
    for (unsigned i = 0; i < 64; i++) {
        size_t at = (size_t)(row * 8 + i / 8) * c->of->paint.columns * 8 + column * 8 + i % 8;
        if (c->of->needed[at]) add_texel(c->told, rgb[i], c->of->paint.rgb + 3 * at);
    }
}

/* Blocks of 16 side by side, as JPEGs were sent before. */
static int add_jpeg(const train_vista *of, int at_quality, told *t)
{
    const ff_paint_source *paint = &of->paint;
    static uint8_t rgb[1 << 24], back[1 << 24], bytes[BYTES_MAX];
    static size_t from[1 << 16];
    unsigned count = 0, columns = (paint->columns + 1) / 2;
    for (unsigned row = 0; row < paint->rows; row += 2)
        for (unsigned c = 0; c < columns; c++) {
            int any = 0;
            for (unsigned i = 0; i < 4; i++) {
                unsigned x = 2 * c + i % 2, y = row + i / 2;
                if (x < paint->columns && y < paint->rows)
                    any |= paint->there[y * paint->columns + x];
            }
            if (any) from[count++] = ((size_t)row << 16) | (2 * c);
        }
    if (!count || count > 4093) return 0;
    for (unsigned pass = 0; pass < 2; pass++) {
        for (unsigned i = 0; i < count * 256; i++) {
            unsigned x = i % 16, y = i / 16 % 16, b = i / 256;
            unsigned px = (unsigned)(from[b] & 65535) * 8 + x,
                     py = (unsigned)(from[b] >> 16) * 8 + y;
            if (py >= paint->rows * 8) py = paint->rows * 8 - 1;
            if (px >= paint->columns * 8) px = paint->columns * 8 - 1;
            size_t at = (size_t)py * paint->columns * 8 + px,
                   to = 3 * ((size_t)y * count * 16 + b * 16 + x);
            if (!pass)
                memcpy(rgb + to, paint->rgb + 3 * at, 3);
            else if (of->needed[at])
                add_texel(t, back + to, paint->rgb + 3 * at);
        }
        if (pass) break;
        int made = sys_jpeg_encode(rgb, count * 16, 16, at_quality, bytes, sizeof bytes);
        if (made < 0 || sys_jpeg_decode(bytes, (size_t)made, count * 16, 16, back) < 0) return -1;
        t->bytes += made;
    }
    return 0;
}

static double at_error(const told *ours, double squares, int luma)
{
    unsigned i = 0;
#define S(i) ((luma ? ours[i].luma : ours[i].rgb) / ours[i].texels)
    while (i + 2 < STEPS && S(i + 1) > squares) i++;
    double part = log(S(i) / squares) / log(S(i) / S(i + 1));
    return exp(log(ours[i].bytes) * (1 - part) + log(ours[i + 1].bytes) * part);
#undef S
}

static int is_of(const ff_paint_source *paint, const char *what)
{
    return (paint->columns <= 16) == (what[0] == '2');
}

static int tell(const train_vistas *vistas, unsigned first, unsigned end, const char *what,
                const train_far_tables *tables)
{
    ff_paint_room *room = malloc(ff_paint_room_bytes(FF_FAR_BLOCKS_MAX));
    uint8_t *out = malloc(BYTES_MAX);
    told ours[STEPS] = { { 0 } };
    if (!room || !out) return bake_fail("out of memory");
    for (unsigned i = first; i < end; i++)
        for (unsigned s = 0; s < STEPS; s++) {
            const ff_paint_source *paint = &vistas->vista[i].paint;
            compared c = { &vistas->vista[i], &ours[s] };
            const ff_paint_sink sink = { &c, compare };
            if (!paint->columns || !is_of(paint, what)) continue;
            ours[s].bytes += ff_paint_put(&tables->paint, NULL, paint, quality[s], room, &sink, out,
                                          BYTES_MAX);
        }
    for (unsigned j = 0; j < 3; j++) {
        told jpeg = { 0 };
        for (unsigned i = first; i < end; i++)
            if (vistas->vista[i].paint.columns && is_of(&vistas->vista[i].paint, what) &&
                add_jpeg(&vistas->vista[i], jpeg_quality[j], &jpeg))
                return -1;
        double luma = at_error(ours, jpeg.luma / jpeg.texels, 1),
               rgb = at_error(ours, jpeg.rgb / jpeg.texels, 0);
        printf(
            "%s %s JPEG %d: %.0f bytes, %.2f dB (%.2f); ours %.0f (%+.1f %%), of all channels %.0f (%+.1f %%)\n",
            vistas->vista[first].path, what, jpeg_quality[j], jpeg.bytes,
            10 * log10(65025 / (jpeg.luma / jpeg.texels)),
            10 * log10(65025 / (jpeg.rgb / jpeg.texels)), luma, 100 * (luma / jpeg.bytes - 1), rgb,
            100 * (rgb / jpeg.bytes - 1));
    }
    for (unsigned s = 0; s < STEPS; s++)
        printf("   %u: %.0f bytes, %.2f dB luma, %.2f dB\n", quality[s], ours[s].bytes,
               10 * log10(65025 / (ours[s].luma / ours[s].texels)),
               10 * log10(65025 / (ours[s].rgb / ours[s].texels)));
    free(room);
    free(out);
    return 0;
}

static void tell_fins(const train_vistas *vistas, unsigned first, unsigned end,
                      const train_far_tables *tables)
{
    static uint8_t out[FF_FAR_FINS_BYTES];
    double bytes = 0, vertices = 0;
    for (unsigned i = first; i < end; i++) {
        bytes += ff_fins_put(tables->fins, NULL, vistas->vista[i].vertex, vistas->vista[i].count,
                             out, sizeof out);
        vertices += vistas->vista[i].count;
    }
    printf("%s: fins of %.0f vertices, %.0f bytes, %.2f a vertex\n", vistas->vista[first].path,
           vertices, bytes, bytes / vertices);
}

int train_far_measure(const train_vistas *vistas, const train_far_tables *tables)
{
    unsigned first = 0;
    int rc = 0;
    for (unsigned i = 1; !rc && i <= vistas->count; i++) {
        if (i < vistas->count && vistas->vista[i].path == vistas->vista[first].path) continue;
        rc = tell(vistas, first, i, "240 wide", tables) ||
             tell(vistas, first, i, "640 wide", tables);
        tell_fins(vistas, first, i, tables);
        first = i;
    }
    return rc;
}

static void put_paint(FILE *out, const ff_paint_tables *t)
{
    fputs("#include \"ff_paint_local.h\"\n\n"
          "/* clang-format off */\n"
          "const ff_paint_tables ff_paint_learned = {\n    .numbers = {\n    .weight = {\n",
          out);
    for (unsigned row = 0; row < FF_PICTURE_ROWS; row++) {
        fputs("        {", out);
        train_put_numbers(out, t->numbers.weight[row], FF_PICTURE_KNOWN, 1);
        fputs("},\n", out);
    }
    fputs("    },\n    .one = {\n        ", out);
    train_put_numbers(out, t->numbers.one, FF_PICTURE_CONTEXTS, 0);
    fputs("},\n    },\n    .there = {\n        ", out);
    train_put_numbers(out, t->there, FF_PAINT_THERE, 0);
    fputs("},\n};\n/* clang-format on */\n", out);
}

static void put_fins(FILE *out, const uint16_t one[FF_FINS_CONTEXTS])
{
    fputs("#include \"ff_fins_local.h\"\n\n"
          "/* clang-format off */\n"
          "const uint16_t ff_fins_learned[FF_FINS_CONTEXTS] = {\n        ",
          out);
    train_put_numbers(out, one, FF_FINS_CONTEXTS, 0);
    fputs("};\n/* clang-format on */\n", out);
}

static FILE *begin(const char *folder, const char *name)
{
    char path[FILENAME_MAX];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *out = fopen(path, "w");
    if (!out)
        bake_fail("cannot write %s: %s", path, strerror(errno));
    else
        fputs(
            "/* What farfield-train has learned of far sets: part of the format (SPEC.md, 5.3). */\n",
            out);
    return out;
}

int train_far_write(const char *folder, const train_far_tables *tables)
{
    FILE *paint = begin(folder, "ff_paint_tables.c"),
         *fins = paint ? begin(folder, "ff_fins_table.c") : NULL;
    if (paint) put_paint(paint, &tables->paint);
    if (fins) put_fins(fins, tables->fins);
    int bad = !paint || !fins || ferror(paint) || ferror(fins);
    bad |= paint && fclose(paint);
    bad |= fins && fclose(fins);
    return bad ? bake_fail("cannot write into %s", folder) : 0;
}
