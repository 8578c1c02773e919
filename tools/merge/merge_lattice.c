#include "merge_lattice.h"

#include "../../protocol/shape/ff_shape.h"
#include "../bake/raster/bake_quantise.h"

#include <math.h>
#include <stdlib.h>

#define MM_PER_METRE  1000
#define TOLERANCE_MM  1 /* origins are told in whole millimetres */
#define TOLERANCE_WU  1 /* and heights of step 0 in whole units */
#define STEPS_MAX     65535
#define PLACES_MAX    (INT64_C(1) << 31)
#define ORIGIN_MM_MAX (INT64_C(1) << 60) /* no reference system goes so far */

/* ---- places ---- */

double merge_spacing_m(const ff_terrain_info *info)
{
    return (double)info->spacing_wu / FF_WU_PER_METRE;
}

/* Log2 of how many times the finest spacing fits; -1: not a power of two. */
static int apart_log2(uint32_t spacing_wu, uint32_t finest_wu)
{
    uint32_t times = spacing_wu / finest_wu;
    int log2 = 0;
    if (spacing_wu % finest_wu || times & (times - 1)) return -1;
    while (times >> (log2 + 1)) log2++;
    return log2;
}

/* How many times a spacing goes into a distance; 0 where it does not go a whole number of times. */
static int count_places(int64_t distance_mm, uint32_t spacing_wu, int64_t *places)
{
    double apart_mm = (double)spacing_wu * MM_PER_METRE / FF_WU_PER_METRE,
           count = nearbyint((double)distance_mm / apart_mm);
    if (!(fabs(count) < (double)PLACES_MAX)) return 0;
    *places = (int64_t)count;
    return fabs((double)distance_mm - count * apart_mm) <= TOLERANCE_MM;
}

/* Differences of such origins fit, and what a pack's ground adds to them. */
static int is_somewhere(const ff_terrain_info *info)
{
    return llabs(info->origin_x_mm / 2) < ORIGIN_MM_MAX / 2 &&
           llabs(info->origin_y_mm / 2) < ORIGIN_MM_MAX / 2;
}

/* Where the packs lie, counted from the first one's south-west sample. */
typedef struct span {
    int64_t x, y, end_x, end_y;
    uint32_t apart_log2;
} span;

static uint32_t finest_of(const ff_terrain_info *const info[], uint32_t count)
{
    uint32_t finest = UINT32_MAX;
    for (uint32_t i = 0; i < count; i++)
        if (info[i]->spacing_wu < finest) finest = info[i]->spacing_wu;
    return finest;
}

static enum merge_fault find_span(const ff_terrain_info *info, const ff_terrain_info *first,
                                  uint32_t finest_wu, span *s)
{
    ff_sheet samples = ff_shape_sheet_samples(info);
    int log2 = apart_log2(info->spacing_wu, finest_wu);
    if (log2 < 0) return MERGE_SPACING;
    if (!is_somewhere(first) || !is_somewhere(info) ||
        !count_places(info->origin_x_mm - first->origin_x_mm, finest_wu, &s->x) ||
        !count_places(info->origin_y_mm - first->origin_y_mm, finest_wu, &s->y))
        return MERGE_PLACES;
    s->apart_log2 = (uint32_t)log2;
    s->end_x = s->x + ((int64_t)(samples.x - 1) << log2);
    s->end_y = s->y + ((int64_t)(samples.y - 1) << log2);
    return MERGE_FITS;
}

/* Whether the coarser of two packs has its samples on places of the finer one's lattice. */
static int are_nested(const span *a, const span *b)
{
    uint32_t finer = a->apart_log2 < b->apart_log2 ? a->apart_log2 : b->apart_log2;
    int64_t mask = (INT64_C(1) << finer) - 1;
    return !((a->x - b->x) & mask) && !((a->y - b->y) & mask);
}

/* The next place of the coarsest lattice from `at` on, down or up. */
static int64_t round_place(int64_t at, int64_t on, uint32_t log2, int up)
{
    int64_t edge = INT64_C(1) << log2, rest = (at - on) & (edge - 1);
    return rest && up ? at - rest + edge : at - rest;
}

