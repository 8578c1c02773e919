/* Height codec: bound, exactness, rims, sizes, damaged payloads; and the slow decoder beside it. */
#include "../../protocol/codec/ff_codec_local.h"
#include "../rig/slow_decoder.h"

#include <malloc.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include <zlib.h>

static uint16_t codec_room[FF_CODEC_ROOM_MAX / 2 + 1];

#define FIELD_MAX 129 /* samples a side of the largest ground here */

static uint32_t random_state = 1;

static uint32_t random_below(uint32_t limit)
{
    random_state = random_state * 1664525u + 1013904223u;
    return (random_state >> 8) % limit;
}

/* ---- grounds ---- */

typedef struct ground {
    uint32_t side;
    uint16_t height[FIELD_MAX * FIELD_MAX];
} ground;

enum { FLAT, RANDOM, CLIFF, CHECKER, RAMP, FRACTAL, GROUND_COUNT };

static uint32_t middle(uint32_t a, uint32_t b, uint32_t rough)
{
    uint32_t h = (a + b) / 2 + random_below(rough + 1);

    return h < rough / 2 ? 0 : h - rough / 2 > 65535 ? 65535 : h - rough / 2;
}

/* Midpoint displacement along rows, then along columns: ground that is rough at every scale. `side`
 * is a power of two plus one. */
static void fractal(ground *g)
{
    uint32_t side = g->side;

    g->height[0] = (uint16_t)random_below(65536);
    g->height[side - 1] = (uint16_t)random_below(65536);
    for (uint32_t half = (side - 1) / 2, rough = 8000; half > 0; half /= 2, rough /= 2)
        for (uint32_t x = half; x < side; x += 2 * half)
            g->height[x] = (uint16_t)middle(g->height[x - half], g->height[x + half], rough);
    for (uint32_t x = 0; x < side; x++)
        g->height[(side - 1) * side + x] = (uint16_t)middle(g->height[x], g->height[x], 8000);
    for (uint32_t half = (side - 1) / 2, rough = 8000; half > 0; half /= 2, rough /= 2)
        for (uint32_t y = half; y < side; y += 2 * half)
            for (uint32_t x = 0; x < side; x++)
                g->height[y * side + x] = (uint16_t)middle(g->height[(y - half) * side + x],
                                                           g->height[(y + half) * side + x], rough);
}

static void make_ground(ground *g, int kind, uint32_t side)
{
    g->side = side;
    for (uint32_t i = 0; i < side * side; i++) {
        uint32_t x = i % side, y = i / side;
        g->height[i] = (uint16_t)(kind == FLAT      ? 4711
                                  : kind == RANDOM  ? random_below(65536)
                                  : kind == CLIFF   ? (x * 3 > y + side) * 65535u
                                  : kind == CHECKER ? ((x + y) & 1u) * 65535u
                                                    : 65535u * (x + 2 * y) / (3 * (side - 1)));
    }
    if (kind == FRACTAL) fractal(g);
}

static void cut(const ground *g, uint32_t x0, uint32_t y0, uint32_t step, uint32_t side,
                uint16_t *out)
{
    for (uint32_t j = 0; j < side; j++)
        for (uint32_t i = 0; i < side; i++)
            *out++ = g->height[(y0 + j * step) * g->side + x0 + i * step];
}

/* ---- one payload there and back ---- */

static ff_terrain_info terrain(int k, int levels, enum ff_codec_id codec, uint32_t max_error)
{
    return (ff_terrain_info){ .node_log2 = (uint8_t)k,
                              .tile_log2 = (uint8_t)(k + levels - 1),
                              .codec = (uint8_t)codec,
                              .max_error = (uint16_t)max_error,
                              .tiles_x = 2,
                              .tiles_y = 2,
                              .spacing_wu = 1,
                              .hscale_q24 = 1 };
}

static ff_decoder *decoder_for(const ff_terrain_info *info)
{
    ff_decoder *dec = ff_decoder_create(info, malloc(ff_decoder_bytes(info)),
                                        ff_decoder_bytes(info));

    assert_non_null(dec);
    return dec;
}

