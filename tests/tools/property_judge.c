#include "property_judge.h"

#include "property_told.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SHIFT_MAX 0.05 /* samples */
#define SCALE_MAX 1e-5
#define DRIFT_MAX                                                                  \
    0.25 /* samples, from end to end: kept samples may be so far off, and are told \
          */
#define SIGMAS      8
#define FILTER_SUM  1.6 /* of a cubic's weights, without their signs */
#define ASKED_PART  0.1 /* of --max-error that goes along with the ground's waves */
#define LEAN_PART   0.2 /* of it by which heights lean towards what is expected: waves are lower */
#define WU_M        (1.0 / 256)
#define FLOAT_PART  1.2e-7 /* metres pass through single precision */
#define CUBIC       0.02   /* the part of a wave of 1 radian a sample that a cubic misses */
#define APPROX_PX   3e-4   /* GDAL's approximate transformer */
#define ORIGIN_M    0.001  /* a pack tells its origin in millimetres, both ways */
#define CELLS_SHARP 1.99   /* of the source in a sample: with more they are averaged */
#define TIMEOUT_S   "120"

/* What may be refused, with a piece of the one line that says so. */
static const struct {
    const char *kind, *line;
} refusals[] = {
    { "spacing too coarse or too fine for the raster", "is too coarse for this raster" },
    { "more samples than asked for by projection", "times as large" },
    { "turned cells with --no-project", "cells are turned or no squares" },
    { "a field out of its range", "do not make a terrain" },
    { "heights do not fit", "span more than 65536 steps" },
    { "no shift known between two datums", "PROJ knows no shift from" },
};

const char *property_refusal(int kind)
{
    return kind < (int)(sizeof refusals / sizeof *refusals) ? refusals[kind].kind : NULL;
}

__attribute__((format(printf, 2, 3))) static int wrong(property_run *run, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    if (!*run->wrong) vsnprintf(run->wrong, sizeof run->wrong, format, list);
    va_end(list);
    return -1;
}

/* ---- the programs ---- */

__attribute__((format(printf, 2, 3))) static void add(property_run *run, const char *format, ...)
{
    size_t used = strlen(run->command);
    va_list list;
    va_start(list, format);
    vsnprintf(run->command + used, sizeof run->command - used, format, list);
    va_end(list);
}

static void name(const property_draw *d, const property_run *run, const char *ending, char *path,
                 size_t size)
{
    snprintf(path, size, "%s/draw-%u.%s", run->folder, d->number, ending);
}

static void command_line(const property_draw *d, property_run *run, const char *source)
{
    static const char *const codecs[] = { "raw", "deflate", "rice", "trained" };
    *run->command = 0;
    add(run, "timeout " TIMEOUT_S " %s/farfield-bake %s -o %s/draw-%u.ffp --json", run->programs,
        source, run->folder, d->number);
    if (d->level[PROPERTY_FILE] == FILE_RAW) add(run, " --raw %dx%d", d->columns, d->rows);
    if (d->level[PROPERTY_VOIDS] == VOIDS_OPTION) add(run, " --nodata %.17g", d->nodata);
    if (d->spacing_m > 0) add(run, " --spacing %.9g", d->spacing_m);
    if (d->level[PROPERTY_FILE] == FILE_RAW) add(run, " --scale 1");
    if (d->max_error_m > 0) add(run, " --max-error %.6g", d->max_error_m);
    if (d->epsg) add(run, " --t-srs EPSG:%d", d->epsg);
    if (d->densify > 1) add(run, " --densify %d", d->densify);
    if (d->node_log2) add(run, " --node-log2 %d --tile-log2 %d", d->node_log2, d->tile_log2);
    if (property_has(d, OPTION_CODEC)) add(run, " --codec %s", codecs[d->codec]);
    if (d->jobs) add(run, " --jobs %d", d->jobs);
    if (property_has(d, OPTION_NO_PROJECT)) add(run, " --no-project");
    if (property_has(d, OPTION_VOID_HEIGHT)) add(run, " --void-height %.9g", d->void_m);
    if (property_has(d, OPTION_RIM_HEIGHT)) add(run, " --rim-void-height %.9g", d->void_m);
}

