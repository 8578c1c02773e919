/* Codec trained beside the slow decoder: wild, flat and cut ground, any bytes; its streams, its
 * numbers, and payloads that must stay as they are. */
#include "../../protocol/trained/ff_trained.h"
#include "../rig/slow_decoder.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include <zlib.h>

static const uint16_t max_errors[] = { 0, 1, 4, 100, 32767 };
#define MAX_ERRORS (sizeof max_errors / sizeof *max_errors)

static uint16_t codec_room[FF_CODEC_ROOM_MAX / 2 + 1];
static uint32_t random_state = 1;

static uint32_t random_below(uint32_t limit)
{
    random_state = random_state * 1664525u + 1013904223u;
    return (uint32_t)((uint64_t)random_state * limit >> 32);
}

/* ---- grids ---- */

typedef struct grid_test {
    ff_terrain_info info;
    ff_cells cells;
    int root;
    uint16_t parent[FF_NODE_HEIGHTS_MAX], source[FF_REFINED_HEIGHTS_MAX],
        decoded[FF_REFINED_HEIGHTS_MAX];
    uint8_t payload[FF_PAYLOAD_BYTES_MAX];
    uint32_t count; /* residuals, of corners none */
} grid_test;

static uint32_t side_of(const grid_test *t)
{
    return t->root ? ff_node_side(&t->info) : ff_refined_side(&t->info);
}

/* The whole of it has ground. */
static void set_grid(grid_test *t, uint8_t k, int root, uint16_t max_error)
{
    t->info = (ff_terrain_info){
        .node_log2 = k, .tile_log2 = 8, .codec = FF_CODEC_TRAINED, .max_error = max_error
    };
    t->root = root;
    t->cells.columns = t->cells.rows = (uint8_t)(side_of(t) - 1);
}

enum { FLAT, NOISE, CLIFF, CHECKER, SMOOTH, ROUGH, EXTREMES, GROUNDS };

static uint16_t height_at(int kind, uint32_t x, uint32_t y)
{
    switch (kind) {
        case FLAT: return 4711;
        case NOISE: return (uint16_t)random_below(65536);
        case CLIFF: return x * 3 > y + 20 ? 65535 : 0;
        case CHECKER: return (x + y) & 1 ? 65535 : 0;
        case SMOOTH: return (uint16_t)(20000 + 7 * x * x - 3 * x * y + 90 * y);
        case ROUGH: return (uint16_t)(20000 + 300 * x + 100 * y + random_below(400));
        default: return random_below(2) ? 65535 : 0;
    }
}

/* Beyond its ground it repeats the last sample, as decoded grids do; the parent has every other
 * sample of it. */
static void make_ground(grid_test *t, int kind)
{
    uint32_t side = side_of(t), node = ff_node_side(&t->info);
    for (uint32_t y = 0; y < side; y++)
        for (uint32_t x = 0; x < side; x++) t->source[y * side + x] = height_at(kind, x, y);
    for (uint32_t y = 0; y < side; y++)
        for (uint32_t x = 0; x < side; x++) {
            uint32_t from_x = x < t->cells.columns ? x : t->cells.columns;
            uint32_t from_y = y < t->cells.rows ? y : t->cells.rows;
            t->source[y * side + x] = t->source[from_y * side + from_x];
        }
    for (uint32_t i = 0; i < node * node && !t->root; i++)
        t->parent[i] = t->source[2 * (i / node) * side + 2 * (i % node)];
}

static const uint16_t *parent_of(const grid_test *t) { return t->root ? NULL : t->parent; }

static int encode(grid_test *t)
{
    static int32_t value[FF_REFINED_HEIGHTS_MAX];
    static uint8_t body[FF_PAYLOAD_BYTES_MAX];
    ff_residuals res = { .cells = t->cells, .value = value, .body = body };
    ff_encode_heights(&t->info, parent_of(t), t->source, NULL, &res, t->decoded);
    t->count = res.count - (t->root ? FF_CORNERS : 0);
    return ff_encode_payload(&t->info, parent_of(t), t->decoded, &res, t->payload);
}

