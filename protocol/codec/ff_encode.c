/* Encoder half of the height codec, for tools. It predicts from decoded heights (closed loop), so
 * it makes every height just as the decoders will. */
#ifdef FF_ENCODER

#include "ff_codec_local.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

typedef struct quantisation {
    const uint16_t *source;
    int32_t *next;
    int32_t quantum;
} quantisation;

static uint16_t take_residual(void *context, uint32_t at, int32_t predicted)
{
    quantisation *q = context;
    int32_t difference = q->source[at] - predicted, half = q->quantum / 2;
    int32_t residual;

    if (q->quantum == 1) /* modulo 2^16: the shorter way round */
        residual = difference > INT16_MAX   ? difference - 65536
                   : difference < INT16_MIN ? difference + 65536
                                            : difference;
    else
        residual = difference >= 0 ? (difference + half) / q->quantum
                                   : -((half - difference) / q->quantum);
    *q->next++ = residual;
    return ff_dequantise(q->quantum, predicted, residual);
}

/* ---- residuals to payload ---- */

static uint32_t zigzag(int32_t v) { return v < 0 ? ~((uint32_t)v << 1) : (uint32_t)v << 1; }

static uint32_t packed_width(const int32_t *value, uint32_t count)
{
    uint32_t all = 0, width = 0;

    for (uint32_t i = 0; i < count; i++) all |= zigzag(value[i]);
    while (all >> width) width++;
    return width;
}

/* The lowest `width` bits of every value. */
static void put_low(const int32_t *value, uint32_t count, uint32_t width, uint8_t *out)
{
    uint32_t bits = 0, held = 0, mask = (1u << width) - 1;
    uint8_t *at = out;

    for (uint32_t i = 0; i < count; i++) {
        bits |= (zigzag(value[i]) & mask) << held;
        for (held += width; held >= 8; held -= 8, bits >>= 8) *at++ = (uint8_t)bits;
    }
    if (held > 0) *at = (uint8_t)bits;
}

/* Deflates a plane of high parts to `out`. Bytes written, or 0 when they would not be fewer than
 * `limit`. */
static size_t deflate_plane(const uint8_t *plane, uint32_t bytes, int window_bits, int strategy,
                            uint8_t *out, size_t limit)
{
    z_stream z;
    size_t written = 0;

    memset(&z, 0, sizeof(z));
    /* The least memory level whose symbol buffer holds the whole plane: zlib then writes one block,
     * and has little memory to allocate and clear. */
    if (deflateInit2(&z, 9, Z_DEFLATED, -window_bits, bytes < 1000 ? 4 : 8, strategy) != Z_OK)
        abort();
    z.next_in = (z_const Bytef *)plane;
    z.avail_in = bytes;
    z.next_out = out;
    z.avail_out = (uInt)limit - 1;
    if (deflate(&z, Z_FINISH) == Z_STREAM_END) written = (size_t)(z.next_out - out);
    deflateEnd(&z);
    return written;
}

/* Writes the high parts in unary, as take_unary in the decoder reads them. Returns their bytes;
 * with `out` NULL it only counts them. */
static size_t put_unary(const int32_t *value, uint32_t count, uint32_t low, uint8_t *out)
{
    size_t bit = 0;

    for (uint32_t i = 0; i < count; i++) {
        uint32_t high = zigzag(value[i]) >> low;
        for (uint32_t one = 0; out && one <= high; one++) {
            size_t at = bit + one;
            if (at % 8 == 0) out[at / 8] = 0;
            out[at / 8] |= (uint8_t)((one < high) << at % 8);
        }
        bit += high + 1;
    }
    return (bit + 7) / 8;
}

/* Deflates the high parts of all values: what is above their lowest `low` bits. Bytes in `out`, or
 * 0 when they are not fewer than `limit`. */
static size_t put_deflated(const ff_terrain_info *info, const int32_t *value, uint32_t count,
                           uint32_t low, uint8_t *out, size_t limit)
{
    static const int strategies[] = { Z_DEFAULT_STRATEGY, Z_FIXED, Z_HUFFMAN_ONLY };
    uint8_t plane[FF_REFINED_HEIGHTS_MAX], trial[2 * FF_REFINED_HEIGHTS_MAX];
    size_t best = 0;

    for (uint32_t i = 0; i < count; i++) plane[i] = (uint8_t)(zigzag(value[i]) >> low);
    for (size_t s = 0; s < sizeof(strategies) / sizeof(strategies[0]) && limit > 1; s++) {
        size_t bytes = deflate_plane(plane, count, ff_window_bits(info), strategies[s], trial,
                                     limit);
        if (bytes > 0) {
            memcpy(out, trial, bytes);
            best = limit = bytes;
        }
    }
    return best;
}

