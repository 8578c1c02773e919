/* A node's image as it is stored and sent (protocol/SPEC.md, "Images"): a picture or a bare JPEG,
 * as the terrain says, and before it, where children of the node have no image of their own, a byte
 * that says which. */
#ifndef FF_IMAGE_H
#define FF_IMAGE_H

#include "ff_error.h"

#include <stddef.h>
#include <stdint.h>

#define FF_IMAGE_BARE 128u /* and the bits; the first byte of what is coded is 100 at most */

typedef struct ff_image {
    const uint8_t *coded;
    size_t coded_bytes;
    uint8_t bare; /* bit q: child q, and all below it, shows this image: there is no finer one */
} ff_image;

/* FF_OK or FF_ERR_TRUNCATED; what is coded is not looked at. */
static inline int ff_image_read(const uint8_t *payload, size_t bytes, ff_image *image)
{
    size_t mark = bytes > 0 && *payload > FF_IMAGE_BARE && *payload <= FF_IMAGE_BARE + 15;
    if (bytes <= mark) return FF_ERR_TRUNCATED;
    image->coded = payload + mark;
    image->coded_bytes = bytes - mark;
    image->bare = mark ? *payload & 15u : 0;
    return FF_OK;
}

#endif
