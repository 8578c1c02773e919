/* Private to bake_image_*.c: an opened image and where it lies, and parts of it. */
#ifndef BAKE_IMAGE_LOCAL_H
#define BAKE_IMAGE_LOCAL_H

#include "../raster/bake_colour.h"
#include "../../../protocol/shape/ff_shape.h"
#include "bake_image.h"

typedef struct bake_picture {
    GDALDatasetH set;                               /* 8 bits a band; row 0 north */
    GDALDatasetH behind[4 + BAKE_COLOUR_VIEWS_MAX]; /* what `set` reads from: closed after it, the
                                                       last one first */
    int behind_count;
    uint32_t width, height;
    /* its edges, in samples from the ground's south-west sample */
    double west, east, south, north;
} bake_picture;

/* Opens --color and places it over the ground, through a warping VRT where needed. 0 or -1
 * (said). */
int bake_picture_open(const bake_options *options, const bake_ground *ground,
                      bake_picture *picture);
/* An open image in the ground's own plane, rows from north to south, which the picture does not
 * own. */
bake_picture bake_picture_of(const bake_ground *ground, GDALDatasetH set);
/* As bake_picture_open; sets info->texture_log2 and texture_levels. */
int bake_picture_levels(const bake_options *options, const bake_ground *ground,
                        ff_terrain_info *info, bake_picture *picture);
/* Of the nodes first..last in columns and rows, each so many samples along its side, those that the
 * picture reaches into; one, when there are none. */
void bake_picture_reach(const bake_picture *picture, double edge, ff_sheet *first, ff_sheet *last);
void bake_picture_close(bake_picture *picture);
/* Reads one row as RGBA. 0 or -1 (said). */
int bake_picture_row(const bake_picture *picture, uint32_t row, uint8_t *rgba);
/* Where a node is in grids of a byte for each: 0: it is not. */
int bake_image_has(const bake_image *image, const ff_terrain_info *info, ff_key key, ff_sheet *at);
/* The lattice over a node that is there, top row first. 0 or -1 (said). */
int bake_texture_read(const bake_image *image, const ff_terrain_info *info, ff_key key,
                      uint8_t *rgb);
/* What clients see of such a node's picture, to or from image->seen. 0 or -1 (said). */
int bake_texture_seen(const bake_image *image, const ff_terrain_info *info, ff_key key, int put,
                      uint8_t *rgb);
/* The part of the image below the node in a column and row of a level's sheet, as if it were all of
 * a terrain's only tile; black where the image shows nothing of it. 0 or -1 (said). */
int bake_image_part(const bake_picture *picture, const bake_ground *ground,
                    const ff_terrain_info *info, uint32_t level, ff_sheet node, bake_image *image);

#endif
