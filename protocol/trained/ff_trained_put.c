/* The writing half of codec trained: for tools. */
#ifdef FF_ENCODER

#include "../codec/ff_body.h"
#include "ff_range.h"
#include "ff_trained.h"

#include <string.h>

#define HALF 32768u

typedef struct putting {
    const ff_trained *by;
    const ff_source_heights *source;
    int32_t *next, quantum;
    ff_range_writer range;
    ff_trained_sides *sides; /* NULL: there is one stream */
    unsigned side;           /* whose stream is written, FF_SIDE_COUNT: none's */
    uint32_t side_bits;      /* at most */
    uint8_t *out;
    int is_full, is_given_up;
    size_t half; /* as ff_trained_put says */
} putting;

static void put_magnitude(const ff_odds *odds, ff_range_writer *range, uint32_t value)
{
    uint32_t bits = 0;
    while (value >> bits >> 1) bits++;
    for (uint32_t i = 0; i < bits; i++) ff_range_put(range, odds->beyond[i], 1);
    if (bits < FF_TRAINED_CLASSES - 1) ff_range_put(range, odds->beyond[bits], 0);
    for (uint32_t i = 0; i < bits; i++) {
        uint32_t one = i == 0   ? odds->second[bits]
                       : i == 1 ? odds->third[2 * bits + (value >> (bits - 1) & 1u)]
                                : HALF;
        ff_range_put(range, one, value >> (bits - 1 - i) & 1u);
    }
}

static uint16_t put_height(void *context, const ff_expected *p)
{
    putting *to = context;
    const ff_odds *odds = to->by->odds + p->scale;
    uint16_t height = ff_make_height(to->source, ff_expected_at(p), to->quantum, p->predicted,
                                     to->next);
    int32_t value = *to->next++ - p->residual;
    ff_range_put(&to->range, odds->zero, value == 0);
    if (value) {
        ff_range_put(&to->range, odds->below[p->phase], value < 0);
        put_magnitude(odds, &to->range, (uint32_t)(value < 0 ? -value : value));
    }
    return height;
}

static void end_side(putting *to)
{
    int bits = ff_range_end_before(&to->range);
    FF_ASSERT(to->side < FF_SIDE_COUNT);
    to->is_full |= bits < 0 || (uint32_t)bits > to->side_bits;
    to->sides->bits[to->side] = to->is_full ? 0 : (uint32_t)bits;
}

static int put_side(void *context, unsigned side, uint32_t points)
{
    putting *to = context;
    FF_ASSERT(side <= FF_SIDE_COUNT);
    if (to->side < FF_SIDE_COUNT) end_side(to);
    to->side = points ? side : FF_SIDE_COUNT;
    if (points)
        ff_range_write(&to->range, to->sides->bytes[side], sizeof to->sides->bytes[side]);
    else
        ff_range_write(&to->range, to->out, FF_TRAINED_BODY_MAX);
    return 0;
}

static int go_on(void *context)
{
    putting *to = context;
    size_t half = (size_t)(to->range.out - to->out), most = to->half;
    if (to->sides) half += ff_trained_bits_of(to->sides) / 8;
    to->half = half;
    to->is_given_up = most && half > most;
    return !to->is_given_up;
}

uint32_t ff_trained_put(const ff_trained *by, unsigned set, const ff_terrain_info *info,
                        ff_cells cells, const uint16_t *parent, const ff_source_heights *source,
                        int32_t *residual, uint16_t *decoded, ff_trained_sides *sides, uint8_t *out,
                        uint16_t *half)
{
    uint16_t room[FF_CODEC_ROOM_MAX / 2 + 1];
    putting to = { .by = by,
                   .source = source,
                   .next = residual,
                   .quantum = ff_quantum(info, !parent),
                   .sides = sides,
                   .side = FF_SIDE_COUNT,
                   .side_bits = ff_trained_side_bits(info),
                   .out = out,
                   .half = half ? *half : 0 };
    const ff_points points = { put_height, sides ? put_side : NULL, half ? go_on : NULL, &to };

    if (sides) memset(sides->bits, 0, sizeof sides->bits);
    ff_range_write(&to.range, out, FF_TRAINED_BODY_MAX);
    ff_expect(by, set, info, cells, parent, decoded, room, &points);
    if (half) *half = (uint16_t)to.half;
    if (to.is_given_up) return FF_TRAINED_GIVEN_UP;
    int bits = ff_range_end_bits(&to.range);
    return to.is_full || bits < 0 ? FF_TRAINED_FULL : (uint32_t)bits;
}

/* What a payload is put together from, as it is kept in ff_residuals.body; the stream, or words,
 * lie behind it. */
typedef struct body {
    enum ff_sides_form form;
    uint32_t stream_bits;
    ff_trained_sides sides;
} body;
FF_STATIC_ASSERT(sizeof(body) + FF_TRAINED_BODY_MAX <= FF_PAYLOAD_BYTES_MAX);

/* A side apart costs a bit or two, but who has a side already need not take it: of four, more than
 * one in a flight. So one stream is looked at only where sides are short. */
#define SIDES_SHARE 3
#define SIDES_LONG  (SIDES_SHARE * 3 * FF_SIDE_COUNT) /* bits */
#define SIDES_TOLD  4                                 /* bits that tell which are left out */
#define ONE_TOLD    6                                 /* those that tell that there are none */

