/* Codec "trained": residuals as one arithmetic stream, each by what is expected of its point
 * (ff_trained.h; SPEC.md, "Payload, codec 3"). The second stage of decoding reads it, while it
 * makes heights. */
#include "../codec/ff_body.h"
#include "ff_range.h"
#include "ff_trained.h"

#define HALF 32768u

const uint8_t ff_trained_built = 1;

/* ---- predicted ground ---- */

typedef struct prediction {
    ff_sample_fn sample;
    void *context;
} prediction;

static uint16_t pass_on(void *context, const ff_expected *point)
{
    const prediction *p = context;
    return p->sample(p->context, ff_expected_at(point), point->predicted);
}

void ff_trained_predict(const ff_terrain_info *info, ff_cells cells, unsigned way,
                        const uint16_t *parent, uint16_t *grid, void *room, ff_sample_fn sample,
                        void *context)
{
    prediction p = { sample, context };
    ff_points points = { .height = pass_on, .context = &p };
    ff_expect(&ff_trained_tables, way, info, cells, parent, grid, room, &points);
}

/* ---- decoder ---- */

int ff_trained_decode(const ff_decoder *dec, ff_payload *in, const ff_contents *contents,
                      ff_residuals *out)
{
    int root = contents->corners > 0;
    size_t words = 2 * (size_t)(contents->count - contents->corners);
    ff_tail tail = { in->at, (uint32_t)ff_payload_left(in), 0 };
    int rc = ff_trained_take_head(&dec->info, root, &tail, out);

    if (rc != FF_OK) return rc;
    out->head_bits = (uint16_t)tail.at;
    if (out->apart == FF_SIDES_WORDS) {
        words += (tail.at + 16 * contents->corners + 7) / 8;
        if (tail.count != words) return tail.count < words ? FF_ERR_TRUNCATED : FF_ERR_FORMAT;
    }
    return ff_carry(&dec->info, in, out);
}

typedef struct taking {
    ff_range range;
    const ff_odds *odds;
    ff_payload words;
    ff_tail tail; /* head, corners, lengths and sides */
    const ff_residuals *res;
    uint8_t *shared, kept; /* the stream's last byte, part of which is the tail's, as it was */
    uint32_t stream_bytes;
    uint16_t length[FF_SIDE_COUNT]; /* bits of the sides' streams, as they are told */
    unsigned side;                  /* whose stream is read, FF_SIDE_COUNT: none's */
    unsigned side_bytes;            /* of what is looked at of one, which lies in side_room */
    uint8_t side_room[FF_TRAINED_SIDE_BYTES + 4];
    int32_t quantum;
    int rc;
} taking;

static void refuse(taking *t, int error)
{
    if (t->rc == FF_OK) t->rc = error;
}

static inline uint32_t take_magnitude(const ff_odds *odds, ff_range *range)
{
    uint32_t bits = 0, value = 1;
    while (bits < FF_TRAINED_CLASSES - 1 && ff_range_take(range, odds->beyond[bits])) bits++;
    if (bits > 0) value = 2 | ff_range_take(range, odds->second[bits]);
    if (bits > 1) value = value << 1 | ff_range_take(range, odds->third[2 * bits + (value & 1u)]);
    for (uint32_t i = 2; i < bits; i++) value = value << 1 | ff_range_take(range, HALF);
    return value;
}

static uint16_t take_height(void *context, const ff_expected *p)
{
    taking *t = context;
    ff_range range = t->range; /* in registers */
    const ff_odds *odds = t->odds + p->scale;
    int32_t residual = p->residual;
    if (!ff_range_take(&range, odds->zero)) {
        unsigned below = ff_range_take(&range, odds->below[p->phase]);
        int32_t magnitude = (int32_t)take_magnitude(odds, &range);
        residual += below ? -magnitude : magnitude;
        if (residual < INT16_MIN || residual > INT16_MAX) {
            refuse(t, FF_ERR_RANGE);
            residual = 0;
        }
    }
    t->range = range;
    return ff_dequantise(t->quantum, p->predicted, residual);
}

