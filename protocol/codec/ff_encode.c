/* Encoder of heights, for tools: closed loop, so it makes every height just as the decoders will;
 * then the codec's own function makes the payload. */
#ifdef FF_ENCODER

#include "ff_body.h"

#include <string.h>

typedef struct quantisation {
    const uint16_t *source;
    const uint8_t *between;
    int32_t *next;
    int32_t quantum;
} quantisation;

static uint16_t take_residual(void *context, uint32_t at, int32_t predicted)
{
    quantisation *q = context;
    if (q->between && q->between[at]) {
        *q->next++ = 0;
        return ff_dequantise(q->quantum, predicted, 0);
    }
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

/* Residuals and heights by prediction out->way. */
static void make_heights(const ff_terrain_info *info, const uint16_t *parent,
                         const uint16_t *source, const uint8_t *between, ff_residuals *out,
                         uint16_t *decoded)
{
    uint16_t room[FF_CODEC_ROOM_MAX / 2 + 1];
    quantisation q = { source, between, out->value, ff_quantum(info, !parent) };

    for (uint32_t corner = 0; !parent && corner < FF_CORNERS; corner++) {
        uint32_t at = ff_corner_at(info, corner);
        FF_ASSERT(!between || !between[at]);
        *q.next = (source[at] + q.quantum / 2) / q.quantum;
        decoded[at] = ff_dequantise(q.quantum, 0, *q.next++);
    }
    ff_codec_row(info->codec)
        ->predict(info, out->cells, out->way, parent, decoded, room, take_residual, &q);
    FF_ASSERT(q.next == out->value + out->count);
}

/* Bytes of the payload, but for errors and marks. */
static int bytes_of(const ff_terrain_info *info, const uint16_t *parent, const uint16_t *decoded,
                    const ff_residuals *made)
{
    uint8_t payload[FF_PAYLOAD_BYTES_MAX];
    ff_residuals alone = {
        .cells = made->cells, .way = made->way, .count = made->count, .value = made->value
    };

    return ff_encode_payload(info, parent, decoded, &alone, payload);
}

int ff_is_as_predicted(const ff_residuals *res)
{
    for (uint32_t i = 0; i < res->count; i++)
        if (res->value[i] != 0) return 0;
    return res->way == 0;
}

/* Of a codec's predictions the one of the shortest payload; that of leaves where it is right. */
void ff_encode_heights(const ff_terrain_info *info, const uint16_t *parent, const uint16_t *source,
                       const uint8_t *between, ff_residuals *out, uint16_t *decoded)
{
    unsigned ways = ff_codec_ways(info->codec), best = 0;
    int least;

    out->count = (uint16_t)ff_coded_count(info, out->cells, !parent);
    out->carried_bytes = 0;
    out->way = 0;
    make_heights(info, parent, source, between, out, decoded);
    if (ways == 1 || ff_is_as_predicted(out)) return;
    least = bytes_of(info, parent, decoded, out);
    for (unsigned way = 1; way < ways; way++) {
        out->way = (uint8_t)way;
        make_heights(info, parent, source, between, out, decoded);
        int bytes = bytes_of(info, parent, decoded, out);
        if (bytes >= least) continue;
        least = bytes;
        best = way;
    }
    if (best == ways - 1) return;
    out->way = (uint8_t)best;
    make_heights(info, parent, source, between, out, decoded);
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

    ff_encode_heights(info, NULL, source, NULL, &res, decoded);
    return ff_encode_payload(info, NULL, decoded, &res, out);
}

int ff_encode_refinement(const ff_terrain_info *info, const uint16_t *parent,
                         const uint16_t *source, const uint8_t child_error[4], uint8_t *out,
                         uint16_t *decoded)
{
    int32_t value[FF_REFINED_HEIGHTS_MAX];
    ff_residuals res = { .value = value };

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
    int form = take_marks(info, root, &in, out);

    return form < 0 ? form : FF_OK;
}

int ff_mark_stubs(const ff_terrain_info *info, int root, const uint8_t *payload, size_t bytes,
                  uint8_t stub, uint8_t *out)
{
    size_t head = ff_codec_head(info->codec), put;
    ff_payload in = { payload, payload + bytes };
    ff_residuals res;
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
