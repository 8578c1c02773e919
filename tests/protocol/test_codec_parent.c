/* A codec whose contexts need the parent's heights is possible: this file has one, as one more row
 * of the library's table. Tested: the codec by itself, damaged payloads, and the whole way through
 * the client. */
#include "../../client/ff_client_local.h"
#include "../../protocol/codec/ff_codec_local.h"
#include "../rig/client_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static uint16_t codec_room[FF_CODEC_ROOM_MAX / 2 + 1];

/* ---- the codec: Golomb-Rice, as many low bits as the parent is rough around the sample ----
 *
 * Head: form of the error codes; error codes; corners of a root, 16 bits each; then each residual
 * as v (0, -1, 1, ... are 0, 1, 2, ...): v >> low as that many 1 bits and a 0 bit, then `low` bits;
 * or ESCAPE 1 bits and 16 bits. Bits fill bytes from their lowest. `low` of a refinement: from the
 * highest and the lowest corner of the parent's cell; of a root: from the value before. */

#define CODEC_BY_PARENT FF_CODEC_COUNT
#define ESCAPE          12u

typedef struct bits {
    const uint8_t *in, *end; /* decoding */
    uint8_t *out;            /* encoding */
    size_t at;               /* in bits */
    int error;
} bits;

/* One sample after the other, in coding order; the same contexts on both sides. */
typedef struct coder {
    const ff_terrain_info *info;
    const uint16_t *parent;
    bits bits;
    uint32_t before;         /* v of the sample before */
    const int32_t *residual; /* encoding: the next one */
    const uint16_t *decoded; /* encoding */
} coder;

static unsigned length_of(uint32_t value)
{
    unsigned length = 0;

    while (value >> length) length++;
    return length;
}

static unsigned low_bits(const coder *c, uint32_t at)
{
    uint32_t side = ff_refined_side(c->info), node_side = ff_node_side(c->info);
    uint32_t i = at % side / 2, j = at / side / 2, lowest = UINT16_MAX, highest = 0;

    if (!c->parent) return length_of(c->before) / 2;
    for (uint32_t corner = 0; corner < 4; corner++) {
        uint32_t x = i + (corner & 1u), y = j + (corner >> 1);
        uint32_t h = c->parent[(y < node_side ? y : j) * node_side + (x < node_side ? x : i)];
        lowest = h < lowest ? h : lowest;
        highest = h > highest ? h : highest;
    }
    return length_of((highest - lowest) / (8u * (uint32_t)ff_quantum(c->info, !c->parent)));
}

static unsigned take_bit(bits *b)
{
    const uint8_t *byte = b->in + b->at / 8;

    if (byte >= b->end) {
        b->error = FF_ERR_TRUNCATED;
        return 0;
    }
    return *byte >> b->at++ % 8 & 1u;
}

static uint32_t take_value(bits *b, unsigned low)
{
    uint32_t high = 0, rest = 0;

    while (high < ESCAPE && take_bit(b)) high++;
    if (high == ESCAPE) low = 16;
    for (unsigned i = 0; i < low; i++) rest |= take_bit(b) << i;
    if (high < ESCAPE && (high << low | rest) > UINT16_MAX) b->error = FF_ERR_RANGE;
    return high == ESCAPE ? rest : high << low | rest;
}

static void put_bit(bits *b, unsigned bit)
{
    if (b->at % 8 == 0) b->out[b->at / 8] = 0;
    b->out[b->at / 8] |= (uint8_t)(bit << b->at % 8);
    b->at++;
}

static void put_value(bits *b, unsigned low, uint32_t value)
{
    uint32_t high = value >> low < ESCAPE ? value >> low : ESCAPE;

    for (uint32_t i = 0; i < high; i++) put_bit(b, 1);
    if (high < ESCAPE) put_bit(b, 0);
    for (unsigned i = 0; i < (high < ESCAPE ? low : 16); i++) put_bit(b, value >> i & 1u);
}

static uint16_t take_sample(void *context, uint32_t at, int32_t predicted)
{
    coder *c = context;

    c->before = c->bits.error ? 0 : take_value(&c->bits, low_bits(c, at));
    return ff_dequantise(ff_quantum(c->info, !c->parent), predicted, ff_unzigzag(c->before));
}

static uint16_t put_sample(void *context, uint32_t at, int32_t predicted)
{
    coder *c = context;
    uint32_t value = ff_zigzag(*c->residual++);

    (void)predicted;
    put_value(&c->bits, low_bits(c, at), value);
    c->before = value;
    return c->decoded[at];
}

