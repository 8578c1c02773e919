/* Colour of the ground: an image of any resolution becomes lattices of texels, one per texture
 * level.
 *
 * A node's texture has T = 2^t texels a side, the outermost on the node's very edges, so that
 * neighbours share them and bilinear filtering shows no seam. All texels of a level therefore form
 * one lattice of 2^l * (T-1) * tiles + 1 texels; each coarser lattice is every second point of the
 * finer one, weighted 1-2-1. Points beyond the ground repeat its rim. Images that would show no
 * more than one above them are left out (bake_bare.h), and those of ground that the image does not
 * cover (bake_open.h).
 */
#ifndef BAKE_IMAGE_H
#define BAKE_IMAGE_H

#include "../../../protocol/ff_terrain.h"
#include "../bake_blob.h"
#include "../bake_samples.h"
#include "../raster/bake_source.h"

#define BAKE_TEXTURE_LEVELS_MAX 16

typedef struct bake_image {
    bake_grid lattice[BAKE_TEXTURE_LEVELS_MAX]; /* RGB, rows south to north */
    /* the node of each level in the south-west corner of what the lattice and the grids below are
     * of: all of the ground, or the nodes that an image of a part of it reaches into */
    ff_sheet first[BAKE_TEXTURE_LEVELS_MAX];
    uint32_t levels;
    /* of all levels but the last, a byte for each node: which children have no image (bake_bare.h)
     */
    bake_grid bare[BAKE_TEXTURE_LEVELS_MAX];
    int has_bare; /* 0: all nodes with ground have one, and `bare` is not looked at */
    /* of all levels, a byte for each node: 1 when the image covers nothing of it (bake_open.h) */
    bake_grid open[BAKE_TEXTURE_LEVELS_MAX];
    int has_open; /* 0: it covers some of every node; 1: and nothing of those not here */
    /* of pictures, of all levels but the last: what clients see of each node's, RGB, top row first;
     * those below are differences to it */
    bake_grid seen[BAKE_TEXTURE_LEVELS_MAX];
} bake_image;

/* Reads the image of `options` onto the ground; sets info->texture_log2 and texture_levels. Where
 * it does not cover the ground its texels have the colours that `heights` have without an image. 0
 * or -1 (said). */
int bake_image_make(const bake_options *options, const bake_ground *ground,
                    const bake_samples *heights, ff_terrain_info *info, bake_image *image);
/* The same of an image that lies in the ground's own plane, its rows from north to south: `set`
 * stays open. */
int bake_image_lay(const bake_options *options, GDALDatasetH set, const bake_ground *ground,
                   const bake_samples *heights, ff_terrain_info *info, bake_image *image);
void bake_image_close(bake_image *image);

/* Appends the images of all nodes so many levels below a node, in Morton order, to `blob`, after
 * bake_bare_find. May run in several threads. 0 or -1 (said). */
int bake_texture_encode(const bake_image *image, const ff_terrain_info *info, int quality,
                        ff_key node, uint32_t below, bake_blob *blob);

#endif
