#include "property_surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define RADIAN   57.29577951308232 /* degrees */
#define EARTH_M  6371008.8
#define VOID_MIN 12 /* samples: so that the middle of a void sees nothing else */

/* ---- metres east and north of the draw's middle, along the body's surface, about ---- */

static double radius_m(const property_draw *d)
{
    return d->place->radius_m > 0 ? d->place->radius_m : EARTH_M;
}

/* A place's direction from the middle of a sphere, by axes east, north and up at the draw's middle:
 * smooth everywhere, at the poles and at 180 degrees too. */
static void to_local(const property_draw *d, double longitude, double latitude, double *east,
                     double *north)
{
    double b = latitude / RADIAN, b0 = d->latitude / RADIAN;
    double l = (longitude - d->longitude) / RADIAN;
    *east = radius_m(d) * cos(b) * sin(l);
    *north = radius_m(d) * (sin(b) * cos(b0) - cos(b) * sin(b0) * cos(l));
}

/* Places in the plane of `srs` to metres from the middle. */
static int to_metres(const property_draw *d, OGRSpatialReferenceH srs, int count, double *x,
                     double *y)
{
    OGRSpatialReferenceH degrees = property_degrees(d);
    if (!degrees || !srs) { /* a plane: metres from the middle of the raster */
        double x0 = d->gt[0] + d->gt[1] * d->columns / 2 + d->gt[2] * d->rows / 2;
        double y0 = d->gt[3] + d->gt[4] * d->columns / 2 + d->gt[5] * d->rows / 2;
        for (int i = 0; i < count; i++) x[i] -= x0, y[i] -= y0;
        return 0;
    }
    OGRCoordinateTransformationH to = property_transformation(d, srs, degrees);
    int ok = to && OCTTransform(to, count, x, y, NULL);
    for (int i = 0; ok && i < count; i++) to_local(d, x[i], y[i], &x[i], &y[i]);
    if (to) OCTDestroyCoordinateTransformation(to);
    OSRDestroySpatialReference(degrees);
    return ok ? 0 : -1;
}

/* A cell of the middle: how many metres its sides are on the ground. */
static void measure(const property_draw *d, double *across, double *down)
{
    double i = d->columns / 2, j = d->rows / 2, x[3], y[3];
    for (int n = 0; n < 3; n++) {
        double u = i + (n == 1), v = j + (n == 2);
        x[n] = d->gt[0] + d->gt[1] * u + d->gt[2] * v;
        y[n] = d->gt[3] + d->gt[4] * u + d->gt[5] * v;
    }
    OGRSpatialReferenceH srs = property_reference(d->place->srs);
    *across = *down = 1;
    if (!to_metres(d, srs, 3, x, y)) {
        *across = hypot(x[1] - x[0], y[1] - y[0]);
        *down = hypot(x[2] - x[0], y[2] - y[0]);
    }
    if (srs) OSRDestroySpatialReference(srs);
}

double property_cell_m(const property_draw *d)
{
    double across, down;
    measure(d, &across, &down);
    return sqrt(across * down);
}

static double shortest_wave(const property_draw *d) { return fmin(d->wave[0], d->wave[1]); }

double property_slope(const property_draw *d) { return d->swing_m * 6.2831853 / shortest_wave(d); }

double property_wave(const property_draw *d)
{
    double across, down;
    measure(d, &across, &down);
    return 6.2831853 / shortest_wave(d) * fmax(across, down) / d->cell_m;
}

int property_heights(const property_draw *d, OGRSpatialReferenceH srs, int count, double *x,
                     double *y, double *heights)
{
    if (to_metres(d, srs, count, x, y)) return -1;
    for (int n = 0; n < count; n++) {
        double sum = 0;
        for (int i = 0; i < 2; i++) {
            double along = (x[n] * cos(d->turn[i]) + y[n] * sin(d->turn[i])) / d->cell_m;
            sum += sin(6.2831853 * along / d->wave[i] + d->phase[i]);
        }
        heights[n] = d->middle_m + d->swing_m * sum / 2;
    }
    return 0;
}

/* ---- samples ---- */

static void mark_box(const property_draw *d, property_raster *r, int x, int y, int w, int h,
                     enum property_mark mark)
{
    for (int j = y; j < y + h && j < d->rows; j++)
        for (int i = x; i < x + w && i < d->columns; i++)
            r->mark[j * d->columns + i] = (uint8_t)mark;
}

