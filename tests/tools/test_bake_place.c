/* Where things are: rasters of a known surface, in many projections and under many geotransforms,
 * are baked, and each pack is fitted to the surface: nothing may be shifted, scaled, turned or
 * blurred. PLACES rounds (default 1) of other numbers; all from one seed. */
#include "../../protocol/shape/ff_shape.h"
#include "../../tools/bake/bake_options.h"
#include "../../tools/bake/bake_run.h"
#include "../../tools/bake/bake_say.h"
#include "../../tools/bake/raster/bake_gdal.h"
#include "../../tools/info/bake_unpack.h"

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
#include <unistd.h>

#define SHIFT_MAX   0.05 /* samples */
#define SCALE_MAX   1e-5
#define BIAS_MAX_M  0.02
#define ERROR_MAX_M 0.15 /* of any sample: half a step and what a cubic misses */
#define RIM         4    /* samples: there the cubic has no neighbours */
#define UNKNOWNS    8

enum { COLUMNS = 120, ROWS = 100 };

/* ---- the surface, in columns and rows of the source raster, whole at the samples ---- */

static double surface(double u, double v)
{
    return 900 + 200 * sin(u / 13 + v / 29) + 150 * cos(v / 11 - u / 37) + u - 2 * v;
}

typedef struct place {
    const char *srs; /* as GDAL reads it */
    double x, y, cell;
    double metre; /* metres in a cell, about */
} place;

static const place places[] = {
    { "EPSG:32632", 500000, 5000000, 30, 30 },  { "EPSG:4326", -70.3, -33.2, 1 / 1200.0, 86 },
    { "EPSG:4269", -105, 62, 1 / 3600.0, 24 },  { "EPSG:3857", 1113194, 8399737, 30, 15 },
    { "EPSG:4087", 1113194, 6679169, 60, 45 },  { "EPSG:2056", 2600000, 1200000, 10, 10 },
    { "EPSG:3035", 4300000, 3000000, 25, 25 },  { "EPSG:2263", 1000000, 200000, 100, 30 },
    { "EPSG:32661", 2000000, 1500000, 90, 90 },
};
enum { PLACES = sizeof places / sizeof *places };

enum kind {
    UPRIGHT,
    ROWS_NORTHWARDS,
    COLUMNS_WESTWARDS,
    EXCHANGED,
    EXCHANGED_BACKWARDS,
    TURNED,
    TURNED_MIRRORED,
    UNLIKE,
    UNLIKE_BY_LITTLE,
    SHEARED,
    FINE,
    SPACED,
    KINDS
};
static const char *const kind_name[KINDS] = {
    "upright",  "rows northwards", "westwards",       "exchanged", "backwards", "turned",
    "mirrored", "cells unlike",    "unlike by 0.4 %", "sheared",   "fine",      "--spacing"
};

static uint32_t seed = 1;
static double chance(double low, double high)
{
    seed = seed * 1664525u + 1013904223u;
    return low + (high - low) * (seed >> 8) / 16777216.0;
}

/* A geotransform of this kind. */
static void make_geotransform(const place *at, enum kind kind, double *gt)
{
    double a = 0, cell = at->cell, shear = 0;
    /* no multiple of 1/256 m where the plane stays */
    if (kind == FINE) cell *= (floor(chance(12, 60)) + chance(0.25, 0.45)) / 256 / at->metre;
    double along = cell, down = -cell;
    /* less of a turn is left, and told: a quarter of a sample from end to end */
    if (kind == TURNED || kind == TURNED_MIRRORED || kind == SHEARED) a = chance(0.01, 6.27);
    if (kind == ROWS_NORTHWARDS || kind == TURNED_MIRRORED) down = -down;
    if (kind == COLUMNS_WESTWARDS) along = -along;
    if (kind == UNLIKE || kind == SHEARED) down *= chance(0.6, 1.5);
    if (kind == UNLIKE_BY_LITTLE) down *= 1.004;
    if (kind == SHEARED) shear = chance(-0.4, 0.4) * at->cell;
    gt[0] = at->x + 7.3 * at->cell;
    gt[3] = at->y - 3.1 * at->cell;
    gt[1] = along * cos(a);
    gt[4] = along * sin(a);
    gt[2] = shear * cos(a) - down * sin(a);
    gt[5] = shear * sin(a) + down * cos(a);
    if (kind != EXCHANGED && kind != EXCHANGED_BACKWARDS) return;
    gt[1] = gt[5] = 0;
    gt[2] = kind == EXCHANGED ? at->cell : -at->cell;
    gt[4] = kind == EXCHANGED ? -at->cell : at->cell;
}