/* Both stages of decoding: FF_OK, or the error of the first that fails. */
static int decode(ff_decoder *dec, const ff_terrain_info *info, const uint16_t *parent,
                  const uint8_t *payload, size_t bytes, uint8_t child_error[4], uint16_t *heights)
{
    static int32_t value[FF_REFINED_HEIGHTS_MAX];
    ff_residuals residuals = { .value = value };
    int rc = parent ? ff_decode_refinement(dec, payload, bytes, &residuals)
                    : ff_decode_root(dec, payload, bytes, &residuals);

    memcpy(child_error, residuals.child_error, 4);
    if (rc != FF_OK) return rc;
    return parent ? ff_reconstruct_beside(info, parent, &residuals, heights, codec_room)
                  : ff_reconstruct_root(info, &residuals, heights, codec_room);
}

/* Encodes (parent NULL: a root), decodes with both decoders, and checks the bound, rims and sizes
 * on the way. Returns the payload's bytes. */
static int there_and_back(const ff_terrain_info *info, const uint16_t *parent,
                          const uint16_t *source, uint8_t *payload, uint16_t *decoded)
{
    static uint16_t again[FF_REFINED_HEIGHTS_MAX], slow[FF_REFINED_HEIGHTS_MAX];
    static const uint8_t errors[4] = { 0, 31, 77, 208 };
    uint8_t told[4];
    uint32_t side = parent ? ff_refined_side(info) : ff_node_side(info);
    ff_decoder *dec = decoder_for(info);
    int bytes = parent ? ff_encode_refinement(info, parent, source, errors, payload, decoded)
                       : ff_encode_root(info, source, errors[2], payload, decoded);

    assert_in_range(bytes, 1, FF_PAYLOAD_BYTES_MAX);
    assert_in_range(bytes, 1, 5 + 2 * side * side);
    assert_int_equal(decode(dec, info, parent, payload, (size_t)bytes, told, again), FF_OK);
    if (parent)
        assert_memory_equal(told, errors, 4);
    else
        assert_int_equal(told[0], errors[2]);
    free(dec);
    assert_memory_equal(again, decoded, side * side * sizeof(*decoded));
    assert_int_equal(slow_decode(info, parent, payload, (size_t)bytes, slow), 0);
    assert_memory_equal(slow, decoded, side * side * sizeof(*decoded));
    for (uint32_t i = 0; i < side * side; i++) {
        if (parent && i / side % 2 == 0 &&
            i % side % 2 == 0) /* the parent's own samples, bit for bit */
            assert_int_equal(decoded[i], parent[i / side / 2 * ff_node_side(info) + i % side / 2]);
        else
            assert_in_range(abs(decoded[i] - source[i]), 0, info->max_error);
    }
    return bytes;
}

static void bound_holds(const ff_terrain_info *info)
{
    static ground g;
    static uint16_t source[FF_REFINED_HEIGHTS_MAX], root[FF_REFINED_HEIGHTS_MAX],
        refined[FF_REFINED_HEIGHTS_MAX];
    static uint8_t payload[FF_PAYLOAD_BYTES_MAX];

    for (int kind = 0; kind < GROUND_COUNT; kind++) {
        make_ground(&g, kind, ff_refined_side(info));
        cut(&g, 0, 0, 2, ff_node_side(info), source);
        there_and_back(info, NULL, source, payload, root);
        there_and_back(info, root, g.height, payload, refined);
    }
}

static void bound_holds_on_every_ground(void **state)
{
    static const uint32_t max_errors[] = { 0, 1, 4, 100, 32767 };

    (void)state;
    for (int codec = 0; codec < FF_CODEC_COUNT; codec++)
        for (size_t e = 0; e < sizeof(max_errors) / sizeof(max_errors[0]); e++)
            for (int k = 1; k <= FF_NODE_LOG2_MAX; k++) {
                ff_terrain_info info = terrain(k, 2, (enum ff_codec_id)codec, max_errors[e]);
                bound_holds(&info);
            }
}

/* ---- a whole terrain of 2 by 2 tiles ---- */

