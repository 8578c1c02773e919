#include "terrain_fixture.h"

#include "../../sim/judge/sim_watertight.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#define ERROR_STRIDE_SPAN 128 /* nodes wider than this many samples have their error sampled */

/* ---- height functions ---- */

static uint32_t hashed(uint32_t x, uint32_t y)
{
    uint32_t h = x * 0x9E3779B1u ^ y * 0x85EBCA77u;
    h ^= h >> 15;
    h *= 0xC2B2AE3Du;
    return h ^ h >> 13;
}

/* Value noise with a lattice of 2^log2 samples, 0..65535. */
static uint32_t lattice_noise(uint32_t x, uint32_t y, unsigned log2)
{
    uint32_t size = 1u << log2, fx = x & (size - 1), fy = y & (size - 1), cx = x >> log2,
             cy = y >> log2;
    uint64_t south = (uint64_t)(hashed(cx, cy) >> 16) * (size - fx) +
                     (uint64_t)(hashed(cx + 1, cy) >> 16) * fx;
    uint64_t north = (uint64_t)(hashed(cx, cy + 1) >> 16) * (size - fx) +
                     (uint64_t)(hashed(cx + 1, cy + 1) >> 16) * fx;
    return (uint32_t)((south * (size - fy) + north * fy) >> (2 * log2));
}

uint16_t fixture_hills(uint32_t x, uint32_t y)
{
    return (uint16_t)(lattice_noise(x, y, 7) / 64 + lattice_noise(x, y, 5) / 256 +
                      lattice_noise(x, y, 3) / 1024 + lattice_noise(x, y, 1) / 8192);
}

uint16_t fixture_flat(uint32_t x, uint32_t y)
{
    (void)x, (void)y;
    return 120;
}

uint16_t fixture_cliffs(uint32_t x, uint32_t y) { return hashed(x >> 3, y >> 3) & 1 ? 65535 : 0; }
uint16_t fixture_noise(uint32_t x, uint32_t y) { return (uint16_t)hashed(x, y); }
uint16_t fixture_half_flat(uint32_t x, uint32_t y)
{
    return x <= 96 ? 500 : (uint16_t)(500 + lattice_noise(x, y, 3) / 64);
}

/* ---- making ---- */

void fixture_make(terrain_fixture *fx, unsigned node_log2, unsigned tile_log2, uint32_t tiles_x,
                  uint32_t tiles_y, fixture_height height)
{
    memset(fx, 0, sizeof *fx);
    fx->height = height;
    fx->hidden = FF_HIDDEN_FETCHED;
    fx->leaf_level = UINT32_MAX;
    fx->info = (ff_terrain_info){
        .node_log2 = (uint8_t)node_log2,
        .tile_log2 = (uint8_t)tile_log2,
        .codec = FF_CODEC_RAW,
        .height_max = 65535,
        .tiles_x = tiles_x,
        .tiles_y = tiles_y,
        .samples_x = (tiles_x << tile_log2) + 1,
        .samples_y = (tiles_y << tile_log2) + 1,
        .spacing_wu = 10 * FF_WU_PER_METRE,
        .hscale_q24 = 1 << 24,
    };
}

void fixture_samples(terrain_fixture *fx, uint32_t samples_x, uint32_t samples_y)
{
    ff_shape_cover(&fx->info, samples_x, samples_y);
}

void fixture_tree(terrain_fixture *fx, uint32_t node_count, uint32_t wish_count)
{
    fixture_free(fx);
    ff_tree_desc desc = { fx->info, node_count, wish_count, fx->hidden, 0, 0, 0 };
    size_t bytes = ff_tree_bytes(&desc), decoder_bytes = ff_decoder_bytes(&fx->info);
    assert_true(bytes > 0);
    fx->tree_memory = malloc(bytes);
    fx->tree = ff_tree_create(&desc, fx->tree_memory, bytes);
    assert_non_null(fx->tree);
    fx->decoder = ff_decoder_create(&fx->info, malloc(decoder_bytes), decoder_bytes);
    assert_non_null(fx->decoder);
}

void fixture_free(terrain_fixture *fx)
{
    free(fx->tree_memory);
    free(fx->decoder);
    fx->tree_memory = NULL;
    fx->decoder = NULL;
    fx->tree = NULL;
}

/* ---- encoding ---- */

/* A node's samples of the finest level: `edge` columns and rows of them from (0, 0), and the way
 * that a column and a row go, as the terrain's shape says. */