static void read_text(const char *path, char *text, size_t size)
{
    FILE *file = fopen(path, "r");
    size_t got = file ? fread(text, 1, size - 1, file) : 0;
    text[got] = 0;
    if (file) fclose(file);
}

static int count_lines(const char *text)
{
    int lines = 0;
    for (; *text; text++) lines += *text == '\n';
    return lines;
}

/* A refusal: of a kind that is told, in one line. */
static void take_refusal(property_run *run, int status)
{
    for (size_t k = 0; k < sizeof refusals / sizeof *refusals; k++)
        if (strstr(run->said, refusals[k].line)) run->refusal = refusals[k].kind;
    if (status >> 8 != 1 || !run->refusal || count_lines(run->said) > 3)
        wrong(run, "bake ended with status %d", status >> 8);
}

/* Bakes and exports. `json` gets the summary. */
static int run_programs(const property_draw *d, property_run *run, const char *source, char *json,
                        size_t size)
{
    char command[4000], json_path[600], said_path[600];
    name(d, run, "json", json_path, sizeof json_path);
    name(d, run, "err", said_path, sizeof said_path);
    command_line(d, run, source);
    snprintf(command, sizeof command, "%s >%s 2>%s", run->command, json_path, said_path);
    int status = system(command);
    read_text(json_path, json, size);
    read_text(said_path, run->said, sizeof run->said);
    unlink(json_path);
    unlink(said_path);
    if (status) {
        take_refusal(run, status);
        return -1;
    }
    snprintf(command, sizeof command,
             "timeout " TIMEOUT_S
             " %s/farfield-export %s/draw-%u.ffp -o %s/draw-%u.out.tif --quiet",
             run->programs, run->folder, d->number, run->folder, d->number);
    return system(command) ? wrong(run, "export failed") : 0;
}

static double field(const char *json, const char *key)
{
    char text[60];
    snprintf(text, sizeof text, "\"%s\": ", key);
    const char *at = strstr(json, text);
    if (!at) return NAN;
    at += strlen(text);
    return *at == 't' ? 1 : *at == 'f' ? 0 : strtod(at, NULL);
}

/* ---- what came out ---- */

typedef struct ground {
    uint32_t columns, rows; /* of densified ground the samples that were measured */
    double gt[6];
    OGRSpatialReferenceH srs; /* NULL: a plane without one */
    property_told told;       /* of a shift between datums */
    double *height, *wanted;
    double *u, *v;    /* samples of the source, 0 in the middle of the first */
    double ratio;     /* samples of the source in one, along the longer way */
    double copies;    /* samples made of one of the source, where the source is coarser */
    int is_sharp;     /* the filter sees four samples along each axis, no more */
    int is_unrounded; /* what rounding did to `height` was taken out */
} ground;

/* The system that the pack's plane is in: as the export says; what a note says; the source's. */
static OGRSpatialReferenceH find_reference(const property_draw *d, const property_run *run,
                                           GDALDatasetH set)
{
    OGRSpatialReferenceH own = GDALGetSpatialRef(set);
    if (!d->place->srs) return NULL; /* an engineering system that a driver made up says nothing */
    if (own) {
        own = OSRClone(own);
        OSRSetAxisMappingStrategy(own, OAMS_TRADITIONAL_GIS_ORDER);
        return own;
    }
    OGRSpatialReferenceH srs = property_reference(d->place->srs);
    int is_local = srs && (OSRIsGeographic(srs) || strstr(run->said, "local transverse Mercator"));
    if (!is_local) return srs;
    OGRSpatialReferenceH degrees = property_degrees(d);
    double x = d->gt[0] + d->gt[1] * d->columns / 2 + d->gt[2] * d->rows / 2;
    double y = d->gt[3] + d->gt[4] * d->columns / 2 + d->gt[5] * d->rows / 2;
    OGRCoordinateTransformationH to = property_transformation(d, srs, degrees);
    OCTTransform(to, 1, &x, &y, NULL);
    OCTDestroyCoordinateTransformation(to);
    OSRDestroySpatialReference(srs);
    OSRDestroySpatialReference(degrees);
    char text[200];
    snprintf(text, sizeof text, "+proj=tmerc +lat_0=%.15g +lon_0=%.15g +k=1 +R=%.9g +units=m", y, x,
             d->place->radius_m);
    return property_reference(text);
}

