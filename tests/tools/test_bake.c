/* The parts of farfield-bake that keep promises by themselves: geometric error, void filling,
 * densifying, choice of tiles, ordered jobs, and a tile's records as a decoder sees them. */
#include "../../platform/sys.h"
#include "../../protocol/codec/ff_codec.h"
#include "../../protocol/shape/ff_shape.h"
#include "../../tools/bake/raster/bake_densify.h"
#include "../../tools/bake/bake_error.h"
#include "../../tools/bake/bake_fault.h"
#include "../../tools/bake/raster/bake_fill.h"
#include "../../tools/bake/raster/bake_unit.h"
#include "../../tools/bake/bake_jobs.h"
#include "../../tools/bake/bake_run.h"
#include "../../tools/bake/bake_say.h"
#include "../../tools/bake/raster/bake_voids.h"
#include "../rig/whole_tile.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* after the four above: */
#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static uint16_t codec_room[FF_CODEC_ROOM_MAX / 2 + 1];

static uint32_t next_random(uint32_t *state) { return *state = *state * 1664525u + 1013904223u; }

/* ---- geometric error against plain double precision over every sample ---- */

/* Place in its cell, 0..1, of a sample, and the cell: the last one ends with the ground. */
static double in_cell(uint32_t at, uint32_t cell, uint32_t ground, uint32_t *number)
{
    *number = at == ground ? (at - 1) / cell : at / cell;
    uint32_t first = *number * cell, width = first + cell < ground ? cell : ground - first;
    return (double)(at - first) / width;
}

static double drawn_at(const uint16_t *drawn, size_t pitch, uint32_t cell, uint32_t x, uint32_t y,
                       ff_extent ground)
{
    uint32_t i, j;
    double u = in_cell(x, cell, ground.columns, &i), v = in_cell(y, cell, ground.rows, &j);
    const uint16_t *sw = drawn + j * cell * pitch + i * cell;
    double a = sw[0], b = sw[cell], c = sw[cell * pitch], d = sw[cell * pitch + cell];
    return u >= v ? a + (b - a) * u + (d - b) * v : a + (c - a) * v + (d - c) * u;
}

static void check_error(uint32_t cells, uint32_t cell, ff_extent ground, uint32_t seed)
{
    uint32_t edge = cells * cell;
    size_t pitch = edge + 3;
    uint16_t *source = test_malloc(pitch * (edge + 1) * sizeof *source),
             *drawn = test_malloc(pitch * (edge + 1) * sizeof *drawn);
    for (size_t i = 0; i < pitch * (edge + 1); i++) {
        source[i] = (uint16_t)(next_random(&seed) >> 16);
        drawn[i] = (uint16_t)(source[i] ^ (seed >> 28));
    }
    double worst = 0;
    for (uint32_t y = 0; y <= ground.rows; y++)
        for (uint32_t x = 0; x <= ground.columns; x++)
            worst = fmax(worst,
                         fabs(drawn_at(drawn, pitch, cell, x, y, ground) - source[y * pitch + x]));
    assert_int_equal(bake_node_error(source, NULL, drawn, pitch, ground, cell),
                     (uint32_t)ceil(worst - 1e-6));
    test_free(source);
    test_free(drawn);
}

static void node_error_is_exact(void **state)
{
    (void)state;
    check_error(8, 1, (ff_extent){ 8, 8 }, 1);
    check_error(8, 2, (ff_extent){ 16, 16 }, 2);
    check_error(2, 16, (ff_extent){ 32, 32 }, 3);
    check_error(4, 64, (ff_extent){ 256, 256 }, 4);
    check_error(1, 3, (ff_extent){ 3, 3 }, 5);
}

static void the_error_ends_with_the_ground(void **state)
{
    (void)state;
    for (uint32_t columns = 1; columns <= 32; columns++)
        for (uint32_t rows = 1; rows <= 32; rows++)
            check_error(4, 8, (ff_extent){ columns, rows }, 100 * columns + rows);
    check_error(2, 512, (ff_extent){ 511, 1023 }, 6);
    uint16_t none[25] = { 0, 9, 0, 9, 0, 9 };
    assert_int_equal(bake_node_error(none, NULL, none, 5, (ff_extent){ 0, 4 }, 1), 0);
}

