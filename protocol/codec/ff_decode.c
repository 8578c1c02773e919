/* Decoder half of the height codec: payload to residuals (network worker), residuals to heights
 * (main thread). */
#include "ff_codec_local.h"
#include "../zlib/ff_inflate.h"

#include <assert.h>
#include <string.h>

#define ALIGNMENT 16u

struct ff_decoder {
    ff_terrain_info info;
    ff_inflate *inflater; /* NULL when the codec has no use for one */
    uint8_t *plane;       /* what the inflater writes: high parts of a payload's values */
};

uint32_t ff_geometric_error_decode(uint8_t code)
{
    return code < 32 ? code : (16u + (code & 15u)) << (code / 16u - 1u);
}

uint8_t ff_geometric_error_encode(uint32_t steps)
{
    uint32_t code = 32, shift = 1;

    if (steps < 32) return (uint8_t)steps;
    if (steps >= 65536) return FF_ERROR_CODE_MAX;
    while (shift < 12 && steps > (31u << shift)) {
        code += 16;
        shift++;
    }
    return (uint8_t)(code + ((steps + (1u << shift) - 1) >> shift) - 16);
}

static size_t align_up(size_t bytes) { return (bytes + ALIGNMENT - 1) & ~(size_t)(ALIGNMENT - 1); }

static size_t plane_bytes(const ff_terrain_info *info)
{
    return align_up(ff_refinement_count(info));
}

int ff_codec_supported(int codec)
{
    return codec >= 0 && codec < FF_CODEC_COUNT && (codec != FF_CODEC_DEFLATE || ff_inflate_built);
}

size_t ff_decoder_bytes(const ff_terrain_info *info)
{
    size_t head_bytes = align_up(sizeof(ff_decoder));

    return info->codec == FF_CODEC_DEFLATE
               ? head_bytes + plane_bytes(info) + ff_inflate_bytes(ff_window_bits(info))
               : head_bytes;
}

ff_decoder *ff_decoder_create(const ff_terrain_info *info, void *memory, size_t bytes)
{
    ff_decoder *dec = memory;
    size_t head_bytes = align_up(sizeof(ff_decoder)) + plane_bytes(info);

    if (bytes < ff_decoder_bytes(info) || !ff_codec_supported(info->codec)) return NULL;
    memset(dec, 0, sizeof(*dec));
    dec->info = *info;
    if (info->codec != FF_CODEC_DEFLATE) return dec;
    dec->plane = (uint8_t *)memory + align_up(sizeof(ff_decoder));
    dec->inflater = ff_inflate_create(ff_window_bits(info), (uint8_t *)memory + head_bytes,
                                      bytes - head_bytes);
    return dec->inflater ? dec : NULL;
}

/* ---- payload to residuals ---- */

typedef struct cursor {
    const uint8_t *at, *end;
} cursor;

static size_t left(const cursor *in) { return (size_t)(in->end - in->at); }

static int take_errors(cursor *in, unsigned form, uint32_t count, uint8_t error[4])
{
    uint32_t stored = form == FF_ERRORS_EACH ? count : form == FF_ERRORS_SAME ? 1 : 0;

    if (form > FF_ERRORS_EACH) return FF_ERR_FORMAT;
    if (left(in) < stored) return FF_ERR_TRUNCATED;
    memset(error, 0, 4);
    for (uint32_t i = 0; i < count && stored > 0; i++) {
        error[i] = in->at[stored == 1 ? 0 : i];
        if (error[i] > FF_ERROR_CODE_MAX) return FF_ERR_RANGE;
    }
    in->at += stored;
    return FF_OK;
}

/* 0, -1, 1, -2, ... from 0, 1, 2, 3, ... */
static int32_t unzigzag(uint32_t v) { return (int32_t)(v >> 1) ^ -(int32_t)(v & 1u); }

/* Reads the low parts: `width` bits of every value, packed low bit first. */
static int take_low(cursor *in, uint32_t width, int32_t *value, uint32_t count)
{
    uint32_t bits = 0, held = 0;

    if (left(in) < ff_packed_bytes(count, width)) return FF_ERR_TRUNCATED;
    for (uint32_t i = 0; i < count; i++) {
        for (; held < width; held += 8) bits |= (uint32_t)*in->at++ << held;
        value[i] = (int32_t)(bits & ((1u << width) - 1));
        bits >>= width;
        held -= width;
    }
    return FF_OK;
}

/* Reads the high parts from all that is left of the payload: one byte a value, packed by raw
 * deflate. */
static int take_deflated(ff_decoder *dec, cursor *in, uint32_t width, int32_t *value,
                         uint32_t count)
{
    uint32_t all = 0;
    int rc = dec->inflater ? ff_inflate_all(dec->inflater, in->at, left(in), dec->plane, count)
                           : FF_ERR_FORMAT;

    if (rc != FF_OK) return rc;
    for (uint32_t i = 0; i < count; i++) {
        value[i] |= (int32_t)dec->plane[i] << width;
        all |= (uint32_t)value[i];
    }
    in->at = in->end;
    return all > UINT16_MAX ? FF_ERR_RANGE : FF_OK;
}

