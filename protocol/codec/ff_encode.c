/* Encoder of heights, for tools: closed loop, so it makes every height just as the decoders will;
 * then the codec's own function makes the payload. */
#ifdef FF_ENCODER

#include "ff_body.h"

#include <string.h>

typedef struct quantisation {
    const ff_source_heights *source;
    int32_t *next;
    int32_t quantum;
} quantisation;

static uint16_t take_residual(void *context, uint32_t at, int32_t predicted)
{
    quantisation *q = context;
    return ff_make_height(q->source, at, q->quantum, predicted, q->next++);
}

void ff_make_residuals(const ff_terrain_info *info, const uint16_t *parent,
                       const ff_source_heights *source, ff_residuals *out, uint16_t *decoded)
{
    uint16_t room[FF_CODEC_ROOM_MAX / 2 + 1];
    quantisation q = { source, out->value + (parent ? 0 : FF_CORNERS), ff_quantum(info, !parent) };
    ff_codec_row(info->codec)
        ->predict(info, out->cells, out->way, parent, decoded, room, take_residual, &q);
    FF_ASSERT(q.next == out->value + out->count);
}

static void make_corners(const ff_terrain_info *info, const ff_source_heights *source,
                         int32_t *value, uint16_t *decoded)
{
    int32_t quantum = ff_quantum(info, 1);
    for (uint32_t corner = 0; corner < FF_CORNERS; corner++) {
        uint32_t at = ff_corner_at(info, corner);
        FF_ASSERT(!source->between || !source->between[at]);
        value[corner] = (source->height[at] + quantum / 2) / quantum;
        decoded[at] = ff_dequantise_corner(quantum, value[corner]);
    }
}

int ff_is_as_predicted(const ff_residuals *res)
{
    for (uint32_t i = 0; i < res->count; i++)
        if (res->value[i] != 0) return 0;
    return res->way == 0;
}

/* A prediction that is behind half-way is given up, where there are bytes enough to tell. */
#define HALF_TELLS 48

/* Makes it by another prediction, and keeps that if it is shorter. */
static void try_way(const ff_terrain_info *info, const uint16_t *parent,
                    const ff_source_heights *from, unsigned way, ff_residuals *out,
                    uint16_t *decoded)
{
    uint16_t heights[FF_REFINED_HEIGHTS_MAX];
    int32_t value[FF_REFINED_HEIGHTS_MAX];
    uint8_t body[FF_PAYLOAD_BYTES_MAX];
    uint32_t side = parent ? ff_refined_side(info) : ff_node_side(info);
    ff_residuals other = *out;
    other.way = (uint8_t)way;
    other.value = value;
    other.body = body;
    other.body_half = (uint16_t)(other.body_half < HALF_TELLS ? 0 : other.body_half + 1);
    if (!parent) make_corners(info, from, value, heights);
    ff_codec_maker(info->codec)(info, parent, from, &other, heights);
    if (other.body_bits >= out->body_bits) return;
    memcpy(out->value, value, out->count * sizeof *value);
    memcpy(out->body, body, other.body_bytes);
    memcpy(decoded, heights, (size_t)side * side * sizeof *heights);
    out->way = (uint8_t)way;
    out->body_bytes = other.body_bytes;
    out->body_bits = other.body_bits;
}

/* Of a codec's predictions the one of the shortest payload; that of leaves where it is right. */
void ff_encode_heights(const ff_terrain_info *info, const uint16_t *parent, const uint16_t *source,
                       const uint8_t *between, ff_residuals *out, uint16_t *decoded)
{
    const ff_source_heights from = { source, between };
    ff_make_fn *make = ff_codec_maker(info->codec);
    unsigned ways = ff_codec_ways(info->codec);
    FF_ASSERT(ways == 1 || out->body);
    out->count = (uint16_t)ff_coded_count(info, out->cells, !parent);
    out->carried_bytes = 0;
    out->sides = out->way = 0;
    out->body_half = 0;
    if (!parent) make_corners(info, &from, out->value, decoded);
    make(info, parent, &from, out, decoded);
    for (unsigned way = 1; way < ways && !ff_is_as_predicted(out); way++)
        try_way(info, parent, &from, way, out, decoded);
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
    uint8_t body[FF_PAYLOAD_BYTES_MAX];
    ff_residuals res = { .child_error = { error_code }, .value = value, .body = body };

    ff_encode_heights(info, NULL, source, NULL, &res, decoded);
    return ff_encode_payload(info, NULL, decoded, &res, out);
}

