/* Packs entered below their tops, as a session hands them out: every node has the heights and marks
 * that it has in the whole pack, made roots too, and a second decoder reads those alike. */
#include "../../protocol/ff_entry.h"
#include "../../protocol/shape/ff_shape.h"
#include "../../server/packs/ff_packs.h"
#include "../../server/packs/ff_packs_entered.h"
#include "../rig/pack_fixture.h"
#include "../rig/slow_decoder.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static uint16_t codec_room[FF_CODEC_ROOM_MAX / 2 + 1];

#define EDGE_WU (32 * 256 * 64) /* of the packs' tiles */

typedef struct known_node {
    uint16_t heights[FF_NODE_HEIGHTS_MAX];
    uint8_t code, leaf, filled, stub;
} known_node;

static void *decoder_memory;
static ff_decoder *decoder;

static void turn_decoder(const ff_terrain_info *info)
{
    free(decoder_memory);
    decoder_memory = malloc(ff_decoder_bytes(info));
    decoder = ff_decoder_create(info, decoder_memory, ff_decoder_bytes(info));
    assert_non_null(decoder);
}

static void take(known_node *node, const ff_residuals *r, uint32_t q)
{
    node->code = r->child_error[q];
    node->leaf = r->leaf >> q & 1u;
    node->filled = r->filled >> q & 1u;
    node->stub = r->stub >> q & 1u;
}

/* What a client comes to know of a node, from its tile's root down; 0: nothing is stored. */
static int know(const ff_pack *pack, ff_key key, known_node *node)
{
    static int32_t value[FF_REFINED_HEIGHTS_MAX];
    const ff_terrain_info *info = &pack->header.info;
    const uint8_t *payload;
    uint16_t refined[FF_REFINED_HEIGHTS_MAX];
    ff_key at = ff_key_make(ff_key_tile(key), 0, 0);
    ff_residuals r = { .cells = ff_shape_cells(info, at, 0), .value = value };
    turn_decoder(info);
    int bytes = ff_pack_record(pack, FF_SECTION_ROOT, at, &payload);
    if (bytes == FF_ERR_NOT_FOUND) return 0;
    assert_true(bytes > 0);
    assert_int_equal(ff_decode_root(decoder, payload, (size_t)bytes, &r), FF_OK);
    assert_int_equal(ff_reconstruct_root(info, &r, node->heights, codec_room), FF_OK);
    take(node, &r, 0);
    for (uint32_t level = ff_key_level(key); level-- > 0;) {
        uint32_t q = ff_key_code(key) >> 2 * level & 3u;
        r.cells = ff_shape_cells(info, at, 1);
        if (node->stub) return 0;
        if (node->leaf) {
            r = ff_leaf_residuals(info, node->code, node->filled);
            r.value = value;
            ff_predict_children(info, ff_shape_cells(info, at, 1), node->heights, refined,
                                codec_room);
        } else {
            bytes = ff_pack_record(pack, FF_SECTION_REFINEMENT, at, &payload);
            assert_true(bytes > 0);
            assert_int_equal(ff_decode_refinement(decoder, payload, (size_t)bytes, &r), FF_OK);
            assert_int_equal(
                ff_reconstruct_refinement(info, node->heights, &r, refined, codec_room), FF_OK);
        }
        ff_refined_child(info, refined, q, node->heights);
        take(node, &r, q);
        at = ff_key_child(at, q);
    }
    return 1;
}

static void assert_second_decoder_agrees(const ff_pack *pack, ff_key root, const known_node *node)
{
    ff_terrain_info exact = pack->header.info;
    ff_cells cells = ff_shape_cells(&exact, root, 0);
    const uint8_t *payload;
    uint16_t heights[FF_NODE_HEIGHTS_MAX];
    int bytes = ff_pack_record(pack, FF_SECTION_ROOT, root, &payload);
    exact.max_error = 0;
    assert_true(bytes > 0);
    assert_int_equal(
        slow_decode_part(&exact, cells.columns, cells.rows, NULL, payload, (size_t)bytes, heights),
        node->filled | node->leaf << 4 | node->stub << 8);
    assert_memory_equal(heights, node->heights,
                        ff_node_side(&exact) * ff_node_side(&exact) * sizeof *heights);
}