static int first_stage(const ff_decoder *dec, ff_payload *in, const ff_contents *contents,
                       ff_residuals *out)
{
    unsigned form = *in->at++;
    int rc = ff_take_errors(in, form, contents->errors, out);

    return rc == FF_OK ? ff_carry(&dec->info, in, out) : rc;
}

static int second_stage(const ff_terrain_info *info, const uint16_t *parent,
                        const ff_residuals *res, uint16_t *heights, void *room)
{
    const uint8_t *carried = (const uint8_t *)res->value;
    ff_payload in = { carried, carried + res->carried_bytes };
    coder c = { .info = info, .parent = parent };
    int32_t corner[FF_CORNERS];
    int rc = parent ? FF_OK : ff_take_words(&in, FF_CORNERS, corner, FF_CORNERS);

    (void)room;
    if (rc != FF_OK) return rc;
    c.bits = (bits){ .in = in.at, .end = in.end };
    for (uint32_t i = 0; i < FF_CORNERS && !parent; i++)
        heights[ff_corner_at(info, i)] = ff_dequantise_corner(ff_quantum(info, !parent), corner[i]);
    ff_interpolate(info, res->cells, 0, parent, heights, NULL, take_sample, &c);
    if (c.bits.error) return c.bits.error;
    return (c.bits.at + 7) / 8 == ff_payload_left(&in) ? FF_OK : FF_ERR_FORMAT;
}

static int add_a_byte_each; /* spoils every n-th payload so that the second stage refuses it */
static int payloads_made;

static size_t encode(const ff_terrain_info *info, const uint16_t *parent, const uint16_t *decoded,
                     const ff_contents *contents, const ff_residuals *res, uint8_t *out)
{
    static uint16_t grid[FF_REFINED_HEIGHTS_MAX];
    coder c = { .info = info, .parent = parent, .residual = res->value, .decoded = decoded };
    size_t bytes = 1;

    out[0] = FF_ERRORS_EACH;
    bytes += ff_put_errors(res, FF_ERRORS_EACH, contents->errors, out + bytes);
    bytes += ff_put_words(res->value, contents->corners, out + bytes);
    c.residual += contents->corners;
    c.bits.out = out + bytes;
    for (uint32_t i = 0; i < contents->corners; i++)
        grid[ff_corner_at(info, i)] = decoded[ff_corner_at(info, i)];
    ff_interpolate(info, res->cells, 0, parent, grid, NULL, put_sample, &c);
    bytes += (c.bits.at + 7) / 8;
    if (add_a_byte_each && ++payloads_made % add_a_byte_each == 0) out[bytes++] = 0;
    return bytes;
}

/* ---- the table, linked in place of ff_codec_table.c ---- */