static int decode(const grid_test *t, const uint8_t *payload, size_t bytes, uint16_t *heights)
{
    static int32_t value[FF_REFINED_HEIGHTS_MAX];
    ff_residuals out = { .cells = t->cells, .value = value };
    size_t memory_bytes = ff_decoder_bytes(&t->info);
    void *memory = malloc(memory_bytes);
    ff_decoder *dec = ff_decoder_create(&t->info, memory, memory_bytes);
    int rc = t->root ? ff_decode_root(dec, payload, bytes, &out)
                     : ff_decode_refinement(dec, payload, bytes, &out);
    free(memory);
    if (rc != FF_OK) return rc;
    return t->root ? ff_reconstruct_root(&t->info, &out, heights, codec_room)
                   : ff_reconstruct_beside(&t->info, t->parent, &out, heights, codec_room);
}

/* Both decoders take the payload and make the same of it, or both refuse it. They find in the grid
 * what the encoder has made of its sides, should some be left out, and nothing of the rest. */
static int decode_both(const grid_test *t, const uint8_t *payload, size_t bytes, uint16_t *heights)
{
    static uint16_t slow[FF_REFINED_HEIGHTS_MAX];
    uint8_t *exact = malloc(bytes + 1); /* bytes beyond are not there */
    ff_terrain_info info = t->info;
    if (t->root && info.entered) info.max_error = 0;
    memcpy(exact, payload, bytes);
    exact = realloc(exact, bytes ? bytes : 1);
    for (uint32_t i = 0, side = side_of(t); i < side * side; i++) {
        int rim = i % side == 0 || i % side == side - 1 || i < side || i >= side * (side - 1);
        heights[i] = slow[i] = rim ? t->decoded[i] : 12345;
    }
    int rc = decode(t, exact, bytes, heights);
    int slow_rc = slow_decode_part(&info, t->cells.columns, t->cells.rows, parent_of(t), exact,
                                   bytes, slow);
    free(exact);
    assert_int_equal(rc == FF_OK, slow_rc >= 0);
    if (rc == FF_OK) assert_memory_equal(heights, slow, 2 * side_of(t) * side_of(t));
    return rc;
}

static void every_ground_comes_back(void **state)
{
    static grid_test t;
    static uint16_t again[FF_REFINED_HEIGHTS_MAX];
    (void)state;
    for (uint32_t run = 0; run < 5 * MAX_ERRORS * GROUNDS * 8; run++) {
        uint32_t e = run / 5 % MAX_ERRORS, way = run / 5 / MAX_ERRORS / GROUNDS;
        set_grid(&t, (uint8_t)(1 + run % 5), way & 1, max_errors[e]);
        t.info.entered = way == 7;
        uint32_t side = side_of(&t);
        if (way & 2) t.cells.columns = (uint8_t)(1 + random_below(side - 1));
        if (way & 4) t.cells.rows = (uint8_t)(1 + random_below(side - 1));
        make_ground(&t, (int)(run / 5 / MAX_ERRORS % GROUNDS));
        int bytes = encode(&t), error = t.info.entered ? 0 : t.info.max_error;
        assert_in_range(bytes, 1, 1 + 8 + 2 * t.count);
        assert_int_equal(decode_both(&t, t.payload, (size_t)bytes, again), FF_OK);
        assert_memory_equal(again, t.decoded, 2 * side * side);
        for (uint32_t i = 0; i < side * side; i++)
            assert_in_range(abs(again[i] - t.source[i]), 0, error);
    }
}

/* ---- any bytes ---- */