typedef struct walk {
    const ff_terrain_info *info;
    const ground *source;
    ground at_level[8]; /* decoded heights of each level, laid out in the finest grid */
    uint8_t set[8][FIELD_MAX * FIELD_MAX];
} walk;

/* Every node that holds a sample must have decoded it to the same height. */
static void note(walk *w, uint32_t level, uint32_t x0, uint32_t y0, const uint16_t *heights)
{
    uint32_t side = ff_node_side(w->info),
             step = 1u << (w->info->tile_log2 - level - w->info->node_log2);

    for (uint32_t i = 0; i < side * side; i++) {
        uint32_t at = (y0 + i / side * step) * w->source->side + x0 + i % side * step;
        if (w->set[level][at]) assert_int_equal(w->at_level[level].height[at], heights[i]);
        w->set[level][at] = 1;
        w->at_level[level].height[at] = heights[i];
    }
}

static void walk_node(walk *w, uint32_t level, uint32_t x0, uint32_t y0, const uint16_t *heights)
{
    uint32_t edge = 1u << (w->info->tile_log2 - level);
    uint16_t source[FF_REFINED_HEIGHTS_MAX], refined[FF_REFINED_HEIGHTS_MAX],
        child[FF_NODE_HEIGHTS_MAX];
    uint8_t payload[FF_PAYLOAD_BYTES_MAX];

    note(w, level, x0, y0, heights);
    if (level + 1 == ff_terrain_levels(w->info)) return;
    cut(w->source, x0, y0, edge >> (w->info->node_log2 + 1), ff_refined_side(w->info), source);
    there_and_back(w->info, heights, source, payload, refined);
    for (uint32_t q = 0; q < 4; q++) {
        ff_refined_child(w->info, refined, q, child);
        walk_node(w, level + 1, x0 + (q & 1) * edge / 2, y0 + (q >> 1) * edge / 2, child);
    }
}

static void walk_terrain(walk *w, const ff_terrain_info *info, const ground *source)
{
    uint16_t heights[FF_NODE_HEIGHTS_MAX], root[FF_NODE_HEIGHTS_MAX];
    uint8_t payload[FF_PAYLOAD_BYTES_MAX];

    memset(w, 0, sizeof(*w));
    w->info = info;
    w->source = source;
    for (uint32_t tile = 0; tile < 4; tile++) {
        uint32_t edge = 1u << info->tile_log2, x0 = (tile & 1) * edge, y0 = (tile >> 1) * edge;
        cut(source, x0, y0, edge >> info->node_log2, ff_node_side(info), heights);
        there_and_back(info, NULL, heights, payload, root);
        walk_node(w, 0, x0, y0, root);
    }
}

static walk one, other;

static void rims_agree_on_every_level(void **state)
{
    static const uint32_t max_errors[] = { 0, 3, 500 };
    static ground g;

    (void)state;
    for (int run = 0; run < 24; run++) {
        int k = run % 4 + 1;
        ff_terrain_info info = terrain(k, 3, run < 12 ? FF_CODEC_DEFLATE : FF_CODEC_TRAINED,
                                       max_errors[run / 4 % 3]);
        make_ground(&g, run % 2 ? RANDOM : FRACTAL, (2u << info.tile_log2) + 1);
        walk_terrain(&one, &info, &g);
    }
}

/* A rim depends on the heights along it alone: another ground with the same rim between the tiles
 * decodes to the same rim. */
static void rims_depend_on_rims_alone(void **state)
{
    static ground g, h;
    uint32_t middle_x = 32;

    (void)state;
    make_ground(&g, FRACTAL, 2 * middle_x + 1);
    make_ground(&h, RANDOM, g.side);
    for (uint32_t y = 0; y < g.side; y++)
        h.height[y * g.side + middle_x] = g.height[y * g.side + middle_x];
    for (int codec = FF_CODEC_DEFLATE; codec < FF_CODEC_COUNT; codec++) {
        ff_terrain_info info = terrain(3, 3, (enum ff_codec_id)codec, 7);
        walk_terrain(&one, &info, &g);
        walk_terrain(&other, &info, &h);
        for (uint32_t level = 0; level < 3; level++)
            for (uint32_t y = 0; y < g.side; y++)
                assert_int_equal(one.at_level[level].height[y * g.side + middle_x],
                                 other.at_level[level].height[y * g.side + middle_x]);
    }
}

