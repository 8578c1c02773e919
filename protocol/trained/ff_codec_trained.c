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

/* A stream has fewer bytes than words, so what is carried tells by its size which it is. */
static size_t words_of(uint32_t count) { return 2 * (size_t)count; }

/* What the head says of the sides. FF_ERR_FORMAT: nothing that may be said. */
static int take_sides(unsigned head, int root, ff_residuals *out)
{
    unsigned form = head & FF_TRAINED_ALL;
    int words = form == FF_TRAINED_WORDS, whole = !(form & FF_TRAINED_WORDS);
    out->sides = whole ? (uint8_t)(form >> FF_TRAINED_SIDES_SHIFT) : 0;
    out->apart = root || words || form == FF_TRAINED_ONE ? FF_SIDES_NONE
                 : form                                  ? FF_SIDES_BARE
                                                         : FF_SIDES_MEASURED;
    if (root) return form && !words ? FF_ERR_FORMAT : FF_OK;
    return whole || words || form == FF_TRAINED_ALL || form == FF_TRAINED_ONE ? FF_OK
                                                                              : FF_ERR_FORMAT;
}

int ff_trained_decode(const ff_decoder *dec, ff_payload *in, const ff_contents *contents,
                      ff_residuals *out)
{
    uint8_t head = *in->at++;
    size_t bytes, words = words_of(contents->count);
    int rc = take_sides(head, contents->corners > 0, out);
    int plain = (head & FF_TRAINED_ALL) == FF_TRAINED_WORDS;

    if (rc != FF_OK) return rc;
    out->way = (uint8_t)((head & FF_TRAINED_SET) >> FF_TRAINED_SET_SHIFT);
    rc = ff_take_errors(in, (head & FF_HEAD_ERRORS) >> FF_HEAD_ERRORS_SHIFT, contents->errors, out);
    if (rc != FF_OK) return rc;
    bytes = ff_payload_left(in);
    if (plain ? bytes > words : bytes >= words) return FF_ERR_FORMAT;
    if (plain && bytes < words) return FF_ERR_TRUNCATED;
    return ff_carry(&dec->info, in, out);
}

typedef struct taking {
    ff_range range;
    const ff_odds *odds;
    ff_payload left; /* words, or streams that have not begun */
    const ff_residuals *res;
    uint8_t length[FF_SIDE_COUNT]; /* of the sides' streams, as they are told */
    unsigned side;                 /* whose stream is read, FF_SIDE_COUNT: none's */
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
    int rc = ff_take_words(&t->left, 0, &residual, 1);
    FF_ASSERT(rc == FF_OK); /* the first stage has counted them */
    (void)rc;
    return ff_dequantise(t->quantum, p->predicted, residual);
}

static int take_corners(const ff_terrain_info *info, taking *t, uint16_t *heights)
{
    int32_t value[FF_CORNERS];
    int rc = ff_take_words(&t->left, FF_CORNERS, value, FF_CORNERS);
    for (uint32_t i = 0; rc == FF_OK && i < FF_CORNERS; i++)
        heights[ff_corner_at(info, i)] = ff_dequantise_corner(t->quantum, value[i]);
    return rc;
}

/* A side's stream ends where its last decision leads, which is where its length says. */
static void end_side(taking *t)
{
    const uint8_t *next = ff_range_next(&t->range);
    FF_ASSERT(t->side < FF_SIDE_COUNT);
    if (!next) {
        refuse(t, FF_ERR_TRUNCATED);
        next = t->left.end;
    } else if (t->res->apart == FF_SIDES_MEASURED && next - t->left.at != t->length[t->side]) {
        refuse(t, FF_ERR_FORMAT);
    }
    t->left.at = next;
}

/* Streams of sides, then that of all else. A side without points has none. */
static int take_side(void *context, unsigned side, uint32_t points)
{
    taking *t = context;
    FF_ASSERT(side <= FF_SIDE_COUNT && t->left.at <= t->left.end);
    if (t->side < FF_SIDE_COUNT) end_side(t);
    t->side = FF_SIDE_COUNT;
    if (side == FF_SIDE_COUNT) {
        ff_range_read(&t->range, t->left.at, ff_payload_left(&t->left));
        return 0;
    }
    if (t->res->sides >> side & 1u) return 1;
    if (t->res->apart == FF_SIDES_MEASURED && !points && t->length[side]) refuse(t, FF_ERR_FORMAT);
    if (!points) return 0;
    t->side = side;
    ff_range_read(&t->range, t->left.at, ff_payload_left(&t->left));
    return 0;
}

/* A stream has no byte that says nothing. */
static int is_all_taken(const taking *t)
{
    return ff_range_is_read(&t->range) && (t->left.at == t->left.end || t->left.end[-1]);
}

/* Sides that are left out are known where the ground goes on beyond them. */
static int may_leave_out(const ff_terrain_info *info, const ff_residuals *res)
{
    uint32_t last = ff_refined_side(info) - 1;
    ff_cells cells = ff_cells_of(res->cells, last + 1);
    return !(res->sides >> FF_SIDE_EAST & 1u && ff_last_point(1, cells.columns) < last) &&
           !(res->sides >> FF_SIDE_NORTH & 1u && ff_last_point(1, cells.rows) < last);
}

static int take_lengths(const ff_terrain_info *info, taking *t)
{
    size_t bytes = ff_trained_lengths(info);
    if (ff_payload_left(&t->left) < bytes) return FF_ERR_TRUNCATED;
    ff_trained_lengths_of(info, t->left.at, t->length);
    t->left.at += bytes;
    return FF_OK;
}

static void take_points(const ff_terrain_info *info, const uint16_t *parent, taking *t,
                        uint16_t *heights, void *room)
{
    const ff_residuals *res = t->res;
    int coded = res->carried_bytes < words_of(ff_coded_count(info, res->cells, !parent));
    ff_points points = { .height = coded ? take_height : take_word,
                         .side = coded && res->apart ? take_side : NULL,
                         .context = t };
    FF_ASSERT(parent || !res->apart);
    if (coded && res->apart == FF_SIDES_MEASURED) refuse(t, take_lengths(info, t));
    if (coded && !res->apart) ff_range_read(&t->range, t->left.at, ff_payload_left(&t->left));
    if (t->rc != FF_OK) return;
    ff_expect(&ff_trained_tables, res->way, info, res->cells, parent, heights, room, &points);
    FF_ASSERT(coded || !ff_payload_left(&t->left));
    if (coded && !is_all_taken(t)) refuse(t, FF_ERR_FORMAT);
}

int ff_trained_reconstruct(const ff_terrain_info *info, const uint16_t *parent,
                           const ff_residuals *res, uint16_t *heights, void *room)
{
    const uint8_t *carried = (const uint8_t *)res->value;
    taking t = { .odds = ff_trained_tables.odds,
                 .left = { carried, carried + res->carried_bytes },
                 .res = res,
                 .side = FF_SIDE_COUNT,
                 .quantum = ff_quantum(info, !parent) };

    if (!parent) t.rc = take_corners(info, &t, heights);
    if (parent && !may_leave_out(info, res)) t.rc = FF_ERR_FORMAT;
    if (t.rc == FF_OK) take_points(info, parent, &t, heights, room);
    return t.rc;
}