static uint16_t take_word(void *context, const ff_expected *p)
{
    taking *t = context;
    int32_t residual = 0;
    int rc = ff_take_words(&t->words, 0, &residual, 1);
    FF_ASSERT(rc == FF_OK); /* the first stage has counted them */
    (void)rc;
    return ff_dequantise(t->quantum, p->predicted, residual);
}

static void take_corners(const ff_terrain_info *info, taking *t, uint16_t *heights)
{
    for (uint32_t i = 0; i < FF_CORNERS; i++)
        heights[ff_corner_at(info, i)] = ff_dequantise_corner(t->quantum,
                                                              (int32_t)ff_tail_take(&t->tail, 16));
}

/* Whatever the bits behind a side's stream are, they do not change what it says. */
static int is_decided(const taking *t)
{
    const uint8_t *read = t->side_room + t->side_bytes - t->range.left - 4;
    uint32_t rest = UINT32_MAX >> ff_range_tail(t->range.width);
    FF_ASSERT(read >= t->side_room && rest < t->range.width);
    uint32_t beyond = ((uint32_t)read[0] << 24 | (uint32_t)read[1] << 16 | (uint32_t)read[2] << 8 |
                       read[3]) &
                      rest;
    return t->range.code >= beyond && t->range.code - beyond < t->range.width - rest;
}

/* A side's stream ends where its last decision leads, which is where its length says. */
static void end_side(taking *t)
{
    uint32_t bits = ff_range_bits(&t->range, t->side_bytes);
    FF_ASSERT(t->side < FF_SIDE_COUNT);
    if (bits > 8 * (t->side_bytes - 4) || !is_decided(t) ||
        (t->res->apart == FF_SIDES_MEASURED && bits != t->length[t->side]))
        refuse(t, FF_ERR_FORMAT);
    t->tail.at += bits;
    if (ff_tail_is_short(&t->tail)) refuse(t, FF_ERR_TRUNCATED);
}

static inline void put_word(uint8_t *to, uint32_t word)
{
    to[0] = (uint8_t)(word >> 24);
    to[1] = (uint8_t)(word >> 16);
    to[2] = (uint8_t)(word >> 8);
    to[3] = (uint8_t)word;
}

/* Bits from the tail's end on, as bytes. */
static void begin_side(taking *t, unsigned side)
{
    uint32_t from = t->tail.at / 8, shift = t->tail.at % 8;
    FF_ASSERT(t->side_bytes <= sizeof t->side_room && t->side_bytes % 4 == 0);
    const ff_tail tail = t->tail; /* in registers */
    uint32_t word = ff_tail_word(&tail, from);
    for (uint8_t *to = t->side_room, *end = to + t->side_bytes; to < end; to += 4) {
        uint32_t next = ff_tail_word(&tail, from += 4);
        put_word(to, word << shift | next >> 1 >> (31 - shift));
        word = next;
    }
    FF_ASSERT(side < FF_SIDE_COUNT);
    t->side = side;
    ff_range_read(&t->range, t->side_room, t->side_bytes);
}

/* All that lies before the tail. Where they share a byte, the stream's last bits stand in its place
 * while they are read. */
static void begin_stream(taking *t)
{
    uint8_t last;
    FF_ASSERT(!t->shared);
    if (t->rc != FF_OK) t->tail.at = 8 * t->tail.count;
    t->stream_bytes = ff_tail_before(&t->tail, &last);
    if (t->stream_bytes > 0) {
        t->shared = (uint8_t *)t->res->value + t->stream_bytes - 1;
        t->kept = *t->shared;
        *t->shared = last;
    }
    ff_range_read(&t->range, t->tail.bytes, t->stream_bytes);
}

