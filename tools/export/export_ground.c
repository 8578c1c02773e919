#include "export_ground.h"

#include "../../protocol/shape/ff_shape.h"
#include "../bake/bake_say.h"
#include "../info/bake_about_gdal.h"
#include "../bake/raster/bake_grid_gdal.h"
#include "export_ground_local.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define Q24 16777216.0

/* ---- tiles of a window ---- */

/* Places of the first and the last tile that have points of the window along an axis, of tiles
 * that are so many points wide. */
static void tile_range(uint32_t first, uint32_t count, uint32_t tile_points, uint32_t tiles,
                       uint32_t range[2])
{
    range[0] = first / tile_points;
    range[1] = (first + count - 1) / tile_points;
    /* a rim is the last of a tile and the first of the next one, which the last tile has not */
    if (range[0] >= tiles) range[0] = tiles - 1;
    if (range[1] >= tiles) range[1] = tiles - 1;
}

int export_each_tile(const export_ground *ground, uint32_t tile_points, export_tile_fn visit,
                     void *context)
{
    const ff_terrain_info *info = &ground->unpack->pack.header.info;
    const export_window *w = &ground->window;
    ff_sheet tiles = ff_shape_sheet_tiles(info);
    uint32_t count = ff_shape_tiles(info), columns[2], rows[2];
    tile_range(w->left, w->width, tile_points, tiles.x, columns);
    tile_range(w->bottom, w->height, tile_points, tiles.y, rows);
    for (uint32_t tile = 0; tile < count; tile++) {
        ff_sheet at = ff_shape_sheet(info, tile);
        int inside = at.x >= columns[0] && at.x <= columns[1] && at.y >= rows[0] && at.y <= rows[1];
        if (inside && visit(context, tile)) return -1;
        bake_progress("reading", tile + 1, count);
    }
    return 0;
}

int export_put_row(const export_ground *ground, uint32_t column, uint32_t row, uint32_t count,
                   const uint8_t *cells)
{
    const export_window *w = &ground->window;
    int64_t from = (int64_t)column - w->left, up = (int64_t)row - w->bottom;
    int64_t first = from < 0 ? -from : 0, end = from + count > w->width ? w->width - from : count;
    if (up < 0 || up >= w->height || first >= end) return 0;
    return bake_grid_write(&ground->cells, w->height - 1 - (uint32_t)up, (uint32_t)(from + first),
                           (uint32_t)(end - first), cells + first * ground->cells.cell_bytes);
}

/* ---- heights ---- */

typedef struct height_reader {
    const export_ground *ground;
    uint16_t *heights; /* of a tile */
    bake_rims known;
} height_reader;

/* What a tile does not know of rims that others have written stays as those know it. */
static int put_tile_row(const height_reader *reader, uint32_t column, uint32_t row, uint32_t side,
                        uint32_t j)
{
    const export_ground *ground = reader->ground;
    const uint16_t *heights = reader->heights + (size_t)j * side;
    uint32_t first = column > ground->window.left && !reader->known.west[j];
    int all = j > 0 || row <= ground->window.bottom || !memchr(reader->known.south, 0, side);
    if (all)
        return export_put_row(ground, column + first, row + j, side - first,
                              (const uint8_t *)(heights + first));
    for (uint32_t i = first; i < side; i++)
        if (reader->known.south[i] &&
            export_put_row(ground, column + i, row, 1, (const uint8_t *)(heights + i)))
            return -1;
    return 0;
}

static int read_tile(void *context, uint32_t tile)
{
    height_reader *reader = context;
    const export_ground *ground = reader->ground;
    const ff_terrain_info *info = &ground->unpack->pack.header.info;
    uint32_t side = bake_unpack_side(info, ground->level);
    ff_sheet at = ff_shape_sheet(info, tile);
    if (bake_unpack_tile(ground->unpack, tile, ground->level, reader->heights, &reader->known))
        return -1;
    for (uint32_t j = 0; j < side; j++)
        if (put_tile_row(reader, at.x * (side - 1), at.y * (side - 1), side, j)) return -1;
    return 0;
}

static int read_heights(const export_ground *ground)
{
    uint32_t side = bake_unpack_side(&ground->unpack->pack.header.info, ground->level);
    height_reader reader = { ground,
                             malloc((size_t)side * side * sizeof(uint16_t)),
                             { malloc(side), malloc(side) } };
    int rc = reader.heights && reader.known.west && reader.known.south
                 ? export_each_tile(ground, side - 1, read_tile, &reader)
                 : bake_fail("out of memory");
    free(reader.heights);
    free(reader.known.west);
    free(reader.known.south);
    return rc;
}

static void describe_heights(export_ground *ground)
{
    const ff_terrain_info *info = &ground->unpack->pack.header.info;
    int64_t range_wu[2];
    ff_terrain_range_wu(info, range_wu);
    ground->bands = 1;
    ground->scale = info->hscale_q24 / Q24;
    ground->offset = (double)info->hoffset_wu / FF_WU_PER_METRE;
    ground->low = (double)range_wu[0] / FF_WU_PER_METRE;
    ground->high = (double)(range_wu[1] + 1) / FF_WU_PER_METRE;
}

/* ---- both ---- */

int export_ground_begin(export_ground *ground, const bake_box *region, uint32_t cell_bytes)
{
    const ff_terrain_info *info = &ground->unpack->pack.header.info;
    ground->cells = ground->mask = BAKE_GRID_CLOSED;
    ground->srs = bake_about_reference(&ground->unpack->pack);
    if (info->epsg && !ground->srs)
        bake_note("EPSG:%d is not known here: what is written will not name it", info->epsg);
    if (export_place_window(info, ground->srs, &ground->lattice, region, &ground->window))
        return -1;
    export_place_geotransform(info, &ground->lattice, &ground->window, ground->geotransform);
    return bake_grid_open(&ground->cells, ground->window.width, ground->window.height, cell_bytes);
}

int export_ground_finish(export_ground *ground, int rc)
{
    if (!rc) {
        ground->set = bake_grid_dataset(&ground->cells, ground->bands == 1 ? GDT_UInt16 : GDT_Byte,
                                        ground->bands);
        rc = ground->set ? 0 : -1;
    }
    if (rc) {
        export_ground_close(ground);
        return rc;
    }
    GDALSetGeoTransform(ground->set, ground->geotransform);
    if (ground->srs) GDALSetSpatialRef(ground->set, ground->srs);
    return 0;
}

int export_ground_open(const bake_unpack *unpack, uint32_t level, const bake_box *region,
                       export_ground *ground)
{
    *ground = (export_ground){ .unpack = unpack, .level = level };
    ground->lattice = export_lattice_samples(&unpack->pack.header.info, level);
    describe_heights(ground);
    int rc = export_ground_begin(ground, region, sizeof(uint16_t));
    if (!rc) rc = read_heights(ground);
    if (!rc) rc = export_told_error(ground, &ground->error);
    if (!rc) rc = export_told_filled(ground, &ground->mask);
    if (export_ground_finish(ground, rc)) return -1;
    GDALRasterBandH band = GDALGetRasterBand(ground->set, 1);
    GDALSetRasterScale(band, ground->scale);
    GDALSetRasterOffset(band, ground->offset);
    GDALSetRasterUnitType(band, "m");
    return 0;
}

void export_ground_close(export_ground *ground)
{
    if (ground->set) GDALClose(ground->set);
    if (ground->srs) OSRDestroySpatialReference(ground->srs);
    bake_grid_close(&ground->cells);
    bake_grid_close(&ground->mask);
    ground->set = NULL;
    ground->srs = NULL;
}