static void write_raster(const char *path, const char *srs_name, const double *gt)
{
    static float heights[ROWS * COLUMNS];
    for (int j = 0; j < ROWS; j++)
        for (int i = 0; i < COLUMNS; i++) heights[j * COLUMNS + i] = (float)surface(i, j);
    GDALDatasetH set = GDALCreate(GDALGetDriverByName("GTiff"), path, COLUMNS, ROWS, 1, GDT_Float32,
                                  NULL);
    assert_non_null(set);
    OGRSpatialReferenceH srs = OSRNewSpatialReference(NULL);
    assert_int_equal(OSRSetFromUserInput(srs, srs_name), OGRERR_NONE);
    GDALSetSpatialRef(set, srs);
    OSRDestroySpatialReference(srs);
    GDALSetGeoTransform(set, (double *)gt);
    assert_int_equal(GDALRasterIO(GDALGetRasterBand(set, 1), GF_Write, 0, 0, COLUMNS, ROWS, heights,
                                  COLUMNS, ROWS, GDT_Float32, 0, 0),
                     CE_None);
    GDALClose(set);
}

/* ---- a pack, read back ---- */

typedef struct ground {
    ff_terrain_info info;
    uint32_t columns, rows;
    double *height, *wanted; /* metres, rows south to north; NaN: not judged */
} ground;

static char pack_path[100];

static void bake(const char *source, double spacing_m)
{
    char spacing[40];
    char *arguments[] = {
        "bake", (char *)source, "-o", pack_path, "--quiet", "--spacing", spacing
    };
    bake_options options;
    snprintf(spacing, sizeof spacing, "%.9g", spacing_m);
    assert_int_equal(bake_options_parse(&options, spacing_m > 0 ? 7 : 5, arguments), 0);
    assert_int_equal(bake_run(&options), 0);
}

static void take_tile(const bake_unpack *unpack, uint32_t tile, uint16_t *steps, ground *g)
{
    uint32_t level = ff_terrain_levels(&g->info) - 1, side = bake_unpack_side(&g->info, level);
    ff_sheet at = ff_shape_sheet(&g->info, tile);
    assert_int_equal(bake_unpack_tile(unpack, tile, level, steps), 0);
    for (uint32_t j = 0; j < side; j++)
        for (uint32_t i = 0; i < side; i++) {
            uint32_t x = at.x * (side - 1) + i, y = at.y * (side - 1) + j;
            if (x < g->columns && y < g->rows)
                g->height[(size_t)y * g->columns + x] = steps[j * side + i] *
                                                            (g->info.hscale_q24 / 16777216.0) +
                                                        g->info.hoffset_wu / 256.0;
        }
}