/* Reads the high parts in unary: a part's value is the number of one bits before a zero bit, low
 * bit first. With the low parts this is a Golomb-Rice code. */
static int take_unary(cursor *in, uint32_t width, int32_t *value, uint32_t count)
{
    uint32_t high_max = (uint32_t)UINT16_MAX >> width, bit = 0;

    for (uint32_t i = 0; i < count; i++) {
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

static int take_body(ff_decoder *dec, cursor *in, uint8_t head, int32_t *value, uint32_t count)
{
    uint32_t detail = head >> FF_HEAD_DETAIL_SHIFT, body = head & FF_HEAD_BODY;
    int rc;

    if (body == FF_BODY_ZERO && detail != 0) return FF_ERR_FORMAT;
    rc = take_low(in, body == FF_BODY_PACKED ? detail + 1 : detail, value, count);
    if (rc == FF_OK && body == FF_BODY_DEFLATE) rc = take_deflated(dec, in, detail, value, count);
    if (rc == FF_OK && body == FF_BODY_UNARY) rc = take_unary(in, detail, value, count);
    for (uint32_t i = 0; rc == FF_OK && i < count; i++) value[i] = unzigzag((uint32_t)value[i]);
    return rc == FF_OK && left(in) > 0 ? FF_ERR_FORMAT : rc;
}

static int take_raw(cursor *in, uint32_t absolute, int32_t *value, uint32_t count)
{
    if (left(in) != 2 * (size_t)count)
        return left(in) < 2 * (size_t)count ? FF_ERR_TRUNCATED : FF_ERR_FORMAT;
    for (uint32_t i = 0; i < count; i++, in->at += 2) {
        int32_t v = in->at[0] | in->at[1] << 8;
        value[i] = i < absolute || v <= INT16_MAX ? v : v - 65536;
    }
    return FF_OK;
}

static int decode(ff_decoder *dec, const uint8_t *payload, size_t bytes, uint32_t errors,
                  uint32_t absolute, uint32_t count, ff_residuals *out)
{
    cursor in = { payload, payload + bytes };
    int raw = dec->info.codec == FF_CODEC_RAW, rc;
    uint8_t head = 0;

    if (bytes < 1) return FF_ERR_TRUNCATED;
    if (!raw) head = *in.at++;
    rc = take_errors(&in, raw ? FF_ERRORS_EACH : (head & FF_HEAD_ERRORS) >> 2, errors,
                     out->child_error);
    if (rc != FF_OK) return rc;
    out->count = (uint16_t)count;
    if (raw) return take_raw(&in, absolute, out->value, count);
    if (left(&in) < 2 * absolute) return FF_ERR_TRUNCATED;
    for (uint32_t i = 0; i < absolute; i++, in.at += 2) out->value[i] = in.at[0] | in.at[1] << 8;
    return take_body(dec, &in, head, out->value + absolute, count - absolute);
}

int ff_decode_root(ff_decoder *dec, const uint8_t *payload, size_t bytes, ff_residuals *out)
{
    return decode(dec, payload, bytes, 1, FF_CORNERS, ff_root_count(&dec->info), out);
}

int ff_decode_refinement(ff_decoder *dec, const uint8_t *payload, size_t bytes, ff_residuals *out)
{
    return decode(dec, payload, bytes, 4, 0, ff_refinement_count(&dec->info), out);
}

/* ---- residuals to heights ---- */

typedef struct reconstruction {
    const int32_t *next;
    int32_t quantum;
} reconstruction;

static uint16_t add_residual(void *context, uint32_t at, int32_t predicted)
{
    reconstruction *r = context;

    (void)at;
    return ff_dequantise(r->quantum, predicted, *r->next++);
}

void ff_reconstruct_root(const ff_terrain_info *info, const ff_residuals *res, uint16_t *heights)
{
    reconstruction r = { res->value, ff_quantum(info) };

    assert(res->count == ff_root_count(info));
    for (uint32_t corner = 0; corner < FF_CORNERS; corner++)
        heights[ff_corner_at(info, corner)] = ff_dequantise(r.quantum, 0, *r.next++);
    ff_predict_root(info, heights, add_residual, &r);
}

void ff_reconstruct_refinement(const ff_terrain_info *info, const uint16_t *parent,
                               const ff_residuals *res, uint16_t *refined)
{
    reconstruction r = { res->value, ff_quantum(info) };

    assert(res->count == ff_refinement_count(info));
    ff_predict_refinement(info, parent, refined, add_residual, &r);
}

void ff_refined_child(const ff_terrain_info *info, const uint16_t *refined, uint32_t quadrant,
                      uint16_t *child)
{
    uint32_t side = ff_node_side(info), refined_side = ff_refined_side(info);
    const uint16_t *from = refined + (quadrant & 1u) * (side - 1) +
                           (quadrant >> 1) * (side - 1) * refined_side;

    for (uint32_t j = 0; j < side; j++)
        memcpy(child + j * side, from + j * refined_side, side * sizeof(*child));
}
