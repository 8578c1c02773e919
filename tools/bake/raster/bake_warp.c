#include "bake_warp.h"

#include "../bake_say.h"
#include "bake_grid_gdal.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STRIP_ROWS         128 /* rows of a warped VRT's blocks */
#define TRANSFORM_ERROR_PX 0.0001
#define CELLS_SHARP        1.99 /* of the source in a sample: up to here a cubic sees them all */

void *bake_warp_transform(GDALDatasetH source, OGRSpatialReferenceH target, const bake_shift *shift)
{
    char **settings = NULL;
    char *wkt = NULL;
    if (target) {
        OSRExportToWkt(target, &wkt);
        settings = CSLSetNameValue(settings, "DST_SRS", wkt);
    }
    if (*shift->operation)
        settings = CSLSetNameValue(settings, "COORDINATE_OPERATION", shift->operation);
    CPLErrorReset();
    void *transform = GDALCreateGenImgProjTransformer2(source, NULL, settings);
    CSLDestroy(settings);
    CPLFree(wkt);
    if (!transform) bake_fail_gdal("cannot project the raster");
    return transform;
}

GDALDatasetH bake_warp_source(const bake_warp *w, const bake_grid *grid)
{
    GDALDatasetH source = bake_grid_dataset(grid, GDT_Float32, 1);
    if (!source) return NULL;
    GDALSetGeoTransform(source, (double *)w->from);
    if (w->srs) GDALSetSpatialRef(source, w->srs);
    return source;
}

int bake_warp_measure(void *transform, int to_source, uint32_t width, uint32_t height,
                      bake_warp_cell *cell)
{
    double i = width / 2, j = height / 2;
    double x[3] = { i, i + 1, i }, y[3] = { j, j, j + 1 }, z[3] = { 0 };
    int ok[3] = { 0 };
    if (!GDALGenImgProjTransform(transform, to_source, 3, x, y, z, ok) || !ok[0] || !ok[1] ||
        !ok[2])
        return -1;
    *cell = (bake_warp_cell){ { x[1] - x[0], x[2] - x[0] }, { y[1] - y[0], y[2] - y[0] } };
    return 0;
}

static char **add_scale(char **list, const char *name, double cells)
{
    char text[40];
    snprintf(text, sizeof text, "%.17g", cells > CELLS_SHARP ? 1 / cells : 1);
    return CSLSetNameValue(list, name, text);
}

char **bake_warp_sharpness(char **list, void *transform, uint32_t width, uint32_t height)
{
    bake_warp_cell cell;
    if (bake_warp_measure(transform, 1, width, height, &cell)) return list;
    list = add_scale(list, "XSCALE", hypot(cell.x[0], cell.x[1]));
    return add_scale(list, "YSCALE", hypot(cell.y[0], cell.y[1]));
}

/* Takes `transform` over. */
static GDALDatasetH make_warped(const bake_warp *w, GDALDatasetH source, void *transform)
{
    char threads[16];
    snprintf(threads, sizeof threads, "%d", w->jobs);
    GDALWarpOptions *warp = GDALCreateWarpOptions();
    warp->eResampleAlg = GRA_Cubic;
    warp->eWorkingDataType = GDT_Float32;
    warp->dfWarpMemoryLimit = 32 << 20;
    warp->hSrcDS = source;
    warp->nBandCount = 1;
    warp->panSrcBands = CPLCalloc(1, sizeof(int));
    warp->panDstBands = CPLCalloc(1, sizeof(int));
    warp->panSrcBands[0] = warp->panDstBands[0] = 1;
    warp->padfDstNoDataReal = CPLCalloc(1, sizeof(double));
    warp->padfDstNoDataReal[0] = NAN;
    warp->papszWarpOptions = CSLSetNameValue(warp->papszWarpOptions, "INIT_DEST", "NO_DATA");
    warp->papszWarpOptions = CSLSetNameValue(warp->papszWarpOptions, "NUM_THREADS", threads);
    GDALSetGenImgProjTransformerDstGeoTransform(transform, w->to);
    warp->papszWarpOptions = bake_warp_sharpness(warp->papszWarpOptions, transform, w->width,
                                                 w->height);
    warp->pfnTransformer = GDALApproxTransform;
    warp->pTransformerArg = GDALCreateApproxTransformer(GDALGenImgProjTransform, transform,
                                                        TRANSFORM_ERROR_PX);
    GDALApproxTransformerOwnsSubtransformer(warp->pTransformerArg, 1);
    GDALDatasetH warped = GDALCreateWarpedVRT(source, (int)w->width, (int)w->height,
                                              (double *)w->to, warp);
    GDALDestroyWarpOptions(warp);
    if (!warped) bake_fail_gdal("cannot project the raster");
    return warped;
}