static void node_error_of_a_plane_is_nothing(void **state)
{
    uint16_t plane[33 * 33];
    (void)state;
    for (uint32_t i = 0; i < 33 * 33; i++)
        plane[i] = (uint16_t)(1000 + 17 * (i % 33) + 40 * (i / 33));
    assert_int_equal(bake_node_error(plane, NULL, plane, 33, (ff_extent){ 32, 32 }, 8), 0);
    plane[33 * 5 + 9] = (uint16_t)(plane[33 * 5 + 9] + 3);
    assert_int_equal(bake_node_error(plane, NULL, plane, 33, (ff_extent){ 32, 32 }, 8), 3);
}

/* ---- filling ---- */

static void write_grid(bake_grid *grid, uint32_t width, uint32_t height, const float *values)
{
    assert_int_equal(bake_grid_open(grid, width, height, sizeof(float)), 0);
    for (uint32_t j = 0; j < height; j++)
        assert_int_equal(bake_grid_write(grid, j, 0, width, values + (size_t)j * width), 0);
}

static void fill_keeps_what_is_known(void **state)
{
    enum { W = 61, H = 47 };
    static float before[W * H], after[W * H];
    bake_grid grid;
    (void)state;
    for (int i = 0; i < W * H; i++) {
        int x = i % W, y = i / W,
            is_void = (x > 15 && x < 40 && y > 8 && y < 30) || i == 0 || x == W - 1;
        before[i] = is_void ? NAN : (float)(100 + 3 * x + 2 * y);
    }
    write_grid(&grid, W, H, before);
    assert_int_equal(bake_fill_voids(&grid), 0);
    for (uint32_t j = 0; j < H; j++)
        assert_int_equal(bake_grid_read(&grid, j, 0, W, after + (size_t)j * W), 0);
    for (int i = 0; i < W * H; i++) {
        if (!isnan(before[i])) assert_true(after[i] == before[i]);
        /* a slope continues through the hole, within a fraction of its rise across the hole */
        assert_true(fabs(after[i] - (100 + 3.0 * (i % W) + 2.0 * (i / W))) < 15);
    }
    bake_grid_close(&grid);
}

static void fill_from_a_single_sample(void **state)
{
    float values[12], out[12];
    bake_grid grid;
    (void)state;
    for (int i = 0; i < 12; i++) values[i] = i == 7 ? 42.0f : NAN;
    write_grid(&grid, 4, 3, values);
    assert_int_equal(bake_fill_voids(&grid), 0);
    for (uint32_t j = 0; j < 3; j++)
        assert_int_equal(bake_grid_read(&grid, j, 0, 4, out + 4 * j), 0);
    for (int i = 0; i < 12; i++) assert_true(out[i] == 42.0f);
    bake_grid_close(&grid);
}

/* ---- densifying ---- */

static void densify_keeps_samples_and_flat_water(void **state)
{
    enum { W = 40, H = 30, N = 4, FINE = (W - 1) * N + 1 };
    static float values[W * H], row[FINE];
    uint32_t seed = 9;
    double gt[6] = { 100, 8, 0, 500, 0, -8 };
    bake_grid grid;
    (void)state;
    for (int i = 0; i < W * H; i++)
        values[i] = i % W < W / 2 ? 5.0f : (float)(5 + (next_random(&seed) >> 24));
    write_grid(&grid, W, H, values);
    assert_int_equal(bake_densify(&grid, gt, N), 0);
    assert_int_equal(grid.width, FINE);
    assert_int_equal(grid.height, (H - 1) * N + 1);
    assert_true(gt[1] == 2 && gt[0] + 1 == 104 && gt[3] - 1 == 496);
    int invented = 0;
    for (uint32_t j = 0; j < grid.height; j++) {
        assert_int_equal(bake_grid_read(&grid, j, 0, FINE, row), 0);
        for (uint32_t i = 0; j % N == 0 && i < FINE; i += N)
            assert_true(row[i] == values[j / N * W + i / N]);
        for (uint32_t i = 0; i < (W / 2 - 8) * N; i++) assert_true(row[i] == 5.0f);
        invented += row[FINE - 2] != row[FINE - 1];
    }
    assert_true(invented > 0);
    bake_grid_close(&grid);
}

/* ---- tiles ---- */