/* Where sample i of square ground lies in its image: mirrored either way, or transposed. */
static uint32_t image_of(int kind, uint32_t side, uint32_t i)
{
    uint32_t x = i % side, y = i / side;

    return kind == 0   ? y * side + side - 1 - x
           : kind == 1 ? (side - 1 - y) * side + x
                       : x * side + y;
}

/* Axes may run against each other or be swapped across a border (cube faces): mirrored ground
 * decodes to the mirror image; of codec trained, along the tiles' rims. */
static void mirrored_ground_decodes_mirrored(void **state)
{
    static ground g, mirrored;
    uint32_t side = 65, edge = 32;

    (void)state;
    make_ground(&g, RANDOM, side);
    mirrored.side = side;
    for (int run = 0; run < 6; run++) {
        int kind = run % 3, rims = run >= 3;
        ff_terrain_info info = terrain(3, 3, rims ? FF_CODEC_TRAINED : FF_CODEC_DEFLATE, 7);
        for (uint32_t i = 0; i < side * side; i++)
            mirrored.height[image_of(kind, side, i)] = g.height[i];
        walk_terrain(&one, &info, &g);
        walk_terrain(&other, &info, &mirrored);
        for (uint32_t i = 0; i < side * side; i++)
            if (!rims || i % side % edge == 0 || i / side % edge == 0)
                assert_int_equal(other.at_level[2].height[image_of(kind, side, i)],
                                 one.at_level[2].height[i]);
    }
}

/* ---- sizes ---- */

static void flat_ground_is_one_byte(void **state)
{
    static uint16_t flat[FF_REFINED_HEIGHTS_MAX], decoded[FF_REFINED_HEIGHTS_MAX];
    static const uint8_t zero[4] = { 0, 0, 0, 0 }, same[4] = { 9, 9, 9, 9 };
    uint8_t payload[FF_PAYLOAD_BYTES_MAX];

    (void)state;
    for (uint32_t i = 0; i < FF_REFINED_HEIGHTS_MAX; i++) flat[i] = 999;
    for (int run = 0; run < 3 * FF_NODE_LOG2_MAX; run++) {
        ff_terrain_info info = terrain(1 + run / 3, 2,
                                       (enum ff_codec_id)(FF_CODEC_DEFLATE + run % 3), 0);
        assert_int_equal(ff_encode_refinement(&info, flat, flat, zero, payload, decoded), 1);
        /* told one by one, in a few bits each */
        assert_int_equal(ff_encode_refinement(&info, flat, flat, same, payload, decoded),
                         info.codec == FF_CODEC_TRAINED ? 4 : 2);
        assert_int_equal(ff_encode_root(&info, flat, 0, payload, decoded), 9);
    }
}

/* Ground of little relief costs far less than 16 bits, ground of noise hardly more. */
static void sizes_follow_the_ground(void **state)
{
    static uint16_t parent[FF_NODE_HEIGHTS_MAX], refined[FF_REFINED_HEIGHTS_MAX];
    static uint8_t payload[FF_PAYLOAD_BYTES_MAX];
    static ground g;
    ff_terrain_info info = terrain(3, 2, FF_CODEC_DEFLATE, 0);
    int smooth_bytes, noise_bytes;

    (void)state;
    make_ground(&g, RANDOM, 17);
    cut(&g, 0, 0, 2, 9, parent);
    noise_bytes = there_and_back(&info, parent, g.height, payload, refined);
    for (uint32_t i = 0; i < 17 * 17; i++)
        g.height[i] = (uint16_t)(1000 + i % 17 * (i / 17) + random_below(4));
    cut(&g, 0, 0, 2, 9, parent);
    smooth_bytes = there_and_back(&info, parent, g.height, payload, refined);
    assert_in_range(noise_bytes, 1, 5 + 2 * 208);
    assert_in_range(smooth_bytes, 1, 5 + 208 * 3 / 8);
}

