/* A node's image as it is stored and sent (protocol/SPEC.md, "Images"): a picture or a bare JPEG,
 * as the terrain says, and before it, where children of the node have no image of their own, a byte
 * or two that say which, and what their ground shows instead. */
#ifndef FF_IMAGE_H
#define FF_IMAGE_H

#include "ff_error.h"

#include <stddef.h>
#include <stdint.h>

#define FF_IMAGE_BARE        128u /* and the bits; the first byte of what is coded is 100 at most */
#define FF_IMAGE_OPEN        144u
#define FF_IMAGE_MARKS_BYTES 2u /* at most */

/* Bit q: child q, and all below it, has no image. None is in both. */
typedef struct ff_image_marks {
    uint8_t bare : 4; /* its ground shows the image of the node */
    uint8_t open : 4; /* the image that was laid over the ground ends before it: it shows its own
                         colours. 15: and so does the node itself, which has no image but this
                         mark; only roots are such */
} ff_image_marks;

typedef struct ff_image {
    const uint8_t *coded;
    size_t coded_bytes; /* 0: open all over */
    ff_image_marks marks;
} ff_image;

/* 1 when child q has no image of its own. */
static inline int ff_image_ends(ff_image_marks marks, unsigned q)
{
    return (marks.bare | marks.open) >> q & 1;
}

/* FF_OK, FF_ERR_TRUNCATED, or FF_ERR_FORMAT: marks that cannot be; what is coded is not looked
 * at. */
static inline int ff_image_read(const uint8_t *payload, size_t bytes, ff_image *image)
{
    const uint8_t *at = payload, *end = payload + bytes;
    *image = (ff_image){ 0 };
    if (at<end && * at> FF_IMAGE_BARE && *at <= FF_IMAGE_BARE + 15) image->marks.bare = *at++ & 15;
    if (at<end && * at> FF_IMAGE_OPEN && *at <= FF_IMAGE_OPEN + 15) image->marks.open = *at++ & 15;
    image->coded = at;
    image->coded_bytes = (size_t)(end - at);
    if (image->marks.bare & image->marks.open) return FF_ERR_FORMAT;
    if (image->marks.open == 15) return at == end ? FF_OK : FF_ERR_FORMAT;
    return at == end ? FF_ERR_TRUNCATED : FF_OK;
}

/* Puts the bytes that stand before what is coded: how many. */
static inline size_t ff_image_put_marks(ff_image_marks marks, uint8_t out[FF_IMAGE_MARKS_BYTES])
{
    size_t bytes = 0;
    if (marks.bare) out[bytes++] = (uint8_t)(FF_IMAGE_BARE + marks.bare);
    if (marks.open) out[bytes++] = (uint8_t)(FF_IMAGE_OPEN + marks.open);
    return bytes;
}

#endif