static void one_tile_holds_the_raster(void **state)
{
    (void)state;
    assert_int_equal(bake_choose_tile_log2(3, 5, 5, 256), 3);
    assert_int_equal(bake_choose_tile_log2(3, 2, 2, 256), 3);
    assert_int_equal(bake_choose_tile_log2(3, 1025, 1025, 256), 10);
    assert_int_equal(bake_choose_tile_log2(3, 1026, 2, 256), 11);
    assert_int_equal(bake_choose_tile_log2(3, 5000, 13000, 256), 14);
    assert_int_equal(bake_choose_tile_log2(5, 17, 17, 256), 5);
    assert_int_equal(bake_choose_tile_log2(1, 100000, 3, 256), 16); /* the last level of keys */
    assert_int_equal(bake_choose_tile_log2(3, 50000, 9, 90 * 256), 16);
    /* 2^17 samples of 90 m end beyond 8388 km, and 3 * 2^15, too: 5 * 2^14 do not */
    assert_int_equal(bake_choose_tile_log2(3, 70000, 9, 90 * 256), 14);
}

static ff_terrain_info small_info(uint16_t max_error)
{
    return (ff_terrain_info){ .node_log2 = 2,
                              .tile_log2 = 5,
                              .codec = FF_CODEC_DEFLATE,
                              .max_error = max_error,
                              .height_max = 65535,
                              .flags = max_error ? FF_TERRAIN_LOSSY : 0,
                              .tiles_x = 2,
                              .tiles_y = 1,
                              .samples_x = 50,
                              .samples_y = 20,
                              .spacing_wu = 256,
                              .hscale_q24 = 1 << 24 };
}

static void load_noise(whole_tile *tile, const ff_terrain_info *info, bake_grid *grid,
                       const bake_grid *filled, uint32_t number)
{
    uint16_t row[50];
    uint32_t seed = 77;
    assert_int_equal(bake_grid_open(grid, 50, 20, sizeof(uint16_t)), 0);
    for (uint32_t j = 0; j < 20; j++) {
        for (int i = 0; i < 50; i++)
            row[i] = (uint16_t)(20000 + 40 * j + (next_random(&seed) >> 23));
        assert_int_equal(bake_grid_write(grid, j, 0, 50, row), 0);
    }
    whole_tile_open(tile, info, grid, filled, number);
}

static void tile_repeats_the_rim(void **state)
{
    ff_terrain_info info = small_info(0);
    whole_tile tile;
    bake_grid grid;
    uint16_t row[50];
    (void)state;
    load_noise(&tile, &info, &grid, &BAKE_GRID_CLOSED, 1);
    assert_int_equal(bake_grid_read(&grid, 19, 0, 50, row), 0);
    assert_int_equal(tile.source[19 * 33 + 3], row[35]);
    assert_int_equal(tile.source[32 * 33 + 3], row[35]);
    assert_int_equal(tile.source[32 * 33 + 32], row[49]);
    whole_tile_close(&tile);
    bake_grid_close(&grid);
}

/* Decoding the records gives the heights that the encoder predicted, within the bound, and the
 * errors that were measured. */
static void check_records(uint16_t max_error)
{
    ff_terrain_info info = small_info(max_error);
    whole_tile tile;
    bake_grid grid;
    int32_t value[FF_REFINED_HEIGHTS_MAX];
    uint16_t node[FF_NODE_HEIGHTS_MAX];
    ff_residuals residuals = { .value = value };
    load_noise(&tile, &info, &grid, &BAKE_GRID_CLOSED, 0);
    whole_tile_encode(&tile);
    for (int i = 0; i < 20 * 33; i++) /* what is ground */
        assert_true(abs(tile.decoded[i] - tile.source[i]) <= max_error);
    size_t bytes = ff_decoder_bytes(&info);
    void *memory = test_malloc(bytes);
    ff_decoder *decoder = ff_decoder_create(&info, memory, bytes);
    assert_non_null(decoder);
    residuals.cells = ff_shape_cells(&info, ff_key_make(tile.number, 0, 0), 0);
    assert_int_equal(
        ff_decode_root(decoder, tile.level[0].bytes, tile.level[0].length[0], &residuals), FF_OK);
    ff_reconstruct_root(&info, &residuals, node, codec_room);
    for (int i = 0; i < 25; i++)
        assert_int_equal(node[i], tile.decoded[i / 5 * 8 * 33 + i % 5 * 8]);
    assert_int_equal(residuals.child_error[0],
                     ff_geometric_error_encode(bake_node_error(tile.source, NULL, tile.decoded, 33,
                                                               (ff_extent){ 32, 19 }, 8)));
    for (uint32_t l = 1; l < ff_terrain_levels(&info); l++)
        assert_int_equal(tile.level[l].record_count, 1u << (2 * (l - 1)));
    /* first refinement of level 1: children of 8 x 8 samples at the south-west */
    const bake_blob *middle = &tile.level[2];
    residuals.cells = ff_shape_cells(&info, ff_key_make(0, 1, 0), 1);
    assert_int_equal(ff_decode_refinement(decoder, middle->bytes, middle->length[0], &residuals),
                     FF_OK);
    for (int q = 0; q < 4; q++) {
        int at = (q & 1) * 8 + (q >> 1) * 8 * 33;
        uint32_t steps = bake_node_error(tile.source + at, NULL, tile.decoded + at, 33,
                                         (ff_extent){ 8, 8 }, 2);
        assert_int_equal(residuals.child_error[q], ff_geometric_error_encode(steps));
    }
    /* refinements of level 2: their children are the data itself */
    const bake_blob *finest = &tile.level[3];
    residuals.cells = ff_shape_cells(&info, ff_key_make(0, 2, 0), 1);
    assert_int_equal(ff_decode_refinement(decoder, finest->bytes, finest->length[0], &residuals),
                     FF_OK);
    for (int q = 0; q < 4; q++)
        assert_true(ff_geometric_error_decode(residuals.child_error[q]) <= max_error);
    test_free(memory);
    whole_tile_close(&tile);
    bake_grid_close(&grid);
}

