/* Codec "trained": residuals as one arithmetic stream, each by what is expected of its point
 * (ff_trained.h; SPEC.md, "Payload, codec 3"). The second stage of decoding reads it, while it
 * makes heights. */
#include "../codec/ff_body.h"
#include "ff_range.h"
#include "ff_trained.h"

enum ff_trained_body { BODY_CODED, BODY_WORDS };

#define HEAD_SET_SHIFT 4
#define HEAD_SET       (1u << HEAD_SET_SHIFT)

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
    return p->sample(p->context, point->at, point->predicted);
}

void ff_trained_predict(const ff_terrain_info *info, ff_cells cells, unsigned way,
                        const uint16_t *parent, uint16_t *grid, void *room, ff_sample_fn sample,
                        void *context)
{
    prediction p = { sample, context };
    ff_expect(&ff_trained_tables, way, info, cells, parent, grid, 0, room, pass_on, &p);
}

/* ---- decoder ---- */

/* A stream has fewer bytes than words, so what is carried tells by its size which it is. */
static size_t words_of(uint32_t count) { return 2 * (size_t)count; }

int ff_trained_decode(const ff_decoder *dec, ff_payload *in, const ff_contents *contents,
                      ff_residuals *out)
{
    uint8_t head = *in->at++;
    size_t bytes, words = words_of(contents->count);
    int rc;

    if (head & ~(FF_HEAD_ERRORS | HEAD_SET | BODY_WORDS)) return FF_ERR_FORMAT;
    out->way = (uint8_t)(head >> HEAD_SET_SHIFT);
    rc = ff_take_errors(in, (head & FF_HEAD_ERRORS) >> FF_HEAD_ERRORS_SHIFT, contents->errors, out);
    if (rc != FF_OK) return rc;
    bytes = ff_payload_left(in);
    if (head & BODY_WORDS ? bytes > words : bytes >= words) return FF_ERR_FORMAT;
    if (head & BODY_WORDS && bytes < words) return FF_ERR_TRUNCATED;
    return ff_carry(&dec->info, in, out);
}

typedef struct taking {
    ff_range range;
    ff_payload words; /* of BODY_WORDS */
    int32_t quantum;
    int rc;
} taking;

static uint32_t take_magnitude(ff_range *range, uint32_t scale)
{
    const ff_trained *by = &ff_trained_tables;
    uint32_t bits = 0, value = 1;
    while (bits < FF_TRAINED_CLASSES - 1 && ff_range_take(range, by->beyond[bits][scale])) bits++;
    if (bits > 0) value = 2 | ff_range_take(range, by->second[bits][scale]);
    if (bits > 1)
        value = value << 1 | ff_range_take(range, by->third[2 * bits + (value & 1u)][scale]);
    for (uint32_t i = 2; i < bits; i++) value = value << 1 | ff_range_take(range, HALF);
    return value;
}

static int32_t take_residual(ff_range *range, const ff_expected *p)
{
    const ff_trained *by = &ff_trained_tables;
    if (ff_range_take(range, by->zero[p->scale])) return p->residual;
    int below = (int)ff_range_take(range, by->below[p->phase][p->scale]);
    int32_t magnitude = (int32_t)take_magnitude(range, p->scale);
    return p->residual + (below ? -magnitude : magnitude);
}