/* A body of sides apart, or of one stream where that pays more, or words. */
void ff_trained_make(const ff_terrain_info *info, const uint16_t *parent,
                     const ff_source_heights *source, ff_residuals *out, uint16_t *decoded)
{
    const uint32_t corners = parent ? 0 : FF_CORNERS, words = 16 * (out->count - corners);
    const ff_trained *by = &ff_trained_tables;
    uint8_t one[FF_TRAINED_BODY_MAX], *stream = out->body + sizeof(body);
    int32_t *residual = out->value + corners;
    body b = { .form = parent ? FF_SIDES_MEASURED : FF_SIDES_NONE };
    b.stream_bits = ff_trained_put(by, out->way, info, out->cells, parent, source, residual,
                                   decoded, parent ? &b.sides : NULL, stream, &out->body_half);
    out->body_bits = b.stream_bits;
    if (b.stream_bits == FF_TRAINED_GIVEN_UP) return;
    uint32_t sides = parent ? ff_trained_bits_of(&b.sides) : 0;

    if (parent) out->body_bits += sides + SIDES_TOLD;
    if (parent && (sides < SIDES_LONG || out->body_bits >= words)) {
        uint32_t bits = ff_trained_put(by, out->way, info, out->cells, parent, source, residual,
                                       decoded, NULL, one, NULL);
        if (out->body_bits >= words || out->body_bits > bits + ONE_TOLD + sides / SIDES_SHARE) {
            b.form = FF_SIDES_NONE;
            b.stream_bits = bits;
            out->body_bits = bits + ONE_TOLD;
            memcpy(stream, one, (bits + 7) / 8);
        }
    }
    if (out->body_bits >= words && words) {
        b.form = FF_SIDES_WORDS;
        out->body_bits = b.stream_bits = words;
        ff_put_words(residual, out->count - corners, stream);
    }
    memcpy(out->body, &b, sizeof b);
    out->body_bytes = (uint16_t)(sizeof b + (b.stream_bits + 7) / 8);
}

static void put_sides(const ff_terrain_info *info, const ff_trained_sides *sides, ff_bits *to)
{
    for (unsigned side = 0; side < FF_SIDE_COUNT; side++)
        ff_bits_number(to, sides->bits[side], ff_trained_length_order(info));
    for (unsigned side = 0; side < FF_SIDE_COUNT; side++)
        for (uint32_t bit = 0; bit < sides->bits[side]; bit++)
            ff_bits_put(to, sides->bytes[side][bit / 8] >> (7 - bit % 8), 1);
}

size_t ff_trained_encode(const ff_terrain_info *info, const uint16_t *parent,
                         const uint16_t *decoded, const ff_contents *contents,
                         const ff_residuals *res, uint8_t *out)
{
    ff_residuals head = *res;
    ff_bits tail = { 0 };
    body b;

    (void)parent, (void)decoded;
    memcpy(&b, res->body, sizeof b);
    head.apart = (uint8_t)b.form;
    head.sides = 0;
    ff_trained_put_head(info, contents->corners > 0, &head, &tail);
    for (uint32_t i = 0; i < contents->corners; i++)
        ff_bits_put(&tail, (uint32_t)res->value[i], 16);
    if (b.form == FF_SIDES_MEASURED) put_sides(info, &b.sides, &tail);
    memcpy(out, res->body + sizeof b, (b.stream_bits + 7) / 8);
    return ff_bits_join(&tail, out, b.stream_bits);
}

/* ---- marks of payloads that are there ---- */

int ff_trained_read_marks(const ff_terrain_info *info, int root, const uint8_t *payload,
                          size_t bytes, ff_residuals *out)
{
    ff_tail tail = { payload, (uint32_t)bytes, 0 };
    return ff_trained_take_head(info, root, &tail, out);
}

int ff_trained_mark_stubs(const ff_terrain_info *info, int root, const uint8_t *payload,
                          size_t bytes, uint8_t stub, uint8_t *out)
{
    ff_residuals head = { 0 };
    ff_tail tail = { payload, (uint32_t)bytes, 0 };
    ff_bits bits = { 0 };
    uint8_t last;
    int rc = ff_trained_take_head(info, root, &tail, &head);
    if (rc != FF_OK) return rc;
    if (head.apart == FF_SIDES_BARE) return FF_ERR_FORMAT; /* no pack has it */
    head.stub = stub;
    if (head.stub >> (root ? 1 : 4) || head.stub & head.leaf) return FF_ERR_RANGE;
    ff_trained_put_head(info, root, &head, &bits);
    ff_tail rest = tail;
    for (unsigned i = 0; i < FF_CORNERS && root; i++) rest.at += 16;
    if (head.apart == FF_SIDES_MEASURED) rc = ff_trained_pass_sides(info, &rest);
    if (rc == FF_OK && ff_tail_is_short(&rest)) rc = FF_ERR_TRUNCATED;
    if (rc != FF_OK) return rc;
    uint32_t stream = ff_tail_before(&rest, &last);
    if (stream + sizeof bits.bytes > FF_PAYLOAD_BYTES_MAX) return FF_ERR_FORMAT;
    uint32_t stream_bits = head.apart == FF_SIDES_WORDS ? 8 * (uint32_t)(bytes - (rest.at + 7) / 8)
                                                        : ff_stream_bits(payload, stream, last);
    ff_bits_copy(&bits, &tail, rest.at - tail.at);
    memcpy(out, payload, stream);
    if (stream > 0) out[stream - 1] = last;
    return (int)ff_bits_join(&bits, out, stream_bits);
}

#else
typedef int ff_trained_put_not_built; /* ISO C wants a declaration in every file */
#endif