/* Marks of filled samples: of the ground's size and way, then of the heights'. */
static void marks_follow_the_heights(void **state)
{
    (void)state;
    bake_grid ground, marks = BAKE_GRID_CLOSED, filled;
    float row[5];
    uint8_t marked[9];
    assert_int_equal(bake_grid_open(&ground, 5, 4, sizeof(float)), 0);
    for (uint32_t j = 0; j < 4; j++) {
        for (uint32_t i = 0; i < 5; i++) row[i] = i == 2 && j == 1 ? NAN : 7;
        assert_int_equal(bake_grid_write(&ground, j, 0, 5, row), 0);
    }
    assert_int_equal(bake_voids_mark(&ground, &marks), 0);
    for (int north_up = 0; north_up < 2; north_up++)
        for (uint32_t densify = 1; densify <= 2; densify++) {
            uint32_t width = 4 * densify + 1, height = 3 * densify + 1;
            assert_int_equal(bake_voids_finish(&marks, north_up, densify, &filled), 0);
            assert_true(filled.width == width && filled.height == height);
            for (uint32_t j = 0; j < height; j++) {
                uint32_t from_void = north_up ? height - 1 - j : j;
                assert_int_equal(bake_grid_read(&filled, j, 0, width, marked), 0);
                for (uint32_t i = 0; i < width; i++)
                    assert_int_equal(marked[i], from_void > 0 && from_void < 2 * densify &&
                                                    i > densify && i < 3 * densify);
            }
            bake_grid_close(&filled);
        }
    bake_grid_close(&marks);
    bake_grid_close(&ground);
}

/* Which children of a node of tile 1 hold filled samples, by the samples themselves. */
static unsigned filled_children(const ff_terrain_info *info, const uint8_t *filled, ff_key key)
{
    unsigned bits = 0;
    for (uint32_t q = 0; q < 4; q++) {
        ff_key child = ff_key_child(key, q);
        ff_extent extent = ff_shape_extent(info, child);
        uint32_t edge = 32u >> ff_key_level(child), code = ff_key_code(child),
                 x = 32 + ff_morton_x(code) * edge, y = ff_morton_y(code) * edge;
        if (!extent.columns || !extent.rows) continue;
        for (uint32_t j = y; j <= y + extent.rows; j++)
            for (uint32_t i = x; i <= x + extent.columns; i++)
                bits |= (unsigned)filled[j * 50 + i] << q;
    }
    return bits;
}