int ff_encode_refinement(const ff_terrain_info *info, const uint16_t *parent,
                         const uint16_t *source, const uint8_t child_error[4], uint8_t *out,
                         uint16_t *decoded)
{
    int32_t value[FF_REFINED_HEIGHTS_MAX];
    uint8_t body[FF_PAYLOAD_BYTES_MAX];
    ff_residuals res = { .value = value, .body = body };

    memcpy(res.child_error, child_error, sizeof(res.child_error));
    ff_encode_heights(info, parent, source, NULL, &res, decoded);
    return ff_encode_payload(info, parent, decoded, &res, out);
}

/* ---- marks of payloads that are there ---- */

/* Takes head, marks and error codes off a payload: how the codes are stored, or an error. */
static int take_marks(const ff_terrain_info *info, int root, ff_payload *in, ff_residuals *out)
{
    int form = FF_ERRORS_EACH, rc;

    if (ff_payload_left(in) < 1) return FF_ERR_TRUNCATED;
    if (ff_codec_head(info->codec)) form = (*in->at++ & FF_HEAD_ERRORS) >> FF_HEAD_ERRORS_SHIFT;
    rc = ff_take_errors(in, (unsigned)form, root ? 1 : 4, out);
    return rc == FF_OK ? form : rc;
}

int ff_read_marks(const ff_terrain_info *info, int root, const uint8_t *payload, size_t bytes,
                  ff_residuals *out)
{
    ff_payload in = { payload, payload + bytes };
    if (info->codec == FF_CODEC_TRAINED)
        return ff_trained_read_marks(info, root, payload, bytes, out);
    int form = take_marks(info, root, &in, out);

    return form < 0 ? form : FF_OK;
}

int ff_mark_stubs(const ff_terrain_info *info, int root, const uint8_t *payload, size_t bytes,
                  uint8_t stub, uint8_t *out)
{
    size_t head = ff_codec_head(info->codec), put;
    ff_payload in = { payload, payload + bytes };
    ff_residuals res;
    if (info->codec == FF_CODEC_TRAINED)
        return ff_trained_mark_stubs(info, root, payload, bytes, stub, out);
    int form = take_marks(info, root, &in, &res);

    if (form < 0) return form;
    res.stub = stub;
    if (res.stub >> (root ? 1 : 4) || res.stub & res.leaf) return FF_ERR_RANGE;
    if (form == FF_ERRORS_ZERO && stub) form = FF_ERRORS_SAME;
    if (form == FF_ERRORS_SAME && !stub && !res.leaf && !res.filled && !res.child_error[0])
        form = FF_ERRORS_ZERO;
    if (head)
        out[0] = (uint8_t)((payload[0] & ~FF_HEAD_ERRORS) | (unsigned)form << FF_HEAD_ERRORS_SHIFT);
    put = head + ff_put_errors(&res, (enum ff_errors_form)form, root ? 1 : 4, out + head);
    if (ff_payload_left(&in) > FF_PAYLOAD_BYTES_MAX - put) return FF_ERR_FORMAT;
    memcpy(out + put, in.at, ff_payload_left(&in));
    return (int)(put + ff_payload_left(&in));
}

/* ---- below stubs ---- */

typedef struct triangles {
    const uint16_t *grid;
    uint32_t side;
} triangles;

/* New points lie in the middle of an edge, or of the diagonal from south-west to north-east. */
static uint16_t take_middle(void *context, uint32_t at, int32_t predicted)
{
    const triangles *t = context;
    uint32_t step = at % t->side % 2 + at / t->side % 2 * t->side;

    (void)predicted;
    FF_ASSERT(step > 0);
    return (uint16_t)((t->grid[at - step] + t->grid[at + step] + 1) / 2);
}

void ff_interpolate_children(const ff_terrain_info *info, ff_cells cells, const uint16_t *parent,
                             uint16_t *refined)
{
    triangles t = { refined, ff_refined_side(info) };

    ff_interpolate(info, cells, 0, parent, refined, NULL, take_middle, &t);
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
    FF_ASSERT(res->stub >> errors == 0 && (bytes > 0 || !res->stub) && !(res->stub & res->leaf));
    if (res->stub) *at++ = (uint8_t)(FF_STUB | res->stub);
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
