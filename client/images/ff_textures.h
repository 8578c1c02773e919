/* Images of the ground: a tree of its own depth, which differs from place to place, over the same
 * keys (Planet: linked height and texture trees). What is drawn of it is told by the size of texels
 * in the picture (ff_wear.h), as far as it is held. The image used least lately makes room. A
 * client's images come over the link from coarse to fine (wishes, take), those of the server's
 * renderer from the pack (touch, put).
 *
 * The owner zeroes the cache and sets the first part; the slots are the owner's memory. */
#ifndef FF_TEXTURES_H
#define FF_TEXTURES_H

#include "../ask/ff_new_data.h"
#include "ff_held_pictures.h"
#include "ff_wear.h"

/* Room for what came of a picture, 1/4 of a byte a texel: as many as the device holds, for each. */
#define FF_CODED_BYTES(log2) ((1u << 2 * (log2)) / 4)

extern const uint8_t ff_textures_built; /* 0: left out of this build */

#define FF_TEXTURE_HASH 256u
#define FF_TEXEL_PX_Q8  362 /* sqrt 2: texels are as large as pixels, as a mean of levels */

typedef struct ff_texture_slot {
    ff_key key;
    c3d_texture texture; /* id 0: not on the device */
    ff_coded coded;      /* of pictures */
    uint32_t used;       /* stamp of the last frame it, or one below it, was of use in */
    uint32_t drawn;      /* and was drawn in */
    uint16_t next;       /* hash chain: slot + 1 */
    uint8_t tag;         /* 1 + the layer it is of; 0: the slot is free */
    ff_image_marks marks;
} ff_texture_slot;

typedef struct ff_textures {
    c3d_device *device;
    ff_terrain_info info;
    ff_texture_slot *slot; /* zeroed */
    uint16_t slot_count;
    uint16_t texture_count; /* that the device has room for */
    int32_t texel_px_q8;    /* the least of ff_texel_look */
    uint8_t across;         /* of ff_texel_look */
    uint8_t layer;          /* that is shown: ff_textures_set_layer */
    /* Where pictures are to be drawn: those that are held, on the device or not; and texels of one
     * image, on their way to the device. */
    ff_held_pictures pictures;
    uint16_t *texels;
    ff_wear *wear; /* scratch, FF_WEAR_MAX, of wishes */

    uint16_t held, high, made, made_high; /* made: on the device */
    uint8_t waits; /* 1: something held is to be drawn and not on the device yet */
    uint16_t bucket[FF_TEXTURE_HASH]; /* slot + 1 */
    uint32_t stamp, full, apart;      /* apart: pictures whose parent's was not held */
    uint32_t lacking; /* drawn nodes whose own image is not held, though it is there */
} ff_textures;

/* A wish for an image: one that lacks on the way down to what a drawn node wants. */
typedef struct ff_texture_wish {
    ff_key key;
    uint32_t priority;
} ff_texture_wish;

/* How a camera looks at images: texels as large as pixels, or so much larger that what a picture of
 * its size shows finds room. */
ff_texel_look ff_textures_look(const ff_textures *textures, const ff_frame *frame,
                               const c3d_camera *camera);
/* Lists what a drawn node would wear if all images were held (ff_wear_list); nodes of grounds whose
 * images have another size wear none. */
unsigned ff_textures_wanted(const ff_textures *textures, const ff_tree *tree, const ff_drawn *drawn,
                            const ff_texel_look *look, ff_wear list[FF_WEAR_MAX]);
/* Lists what a drawn node wears of the images that are held: on each of its squares the one that is
 * wanted there, or the nearest above that; FF_KEY_NONE, in the last place: none is held, or the
 * images end there. How many; 0: no images belong to its ground. */
unsigned ff_textures_worn(const ff_textures *textures, const ff_tree *tree, const ff_drawn *drawn,
                          const ff_texel_look *look, ff_wear list[FF_WEAR_MAX]);
/* Lays such an image over `node` on the call that draws it, in place of colours; without one the
 * call stays as it is. */
void ff_textures_lay(const ff_textures *textures, ff_key node, ff_key image, c3d_draw *draw);
/* Marks what the drawn nodes of the tree use and lists what they lack, most urgent first;
 * priorities are on the tree's scale. Puts a picture that is held on the device, if one is wanted
 * that is not there: *changed. */
uint32_t ff_textures_wishes(ff_textures *textures, const ff_tree *tree, const ff_drawn *drawn,
                            uint32_t drawn_count, const ff_view *view, const ff_quality *quality,
                            ff_texture_wish *list, uint32_t capacity, int *changed);
/* Takes an image in, RGB565, south row first; NULL: there is none, and ground below `key` shows its
 * colours. 1 when the picture may have changed; 0: no room (counted). */
int ff_textures_put(ff_textures *textures, ff_key key, ff_image_marks marks,
                    const uint16_t *texels);
/* The same, for an item of the new-data list, of a key of the ground `info`. A picture whose
 * parent's is not held is not taken, a damaged one makes the item an error. */
int ff_textures_take(ff_textures *textures, const ff_terrain_info *info, ff_new_item *item);
/* 1 when the last wishes were made for a picture that shows this image. */
int ff_textures_is_worn(const ff_textures *textures, ff_key image);
/* A picture that is held, as it was decoded: ff_held_pictures_get. */
const uint8_t *ff_textures_picture(ff_textures *textures, const ff_terrain_info *info, ff_key key,
                                   int *error);
/* Shows images of another layer. Those of the one before stay, as those not in use do, until there
 * is no room for them: who comes back to it soon finds them. */
void ff_textures_set_layer(ff_textures *textures, uint8_t layer);
#define FF_LAYER_TAG_NONE 254u
/* Somebody else may have images where those that are held say that there are none. */
void ff_textures_doubt(ff_textures *textures);
/* For an owner whose images come at once (a pack): 1 when this image is held; it is then the last
 * to make room. */
int ff_textures_touch(ff_textures *textures, ff_key key);

#endif