/* All nodes of a pack, entered and as it is stored, whose tiles are numbered alike from 0 on. */
static void assert_same_nodes(const ff_pack *entered, const ff_pack *whole)
{
    const ff_terrain_info *info = &entered->header.info, *whole_info = &whole->header.info;
    static known_node a, b;
    for (uint32_t t = 0; t < ff_shape_tiles(info); t++)
        for (uint32_t level = 0; level < ff_terrain_levels(info); level++)
            for (uint32_t code = 0; code < 1u << 2 * level; code++) {
                ff_key key = ff_key_make(info->first_tile + t, level, code);
                if (!ff_shape_has_ground(info, key)) continue;
                int there = know(entered, key, &a);
                assert_int_equal(there, know(whole, ff_entry_key(whole_info, info, key), &b));
                if (!there) continue;
                assert_memory_equal(a.heights, b.heights,
                                    ff_node_side(info) * ff_node_side(info) * sizeof *a.heights);
                assert_int_equal(a.code, b.code);
                assert_int_equal(a.leaf, b.leaf);
                assert_int_equal(a.filled, b.filled);
                assert_int_equal(a.stub, b.stub);
                if (level == 0) assert_second_decoder_agrees(entered, key, &a);
            }
}

static uint8_t *open_pack(pack_fixture_desc *desc, ff_pack *pack)
{
    size_t bytes;
    uint8_t *memory = pack_fixture_make(desc, &bytes);
    assert_non_null(memory);
    assert_int_equal(ff_pack_open(pack, memory, bytes), FF_OK);
    return memory;
}

static void check_levels(const ff_pack *whole)
{
    for (uint32_t level = 1; level < 4; level++) {
        ff_packs_entered *entered;
        assert_int_equal(ff_packs_enter(whole, EDGE_WU >> (level + 1), &entered), FF_OK);
        assert_non_null(entered);
        assert_int_equal(ff_packs_entered_first(entered)->header.info.entered, level);
        assert_same_nodes(ff_packs_entered_first(entered), whole);
        ff_packs_leave(entered);
    }
}

static void every_node_is_as_in_the_whole(void **state)
{
    (void)state;
    for (uint8_t codec = 0; ff_codec_name(codec); codec++)
        for (uint16_t error = 0; error <= 6; error += 3)
            for (int kind = 0; kind < 4; kind++) {
                pack_fixture_desc desc = { .info = pack_fixture_info(6, 2, 1),
                                           .height = pack_fixture_hills };
                ff_pack whole;
                desc.info.codec = codec;
                desc.info.max_error = error;
                if (kind == 1) ff_shape_cover(&desc.info, 75, 50);
                if (kind == 2) desc.filled = pack_fixture_hole;
                if (kind == 3) desc.leaf_level = 1;
                uint8_t *memory = open_pack(&desc, &whole);
                check_levels(&whole);
                free(memory);
            }
}

static void below_a_stub_there_is_nothing(void **state)
{
    pack_fixture_desc desc = { .info = pack_fixture_info(6, 1, 1),
                               .height = pack_fixture_hills,
                               .stub_level = 1 };
    ff_pack whole;
    (void)state;
    uint8_t *memory = open_pack(&desc, &whole);
    check_levels(&whole);
    free(memory);
}