typedef struct patch {
    int32_t edge, from[2], column[2], row[2];
} patch;

static int32_t sign(int32_t value) { return (value > 0) - (value < 0); }

static patch patch_of(const terrain_fixture *fx, ff_key key)
{
    const int32_t nowhere[3] = { 0, 0, 0 };
    uint32_t last = 1u << fx->info.node_log2;
    int32_t edge = 1 << (fx->info.tile_log2 - ff_key_level(key));
    int32_t from_wu[3], column_wu[3], row_wu[3];
    ff_frame frame = ff_shape_frame(&fx->info, nowhere);
    ff_placed placed = ff_shape_put(&fx->info, &frame, key);
    ff_shape_place(&fx->info, key, &placed, 0, 0, 0, from_wu);
    ff_shape_place(&fx->info, key, &placed, last, 0, 0, column_wu);
    ff_shape_place(&fx->info, key, &placed, 0, last, 0, row_wu);
    patch p = { .edge = edge };
    for (int axis = 0; axis < 2; axis++) {
        int32_t corner_wu = axis ? fx->info.south_wu : fx->info.west_wu;
        p.from[axis] = (from_wu[axis] - corner_wu) / (int32_t)fx->info.spacing_wu;
        p.column[axis] = sign(column_wu[axis] - from_wu[axis]);
        p.row[axis] = sign(row_wu[axis] - from_wu[axis]);
    }
    return p;
}

static uint16_t true_height(const terrain_fixture *fx, const patch *p, int32_t column, int32_t row)
{
    uint32_t x = (uint32_t)(p->from[0] + column * p->column[0] + row * p->row[0]),
             y = (uint32_t)(p->from[1] + column * p->column[1] + row * p->row[1]);
    return fx->height(x < fx->info.samples_x ? x : fx->info.samples_x - 1,
                      y < fx->info.samples_y ? y : fx->info.samples_y - 1);
}

/* The patch as a grid of `side`. */
static void true_grid(const terrain_fixture *fx, const patch *p, uint32_t side, uint16_t *grid)
{
    int32_t step = p->edge / (int32_t)(side - 1);
    for (uint32_t row = 0; row < side; row++) {
        for (uint32_t column = 0; column < side; column++)
            grid[row * side + column] = true_height(fx, p, (int32_t)column * step,
                                                    (int32_t)row * step);
    }
}

/* Of the cell with a number, as far as there is ground. */
static int64_t cell_width(uint32_t number, uint32_t cell, uint32_t ground)
{
    return number * cell + cell < ground ? cell : ground - number * cell;
}

/* Largest distance between the source and the node's triangles, rounded up; wide nodes are
 * sampled. */
static uint8_t error_of(const terrain_fixture *fx, ff_key key, const uint16_t *heights)
{
    patch p = patch_of(fx, key);
    ff_extent ground = ff_shape_extent(&fx->info, key);
    uint32_t edge = (uint32_t)p.edge, side = ff_node_side(&fx->info), worst = 0;
    uint32_t cell = edge / (side - 1),
             step = edge > ERROR_STRIDE_SPAN ? edge / ERROR_STRIDE_SPAN : 1;
    for (uint32_t row = 0; row < ground.rows; row += step) {
        for (uint32_t column = 0; column < ground.columns; column += step) {
            const uint16_t *sw = heights + row / cell * side + column / cell;
            int64_t wide = cell_width(column / cell, cell, ground.columns),
                    deep = cell_width(row / cell, cell, ground.rows), c = wide * deep,
                    u = column % cell * deep, v = row % cell * wide;
            int64_t drawn = u >= v ? sw[0] * (c - u) + sw[1] * (u - v) + sw[side + 1] * v
                                   : sw[0] * (c - v) + sw[side] * (v - u) + sw[side + 1] * u;
            int64_t off = drawn - true_height(fx, &p, (int32_t)column, (int32_t)row) * c;
            uint32_t error = (uint32_t)(((off < 0 ? -off : off) + c - 1) / c);
            worst = error > worst ? error : worst;
        }
    }
    return ff_geometric_error_encode(worst);
}