/* A stream of chance, or an encoded one of wild ground with a few bits turned. */
static size_t spoilt_payload(grid_test *t)
{
    size_t bytes = (size_t)encode(t);
    if (random_below(2)) {
        uint32_t before = 1 + (t->root ? 8 : 0);
        t->payload[0] = (uint8_t)random_below(4); /* no errors */
        if (random_below(2)) t->payload[0] |= (uint8_t)(random_below(16) << 4);
        if (random_below(4)) t->payload[0] &= (uint8_t)~FF_TRAINED_WORDS;
        bytes = before + ((t->payload[0] & FF_TRAINED_ALL) == FF_TRAINED_WORDS
                              ? 2 * t->count
                              : random_below(2 * t->count + 2));
        for (size_t i = 1; i < bytes; i++) t->payload[i] = (uint8_t)random_below(256);
    } else {
        for (uint32_t i = random_below(4); i > 0; i--)
            t->payload[random_below((uint32_t)bytes)] ^= (uint8_t)(1u << random_below(8));
        if (random_below(4) == 0) bytes = random_below((uint32_t)bytes + 1);
        if (random_below(4) == 0) t->payload[bytes++] = (uint8_t)random_below(256);
    }
    return bytes;
}

static void any_bytes_are_read_alike(void **state)
{
    static grid_test t;
    static uint16_t heights[FF_REFINED_HEIGHTS_MAX];
    uint32_t taken = 0, refused = 0;
    (void)state;
    for (int run = 0; run < 6000; run++) {
        set_grid(&t, (uint8_t)(1 + random_below(5)), (int)random_below(2),
                 random_below(2) ? max_errors[random_below(MAX_ERRORS)]
                                 : (uint16_t)random_below(32768));
        t.info.entered = random_below(8) == 0;
        if (random_below(2)) {
            t.cells.columns = (uint8_t)(1 + random_below(side_of(&t) - 1));
            t.cells.rows = (uint8_t)(1 + random_below(side_of(&t) - 1));
        }
        make_ground(&t, (int)random_below(GROUNDS));
        size_t bytes = spoilt_payload(&t);
        if (decode_both(&t, t.payload, bytes, heights) == FF_OK)
            taken++;
        else
            refused++;
    }
    assert_true(taken > 1000 && refused > 1000);
}

/* ---- sizes ---- */

static void flat_ground_needs_no_stream(void **state)
{
    static grid_test t;
    (void)state;
    for (uint8_t k = 1; k <= FF_NODE_LOG2_MAX; k++)
        for (uint32_t e = 0; e < MAX_ERRORS; e++)
            for (int root = 0; root < 2; root++) {
                set_grid(&t, k, root, max_errors[e]);
                make_ground(&t, FLAT);
                assert_int_equal(encode(&t), root ? 9 : 1);
                for (; t.cells.columns > 0; t.cells.columns--)
                    assert_int_equal(encode(&t), root ? 9 : 1);
                set_grid(&t, k, root, max_errors[e]);
                for (t.cells.columns = 1; t.cells.rows > 0; t.cells.rows--)
                    assert_int_equal(encode(&t), root ? 9 : 1);
            }
}

static void noise_is_stored_as_words(void **state)
{
    static grid_test t;
    (void)state;
    for (uint8_t k = 1; k <= FF_NODE_LOG2_MAX; k++)
        for (int root = 0; root < 2; root++) {
            set_grid(&t, k, root, 0);
            make_ground(&t, NOISE);
            uint32_t bytes = (uint32_t)encode(&t);
            assert_int_equal(bytes, 1 + (root ? 8 : 0) + 2 * t.count);
            assert_int_equal(t.payload[0], 1);
        }
}

/* ---- sets of weights ---- */

/* What the finest levels of real ground are like, and what coarse ones are. */
static void smooth_and_rough_ground_take_sets_of_their_own(void **state)
{
    static grid_test t;
    (void)state;
    for (uint8_t k = 3; k <= FF_NODE_LOG2_MAX; k++) {
        set_grid(&t, k, 0, 0);
        make_ground(&t, ROUGH);
        encode(&t);
        assert_int_equal(t.payload[0], FF_TRAINED_SET);
        for (uint32_t i = 0, side = side_of(&t); i < side * side; i++)
            t.source[i] = (uint16_t)(20000 + i % side * (i % side) / 4 + 25 * (i / side) +
                                     random_below(3));
        for (uint32_t i = 0, side = ff_node_side(&t.info); i < side * side; i++)
            t.parent[i] = t.source[2 * (i / side) * side_of(&t) + 2 * (i % side)];
        encode(&t);
        assert_int_equal(t.payload[0], 0);
    }
}