static int read_export(const property_draw *d, property_run *run, ground *g)
{
    char path[600];
    name(d, run, "out.tif", path, sizeof path);
    GDALDatasetH set = GDALOpen(path, GA_ReadOnly);
    if (!set) return wrong(run, "the export cannot be read");
    int step = d->densify, width = GDALGetRasterXSize(set), height = GDALGetRasterYSize(set);
    GDALRasterBandH band = GDALGetRasterBand(set, 1);
    double scale = GDALGetRasterScale(band, NULL), offset = GDALGetRasterOffset(band, NULL);
    g->columns = (uint32_t)((width - 1) / step + 1);
    g->rows = (uint32_t)((height - 1) / step + 1);
    size_t count = (size_t)g->columns * g->rows;
    double *row = malloc((size_t)width * sizeof *row);
    g->height = malloc(count * sizeof *g->height);
    int rc = row && g->height && GDALGetGeoTransform(set, g->gt) == CE_None ? 0 : -1;
    for (uint32_t j = 0; !rc && j < g->rows; j++) {
        rc = GDALRasterIO(band, GF_Read, 0, (int)j * step, width, 1, row, width, 1, GDT_Float64, 0,
                          0) != CE_None;
        for (uint32_t i = 0; i < g->columns; i++)
            g->height[(size_t)j * g->columns + i] = row[i * (uint32_t)step] * scale + offset;
    }
    free(row);
    if (!rc) g->srs = find_reference(d, run, set);
    GDALClose(set);
    return rc ? wrong(run, "the export cannot be read") : 0;
}

/* Where all samples lie, in the plane of the pack. */
static void places_of(const property_draw *d, const ground *g, double *x, double *y)
{
    for (uint32_t j = 0; j < g->rows; j++)
        for (uint32_t i = 0; i < g->columns; i++) {
            double u = (double)i * d->densify + 0.5, v = (double)j * d->densify + 0.5;
            x[(size_t)j * g->columns + i] = g->gt[0] + g->gt[1] * u;
            y[(size_t)j * g->columns + i] = g->gt[3] + g->gt[5] * v;
        }
}

/* Degrees beyond 180 in a raster that goes on there. */
static double whole_circle(OGRSpatialReferenceH srs)
{
    return srs && OSRIsGeographic(srs) ? 6.283185307179586 / OSRGetAngularUnits(srs, NULL) : 0;
}

/* Takes places of the pack's plane to the source's: the way that was told, or PROJ's best. */
static int to_source(const property_draw *d, const ground *g, OGRSpatialReferenceH srs, double *x,
                     double *y)
{
    int count = (int)(g->columns * g->rows);
    if (!g->srs) return 0;
    if (g->told.to_source) return OCTTransform(g->told.to_source, count, x, y, NULL) ? 0 : -1;
    OGRCoordinateTransformationH to = property_transformation(d, g->srs, srs);
    int ok = to && OCTTransform(to, count, x, y, NULL);
    if (to) OCTDestroyCoordinateTransformation(to);
    return ok ? 0 : -1;
}

static int find_sources(const property_draw *d, ground *g, OGRSpatialReferenceH srs)
{
    double inverse[6];
    size_t count = (size_t)g->columns * g->rows;
    int ok = !to_source(d, g, srs, g->u, g->v);
    double circle = whole_circle(srs),
           middle = d->gt[0] + d->gt[1] * d->columns / 2 + d->gt[2] * d->rows / 2;
    if (!ok || !GDALInvGeoTransform((double *)d->gt, inverse)) return -1;
    for (size_t n = 0; n < count; n++) {
        double x = g->u[n], y = g->v[n];
        if (circle > 0) x += circle * nearbyint((middle - x) / circle);
        g->u[n] = inverse[0] + inverse[1] * x + inverse[2] * y - 0.5;
        g->v[n] = inverse[3] + inverse[4] * x + inverse[5] * y - 0.5;
    }
    size_t n = (size_t)(g->rows / 2) * g->columns + g->columns / 2;
    double ux = fabs(g->u[n + 1] - g->u[n]), vx = fabs(g->v[n + 1] - g->v[n]);
    double uy = fabs(g->u[n + g->columns] - g->u[n]), vy = fabs(g->v[n + g->columns] - g->v[n]);
    g->ratio = fmax(fmax(ux + uy, vx + vy), 1);
    g->is_sharp = fmax(hypot(ux, uy), hypot(vx, vy)) < CELLS_SHARP;
    g->copies = fmax(1, 1 / hypot(ux, uy)) * fmax(1, 1 / hypot(vx, vy));
    return 0;
}

