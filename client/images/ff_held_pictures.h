/* Pictures as they came, and some as they were decoded.
 *
 * A picture is a difference to its parent's, which is needed again for each of its children. What
 * came takes a thirtieth of what it becomes, so that is kept of all, one behind the other, and the
 * few decoded lately, RGB888; others are decoded once more, from the nearest of those down. */
#ifndef FF_HELD_PICTURES_H
#define FF_HELD_PICTURES_H

#include "../../protocol/ff_terrain.h"
#include "../../protocol/picture/ff_picture.h"

#define FF_DECODED_MIN 4u /* a picture, its parent's, one spare, and one more */
#define FF_DECODED_MAX 64u

/* Where one is in the memory of all. 0 bytes: nowhere. */
typedef struct ff_coded {
    uint32_t at, bytes;
} ff_coded;

typedef struct ff_held_pictures {
    uint8_t *coded; /* NULL: none are kept */
    uint32_t coded_size, coded_used;
    uint8_t *rgb; /* decoded_count places */
    unsigned decoded_count;
    ff_picture_room *room;
    ff_key key[FF_DECODED_MAX]; /* of each place; FF_KEY_NONE: free */
    uint32_t used[FF_DECODED_MAX], stamp;
    uint32_t decodes;
} ff_held_pictures;

/* Finds what is kept of a picture; 0 bytes: nothing. */
typedef ff_coded ff_find_coded(const void *context, ff_key key);

/* Bytes of the memory for so many places, and so many bytes of what came. */
size_t ff_held_pictures_bytes(unsigned log2, unsigned decoded, size_t coded);
void ff_held_pictures_init(ff_held_pictures *pictures, unsigned log2, unsigned decoded,
                           size_t coded, void *memory);
/* Puts what came behind the others. The owner has seen that there is room. */
ff_coded ff_held_pictures_add(ff_held_pictures *pictures, const uint8_t *bytes, uint32_t count);
/* Takes one out: those behind it move up by its bytes (the owner tells them). */
void ff_held_pictures_cut(ff_held_pictures *pictures, ff_key key, ff_coded coded);
/* Keys mean other pictures from now on: none counts as decoded. */
void ff_held_pictures_forget(ff_held_pictures *pictures);
/* A picture, of which and of all above it what came is kept: RGB888, north row first, until the
 * next call; info: of its ground. NULL: *error says why. */
const uint8_t *ff_held_pictures_get(ff_held_pictures *pictures, const ff_terrain_info *info,
                                    ff_key key, ff_find_coded *find, const void *context,
                                    int *error);

#endif