static void records_tell_filled_nodes(void **state)
{
    (void)state;
    ff_terrain_info info = small_info(0);
    whole_tile tile;
    bake_grid grid, filled;
    uint8_t marks[20 * 50] = { 0 };
    int32_t value[FF_REFINED_HEIGHTS_MAX];
    ff_residuals residuals = { .value = value };
    marks[6 * 50 + 37] = marks[19 * 50 + 49] = marks[8 * 50 + 40] = 1;
    assert_int_equal(bake_grid_open(&filled, 50, 20, 1), 0);
    for (uint32_t j = 0; j < 20; j++)
        assert_int_equal(bake_grid_write(&filled, j, 0, 50, marks + j * 50), 0);
    load_noise(&tile, &info, &grid, &filled, 1);
    whole_tile_encode(&tile);
    size_t bytes = ff_decoder_bytes(&info);
    void *memory = test_malloc(bytes);
    ff_decoder *decoder = ff_decoder_create(&info, memory, bytes);
    residuals.cells = ff_shape_cells(&info, ff_key_make(tile.number, 0, 0), 0);
    assert_int_equal(
        ff_decode_root(decoder, tile.level[0].bytes, tile.level[0].length[0], &residuals), FF_OK);
    assert_int_equal(residuals.filled, 1);
    unsigned told = 0;
    for (uint32_t level = 0; level + 1 < ff_terrain_levels(&info); level++) {
        const bake_blob *records = &tile.level[level + 1];
        size_t at = 0;
        for (uint32_t code = 0; code < 1u << (2 * level); code++) {
            if (!ff_shape_has_ground(&info, ff_key_make(1, level, code))) {
                assert_int_equal(records->length[code], 0);
                continue;
            }
            residuals.cells = ff_shape_cells(&info, ff_key_make(1, level, code), 1);
            assert_int_equal(ff_decode_refinement(decoder, records->bytes + at,
                                                  records->length[code], &residuals),
                             FF_OK);
            assert_int_equal(residuals.filled,
                             filled_children(&info, marks, ff_key_make(1, level, code)));
            told += residuals.filled != 0;
            at += records->length[code];
        }
    }
    assert_in_range(told, 5, 12);
    test_free(memory);
    whole_tile_close(&tile);
    bake_grid_close(&grid);
    bake_grid_close(&filled);
}

static void records_decode(void **state)
{
    (void)state;
    check_records(0);
    check_records(6);
}

/* ---- jobs ---- */

#define JOBS 200
typedef struct ledger {
    uint32_t made[8], taken[JOBS], count, fail_at;
} ledger;

static int make_job(void *context, int worker, uint32_t job)
{
    ledger *l = context;
    l->made[worker] = job;
    if (job % 3 == 0) sys_sleep_us(200); /* other jobs overtake this one */
    return job == l->fail_at ? -1 : 0;
}

static int take_job(void *context, int worker, uint32_t job)
{
    ledger *l = context;
    l->taken[l->count++] = l->made[worker] == job ? job : UINT32_MAX;
    return 0;
}

static void jobs_are_taken_in_order(void **state)
{
    (void)state;
    for (int threads = 1; threads <= 8; threads++) {
        ledger l = { .fail_at = UINT32_MAX };
        bake_jobs jobs = { "test", JOBS, threads, &l, make_job, take_job };
        assert_int_equal(bake_jobs_run(&jobs), 0);
        assert_int_equal(l.count, JOBS);
        for (uint32_t i = 0; i < JOBS; i++) assert_int_equal(l.taken[i], i);
    }
}

static void a_failed_job_ends_all(void **state)
{
    ledger l = { .fail_at = 50 };
    bake_jobs jobs = { "test", JOBS, 4, &l, make_job, take_job };
    (void)state;
    assert_int_equal(bake_jobs_run(&jobs), -1);
    assert_true(l.count <= 50);
}

/* ---- fields out of range ---- */

/* A number that is often at an edge of something. */
static uint32_t edge_number(uint32_t *state)
{
    uint32_t bits = next_random(state) >> 27, jitter = (next_random(state) >> 16) % 3;
    return (1u << bits) - 1 + jitter;
}