static void error_codes_never_understate(void **state)
{
    (void)state;
    for (uint32_t steps = 0; steps <= 65536; steps++) {
        uint8_t code = ff_geometric_error_encode(steps);
        assert_in_range(code, 0, 208);
        assert_in_range(ff_geometric_error_decode(code), steps, steps + steps / 16);
        if (code > 0) assert_true(ff_geometric_error_decode((uint8_t)(code - 1)) < steps);
    }
    assert_int_equal(ff_geometric_error_encode(UINT32_MAX), 208);
}

static void bad_error_codes_are_refused(void **state)
{
    static uint16_t flat[FF_REFINED_HEIGHTS_MAX], decoded[FF_REFINED_HEIGHTS_MAX];
    static const uint8_t bad[4] = { 0, 0, 209, 0 };
    uint8_t payload[FF_PAYLOAD_BYTES_MAX];
    ff_terrain_info info = terrain(3, 2, FF_CODEC_DEFLATE, 0);

    (void)state;
    assert_int_equal(ff_encode_root(&info, flat, 209, payload, decoded), FF_ERR_RANGE);
    assert_int_equal(ff_encode_refinement(&info, flat, flat, bad, payload, decoded), FF_ERR_RANGE);
}

/* ---- damaged payloads ---- */

static int check_damaged(const ff_terrain_info *info, ff_decoder *dec, const uint16_t *parent,
                         const uint8_t *payload, size_t bytes)
{
    static uint16_t heights[FF_REFINED_HEIGHTS_MAX], slow[FF_REFINED_HEIGHTS_MAX];
    uint8_t *exact = malloc(bytes > 0 ? bytes : 1), told[4];
    int rc;

    memcpy(exact, payload, bytes);
    memset(heights, 0, sizeof(heights)); /* of sides that are told to be left out */
    memset(slow, 0, sizeof(slow));
    rc = decode(dec, info, parent, exact, bytes, told, heights);
    assert_true(rc == FF_OK || rc == FF_ERR_TRUNCATED || rc == FF_ERR_FORMAT || rc == FF_ERR_RANGE);
    assert_int_equal(rc == FF_OK, slow_decode(info, parent, exact, bytes, slow) >= 0);
    if (rc == FF_OK) {
        uint32_t side = parent ? ff_refined_side(info) : ff_node_side(info);
        assert_memory_equal(heights, slow, side * side * sizeof(*heights));
    }
    free(exact);
    return rc;
}

/* A payload cut anywhere, with any one bit flipped, or a byte too long. One of codec trained that
 * is cut is read on as zeros, and told of by its last bits, so it may be another one. */
static void damage(const ff_terrain_info *info, const uint16_t *parent, uint8_t *payload, int bytes)
{
    ff_decoder *dec = decoder_for(info);

    for (int cut_at = 0; cut_at < bytes; cut_at++) {
        int rc = check_damaged(info, dec, parent, payload, (size_t)cut_at);
        if (info->codec != FF_CODEC_TRAINED) assert_int_equal(rc, FF_ERR_TRUNCATED);
    }
    for (int bit = 0; bit < 8 * bytes; bit++) {
        payload[bit / 8] ^= (uint8_t)(1u << bit % 8);
        check_damaged(info, dec, parent, payload, (size_t)bytes);
        payload[bit / 8] ^= (uint8_t)(1u << bit % 8);
    }
    payload[bytes] = 0;
    int rc = check_damaged(info, dec, parent, payload, (size_t)bytes + 1);
    if (info->codec != FF_CODEC_TRAINED) assert_int_equal(rc, FF_ERR_FORMAT);
    free(dec);
}