static uint16_t as_predicted(void *context, uint32_t at, int32_t predicted)
{
    (void)context, (void)at;
    return (uint16_t)predicted;
}

/* Below leaves there is no payload that could tell the set, so they are always of the first. */
static void ground_that_only_the_second_set_foresees_is_no_leaf(void **state)
{
    static grid_test t;
    static int32_t value[FF_REFINED_HEIGHTS_MAX];
    static uint8_t body[FF_PAYLOAD_BYTES_MAX];
    ff_residuals res = { .value = value, .body = body };
    (void)state;
    set_grid(&t, 2, 0, 0);
    make_ground(&t, ROUGH);
    res.cells = t.cells;
    for (unsigned way = 0; way < 2; way++) {
        ff_trained_predict(&t.info, t.cells, way, t.parent, t.source, codec_room, as_predicted,
                           NULL);
        ff_encode_heights(&t.info, t.parent, t.source, NULL, &res, t.decoded);
        assert_int_equal(res.way, way);
        for (uint32_t i = 0; i < res.count; i++)
            if (way == 0) assert_int_equal(value[i], 0);
        assert_int_equal(ff_is_as_predicted(&res), way == 0);
    }
}

/* ---- streams ---- */

static void streams_are_held_to_their_end(void **state)
{
    static grid_test t;
    static uint16_t heights[FF_REFINED_HEIGHTS_MAX];
    (void)state;
    for (uint8_t k = 2; k <= FF_NODE_LOG2_MAX; k++)
        for (int root = 0; root < 2; root++) {
            set_grid(&t, k, root, 4);
            make_ground(&t, ROUGH);
            size_t bytes = (size_t)encode(&t);
            assert_int_equal(t.payload[0] & 1, 0);
            for (size_t more = 1; more <= 5; more++) {
                memset(t.payload + bytes, 1, more - 1); /* a reader is up to four ahead */
                t.payload[bytes + more - 1] = 0;
                assert_int_equal(decode_both(&t, t.payload, bytes + more, heights), FF_ERR_FORMAT);
                t.payload[bytes + more - 1] = 1;
                int rc = decode_both(&t, t.payload, bytes + more, heights);
                if (more == 5) assert_int_equal(rc, FF_ERR_FORMAT);
            }
        }
}

/* Words tell at once how many there are; a stream that would be no shorter is none. */
static void bodies_are_no_longer_than_words(void **state)
{
    static grid_test t;
    static uint16_t heights[FF_REFINED_HEIGHTS_MAX];
    (void)state;
    for (uint8_t k = 1; k <= FF_NODE_LOG2_MAX; k++)
        for (int root = 0; root < 2; root++) {
            set_grid(&t, k, root, 0);
            make_ground(&t, EXTREMES);
            encode(&t);
            size_t words = 1 + (root ? 8 : 0) + 2 * t.count;
            memset(t.payload + 1, 0xff, words + 1);
            t.payload[0] = 1;
            assert_int_equal(decode_both(&t, t.payload, words - 1, heights), FF_ERR_TRUNCATED);
            assert_int_equal(decode_both(&t, t.payload, words, heights), FF_OK);
            assert_int_equal(decode_both(&t, t.payload, words + 1, heights), FF_ERR_FORMAT);
            t.payload[0] = 0;
            assert_int_equal(decode_both(&t, t.payload, words, heights), FF_ERR_FORMAT);
        }
}

/* ---- sides ---- */

/* Which of the sides' points are coded is known only where the ground goes on beyond them. */
static int may_leave_out(const grid_test *t, unsigned sides)
{
    uint32_t side = side_of(t);
    return !(sides >> FF_SIDE_EAST & 1u && (t->cells.columns + 1u) / 2 * 2 < side - 1) &&
           !(sides >> FF_SIDE_NORTH & 1u && (t->cells.rows + 1u) / 2 * 2 < side - 1);
}

