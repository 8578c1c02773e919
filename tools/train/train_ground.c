#include "train_ground.h"

#include "../../protocol/shape/ff_shape.h"
#include "../bake/bake_say.h"
#include "../bake/bake_square.h"
#include "../info/bake_unpack.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TILE_LOG2_MAX 9
#define FINER         9
#define COARSE_CELL   8 /* from here on the second set, before the first choice */

/* ---- a pack's heights ---- */

typedef struct taking {
    train_ground *ground;
    const ff_terrain_info *info;
} taking;

static int want_all(void *context, ff_key key) { return (void)context, (void)key, 1; }

static int take_block(void *context, ff_key key, uint32_t side, const uint16_t *heights,
                      const uint8_t *known)
{
    const taking *t = context;
    train_ground *ground = t->ground;
    uint32_t level = ff_key_level(key), code = ff_key_code(key), edge = side - 1;
    ff_sheet at = ff_shape_sheet(t->info, ff_key_tile(key));
    uint32_t west = ((at.x << level) + ff_morton_x(code)) * edge,
             south = ((at.y << level) + ff_morton_y(code)) * edge;
    (void)known;
    for (uint32_t j = 0; j < side && south + j < ground->height; j++)
        for (uint32_t i = 0; i < side && west + i < ground->width; i++)
            ground->heights[(size_t)(south + j) * ground->width + west + i] = heights[j * side + i];
    return 0;
}

int train_ground_open(train_ground *ground, const char *path)
{
    bake_unpack unpack;
    if (bake_unpack_open(&unpack, path)) return -1;
    const ff_terrain_info *info = &unpack.pack.header.info;
    ff_sheet samples = ff_shape_sheet_samples(info);
    taking t = { ground, info };
    bake_unpack_walk walk = { .context = &t, .wants = want_all, .take = take_block };
    *ground = (train_ground){ .path = path,
                              .width = samples.x,
                              .height = samples.y,
                              .step_m = info->hscale_q24 / 16777216.0,
                              .max_error = info->max_error };
    ground->heights = calloc((size_t)ground->width * ground->height, sizeof *ground->heights);
    int rc = ground->heights ? bake_unpack_heights(&unpack, ff_terrain_levels(info) - 1, &walk)
                             : bake_fail("out of memory");
    bake_unpack_close(&unpack);
    return rc;
}

int train_ground_refine(train_ground *finer, const train_ground *ground)
{
    size_t count = (size_t)ground->width * ground->height;
    uint32_t chance = 1;
    *finer = *ground;
    finer->step_m = ground->step_m / FINER;
    finer->heights = malloc(count * sizeof *finer->heights);
    if (!finer->heights) return bake_fail("out of memory");
    for (size_t i = 0; i < count; i++) {
        chance = chance * 1664525u + 1013904223u; /* Numerical Recipes */
        uint32_t height = ground->heights[i] * FINER + (chance >> 16) % FINER;
        finer->heights[i] = (uint16_t)(height < UINT16_MAX ? height : UINT16_MAX);
    }
    return 0;
}

void train_ground_close(train_ground *ground) { free(ground->heights); }

/* ---- made again ---- */

typedef struct maker {
    const train_ground *ground;
    const ff_trained *by;
    enum train_choice choice;
    const train_eye *eye;
    ff_terrain_info info;
    uint32_t side, west, south; /* of the tile, in samples */
    uint16_t *decoded;
    /* of the grid being made */
    const uint16_t *source;
    train_point point;
    double bits;
    int32_t residual[FF_REFINED_HEIGHTS_MAX], quantum;
} maker;

static int32_t residual_of(const maker *m, const ff_expected *p)
{
    int32_t off = m->source[ff_expected_at(p)] - p->predicted, half = m->quantum / 2;
    if (m->quantum == 1) return (int16_t)off; /* the shorter way round */
    return off >= 0 ? (off + half) / m->quantum : -((half - off) / m->quantum);
}

static uint16_t try_height(void *context, const ff_expected *p)
{
    maker *m = context;
    int32_t residual = residual_of(m, p);
    m->bits += train_bits(m->by, p, residual);
    return ff_dequantise(m->quantum, p->predicted, residual);
}

static uint16_t make_height(void *context, const ff_expected *p)
{
    maker *m = context;
    int32_t residual = residual_of(m, p);
    m->point.expected = p;
    m->point.height = m->source[ff_expected_at(p)];
    m->point.residual = residual;
    m->eye->point(m->eye->context, &m->point);
    return ff_dequantise(m->quantum, p->predicted, residual);
}