static ground read_pack(void)
{
    bake_unpack unpack;
    assert_int_equal(bake_unpack_open(&unpack, pack_path), 0);
    ground g = { .info = unpack.pack.header.info };
    ff_sheet samples = ff_shape_sheet_samples(&g.info);
    g.columns = samples.x;
    g.rows = samples.y;
    g.height = test_malloc((size_t)g.columns * g.rows * sizeof *g.height);
    g.wanted = test_malloc((size_t)g.columns * g.rows * sizeof *g.wanted);
    uint32_t side = bake_unpack_side(&g.info, ff_terrain_levels(&g.info) - 1);
    uint16_t *steps = test_malloc((size_t)side * side * sizeof *steps);
    for (uint32_t t = 0; t < ff_shape_tiles(&g.info); t++) take_tile(&unpack, t, steps, &g);
    test_free(steps);
    bake_unpack_close(&unpack);
    return g;
}

static OGRSpatialReferenceH reference(const char *name, int epsg)
{
    OGRSpatialReferenceH srs = OSRNewSpatialReference(NULL);
    if (epsg)
        OSRImportFromEPSG(srs, epsg);
    else
        OSRSetFromUserInput(srs, name);
    OSRSetAxisMappingStrategy(srs, OAMS_TRADITIONAL_GIS_ORDER);
    return srs;
}

/* What the surface says where the pack says that its samples lie. */
static void look_up(ground *g, const char *srs, const double *gt)
{
    double inverse[6];
    OGRSpatialReferenceH here = reference(srs, g->info.epsg), there = reference(srs, 0);
    OGRCoordinateTransformationH to = OCTNewCoordinateTransformation(here, there);
    assert_true(to && GDALInvGeoTransform((double *)gt, inverse));
    for (size_t n = 0; n < (size_t)g->columns * g->rows; n++) {
        double spacing = g->info.spacing_wu / 256.0;
        double x = (double)g->info.origin_x_mm / 1000 + (double)(n % g->columns) * spacing;
        double y = (double)g->info.origin_y_mm / 1000 + (double)(n / g->columns) * spacing;
        assert_true(OCTTransform(to, 1, &x, &y, NULL));
        double u = inverse[0] + inverse[1] * x + inverse[2] * y - 0.5,
               v = inverse[3] + inverse[4] * x + inverse[5] * y - 0.5;
        int known = u > RIM && v > RIM && u < COLUMNS - 1 - RIM && v < ROWS - 1 - RIM;
        g->wanted[n] = known ? surface(u, v) : NAN;
    }
    OCTDestroyCoordinateTransformation(to);
    OSRDestroySpatialReference(here);
    OSRDestroySpatialReference(there);
}

/* ---- the fit ---- */

typedef struct fit {
    double shift, scale, bias_m, error_m;
    uint32_t samples;
} fit;

/* Gauss-Jordan with pivots. */
static void solve(double m[UNKNOWNS][UNKNOWNS + 1])
{
    for (int c = 0; c < UNKNOWNS; c++) {
        int best = c;
        for (int r = c; r < UNKNOWNS; r++)
            if (fabs(m[r][c]) > fabs(m[best][c])) best = r;
        for (int k = 0; k <= UNKNOWNS; k++) {
            double swap = m[c][k];
            m[c][k] = m[best][k];
            m[best][k] = swap;
        }
        assert_true(m[c][c] != 0);
        for (int r = 0; r < UNKNOWNS; r++) {
            double factor = r == c ? 0 : m[r][c] / m[c][c];
            for (int k = c; k <= UNKNOWNS; k++) m[r][k] -= factor * m[c][k];
        }
    }
}

/* One sample's equation: height - wanted = bias + gain * wanted + gradient . (shift + M . place).
 */
static int equation(const ground *g, uint32_t i, uint32_t j, double *row)
{
    const double *w = g->wanted + (size_t)j * g->columns + i;
    double x = i - (g->columns - 1) / 2.0, y = j - (g->rows - 1) / 2.0;
    double gx = (w[1] - w[-1]) / 2, gy = (w[g->columns] - w[-(ptrdiff_t)g->columns]) / 2;
    double all[UNKNOWNS + 1] = { 1,      gx,         gy,
                                 gx * x, gx * y,     gy * x,
                                 gy * y, w[0] - 900, g->height[(size_t)j * g->columns + i] - w[0] };
    memcpy(row, all, sizeof all);
    return !isnan(gx + gy + w[0]);
}