static void what_lies_beside_a_node_need_not_come_again(void **state)
{
    static grid_test t;
    static uint16_t again[FF_REFINED_HEIGHTS_MAX];
    static uint8_t less[FF_PAYLOAD_BYTES_MAX];
    uint32_t left_out = 0;
    (void)state;
    for (uint32_t run = 0; run < 5 * MAX_ERRORS * 2 * 16; run++) {
        unsigned sides = run / 5 / MAX_ERRORS % 16;
        set_grid(&t, (uint8_t)(1 + run % 5), 0, max_errors[run / 5 % MAX_ERRORS]);
        if (run / 5 / MAX_ERRORS / 16)
            t.cells.columns = (uint8_t)(1 + random_below(side_of(&t) - 1));
        make_ground(&t, run % 2 ? ROUGH : SMOOTH);
        int bytes = encode(&t);
        int fewer = ff_without_sides(&t.info, t.payload, (size_t)bytes, sides, less);
        if (t.payload[0] & FF_TRAINED_ALL) { /* sides apart would not pay, or words are as short */
            assert_int_equal(fewer, 0);
            continue;
        }
        assert_in_range(fewer, 1, bytes - (int)ff_trained_lengths(&t.info));
        assert_int_equal(less[0], sides ? t.payload[0] | sides << 4 : t.payload[0] | 0xF1);
        if (!may_leave_out(&t, sides)) {
            assert_int_equal(decode_both(&t, less, (size_t)fewer, again), FF_ERR_FORMAT);
            continue;
        }
        assert_int_equal(decode_both(&t, less, (size_t)fewer, again), FF_OK);
        assert_memory_equal(again, t.decoded, 2 * side_of(&t) * side_of(&t));
        assert_int_equal(ff_without_sides(&t.info, less, (size_t)fewer, sides, t.payload), 0);
        left_out += sides != 0;
    }
    assert_true(left_out > 300);
}

/* Who has not put the sides into the grid is not given what happens to be there. */
static void sides_are_left_out_for_those_who_know_them(void **state)
{
    static grid_test t;
    static uint8_t less[FF_PAYLOAD_BYTES_MAX];
    static int32_t value[FF_REFINED_HEIGHTS_MAX];
    static uint16_t heights[FF_REFINED_HEIGHTS_MAX];
    ff_residuals out = { .value = value };
    (void)state;
    set_grid(&t, 3, 0, 0);
    make_ground(&t, ROUGH);
    out.cells = t.cells;
    int bytes = encode(&t), fewer = ff_without_sides(&t.info, t.payload, (size_t)bytes, 2, less);
    void *memory = malloc(ff_decoder_bytes(&t.info));
    ff_decoder *dec = ff_decoder_create(&t.info, memory, ff_decoder_bytes(&t.info));
    assert_int_equal(ff_decode_refinement(dec, less, (size_t)fewer, &out), FF_OK);
    assert_int_equal(out.sides, 1 << FF_SIDE_EAST);
    assert_int_equal(ff_reconstruct_refinement(&t.info, t.parent, &out, heights, codec_room),
                     FF_ERR_FORMAT);
    free(memory);
}

/* A payload that is cut anywhere, or whose lengths are wrong, is not read beyond its end. */
static void lengths_of_sides_are_held_to_the_payload(void **state)
{
    static grid_test t;
    static uint8_t less[FF_PAYLOAD_BYTES_MAX];
    static uint16_t heights[FF_REFINED_HEIGHTS_MAX];
    (void)state;
    set_grid(&t, 3, 0, 1);
    make_ground(&t, ROUGH);
    size_t bytes = (size_t)encode(&t), sides = 1 + 2;
    assert_int_equal(t.payload[0] & ~FF_TRAINED_SET, 0);
    for (unsigned s = 0; s < 4; s++) sides += t.payload[1 + s / 2] >> 4 * (s % 2) & 15u;
    for (size_t cut = 0; cut < sides; cut++) {
        uint8_t *exact = malloc(cut ? cut : 1);
        memcpy(exact, t.payload, cut);
        assert_int_equal(ff_without_sides(&t.info, exact, cut, 5, less), FF_ERR_TRUNCATED);
        free(exact);
        assert_true(decode_both(&t, t.payload, cut, heights) < 0);
    }
    for (unsigned s = 0; s < 4; s++) {
        t.payload[1 + s / 2] ^= (uint8_t)(1u << 4 * (s % 2));
        assert_true(decode_both(&t, t.payload, bytes, heights) < 0);
        t.payload[1 + s / 2] ^= (uint8_t)(1u << 4 * (s % 2));
    }
}

