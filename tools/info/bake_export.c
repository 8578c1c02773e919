#include "bake_export.h"
#include "bake_about_gdal.h"

#include "../../protocol/shape/ff_shape.h"
#include "../bake/raster/bake_grid_gdal.h"
#include "../bake/bake_say.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define PATH_BYTES 4096
#define COPY_BYTES (1u << 18)

/* Samples along one axis when every 2^skip-th is taken. */
static uint32_t thinned(uint32_t samples, uint32_t skip) { return ((samples - 1) >> skip) + 1; }

/* Decodes a tile into the raster (row 0 north). */
static int export_tile(const bake_unpack *unpack, uint32_t tile, uint32_t level,
                       const bake_grid *raster, uint16_t *heights)
{
    const ff_terrain_info *info = &unpack->pack.header.info;
    uint32_t side = bake_unpack_side(info, level);
    ff_sheet at = ff_shape_sheet(info, tile);
    uint32_t column = at.x * (side - 1), row = at.y * (side - 1);
    if (column >= raster->width || row >= raster->height) return 0;
    uint32_t columns = raster->width - column < side ? raster->width - column : side;
    if (bake_unpack_tile(unpack, tile, level, heights)) return -1;
    for (uint32_t j = 0; j < side && row + j < raster->height; j++)
        if (bake_grid_write(raster, raster->height - 1 - row - j, column, columns,
                            heights + (size_t)j * side))
            return -1;
    return 0;
}

static int export_tiles(const bake_unpack *unpack, uint32_t level, const bake_grid *raster)
{
    const ff_terrain_info *info = &unpack->pack.header.info;
    uint32_t side = bake_unpack_side(info, level), tiles = ff_shape_tiles(info);
    uint16_t *heights = malloc((size_t)side * side * sizeof *heights);
    int rc = heights ? 0 : bake_fail("out of memory");
    for (uint32_t tile = 0; !rc && tile < tiles; tile++) {
        rc = export_tile(unpack, tile, level, raster, heights);
        bake_progress("tiles", tile + 1, tiles);
    }
    free(heights);
    return rc;
}

static int copy_raw(const bake_grid *raster, const char *path)
{
    uint64_t count = (uint64_t)raster->width * raster->height * raster->cell_bytes;
    FILE *file = fopen(path, "wb");
    uint8_t *buffer = malloc(COPY_BYTES);
    int rc = file && buffer ? 0 : bake_fail("cannot write %s: %s", path, strerror(errno));
    for (uint64_t at = 0; !rc && at < count;) {
        size_t bytes = count - at < COPY_BYTES ? (size_t)(count - at) : COPY_BYTES;
        rc = bake_pread(raster->fd, buffer, bytes, at);
        if (!rc && fwrite(buffer, 1, bytes, file) != bytes)
            rc = bake_fail("cannot write %s: %s", path, strerror(errno));
        at += bytes;
    }
    if (file && fclose(file) && !rc) rc = bake_fail("cannot write %s: %s", path, strerror(errno));
    free(buffer);
    return rc;
}

static void set_reference(const ff_pack *pack, uint32_t skip, const bake_grid *raster,
                          GDALDatasetH set)
{
    const ff_terrain_info *info = &pack->header.info;
    double spacing = (double)info->spacing_wu / FF_WU_PER_METRE * (double)(1u << skip);
    double west = (double)info->origin_x_mm / 1000 - spacing / 2,
           south = (double)info->origin_y_mm / 1000 - spacing / 2;
    double gt[6] = { west, spacing, 0, south + spacing * raster->height, 0, -spacing };
    GDALSetGeoTransform(set, gt);
    OGRSpatialReferenceH srs = bake_about_reference(pack);
    if (srs) {
        GDALSetSpatialRef(set, srs);
        OSRDestroySpatialReference(srs);
    } else if (info->epsg)
        bake_note("EPSG:%d is not known here: the raster will not name it", info->epsg);
    bake_about_metadata(pack, set);
    GDALRasterBandH band = GDALGetRasterBand(set, 1);
    GDALSetRasterScale(band, info->hscale_q24 / 16777216.0);
    GDALSetRasterOffset(band, (double)info->hoffset_wu / FF_WU_PER_METRE);
    GDALSetRasterUnitType(band, "m");
}

static int copy_image(const ff_pack *pack, uint32_t skip, const bake_grid *raster,
                      const char *driver, const char *path)
{
    GDALDatasetH set = bake_grid_dataset(raster, GDT_UInt16, 1);
    if (!set) return -1;
    int is_tiff = !strcmp(driver, "GTiff");
    if (is_tiff) set_reference(pack, skip, raster, set);
    char **settings = is_tiff ? CSLSetNameValue(NULL, "COMPRESS", "DEFLATE") : NULL;
    if (is_tiff) settings = CSLSetNameValue(settings, "PREDICTOR", "2");
    CPLErrorReset();
    GDALDatasetH copy = GDALCreateCopy(GDALGetDriverByName(driver), path, set, 0, settings, NULL,
                                       NULL);
    CSLDestroy(settings);
    if (copy) GDALClose(copy);
    GDALClose(set);
    if (copy && CPLGetLastErrorType() < CE_Failure) return 0;
    return bake_fail_gdal("cannot write %s", path);
}

static int write_as(const ff_pack *pack, uint32_t skip, const bake_grid *raster, const char *ending,
                    const char *path)
{
    if (!strcmp(ending, ".r16")) return copy_raw(raster, path);
    return copy_image(pack, skip, raster, strcmp(ending, ".png") ? "GTiff" : "PNG", path);
}

int bake_export(const bake_unpack *unpack, uint32_t level, const char *path)
{
    const ff_terrain_info *info = &unpack->pack.header.info;
    const char *ending = strrchr(path, '.');
    char temp[PATH_BYTES];
    if (!ending || (strcmp(ending, ".tif") && strcmp(ending, ".png") && strcmp(ending, ".r16")))
        return bake_fail("%s: the ending must be .tif, .png or .r16", path);
    if (snprintf(temp, sizeof temp, "%s.tmp-%ld", path, (long)getpid()) >= (int)sizeof temp)
        return bake_fail("%s: the name is too long", path);
    uint32_t skip = ff_terrain_levels(info) - 1 - level;
    ff_sheet samples = ff_shape_sheet_samples(info);
    bake_grid raster;
    bake_temp_setup(path);
    if (bake_grid_open(&raster, thinned(samples.x, skip), thinned(samples.y, skip),
                       sizeof(uint16_t)))
        return -1;
    int rc = export_tiles(unpack, level, &raster);
    if (!rc) rc = write_as(&unpack->pack, skip, &raster, ending, temp);
    if (!rc && rename(temp, path)) rc = bake_fail("cannot rename to %s: %s", path, strerror(errno));
    if (rc) unlink(temp);
    bake_grid_close(&raster);
    return rc;
}
