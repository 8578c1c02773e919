/* Payloads of codec trained without some of their sides: stored bits put together anew. */
#include "ff_trained.h"

#include <string.h>

/* Numbers of bits, and the sides that have so many. */
static int take_lengths(const ff_terrain_info *info, ff_tail *tail, uint32_t length[FF_SIDE_COUNT],
                        uint32_t *sum)
{
    *sum = 0;
    for (unsigned side = 0; side < FF_SIDE_COUNT; side++) {
        length[side] = ff_tail_number(tail, ff_trained_length_order(info));
        if (length[side] > ff_trained_side_bits(info)) return FF_ERR_FORMAT;
        *sum += length[side];
    }
    return tail->at + *sum > 8 * tail->count ? FF_ERR_TRUNCATED : FF_OK;
}

int ff_trained_pass_sides(const ff_terrain_info *info, ff_tail *tail)
{
    uint32_t length[FF_SIDE_COUNT], sum;
    int rc = take_lengths(info, tail, length, &sum);
    if (rc == FF_OK) tail->at += sum;
    return rc;
}

int ff_trained_without_sides(const ff_terrain_info *info, const uint8_t *payload, size_t bytes,
                             unsigned sides, uint8_t *out)
{
    ff_residuals head = { 0 };
    ff_tail tail = { payload, (uint32_t)bytes, 0 };
    ff_bits bits = { 0 };
    uint32_t length[FF_SIDE_COUNT], sum;
    uint8_t last;
    FF_ASSERT(sides >> FF_SIDE_COUNT == 0);
    if (bytes < 1) return FF_ERR_TRUNCATED;
    if (bytes > FF_PAYLOAD_BYTES_MAX) return FF_ERR_FORMAT;
    int rc = ff_trained_take_head(info, 0, &tail, &head);
    if (rc != FF_OK) return rc;
    if (head.apart != FF_SIDES_MEASURED) return 0;
    rc = take_lengths(info, &tail, length, &sum);
    if (rc != FF_OK) return rc;
    head.apart = FF_SIDES_BARE;
    head.sides = (uint8_t)sides;
    ff_trained_put_head(info, 0, &head, &bits);
    for (unsigned side = 0; side < FF_SIDE_COUNT; side++) {
        if (sides >> side & 1u)
            tail.at += length[side];
        else
            ff_bits_copy(&bits, &tail, length[side]);
    }
    uint32_t stream = ff_tail_before(&tail, &last);
    memcpy(out, payload, stream);
    if (stream > 0) out[stream - 1] = last;
    return (int)ff_bits_join(&bits, out, ff_stream_bits(payload, stream, last));
}