static void several_are_entered_each_by_its_own_size(void **state)
{
    pack_fixture_desc desc = { .info = pack_fixture_info(6, 2, 1), .height = pack_fixture_hills };
    ff_pack whole[2], alone[2];
    uint8_t *memory[2];
    ff_packs_entered *entered;
    (void)state;
    for (int i = 0; i < 2; i++) {
        desc.info.epsg = 32632;
        desc.info.origin_x_mm = 5000000 * i;
        if (i) desc.info.spacing_wu /= 4;
        memory[i] = open_pack(&desc, &whole[i]);
        alone[i] = whole[i];
    }
    assert_int_equal(ff_pack_join(&whole[0], &whole[1]), FF_OK);
    assert_int_equal(ff_packs_enter(&whole[0], EDGE_WU / 8, &entered), FF_OK);
    const ff_pack *first = ff_packs_entered_first(entered);
    assert_int_equal(first->header.info.entered, 2);
    assert_int_equal(first->next->header.info.entered, 0);
    assert_int_equal(first->next->header.info.first_tile, 32);
    assert_int_equal(first->next->header.info.west_wu, 5000 * 256);
    assert_same_nodes(first, &alone[0]);
    /* the coarse one is entered deeper than that one, which is of the size of a view */
    const uint8_t *a, *b;
    int bytes = ff_pack_record(first, FF_SECTION_ROOT, ff_key_make(33, 0, 0), &a);
    assert_int_equal(bytes, ff_pack_record(&alone[1], FF_SECTION_ROOT, ff_key_make(1, 0, 0), &b));
    assert_memory_equal(a, b, (size_t)bytes);
    ff_packs_leave(entered);
    for (int i = 0; i < 2; i++) free(memory[i]);
}

static void those_that_gain_nothing_or_are_parts_are_left_as_they_are(void **state)
{
    pack_fixture_desc desc = { .info = pack_fixture_info(6, 2, 1), .height = pack_fixture_hills };
    ff_pack whole;
    ff_packs_entered *entered;
    (void)state;
    uint8_t *memory = open_pack(&desc, &whole);
    assert_int_equal(ff_packs_enter(&whole, EDGE_WU / 2, &entered), FF_OK);
    assert_null(entered);
    free(memory);
    desc.about = (ff_list){ (const uint8_t *)"\x08\4part", 6 };
    memory = open_pack(&desc, &whole);
    assert_int_equal(ff_packs_enter(&whole, EDGE_WU / 8, &entered), FF_OK);
    assert_null(entered);
    free(memory);
}

static void a_colour(void *context, int64_t x_wu, int64_t y_wu, uint8_t rgb[3])
{
    (void)context;
    rgb[0] = (uint8_t)(x_wu >> 10);
    rgb[1] = (uint8_t)(y_wu >> 10);
    rgb[2] = 0;
}

static void images_are_those_of_the_nodes(void **state)
{
    pack_fixture_desc desc = { .info = pack_fixture_info(6, 1, 1),
                               .height = pack_fixture_hills,
                               .colour = a_colour };
    ff_pack whole;
    ff_packs_entered *entered;
    const uint8_t *a, *b;
    (void)state;
    desc.info.texture_log2 = 4;
    desc.info.texture_levels = 3;
    for (uint32_t bare = 0; bare < 2; bare++) {
        desc.bare_level = bare; /* below its images there are none: no deeper than they */
        uint8_t *memory = open_pack(&desc, &whole);
        assert_int_equal(ff_packs_enter(&whole, EDGE_WU / 8, &entered), FF_OK);
        const ff_pack *pack = ff_packs_entered_first(entered);
        uint32_t level = pack->header.info.entered;
        assert_int_equal(level, bare ? 1 : 2);
        for (uint32_t t = 0; t < ff_shape_tiles(&pack->header.info); t++) {
            ff_key key = ff_key_make(t, 0, 0),
                   in_whole = ff_entry_key(&whole.header.info, &pack->header.info, key);
            int bytes = ff_pack_record(pack, FF_SECTION_TEXTURE, key, &a);
            assert_true(bytes > 0);
            assert_int_equal(bytes, ff_pack_record(&whole, FF_SECTION_TEXTURE, in_whole, &b));
            assert_ptr_equal(a, b);
        }
        ff_packs_leave(entered);
        free(memory);
    }
}

static int release(void **state)
{
    (void)state;
    free(decoder_memory);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_node_is_as_in_the_whole),
        cmocka_unit_test(below_a_stub_there_is_nothing),
        cmocka_unit_test(several_are_entered_each_by_its_own_size),
        cmocka_unit_test(those_that_gain_nothing_or_are_parts_are_left_as_they_are),
        cmocka_unit_test(images_are_those_of_the_nodes),
    };
    return cmocka_run_group_tests(tests, NULL, release);
}
