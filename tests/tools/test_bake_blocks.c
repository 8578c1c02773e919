/* A tile in blocks gives the pack that it gives in one piece, bit for bit, whatever the size of the
 * blocks and the number of threads. */
#include "../../platform/sys.h"
#include "../../protocol/shape/ff_shape.h"
#include "../../tools/bake/bake_tiles.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* after the four above: */
#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#define SECTIONS_MAX 32
#define SIDE_MAX     150

/* What comes of each section: lengths of the records that have a place, and their bytes. */
typedef struct made {
    bake_blob section[SECTIONS_MAX];
} made;

static int take(void *context, uint32_t section, const bake_blob *records, const bake_blob *above)
{
    made *m = context;
    const uint8_t *bytes = records->bytes;
    size_t each = above ? records->record_count / above->record_count : 1;
    assert_true(section < SECTIONS_MAX && each > 0);
    for (size_t i = 0; i < records->record_count; i++) {
        uint32_t length = records->length[i];
        if (above && above->length[i / each] == 0)
            assert_int_equal(length, 0); /* it would have no parent */
        else
            assert_int_equal(bake_blob_add(&m->section[section], bytes, length), 0);
        if (length) bytes += length;
    }
    return 0;
}

static void forget(made *m)
{
    for (uint32_t i = 0; i < SECTIONS_MAX; i++) bake_blob_free(&m->section[i]);
}

static void same(const made *a, const made *b)
{
    for (uint32_t i = 0; i < SECTIONS_MAX; i++) {
        const bake_blob *x = &a->section[i], *y = &b->section[i];
        assert_int_equal(x->record_count, y->record_count);
        assert_int_equal(x->byte_count, y->byte_count);
        if (x->record_count)
            assert_memory_equal(x->length, y->length, x->record_count * sizeof *x->length);
        if (x->byte_count) assert_memory_equal(x->bytes, y->bytes, x->byte_count);
    }
}

enum kind { NOISE, HILLS, SEA, ISLAND, KINDS };

/* Heights of a kind: sea lies in the west and the south of an island. */
static uint16_t height_at(enum kind kind, uint32_t x, uint32_t y, sys_random *random)
{
    uint32_t hills = 3000 + (x * x + 7 * y * y) % 97 * 3 + 9 * x;
    switch (kind) {
        case NOISE: return (uint16_t)(20000 + sys_random_below(random, 600));
        case HILLS: return (uint16_t)hills;
        case SEA: return 700;
        default: return (uint16_t)(x < 50 || y < 40 ? 700 : hills);
    }
}

typedef struct ground {
    ff_terrain_info info;
    bake_grid heights, filled;
    bake_image image;
} ground;

/* Colours by chance. */
static void make_lattice(bake_grid *grid, uint32_t width, uint32_t height, sys_random *random)
{
    uint8_t *row = test_malloc((size_t)width * 3);
    assert_int_equal(bake_grid_open(grid, width, height, 3), 0);
    for (uint32_t j = 0; j < height; j++) {
        for (uint32_t i = 0; i < 3 * width; i++) row[i] = (uint8_t)sys_random_below(random, 256);
        assert_int_equal(bake_grid_write(grid, j, 0, width, row), 0);
    }
    test_free(row);
}