/* A shift that was told is one of PROJ's for the place, and no further than told from the best. */
static int judge_shift(const property_draw *d, property_run *run, const char *json, ground *g)
{
    if (!g->srs) return 0;
    double cell_m = fabs(g->gt[1]) * d->densify;
    if (property_told_read(d, json, run->said, g->srs, cell_m, &g->told))
        return wrong(run, "a shift between datums that is not PROJ's, or not told");
    if (!g->told.to_source) return 0;
    double x = g->gt[0] + g->gt[1] * g->columns * d->densify / 2,
           y = g->gt[3] + g->gt[5] * g->rows * d->densify / 2,
           off = property_told_offset(d, &g->told, g->srs, x, y);
    return off <= g->told.accuracy_m
               ? 0
               : wrong(run, "shifted by %g m, told %g", off, g->told.accuracy_m);
}

static int look_up(const property_draw *d, property_run *run, ground *g)
{
    size_t count = (size_t)g->columns * g->rows;
    double *x = malloc(count * sizeof *x), *y = malloc(count * sizeof *y);
    g->wanted = malloc(count * sizeof *g->wanted);
    g->u = malloc(count * sizeof *g->u);
    g->v = malloc(count * sizeof *g->v);
    int rc = x && y && g->wanted && g->u && g->v ? 0 : -1;
    if (!rc) places_of(d, g, x, y);
    if (!rc) places_of(d, g, g->u, g->v);
    /* a shift that was told is judged by itself: the surface is asked where the source lies */
    OGRSpatialReferenceH srs = property_reference(d->place->srs);
    if (!rc && g->told.to_source) rc = to_source(d, g, srs, x, y);
    if (!rc)
        rc = property_heights(d, g->told.to_source ? srs : g->srs, (int)count, x, y, g->wanted);
    if (!rc) rc = find_sources(d, g, srs);
    if (srs) OSRDestroySpatialReference(srs);
    free(x);
    free(y);
    return rc ? wrong(run, "the pack lies where PROJ shows nothing") : 0;
}

static void free_ground(ground *g)
{
    free(g->height);
    free(g->wanted);
    free(g->u);
    free(g->v);
    if (g->srs) OSRDestroySpatialReference(g->srs);
    property_told_free(&g->told);
}

/* ---- the judgement ---- */

/* What all source samples within `reach` of (u, v) are: a mark that they share, or -1; beyond the
 * rim nothing is known. */
static int mark_round(const property_draw *d, const property_raster *r, double u, double v,
                      int reach)
{
    int i0 = (int)floor(u) - reach, j0 = (int)floor(v) - reach;
    if (i0 < 0 || j0 < 0 || i0 + 2 * reach + 1 >= d->columns || j0 + 2 * reach + 1 >= d->rows)
        return -1;
    int first = r->mark[j0 * d->columns + i0];
    for (int j = j0; j <= j0 + 2 * reach + 1 && (r->holes || r->rims); j++)
        for (int i = i0; i <= i0 + 2 * reach + 1; i++)
            if (r->mark[j * d->columns + i] != first) return -1;
    return first;
}

/* What a void of this mark was given, or NaN: filled from around. */
static double given_m(const property_draw *d, int mark)
{
    int given = property_has(d, OPTION_VOID_HEIGHT) ||
                (mark == MARK_RIM && property_has(d, OPTION_RIM_HEIGHT));
    return given ? d->void_m : NAN;
}

