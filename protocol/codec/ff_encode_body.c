/* Payloads of head and body (ff_body.h), the encoder's side, for tools. */
#ifdef FF_ENCODER

#include "ff_body.h"

#include <string.h>

static uint32_t packed_width(const int32_t *value, uint32_t count)
{
    uint32_t all = 0, width = 0;

    for (uint32_t i = 0; i < count; i++) all |= ff_zigzag(value[i]);
    while (all >> width) width++;
    FF_ASSERT(width <= FF_WIDTH_MAX);
    return width;
}

/* The lowest `width` bits of every value. */
static void put_low(const int32_t *value, uint32_t count, uint32_t width, uint8_t *out)
{
    uint32_t bits = 0, held = 0, mask = (1u << width) - 1;
    uint8_t *at = out;

    for (uint32_t i = 0; i < count; i++) {
        bits |= (ff_zigzag(value[i]) & mask) << held;
        for (held += width; held >= 8; held -= 8, bits >>= 8) *at++ = (uint8_t)bits;
    }
    FF_ASSERT((size_t)(at - out) + (held > 0) == ff_packed_bytes(count, width));
    if (held > 0) *at = (uint8_t)bits;
}

/* High parts in unary, as the decoder's take_unary reads them; bytes written, or (`out` NULL) what
 * they would be. */
static size_t put_unary(const int32_t *value, uint32_t count, uint32_t low, uint8_t *out)
{
    size_t bit = 0;

    FF_ASSERT(low < FF_WIDTH_MAX);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t high = ff_zigzag(value[i]) >> low;
        for (uint32_t one = 0; out && one <= high; one++) {
            size_t at = bit + one;
            if (at % 8 == 0) out[at / 8] = 0;
            out[at / 8] |= (uint8_t)((one < high) << at % 8);
        }
        bit += high + 1;
    }
    return (bit + 7) / 8;
}

/* Deflates the parts of all values above their lowest `low` bits. Bytes in `out`, or 0 when not
 * fewer than `limit`. */
static size_t put_high(const ff_terrain_info *info, ff_put_high_fn *deflated, const int32_t *value,
                       uint32_t count, uint32_t low, uint8_t *out, size_t limit)
{
    uint8_t plane[FF_REFINED_HEIGHTS_MAX];

    FF_ASSERT(count <= sizeof(plane));
    for (uint32_t i = 0; i < count; i++) {
        FF_ASSERT(ff_zigzag(value[i]) >> low <= UINT8_MAX);
        plane[i] = (uint8_t)(ff_zigzag(value[i]) >> low);
    }
    return deflated(info, plane, count, out, limit);
}

/* The form of a body, as chosen: its kind, low bits and bytes in all. */
typedef struct body_form {
    enum ff_body kind;
    uint32_t low;
    size_t bytes;
} body_form;

static body_form cheapest_plain_form(const int32_t *value, uint32_t count, uint32_t width)
{
    body_form best = { FF_BODY_PACKED, width, ff_packed_bytes(count, width) };

    for (uint32_t low = 0; low < width; low++) {
        size_t bytes = ff_packed_bytes(count, low) + put_unary(value, count, low, NULL);
        if (bytes < best.bytes) best = (body_form){ FF_BODY_UNARY, low, bytes };
    }
    return best;
}

/* Tries all forms, and where to cut the values into low bits and high parts. Bytes of the values;
 * their form goes into *head. */
static size_t put_values(const ff_terrain_info *info, ff_put_high_fn *deflated,
                         const int32_t *value, uint32_t count, uint8_t *head, uint8_t *out)
{
    uint32_t width = packed_width(value, count);
    uint8_t high[2 * FF_REFINED_HEIGHTS_MAX];
    body_form best = cheapest_plain_form(value, count, width);

    FF_ASSERT(best.bytes <= 2 * (size_t)count);
    if (width == 0) return 0;
    for (uint32_t low = width > 8 ? width - 8 : 0; deflated && low < width; low++) {
        size_t low_bytes = ff_packed_bytes(count, low);
        size_t bytes = low_bytes >= best.bytes ? 0
                                               : put_high(info, deflated, value, count, low, high,
                                                          best.bytes - low_bytes);
        if (bytes > 0) {
            FF_ASSERT(bytes <= sizeof(high) && low_bytes + bytes < best.bytes);
            memcpy(out + low_bytes, high, bytes);
            best = (body_form){ FF_BODY_DEFLATE, low, low_bytes + bytes };
        }
    }
    FF_ASSERT(best.low < FF_WIDTH_MAX || best.kind == FF_BODY_PACKED);
    put_low(value, count, best.low, out);
    if (best.kind == FF_BODY_UNARY)
        put_unary(value, count, best.low, out + ff_packed_bytes(count, best.low));
    *head |= (uint8_t)(best.kind | (best.kind == FF_BODY_PACKED ? best.low - 1 : best.low)
                                       << FF_HEAD_DETAIL_SHIFT);
    return best.bytes;
}

enum ff_errors_form ff_errors_form_of(const ff_residuals *res, uint32_t errors)
{
    const uint8_t *error = res->child_error;
    int same = 1;

    for (uint32_t i = 1; i < errors; i++) same &= error[i] == error[0];
    if (!same) return FF_ERRORS_EACH;
    if (error[0] > 0 || res->filled || res->stub) return FF_ERRORS_SAME;
    if (!res->leaf) return FF_ERRORS_ZERO;
    return res->leaf == (1u << errors) - 1 ? FF_ERRORS_LEAF : FF_ERRORS_SAME;
}

size_t ff_put_body(const ff_terrain_info *info, const ff_contents *contents,
                   const ff_residuals *res, ff_put_high_fn *deflated, uint8_t *out)
{
    enum ff_errors_form form = ff_errors_form_of(res, contents->errors);
    uint32_t corners = contents->corners;
    size_t bytes = 1;

    FF_ASSERT(corners <= contents->count && contents->count <= FF_REFINED_HEIGHTS_MAX);
    out[0] = (uint8_t)(form << FF_HEAD_ERRORS_SHIFT);
    bytes += ff_put_errors(res, form, contents->errors, out + bytes);
    bytes += ff_put_words(res->value, corners, out + bytes);
    return bytes + put_values(info, deflated, res->value + corners, contents->count - corners, out,
                              out + bytes);
}

#else
typedef int ff_encode_body_not_built; /* ISO C wants a declaration in every file */
#endif
