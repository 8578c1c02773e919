/* Padding is not coded: payloads of grids that the ground's edge crosses hold the ground alone, in
 * both decoders, and what lies beyond repeats the last sample. */
#include "../../protocol/codec/ff_codec.h"
#include "../rig/slow_decoder.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static uint16_t codec_room[FF_CODEC_ROOM_MAX / 2 + 1];

typedef struct edge_test {
    ff_terrain_info info;
    ff_cells cells;
    int root;
    uint16_t parent[FF_NODE_HEIGHTS_MAX], source[FF_REFINED_HEIGHTS_MAX];
} edge_test;

static uint32_t side_of(const edge_test *t)
{
    return t->root ? ff_node_side(&t->info) : ff_refined_side(&t->info);
}

/* Ground that repeats beyond `cells`, as tiles do; the parent has every other sample of it. */
static void make_ground(edge_test *t, uint32_t seed)
{
    uint32_t side = side_of(t), node = ff_node_side(&t->info);
    for (uint32_t i = 0; i < side * side; i++) {
        uint32_t x = i % side < t->cells.columns ? i % side : t->cells.columns;
        uint32_t y = i / side < t->cells.rows ? i / side : t->cells.rows;
        t->source[i] = (uint16_t)(20000 + 300 * x + 100 * y +
                                  ((x * 7919 + y * 104729) * seed >> 22));
    }
    for (uint32_t i = 0; i < node * node && !t->root; i++)
        t->parent[i] = t->source[2 * (i / node) * side + 2 * (i % node)];
}

/* Samples that a decoder must be told, root corners included, counted one by one. */
static uint32_t told(const edge_test *t)
{
    uint32_t side = side_of(t), count = t->root ? 4 : 0;
    for (uint32_t gap = t->root ? side - 1 : 2; gap > 1; gap /= 2) {
        uint32_t end_x = (t->cells.columns + gap - 1) / gap * gap,
                 end_y = (t->cells.rows + gap - 1) / gap * gap;
        for (uint32_t y = 0; y <= end_y; y += gap / 2)
            for (uint32_t x = 0; x <= end_x; x += gap / 2)
                count += (x % gap || y % gap) && (x % gap == 0 || x < t->cells.columns) &&
                         (y % gap == 0 || y < t->cells.rows);
    }
    return count;
}

static void check(edge_test *t)
{
    static int32_t value[FF_REFINED_HEIGHTS_MAX], taken[FF_REFINED_HEIGHTS_MAX];
    static uint16_t decoded[FF_REFINED_HEIGHTS_MAX], again[FF_REFINED_HEIGHTS_MAX],
        slow[FF_REFINED_HEIGHTS_MAX];
    static uint8_t payload[FF_PAYLOAD_BYTES_MAX], body[FF_PAYLOAD_BYTES_MAX];
    const uint16_t *parent = t->root ? NULL : t->parent;
    ff_residuals res = { .cells = t->cells, .value = value, .body = body },
                 out = { .cells = t->cells, .value = taken };
    uint32_t side = side_of(t), heights = side * side;
    size_t memory_bytes = ff_decoder_bytes(&t->info);
    void *memory = malloc(memory_bytes);
    ff_decoder *dec = ff_decoder_create(&t->info, memory, memory_bytes);
    ff_encode_heights(&t->info, parent, t->source, NULL, &res, decoded);
    assert_int_equal(res.count, told(t));
    for (uint32_t i = 0; i < heights; i++)
        assert_in_range(decoded[i], t->source[i] - t->info.max_error,
                        t->source[i] + t->info.max_error);
    int bytes = ff_encode_payload(&t->info, parent, decoded, &res, payload);
    assert_true(bytes > 0);
    assert_int_equal(t->root ? ff_decode_root(dec, payload, (size_t)bytes, &out)
                             : ff_decode_refinement(dec, payload, (size_t)bytes, &out),
                     FF_OK);
    assert_int_equal(t->root ? ff_reconstruct_root(&t->info, &out, again, codec_room)
                             : ff_reconstruct_refinement(&t->info, parent, &out, again, codec_room),
                     FF_OK);
    assert_memory_equal(again, decoded, heights * sizeof *again);
    assert_int_equal(slow_decode_part(&t->info, t->cells.columns, t->cells.rows, parent, payload,
                                      (size_t)bytes, slow),
                     0);
    assert_memory_equal(slow, decoded, heights * sizeof *slow);
    free(memory);
}

static void grids_at_the_edge_hold_their_ground_alone(void **state)
{
    static edge_test t;
    (void)state;
    for (uint8_t k = 1; k <= 4; k++)
        for (uint16_t max_error = 0; max_error <= 5; max_error += 5)
            for (uint32_t way = 0; way < 2 * FF_CODEC_COUNT; way++) {
                t.info = (ff_terrain_info){ .node_log2 = k,
                                            .tile_log2 = 8,
                                            .codec = (uint8_t)(way / 2),
                                            .max_error = max_error };
                t.root = way % 2;
                uint32_t side = side_of(&t), step = k < 4 ? 1 : 5;
                for (uint32_t columns = 1; columns < side; columns += step)
                    for (uint32_t rows = 1; rows < side; rows += step) {
                        t.cells = (ff_cells){ (uint8_t)columns, (uint8_t)rows };
                        make_ground(&t, max_error ? 0 : 1 + columns);
                        check(&t);
                    }
            }
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(
        grids_at_the_edge_hold_their_ground_alone) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