/* A head that means nothing is refused. */
static void heads_are_held_to_what_they_mean(void **state)
{
    static grid_test t;
    static uint16_t heights[FF_REFINED_HEIGHTS_MAX];
    (void)state;
    set_grid(&t, 3, 0, 0);
    make_ground(&t, FLAT);
    for (uint32_t head = 0; head < 256; head++) {
        uint8_t payload[1 + 4 + 2 * 208] = { (uint8_t)head };
        uint32_t form = head >> 2 & 3, errors = form == 1 ? 1 : form == 2 ? 4 : 0, kept = 4;
        uint32_t sides = head >> 4, words = head & 1, one = words && sides == 1;
        size_t bytes = 1 + errors;
        for (unsigned s = 0; s < 4; s++) kept -= !words && sides >> s & 1u;
        if (words && !sides) bytes += 2 * 208;
        /* a stream of zeros has a byte for each side */
        if (!words || sides == 15) bytes += (!sides ? 2 : 0) + kept;
        if (!sides && !words) payload[1 + errors] = payload[2 + errors] = 0x11;
        assert_int_equal(decode_both(&t, payload, bytes, heights),
                         words && sides && sides != 15 && !one ? FF_ERR_FORMAT : FF_OK);
    }
}

/* ---- leaves ---- */

/* What lies below a leaf has a residual of 0 everywhere, even where another one is likelier. */
static void below_leaves_all_is_prediction(void **state)
{
    static grid_test t;
    static uint16_t made[FF_REFINED_HEIGHTS_MAX], heights[FF_REFINED_HEIGHTS_MAX];
    static uint8_t payload[FF_PAYLOAD_BYTES_MAX];
    (void)state;
    for (uint8_t k = 1; k <= FF_NODE_LOG2_MAX; k++)
        for (uint32_t run = 0; run < MAX_ERRORS * GROUNDS * 2; run++) {
            set_grid(&t, k, 0, max_errors[run % MAX_ERRORS]);
            if (run % 2) t.cells.columns = (uint8_t)(1 + random_below(side_of(&t) - 1));
            make_ground(&t, (int)(run / MAX_ERRORS / 2));
            encode(&t);
            payload[0] = 1;
            assert_int_equal(decode_both(&t, payload, 1 + 2 * t.count, heights), FF_OK);
            ff_predict_children(&t.info, t.cells, t.parent, made, codec_room);
            assert_memory_equal(made, heights, 2 * side_of(&t) * side_of(&t));
        }
}

/* ---- numbers ---- */

/* A decision that cannot be would end the coder's interval. */
static void every_decision_is_possible(void **state)
{
    (void)state;
    for (uint32_t scale = 0; scale < FF_TRAINED_SCALES; scale++) {
        const uint16_t *one = (const uint16_t *)&ff_trained_tables.odds[scale];
        for (uint32_t i = 0; i < FF_TRAINED_DECISIONS; i++) assert_in_range(one[i], 1, 65535);
    }
}

static int64_t sizes(const int16_t *weight, uint32_t count)
{
    int64_t sum = 0;
    for (uint32_t i = 0; i < count; i++) sum += weight[i] < 0 ? -weight[i] : weight[i];
    return sum;
}

