#include "export_view.h"

#include "../bake/bake_say.h"
#include "../bake/raster/bake_grid_gdal.h"
#include "../bake/raster/bake_warp.h"

#include <math.h>
#include <stdlib.h>

#define TRANSFORM_ERROR_PX 0.0002
#define WARP_MEMORY_BYTES  (64 << 20)

/* Chooses how the ground gets from its datum to that of the target. 0 or -1 (said). */
static int find_shift(const export_ground *ground, OGRSpatialReferenceH target, bake_shift *shift)
{
    bake_area degrees;
    double gt[6];
    GDALGetGeoTransform(ground->set, gt);
    if (bake_shift_area(ground->srs, gt, ground->cells.width, ground->cells.height, &degrees))
        return 0;
    if (bake_shift_find(ground->unpack->path, ground->srs, target, &degrees,
                        "write .tif, .png or .r16, which stay on its datum", shift))
        return -1;
    bake_shift_note(ground->unpack->path, shift, gt[1]);
    return 0;
}

int export_view_open(const export_ground *ground, OGRSpatialReferenceH target, export_view *view)
{
    *view = (export_view){ .ground = ground };
    if (!ground->srs)
        return bake_fail("%s: no reference system, or none that is known here: it cannot be laid "
                         "on a map; .tif, .png and .r16 can be written",
                         ground->unpack->path);
    if (find_shift(ground, target, &view->shift)) return -1;
    view->transform = bake_warp_transform(ground->set, target, &view->shift);
    if (!view->transform) return -1;
    if (ground->mask.fd < 0) return 0;
    view->marks = bake_grid_dataset(&ground->mask, GDT_Byte, 1);
    if (view->marks) return 0;
    export_view_close(view);
    return -1;
}

void export_view_close(export_view *view)
{
    if (view->marks) GDALClose(view->marks);
    if (view->transform) GDALDestroyGenImgProjTransformer(view->transform);
    view->marks = NULL;
    view->transform = NULL;
}

/* ---- the warper ---- */

/* Projects bands of `source` into a buffer in which all cells are NAN, and stay so beyond it. */
static int warp(const export_view *view, GDALDatasetH source, int bands, GDALResampleAlg how,
                uint32_t width, uint32_t height, float *values)
{
    GDALWarpOptions *o = GDALCreateWarpOptions();
    o->eResampleAlg = how;
    o->eWorkingDataType = GDT_Float32;
    o->dfWarpMemoryLimit = WARP_MEMORY_BYTES;
    o->hSrcDS = source;
    GDALWarpInitDefaultBandMapping(o, bands);
    o->padfDstNoDataReal = CPLCalloc((size_t)bands, sizeof(double));
    for (int b = 0; b < bands; b++) o->padfDstNoDataReal[b] = NAN;
    o->papszWarpOptions = bake_warp_sharpness(o->papszWarpOptions, view->transform, width, height);
    void *approx = GDALCreateApproxTransformer(GDALGenImgProjTransform, view->transform,
                                               TRANSFORM_ERROR_PX);
    o->pfnTransformer = GDALApproxTransform;
    o->pTransformerArg = approx;
    CPLErrorReset();
    GDALWarpOperationH operation = GDALCreateWarpOperation(o);
    int failed = !operation || GDALWarpRegionToBuffer(operation, 0, 0, (int)width, (int)height,
                                                      values, GDT_Float32, 0, 0, 0, 0) != CE_None;
    if (operation) GDALDestroyWarpOperation(operation);
    GDALDestroyApproxTransformer(approx);
    GDALDestroyWarpOptions(o);
    return failed ? bake_fail_gdal("cannot project the ground") : 0;
}

/* ---- beyond the ground ---- */

static double clamp(double value, double low, double high) { return fmin(fmax(value, low), high); }

/* Cubic filters overshoot. */
static double metres_of(const export_ground *ground, float cell)
{
    return clamp((double)cell * ground->scale + ground->offset, ground->low, ground->high);
}

/* The bands of the ground's cell that is nearest to a place in its columns and rows. 0 or -1
 * (said).
 */