static void make_ground(ground *g, enum kind kind, uint32_t node_log2, uint32_t tile_log2,
                        uint32_t width, uint32_t height, uint32_t textures, sys_random *random)
{
    uint16_t row[SIDE_MAX];
    uint8_t marks[SIDE_MAX];
    int voids = sys_random_below(random, 2) == 1;
    *g = (ground){ .info = { .node_log2 = (uint8_t)node_log2,
                             .tile_log2 = (uint8_t)tile_log2,
                             .codec = FF_CODEC_RICE,
                             .texture_log2 = textures ? 4 : 0,
                             .texture_levels = (uint8_t)textures,
                             .max_error = (uint16_t)(sys_random_below(random, 3) * 4),
                             .height_max = 65535,
                             .spacing_wu = 256,
                             .hscale_q24 = 1 << 24 },
                   .filled = BAKE_GRID_CLOSED };
    ff_shape_cover(&g->info, width, height);
    assert_int_equal(bake_grid_open(&g->heights, width, height, sizeof *row), 0);
    if (voids) assert_int_equal(bake_grid_open(&g->filled, width, height, 1), 0);
    for (uint32_t y = 0; y < height; y++) {
        for (uint32_t x = 0; x < width; x++) {
            row[x] = height_at(kind, x, y, random);
            marks[x] = sys_random_below(random, 400) == 0;
        }
        assert_int_equal(bake_grid_write(&g->heights, y, 0, width, row), 0);
        if (voids) assert_int_equal(bake_grid_write(&g->filled, y, 0, width, marks), 0);
    }
    g->image.levels = textures;
    for (uint32_t l = 0; l < textures; l++)
        make_lattice(&g->image.lattice[l], (g->info.tiles_x * 15 << l) + 1,
                     (g->info.tiles_y * 15 << l) + 1, random);
}

static void close_ground(ground *g)
{
    bake_image_close(&g->image);
    bake_grid_close(&g->heights);
    bake_grid_close(&g->filled);
}

static void make_of(const ground *g, const bake_samples *samples, uint32_t block_log2,
                    uint32_t jobs, made *m)
{
    bake_tiles tiles = { .info = &g->info,
                         .samples = samples,
                         .image = &g->image,
                         .texture_quality = 50,
                         .block_log2 = block_log2,
                         .jobs = jobs,
                         .context = m,
                         .take = take };
    *m = (made){ .section = { { 0 } } };
    assert_int_equal(bake_tiles_make(&tiles), 0);
}

static void make(const ground *g, uint32_t block_log2, uint32_t jobs, made *m)
{
    bake_grid_samples samples = bake_samples_of(&g->heights, &g->filled);
    make_of(g, &samples.samples, block_log2, jobs, m);
}

static void compare_blocks(const ground *g)
{
    made whole, blocks;
    make(g, g->info.tile_log2, 1, &whole);
    assert_int_equal(whole.section[0].record_count, ff_shape_tiles(&g->info));
    for (uint32_t b = g->info.node_log2; b < g->info.tile_log2; b++) {
        make(g, b, 1 + b % 3, &blocks);
        same(&whole, &blocks);
        forget(&blocks);
    }
    forget(&whole);
}

static void blocks_give_what_one_piece_gives(void **state)
{
    (void)state;
    for (uint32_t seed = 1; seed <= 40; seed++) {
        sys_random random;
        sys_random_seed(&random, seed, 1);
        uint32_t node_log2 = 1 + seed % 3, tile_log2 = 5 + sys_random_below(&random, 3),
                 levels = tile_log2 - node_log2 + 1;
        ground g;
        make_ground(&g, (enum kind)(seed % KINDS), node_log2, tile_log2,
                    2 + sys_random_below(&random, SIDE_MAX - 2),
                    2 + sys_random_below(&random, SIDE_MAX - 2),
                    sys_random_below(&random, levels < 4 ? levels + 1 : 5), &random);
        compare_blocks(&g);
        close_ground(&g);
    }
}

/* ---- samples of unlike spacing ---- */

/* Of a grid, those at multiples of 2^apart_log2, and all from first to last both ways. */
typedef struct sparse_samples {
    bake_samples samples;
    const bake_grid *heights;
    uint32_t apart_log2, first, last;
} sparse_samples;

static int is_fine(const sparse_samples *s, uint32_t at) { return at >= s->first && at <= s->last; }