void fixture_decoded(const terrain_fixture *fx, ff_key key, uint16_t *heights)
{
    uint32_t side = ff_node_side(&fx->info);
    patch p = patch_of(fx, key);
    uint16_t source[FF_REFINED_HEIGHTS_MAX], parent[FF_NODE_HEIGHTS_MAX],
        decoded[FF_REFINED_HEIGHTS_MAX];
    static uint8_t payload[FF_PAYLOAD_BYTES_MAX];
    const uint8_t no_error[4] = { 0 };
    if (fx->info.max_error == 0) {
        true_grid(fx, &p, side, heights);
    } else if (ff_key_level(key) == 0) {
        true_grid(fx, &p, side, source);
        assert_true(ff_encode_root(&fx->info, source, 0, payload, heights) > 0);
    } else {
        ff_key up = ff_key_parent(key);
        fixture_decoded(fx, up, parent);
        p = patch_of(fx, up);
        true_grid(fx, &p, ff_refined_side(&fx->info), source);
        assert_true(ff_encode_refinement(&fx->info, parent, source, no_error, payload, decoded) >
                    0);
        ff_refined_child(&fx->info, decoded, ff_key_quadrant(key), heights);
    }
}

int fixture_deliver_from(terrain_fixture *fx, ff_key key, int refinement, unsigned by)
{
    uint32_t side = ff_node_side(&fx->info);
    patch p = patch_of(fx, key);
    uint16_t source[FF_REFINED_HEIGHTS_MAX], held[FF_NODE_HEIGHTS_MAX],
        decoded[FF_REFINED_HEIGHTS_MAX];
    static uint8_t payload[FF_PAYLOAD_BYTES_MAX];
    static int32_t value[FF_REFINED_HEIGHTS_MAX];
    ff_residuals residuals = { .value = value };
    int bytes;
    fixture_decoded(fx, key, held);
    if (!refinement) {
        true_grid(fx, &p, side, source);
        bytes = ff_encode_root(&fx->info, source, error_of(fx, key, held), payload, decoded);
        assert_true(bytes > 0);
        assert_int_equal(ff_decode_root(fx->decoder, payload, (size_t)bytes, &residuals), FF_OK);
        residuals.leaf = fx->leaf_level == 0;
        residuals.stub = fx->is_stub && fx->is_stub(key);
        return ff_tree_deliver_root(fx->tree, ff_key_tile(key), by, &residuals);
    }
    uint8_t error[4];
    for (uint32_t q = 0; q < 4; q++) {
        uint16_t child[FF_NODE_HEIGHTS_MAX];
        fixture_decoded(fx, ff_key_child(key, q), child);
        error[q] = error_of(fx, ff_key_child(key, q), child);
    }
    true_grid(fx, &p, ff_refined_side(&fx->info), source);
    bytes = ff_encode_refinement(&fx->info, held, source, error, payload, decoded);
    assert_true(bytes > 0);
    assert_int_equal(ff_decode_refinement(fx->decoder, payload, (size_t)bytes, &residuals), FF_OK);
    residuals.leaf = fx->leaf_level == ff_key_level(key) + 1 ? 15 : 0;
    for (uint32_t q = 0; q < 4 && fx->is_stub; q++)
        residuals.stub |= (uint8_t)(fx->is_stub(ff_key_child(key, q)) << q);
    return ff_tree_deliver_children(fx->tree, key, by, &residuals);
}

int fixture_deliver(terrain_fixture *fx, ff_key key, int refinement)
{
    return fixture_deliver_from(fx, key, refinement, 0);
}

/* ---- feeding ---- */

terrain_fixture *fixture_of(terrain_fixture *list, uint32_t count, ff_key key)
{
    for (uint32_t i = 0; i < count; i++)
        if (ff_terrain_has_node(&list[i].info, key)) return &list[i];
    fail_msg("no ground has node %llx", (unsigned long long)key);
    return NULL;
}

uint32_t fixture_settle_all(terrain_fixture *list, uint32_t count, const ff_view *view,
                            const ff_quality *quality, uint32_t rounds)
{
    ff_tree *tree = list->tree;
    uint32_t delivered = 0;
    for (uint32_t round = 0; round < rounds; round++) {
        const ff_wish *wishes;
        ff_wish wish[FIXTURE_BAG];
        int changed = ff_tree_select(tree, view, quality);
        uint32_t wish_count = ff_tree_wishes(tree, &wishes);
        if (wish_count == 0 && ff_tree_to_make(tree) == 0 && !changed) break;
        wish_count = wish_count > FIXTURE_BAG ? FIXTURE_BAG : wish_count;
        memcpy(wish, wishes, wish_count * sizeof *wish);
        for (uint32_t i = 0; i < wish_count; i++)
            delivered += fixture_deliver(fixture_of(list, count, wish[i].key), wish[i].key,
                                         wish[i].kind) == FF_OK;
    }
    ff_tree_select(tree, view, quality);
    return delivered;
}