static int read_nearest(const export_ground *ground, double x, double y, float value[3])
{
    uint8_t cell[4];
    uint16_t step;
    if (!isfinite(x) || !isfinite(y)) x = y = 0;
    uint32_t column = (uint32_t)clamp(floor(x), 0, ground->cells.width - 1.0),
             row = (uint32_t)clamp(floor(y), 0, ground->cells.height - 1.0);
    if (ground->bands == 1) {
        if (bake_grid_read(&ground->cells, row, column, 1, &step)) return -1;
        value[0] = step;
        return 0;
    }
    if (bake_grid_read(&ground->cells, row, column, 1, cell)) return -1;
    for (int b = 0; b < ground->bands; b++) value[b] = cell[b];
    return 0;
}

/* Cells of a row that are NAN take the nearest ground. */
static int reach_beyond(const export_view *view, uint32_t width, uint32_t row, size_t band_cells,
                        double *place, float *values)
{
    double *x = place, *y = place + width, *z = place + 2 * (size_t)width;
    int *ok = (int *)(place + 3 * (size_t)width), any = 0;
    for (uint32_t i = 0; i < width; i++) {
        x[i] = i + 0.5;
        y[i] = row + 0.5;
        z[i] = 0;
        any |= isnan(values[(size_t)row * width + i]);
    }
    if (!any) return 0;
    GDALGenImgProjTransform(view->transform, TRUE, (int)width, x, y, z, ok);
    for (uint32_t i = 0; i < width; i++) {
        float nearest[3], *at = values + (size_t)row * width + i;
        if (!isnan(*at)) continue;
        if (read_nearest(view->ground, ok[i] ? x[i] : NAN, ok[i] ? y[i] : NAN, nearest)) return -1;
        for (int b = 0; b < view->ground->bands; b++)
            at[(size_t)b * band_cells] = (float)metres_of(view->ground, nearest[b]);
    }
    return 0;
}

/* ---- both ---- */

static int64_t make_mask(const export_view *view, uint32_t width, uint32_t height,
                         const float *values, uint8_t *mask)
{
    size_t count = (size_t)width * height;
    int64_t found = 0;
    float *marks = view->marks ? malloc(count * sizeof *marks) : NULL;
    if (view->marks && !marks) return bake_fail("out of memory");
    for (size_t i = 0; marks && i < count; i++) marks[i] = NAN;
    int rc = marks ? warp(view, view->marks, 1, GRA_NearestNeighbour, width, height, marks) : 0;
    for (size_t i = 0; !rc && i < count; i++) {
        int on_ground = !isnan(values[i]);
        if (marks && on_ground) /* at the rim the filters may differ in what they reach */
            mask[i] = isnan(marks[i]) ? EXPORT_MEASURED : (uint8_t)marks[i];
        else
            mask[i] = on_ground ? EXPORT_MEASURED : EXPORT_BEYOND;
        found += mask[i] != EXPORT_BEYOND;
    }
    free(marks);
    return rc ? rc : found;
}

int export_view_reach(const export_view *view, const double geotransform[6], uint32_t width,
                      uint32_t height, float *values)
{
    double *place = malloc(width * (3 * sizeof *place + sizeof(int)));
    if (!place) return bake_fail("out of memory");
    GDALSetGenImgProjTransformerDstGeoTransform(view->transform, geotransform);
    int rc = 0;
    for (uint32_t row = 0; !rc && row < height; row++)
        rc = reach_beyond(view, width, row, (size_t)width * height, place, values);
    free(place);
    return rc;
}

int64_t export_view_read(const export_view *view, const double geotransform[6], uint32_t width,
                         uint32_t height, float *values, uint8_t *mask)
{
    const export_ground *ground = view->ground;
    size_t count = (size_t)width * height * (size_t)ground->bands;
    for (size_t i = 0; i < count; i++) values[i] = NAN;
    GDALSetGenImgProjTransformerDstGeoTransform(view->transform, geotransform);
    if (warp(view, ground->set, ground->bands, GRA_Cubic, width, height, values)) return -1;
    int64_t found = make_mask(view, width, height, values, mask);
    for (size_t i = 0; i < count; i++)
        if (!isnan(values[i])) values[i] = (float)metres_of(ground, values[i]);
    if (found >= 0 && export_view_reach(view, geotransform, width, height, values)) return -1;
    return found;
}
