/* The ground a panorama shows: a tree fed from the pack, drawn on one 3D device as the client draws
 * its own (client/ground). Kept warm between faces. Internal to the renderer.
 */
#ifndef FF_PANORAMA_GROUND_H
#define FF_PANORAMA_GROUND_H

#include "ff_panorama_render.h"
#include "../../client/ground/ff_terrain_view.h"

#define FF_PANORAMA_NODES    4096 /* slots of the tree: bounds the renderer's memory */
#define FF_PANORAMA_WISHES   1024
#define FF_PANORAMA_TEXTURES 256

typedef struct panorama_ground {
    const ff_pack *pack;
    ff_panorama_render_stats *stats;
    c3d_device *device;
    ff_tree *tree;
    ff_decoder *decoder;
    void *tree_memory, *decoder_memory;
    int32_t values[FF_REFINED_HEIGHTS_MAX];
    ff_wish wishes[FF_PANORAMA_WISHES];
    ff_drawn seen[FF_PANORAMA_NODES]; /* of the face being drawn */
    ff_frame frame;                   /* of the face loaded last */
    int32_t position_wu[3];           /* of the face drawn last, and its frame */
    ff_frame drawn_frame;
    ff_terrain_view view;
    ff_view_node entry[FF_PANORAMA_NODES];
    c3d_vertex vertices[FF_NODE_HEIGHTS_MAX];
    ff_textures textures;
    ff_texture_slot slot[FF_PANORAMA_TEXTURES];
    uint8_t *texture_rgb; /* one decoded image, and the same as RGB565 */
    uint16_t *texture_texels;
} panorama_ground;

/* What c3d_open must provide for the ground. */
void panorama_ground_desc(const ff_pack *pack, const sys_surface_api *surface_api, c3d_desc *desc);
/* FF_OK or a negative error; the device stays the caller's. Close also after a failed open. */
int panorama_ground_open(panorama_ground *ground, const ff_pack *pack, c3d_device *device,
                         ff_panorama_render_stats *stats);
void panorama_ground_close(panorama_ground *ground);

/* Reads what the face needs, within the pool. The request's position, here and below, is a point of
 * the frame at O. */
void panorama_ground_load(panorama_ground *ground, const ff_frame *frame,
                          const ff_get_panorama *request, enum ff_face_name face);
/* 1 when the loaded ground can show in the face. */
int panorama_ground_seen(const panorama_ground *ground, const ff_get_panorama *request,
                         enum ff_face_name face);
/* Draws the loaded ground over FF_FACE_KEY. */
void panorama_ground_draw(panorama_ground *ground, const ff_get_panorama *request,
                          enum ff_face_name face);

#endif
