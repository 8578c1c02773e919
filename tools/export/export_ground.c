#include "export_ground.h"

#include "../../protocol/shape/ff_shape.h"
#include "../bake/bake_say.h"
#include "../bake/raster/bake_reference.h"
#include "../bake/raster/bake_grid_gdal.h"
#include "export_ground_local.h"

#include <math.h>

#define Q24      16777216.0
#define PROGRESS 1000

/* ---- nodes of a window ---- */

/* 1 when the points first .. first + count touch those of a window, made finer. */
static int meets_along(uint64_t first, uint64_t count, uint64_t from, uint64_t width,
                       uint32_t finer_log2)
{
    return first <= (from + width - 1) << finer_log2 && first + count >= from << finer_log2;
}

int export_meets(const export_ground *ground, ff_key key, uint32_t points, uint32_t finer_log2)
{
    const ff_terrain_info *info = &ground->unpack->pack.header.info;
    const export_window *w = &ground->window;
    uint32_t level = ff_key_level(key), code = ff_key_code(key);
    ff_sheet at = ff_shape_sheet(info, ff_key_tile(key));
    uint64_t x = ((uint64_t)at.x << level) + ff_morton_x(code),
             y = ((uint64_t)at.y << level) + ff_morton_y(code);
    return ff_shape_has_ground(info, key) &&
           meets_along(x * points, points, w->left, w->width, finer_log2) &&
           meets_along(y * points, points, w->bottom, w->height, finer_log2);
}

int export_meets_samples(const export_ground *ground, ff_key key)
{
    const ff_terrain_info *info = &ground->unpack->pack.header.info;
    return export_meets(ground, key, 1u << (info->tile_log2 - ff_key_level(key)),
                        ff_terrain_levels(info) - 1 - ground->level);
}

void export_reading(const export_ground *ground, ff_key key, uint32_t level)
{
    uint32_t down = level - ff_key_level(key);
    uint64_t each = UINT64_C(1) << 2 * level,
             all = each * ff_shape_tiles(&ground->unpack->pack.header.info),
             done = each * ff_key_tile(key) + (((uint64_t)ff_key_code(key) + 1) << 2 * down);
    bake_progress("reading", (uint32_t)(done * PROGRESS / all), PROGRESS);
}

static int put_row(const export_ground *ground, const bake_grid *grid, uint32_t column,
                   uint32_t row, uint32_t count, const uint8_t *cells)
{
    const export_window *w = &ground->window;
    int64_t from = (int64_t)column - w->left, up = (int64_t)row - w->bottom;
    int64_t first = from < 0 ? -from : 0, end = from + count > w->width ? w->width - from : count;
    if (up < 0 || up >= w->height || first >= end) return 0;
    return bake_grid_write(grid, w->height - 1 - (uint32_t)up, (uint32_t)(from + first),
                           (uint32_t)(end - first), cells + first * grid->cell_bytes);
}

int export_put_row(const export_ground *ground, uint32_t column, uint32_t row, uint32_t count,
                   const uint8_t *cells)
{
    return put_row(ground, &ground->cells, column, row, count, cells);
}

int export_put_mask(const export_ground *ground, uint32_t column, uint32_t row, uint32_t count,
                    const uint8_t *mask)
{
    return put_row(ground, &ground->mask, column, row, count, mask);
}

/* ---- heights ---- */

static int wants(void *context, ff_key key) { return export_meets_samples(context, key); }

/* What a block does not know of rims that those before it have written stays as those know it. */
static int put_block_row(const export_ground *ground, uint32_t column, uint32_t row, uint32_t side,
                         const uint16_t *heights, const uint8_t *known, int on_rim)
{
    uint32_t first = known && column > ground->window.left && !known[0];
    if (!known || !on_rim || row <= ground->window.bottom)
        return export_put_row(ground, column + first, row, side - first,
                              (const uint8_t *)(heights + first));
    for (uint32_t i = first; i < side; i++)
        if (known[i] && export_put_row(ground, column + i, row, 1, (const uint8_t *)(heights + i)))
            return -1;
    return 0;
}

static int take_block(void *context, ff_key key, uint32_t side, const uint16_t *heights,
                      const uint8_t *known)
{
    const export_ground *ground = context;
    uint32_t level = ff_key_level(key), code = ff_key_code(key);
    ff_sheet at = ff_shape_sheet(&ground->unpack->pack.header.info, ff_key_tile(key));
    uint32_t column = ((at.x << level) + ff_morton_x(code)) * (side - 1),
             row = ((at.y << level) + ff_morton_y(code)) * (side - 1);
    for (uint32_t j = 0; j < side; j++)
        if (put_block_row(ground, column, row + j, side, heights + (size_t)j * side,
                          known ? known + (size_t)j * side : NULL, j == 0))
            return -1;
    export_reading(ground, key, level);
    return 0;
}

static int read_heights(export_ground *ground)
{
    const bake_unpack_walk walk = { ground, wants, take_block };
    return bake_unpack_heights(ground->unpack, ground->level, &walk);
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
    ground->srs = bake_reference_of(&ground->unpack->pack);
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
        ground->set = ground->bands == 1 ? bake_grid_dataset(&ground->cells, GDT_UInt16, 1)
                                         : bake_grid_dataset(&ground->cells, GDT_Byte, 4);
        rc = ground->set ? 0 : -1;
    }
    if (rc) {
        export_ground_close(ground);
        return rc;
    }
    for (int b = 0; ground->bands == 3 && b < 4; b++)
        GDALSetRasterColorInterpretation(GDALGetRasterBand(ground->set, b + 1),
                                         (GDALColorInterp)(GCI_RedBand + b));
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