uint32_t fixture_settle(terrain_fixture *fx, const ff_view *view, const ff_quality *quality,
                        uint32_t rounds)
{
    return fixture_settle_all(fx, 1, view, quality, rounds);
}

void fixture_link_step(terrain_fixture *fx, fixture_link *link)
{
    const ff_wish *list;
    uint32_t count = ff_tree_wishes(fx->tree, &list);
    for (uint32_t i = 0; i < count && link->count < FIXTURE_BAG; i++) {
        uint32_t known = 0;
        while (known < link->count &&
               (link->bag[known].key != list[i].key || link->bag[known].kind != list[i].kind))
            known++;
        if (known == link->count) link->bag[link->count++] = list[i];
    }
    for (uint32_t i = 0; i < link->per_frame && link->count > 0; i++) {
        uint32_t taken = sys_random_below(&link->random, link->count);
        ff_wish wish = link->bag[taken];
        link->bag[taken] = link->bag[--link->count];
        if (sys_random_below(&link->random, 100) >= link->loss_percent)
            fixture_deliver(fx, wish.key, wish.kind);
    }
}

/* ---- judging ---- */

void fixture_assert_whole(terrain_fixture *fx)
{
    const ff_drawn *cut, *drawn;
    char why[160] = "";
    ff_tree_stats stats;
    ff_tree_get_stats(fx->tree, &stats);
    uint32_t cut_count = ff_tree_cut(fx->tree, &cut), drawn_count = ff_tree_drawn(fx->tree, &drawn);
    assert_int_equal(cut_count, stats.nodes_cut);
    assert_int_equal(drawn_count, stats.nodes_drawn);
    assert_true(stats.nodes_held <= stats.nodes_capacity);
    const ff_frame *frame = ff_tree_frame(fx->tree);
    if (!sim_watertight_check(&fx->info, frame, cut, cut_count, why, sizeof why) ||
        !sim_watertight_check(&fx->info, frame, drawn, drawn_count, why, sizeof why))
        fail_msg("%s", why);
}

void fixture_origin(const ff_terrain_info *info, ff_key key, int32_t origin_wu[3])
{
    const int32_t world_wu[3] = { 0, 0, 0 };
    ff_frame frame = ff_shape_frame(info, world_wu);
    ff_placed placed = ff_shape_put(info, &frame, key);
    ff_shape_place(info, key, &placed, 0, 0, 32768, origin_wu);
}

ff_view fixture_view(int32_t x_m, int32_t y_m, int32_t z_m, int32_t yaw_deg, int32_t pitch_deg)
{
    ff_view view = { .camera = { .pos_wu = { x_m * FF_WU_PER_METRE, y_m * FF_WU_PER_METRE,
                                             z_m * FF_WU_PER_METRE },
                                 .yaw = yaw_deg * 65536 / 360,
                                 .pitch = pitch_deg * 65536 / 360,
                                 .focal_q8 = 53209 /* 120 / tan(30 degrees) */,
                                 .width = 240,
                                 .height = 320 } };
    memcpy(view.centre_wu, view.camera.pos_wu, sizeof view.centre_wu);
    return view;
}

ff_view fixture_view_above(const terrain_fixture *fx, int32_t x_m, int32_t y_m, int32_t above_m,
                           int32_t yaw_deg, int32_t pitch_deg)
{
    return fixture_view(x_m, y_m, fx->height((uint32_t)x_m / 10, (uint32_t)y_m / 10) + above_m,
                        yaw_deg, pitch_deg);
}

ff_quality fixture_quality(enum ff_measure measure)
{
    return (ff_quality){ .measure = measure,
                         .c_q8 = 3 * 256,
                         .error_px_q8 = 2 * 256,
                         .depth_max = 0,
                         .sigma_q8 = 320,
                         .view_wu = 30000 * FF_WU_PER_METRE };
}

ff_tree_stats fixture_stats(const terrain_fixture *fx)
{
    ff_tree_stats stats;
    ff_tree_get_stats(fx->tree, &stats);
    return stats;
}

void fixture_usual(terrain_fixture *fx, uint32_t nodes)
{
    fixture_make(fx, 3, 7, 3, 2, fixture_hills);
    fixture_tree(fx, nodes, 64);
}
