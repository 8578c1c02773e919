/* Private to codecs rice and deflate: a payload of head, error codes, corners and body (SPEC.md,
 * "Payload, codec 1 and 2"). */
#ifndef FF_BODY_H
#define FF_BODY_H

#include "ff_codec_local.h"

#define FF_HEAD_BODY         0x03u /* enum ff_body */
#define FF_HEAD_ERRORS       0x0cu /* enum ff_errors_form */
#define FF_HEAD_ERRORS_SHIFT 2
/* From this bit on, the head says how many low bits of every value are stored plainly (for
 * FF_BODY_PACKED that number less one). */
#define FF_HEAD_DETAIL_SHIFT 4
#define FF_WIDTH_MAX         16 /* bits of the widest value of a body */

enum ff_body { FF_BODY_ZERO, FF_BODY_PACKED, FF_BODY_DEFLATE, FF_BODY_UNARY };

FF_STATIC_ASSERT(FF_BODY_UNARY <= FF_HEAD_BODY &&
                 FF_ERRORS_LEAF <= FF_HEAD_ERRORS >> FF_HEAD_ERRORS_SHIFT);
FF_STATIC_ASSERT((FF_HEAD_BODY | FF_HEAD_ERRORS) == (1u << FF_HEAD_DETAIL_SHIFT) - 1);
/* A body of form PACKED, whose head says one less, may have all bits. */
FF_STATIC_ASSERT((UINT8_MAX >> FF_HEAD_DETAIL_SHIFT) + 1 == FF_WIDTH_MAX);

/* Bytes of `count` values of `bits` bits each, packed. */
static inline size_t ff_packed_bytes(uint32_t count, uint32_t bits)
{
    FF_ASSERT(count <= FF_REFINED_HEIGHTS_MAX && bits <= FF_WIDTH_MAX);
    return ((size_t)count * bits + 7) / 8;
}

/* High parts of a body of form DEFLATE: all that is left of the payload, shifted by `width` into
 * the values. */
typedef int ff_take_high_fn(const ff_decoder *dec, ff_payload *in, uint32_t width, int32_t *value,
                            uint32_t count);
/* `deflated` NULL: the codec has no such form, and refuses it. */
int ff_take_body(const ff_decoder *dec, ff_payload *in, const ff_contents *contents,
                 ff_take_high_fn *deflated, ff_residuals *out);

/* Encoder: high parts, one byte a value, in fewer than `limit` bytes. Bytes in `out`, or 0: not
 * fewer. */
typedef size_t ff_put_high_fn(const ff_terrain_info *info, const uint8_t *high, uint32_t count,
                              uint8_t *out, size_t limit);
/* The shortest of all forms that the codec has. Bytes written. */
size_t ff_put_body(const ff_terrain_info *info, const ff_contents *contents,
                   const ff_residuals *res, ff_put_high_fn *deflated, uint8_t *out);

#endif