/* One way to write a body: its kind, the number of low bits stored plainly, the bytes in all. */
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

/* Tries all forms, and all places to cut the values into low bits and high parts. Returns the bytes
 * of the smallest body, and adds its form to *head. */
static size_t put_body(const ff_terrain_info *info, const int32_t *value, uint32_t count,
                       uint8_t *head, uint8_t *out)
{
    uint32_t width = packed_width(value, count);
    uint8_t high[2 * FF_REFINED_HEIGHTS_MAX];
    body_form best = cheapest_plain_form(value, count, width);

    if (width == 0) return 0;
    for (uint32_t low = width > 8 ? width - 8 : 0; low < width && info->codec == FF_CODEC_DEFLATE;
         low++) {
        size_t low_bytes = ff_packed_bytes(count, low);
        size_t bytes = low_bytes >= best.bytes
                           ? 0
                           : put_deflated(info, value, count, low, high, best.bytes - low_bytes);
        if (bytes > 0) {
            memcpy(out + low_bytes, high, bytes);
            best = (body_form){ FF_BODY_DEFLATE, low, low_bytes + bytes };
        }
    }
    put_low(value, count, best.low, out);
    if (best.kind == FF_BODY_UNARY)
        put_unary(value, count, best.low, out + ff_packed_bytes(count, best.low));
    *head |= (uint8_t)(best.kind | (best.kind == FF_BODY_PACKED ? best.low - 1 : best.low)
                                       << FF_HEAD_DETAIL_SHIFT);
    return best.bytes;
}

static int encode_raw(const uint8_t *error, uint32_t errors, const int32_t *value, uint32_t count,
                      uint8_t *out)
{
    uint8_t *at = out + errors;

    memcpy(out, error, errors);
    for (uint32_t i = 0; i < count; i++) {
        *at++ = (uint8_t)((uint32_t)value[i] & 0xffu);
        *at++ = (uint8_t)(((uint32_t)value[i] >> 8) & 0xffu);
    }
    return (int)(at - out);
}

static enum ff_errors_form errors_form(const uint8_t *error, uint32_t errors)
{
    int same = 1;

    for (uint32_t i = 1; i < errors; i++) same &= error[i] == error[0];
    return !same ? FF_ERRORS_EACH : error[0] == 0 ? FF_ERRORS_ZERO : FF_ERRORS_SAME;
}

static int encode_payload(const ff_terrain_info *info, const uint8_t *error, uint32_t errors,
                          const int32_t *value, uint32_t absolute, uint32_t count, uint8_t *out)
{
    enum ff_errors_form form = errors_form(error, errors);
    uint32_t error_bytes = form == FF_ERRORS_EACH ? errors : form == FF_ERRORS_SAME;
    uint8_t *at = out + 1;

    if (info->codec == FF_CODEC_RAW) return encode_raw(error, errors, value, count, out);
    out[0] = (uint8_t)(form << 2);
    at += encode_raw(error, error_bytes, value, absolute, at);
    at += put_body(info, value + absolute, count - absolute, out, at);
    return (int)(at - out);
}

int ff_encode_root(const ff_terrain_info *info, const uint16_t *source, uint8_t error_code,
                   uint8_t *out, uint16_t *decoded)
{
    int32_t value[FF_NODE_HEIGHTS_MAX];
    quantisation q = { source, value, ff_quantum(info) };

    if (error_code > FF_ERROR_CODE_MAX) return FF_ERR_RANGE;
    for (uint32_t corner = 0; corner < FF_CORNERS; corner++) {
        uint32_t at = ff_corner_at(info, corner);
        *q.next = (source[at] + info->max_error) / q.quantum;
        decoded[at] = ff_dequantise(q.quantum, 0, *q.next++);
    }
    ff_predict_root(info, decoded, take_residual, &q);
    return encode_payload(info, &error_code, 1, value, FF_CORNERS, ff_root_count(info), out);
}

int ff_encode_refinement(const ff_terrain_info *info, const uint16_t *parent,
                         const uint16_t *source, const uint8_t child_error[4], uint8_t *out,
                         uint16_t *decoded)
{
    int32_t value[FF_REFINED_HEIGHTS_MAX];
    quantisation q = { source, value, ff_quantum(info) };

    for (int i = 0; i < 4; i++)
        if (child_error[i] > FF_ERROR_CODE_MAX) return FF_ERR_RANGE;
    ff_predict_refinement(info, parent, decoded, take_residual, &q);
    return encode_payload(info, child_error, 4, value, 0, ff_refinement_count(info), out);
}

#else
typedef int ff_encode_not_built; /* ISO C wants a declaration in every file */
#endif
