/* What a terrain is: sizes and units, as written in a pack's header and in the WELCOME message.
 *
 * World axes: x east, y north, z up; the south-west sample of the terrain lies at x = y = 0. World
 * unit (wu): 1/256 metre, and only FF_WU_PER_METRE says so: lengths that are meant in metres are
 * written with it. Positions are int32_t wu (+-8388 km), differences of positions are int64_t wu.
 * Where a sample lies, and which nodes touch, is asked in shape/ff_shape.h; lengths of edges and
 * cells below are for measures. Heights: uint16_t steps; z_wu = hoffset_wu + (h * hscale_q24 >>
 * 16), with hscale_q24 in metres a step, Q24. Grids of heights are stored row by row from south to
 * north, each row from west to east.
 */
#ifndef FF_TERRAIN_H
#define FF_TERRAIN_H

#include "ff_key.h"

#include <stdint.h>

#define FF_WU_PER_METRE  256
#define FF_NODE_LOG2_MAX 5
#define FF_TILE_LOG2_MAX 20

FF_STATIC_ASSERT(FF_TILE_LOG2_MAX == FF_NODE_LOG2_MAX + FF_KEY_LEVEL_MAX);

enum ff_terrain_flags {
    FF_TERRAIN_DENSIFIED = 1, /* part of the detail is invented (farfield-bake --densify) */
    FF_TERRAIN_LOSSY = 2,     /* max_error > 0 */
    FF_TERRAIN_PICTURES = 4   /* its images are pictures (picture/ff_picture.h), not JPEGs */
};

#define FF_TERRAIN_FLAGS (FF_TERRAIN_DENSIFIED | FF_TERRAIN_LOSSY | FF_TERRAIN_PICTURES)

typedef struct ff_terrain_info {
    uint8_t node_log2; /* k: a node holds (2^k+1)^2 heights; 1..5 */
    uint8_t tile_log2; /* n: a tile holds (2^n+1)^2 heights; k..k+15 */
    uint8_t codec;     /* enum ff_codec_id, codec/ff_codec_list.h */
    uint8_t flags;     /* enum ff_terrain_flags */
    /* a texture holds (2^t)^2 texels, t 4..8; 0: the terrain has no images */
    uint8_t texture_log2;
    uint8_t texture_levels;          /* levels 0..texture_levels-1 carry textures */
    uint16_t height_min, height_max; /* of the source, in height steps */
    /* no decoded height is further from its source than this, in height steps */
    uint16_t max_error;
    uint32_t tiles_x, tiles_y; /* at least 1 each, product at most FF_KEY_TILES_MAX */
    /* samples of the source, at least 2 each; tiles reach beyond them and repeat the last row and
     * column there */
    uint32_t samples_x, samples_y;
    uint32_t spacing_wu; /* between neighbouring samples of the finest level; at least 1 */
    uint32_t hscale_q24; /* metres a height step, Q24; at least 1 */
    int32_t hoffset_wu;  /* z of height step 0 */
    int32_t epsg;        /* coordinate reference of the origin below; 0: none */
    int64_t origin_x_mm, origin_y_mm; /* where x = y = 0 lies in that reference, millimetres */
    /* How the ground falls away: at a distance of d wu it lies d * d * curve_q60 / 2^60 wu lower
     * than on a plane, (1 - refraction) / (2 radius). 0: flat. At most 2^31: a radius of 262 km. */
    uint32_t curve_q60;
    /* of the pack's contents: a client knows by it whether its cache is of this pack */
    uint32_t checksum;
    /* What follows is in no pack and no message, and 0 but for grounds that are held together
     * (ff_tree.h): the number of the ground's first tile among those of all of them, as keys name
     * it, and where its south-west sample lies in the axes of the first one. */
    uint32_t first_tile;
    int32_t west_wu, south_wu;
    /* In no pack either: how many levels of it above these tiles are left out (ff_entry.h). Where
     * some are, roots are coded exactly, whatever max_error is. */
    uint8_t entered;
    /* Nor this: levels 0..images_whole-1 have an image wherever there is ground, as its server
     * says; 0: nobody says so. */
    uint8_t images_whole;
} ff_terrain_info;

/* Columns and rows of cells of a payload's grid that have ground, from the south-west: of a node's
 * grid for a root, of its children's for a refinement; the last ones may end inside their cell
 * (ff_shape_cells). 0: all of the grid. Samples beyond repeat the last ones, and are not coded. */
typedef struct ff_cells {
    uint8_t columns, rows;
} ff_cells;

#define FF_CURVE_MAX (UINT32_C(1) << 31)

/* 0 when every field is in range and the terrain's far corner fits int32_t wu; else a negative
 * ff_error. */
int ff_terrain_check(const ff_terrain_info *info);

/* 1 when it is the same ground, sample for sample: what is held of it stays valid. */
int ff_terrain_same(const ff_terrain_info *a, const ff_terrain_info *b);

/* Number of levels of every tile: n - k + 1. */
static inline uint32_t ff_terrain_levels(const ff_terrain_info *info)
{
    FF_ASSERT(info->node_log2 <= info->tile_log2 &&
              info->tile_log2 - info->node_log2 <= (int)FF_KEY_LEVEL_MAX);
    return (uint32_t)info->tile_log2 - info->node_log2 + 1u;
}
/* Heights along a node's side: 2^k + 1; along the grid of its four children: 2^(k+1) + 1. */
static inline uint32_t ff_node_side(const ff_terrain_info *info)
{
    FF_ASSERT(info->node_log2 >= 1 && info->node_log2 <= FF_NODE_LOG2_MAX);
    return (1u << info->node_log2) + 1u;
}
static inline uint32_t ff_refined_side(const ff_terrain_info *info)
{
    FF_ASSERT(info->node_log2 >= 1 && info->node_log2 <= FF_NODE_LOG2_MAX);
    return (2u << info->node_log2) + 1u;
}
/* Edge of a node and of one of its cells at a level, in wu: nominal, what a measure reckons with.
 */