static uint16_t take_height(void *context, const ff_expected *p)
{
    taking *t = context;
    int32_t residual = take_residual(&t->range, p);
    if (residual < INT16_MIN || residual > INT16_MAX) {
        t->rc = FF_ERR_RANGE;
        residual = 0;
    }
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

static int take_corners(const ff_terrain_info *info, taking *t, uint16_t *heights)
{
    int32_t value[FF_CORNERS];
    int rc = ff_take_words(&t->words, FF_CORNERS, value, FF_CORNERS);
    for (uint32_t i = 0; rc == FF_OK && i < FF_CORNERS; i++)
        heights[ff_corner_at(info, i)] = ff_dequantise(t->quantum, 0, value[i]);
    return rc;
}

/* A stream has no byte that says nothing. */
static int is_all_taken(const taking *t)
{
    return t->range.in == t->range.end && (t->words.at == t->words.end || t->words.end[-1]);
}

int ff_trained_reconstruct(const ff_terrain_info *info, const uint16_t *parent,
                           const ff_residuals *res, uint16_t *heights, void *room)
{
    const uint8_t *carried = (const uint8_t *)res->value;
    int coded = res->carried_bytes < words_of(ff_coded_count(info, res->cells, !parent));
    taking t = { .words = { carried, carried + res->carried_bytes },
                 .quantum = ff_quantum(info, !parent) };

    if (!parent) t.rc = take_corners(info, &t, heights);
    if (t.rc != FF_OK) return t.rc;
    if (coded) ff_range_read(&t.range, t.words.at, ff_payload_left(&t.words));
    ff_expect(&ff_trained_tables, res->way, info, res->cells, parent, heights, coded, room,
              coded ? take_height : take_word, &t);
    FF_ASSERT(coded || !ff_payload_left(&t.words));
    return t.rc == FF_OK && coded && !is_all_taken(&t) ? FF_ERR_FORMAT : t.rc;
}

/* ---- encoder ---- */

#ifdef FF_ENCODER
typedef struct putting {
    const ff_trained *by;
    ff_range_writer range;
    const int32_t *next;
    const uint16_t *decoded;
} putting;

static void put_magnitude(const ff_trained *by, ff_range_writer *range, uint32_t scale,
                          uint32_t value)
{
    uint32_t bits = 0;
    while (value >> bits >> 1) bits++;
    for (uint32_t i = 0; i < bits; i++) ff_range_put(range, by->beyond[i][scale], 1);
    if (bits < FF_TRAINED_CLASSES - 1) ff_range_put(range, by->beyond[bits][scale], 0);
    for (uint32_t i = 0; i < bits; i++) {
        uint32_t one = i == 0   ? by->second[bits][scale]
                       : i == 1 ? by->third[2 * bits + (value >> (bits - 1) & 1u)][scale]
                                : HALF;
        ff_range_put(range, one, value >> (bits - 1 - i) & 1u);
    }
}

static uint16_t put_height(void *context, const ff_expected *p)
{
    putting *to = context;
    const ff_trained *by = to->by;
    int32_t value = *to->next++ - p->residual;
    ff_range_put(&to->range, by->zero[p->scale], value == 0);
    if (value) {
        ff_range_put(&to->range, by->below[p->phase][p->scale], value < 0);
        put_magnitude(by, &to->range, p->scale, (uint32_t)(value < 0 ? -value : value));
    }
    return to->decoded[p->at];
}

size_t ff_trained_stream(const ff_trained *by, unsigned set, const ff_terrain_info *info,
                         ff_cells cells, const uint16_t *parent, const uint16_t *decoded,
                         const int32_t *residual, uint8_t *out, size_t limit)
{
    uint16_t grid[FF_REFINED_HEIGHTS_MAX];
    uint16_t room[FF_CODEC_ROOM_MAX / 2 + 1];
    putting to = { .by = by, .next = residual, .decoded = decoded };
    ff_range_write(&to.range, out, limit);
    for (uint32_t i = 0; !parent && i < FF_CORNERS; i++)
        grid[ff_corner_at(info, i)] = decoded[ff_corner_at(info, i)];
    ff_expect(by, set, info, cells, parent, grid, 1, room, put_height, &to);
    int bytes = ff_range_end(&to.range);
    return bytes < 0 ? limit : (size_t)bytes;
}

size_t ff_trained_encode(const ff_terrain_info *info, const uint16_t *parent,
                         const uint16_t *decoded, const ff_contents *contents,
                         const ff_residuals *res, uint8_t *out)
{
    enum ff_errors_form form = ff_errors_form_of(res, contents->errors);
    const int32_t *residual = res->value + contents->corners;
    uint32_t count = contents->count - contents->corners;
    size_t bytes = 1, coded;

    bytes += ff_put_errors(res, form, contents->errors, out + bytes);
    bytes += ff_put_words(res->value, contents->corners, out + bytes);
    out[0] = (uint8_t)((unsigned)form << FF_HEAD_ERRORS_SHIFT |
                       (unsigned)res->way << HEAD_SET_SHIFT | BODY_CODED);
    coded = ff_trained_stream(&ff_trained_tables, res->way, info, res->cells, parent, decoded,
                              residual, out + bytes, 2 * (size_t)count);
    if (coded < 2 * (size_t)count) return bytes + coded;
    out[0] |= BODY_WORDS;
    return bytes + ff_put_words(residual, count, out + bytes);
}
#endif
