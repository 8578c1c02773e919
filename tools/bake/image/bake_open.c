#include "bake_open.h"

#include "../../../protocol/shape/ff_shape.h"
#include "../bake_say.h"
#include "bake_image_local.h"
#include "bake_nearest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define RGB 3

/* ---- nodes ---- */

static uint32_t steps_of(const ff_terrain_info *info) { return (1u << info->texture_log2) - 1; }

/* All of a level have `value` at first. */
static int open_grid(const ff_terrain_info *info, bake_image *image, uint32_t level, uint8_t value)
{
    bake_grid *open = &image->open[level];
    const bake_grid *lattice = &image->lattice[level];
    uint32_t width = (lattice->width - 1) / steps_of(info),
             height = (lattice->height - 1) / steps_of(info);
    uint8_t *row = malloc(width);
    int rc = row ? bake_grid_open(open, width, height, 1) : bake_fail("out of memory");
    if (row) memset(row, value, width);
    for (uint32_t j = 0; !rc && j < height; j++) rc = bake_grid_write(open, j, 0, width, row);
    free(row);
    return rc;
}

int bake_open_all(bake_image *image, const ff_terrain_info *info)
{
    image->has_open = 1;
    for (uint32_t l = 0; l < image->levels; l++)
        if (open_grid(info, image, l, 1)) return -1;
    return 0;
}

int bake_is_open(const bake_image *image, const ff_terrain_info *info, ff_key key)
{
    uint8_t open = 0;
    ff_sheet at;
    if (!image->has_open) return 0;
    if (!bake_image_has(image, info, key, &at)) return 1;
    return bake_grid_read(&image->open[ff_key_level(key)], at.y, at.x, 1, &open) ? -1 : open;
}

/* Nodes of the finest level over a row of texels inside them are not open where one is covered. */
static int cover_nodes(const bake_image *image, const ff_terrain_info *info, uint32_t row,
                       const uint32_t *distance)
{
    const bake_grid *open = &image->open[image->levels - 1];
    uint32_t steps = steps_of(info);
    uint8_t is_open = 0;
    if (row % steps == 0) return 0;
    for (uint32_t node = 0; node < open->width; node++) {
        uint32_t i = node * steps + 1;
        while (i < (node + 1) * steps && distance[i]) i++;
        if (i < (node + 1) * steps && bake_grid_write(open, row / steps, node, 1, &is_open))
            return -1;
    }
    return 0;
}

/* A node of which a child is not open is not open. */
static int cover_above(const bake_image *image, uint32_t level)
{
    const bake_grid *fine = &image->open[level + 1], *coarse = &image->open[level];
    const ff_sheet *first = &image->first[level + 1];
    for (uint32_t y = 0; y < fine->height; y++)
        for (uint32_t x = 0; x < fine->width; x++) {
            uint8_t is_open;
            if (bake_grid_read(fine, y, x, 1, &is_open)) return -1;
            if (!is_open && bake_grid_write(coarse, (y + (first->y & 1)) / 2,
                                            (x + (first->x & 1)) / 2, 1, &is_open))
                return -1;
        }
    return 0;
}

/* ---- texels ---- */

typedef struct texel_row {
    uint32_t *distance;
    uint8_t *rgb;
} texel_row;

static int fill_row(bake_own *own, const bake_texel_place *place, const bake_grid *lattice,
                    uint32_t j, const texel_row *row)
{
    double y = fmin((place->first_y + (double)j) * place->samples, place->last_y);
    if (bake_own_row(own, y, place->samples) ||
        bake_grid_read(lattice, j, 0, lattice->width, row->rgb))
        return -1;
    for (uint32_t i = 0; i < lattice->width; i++) {
        double x = fmin((place->first_x + (double)i) * place->samples, place->last_x);
        if (row->distance[i] > BAKE_OPEN_NEAR) bake_own_at(own, x, row->rgb + (size_t)RGB * i);
    }
    return bake_grid_write(lattice, j, 0, lattice->width, row->rgb);
}

/* Every row of the finest lattice, after its nearest colours are found. */
static int fill_rows(bake_image *image, const ff_terrain_info *info, bake_own *own,
                     const bake_texel_place *place, const bake_grid *distance)
{
    const bake_grid *lattice = &image->lattice[image->levels - 1];
    texel_row row = { malloc(lattice->width * sizeof(uint32_t)),
                      malloc((size_t)lattice->width * RGB) };
    int rc = row.distance && row.rgb ? 0 : bake_fail("out of memory");
    for (uint32_t j = 0; !rc && j < lattice->height; j++) {
        rc = bake_grid_read(distance, j, 0, lattice->width, row.distance);
        if (!rc) rc = cover_nodes(image, info, j, row.distance);
        if (!rc && own) rc = fill_row(own, place, lattice, j, &row);
    }
    free(row.distance);
    free(row.rgb);
    return rc;
}

int bake_open_fill(bake_image *image, const ff_terrain_info *info, bake_own *own,
                   const bake_texel_place *place, const bake_grid *distance)
{
    int rc = bake_nearest_fill(&image->lattice[image->levels - 1], distance);
    if (!rc) rc = bake_open_all(image, info);
    if (!rc) rc = fill_rows(image, info, own, place, distance);
    for (uint32_t l = image->levels - 1; !rc && l > 0; l--) rc = cover_above(image, l - 1);
    return rc;
}

/* The texels `from`..`to` of a row, less one. */
static int own_texels(bake_own *own, const bake_texel_place *place, const bake_grid *lattice,
                      uint32_t j, uint32_t from, uint32_t to, uint8_t *rgb)
{
    double y = fmin((place->first_y + (double)j) * place->samples, place->last_y);
    if (from >= to) return 0;
    if (bake_own_row(own, y, place->samples)) return -1;
    for (uint32_t i = from; i < to; i++)
        bake_own_at(own, fmin((place->first_x + (double)i) * place->samples, place->last_x),
                    rgb + (size_t)RGB * (i - from));
    return bake_grid_write(lattice, j, from, to - from, rgb);
}

/* The points first..end, less one, of a coarser lattice of `count` that lie on a finer one. */
static void shared(uint32_t skip, uint32_t fine, uint32_t count, uint32_t *first, uint32_t *end)
{
    *first = (skip + 1) / 2;
    *end = (skip + fine - 1) / 2 + 1;
    if (*end > count) *end = count;
}

int bake_open_beyond(bake_own *own, const bake_texel_place *place, const bake_grid *fine,
                     ff_sheet skip, const bake_grid *coarse)
{
    ff_sheet first, end;
    uint8_t *rgb = malloc((size_t)RGB * coarse->width);
    int rc = rgb ? 0 : bake_fail("out of memory");
    shared(skip.x, fine->width, coarse->width, &first.x, &end.x);
    shared(skip.y, fine->height, coarse->height, &first.y, &end.y);
    for (uint32_t j = 0; !rc && j < coarse->height; j++) {
        int is_shared = j >= first.y && j < end.y;
        rc = own_texels(own, place, coarse, j, 0, is_shared ? first.x : coarse->width, rgb);
        if (!rc && is_shared) rc = own_texels(own, place, coarse, j, end.x, coarse->width, rgb);
    }
    free(rgb);
    return rc;
}
