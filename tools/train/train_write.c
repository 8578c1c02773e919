#include "train_write.h"

#include "../bake/bake_say.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#define A_LINE 16

void train_put_numbers(FILE *out, const void *at, size_t count, int is_signed)
{
    for (size_t i = 0; i < count; i++) {
        int number = is_signed ? ((const int16_t *)at)[i] : ((const uint16_t *)at)[i];
        fprintf(out, "%s%d", i == 0 ? "" : i % A_LINE ? "," : ",\n         ", number);
    }
}

/* Rows of numbers, in braces. */
static void put_rows(FILE *out, const char *name, const void *at, size_t rows, size_t count,
                     int is_signed)
{
    fprintf(out, "    .%s = {\n", name);
    for (size_t i = 0; i < rows; i++) {
        fprintf(out, "        {");
        train_put_numbers(out, (const char *)at + i * count * sizeof(int16_t), count, is_signed);
        fprintf(out, "},\n");
    }
    fprintf(out, "    },\n");
}

static void put_list(FILE *out, const uint16_t *at, size_t count)
{
    fputs(",\n        {", out);
    train_put_numbers(out, at, count, 0);
    fputs("}", out);
}

static void put_odds(FILE *out, const ff_odds *odds)
{
    fprintf(out, "        {%d", odds->zero);
    put_list(out, odds->below, 4);
    put_list(out, odds->beyond, FF_TRAINED_CLASSES - 1);
    put_list(out, odds->second, FF_TRAINED_CLASSES);
    put_list(out, odds->third, FF_TRAINED_CLASSES * 2);
    fputs("},\n", out);
}

static void put_weights(FILE *out, const ff_weights *w)
{
    fputs("    {\n    .taps = {\n", out);
    for (unsigned kind = 0; kind < FF_POINTS; kind++) {
        fputs("        {\n", out);
        for (unsigned bucket = 0; bucket < FF_TRAINED_BUCKETS; bucket++) {
            fputs("        {{", out);
            train_put_numbers(out, w->taps[kind][bucket].tap, FF_TRAINED_TAPS, 1);
            fprintf(out, "}, %d},\n", (int)w->taps[kind][bucket].sum);
        }
        fputs("        },\n", out);
    }
    fputs("    },\n", out);
    put_rows(out, "trait", w->trait, FF_POINTS, FF_TRAINED_TRAITS, 1);
    fputs("    },\n", out);
}

int train_write(const char *path, const ff_trained *t)
{
    FILE *out = fopen(path, "w");
    if (!out) return bake_fail("cannot write %s: %s", path, strerror(errno));
    fputs("/* What farfield-train has learned: part of the format (SPEC.md, \"Expectation\"). */\n"
          "#include \"ff_trained.h\"\n\n"
          "/* clang-format off */\n"
          "const ff_trained ff_trained_tables = {\n    .weights = {\n",
          out);
    for (unsigned set = 0; set < FF_TRAINED_SETS; set++) put_weights(out, &t->weights[set]);
    fputs("    },\n    .odds = {\n", out);
    for (unsigned scale = 0; scale < FF_TRAINED_SCALES; scale++) put_odds(out, &t->odds[scale]);
    fputs("    },\n};\n/* clang-format on */\n", out);
    return fclose(out) ? bake_fail("cannot write %s: %s", path, strerror(errno)) : 0;
}
