#include "bake_project.h"

#include "../../../protocol/ff_terrain.h"
#include "bake_area.h"
#include "bake_grid_gdal.h"
#include "../bake_say.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STRIP_ROWS         128  /* rows of a warped VRT's blocks */
#define LONGITUDES_MAX     20.0 /* further from its middle a UTM zone shows another Earth */
#define TRANSFORM_ERROR_PX 0.05
#define GROWTH_MAX         64.0 /* samples made of one: a projection that makes more has torn the raster \
                                 */

/* The UTM zone (polar: UPS) round a place, as an EPSG code of WGS84. */
static int local_zone(double longitude, double latitude)
{
    if (latitude > 84) return 32661;
    if (latitude < -80) return 32761;
    int zone = ((int)floor((longitude + 180) / 6) % 60 + 60) % 60 + 1;
    return (latitude < 0 ? 32700 : 32600) + zone;
}

/* Middle of the ground in longitude and latitude. */
static int middle_of(const bake_ground *ground, double *longitude, double *latitude)
{
    const double *gt = ground->geotransform;
    double column = ground->grid.width / 2.0, row = ground->grid.height / 2.0;
    *longitude = gt[0] + gt[1] * column + gt[2] * row;
    *latitude = gt[3] + gt[4] * column + gt[5] * row;
    if (ground->is_geographic) return 0;
    OGRSpatialReferenceH wgs84 = OSRNewSpatialReference(NULL);
    OSRImportFromEPSG(wgs84, 4326);
    OSRSetAxisMappingStrategy(wgs84, OAMS_TRADITIONAL_GIS_ORDER);
    OGRCoordinateTransformationH to = OCTNewCoordinateTransformation(ground->srs, wgs84);
    int ok = to && OCTTransform(to, 1, longitude, latitude, NULL);
    if (to) OCTDestroyCoordinateTransformation(to);
    OSRDestroySpatialReference(wgs84);
    return ok ? 0 : bake_fail_gdal("cannot tell where on the Earth the raster lies");
}

static int choose_target(const bake_options *o, const bake_ground *ground,
                         OGRSpatialReferenceH *target)
{
    double longitude, latitude;
    int epsg = o->target_epsg;
    *target = NULL;
    if (!epsg) {
        double wide = fabs(ground->geotransform[1]) * ground->grid.width;
        if (ground->is_geographic && wide > LONGITUDES_MAX)
            return bake_fail(
                "%.0f degrees of longitude are too wide for a UTM zone: name a projection with --t-srs",
                wide);
        if (middle_of(ground, &longitude, &latitude)) return -1;
        epsg = local_zone(longitude, latitude);
    }
    *target = OSRNewSpatialReference(NULL);
    OSRSetAxisMappingStrategy(*target, OAMS_TRADITIONAL_GIS_ORDER);
    CPLErrorReset();
    if (OSRImportFromEPSG(*target, epsg) == OGRERR_NONE && OSRIsProjected(*target) &&
        fabs(OSRGetLinearUnits(*target, NULL) - 1) < 1e-9)
        return 0;
    OSRDestroySpatialReference(*target);
    *target = NULL;
    return bake_fail("EPSG:%d is no projection in metres", epsg);
}

/* Rounds a spacing to whole world units, so that it has whole ones also after --densify has divided
 * it. */
static double round_spacing(const bake_options *o, double spacing_m)
{
    double units = fmax(1, nearbyint(spacing_m * FF_WU_PER_METRE / o->densify));
    return units * o->densify / FF_WU_PER_METRE;
}

/* Refuses, before a sample is made, what would be no terrain or take for ever. 0 or -1 (said). */
static int check_size(const bake_options *o, double source_samples, double spacing_m,
                      double columns, double rows)
{
    if (columns < 2 || rows < 2)
        return bake_fail("a spacing of %g m is too coarse for this raster", spacing_m);
    if (fmax(columns, rows) * spacing_m > BAKE_EDGE_MAX_M)
        return bake_fail(
            "the raster is %.0f x %.0f km after projection, a terrain at most %.0f km: "
            "cut a part with gdal_translate -projwin, or name another projection with "
            "--t-srs",
            columns * spacing_m / 1000, rows * spacing_m / 1000, BAKE_EDGE_MAX_M / 1000);
    if (columns * rows > BAKE_SAMPLES_MAX)
        return bake_fail("a spacing of %g m would make %.0f x %.0f samples, more than %g: give a "
                         "coarser --spacing",
                         spacing_m, columns, rows, BAKE_SAMPLES_MAX);
    if (o->spacing_m <= 0 && columns * rows > GROWTH_MAX * source_samples)
        return bake_fail("projected, the raster would be %.0f times as large: name another "
                         "projection with --t-srs, or give --spacing",
                         columns * rows / source_samples);
    return 0;
}

/* Plans the warped grid: its geotransform, width and height. The south-west sample lies on whole
 * metres. */
static int plan_output(const bake_options *o, GDALDatasetH source, void *transform, double *gt,
                       int *width, int *height)
{
    double extent[4], suggested[6];
    if (GDALSuggestedWarpOutput2(source, GDALGenImgProjTransform, transform, suggested, width,
                                 height, extent, 0) != CE_None)
        return bake_fail_gdal("cannot project the raster");
    double spacing = o->spacing_m > 0 ? o->spacing_m : suggested[1];
    spacing = round_spacing(o, spacing);
    double west = ceil(extent[0] + spacing / 2), south = ceil(extent[1] + spacing / 2);
    double columns = floor((extent[2] - spacing / 2 - west) / spacing) + 1;
    double rows = floor((extent[3] - spacing / 2 - south) / spacing) + 1;
    if (check_size(o, GDALGetRasterXSize(source) * (double)GDALGetRasterYSize(source), spacing,
                   columns, rows))
        return -1;
    *width = (int)columns;
    *height = (int)rows;
    double planned[6] = {
        west - spacing / 2, spacing, 0, south + (rows - 0.5) * spacing, 0, -spacing
    };
    memcpy(gt, planned, sizeof planned);
    return 0;
}