/* The heights of a grid lie between these. */
typedef struct value_range {
    float low, high;
} value_range;

/* Keeps what the cubic filter made beyond the range of its source to that range, and counts it. */
static void keep_in_range(float *value, size_t count, value_range range, bake_warp_count *out)
{
    for (size_t i = 0; i < count; i++) {
        float kept = fminf(fmaxf(value[i], range.low), range.high);
        if (isnan(value[i])) {
            out->outside++;
        } else if (kept != value[i]) {
            out->beyond++;
            out->beyond_m = fmax(out->beyond_m, fabs((double)value[i] - kept));
            value[i] = kept;
        }
    }
}

static int copy_warped(GDALDatasetH warped, value_range range, bake_grid *grid,
                       bake_warp_count *out)
{
    float *rows = malloc((size_t)STRIP_ROWS * grid->width * sizeof *rows);
    if (!rows) return bake_fail("out of memory");
    int rc = 0;
    for (uint32_t top = 0; !rc && top < grid->height; top += STRIP_ROWS) {
        uint32_t count = grid->height - top < STRIP_ROWS ? grid->height - top : STRIP_ROWS;
        CPLErrorReset();
        if (GDALRasterIO(GDALGetRasterBand(warped, 1), GF_Read, 0, (int)top, (int)grid->width,
                         (int)count, rows, (int)grid->width, (int)count, GDT_Float32, 0,
                         0) != CE_None)
            rc = bake_fail_gdal("cannot project rows %u to %u", top, top + count - 1);
        size_t samples = (size_t)count * grid->width;
        if (!rc) keep_in_range(rows, samples, range, out);
        if (!rc)
            rc = bake_pwrite(grid->fd, rows, samples * sizeof *rows,
                             (uint64_t)top * grid->width * sizeof *rows);
        bake_progress("projecting", top + count, grid->height);
    }
    free(rows);
    return rc;
}

static int warp_from(const bake_warp *w, GDALDatasetH source, value_range range, bake_grid *grid,
                     bake_warp_count *out)
{
    void *transform = bake_warp_transform(source, w->target, &w->shift);
    GDALDatasetH warped = transform ? make_warped(w, source, transform) : NULL;
    if (!warped) return -1;
    int rc = bake_grid_open(grid, w->width, w->height, sizeof(float));
    if (!rc) rc = copy_warped(warped, range, grid, out);
    GDALClose(warped);
    return rc;
}

int bake_warp_back(const bake_warp *w, const bake_grid *grid, int count, double *column,
                   double *row)
{
    GDALDatasetH source = bake_warp_source(w, grid);
    void *transform = source ? bake_warp_transform(source, w->target, &w->shift) : NULL;
    double *z = calloc((size_t)count, sizeof *z);
    int *ok = calloc((size_t)count, sizeof *ok);
    int rc = !transform ? -1 : z && ok ? 0 : bake_fail("out of memory");
    if (!rc) {
        GDALSetGenImgProjTransformerDstGeoTransform(transform, w->to);
        GDALGenImgProjTransform(transform, 1, count, column, row, z, ok);
        for (int i = 0; i < count; i++)
            if (!ok[i] || column[i] < 0 || row[i] < 0 || column[i] > grid->width ||
                row[i] > grid->height)
                column[i] = row[i] = NAN;
    }
    free(z);
    free(ok);
    if (transform) GDALDestroyGenImgProjTransformer(transform);
    if (source) GDALClose(source);
    return rc;
}

/* Makes the image of a grid within a range. */
static int warp_into(const bake_warp *w, const bake_grid *grid, value_range range, bake_grid *image,
                     bake_warp_count *out)
{
    *out = (bake_warp_count){ 0 };
    *image = BAKE_GRID_CLOSED;
    GDALDatasetH source = bake_warp_source(w, grid);
    if (!source) return -1;
    int rc = warp_from(w, source, range, image, out);
    GDALClose(source);
    if (rc) bake_grid_close(image);
    return rc;
}

int bake_warp_part(const bake_warp *w, const bake_grid *grid, bake_grid *image,
                   bake_warp_count *out)
{
    return warp_into(w, grid, (value_range){ -FLT_MAX, FLT_MAX }, image, out);
}

int bake_warp_grid(const bake_warp *w, bake_grid *grid, bake_warp_count *out)
{
    value_range range;
    bake_grid image;
    if (bake_grid_range(grid, &range.low, &range.high)) return -1;
    if (warp_into(w, grid, range, &image, out)) return -1;
    bake_grid_close(grid);
    *grid = image;
    return 0;
}
