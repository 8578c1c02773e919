#include "trained_grid.h"

#include "slow_decoder.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static uint16_t codec_room[FF_CODEC_ROOM_MAX / 2 + 1];
uint32_t grid_random_state = 1;

uint32_t grid_random_below(uint32_t limit)
{
    grid_random_state = grid_random_state * 1664525u + 1013904223u;
    return (uint32_t)((uint64_t)grid_random_state * limit >> 32);
}

uint32_t grid_side(const grid_test *t)
{
    return t->root ? ff_node_side(&t->info) : ff_refined_side(&t->info);
}

void grid_set(grid_test *t, uint8_t k, int root, uint16_t max_error)
{
    t->info = (ff_terrain_info){
        .node_log2 = k, .tile_log2 = 8, .codec = FF_CODEC_TRAINED, .max_error = max_error
    };
    t->root = root;
    t->cells.columns = t->cells.rows = (uint8_t)(grid_side(t) - 1);
}

static uint16_t height_at(int kind, uint32_t x, uint32_t y)
{
    switch (kind) {
        case FLAT: return 4711;
        case NOISE: return (uint16_t)grid_random_below(65536);
        case CLIFF: return x * 3 > y + 20 ? 65535 : 0;
        case CHECKER: return (x + y) & 1 ? 65535 : 0;
        case SMOOTH: return (uint16_t)(20000 + 7 * x * x - 3 * x * y + 90 * y);
        case ROUGH: return (uint16_t)(20000 + 300 * x + 100 * y + grid_random_below(400));
        default: return grid_random_below(2) ? 65535 : 0;
    }
}

void grid_make(grid_test *t, int kind)
{
    uint32_t side = grid_side(t), node = ff_node_side(&t->info);
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

const uint16_t *grid_parent(const grid_test *t) { return t->root ? NULL : t->parent; }

int grid_encode(grid_test *t)
{
    static int32_t value[FF_REFINED_HEIGHTS_MAX];
    static uint8_t body[FF_PAYLOAD_BYTES_MAX];
    ff_residuals res = { .cells = t->cells, .value = value, .body = body };
    ff_encode_heights(&t->info, grid_parent(t), t->source, NULL, &res, t->decoded);
    t->count = res.count - (t->root ? FF_CORNERS : 0);
    int bytes = ff_encode_payload(&t->info, grid_parent(t), t->decoded, &res, t->payload);
    t->bytes = (size_t)bytes;
    return bytes;
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

int grid_decode_both(const grid_test *t, const uint8_t *payload, size_t bytes, uint16_t *heights)
{
    static uint16_t slow[FF_REFINED_HEIGHTS_MAX];
    uint8_t *exact = malloc(bytes + 1); /* bytes beyond are not there */
    ff_terrain_info info = t->info;
    if (t->root && info.entered) info.max_error = 0;
    memcpy(exact, payload, bytes);
    exact = realloc(exact, bytes ? bytes : 1);
    for (uint32_t i = 0, side = grid_side(t); i < side * side; i++) {
        int rim = i % side == 0 || i % side == side - 1 || i < side || i >= side * (side - 1);
        heights[i] = slow[i] = rim ? t->decoded[i] : 12345;
    }
    int rc = decode(t, exact, bytes, heights);
    int slow_rc = slow_decode_part(&info, t->cells.columns, t->cells.rows, grid_parent(t), exact,
                                   bytes, slow);
    free(exact);
    assert_int_equal(rc == FF_OK, slow_rc >= 0);
    if (rc == FF_OK) assert_memory_equal(heights, slow, 2 * grid_side(t) * grid_side(t));
    return rc;
}
