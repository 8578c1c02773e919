/* Payloads of head and body, the decoder's side. */
#include "ff_body.h"

/* Low parts: `width` bits of every value, packed low bit first. */
static int take_low(ff_payload *in, uint32_t width, int32_t *value, uint32_t count)
{
    uint32_t bits = 0, held = 0;

    if (ff_payload_left(in) < ff_packed_bytes(count, width)) return FF_ERR_TRUNCATED;
    for (uint32_t i = 0; i < count; i++) {
        for (; held < width; held += 8) bits |= (uint32_t)*in->at++ << held;
        value[i] = (int32_t)(bits & ((1u << width) - 1));
        bits >>= width;
        held -= width;
    }
    FF_ASSERT(held < 8); /* no byte was taken that the values do not reach */
    return FF_OK;
}

/* High parts as that many one bits and a zero bit, low bit first: with the low parts a Golomb-Rice
 * code. */
static int take_unary(ff_payload *in, uint32_t width, int32_t *value, uint32_t count)
{
    uint32_t high_max = (uint32_t)UINT16_MAX >> width, bit = 0;

    FF_ASSERT(width < FF_WIDTH_MAX);
    for (uint32_t i = 0; i < count; i++) {
        FF_ASSERT((uint32_t)value[i] >> width == 0);
        for (uint32_t high = 0, more = 1; more; high++) {
            if (in->at == in->end) return FF_ERR_TRUNCATED;
            if (high > high_max) return FF_ERR_RANGE;
            more = *in->at >> bit & 1u;
            in->at += bit == 7;
            bit = (bit + 1) & 7u;
            if (!more) value[i] |= (int32_t)(high << width);
        }
    }
    in->at += bit > 0;
    return FF_OK;
}

static int take_values(const ff_decoder *dec, ff_payload *in, uint8_t head,
                       ff_take_high_fn *deflated, int32_t *value, uint32_t count)
{
    uint32_t detail = head >> FF_HEAD_DETAIL_SHIFT, body = head & FF_HEAD_BODY;
    int rc;

    if (body == FF_BODY_ZERO && detail != 0) return FF_ERR_FORMAT;
    rc = take_low(in, body == FF_BODY_PACKED ? detail + 1 : detail, value, count);
    if (rc == FF_OK && body == FF_BODY_DEFLATE)
        rc = deflated ? deflated(dec, in, detail, value, count) : FF_ERR_FORMAT;
    if (rc == FF_OK && body == FF_BODY_UNARY) rc = take_unary(in, detail, value, count);
    for (uint32_t i = 0; rc == FF_OK && i < count; i++) value[i] = ff_unzigzag((uint32_t)value[i]);
    return rc;
}

int ff_take_body(const ff_decoder *dec, ff_payload *in, const ff_contents *contents,
                 ff_take_high_fn *deflated, ff_residuals *out)
{
    uint32_t corners = contents->corners;
    uint8_t head;
    int rc;

    FF_ASSERT(ff_payload_left(in) >= 1); /* decode() refuses an empty payload */
    FF_ASSERT(corners <= contents->count && contents->count <= FF_REFINED_HEIGHTS_MAX);
    head = *in->at++;
    rc = ff_take_errors(in, (head & FF_HEAD_ERRORS) >> FF_HEAD_ERRORS_SHIFT, contents->errors, out);
    if (rc == FF_OK) rc = ff_take_words(in, corners, out->value, corners);
    return rc == FF_OK ? take_values(dec, in, head, deflated, out->value + corners,
                                     contents->count - corners)
                       : rc;
}
