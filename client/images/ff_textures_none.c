/* Stands in for this folder in builds without images of the ground. */
#include "../ask/ff_intake_local.h"
#include "ff_textures.h"

const uint8_t ff_textures_built = 0;

ff_texel_look ff_textures_look(const ff_textures *textures, const ff_frame *frame,
                               const c3d_camera *camera)
{
    (void)textures, (void)frame, (void)camera;
    return (ff_texel_look){ .focal_q8 = 0 };
}

unsigned ff_textures_worn(const ff_textures *textures, const ff_tree *tree, const ff_drawn *drawn,
                          const ff_texel_look *look, ff_wear list[FF_WEAR_MAX])
{
    (void)textures, (void)tree, (void)drawn, (void)look, (void)list;
    return 0;
}

void ff_textures_lay(const ff_textures *textures, ff_key node, ff_key image, c3d_draw *draw)
{
    (void)textures, (void)node, (void)image, (void)draw;
}

size_t ff_held_pictures_bytes(unsigned log2, unsigned decoded, size_t coded)
{
    (void)log2, (void)decoded, (void)coded;
    return 0;
}

void ff_held_pictures_init(ff_held_pictures *pictures, unsigned log2, unsigned decoded,
                           size_t coded, void *memory)
{
    (void)pictures, (void)log2, (void)decoded, (void)coded, (void)memory;
}

int ff_textures_is_worn(const ff_textures *textures, ff_key image)
{
    (void)textures, (void)image;
    return 0;
}

uint32_t ff_textures_wishes(ff_textures *textures, const ff_tree *tree, const ff_drawn *drawn,
                            uint32_t drawn_count, const ff_view *view, const ff_quality *quality,
                            ff_texture_wish *list, uint32_t capacity, int *changed)
{
    (void)textures, (void)tree, (void)drawn, (void)drawn_count, (void)view, (void)quality,
        (void)list, (void)capacity, (void)changed;
    return 0;
}

void ff_textures_set_layer(ff_textures *textures, uint8_t layer) { textures->layer = layer; }

void ff_textures_doubt(ff_textures *textures) { (void)textures; }

int ff_textures_take(ff_textures *textures, const ff_terrain_info *info, ff_new_item *item)
{
    (void)textures, (void)info, (void)item;
    return 0;
}

/* Never asked for. */
int ff_intake_texture(ff_intake *intake, const ff_message *answer, ff_new_item *item)
{
    (void)intake, (void)answer, (void)item;
    return FF_ERR_UNSUPPORTED;
}