static int read_sparse(const bake_samples *samples, uint32_t row, uint32_t column, uint32_t count,
                       uint16_t *heights, uint8_t *marks)
{
    const sparse_samples *s = (const sparse_samples *)samples;
    uint32_t mask = (1u << s->apart_log2) - 1;
    assert_int_equal(bake_grid_read(s->heights, row, column, count, heights), 0);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t at = column + i;
        int is_there = (is_fine(s, at) && is_fine(s, row)) || !(at & mask || row & mask);
        marks[i] = is_there ? 0 : BAKE_BETWEEN;
        if (!is_there) heights[i] = (uint16_t)(heights[i] * 31u + 5000u); /* nobody looks at it */
    }
    return 0;
}

static uint32_t apart_sparse(const bake_samples *samples, uint32_t column, uint32_t row,
                             uint32_t side_log2)
{
    const sparse_samples *s = (const sparse_samples *)samples;
    uint32_t side = 1u << side_log2;
    return s->first <= s->last && column <= s->last && column + side >= s->first &&
                   row <= s->last && row + side >= s->first
               ? 0
               : s->apart_log2;
}

static uint64_t bytes_of(const made *m)
{
    uint64_t bytes = 0;
    for (uint32_t i = 0; i < SECTIONS_MAX; i++) bytes += m->section[i].byte_count;
    return bytes;
}

static void samples_apart_give_the_same_however_they_are_read(void **state)
{
    (void)state;
    for (uint32_t seed = 1; seed <= 40; seed++) {
        sys_random random;
        sys_random_seed(&random, seed, 2);
        uint32_t apart_log2 = 1 + sys_random_below(&random, 3),
                 cells = (SIDE_MAX - 1) >> apart_log2, node_log2 = 1 + seed % 3,
                 width = ((1 + sys_random_below(&random, cells)) << apart_log2) + 1,
                 height = ((1 + sys_random_below(&random, cells)) << apart_log2) + 1;
        ground g;
        made whole, blocks, none;
        make_ground(&g, (enum kind)(seed % KINDS), node_log2, 5 + sys_random_below(&random, 3),
                    width, height, 0, &random);
        sparse_samples s = { .samples = { width, height, 1, read_sparse, NULL },
                             .heights = &g.heights,
                             .apart_log2 = apart_log2,
                             .first = sys_random_below(&random, 100),
                             .last = sys_random_below(&random, 130) };
        make_of(&g, &s.samples, g.info.tile_log2, 1, &whole);
        for (uint32_t b = node_log2; b < g.info.tile_log2; b++) {
            s.samples.apart_log2 = b % 2 ? apart_sparse : NULL;
            make_of(&g, &s.samples, b, 1 + b % 2, &blocks);
            same(&whole, &blocks);
            forget(&blocks);
        }
        s.samples.apart_log2 = apart_sparse;
        make_of(&g, &s.samples, g.info.tile_log2, 1, &blocks);
        same(&whole, &blocks);
        make(&g, g.info.tile_log2, 1, &none);
        if (seed % KINDS == NOISE && s.first > s.last && g.info.tile_log2 > node_log2 + apart_log2)
            assert_true(bytes_of(&whole) < bytes_of(&none)); /* of all samples */
        forget(&none);
        forget(&blocks);
        forget(&whole);
        close_ground(&g);
    }
}

static void a_sea_is_a_root_however_it_is_cut(void **state)
{
    (void)state;
    sys_random random;
    ground g;
    made m;
    sys_random_seed(&random, 7, 1);
    make_ground(&g, SEA, 3, 7, 129, 100, 0, &random);
    bake_grid_close(&g.filled);
    g.info.max_error = 0;
    make(&g, 4, 2, &m);
    assert_int_equal(m.section[0].byte_count, 9); /* a head and four corners */
    for (uint32_t l = 1; l < SECTIONS_MAX; l++) assert_int_equal(m.section[l].byte_count, 0);
    assert_int_equal(m.section[1].record_count, 1);
    assert_int_equal(m.section[2].record_count, 0);
    forget(&m);
    close_ground(&g);
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(blocks_give_what_one_piece_gives),
                                        cmocka_unit_test(
                                            samples_apart_give_the_same_however_they_are_read),
                                        cmocka_unit_test(a_sea_is_a_root_however_it_is_cut) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