static const uint16_t *source_at(const maker *m, uint32_t x, uint32_t y)
{
    return m->ground->heights + (size_t)(m->south + y) * m->ground->width + m->west + x;
}

static unsigned choose_set(maker *m, const uint16_t *parent, uint16_t *grid, uint32_t cell,
                           void *room)
{
    double least = HUGE_VAL;
    unsigned best = 0;
    ff_points points = { .height = try_height, .context = m };
    if (m->choice == TRAIN_BY_LEVEL) return cell >= COARSE_CELL;
    for (unsigned set = 0; set < FF_TRAINED_SETS; set++) {
        m->bits = 0;
        ff_expect(m->by, set, &m->info, (ff_cells){ 0, 0 }, parent, grid, room, &points);
        if (m->bits < least) best = set, least = m->bits;
    }
    return best;
}

/* One payload: of the root, parent NULL, or of the children of a node. */
static void make_grid(maker *m, const uint16_t *parent, uint32_t x, uint32_t y, uint32_t cell,
                      uint32_t side)
{
    static uint16_t source[FF_REFINED_HEIGHTS_MAX], grid[FF_REFINED_HEIGHTS_MAX];
    static uint16_t room[FF_CODEC_ROOM_MAX / 2 + 1];
    static uint8_t out[FF_PAYLOAD_BYTES_MAX];
    bake_gather(source_at(m, x, y), m->ground->width, side, cell, source);
    ff_points points = { .height = make_height, .context = m };
    m->source = source;
    for (uint32_t i = 0; !parent && i < FF_CORNERS; i++) {
        uint32_t at = ff_corner_at(&m->info, i);
        grid[at] = ff_dequantise_corner(m->quantum, (source[at] + m->quantum / 2) / m->quantum);
    }
    m->point.info = &m->info;
    /* a level has a fourth of the next one's points, and flights take most of the coarser ones */
    m->point.share = cell;
    m->point.set = choose_set(m, parent, grid, cell, room);
    ff_expect(m->by, m->point.set, &m->info, (ff_cells){ 0, 0 }, parent, grid, room, &points);
    bake_scatter(grid, m->side, side, cell, m->decoded + (size_t)y * m->side + x);
    if (!m->eye->payload) return;
    uint32_t bits = ff_trained_put(m->by, m->point.set, &m->info, (ff_cells){ 0, 0 }, parent,
                                   &(ff_source_heights){ source, NULL }, m->residual, grid, NULL,
                                   out, NULL);
    m->eye->payload(m->eye->context, (bits + 7) / 8 + (parent ? 0 : 2 * FF_CORNERS));
}

static void make_below(maker *m, uint32_t x, uint32_t y, uint32_t cell)
{
    static uint16_t parent[FF_NODE_HEIGHTS_MAX];
    if (cell == 1) return;
    uint32_t edge = cell / 2 << m->info.node_log2;
    bake_gather(m->decoded + (size_t)y * m->side + x, m->side, ff_node_side(&m->info), cell,
                parent);
    make_grid(m, parent, x, y, cell / 2, ff_refined_side(&m->info));
    for (uint32_t q = 0; q < 4; q++)
        make_below(m, x + (q & 1) * edge, y + (q >> 1) * edge, cell / 2);
}

uint64_t train_ground_make(const train_ground *ground, const ff_trained *by,
                           enum train_choice choice, unsigned node_log2, uint32_t max_error,
                           const train_eye *eye)
{
    static maker m;
    uint64_t samples = 0;
    unsigned tile_log2 = TILE_LOG2_MAX;
    while (tile_log2 > node_log2 &&
           (1u << tile_log2 >= ground->width || 1u << tile_log2 >= ground->height))
        tile_log2--;
    m = (maker){ .ground = ground,
                 .by = by,
                 .choice = choice,
                 .eye = eye,
                 .side = (1u << tile_log2) + 1,
                 .quantum = 2 * (int32_t)max_error + 1,
                 .info = { .node_log2 = (uint8_t)node_log2,
                           .tile_log2 = (uint8_t)tile_log2,
                           .max_error = (uint16_t)max_error } };
    m.decoded = malloc((size_t)m.side * m.side * sizeof *m.decoded);
    if (!m.decoded) return 0;
    for (m.south = 0; m.south + m.side <= ground->height; m.south += m.side - 1)
        for (m.west = 0; m.west + m.side <= ground->width; m.west += m.side - 1) {
            make_grid(&m, NULL, 0, 0, (m.side - 1) >> node_log2, ff_node_side(&m.info));
            make_below(&m, 0, 0, (m.side - 1) >> node_log2);
            samples += (uint64_t)(m.side - 1) * (m.side - 1);
        }
    free(m.decoded);
    return samples;
}