/* The rectangle round all packs, on the lattice of the coarsest one. */
static span span_all(const span each[], uint32_t count)
{
    span all = each[0];
    int64_t on_x = each[0].x, on_y = each[0].y;
    for (uint32_t i = 1; i < count; i++) {
        const span *s = &each[i];
        if (s->x < all.x) all.x = s->x;
        if (s->y < all.y) all.y = s->y;
        if (s->end_x > all.end_x) all.end_x = s->end_x;
        if (s->end_y > all.end_y) all.end_y = s->end_y;
        if (s->apart_log2 <= all.apart_log2) continue;
        all.apart_log2 = s->apart_log2;
        on_x = s->x;
        on_y = s->y;
    }
    all.x = round_place(all.x, on_x, all.apart_log2, 0);
    all.y = round_place(all.y, on_y, all.apart_log2, 0);
    all.end_x = round_place(all.end_x, on_x, all.apart_log2, 1);
    all.end_y = round_place(all.end_y, on_y, all.apart_log2, 1);
    return all;
}

/* The joint origin along an axis: that of a pack which begins there, where one does. */
static int64_t origin_mm(int64_t at, uint32_t finest_wu, int64_t pack_at, int64_t pack_mm)
{
    return pack_mm +
           (int64_t)nearbyint((double)(at - pack_at) * finest_wu * MM_PER_METRE / FF_WU_PER_METRE);
}

static void place_all(const ff_terrain_info *const info[], const span each[], uint32_t count,
                      const span *all, merge_lattice *lattice, merge_place place[])
{
    uint32_t finest_wu = lattice->info.spacing_wu, x = 0, y = 0;
    for (uint32_t i = 0; i < count; i++) {
        ff_sheet samples = ff_shape_sheet_samples(info[i]);
        place[i].apart_log2 = each[i].apart_log2;
        place[i].left = (uint32_t)(each[i].x - all->x);
        place[i].bottom = (uint32_t)(each[i].y - all->y);
        place[i].columns = samples.x;
        place[i].rows = samples.y;
        if (place[i].left < place[x].left) x = i;
        if (place[i].bottom < place[y].bottom) y = i;
    }
    lattice->width = (uint32_t)(all->end_x - all->x) + 1;
    lattice->height = (uint32_t)(all->end_y - all->y) + 1;
    lattice->apart_log2 = all->apart_log2;
    lattice->info.origin_x_mm = origin_mm(all->x, finest_wu, each[x].x, info[x]->origin_x_mm);
    lattice->info.origin_y_mm = origin_mm(all->y, finest_wu, each[y].y, info[y]->origin_y_mm);
}

/* ---- heights ---- */

/* How many steps a pack's step 0 lies above the first one's; 0 where it is not a whole number. */
static int count_steps(const ff_terrain_info *info, const ff_terrain_info *first, int64_t *steps)
{
    double step_wu = info->hscale_q24 / 65536.0,
           apart_wu = (double)info->hoffset_wu - first->hoffset_wu,
           count = nearbyint(apart_wu / step_wu);
    *steps = (int64_t)count;
    return info->hscale_q24 == first->hscale_q24 &&
           fabs(apart_wu - count * step_wu) <= TOLERANCE_WU;
}

/* Chooses step 0 as a bake of all the ground would, and what is added to each pack's heights. */
static enum merge_fault find_steps(const ff_terrain_info *const info[], uint32_t count,
                                   ff_terrain_info *joint, merge_place place[], uint32_t *which)
{
    int64_t steps[MERGE_PACKS_MAX], low = INT64_MAX, high = INT64_MIN;
    for (uint32_t i = 0; i < count; i++) {
        *which = i;
        if (!count_steps(info[i], info[0], &steps[i])) return MERGE_STEP;
        if (info[i]->height_min + steps[i] < low) low = info[i]->height_min + steps[i];
        if (info[i]->height_max + steps[i] > high) high = info[i]->height_max + steps[i];
        if (high - low > STEPS_MAX) return MERGE_RANGE;
    }
    double step_m, base_m;
    bake_steps_of(info[0], &step_m, &base_m);
    double zero = nearbyint(((double)info[0]->hoffset_wu / FF_WU_PER_METRE - base_m) / step_m);
    double first = bake_steps_first(base_m, step_m, zero + (double)low, zero + (double)high);
    joint->hoffset_wu = (int32_t)nearbyint((base_m + first * step_m) * FF_WU_PER_METRE);
    for (uint32_t i = 0; i < count; i++)
        place[i].steps = (int32_t)(steps[i] + (int64_t)(zero - first));
    joint->height_min = (uint16_t)(low + (int64_t)(zero - first));
    joint->height_max = (uint16_t)(high + (int64_t)(zero - first));
    return MERGE_FITS;
}