static inline int32_t ff_node_edge_wu(const ff_terrain_info *info, uint32_t level)
{
    FF_ASSERT(level <= info->tile_log2 &&
              (uint64_t)info->spacing_wu << (info->tile_log2 - level) <= INT32_MAX);
    return (int32_t)(info->spacing_wu << (info->tile_log2 - level));
}
static inline int32_t ff_node_cell_wu(const ff_terrain_info *info, uint32_t level)
{
    FF_ASSERT(level < ff_terrain_levels(info));
    return (int32_t)(info->spacing_wu << (info->tile_log2 - info->node_log2 - level));
}
static inline int32_t ff_height_wu(const ff_terrain_info *info, uint32_t h)
{
    FF_ASSERT(h <= UINT16_MAX && info->hscale_q24 <= INT32_MAX);
    return info->hoffset_wu + (int32_t)(((uint64_t)h * info->hscale_q24) >> 16);
}
/* A length in height steps (an error, say) as wu. */
static inline int32_t ff_steps_wu(const ff_terrain_info *info, uint32_t steps)
{
    FF_ASSERT(steps <= UINT16_MAX + 1 && info->hscale_q24 <= INT32_MAX);
    return (int32_t)(((uint64_t)steps * info->hscale_q24) >> 16);
}
/* z of the lowest and highest ground a decoder may show, as z of a height goes. */
static inline void ff_terrain_range_wu(const ff_terrain_info *info, int64_t height_wu[2])
{
    int64_t slack = ff_steps_wu(info, info->max_error);
    height_wu[0] = ff_height_wu(info, info->height_min) - slack;
    height_wu[1] = ff_height_wu(info, info->height_max) + slack;
    FF_ASSERT(height_wu[0] <= height_wu[1]);
}
/* 1 when it is the same ground apart from what is stored of it: whole packs of the same bake, or
 * parts of one, whose `whole` is the checksum of the whole one. Then a key means the same node, and
 * payloads go together. */
static inline int ff_terrain_same_ground(const ff_terrain_info *a, uint32_t a_whole,
                                         const ff_terrain_info *b, uint32_t b_whole)
{
    ff_terrain_info other = *b;
    other.checksum = a->checksum;
    return a_whole == b_whole && ff_terrain_same(a, &other);
}

/* Gives `info` its place among grounds that are held together: behind those up to `last`, in the
 * axes of `first`, by its origin in their reference system. FF_OK, or FF_ERR_UNSUPPORTED: they have
 * no system in common, or nodes of other sizes; FF_ERR_RANGE: too far away, or too many tiles. */
int ff_terrain_join(ff_terrain_info *info, const ff_terrain_info *first,
                    const ff_terrain_info *last);

/* 1 when `key` names a node of this terrain; the same of its images, whose tree has a depth of its
 * own. */
int ff_terrain_has_node(const ff_terrain_info *info, ff_key key);
int ff_terrain_has_image(const ff_terrain_info *info, ff_key key);

/* An image is at most so many levels finer than the node that wears it: it lies on two cells or
 * more each way, and eight of them lie on a node's side at most. */
#define FF_IMAGE_DEPTH_MAX 3
static inline uint32_t ff_image_depth(unsigned node_log2)
{
    return node_log2 - 1 < FF_IMAGE_DEPTH_MAX ? node_log2 - 1 : FF_IMAGE_DEPTH_MAX;
}
/* So many levels of images can be seen of a terrain; packs are made with no more. */
static inline uint32_t ff_image_levels(const ff_terrain_info *info)
{
    uint32_t levels = ff_terrain_levels(info) + ff_image_depth(info->node_log2);
    return levels < FF_KEY_LEVEL_MAX + 1 ? levels : FF_KEY_LEVEL_MAX + 1;
}

/* Has `info` show so many levels of images like those of `told`; 0: none. */
static inline void ff_terrain_show_images(ff_terrain_info *info, const ff_terrain_info *told,
                                          uint32_t levels)
{
    unsigned pictures = levels ? told->flags & FF_TERRAIN_PICTURES : 0u;
    FF_ASSERT(levels <= FF_KEY_LEVEL_MAX + 1);
    info->texture_log2 = levels ? told->texture_log2 : 0;
    info->texture_levels = (uint8_t)levels;
    info->flags = (uint8_t)((info->flags & ~(unsigned)FF_TERRAIN_PICTURES) | pictures);
}

/* The key, among grounds held together, of a node that has the key `own` in its pack and in
 * messages; and back. */
static inline ff_key ff_terrain_key(const ff_terrain_info *info, ff_key own)
{
    return own + ((ff_key)info->first_tile << FF_KEY_TILE_SHIFT);
}
static inline ff_key ff_terrain_own_key(const ff_terrain_info *info, ff_key key)
{
    FF_ASSERT(ff_terrain_has_node(info, key) || ff_terrain_has_image(info, key));
    return key - ((ff_key)info->first_tile << FF_KEY_TILE_SHIFT);
}

#endif