static fit fit_ground(const ground *g)
{
    double m[UNKNOWNS][UNKNOWNS + 1] = { { 0 } }, row[UNKNOWNS + 1];
    fit f = { 0 };
    for (uint32_t j = 1; j + 1 < g->rows; j++)
        for (uint32_t i = 1; i + 1 < g->columns; i++) {
            if (!equation(g, i, j, row)) continue;
            f.samples++;
            f.error_m = fmax(f.error_m, fabs(row[UNKNOWNS]));
            for (int r = 0; r < UNKNOWNS; r++)
                for (int c = 0; c <= UNKNOWNS; c++) m[r][c] += row[r] * row[c];
        }
    assert_true(f.samples > 1000);
    solve(m);
    double found[UNKNOWNS];
    for (int r = 0; r < UNKNOWNS; r++) found[r] = m[r][UNKNOWNS] / m[r][r];
    f.bias_m = fabs(found[0]);
    f.shift = hypot(found[1], found[2]);
    for (int r = 3; r < 7; r++) f.scale = fmax(f.scale, fabs(found[r]));
    return f;
}

/* ---- the tests ---- */

static uint32_t rounds(void)
{
    const char *text = getenv("PLACES");
    return text ? (uint32_t)strtoul(text, NULL, 10) : 1;
}

static void widen(fit *worst, const fit *f)
{
    worst->shift = fmax(worst->shift, f->shift);
    worst->scale = fmax(worst->scale, f->scale);
    worst->bias_m = fmax(worst->bias_m, f->bias_m);
    worst->error_m = fmax(worst->error_m, f->error_m);
    worst->samples += f->samples;
}

static int is_right(const fit *f)
{
    return f->shift <= SHIFT_MAX && f->scale <= SCALE_MAX && f->bias_m <= BIAS_MAX_M &&
           f->error_m <= ERROR_MAX_M;
}

static fit judge(const place *at, const double *gt, double spacing_m)
{
    const char *raster = "/vsimem/place.tif";
    write_raster(raster, at->srs, gt);
    bake(raster, spacing_m);
    ground g = read_pack();
    look_up(&g, at->srs, gt);
    fit f = fit_ground(&g);
    test_free(g.height);
    test_free(g.wanted);
    VSIUnlink(raster);
    return f;
}

static void every_raster_lies_where_it_says(void **state)
{
    int wrong = 0;
    (void)state;
    for (enum kind kind = 0; kind < KINDS; kind++) {
        fit worst = { 0 };
        for (uint32_t n = 0; n < PLACES * rounds(); n++) {
            const place *at = &places[n % PLACES];
            double gt[6];
            make_geotransform(at, kind, gt);
            fit f = judge(at, gt, kind == SPACED ? at->metre * chance(0.8, 1.2) : 0);
            widen(&worst, &f);
            if (is_right(&f)) continue;
            wrong++;
            print_message("# %s, %s: shift %.4f, scale %.2g, bias %.4f m, error %.3f m\n", at->srs,
                          kind_name[kind], f.shift, f.scale, f.bias_m, f.error_m);
        }
        print_message("# %-16s worst: shift %.5f samples, scale %.2g, bias %.4f m, error %.3f m\n",
                      kind_name[kind], worst.shift, worst.scale, worst.bias_m, worst.error_m);
    }
    assert_int_equal(wrong, 0);
}

static int remove_pack(void **state)
{
    (void)state;
    unlink(pack_path);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_raster_lies_where_it_says),
    };
    snprintf(pack_path, sizeof pack_path, "build/tests/test_bake_place.%ld.ffp", (long)getpid());
    bake_say_setup("test_bake_place", 1);
    GDALAllRegister();
    return cmocka_run_group_tests(tests, NULL, remove_pack);
}