/* ---- all ---- */

static enum merge_fault compare(const ff_terrain_info *info, const ff_terrain_info *first)
{
    if (info->epsg != first->epsg) return MERGE_SYSTEM;
    if (info->curve_q60 != first->curve_q60) return MERGE_CURVE;
    if (info->node_log2 != first->node_log2 || info->codec != first->codec) return MERGE_NODES;
    if (info->hscale_q24 != first->hscale_q24) return MERGE_STEP;
    return info->max_error ? MERGE_LOSSY : MERGE_FITS;
}

enum merge_fault merge_lattice_find(const ff_terrain_info *const info[], uint32_t count,
                                    merge_lattice *lattice, merge_place place[], uint32_t *which)
{
    span each[MERGE_PACKS_MAX];
    uint32_t finest_wu = finest_of(info, count);
    FF_ASSERT(count >= 1 && count <= MERGE_PACKS_MAX);
    *lattice = (merge_lattice){ .info = *info[0] };
    lattice->info.spacing_wu = finest_wu;
    lattice->info.flags = lattice->info.texture_log2 = lattice->info.texture_levels = 0;
    for (uint32_t i = 0; i < count; i++) {
        *which = i;
        enum merge_fault fault = compare(info[i], info[0]);
        if (!fault) fault = find_span(info[i], info[0], finest_wu, &each[i]);
        if (fault) return fault;
        for (uint32_t j = 0; j < i; j++)
            if (!are_nested(&each[i], &each[j])) return MERGE_PLACES;
        lattice->info.flags |= info[i]->flags & FF_TERRAIN_DENSIFIED;
    }
    span all = span_all(each, count);
    if (all.end_x - all.x >= PLACES_MAX || all.end_y - all.y >= PLACES_MAX) return MERGE_FAR;
    place_all(info, each, count, &all, lattice, place);
    return find_steps(info, count, &lattice->info, place, which);
}

int merge_place_precedes(const merge_place place[], uint32_t a, uint32_t b)
{
    if (place[a].apart_log2 != place[b].apart_log2)
        return place[a].apart_log2 < place[b].apart_log2;
    return a < b;
}

/* ---- what is not covered ---- */

merge_rectangle merge_place_reach(const merge_lattice *lattice, const merge_place *place)
{
    uint32_t beyond = (1u << place->apart_log2) - 1,
             right = place->left + ((place->columns - 1) << place->apart_log2),
             top = place->bottom + ((place->rows - 1) << place->apart_log2);
    return (
        merge_rectangle){ place->left > beyond ? place->left - beyond : 0,
                          place->bottom > beyond ? place->bottom - beyond : 0,
                          lattice->width - 1 - right > beyond ? right + beyond : lattice->width - 1,
                          lattice->height - 1 - top > beyond ? top + beyond : lattice->height - 1 };
}

static int ascending(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

double merge_lattice_gap(const merge_lattice *lattice, const merge_place place[], uint32_t count)
{
    uint32_t x[2 * MERGE_PACKS_MAX], y[2 * MERGE_PACKS_MAX], edges = 2 * count;
    merge_rectangle reach[MERGE_PACKS_MAX];
    double covered = 0;
    for (uint32_t i = 0; i < count; i++) {
        reach[i] = merge_place_reach(lattice, &place[i]);
        x[2 * i] = reach[i].left;
        x[2 * i + 1] = reach[i].right + 1;
        y[2 * i] = reach[i].bottom;
        y[2 * i + 1] = reach[i].top + 1;
    }
    qsort(x, edges, sizeof *x, ascending);
    qsort(y, edges, sizeof *y, ascending);
    for (uint32_t j = 0; j + 1 < edges; j++)
        for (uint32_t i = 0; i + 1 < edges; i++)
            for (uint32_t p = 0; p < count; p++) {
                if (x[i] < reach[p].left || x[i] > reach[p].right || y[j] < reach[p].bottom ||
                    y[j] > reach[p].top)
                    continue;
                covered += (double)(x[i + 1] - x[i]) * (y[j + 1] - y[j]);
                break;
            }
    return 1 - covered / ((double)lattice->width * lattice->height);
}