static void damaged_payloads_do_no_harm(void **state)
{
    static uint16_t source[FF_REFINED_HEIGHTS_MAX], root[FF_REFINED_HEIGHTS_MAX],
        refined[FF_REFINED_HEIGHTS_MAX];
    static uint8_t payload[FF_PAYLOAD_BYTES_MAX];
    static ground g;

    (void)state;
    for (int codec = 0; codec < FF_CODEC_COUNT; codec++)
        for (uint32_t max_error = 0; max_error <= 50; max_error += 50) {
            ff_terrain_info info = terrain(3, 2, (enum ff_codec_id)codec, max_error);
            make_ground(&g, FRACTAL, 17);
            cut(&g, 0, 0, 2, 9, source);
            int bytes = there_and_back(&info, NULL, source, payload, root);
            damage(&info, NULL, payload, bytes);
            bytes = there_and_back(&info, root, g.height, payload, refined);
            damage(&info, root, payload, bytes);
        }
}

/* ---- deflate bodies, made here: the encoder takes them for repetitive ground only ---- */

/* A refinement payload of 2^3 nodes: high parts through zlib, low bits all ones. Bytes. */
static size_t deflate_payload(uint32_t low, const uint8_t *high, uint32_t count, uint8_t *out)
{
    size_t low_bytes = (208 * low + 7) / 8;
    z_stream z = { 0 };

    out[0] = (uint8_t)(2u | low << 4);
    memset(out + 1, 0xff, low_bytes);
    assert_int_equal(deflateInit2(&z, 9, Z_DEFLATED, -9, 8, Z_DEFAULT_STRATEGY), Z_OK);
    z.next_in = (z_const Bytef *)high;
    z.avail_in = count;
    z.next_out = out + 1 + low_bytes;
    z.avail_out = 1000;
    assert_int_equal(deflate(&z, Z_FINISH), Z_STREAM_END);
    deflateEnd(&z);
    return (size_t)(z.next_out - out);
}

static void deflate_bodies_are_held_to_their_length(void **state)
{
    static int32_t value[FF_REFINED_HEIGHTS_MAX];
    static uint16_t parent[FF_NODE_HEIGHTS_MAX];
    ff_terrain_info info = terrain(3, 2, FF_CODEC_DEFLATE, 0);
    ff_residuals residuals = { .value = value };
    ff_decoder *dec = decoder_for(&info);
    uint8_t payload[2000], high[300];

    (void)state;
    for (uint32_t i = 0; i < 300; i++) high[i] = (uint8_t)(i * i);
    for (uint32_t low = 0; low <= 8; low++) {
        size_t bytes = deflate_payload(low, high, 208, payload);
        assert_int_equal(ff_decode_refinement(dec, payload, bytes, &residuals), FF_OK);
        for (uint32_t i = 0; i < 208; i++) {
            int32_t v = high[i] << low | ((1 << low) - 1);
            assert_int_equal(value[i], v % 2 ? -(v + 1) / 2 : v / 2);
        }
        check_damaged(&info, dec, parent, payload, bytes);
        assert_int_equal(ff_decode_refinement(dec, payload, bytes + 1, &residuals), FF_ERR_FORMAT);
        assert_int_equal(ff_decode_refinement(dec, payload, bytes - 1, &residuals),
                         FF_ERR_TRUNCATED);
        for (uint32_t count = 207; count <= 209; count += 2) {
            bytes = deflate_payload(low, high, count, payload);
            assert_int_equal(ff_decode_refinement(dec, payload, bytes, &residuals), FF_ERR_FORMAT);
        }
        for (size_t bit = 0; bit < 8 * bytes; bit++) {
            payload[bit / 8] ^= (uint8_t)(1u << bit % 8);
            check_damaged(&info, dec, parent, payload, bytes);
            payload[bit / 8] ^= (uint8_t)(1u << bit % 8);
        }
    }
    size_t bytes = deflate_payload(9, high, 208, payload); /* 255 << 9 needs 17 bits */
    assert_int_equal(ff_decode_refinement(dec, payload, bytes, &residuals), FF_ERR_RANGE);
    free(dec);
}

/* ---- the table ---- */