static GDALDatasetH make_warped(const bake_options *o, GDALDatasetH source, void *transform,
                                const double *gt, int width, int height)
{
    char threads[16];
    snprintf(threads, sizeof threads, "%d", o->jobs);
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
    GDALSetGenImgProjTransformerDstGeoTransform(transform, gt);
    warp->pfnTransformer = GDALApproxTransform;
    warp->pTransformerArg = GDALCreateApproxTransformer(GDALGenImgProjTransform, transform,
                                                        TRANSFORM_ERROR_PX);
    GDALApproxTransformerOwnsSubtransformer(warp->pTransformerArg, 1);
    GDALDatasetH warped = GDALCreateWarpedVRT(source, width, height, (double *)gt, warp);
    GDALDestroyWarpOptions(warp);
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

static int warp_from(const bake_options *o, GDALDatasetH source, OGRSpatialReferenceH target,
                     bake_ground *ground, bake_grid *grid)
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
    if (!transform) return bake_fail_gdal("cannot project the raster");
    double gt[6];
    int width, height;
    if (plan_output(o, source, transform, gt, &width, &height)) {
        GDALDestroyGenImgProjTransformer(transform);
        return -1;
    }
    GDALDatasetH warped = make_warped(o, source, transform, gt, width, height);
    if (!warped) return bake_fail_gdal("cannot project the raster");
    int rc = bake_grid_open(grid, (uint32_t)width, (uint32_t)height, sizeof(float));
    if (!rc) rc = copy_warped(warped, grid, &ground->outside);
    GDALClose(warped);
    if (!rc) memcpy(ground->geotransform, gt, sizeof gt);
    return rc;
}

/* Replaces the grid by its image in `target` (NULL: the same plane). Takes `target` over. */
static int warp_ground(const bake_options *o, OGRSpatialReferenceH target, bake_ground *ground)
{
    bake_grid grid = BAKE_GRID_CLOSED;
    GDALDatasetH source = bake_grid_dataset(&ground->grid, GDT_Float32, 1);
    int rc = source ? 0 : -1;
    if (!rc) {
        GDALSetGeoTransform(source, ground->geotransform);
        if (ground->srs) GDALSetSpatialRef(source, ground->srs);
        rc = warp_from(o, source, target, ground, &grid);
    }
    if (source) GDALClose(source);
    if (rc) {
        bake_grid_close(&grid);
        if (target) OSRDestroySpatialReference(target);
        return rc;
    }
    bake_grid_close(&ground->grid);
    ground->grid = grid;
    ground->resampled = 1;
    ground->is_geographic = 0;
    if (target) {
        if (ground->srs) OSRDestroySpatialReference(ground->srs);
        ground->srs = target;
    }
    return 0;
}

static int is_square(const double *gt)
{
    return fabs(gt[2]) < 1e-9 * fabs(gt[1]) && fabs(gt[4]) < 1e-9 * fabs(gt[5]) &&
           fabs(fabs(gt[5] / gt[1]) - 1) < 1e-3 && gt[1] > 0;
}

/* Finds the spacing of samples that stay as they are. */
static int keep_samples(const bake_options *o, const bake_ground *ground, double *spacing_m)
{
    if (o->spacing_m > 0)
        *spacing_m = o->spacing_m;
    else if (!ground->has_place)
        return bake_fail("%s: no georeference: give --spacing", o->heights_path);
    else if (ground->is_geographic)
        return bake_fail("degrees are no spacing: with --no-project give --spacing too");
    else
        *spacing_m = fabs(ground->geotransform[1]);
    double exact = *spacing_m * FF_WU_PER_METRE;
    if (exact < 0.5 * o->densify)
        return bake_fail("a spacing of %g m is finer than the 1/%d m of world units",
                         *spacing_m / o->densify, FF_WU_PER_METRE);
    *spacing_m = round_spacing(o, *spacing_m);
    double drift_m = fabs(*spacing_m - exact / FF_WU_PER_METRE) * ground->grid.width;
    if (drift_m > *spacing_m / 2)
        bake_note("the spacing is rounded to %.8g m: %.1f m over the whole width", *spacing_m,
                  drift_m);
    return 0;
}

static int needs_target(const bake_options *o, const bake_ground *ground)
{
    if (!ground->srs || o->no_project) return 0;
    return ground->is_geographic || o->target_epsg ||
           fabs(OSRGetLinearUnits(ground->srs, NULL) - 1) > 1e-9;
}

int bake_project(const bake_options *o, bake_ground *ground, double *spacing_m)
{
    OGRSpatialReferenceH target = NULL;
    if (o->target_epsg && !ground->srs)
        return bake_fail("%s names no reference system: nothing to project from", o->heights_path);
    if (!ground->has_place || o->no_project) return keep_samples(o, ground, spacing_m);
    int same_spacing = o->spacing_m <= 0 || fabs(o->spacing_m / ground->geotransform[1] - 1) < 1e-6;
    if (needs_target(o, ground)) {
        if (choose_target(o, ground, &target)) return -1;
        if (OSRIsSame(target, ground->srs)) {
            OSRDestroySpatialReference(target);
            target = NULL;
        }
    }
    if (!target && same_spacing && is_square(ground->geotransform))
        return keep_samples(o, ground, spacing_m);
    if (warp_ground(o, target, ground)) return -1;
    *spacing_m = ground->geotransform[1];
    return 0;
}