/* Resampled heights are kept between the source's lowest and highest, void heights among them. */
static double in_range(const property_draw *d, const property_raster *r, double wanted)
{
    int has_given = (property_has(d, OPTION_VOID_HEIGHT) && r->holes + r->rims) ||
                    (property_has(d, OPTION_RIM_HEIGHT) && r->rims);
    double highest = has_given ? fmax(r->highest_m, d->void_m) : r->highest_m;
    return fmin(fmax(wanted, r->lowest_m), highest);
}

/* Leaves what is to be judged in `wanted`; looks at the middles of voids. */
static int sort_out(const property_draw *d, property_run *run, const property_raster *r, ground *g,
                    int is_kept)
{
    int reach = 3 + (int)ceil(2 * g->ratio);
    for (size_t n = 0; n < (size_t)g->columns * g->rows; n++) {
        int mark = mark_round(d, r, g->u[n], g->v[n], reach);
        if (mark == MARK_GROUND && !is_kept) g->wanted[n] = in_range(d, r, g->wanted[n]);
        if (mark == MARK_GROUND) continue;
        g->wanted[n] = NAN;
        if (mark < 0) continue;
        double given = given_m(d, mark), h = g->height[n];
        if (!isnan(given) && fabs(h - given) > run->allowed_m)
            return wrong(run, "a void was given %g m and is %g m", given, h);
        if (isnan(given) && (h < fmin(r->lowest_m, d->void_m) - run->allowed_m ||
                             h > fmax(r->highest_m, d->void_m) + run->allowed_m))
            return wrong(run, "a filled void is %g m, its surroundings %g to %g", h, r->lowest_m,
                         r->highest_m);
    }
    return 0;
}

/* Whole heights that are resampled are rounded to whole steps once more, and that is no chance:
 * where the filter moves a height by less than half a step, it stays as it was. Takes out what
 * rounding does to the samples that the filter makes of the file's, so that what is left is held to
 * the bounds of all others. Returns whether it could. */
static int take_rounding_out(const property_draw *d, const property_raster *r, ground *g,
                             double hscale, double hoffset)
{
    if (!property_is_whole(d) || !g->is_sharp) return 0;
    for (size_t n = 0; n < (size_t)g->columns * g->rows; n++) {
        if (isnan(g->wanted[n])) continue;
        double exact = property_raster_between(d, r, g->u[n], g->v[n]);
        g->height[n] -= nearbyint((exact - hoffset) / hscale) * hscale + hoffset - exact;
    }
    return 1;
}

/* Samples that are kept are the file's, to a step; all of them are there. */
static int judge_kept(const property_draw *d, property_run *run, const property_raster *r,
                      const ground *g, double hscale)
{
    double worst = 0, top = fmax(fabs(r->lowest_m), fabs(r->highest_m));
    int exact = property_is_whole(d) && !strstr(run->said, "coarser steps are chosen") &&
                !strstr(run->said, "not exact") && d->densify == 1;
    double allowed = d->max_error_m + top * FLOAT_PART +
                     (exact ? WU_M / 2 + 65536 / 33554432.0 : hscale / 2 + WU_M);
    if ((size_t)g->columns * g->rows != (size_t)d->columns * (size_t)d->rows)
        return wrong(run, "%u x %u samples of %d x %d", g->columns, g->rows, d->columns, d->rows);
    for (size_t n = 0; n < (size_t)g->columns * g->rows; n++) {
        int i = (int)nearbyint(g->u[n]), j = (int)nearbyint(g->v[n]);
        if (i < 0 || j < 0 || i >= d->columns || j >= d->rows)
            return wrong(run, "a sample lies outside the source, at %g, %g", g->u[n], g->v[n]);
        double metres = r->metres[j * d->columns + i];
        if (!isnan(metres)) worst = fmax(worst, fabs(g->height[n] - metres));
    }
    if (worst > allowed) return wrong(run, "a kept sample is %g m off, allowed %g", worst, allowed);
    double s = fabs(g->gt[1]) * d->densify, x = hypot(d->gt[1], d->gt[4]),
           y = hypot(d->gt[2], d->gt[5]);
    run->drift = fmax(fabs(x / s - 1), fabs(y / s - 1));
    double most = run->drift * fmax(d->columns, d->rows);
    if (most > DRIFT_MAX * 1.001 && !property_has(d, OPTION_NO_PROJECT))
        return wrong(run, "kept samples drift by %g of one", most);
    return 0;
}

