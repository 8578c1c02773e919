#include "bake_given.h"

#include "../bake_say.h"

#include <math.h>
#include <stdlib.h>

#define RIM 0u /* the run that all runs on the rim are joined to */

/* Stretches of void samples in a row, numbered from 1 in reading order; those that touch are joined
 * (Hoshen and Kopelman 1976, by runs). */
typedef struct runs {
    uint32_t *parent; /* of a run, itself when it stands for its void */
    uint32_t count, room;
} runs;

/* A run that goes from `from` to the sample before `to`. */
typedef struct run {
    uint32_t from, to;
} run;

static uint32_t root_of(const runs *all, uint32_t number)
{
    while (all->parent[number] != number) {
        all->parent[number] = all->parent[all->parent[number]];
        number = all->parent[number];
    }
    return number;
}

static void join(const runs *all, uint32_t a, uint32_t b)
{
    a = root_of(all, a);
    b = root_of(all, b);
    if (a < b)
        all->parent[b] = a;
    else
        all->parent[a] = b;
}

static int add_run(runs *all)
{
    if (all->count == all->room) {
        uint32_t room = all->room ? 2 * all->room : 1024;
        uint32_t *grown = room > all->room ? realloc(all->parent, room * sizeof *grown) : NULL;
        if (!grown) return bake_fail("out of memory");
        all->parent = grown;
        all->room = room;
    }
    all->parent[all->count] = all->count;
    all->count++;
    return 0;
}

/* The next run from `at` on; 0 when there is none. */
static int next_run(const float *row, uint32_t width, uint32_t at, run *found)
{
    while (at < width && !isnan(row[at])) at++;
    if (at == width) return 0;
    found->from = at;
    while (at < width && isnan(row[at])) at++;
    found->to = at;
    return 1;
}

/* Numbers the runs of a row, and joins them to those of the row before (numbered from `before` on)
 * that they touch. */
static int join_row(const float *above, const float *row, uint32_t width, int on_rim,
                    uint32_t before, runs *all)
{
    run mine, other;
    uint32_t number = before;
    int has_other = above && next_run(above, width, 0, &other);
    for (uint32_t at = 0; next_run(row, width, at, &mine); at = mine.to) {
        if (add_run(all)) return -1;
        if (on_rim || mine.from == 0 || mine.to == width) join(all, RIM, all->count - 1);
        while (has_other && other.from <= mine.to) {
            if (other.to >= mine.from) join(all, number, all->count - 1);
            if (other.to > mine.to) break; /* the next run may touch it too */
            has_other = next_run(above, width, other.to, &other);
            number++;
        }
    }
    return 0;
}

static int join_rows(const bake_grid *grid, float *memory, runs *all)
{
    uint32_t before = 1;
    if (add_run(all)) return -1;
    for (uint32_t j = 0; j < grid->height; j++) {
        float *row = memory + (j & 1) * (size_t)grid->width,
              *above = memory + (~j & 1) * (size_t)grid->width;
        uint32_t first = all->count;
        int on_rim = j == 0 || j + 1 == grid->height;
        if (bake_grid_read(grid, j, 0, grid->width, row)) return -1;
        if (join_row(j ? above : NULL, row, grid->width, on_rim, before, all)) return -1;
        before = first;
    }
    return 0;
}

/* Gives each void its height; NaN: it stays void. Without runs all are alike. */
static int give(const bake_options *o, const runs *all, float *row, bake_ground *ground)
{
    const bake_grid *grid = &ground->grid;
    uint32_t number = 1;
    run void_run;
    for (uint32_t j = 0; j < grid->height; j++) {
        if (bake_grid_read(grid, j, 0, grid->width, row)) return -1;
        for (uint32_t at = 0; next_run(row, grid->width, at, &void_run); at = void_run.to) {
            int is_rim = all->count && root_of(all, number++) == RIM;
            double height_m = is_rim ? o->rim_void_height_m : o->void_height_m;
            if (isnan(height_m)) continue;
            for (uint32_t i = void_run.from; i < void_run.to; i++) row[i] = (float)height_m;
            ground->given += void_run.to - void_run.from;
            ground->voids -= void_run.to - void_run.from;
        }
        if (bake_grid_write(grid, j, 0, grid->width, row)) return -1;
    }
    return 0;
}

/* Heights that are whole steps of the source stay so: what is given is rounded to one. */
static void note_step(const bake_ground *ground, double height_m)
{
    if (isnan(height_m) || ground->step_m <= 0) return;
    double steps = (height_m - ground->base_m) / ground->step_m;
    if (fabs(steps - nearbyint(steps)) < 0.01) return;
    bake_note("voids get %.9g m instead of %.9g m: heights are steps of %.9g m",
              ground->base_m + nearbyint(steps) * ground->step_m, height_m, ground->step_m);
}

int bake_given_heights(const bake_options *o, bake_ground *ground)
{
    runs all = { 0 };
    if (!ground->voids || (isnan(o->void_height_m) && isnan(o->rim_void_height_m))) return 0;
    float *memory = malloc(2 * (size_t)ground->grid.width * sizeof *memory);
    int rc = memory ? 0 : bake_fail("out of memory");
    if (!rc && !isnan(o->rim_void_height_m)) rc = join_rows(&ground->grid, memory, &all);
    if (!rc) rc = give(o, &all, memory, ground);
    if (!rc) note_step(ground, o->void_height_m);
    if (!rc) note_step(ground, o->rim_void_height_m);
    free(all.parent);
    free(memory);
    return rc;
}
