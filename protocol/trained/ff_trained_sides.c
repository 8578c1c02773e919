/* Payloads of codec trained without some of their sides: stored bytes put together anew. */
#include "../codec/ff_body.h"
#include "ff_trained.h"

#include <string.h>

/* What stands behind the head: error codes and marks; then lengths, sides and the rest. */
typedef struct parts {
    const uint8_t *errors, *sides;
    uint8_t length[FF_SIDE_COUNT];
    ff_payload rest;
} parts;

static int take_parts(const ff_terrain_info *info, ff_payload in, parts *out)
{
    ff_residuals marks;
    FF_ASSERT(ff_payload_left(&in) >= 1);
    int rc, form = (*in.at++ & FF_HEAD_ERRORS) >> FF_HEAD_ERRORS_SHIFT;
    size_t lengths = ff_trained_lengths(info);
    out->errors = in.at;
    rc = ff_take_errors(&in, (unsigned)form, 4, &marks);
    if (rc != FF_OK) return rc;
    if (ff_payload_left(&in) < lengths) return FF_ERR_TRUNCATED;
    ff_trained_lengths_of(info, in.at, out->length);
    in.at += lengths;
    out->sides = in.at;
    for (unsigned side = 0; side < FF_SIDE_COUNT; side++) {
        if (ff_payload_left(&in) < out->length[side]) return FF_ERR_TRUNCATED;
        in.at += out->length[side];
    }
    out->rest = in;
    return FF_OK;
}

static uint8_t *put(uint8_t *to, const uint8_t *bytes, size_t count)
{
    FF_ASSERT(count <= FF_PAYLOAD_BYTES_MAX);
    if (count) memcpy(to, bytes, count);
    return to + count;
}

int ff_trained_without_sides(const ff_terrain_info *info, const uint8_t *payload, size_t bytes,
                             unsigned sides, uint8_t *out)
{
    parts p;
    uint8_t *to = out + 1;
    FF_ASSERT(sides >> FF_SIDE_COUNT == 0);
    if (bytes < 1) return FF_ERR_TRUNCATED;
    if (bytes > FF_PAYLOAD_BYTES_MAX) return FF_ERR_FORMAT;
    if (payload[0] & (FF_TRAINED_WORDS | FF_TRAINED_SIDES)) return 0;
    int rc = take_parts(info, (ff_payload){ payload, payload + bytes }, &p);
    if (rc != FF_OK) return rc;
    out[0] = (uint8_t)(payload[0] | (sides ? sides << FF_TRAINED_SIDES_SHIFT : FF_TRAINED_ALL));
    to = put(to, p.errors, (size_t)(p.sides - p.errors) - ff_trained_lengths(info));
    for (unsigned side = 0; side < FF_SIDE_COUNT; side++) {
        if (!(sides >> side & 1u)) to = put(to, p.sides, p.length[side]);
        p.sides += p.length[side];
    }
    to = put(to, p.rest.at, ff_payload_left(&p.rest));
    FF_ASSERT((size_t)(to - out) + ff_trained_lengths(info) <= bytes);
    return (int)(to - out);
}
