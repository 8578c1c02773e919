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
    uint8_t *out, *end;   /* of what is written, and of the room for it */
    uint32_t lengths;     /* of sides, as the payload has them */
    unsigned length_bits; /* of one of them */
    unsigned side;        /* whose stream is written, FF_SIDE_COUNT: none's */
    int is_full, is_given_up;
    const uint8_t *begin;
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

static void begin_stream(putting *to)
{
    ff_range_write(&to->range, to->out, (size_t)(to->end - to->out));
}

static void end_side(putting *to)
{
    int bytes = ff_range_end_before(&to->range);
    FF_ASSERT(to->side < FF_SIDE_COUNT);
    to->is_full |= bytes < 0 || bytes >> to->length_bits;
    if (to->is_full) return;
    to->out += bytes;
    to->lengths |= (uint32_t)bytes << to->side * to->length_bits;
}

static int put_side(void *context, unsigned side, uint32_t points)
{
    putting *to = context;
    FF_ASSERT(side <= FF_SIDE_COUNT && to->out <= to->end);
    if (to->side < FF_SIDE_COUNT) end_side(to);
    to->side = points ? side : FF_SIDE_COUNT;
    begin_stream(to);
    return 0;
}

static int go_on(void *context)
{
    putting *to = context;
    size_t half = (size_t)(to->range.out - to->begin), most = to->half;
    to->half = half;
    to->is_given_up = most && half > most;
    return !to->is_given_up;
}

size_t ff_trained_put(const ff_trained *by, unsigned set, const ff_terrain_info *info,
                      ff_cells cells, const uint16_t *parent, const ff_source_heights *source,
                      int32_t *residual, uint16_t *decoded, int apart, uint8_t *out, uint16_t *half)
{
    uint16_t room[FF_CODEC_ROOM_MAX / 2 + 1];
    size_t lengths = apart ? ff_trained_lengths(info) : 0;
    putting to = { .by = by,
                   .source = source,
                   .next = residual,
                   .quantum = ff_quantum(info, !parent),
                   .out = out + lengths,
                   .end = out + FF_TRAINED_BODY_MAX,
                   .length_bits = ff_trained_length_bits(info),
                   .side = FF_SIDE_COUNT,
                   .begin = out,
                   .half = half ? *half : 0 };
    const ff_points points = { put_height, apart ? put_side : NULL, half ? go_on : NULL, &to };

    begin_stream(&to);
    ff_expect(by, set, info, cells, parent, decoded, room, &points);
    if (half) *half = (uint16_t)to.half;
    if (to.is_given_up) return SIZE_MAX;
    int bytes = ff_range_end(&to.range);
    for (size_t i = 0; i < lengths; i++) out[i] = (uint8_t)(to.lengths >> 8 * i);
    return to.is_full || bytes < 0 ? FF_TRAINED_BODY_MAX : (size_t)(to.out - out) + (size_t)bytes;
}

static size_t bytes_of_sides(const ff_terrain_info *info, const uint8_t *body)
{
    uint8_t length[FF_SIDE_COUNT];
    ff_trained_lengths_of(info, body, length);
    return (size_t)length[0] + length[1] + length[2] + length[3];
}

/* Sides apart cost a byte or two each, but who has a side already need not take it: of four, more
 * than one in a flight. So one stream is looked at only where sides are short. */
#define SIDES_SHARE 3
#define SIDES_LONG  (SIDES_SHARE * 2 * FF_SIDE_COUNT)

/* A body of sides apart, or of one stream where that pays more, or words. */
void ff_trained_make(const ff_terrain_info *info, const uint16_t *parent,
                     const ff_source_heights *source, ff_residuals *out, uint16_t *decoded)
{
    const uint32_t corners = parent ? 0 : FF_CORNERS;
    const size_t words = 2 * (size_t)(out->count - corners);
    const ff_trained *by = &ff_trained_tables;
    uint8_t one[FF_TRAINED_BODY_MAX], *body = out->body + 1;
    int32_t *residual = out->value + corners;
    size_t bytes = ff_trained_put(by, out->way, info, out->cells, parent, source, residual, decoded,
                                  parent != NULL, body, &out->body_half);
    if (bytes == SIZE_MAX) {
        out->body_bytes = UINT16_MAX;
        return;
    }
    size_t sides = parent && bytes < words ? bytes_of_sides(info, body) : 0;

    out->body[0] = 0;
    if (parent && sides < SIDES_LONG) {
        size_t in_one = ff_trained_put(by, out->way, info, out->cells, parent, source, residual,
                                       decoded, 0, one, NULL);
        if (bytes >= words || bytes > in_one + ff_trained_lengths(info) + sides / SIDES_SHARE) {
            out->body[0] = FF_TRAINED_ONE;
            bytes = in_one;
            if (in_one < words) memcpy(body, one, in_one);
        }
    }
    if (bytes >= words) {
        out->body[0] = FF_TRAINED_WORDS;
        bytes = ff_put_words(residual, out->count - corners, body);
    }
    out->body_bytes = (uint16_t)(1 + bytes);
}

size_t ff_trained_encode(const ff_terrain_info *info, const uint16_t *parent,
                         const uint16_t *decoded, const ff_contents *contents,
                         const ff_residuals *res, uint8_t *out)
{
    enum ff_errors_form form = ff_errors_form_of(res, contents->errors);
    size_t bytes = 1;

    (void)info, (void)parent, (void)decoded;
    out[0] = (uint8_t)(res->body[0] | (unsigned)form << FF_HEAD_ERRORS_SHIFT |
                       (unsigned)res->way << FF_TRAINED_SET_SHIFT);
    bytes += ff_put_errors(res, form, contents->errors, out + bytes);
    bytes += ff_put_words(res->value, contents->corners, out + bytes);
    memcpy(out + bytes, res->body + 1, res->body_bytes - 1u);
    return bytes + res->body_bytes - 1;
}

#else
typedef int ff_trained_put_not_built; /* ISO C wants a declaration in every file */
#endif
