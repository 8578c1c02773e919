/* A pack's pictures, any of them: each with those above it, which it is a difference to. For who
 * has a whole pack at hand: servers, tools. */
#ifndef FF_PICTURE_PATH_H
#define FF_PICTURE_PATH_H

#include "../ff_pack.h"
#include "ff_picture.h"

/* The pictures from a root down to the one that was asked for last: whoever asks for neighbours one
 * after the other decodes few of them twice. The owner zeroes it but for `rgb`. */
typedef struct ff_picture_path {
    uint8_t *rgb; /* ff_picture_path_bytes() bytes */
    ff_picture_room room;
    uint32_t held; /* levels of the path */
    uint8_t layer;
    ff_key key[FF_KEY_LEVEL_MAX + 1];
} ff_picture_path;

/* For pictures of any layer. */
size_t ff_picture_path_bytes(const ff_pack *pack);
/* Of which layer they are from now on; at first those of the first one. */
void ff_picture_path_layer(ff_picture_path *path, unsigned layer);
/* A node's picture, RGB888, north row first; it stays until the next one is asked for. FF_OK, or an
 * error of ff_pack_record or of decoding. */
int ff_picture_path_get(ff_picture_path *path, const ff_pack *pack, ff_key key,
                        const uint8_t **rgb);

#endif