/* Streams of sides, then that of all else. A side without points has none. */
static int take_side(void *context, unsigned side, uint32_t points)
{
    taking *t = context;
    FF_ASSERT(side <= FF_SIDE_COUNT);
    if (t->side < FF_SIDE_COUNT) end_side(t);
    t->side = FF_SIDE_COUNT;
    if (side == FF_SIDE_COUNT) {
        begin_stream(t);
        return 0;
    }
    if (t->res->sides >> side & 1u) return 1;
    if (t->res->apart == FF_SIDES_MEASURED && !points && t->length[side]) refuse(t, FF_ERR_FORMAT);
    if (points) begin_side(t, side);
    return 0;
}

/* A stream has been read to its last bit that is 1, and of what may be left out behind that, zeros,
 * there is less than a byte. */
static int is_all_taken(const taking *t)
{
    uint8_t last = t->shared ? *t->shared : 0;
    uint32_t told = ff_stream_bits(t->tail.bytes, t->stream_bytes, last),
             there = 8 * t->stream_bytes - t->tail.at % 8;
    return told <= 8 * (t->stream_bytes - (uint32_t)t->range.left) && there - told < 8;
}

/* Sides that are left out are known where the ground goes on beyond them. */
static int may_leave_out(const ff_terrain_info *info, const ff_residuals *res)
{
    uint32_t last = ff_refined_side(info) - 1;
    ff_cells cells = ff_cells_of(res->cells, last + 1);
    return !(res->sides >> FF_SIDE_EAST & 1u && ff_last_point(1, cells.columns) < last) &&
           !(res->sides >> FF_SIDE_NORTH & 1u && ff_last_point(1, cells.rows) < last);
}

static void take_lengths(const ff_terrain_info *info, taking *t)
{
    for (unsigned side = 0; side < FF_SIDE_COUNT; side++)
        t->length[side] = (uint16_t)ff_tail_number(&t->tail, ff_trained_length_order(info));
    if (ff_tail_is_short(&t->tail)) refuse(t, FF_ERR_TRUNCATED);
}

static void take_points(const ff_terrain_info *info, const uint16_t *parent, taking *t,
                        uint16_t *heights, void *room)
{
    const ff_residuals *res = t->res;
    int coded = res->apart != FF_SIDES_WORDS;
    int sides = res->apart == FF_SIDES_BARE || res->apart == FF_SIDES_MEASURED;
    ff_points points = { .height = coded ? take_height : take_word,
                         .side = sides ? take_side : NULL,
                         .context = t };
    FF_ASSERT(parent || !sides);
    if (res->apart == FF_SIDES_MEASURED) take_lengths(info, t);
    if (t->rc != FF_OK) return;
    if (coded && !sides) begin_stream(t);
    ff_expect(&ff_trained_tables, res->way, info, res->cells, parent, heights, room, &points);
    if (coded && !is_all_taken(t)) refuse(t, FF_ERR_FORMAT);
    if (t->shared) *t->shared = t->kept;
}

int ff_trained_reconstruct(const ff_terrain_info *info, const uint16_t *parent,
                           const ff_residuals *res, uint16_t *heights, void *room)
{
    const uint8_t *carried = (const uint8_t *)res->value;
    taking t = { .odds = ff_trained_tables.odds,
                 .words = { carried, carried + res->carried_bytes },
                 .tail = { carried, res->carried_bytes, res->head_bits },
                 .res = res,
                 .side = FF_SIDE_COUNT,
                 .side_bytes = ff_trained_side_bits(info) / 8 + 4,
                 .quantum = ff_quantum(info, !parent) };

    if (!parent) take_corners(info, &t, heights);
    if (ff_tail_is_short(&t.tail)) t.rc = FF_ERR_TRUNCATED;
    if (parent && !may_leave_out(info, res)) t.rc = FF_ERR_FORMAT;
    if (t.rc == FF_OK) take_points(info, parent, &t, heights, room);
    return t.rc;
}