/* clang-format off */
const ff_codec *ff_codec_row(int codec)
{
#define ROW(number, constant, name, needs, head, ways, memory, decode, predict, reconstruct, make, encode) \
    { name, FF_NEEDS_##needs, memory, decode, predict, reconstruct },
    static const ff_codec rows[] = { FF_CODEC_LIST(ROW)
        { "parent", FF_NEEDS_PARENT, ff_no_memory, first_stage, ff_interpolate, second_stage } };
#undef ROW
    return codec >= 0 && codec <= CODEC_BY_PARENT ? &rows[codec] : NULL;
}

ff_encode_fn *ff_codec_encoder(int codec)
{
#define ROW(number, constant, name, needs, head, ways, memory, decode, predict, reconstruct, make, encode) encode,
    static ff_encode_fn *const encoders[] = { FF_CODEC_LIST(ROW) encode };
#undef ROW
    return codec >= 0 && codec <= CODEC_BY_PARENT ? encoders[codec] : NULL;
}

ff_make_fn *ff_codec_maker(int codec)
{
#define ROW(number, constant, name, needs, head, ways, memory, decode, predict, reconstruct, make, encode) make,
    static ff_make_fn *const makers[] = { FF_CODEC_LIST(ROW) ff_make_residuals };
#undef ROW
    return codec >= 0 && codec <= CODEC_BY_PARENT ? makers[codec] : NULL;
}

size_t ff_codec_head(int codec)
{
#define ROW(number, constant, name, needs, head, ways, memory, decode, predict, reconstruct, make, encode) head,
    static const uint8_t heads[] = { FF_CODEC_LIST(ROW) 0 };
#undef ROW
    return codec >= 0 && codec <= CODEC_BY_PARENT ? heads[codec] : 0;
}

unsigned ff_codec_ways(int codec)
{
#define ROW(number, constant, name, needs, head, ways, memory, decode, predict, reconstruct, make, encode) ways,
    static const uint8_t all[] = { FF_CODEC_LIST(ROW) 1 };
#undef ROW
    return codec >= 0 && codec <= CODEC_BY_PARENT ? all[codec] : 0;
}
/* clang-format on */

/* ---- payloads ---- */

typedef struct payload {
    ff_terrain_info info;
    uint16_t parent[FF_NODE_HEIGHTS_MAX], decoded[FF_REFINED_HEIGHTS_MAX];
    uint8_t bytes[FF_PAYLOAD_BYTES_MAX];
    int count;
} payload;

static ff_terrain_info terrain(int k, uint32_t max_error)
{
    ff_terrain_info info = pack_fixture_info(6, 2, 2);

    info.node_log2 = (uint8_t)k;
    info.max_error = (uint16_t)max_error;
    info.flags = max_error ? FF_TERRAIN_LOSSY : 0;
    info.codec = CODEC_BY_PARENT;
    return info;
}

/* Hills, or noise for which no number of low bits fits. */
static void refine_ground(payload *p, int k, uint32_t max_error, int noise)
{
    static const uint8_t errors[4] = { 1, 2, 3, 208 };
    static uint16_t source[FF_REFINED_HEIGHTS_MAX], root[FF_NODE_HEIGHTS_MAX];
    uint32_t side;

    p->info = terrain(k, max_error);
    side = ff_refined_side(&p->info);
    for (uint32_t i = 0; i < side * side; i++)
        source[i] = noise ? (uint16_t)(i * i * 40503u >> 3)
                          : pack_fixture_hills(NULL, i % side, i / side);
    for (uint32_t i = 0; i < ff_root_count(&p->info); i++)
        root[i] = source[i / ff_node_side(&p->info) * 2 * side + i % ff_node_side(&p->info) * 2];
    assert_true(ff_encode_root(&p->info, root, 7, p->bytes, p->parent) > 0);
    p->count = ff_encode_refinement(&p->info, p->parent, source, errors, p->bytes, p->decoded);
    assert_in_range(p->count, 1, FF_PAYLOAD_BYTES_MAX);
}

/* Both stages of decoding; everything lies in blocks of exactly its size. */
static int decode_exactly(const payload *p, const uint8_t *bytes, size_t count, uint16_t *heights)
{
    size_t side = ff_refined_side(&p->info);
    ff_residuals residuals = { .value = malloc(side * side * sizeof(int32_t)) };
    uint8_t *copy = malloc(count ? count : 1);
    ff_decoder *dec = ff_decoder_create(&p->info, malloc(ff_decoder_bytes(&p->info)),
                                        ff_decoder_bytes(&p->info));
    int rc;

    memcpy(copy, bytes, count);
    rc = ff_decode_refinement(dec, copy, count, &residuals);
    free(copy); /* the second stage sees only what the first one carried over */
    if (rc == FF_OK) {
        assert_int_equal(residuals.count, 0);
        rc = ff_reconstruct_refinement(&p->info, p->parent, &residuals, heights, codec_room);
    }
    free(dec);
    free(residuals.value);
    return rc;
}

static void contexts_come_from_the_parent(void **state)
{
    static payload p;
    static uint16_t heights[FF_REFINED_HEIGHTS_MAX];

    (void)state;
    for (int run = 0; run < FF_NODE_LOG2_MAX * 4; run++) {
        int k = run / 4 + 1, noise = run & 1, max_error = run & 2 ? 5 : 0;
        refine_ground(&p, k, (uint32_t)max_error, noise);
        size_t side = ff_refined_side(&p.info);
        assert_int_equal(decode_exactly(&p, p.bytes, (size_t)p.count, heights), FF_OK);
        assert_memory_equal(heights, p.decoded, side * side * sizeof(*heights));
        /* another parent gives other contexts, so a larger node's bits do not end where the payload
         * does */
        for (uint32_t i = 0; i < ff_root_count(&p.info); i++) p.parent[i] = 500;
        if (k >= 3 && !noise)
            assert_int_not_equal(decode_exactly(&p, p.bytes, (size_t)p.count, heights), FF_OK);
    }
}

static void damaged_payloads_do_no_harm(void **state)
{
    static payload p;
    static uint16_t heights[FF_REFINED_HEIGHTS_MAX];
    int refused = 0;

    (void)state;
    refine_ground(&p, 3, 0, 0);
    for (int cut = 0; cut < p.count; cut++)
        assert_int_equal(decode_exactly(&p, p.bytes, (size_t)cut, heights), FF_ERR_TRUNCATED);
    for (int bit = 0; bit < 8 * p.count; bit++) {
        p.bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
        int rc = decode_exactly(&p, p.bytes, (size_t)p.count, heights);
        assert_true(rc == FF_OK || rc == FF_ERR_TRUNCATED || rc == FF_ERR_FORMAT ||
                    rc == FF_ERR_RANGE);
        refused += rc != FF_OK;
        p.bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
    }
    assert_true(refused > 0);
    p.bytes[p.count] = 0;
    assert_int_equal(decode_exactly(&p, p.bytes, (size_t)p.count + 1, heights), FF_ERR_FORMAT);
}

/* What the first stage carries over fits the memory of the values, or the first stage refuses the
 * payload. */
static void long_payloads_are_not_carried(void **state)
{
    static payload p;
    static uint8_t bytes[FF_PAYLOAD_BYTES_MAX * 2];
    static uint16_t heights[FF_REFINED_HEIGHTS_MAX];

    (void)state;
    bytes[0] = FF_ERRORS_ZERO;
    for (int k = 1; k <= FF_NODE_LOG2_MAX; k++) {
        p.info = terrain(k, 0);
        size_t room = sizeof(int32_t) * ff_refined_side(&p.info) * ff_refined_side(&p.info);
        assert_true(room + 2 <= sizeof(bytes));
        assert_int_equal(decode_exactly(&p, bytes, room + 2, heights), FF_ERR_RANGE);
        assert_int_equal(decode_exactly(&p, bytes, room + 1, heights), FF_ERR_FORMAT);
    }
}

/* ---- through the client ---- */

static void open_with(client_rig *rig, int codec)
{
    pack_fixture_desc desc = { .info = terrain(3, 0), .height = pack_fixture_hills };
    size_t bytes;

    rig_open(rig, 0);
    rig->desc.panorama.enabled = 0;
    desc.info.codec = (uint8_t)codec;
    free(rig->pack_bytes);
    rig->pack_bytes = pack_fixture_make(&desc, &bytes);
    assert_non_null(rig->pack_bytes);
    assert_int_equal(ff_pack_open(&rig->pack, rig->pack_bytes, bytes), FF_OK);
}

static void shows_what_raw_shows(void **state)
{
    static client_rig raw, link, local;

    (void)state;
    open_with(&raw, FF_CODEC_RAW);
    open_with(&link, CODEC_BY_PARENT);
    open_with(&local, CODEC_BY_PARENT);
    rig_client(&raw, 2u << 20);
    rig_client(&link, 2u << 20);
    rig_local_client(&local, 2u << 20);
    assert_true(rig_settle(&raw, 400) && rig_settle(&link, 400) && rig_settle(&local, 400));
    assert_true(rig_stats(&link).tree.nodes_drawn > 20);
    assert_int_equal(rig_stats(&link).requests_failed + rig_stats(&local).requests_failed, 0);
    assert_true(rig_same_picture(&raw, &link));
    assert_true(rig_same_picture(&raw, &local));
    assert_true(link.bytes_down < raw.bytes_down);
    /* no client memory is set apart for it */
    assert_int_equal(rig_stats(&raw).tree.nodes_capacity, rig_stats(&link).tree.nodes_capacity);
    rig_close(&raw);
    rig_close(&link);
    rig_close(&local);
}

/* A payload that only the second stage refuses is treated like one that the first refuses: asked
 * for three times, then left. Everything else arrives. A refused root leaves no node behind. */
static void refused_by_the_tree(void **state)
{
    static const int each[] = { 7, 1 };

    (void)state;
    for (int run = 0; run < 2; run++) {
        static client_rig rig;
        add_a_byte_each = each[run];
        payloads_made = 0;
        open_with(&rig, CODEC_BY_PARENT);
        add_a_byte_each = 0;
        rig.desc.no_views = 1; /* each refusal ends a request */
        rig_client(&rig, 2u << 20);
        for (int i = 0; i < 400; i++) rig_step(&rig, 50000);
        ff_client_stats stats = rig_stats(&rig);
        assert_true(stats.requests_failed > 0);
        assert_int_equal(stats.requests_failed % FF_REFUSALS_TRIES, 0);
        assert_int_equal(stats.in_flight + stats.queued, 0);
        assert_int_equal(stats.protocol_errors, 0);
        if (each[run] == 1)
            assert_int_equal(stats.tree.nodes_held, 0);
        else
            assert_true(stats.tree.nodes_drawn > 4);
        rig_close(&rig);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(contexts_come_from_the_parent),
                                        cmocka_unit_test(damaged_payloads_do_no_harm),
                                        cmocka_unit_test(long_payloads_are_not_carried),
                                        cmocka_unit_test(shows_what_raw_shows),
                                        cmocka_unit_test(refused_by_the_tree) };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
