/* What is all prediction is not stored: records of a tile, and the ground that they lead to. */
#include "../../protocol/codec/ff_codec.h"
#include "../../protocol/shape/ff_shape.h"
#include "../rig/whole_tile.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <stdlib.h>

static uint16_t codec_room[FF_CODEC_ROOM_MAX / 2 + 1];

#define WIDTH  50
#define HEIGHT 20
#define PITCH  33

typedef struct baked {
    ff_terrain_info info;
    bake_grid grid;
    whole_tile tile;
    void *memory;
    ff_decoder *decoder;
    size_t taken[BAKE_LEVELS_MAX], number[BAKE_LEVELS_MAX]; /* bytes and records, walking */
    uint32_t stored;
    uint16_t ground[PITCH * PITCH];
} baked;

/* Ground of one height but for a hill of `height` round sample (40, 10), in tile 1. */
static void bake(baked *b, uint32_t tile, uint16_t height, uint16_t max_error)
{
    *b = (baked){ .info = { .node_log2 = 2,
                            .tile_log2 = 5,
                            .codec = FF_CODEC_RICE,
                            .max_error = max_error,
                            .height_max = 65535,
                            .flags = max_error ? FF_TERRAIN_LOSSY : 0,
                            .tiles_x = 2,
                            .tiles_y = 1,
                            .samples_x = WIDTH,
                            .samples_y = HEIGHT,
                            .spacing_wu = 256,
                            .hscale_q24 = 1 << 24 } };
    assert_int_equal(bake_grid_open(&b->grid, WIDTH, HEIGHT, sizeof(uint16_t)), 0);
    for (int j = 0; j < HEIGHT; j++) {
        uint16_t row[WIDTH];
        for (int i = 0; i < WIDTH; i++)
            row[i] = (uint16_t)(1000 + (abs(i - 40) < 3 && abs(j - 10) < 3 ? height : 0));
        assert_int_equal(bake_grid_write(&b->grid, (uint32_t)j, 0, WIDTH, row), 0);
    }
    whole_tile_open(&b->tile, &b->info, &b->grid, &BAKE_GRID_CLOSED, tile);
    whole_tile_encode(&b->tile);
    size_t bytes = ff_decoder_bytes(&b->info);
    b->memory = test_malloc(bytes);
    b->decoder = ff_decoder_create(&b->info, b->memory, bytes);
    assert_non_null(b->decoder);
}

static void end(baked *b)
{
    test_free(b->memory);
    whole_tile_close(&b->tile);
    bake_grid_close(&b->grid);
}

/* The next record of a level; NULL: there is none at this place. */
static const uint8_t *next_record(baked *b, uint32_t level, size_t *bytes)
{
    const bake_blob *blob = &b->tile.level[level];
    assert_true(b->number[level] < blob->record_count);
    *bytes = blob->length[b->number[level]++];
    const uint8_t *record = *bytes ? blob->bytes + b->taken[level] : NULL;
    b->taken[level] += *bytes;
    b->stored += *bytes > 0;
    return record;
}

static void show(baked *b, ff_key key, const uint16_t *heights)
{
    uint32_t code = ff_key_code(key);
    for (uint32_t i = 0; i < 25; i++)
        b->ground[(ff_morton_y(code) * 4 + i / 5) * PITCH + ff_morton_x(code) * 4 + i % 5] =
            heights[i];
}

/* All below a node, as a client comes by it. Where nothing is stored its error must hold. */
static void walk(baked *b, ff_key key, const uint16_t *heights, int leaf)
{
    uint32_t level = ff_key_level(key);
    int32_t value[FF_REFINED_HEIGHTS_MAX];
    uint16_t refined[FF_REFINED_HEIGHTS_MAX], child[FF_NODE_HEIGHTS_MAX];
    ff_residuals residuals = { .leaf = 15, .value = value };
    size_t bytes;
    if (level + 1 == ff_terrain_levels(&b->info)) {
        show(b, key, heights);
        return;
    }
    if (ff_shape_has_ground(&b->info, key)) residuals.cells = ff_shape_cells(&b->info, key, 1);
    const uint8_t *record = next_record(b, level + 1, &bytes);
    assert_int_equal(record == NULL, leaf || !ff_shape_has_ground(&b->info, key));
    if (record) {
        assert_int_equal(ff_decode_refinement(b->decoder, record, bytes, &residuals), FF_OK);
        assert_int_equal(
            ff_reconstruct_refinement(&b->info, heights, &residuals, refined, codec_room), FF_OK);
    } else {
        ff_predict_children(&b->info, residuals.cells, heights, refined, codec_room);
    }
    for (uint32_t q = 0; q < 4; q++) {
        ff_refined_child(&b->info, refined, q, child);
        walk(b, ff_key_child(key, q), child, residuals.leaf >> q & 1);
    }
}

static void walk_tile(baked *b, uint32_t tile)
{
    int32_t value[FF_REFINED_HEIGHTS_MAX];
    uint16_t root[FF_NODE_HEIGHTS_MAX];
    ff_residuals residuals = { .cells = ff_shape_cells(&b->info, ff_key_make(tile, 0, 0), 0),
                               .value = value };
    size_t bytes;
    const uint8_t *record = next_record(b, 0, &bytes);
    assert_int_equal(ff_decode_root(b->decoder, record, bytes, &residuals), FF_OK);
    assert_int_equal(ff_reconstruct_root(&b->info, &residuals, root, codec_room), FF_OK);
    walk(b, ff_key_make(tile, 0, 0), root, residuals.leaf);
    for (uint32_t l = 0; l < ff_terrain_levels(&b->info); l++)
        assert_int_equal(b->number[l], b->tile.level[l].record_count);
    for (int i = 0; i < HEIGHT * PITCH; i++)
        assert_in_range(b->ground[i], b->tile.source[i] - b->info.max_error,
                        b->tile.source[i] + b->info.max_error);
}

static void flat_ground_takes_a_root(void **state)
{
    (void)state;
    baked b;
    bake(&b, 0, 50, 0);
    walk_tile(&b, 0);
    assert_int_equal(b.stored, 1);
    assert_int_equal(b.tile.level[0].byte_count, 9); /* a head and four corners */
    end(&b);
}

/* The hill lies in 3 x 3 of the finest nodes, at their parents' border. */
static void a_hill_takes_what_lies_above_it(void **state)
{
    (void)state;
    baked b;
    bake(&b, 1, 50, 0);
    walk_tile(&b, 1);
    assert_in_range(b.stored, 4, 8);
    end(&b);
}

/* What the bound allows to leave out altogether is left out, where the errors told above hold. */
static void what_the_bound_allows_is_not_stored(void **state)
{
    (void)state;
    uint32_t stored[2];
    for (int i = 0; i < 2; i++) {
        baked b;
        bake(&b, 1, 3, i ? 6 : 0);
        walk_tile(&b, 1);
        stored[i] = b.stored;
        end(&b);
    }
    assert_true(stored[1] < stored[0]);
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(flat_ground_takes_a_root),
                                        cmocka_unit_test(a_hill_takes_what_lies_above_it),
                                        cmocka_unit_test(what_the_bound_allows_is_not_stored) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