static int judge_voids(const property_draw *d, property_run *run, const property_raster *r,
                       const char *json)
{
    double given = property_has(d, OPTION_VOID_HEIGHT)  ? r->holes + r->rims
                   : property_has(d, OPTION_RIM_HEIGHT) ? r->rims
                                                        : 0;
    double voids = r->holes + r->rims - given;
    if (field(json, "voids") == voids && field(json, "given") == given) return 0;
    return wrong(run, "%g voids and %g given, right is %g and %g", field(json, "voids"),
                 field(json, "given"), voids, given);
}

/* What a draw may differ by, by what files and packs round, what a cubic does not see, and what was
 * asked for. */
typedef struct allowance {
    double sigma_m; /* of a sample, as far as errors are chance */
    double bias_m, rms_m, shift, scale, gain;
} allowance;

static double cubic_m(const property_draw *d, const ground *g, int is_kept)
{
    double wave = property_wave(d) * g->ratio;
    return is_kept ? 0 : d->swing_m * CUBIC * wave * wave * wave;
}

/* How many samples places are off that are told by millimetres, or reckoned about. */
static double place_px(const property_draw *d, const ground *g)
{
    return APPROX_PX + ORIGIN_M / (fabs(g->gt[1]) * d->densify);
}

/* What that does to a height. */
static double place_m(const property_draw *d, const ground *g)
{
    return property_slope(d) * g->ratio * place_px(d, g);
}

/* Of one sample. A cubic filter widens what the file's steps round by up to FILTER_SUM. */
static double sample_m(const property_draw *d, const ground *g, double drift, double hscale,
                       int is_kept)
{
    double step = property_is_whole(d) ? d->scale * d->unit_m : 0, slope = property_slope(d);
    double drift_m = drift * fmax(d->columns, d->rows) * slope;
    double top = fabs(d->middle_m) + d->swing_m;
    return d->max_error_m + step / 2 * (is_kept ? 1 : FILTER_SUM) + hscale / 2 + WU_M +
           cubic_m(d, g, is_kept) + drift_m + top * FLOAT_PART + place_m(d, g);
}

/* Of the whole fit. Errors that were asked for, and those of averaged ground that is rounded to the
 * source's steps once more, go along with the ground's waves: SIGMAS of chance are not all that
 * they do, and drift lets waves out of step. */
static allowance allow(const property_draw *d, const ground *g, const property_fit *f, double drift,
                       double hscale, int is_kept)
{
    double step = property_is_whole(d) ? d->scale * d->unit_m : 0, cubic = cubic_m(d, g, is_kept);
    double asked = d->max_error_m, root = sqrt(f->samples);
    if (g->is_unrounded) hscale = 0;
    double rounded = (step * step * g->copies + hscale * hscale) / 12;
    allowance a = { .sigma_m = sqrt(rounded + asked * asked + cubic * cubic / 9) };
    double drift_m = drift * fmax(d->columns, d->rows) * property_slope(d);
    double along = asked + (is_kept ? 0 : hscale / 2);
    double chance = SIGMAS * a.sigma_m + along * ASKED_PART * root;
    a.bias_m = asked + WU_M + cubic + drift_m / 10 + SIGMAS * a.sigma_m / root +
               f->tilt_m * place_px(d, g);
    a.rms_m = a.sigma_m + WU_M + cubic + drift_m + place_m(d, g);
    a.shift = SHIFT_MAX + chance * f->shift_sd;
    a.scale = SCALE_MAX + drift + chance * f->scale_sd;
    a.gain = SCALE_MAX + (chance + (cubic + asked * LEAN_PART) * root) * f->gain_sd;
    return a;
}

/* Fits the ground, without what rounding did to it; the largest error is that of the samples as
 * they came. */
static int fit_ground(const property_draw *d, property_run *run, const property_raster *r,
                      ground *g, double hscale, double hoffset, int is_kept)
{
    property_fit *f = &run->fit;
    int rc = property_fit_grid(g->height, g->wanted, g->columns, g->rows, f);
    double error_m = f->error_m;
    g->is_unrounded = !rc && !is_kept && take_rounding_out(d, r, g, hscale, hoffset);
    if (g->is_unrounded) rc = property_fit_grid(g->height, g->wanted, g->columns, g->rows, f);
    f->error_m = error_m;
    return !rc ? 0
               : wrong(run, "too few samples to judge: %u of %u x %u", f->samples, g->columns,
                       g->rows);
}

