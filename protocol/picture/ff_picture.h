/* Pictures: images of the ground as a difference to the image above (SPEC.md, 5.2).
 *
 * A node's picture is predicted from its parent's, as it was decoded: RGB888, north row first, like
 * all images here. What is left is coded by blocks of 8 x 8 through an integer cosine transform,
 * with one step for all levels and places, as decisions of the range coder whose probabilities were
 * learned beforehand and follow what comes (ff_picture_local.h). The outermost texels are coded
 * first, as lines, from the parent's outermost texels alone: so two neighbours have the same ones.
 */
#ifndef FF_PICTURE_H
#define FF_PICTURE_H

#include "../ff_assert.h"
#include "../ff_error.h"

#include <stddef.h>
#include <stdint.h>

#define FF_PICTURE_LOG2_MIN 4
#define FF_PICTURE_LOG2_MAX 8
#define FF_PICTURE_CONTEXTS 1632

extern const uint8_t ff_picture_built; /* 0: left out of this build */

/* What the next blocks are told by: a block's coefficients, without their signs, and how many there
 * are, of each plane. */
typedef struct ff_picture_sizes {
    uint8_t size[3][64], count[3];
} ff_picture_sizes;

/* Memory that coding takes; nothing in it outlives a picture. */
typedef struct ff_picture_room {
    uint16_t one[FF_PICTURE_CONTEXTS]; /* how likely decisions are 1, of 65536 */
    /* of the block before and of those below */
    ff_picture_sizes before, below[1 << (FF_PICTURE_LOG2_MAX - 3)];
} ff_picture_room;

/* What it is predicted from: the parent's, and which of its children it is; NULL: a root. */
typedef struct ff_picture_above {
    const uint8_t *rgb;
    unsigned quadrant;
} ff_picture_above;

/* Makes 2^log2 x 2^log2 texels. FF_OK, or an error with no texels of use; whatever the bytes are,
 * nothing is written elsewhere. */
int ff_picture_decode(const uint8_t *bytes, size_t count, unsigned log2, ff_picture_above above,
                      ff_picture_room *room, uint8_t *rgb);

/* The image of a root of an entered terrain (SPEC.md, "Entry"): the pictures above it, of as many
 * levels as are left out, and its own. `code`: of the node in the whole terrain. `spare`: as large
 * as `rgb`. */
int ff_picture_decode_row(const uint8_t *bytes, size_t count, unsigned log2, unsigned levels,
                          uint32_t code, ff_picture_room *room, uint8_t *rgb, uint8_t *spare);

/* Encoder, for tools: `source` to at most `limit` bytes; `rgb` receives what decoding makes of
 * them. Quality 1..100, as of JPEG. Bytes, or an error. */
int ff_picture_encode(const uint8_t *source, unsigned log2, ff_picture_above above,
                      unsigned quality, ff_picture_room *room, uint8_t *rgb, uint8_t *out,
                      size_t limit);

#endif
