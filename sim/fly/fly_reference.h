/* The picture as it should be: the same view of the same packs, with no link and no panorama,
 * however long it takes.
 *
 * Ground is drawn as far as the terrain reaches (its horizon, if its shape has one), in clear air,
 * until the cells of its grid are no wider than a sample, and under the finest images whose texels
 * are not smaller than a sample. The integer back end draws it, whatever the flight's own one is,
 * at 3 x 3 samples a pixel, and a pixel is their mean. (Fewer where such a picture would pass the
 * 4096 pixels that a viewport has at most; and coarser ground where 2^20 nodes, or half a gigabyte
 * of them, are not enough.) Every picture is drawn from nothing: it does not depend on those
 * before. */
#ifndef FLY_REFERENCE_H
#define FLY_REFERENCE_H

#include "../../client/ff_sky.h"
#include "../../client/ground/ff_terrain_view.h"
#include "../../client/images/ff_pack_images.h"
#include "../../protocol/ff_pack.h"

typedef struct fly_reference {
    const ff_pack *pack; /* with those joined to it; NULL: not open */
    unsigned samples;    /* of a pixel, each way */
    uint16_t width, height;
    ff_tree_desc tree_desc;
    uint8_t holds_all; /* 1: the tree has a slot for every node of the terrain */
    c3d_desc device_desc;
    void *tree_memory, *device_memory, *decoder_memory;
    size_t tree_bytes, device_bytes;
    ff_decoder *decoder;
    int32_t values[FF_REFINED_HEIGHTS_MAX];
    ff_wish *wish;    /* being served */
    uint8_t *sampled; /* RGB888, before samples become pixels */
    ff_texture_slot *slot;
    ff_wear wear[FF_WEAR_MAX];
    uint16_t index[sizeof((ff_strips *)0)->index / sizeof(uint16_t)],
        part[FF_STRIPS_PART(FF_NODE_HEIGHTS_MAX)];
    ff_pack_images images;
    void *image_memory;
    uint16_t *image_texels; /* of one decoded image */
    /* of the picture being drawn */
    ff_view view;
    ff_tree *tree;
    c3d_device *device;
    ff_terrain_view ground;
    ff_textures textures;
    ff_sky sky;
    c3d_vertex vertices[FF_NODE_HEIGHTS_MAX];
} fly_reference;

/* FF_OK or FF_ERR_MEMORY. `pack` must outlive the reference. Call close in both cases. */
int fly_reference_open(fly_reference *reference, const ff_pack *pack, uint16_t width,
                       uint16_t height);
/* The view's picture, RGB888; camera in world axes. FF_OK, or an error of the pack or of the back
 * end. */
/* Draws images of this layer from now on. */
void fly_reference_layer(fly_reference *reference, unsigned layer);
int fly_reference_draw(fly_reference *reference, const c3d_camera *camera, uint8_t *rgb);
void fly_reference_close(fly_reference *reference);

#endif
