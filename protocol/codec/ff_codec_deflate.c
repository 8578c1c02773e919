/* Codec "deflate": a head and a body (ff_body.h) whose high parts may be deflated, one byte a
 * value. Decoder memory: room for a payload's high parts, then the inflate state. */
#include "../zlib/ff_inflate.h"
#include "ff_body.h"

/* The plane is as long as a refinement's residuals: a root's are fewer. */
FF_STATIC_ASSERT(FF_NODE_HEIGHTS_MAX - FF_CORNERS <= FF_REFINED_HEIGHTS_MAX - FF_NODE_HEIGHTS_MAX);

/* Window of the streams: the smallest that covers all high parts of a payload. */
static int window_bits(const ff_terrain_info *info)
{
    int bits = 9;

    while ((1u << bits) < ff_refinement_count(info)) bits++;
    FF_ASSERT(bits <= 13); /* as SPEC.md promises, 3.5 */
    return bits;
}

static size_t plane_bytes(const ff_terrain_info *info)
{
    return ff_align_up(ff_refinement_count(info));
}

int32_t ff_deflate_memory(const ff_terrain_info *info, void *memory)
{
    int window = window_bits(info);
    size_t inflate_bytes = ff_inflate_bytes(window);

    if (memory && !ff_inflate_create(window, (uint8_t *)memory + plane_bytes(info), inflate_bytes))
        return FF_ERR_MEMORY;
    return (int32_t)(plane_bytes(info) + inflate_bytes);
}

static int take_deflated(const ff_decoder *dec, ff_payload *in, uint32_t width, int32_t *value,
                         uint32_t count)
{
    uint8_t *plane = dec->memory;
    void *inflater = plane + plane_bytes(&dec->info);
    uint32_t all = 0;
    int rc;

    FF_ASSERT(count <= plane_bytes(&dec->info) && width < FF_WIDTH_MAX);
    rc = ff_inflate_all(inflater, in->at, ff_payload_left(in), plane, count);
    if (rc != FF_OK) return rc;
    for (uint32_t i = 0; i < count; i++) {
        FF_ASSERT((uint32_t)value[i] >> width == 0);
        value[i] |= (int32_t)plane[i] << width;
        all |= (uint32_t)value[i];
    }
    in->at = in->end;
    return all > UINT16_MAX ? FF_ERR_RANGE : FF_OK;
}

int ff_deflate_decode(const ff_decoder *dec, ff_payload *in, const ff_contents *contents,
                      ff_residuals *out)
{
    return ff_take_body(dec, in, contents, take_deflated, out);
}

#ifdef FF_ENCODER
#include "../zlib/ff_deflate.h"

/* A limit is the packed form's length at most (ff_put_body). */
FF_STATIC_ASSERT(FF_WIDTH_MAX / 8 * FF_REFINED_HEIGHTS_MAX <= FF_DEFLATE_LIMIT_MAX);

static size_t put_deflated(const ff_terrain_info *info, const uint8_t *high, uint32_t count,
                           uint8_t *out, size_t limit)
{
    FF_ASSERT(count <= ff_refinement_count(info));
    return ff_deflate_all(window_bits(info), high, count, out, limit);
}

size_t ff_deflate_encode(const ff_terrain_info *info, const uint16_t *parent,
                         const uint16_t *decoded, const ff_contents *contents,
                         const ff_residuals *res, uint8_t *out)
{
    (void)parent, (void)decoded;
    return ff_put_body(info, contents, res, put_deflated, out);
}
#endif