/* A few holes, and a strip or a corner at the rim that they do not touch. */
static void punch(property_draw *d, property_raster *r)
{
    int rim = 14 + (int)(property_chance(d) * 5), holes = (int)(property_chance(d) * 3);
    int at_rim = property_chance(d) < 0.5 || property_has(d, OPTION_RIM_HEIGHT) || !holes;
    for (int n = 0; n < holes; n++) {
        int w = VOID_MIN + (int)(property_chance(d) * 8),
            h = VOID_MIN + (int)(property_chance(d) * 8);
        int x = rim + 3 + (int)(property_chance(d) * (d->columns - w - 2 * rim)),
            y = rim + 3 + (int)(property_chance(d) * (d->rows - h - 2 * rim));
        mark_box(d, r, x, y, w, h, MARK_HOLE);
    }
    if (at_rim && property_chance(d) < 0.5)
        mark_box(d, r, 0, 0, d->columns, rim, MARK_RIM);
    else if (at_rim)
        mark_box(d, r, 0, 0, rim, rim, MARK_RIM);
}

/* What the type makes of a value. */
static double stored(const property_draw *d, double value)
{
    if (d->type == GDT_Float32) return (float)value;
    return property_is_whole(d) ? nearbyint(value) : value;
}

static void take_values(const property_draw *d, property_raster *r)
{
    r->lowest_m = INFINITY;
    r->highest_m = -INFINITY;
    for (int n = 0; n < d->columns * d->rows; n++) {
        r->value[n] = stored(d, (r->metres[n] / d->unit_m - d->offset) / d->scale);
        r->metres[n] = (r->value[n] * d->scale + d->offset) * d->unit_m;
        r->holes += r->mark[n] == MARK_HOLE;
        r->rims += r->mark[n] == MARK_RIM;
        if (r->mark[n]) {
            r->value[n] = d->nodata;
            r->metres[n] = NAN;
        } else {
            r->lowest_m = fmin(r->lowest_m, r->metres[n]);
            r->highest_m = fmax(r->highest_m, r->metres[n]);
        }
    }
}

int property_raster_make(property_draw *d, property_raster *raster)
{
    size_t count = (size_t)d->columns * (size_t)d->rows;
    double *x = malloc(count * sizeof *x), *y = malloc(count * sizeof *y);
    *raster = (property_raster){ .value = malloc(count * sizeof(double)),
                                 .metres = malloc(count * sizeof(double)),
                                 .mark = calloc(count, 1) };
    int rc = x && y && raster->value && raster->metres && raster->mark ? 0 : -1;
    for (size_t n = 0; !rc && n < count; n++) {
        double u = (double)(n % (size_t)d->columns) + 0.5,
               v = (double)(n / (size_t)d->columns) + 0.5;
        x[n] = d->gt[0] + d->gt[1] * u + d->gt[2] * v;
        y[n] = d->gt[3] + d->gt[4] * u + d->gt[5] * v;
    }
    OGRSpatialReferenceH srs = property_reference(d->place->srs);
    if (!rc) rc = property_heights(d, srs, (int)count, x, y, raster->metres);
    if (srs) OSRDestroySpatialReference(srs);
    free(x);
    free(y);
    if (rc) return rc;
    if (d->level[PROPERTY_VOIDS]) punch(d, raster);
    take_values(d, raster);
    return 0;
}

void property_raster_free(property_raster *raster)
{
    free(raster->value);
    free(raster->metres);
    free(raster->mark);
}

static void cubic_weights(double t, double weight[4])
{
    for (int i = 0; i < 4; i++) {
        double x = fabs(t + 1 - i);
        weight[i] = x < 1 ? (1.5 * x - 2.5) * x * x + 1 : ((-0.5 * x + 2.5) * x - 4) * x + 2;
    }
}

double property_raster_between(const property_draw *d, const property_raster *r, double u, double v)
{
    double across[4], down[4], sum = 0;
    int i0 = (int)floor(u) - 1, j0 = (int)floor(v) - 1;
    if (i0 < 0 || j0 < 0 || i0 + 3 >= d->columns || j0 + 3 >= d->rows) return NAN;
    cubic_weights(u - floor(u), across);
    cubic_weights(v - floor(v), down);
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 4; i++)
            sum += across[i] * down[j] * r->metres[(j0 + j) * d->columns + i0 + i];
    return isnan(sum) ? NAN : fmin(fmax(sum, r->lowest_m), r->highest_m);
}