static int judge_fit(const property_draw *d, property_run *run, const ground *g, double hscale,
                     int is_kept)
{
    property_fit *f = &run->fit;
    allowance a = allow(d, g, f, run->drift, hscale, is_kept);
    const struct {
        const char *name;
        double value, most;
    } bounds[] = { { "shift", f->shift, a.shift },
                   { "scale", f->scale, a.scale },
                   { "rotation", f->rotation, a.scale },
                   { "gain", f->gain, a.gain },
                   { "error", f->error_m, run->allowed_m },
                   { "bias", fabs(f->bias_m), a.bias_m },
                   { "rms", f->rms_m, a.rms_m } };
    for (size_t i = 0; i < sizeof bounds / sizeof *bounds; i++)
        if (bounds[i].value > bounds[i].most)
            return wrong(run, "%s %g, allowed %g", bounds[i].name, bounds[i].value, bounds[i].most);
    return 0;
}

/* The pack reaches to all four sides of the raster. */
static int judge_extent(const property_draw *d, property_run *run, const ground *g)
{
    double low_u = INFINITY, high_u = -INFINITY, low_v = INFINITY, high_v = -INFINITY;
    double slack = 2 + 2 * g->ratio;
    for (size_t n = 0; n < (size_t)g->columns * g->rows; n++) {
        low_u = fmin(low_u, g->u[n]);
        high_u = fmax(high_u, g->u[n]);
        low_v = fmin(low_v, g->v[n]);
        high_v = fmax(high_v, g->v[n]);
    }
    if (low_u <= slack && low_v <= slack && high_u >= d->columns - 1 - slack &&
        high_v >= d->rows - 1 - slack)
        return 0;
    return wrong(run, "the pack shows columns %g to %g and rows %g to %g alone", low_u, high_u,
                 low_v, high_v);
}

static void judge(const property_draw *d, property_run *run, const property_raster *r,
                  const char *json)
{
    ground g = { 0 };
    double hscale = field(json, "hscale_m");
    int is_kept = field(json, "resampled") == 0;
    if (judge_voids(d, run, r, json) || read_export(d, run, &g) || judge_shift(d, run, json, &g) ||
        look_up(d, run, &g)) {
        free_ground(&g);
        return;
    }
    run->allowed_m = d->max_error_m + hscale + WU_M; /* in the middle of voids */
    int rc = judge_extent(d, run, &g) ? -1 : sort_out(d, run, r, &g, is_kept);
    if (!rc && is_kept) rc = judge_kept(d, run, r, &g, hscale);
    if (!rc) rc = fit_ground(d, run, r, &g, hscale, field(json, "hoffset_m"), is_kept);
    run->allowed_m = sample_m(d, &g, run->drift, hscale, is_kept);
    if (!rc) judge_fit(d, run, &g, hscale, is_kept);
    free_ground(&g);
}

static void remove_files(const property_draw *d, const property_run *run, const char *source)
{
    static const char *const endings[] = { "tif", "tif.msk",     "tif.aux.xml", "vrt",
                                           "png", "wld",         "png.aux.xml", "asc",
                                           "prj", "asc.aux.xml", "r16",         "nc",
                                           "ffp", "out.tif" };
    char path[600];
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++) {
        name(d, run, endings[i], path, sizeof path);
        unlink(path);
    }
    unlink(source);
}

void property_judge(property_draw *d, property_run *run)
{
    char source[600], json[3000];
    property_raster raster;
    if (property_raster_make(d, &raster))
        wrong(run, "PROJ does not show the place");
    else if (property_raster_write(d, &raster, run->folder, source, sizeof source))
        wrong(run, "GDAL cannot write the raster: %s", CPLGetLastErrorMsg());
    else if (!run_programs(d, run, source, json, sizeof json))
        judge(d, run, &raster, json);
    if (!*run->wrong) remove_files(d, run, source);
    property_raster_free(&raster);
}
