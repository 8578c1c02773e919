/* Any projection, any geotransform, any type, any voids, any option: what farfield-bake makes and
 * farfield-export gives back lies where PROJ says, and is as high.
 *
 * DRAWS rasters (default 48) of seed SEED (1), from number FIRST (0) on; `make properties`. The
 * worst of each kind is printed, and written to PROPERTIES when set. BIN: the programs. */
#include "property_judge.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* after the four above: */
#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define LEVELS_MAX    40
#define REFUSALS_MAX  10
#define REFUSED_SHARE 0.1 /* a run that refuses more shows nothing */

/* The worst of one kind. */
typedef struct worst {
    uint32_t draws;
    double shift, scale, rotation, gain, bias_m, rms_m, error_m,
        share; /* share: of the error allowed */
} worst;

static worst table[PROPERTY_FACTORS][LEVELS_MAX], all, lossy, drifting;
static uint32_t refused[REFUSALS_MAX];
static uint8_t seen[PROPERTY_FACTORS][LEVELS_MAX][PROPERTY_FACTORS][LEVELS_MAX];

static uint32_t number_of(const char *variable, uint32_t otherwise)
{
    const char *text = getenv(variable);
    return text && *text ? (uint32_t)strtoul(text, NULL, 10) : otherwise;
}

static void widen(worst *w, const property_run *run)
{
    const property_fit *f = &run->fit;
    w->draws++;
    w->shift = fmax(w->shift, f->shift);
    w->scale = fmax(w->scale, f->scale);
    w->rotation = fmax(w->rotation, f->rotation);
    w->gain = fmax(w->gain, f->gain);
    w->bias_m = fmax(w->bias_m, fabs(f->bias_m));
    w->rms_m = fmax(w->rms_m, f->rms_m);
    w->error_m = fmax(w->error_m, f->error_m);
    w->share = fmax(w->share, f->error_m / run->allowed_m);
}

/* Whether a draw's heights are fine enough that places are told well; files that have no such ones
 * count as they are. Whole metres are rows of their own, by type. */
static int is_told_well(const property_draw *d)
{
    int file = d->level[PROPERTY_FILE];
    return !property_is_whole(d) || file == FILE_PNG || file == FILE_RAW || file == FILE_HGT;
}

/* Counts a draw to all its kinds; one whose error was asked for, or whose kept cells were rounded,
 * to those alone. */
static void count(const property_draw *d, const property_run *run)
{
    int is_drifting = run->drift > 1e-6, is_plain = !is_drifting && d->max_error_m <= 0;
    widen(is_drifting ? &drifting : d->max_error_m > 0 ? &lossy : &all, run);
    for (int a = 0; a < PROPERTY_FACTORS; a++) {
        if (is_plain && (a == PROPERTY_TYPE || is_told_well(d))) widen(&table[a][d->level[a]], run);
        for (int b = 0; b < PROPERTY_FACTORS; b++) seen[a][d->level[a]][b][d->level[b]] = 1;
    }
}

static void print_row(FILE *out, const char *kind, const char *level, const worst *w)
{
    if (w->draws)
        fprintf(out, "| %s | %s | %u | %.4f | %.1f | %.1f | %.1f | %.3f | %.3f | %.3f | %.2f |\n",
                kind, level, w->draws, w->shift, w->scale * 1e6, w->rotation * 1e6, w->gain * 1e6,
                w->bias_m, w->rms_m, w->error_m, w->share);
}

/* How many pairs of levels of two factors came up. */
static void count_pairs(uint32_t *met, uint32_t *pairs)
{
    for (int a = 0; a < PROPERTY_FACTORS; a++)
        for (int b = a + 1; b < PROPERTY_FACTORS; b++)
            for (int i = 0; property_level_name(a, i); i++)
                for (int j = 0; property_level_name(b, j); j++) {
                    ++*pairs;
                    *met += seen[a][i][b][j];
                }
}

static void print_table(FILE *out)
{
    uint32_t met = 0, pairs = 0;
    fputs(
        "| kind | level | draws | shift, samples | scale, 1e-6 | rotation, 1e-6 | height, 1e-6 | bias m | rms m | largest m | of allowed |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|\n",
        out);
    for (int f = 0; f < PROPERTY_FACTORS; f++)
        for (int l = 0; property_level_name(f, l); l++)
            print_row(out, property_factor_name(f), property_level_name(f, l), &table[f][l]);
    print_row(out, "all", "", &all);
    print_row(out, "--max-error", "", &lossy);
    print_row(out, "kept cells rounded", "", &drifting);
    for (int k = 0; property_refusal(k); k++)
        if (refused[k]) fprintf(out, "\nrefused: %u, %s\n", refused[k], property_refusal(k));
    count_pairs(&met, &pairs);
    fprintf(out, "\n%u of %u pairs of levels met\n", met, pairs);
}

static void tell_failure(const property_draw *d, const property_run *run)
{
    print_message("# draw %u: %s\n", d->number, run->wrong);
    for (int f = 0; f < PROPERTY_FACTORS; f++)
        print_message("#   %s: %s\n", property_factor_name(f), property_level_name(f, d->level[f]));
    print_message("#   again: make properties N=1 SEED=%u FIRST=%u\n#   %s\n", d->seed, d->number,
                  run->command);
    for (const char *line = run->said; *line;
         line = strchr(line, '\n') ? strchr(line, '\n') + 1 : "")
        print_message("#   %.*s\n", (int)strcspn(line, "\n"), line);
}

/* 1 when the draw fails. */
static int try_draw(uint32_t seed, uint32_t number, const char *folder)
{
    property_draw d;
    property_run run = { .programs = getenv("BIN") ? getenv("BIN") : "build/bin",
                         .folder = folder };
    if (property_draw_make(&d, seed, number)) {
        print_message("# draw %u: PROJ does not know %s\n", number, d.place->name);
        return 1;
    }
    property_judge(&d, &run);
    if (*run.wrong) {
        tell_failure(&d, &run);
        return 1;
    }
    for (int k = 0; run.refusal && property_refusal(k); k++)
        refused[k] += !strcmp(run.refusal, property_refusal(k));
    if (!run.refusal) count(&d, &run);
    return 0;
}

static void what_is_baked_lies_where_proj_says_and_is_as_high(void **state)
{
    uint32_t draws = number_of("DRAWS", 48), seed = number_of("SEED", 1),
             first = number_of("FIRST", 0);
    uint32_t failed = 0, refusals = 0;
    const char *out = getenv("PROPERTIES"), *folder = out && *out ? out : "build/tests/properties";
    char path[600];
    (void)state;
    mkdir(folder, 0777);
    for (uint32_t n = 0; n < draws; n++) failed += (uint32_t)try_draw(seed, first + n, folder);
    for (int k = 0; k < REFUSALS_MAX; k++) refusals += refused[k];
    snprintf(path, sizeof path, "%s/table.md", folder);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    print_table(file);
    fclose(file);
    print_message("# %u draws of seed %u: %u failed, %u refused; worst shift %.4f samples, scale "
                  "%.1fe-6, rotation %.1fe-6; table: %s\n",
                  draws, seed, failed, refusals, all.shift, all.scale * 1e6, all.rotation * 1e6,
                  path);
    assert_int_equal(failed, 0);
    assert_true(refusals <= REFUSED_SHARE * draws + 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_baked_lies_where_proj_says_and_is_as_high),
    };
    GDALAllRegister();
    CPLSetErrorHandler(CPLQuietErrorHandler);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
