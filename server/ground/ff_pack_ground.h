/* The ground of a pack as a server draws it: a tree fed from the pack, drawn on one 3D device as
 * the client draws its own (client/ground). Kept warm between pictures. */
#ifndef FF_PACK_GROUND_H
#define FF_PACK_GROUND_H

#include "../../client/ground/ff_terrain_view.h"
#include "../../client/images/ff_pack_images.h"
#include "../../protocol/ff_pack.h"

#define FF_GROUND_NODES    4096 /* slots of the tree: bounds the memory */
#define FF_GROUND_WISHES   1024
#define FF_GROUND_TEXTURES 256

/* No image of the ground has this colour: pictures are cleared to it, and what still has it shows
 * no ground. */
#define FF_GROUND_KEY_RGB565 0xF81Fu
#define FF_GROUND_KEY_ABGR   0xFFFF00FFu

static inline uint16_t ff_ground_not_key(uint16_t rgb565)
{
    return rgb565 == FF_GROUND_KEY_RGB565 ? (uint16_t)(rgb565 | 1u << 6) : rgb565;
}

/* What is looked at, and how well. */
typedef struct ff_ground_look {
    ff_frame frame;
    c3d_camera camera; /* in the frame */
    int32_t view_wu;   /* as ff_quality has them */
    int32_t hole_wu;
    int32_t error_px_q8;
    uint8_t layer; /* of images */
    uint8_t bare;  /* 1: without images: distances are all that is wanted */
    /* 1 when a box relative to the camera can show; NULL: whatever the tree finds in view */
    int (*sees)(const void *context, const ff_box *box);
    const void *context;
} ff_ground_look;

typedef struct ff_pack_ground_stats {
    /* roots and refinements taken from the pack, damaged ones not counted */
    uint32_t nodes_read;
    uint32_t nodes_damaged; /* their ground is drawn coarser */
    uint32_t nodes_drawn;
    uint64_t triangles;
} ff_pack_ground_stats;

typedef struct ff_pack_ground {
    const ff_pack *pack;
    ff_pack_ground_stats *stats;
    c3d_device *device;
    ff_tree *tree;
    ff_decoder *decoder;
    void *tree_memory, *decoder_memory;
    int32_t values[FF_REFINED_HEIGHTS_MAX];
    ff_wish wishes[FF_GROUND_WISHES];
    ff_drawn seen[FF_GROUND_NODES]; /* of the picture being drawn */
    int32_t position_wu[3];         /* of the picture drawn last, and its frame */
    ff_frame drawn_frame;
    ff_terrain_view view;
    ff_view_node entry[FF_GROUND_NODES];
    c3d_vertex vertices[FF_NODE_HEIGHTS_MAX];
    ff_textures textures;
    ff_texture_slot slot[FF_GROUND_TEXTURES];
    ff_wear wear[FF_WEAR_MAX];
    uint16_t index[sizeof((ff_strips *)0)->index / sizeof(uint16_t)],
        part[FF_STRIPS_PART(FF_NODE_HEIGHTS_MAX)];
    ff_pack_images images;
    void *image_memory;
    uint16_t *texture_texels; /* of one decoded image */
} ff_pack_ground;

/* What c3d_open must provide for the ground. */
void ff_pack_ground_desc(const ff_pack *pack, const sys_surface_api *surface_api, c3d_desc *desc);
/* FF_OK or a negative error; the device stays the caller's. Close also after a failed open. */
int ff_pack_ground_open(ff_pack_ground *ground, const ff_pack *pack, c3d_device *device,
                        ff_pack_ground_stats *stats);
void ff_pack_ground_close(ff_pack_ground *ground);

/* Reads what the look needs, within the pool. */
void ff_pack_ground_load(ff_pack_ground *ground, const ff_ground_look *look);
/* 1 when the loaded ground can show. */
int ff_pack_ground_seen(const ff_pack_ground *ground, const ff_ground_look *look);
/* Draws the loaded ground over FF_GROUND_KEY. */
void ff_pack_ground_draw(ff_pack_ground *ground, const ff_ground_look *look);

#endif
