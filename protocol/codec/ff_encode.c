/* Encoder of heights, for tools: closed loop, so it makes every height just as the decoders will;
 * then the codec's own function makes the payload. */
#ifdef FF_ENCODER

#include "ff_codec_local.h"

#include <string.h>

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
    uint16_t height;

    if (q->quantum == 1) /* modulo 2^16: the shorter way round */
        residual = difference > INT16_MAX   ? difference - 65536
                   : difference < INT16_MIN ? difference + 65536
                                            : difference;
    else
        residual = difference >= 0 ? (difference + half) / q->quantum
                                   : -((half - difference) / q->quantum);
    *q->next++ = residual;
    height = ff_dequantise(q->quantum, predicted, residual);
    FF_ASSERT(height - q->source[at] <= half && q->source[at] - height <= half); /* max_error */
    return height;
}

void ff_encode_heights(const ff_terrain_info *info, const uint16_t *parent, const uint16_t *source,
                       ff_residuals *out, uint16_t *decoded)
{
    quantisation q = { source, out->value, ff_quantum(info) };

    out->count = (uint16_t)ff_coded_count(info, out->cells, !parent);
    out->carried_bytes = 0;
    if (parent) {
        ff_predict_refinement(info, out->cells, parent, decoded, take_residual, &q);
        FF_ASSERT(q.next == out->value + out->count);
        return;
    }
    for (uint32_t corner = 0; corner < FF_CORNERS; corner++) {
        uint32_t at = ff_corner_at(info, corner);
        *q.next = (source[at] + info->max_error) / q.quantum;
        decoded[at] = ff_dequantise(q.quantum, 0, *q.next++);
    }
    ff_predict_root(info, out->cells, decoded, take_residual, &q);
    FF_ASSERT(q.next == out->value + out->count);
}

int ff_encode_payload(const ff_terrain_info *info, const uint16_t *parent, const uint16_t *decoded,
                      const ff_residuals *res, uint8_t *out)
{
    ff_contents contents = { parent ? 4 : 1, parent ? 0 : FF_CORNERS, res->count };
    size_t bytes;

    for (uint32_t i = 0; i < contents.errors; i++)
        if (res->child_error[i] > FF_ERROR_CODE_MAX) return FF_ERR_RANGE;
    bytes = ff_codec_encoder(info->codec)(info, parent, decoded, &contents, res, out);
    FF_ASSERT(bytes >= 1 && bytes <= FF_PAYLOAD_BYTES_MAX);
    return (int)bytes;
}

int ff_encode_root(const ff_terrain_info *info, const uint16_t *source, uint8_t error_code,
                   uint8_t *out, uint16_t *decoded)
{
    int32_t value[FF_NODE_HEIGHTS_MAX];
    ff_residuals res = { .child_error = { error_code }, .value = value };

    ff_encode_heights(info, NULL, source, &res, decoded);
    return ff_encode_payload(info, NULL, decoded, &res, out);
}

int ff_encode_refinement(const ff_terrain_info *info, const uint16_t *parent,
                         const uint16_t *source, const uint8_t child_error[4], uint8_t *out,
                         uint16_t *decoded)
{
    int32_t value[FF_REFINED_HEIGHTS_MAX];
    ff_residuals res = { .value = value };

    memcpy(res.child_error, child_error, sizeof(res.child_error));
    ff_encode_heights(info, parent, source, &res, decoded);
    return ff_encode_payload(info, parent, decoded, &res, out);
}

/* ---- parts of payloads that codecs share ---- */

size_t ff_put_errors(const ff_residuals *res, enum ff_errors_form form, uint32_t errors,
                     uint8_t *out)
{
    size_t bytes = form == FF_ERRORS_EACH ? errors : form == FF_ERRORS_SAME;
    uint8_t *at = out;

    FF_ASSERT(errors == 1 || errors == 4);
    FF_ASSERT(res->filled >> errors == 0 && (bytes > 0 || !res->filled));
    FF_ASSERT(res->leaf >> errors == 0 && (bytes > 0 || !res->leaf == (form == FF_ERRORS_ZERO)));
    if (res->leaf && bytes > 0) *at++ = (uint8_t)(FF_LEAF | res->leaf);
    if (res->filled) *at++ = (uint8_t)(FF_FILLED | res->filled);
    memcpy(at, res->child_error, bytes);
    return (size_t)(at - out) + bytes;
}

size_t ff_put_words(const int32_t *value, uint32_t count, uint8_t *out)
{
    for (uint32_t i = 0; i < count; i++) {
        FF_ASSERT(value[i] >= INT16_MIN && value[i] <= UINT16_MAX); /* a corner's is unsigned */
        *out++ = (uint8_t)((uint32_t)value[i] & 0xffu);
        *out++ = (uint8_t)(((uint32_t)value[i] >> 8) & 0xffu);
    }
    return 2 * (size_t)count;
}

#else
typedef int ff_encode_not_built; /* ISO C wants a declaration in every file */
#endif