/* Packs hold a codec's number: each row is complete and keeps its number. */
static void every_row_is_whole(void **state)
{
    (void)state;
    for (int codec = 0; codec < FF_CODEC_COUNT; codec++) {
        const ff_codec *row = ff_codec_row(codec);
        assert_true(row && row->name && row->memory && row->decode && row->reconstruct);
        assert_non_null(ff_codec_encoder(codec));
        assert_string_equal(ff_codec_name(codec), row->name);
        assert_true(ff_codec_supported(codec));
        for (int before = 0; before < codec; before++)
            assert_string_not_equal(ff_codec_name(before), row->name);
    }
    assert_string_equal(ff_codec_name(0), "raw");
    assert_string_equal(ff_codec_name(1), "deflate");
    assert_string_equal(ff_codec_name(2), "rice");
    assert_string_equal(ff_codec_name(3), "trained");
    assert_null(ff_codec_name(-1));
    assert_null(ff_codec_name(FF_CODEC_COUNT));
    assert_false(ff_codec_supported(FF_CODEC_COUNT));
}

/* ---- memory ---- */

#ifdef __SANITIZE_ADDRESS__
/* a sanitizer's function for which gcc ships no header */
int __sanitizer_install_malloc_and_free_hooks(void (*taken)(const volatile void *, size_t),
                                              void (*given)(const volatile void *));
static size_t allocations;
static void count_allocation(const volatile void *address, size_t bytes)
{
    (void)address;
    (void)bytes;
    allocations++;
}
static void count_free(const volatile void *address) { (void)address; }
static void count_from_now(void)
{
    __sanitizer_install_malloc_and_free_hooks(count_allocation, count_free);
}
static size_t counted(void) { return allocations; }
#else
static size_t counted(void) { return mallinfo2().uordblks; }
static void count_from_now(void) {}
#endif

static void decoding_allocates_nothing(void **state)
{
    static ground g;
    static uint16_t root[FF_NODE_HEIGHTS_MAX], heights[FF_REFINED_HEIGHTS_MAX];
    static uint8_t payload[FF_PAYLOAD_BYTES_MAX];
    static const uint8_t errors[4];
    int done = 0;

    (void)state;
    count_from_now();
    for (int run = 0; run < FF_CODEC_COUNT * FF_NODE_LOG2_MAX; run++) {
        int codec = run / FF_NODE_LOG2_MAX, k = run % FF_NODE_LOG2_MAX + 1;
        ff_terrain_info info = terrain(k, 2, (enum ff_codec_id)codec, 2);
        uint8_t told[4];
        size_t block_bytes = ff_decoder_bytes(&info), before;
        uint8_t *block = malloc(block_bytes + 64);
        make_ground(&g, FRACTAL, (2u << k) + 1);
        cut(&g, 0, 0, 2, ff_node_side(&info), root);
        int bytes = ff_encode_refinement(&info, root, g.height, errors, payload, heights);
        memset(block + block_bytes, 0xa5, 64);
        assert_null(ff_decoder_create(&info, block, block_bytes - 1));
        before = counted();
        ff_decoder *dec = ff_decoder_create(&info, block, block_bytes);
        for (int i = 0; i < 100; i++)
            done += decode(dec, &info, root, payload, (size_t)bytes, told, heights) == FF_OK;
        assert_int_equal(counted(), before);
        for (int i = 0; i < 64; i++) assert_int_equal(block[block_bytes + (size_t)i], 0xa5);
        free(block);
    }
    assert_int_equal(done, 100 * FF_CODEC_COUNT * FF_NODE_LOG2_MAX);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bound_holds_on_every_ground),
        cmocka_unit_test(rims_agree_on_every_level),
        cmocka_unit_test(rims_depend_on_rims_alone),
        cmocka_unit_test(mirrored_ground_decodes_mirrored),
        cmocka_unit_test(flat_ground_is_one_byte),
        cmocka_unit_test(sizes_follow_the_ground),
        cmocka_unit_test(error_codes_never_understate),
        cmocka_unit_test(bad_error_codes_are_refused),
        cmocka_unit_test(damaged_payloads_do_no_harm),
        cmocka_unit_test(deflate_bodies_are_held_to_their_length),
        cmocka_unit_test(every_row_is_whole),
        cmocka_unit_test(decoding_allocates_nothing),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