static void sums_of_what_is_around_a_point_fit_32_bits(void **state)
{
    (void)state;
    for (unsigned set = 0; set < FF_TRAINED_SETS; set++)
        for (unsigned kind = 0; kind < FF_POINTS; kind++) {
            const ff_weights *by = &ff_trained_tables.weights[set];
            const int16_t *trait = by->trait[kind];
            for (unsigned bucket = 0; bucket < FF_TRAINED_BUCKETS; bucket++) {
                const int16_t *tap = by->taps[kind][bucket].tap;
                int32_t sum = 0;
                for (unsigned i = 0; i < FF_TRAINED_TAPS; i++) sum += tap[i];
                assert_int_equal(by->taps[kind][bucket].sum, sum);
                assert_in_range(sizes(tap, FF_TRAINED_TAPS), 0, INT16_MAX);
            }
            assert_in_range(4 * sizes(trait, 1) + UINT16_MAX * sizes(trait + 1, 1) +
                                FF_TRAINED_TRAIT_MAX * sizes(trait + 2, FF_TRAINED_TRAITS - 2),
                            0, INT32_MAX);
        }
}

/* Ground without chance, whatever machine made it: its payloads and heights are part of the
 * format. Their CRC-32, by k; refinements, then roots. */
static void payloads_stay_as_they_are(void **state)
{
    static const uint32_t golden[2][FF_NODE_LOG2_MAX][2] = { { { 0xf4b6e208, 0xa0cd5391 },
                                                               { 0xc786fa0c, 0x27d2e8bf },
                                                               { 0x7c46a7c1, 0x75c47c94 },
                                                               { 0xfe559750, 0xd744b927 },
                                                               { 0x81577574, 0xac788f2c } },
                                                             { { 0xf90394b9, 0x8d79e344 },
                                                               { 0xc2008510, 0xb69fc640 },
                                                               { 0xbb70de47, 0x95c32ebb },
                                                               { 0x227dfd53, 0x87394c42 },
                                                               { 0x41b37a18, 0x0fc6f063 } } };
    static grid_test t;
    int differ = 0;
    (void)state;
    for (int root = 0; root < 2; root++)
        for (uint8_t k = 1; k <= FF_NODE_LOG2_MAX; k++) {
            uLong of_bytes = 0, of_heights = 0;
            random_state = 1;
            for (uint32_t e = 0; e < MAX_ERRORS; e++)
                for (int kind = CLIFF; kind <= ROUGH; kind++)
                    for (uint8_t cut = 0; cut < 2; cut++) {
                        set_grid(&t, k, root, max_errors[e]);
                        t.cells.rows = (uint8_t)(t.cells.rows - cut);
                        make_ground(&t, kind);
                        of_bytes = crc32(of_bytes, t.payload, (uInt)encode(&t));
                        for (uint32_t i = 0; i < side_of(&t) * side_of(&t); i++) {
                            const uint8_t two[2] = { (uint8_t)t.decoded[i],
                                                     (uint8_t)(t.decoded[i] >> 8) };
                            of_heights = crc32(of_heights, two, 2);
                        }
                    }
            if (golden[root][k - 1][0] == of_bytes && golden[root][k - 1][1] == of_heights)
                continue;
            print_message("# root %d, k %d: 0x%08lx, 0x%08lx\n", root, k, of_bytes, of_heights);
            differ++;
        }
    assert_int_equal(differ, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_ground_comes_back),
        cmocka_unit_test(any_bytes_are_read_alike),
        cmocka_unit_test(flat_ground_needs_no_stream),
        cmocka_unit_test(noise_is_stored_as_words),
        cmocka_unit_test(smooth_and_rough_ground_take_sets_of_their_own),
        cmocka_unit_test(ground_that_only_the_second_set_foresees_is_no_leaf),
        cmocka_unit_test(streams_are_held_to_their_end),
        cmocka_unit_test(bodies_are_no_longer_than_words),
        cmocka_unit_test(what_lies_beside_a_node_need_not_come_again),
        cmocka_unit_test(sides_are_left_out_for_those_who_know_them),
        cmocka_unit_test(lengths_of_sides_are_held_to_the_payload),
        cmocka_unit_test(heads_are_held_to_what_they_mean),
        cmocka_unit_test(below_leaves_all_is_prediction),
        cmocka_unit_test(every_decision_is_possible),
        cmocka_unit_test(sums_of_what_is_around_a_point_fit_32_bits),
        cmocka_unit_test(payloads_stay_as_they_are),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