static void a_fault_is_told_where_the_core_finds_one(void **state)
{
    uint32_t random = 1, faults = 0;
    char text[200];
    (void)state;
    for (int i = 0; i < 200000; i++) {
        ff_terrain_info info = { .node_log2 = 3,
                                 .tile_log2 = 10,
                                 .codec = FF_CODEC_DEFLATE,
                                 .height_max = 43000,
                                 .tiles_x = 4,
                                 .tiles_y = 2,
                                 .samples_x = 4097,
                                 .samples_y = 2000,
                                 .spacing_wu = 2560,
                                 .hscale_q24 = 1677722,
                                 .hoffset_wu = -1000 };
        for (int n = next_random(&random) >> 30; n >= 0; n--) {
            uint32_t value = edge_number(&random);
            switch (next_random(&random) >> 28) {
                case 0: info.node_log2 = value & 7; break;
                case 1: info.tile_log2 = value & 31; break;
                case 2: info.flags = value & 7; break;
                case 3: info.texture_log2 = value & 15; break;
                case 4: info.texture_levels = value & 31; break;
                case 5: info.height_min = (uint16_t)value; break;
                case 6: info.max_error = (uint16_t)value; break;
                case 7: info.tiles_x = value; break;
                case 8: info.tiles_y = value; break;
                case 9: info.samples_x = value; break;
                case 10: info.samples_y = value; break;
                case 11: info.spacing_wu = value; break;
                case 12: info.hscale_q24 = value; break;
                case 13: info.hoffset_wu = (int32_t)value; break;
                default: info.curve_q60 = value;
            }
        }
        int fault = bake_fault(&info, text, sizeof text);
        assert_int_equal(fault, ff_terrain_check(&info) == FF_ERR_RANGE);
        faults += (uint32_t)fault;
    }
    assert_true(faults > 50000 && faults < 195000);
    ff_terrain_info far = { .node_log2 = 3,
                            .tile_log2 = 10,
                            .tiles_x = 4,
                            .tiles_y = 2,
                            .samples_x = 4097,
                            .samples_y = 2000,
                            .spacing_wu = 1u << 19,
                            .hscale_q24 = 1,
                            .codec = FF_CODEC_DEFLATE };
    assert_int_equal(bake_fault(&far, text, sizeof text), 1);
    assert_string_equal(text, "spacing_wu 524288 is not from 1 to 524287");
}

/* ---- units ---- */

static void units_are_known_in_every_spelling(void **state)
{
    static const double foot = 0.3048, survey = 1200.0 / 3937;
    const struct {
        double metres;
        const char *spellings[12];
    } unit[] = {
        { foot,
          { "ft", "foot", "Feet", "international foot", "foot (International)", "ft_int",
            "feet (international)" } },
        { survey,
          { "ftUS", "us-ft", "US survey foot", "US_survey_foot", "us_ft", "ft_us", "foot_us",
            "Foot_US", "US survey feet", "ft (US)", "feet_us" } },
        { 1, { "m", "metre", "Metres", "meter", "METERS", "[m]", "m (MSL)", "gpm" } },
        { 1000, { "km", "kilometre" } },
        { 0.1, { "dm", "decimeters", "0.1 m" } },
        { 0.01, { "cm", "centimetre" } },
        { 0.001, { "mm", "millimetres" } },
        { 6 * foot, { "fathom", "fathoms" } },
        { 3 * foot, { "yard", "yd" } },
        { foot / 12, { "inch", "in" } },
        { 0, { "klafter", "", " ", "-1 m", "0 m", "inf m", "nan", "f", "t", "m ft" } },
    };
    (void)state;
    for (size_t u = 0; u < sizeof unit / sizeof *unit; u++)
        for (int s = 0; unit[u].spellings[s]; s++) {
            double found = bake_unit_metres(unit[u].spellings[s]);
            if (fabs(found - unit[u].metres) <= 1e-12 * unit[u].metres) continue;
            fail_msg("\"%s\" is %.9g m, not %.9g m", unit[u].spellings[s], found, unit[u].metres);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(node_error_is_exact),
        cmocka_unit_test(the_error_ends_with_the_ground),
        cmocka_unit_test(node_error_of_a_plane_is_nothing),
        cmocka_unit_test(fill_keeps_what_is_known),
        cmocka_unit_test(fill_from_a_single_sample),
        cmocka_unit_test(densify_keeps_samples_and_flat_water),
        cmocka_unit_test(one_tile_holds_the_raster),
        cmocka_unit_test(tile_repeats_the_rim),
        cmocka_unit_test(marks_follow_the_heights),
        cmocka_unit_test(records_tell_filled_nodes),
        cmocka_unit_test(records_decode),
        cmocka_unit_test(jobs_are_taken_in_order),
        cmocka_unit_test(a_failed_job_ends_all),
        cmocka_unit_test(a_fault_is_told_where_the_core_finds_one),
        cmocka_unit_test(units_are_known_in_every_spelling),
    };
    bake_say_setup("test_bake", 1);
    bake_temp_setup("build/x");
    return cmocka_run_group_tests(tests, NULL, NULL);
}
