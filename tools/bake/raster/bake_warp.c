#include "bake_warp.h"

#include "../bake_say.h"
#include "bake_grid_gdal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STRIP_ROWS         128 /* rows of a warped VRT's blocks */
#define TRANSFORM_ERROR_PX 0.05

void *bake_warp_transform(GDALDatasetH source, OGRSpatialReferenceH target)
{
    char **settings = NULL;
    char *wkt = NULL;
    if (target) {
        OSRExportToWkt(target, &wkt);
        settings = CSLSetNameValue(settings, "DST_SRS", wkt);
    }
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

static int copy_warped(GDALDatasetH warped, bake_grid *grid, uint64_t *outside)
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
        for (size_t i = 0; i < samples; i++) *outside += isnan(rows[i]) != 0;
        if (!rc)
            rc = bake_pwrite(grid->fd, rows, samples * sizeof *rows,
                             (uint64_t)top * grid->width * sizeof *rows);
        bake_progress("projecting", top + count, grid->height);
    }
    free(rows);
    return rc;
}

static int warp_from(const bake_warp *w, GDALDatasetH source, bake_grid *grid, uint64_t *outside)
{
    void *transform = bake_warp_transform(source, w->target);
    GDALDatasetH warped = transform ? make_warped(w, source, transform) : NULL;
    if (!warped) return -1;
    int rc = bake_grid_open(grid, w->width, w->height, sizeof(float));
    if (!rc) rc = copy_warped(warped, grid, outside);
    GDALClose(warped);
    return rc;
}

int bake_warp_grid(const bake_warp *w, bake_grid *grid, uint64_t *outside)
{
    bake_grid image = BAKE_GRID_CLOSED;
    GDALDatasetH source = bake_warp_source(w, grid);
    if (!source) return -1;
    int rc = warp_from(w, source, &image, outside);
    GDALClose(source);
    if (rc) {
        bake_grid_close(&image);
        return rc;
    }
    bake_grid_close(grid);
    *grid = image;
    return 0;
}
