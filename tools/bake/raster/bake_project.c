#include "bake_project.h"

#include "../../../protocol/ff_terrain.h"
#include "bake_area.h"
#include "bake_lattice.h"
#include "bake_target.h"
#include "bake_warp.h"
#include "../bake_say.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#define BEYOND_NOTED_M 0.1
#define GROWTH_MAX     64.0 /* samples made of one: a projection that makes more tears the raster */
#define DRIFT_MAX      0.25 /* samples, from end to end: with more the ground is resampled */
#define DRIFT_NOTED    0.05
#define WHOLE_METRES_M 2.0 /* from this spacing on, whole metres cost less than half a sample */

/* Rounds a spacing to whole world units, so that it has whole ones also after --densify has divided
 * it. */
static double round_spacing(const bake_options *o, double spacing_m)
{
    double units = fmax(1, nearbyint(spacing_m * FF_WU_PER_METRE / o->densify));
    return units * o->densify / FF_WU_PER_METRE;
}

/* Makes of a spacing the one that is told, or that goes with a pack's lattice. 0 or -1 (said). */
static int choose_spacing(const bake_options *o, double *spacing_m)
{
    if (o->spacing_m > 0) *spacing_m = o->spacing_m;
    if (o->lattice) return bake_lattice_spacing(o->lattice, o->spacing_m > 0, spacing_m);
    *spacing_m = round_spacing(o, *spacing_m);
    return 0;
}

/* Refuses, before a sample is made, what would be no terrain or take for ever. 0 or -1 (said). */
static int check_size(const bake_options *o, double source_samples, double spacing_m,
                      double columns, double rows)
{
    if (columns < 2 || rows < 2)
        return bake_fail("a spacing of %g m is too coarse for this raster", spacing_m);
    if (fmax(columns, rows) * spacing_m > BAKE_EDGE_MAX_M)
        return bake_fail(
            "the raster is %.0f x %.0f km after projection, a terrain at most %.0f km: "
            "cut a part with gdal_translate -projwin, or name another projection with "
            "--t-srs",
            columns * spacing_m / 1000, rows * spacing_m / 1000, BAKE_EDGE_MAX_M / 1000);
    if (columns * rows > BAKE_SAMPLES_MAX)
        return bake_fail("a spacing of %g m would make %.0f x %.0f samples, more than %g: give a "
                         "coarser --spacing",
                         spacing_m, columns, rows, BAKE_SAMPLES_MAX);
    if (o->spacing_m <= 0 && columns * rows > GROWTH_MAX * source_samples)
        return bake_fail("projected, the raster would be %.0f times as large: name another "
                         "projection with --t-srs, or give --spacing",
                         columns * rows / source_samples);
    return 0;
}

/* Whether rows run from west to east and columns along the other axis. */
static int is_upright(const double *gt)
{
    return fabs(gt[2]) < 1e-9 * fabs(gt[1]) && fabs(gt[4]) < 1e-9 * fabs(gt[5]) && gt[1] > 0;
}

/* Finds how far the warped grid reaches, and the spacing that suits it best: GDAL's choice, or, of
 * turned cells and in the same plane, the one that makes as many samples as there were. GDAL
 * compares one diagonal of the raster, which of sheared cells is far too long or too short. */
static int plan_extent(const bake_ground *ground, const bake_warp *warp, bake_area *area,
                       double *spacing_m)
{
    const double *gt = ground->geotransform;
    *area = bake_area_of(gt, ground->grid.width, ground->grid.height);
    *spacing_m = sqrt(fabs(gt[1] * gt[5] - gt[2] * gt[4]));
    if (!warp->target) return 0;
    double suggested[6], extent[4];
    int columns, rows;
    GDALDatasetH source = bake_warp_source(warp, &ground->grid);
    void *transform = source ? bake_warp_transform(source, warp->target, &warp->shift) : NULL;
    bake_warp_cell cell;
    int rc = transform ? 0 : -1, is_turned = transform && !is_upright(gt) &&
                                             !bake_warp_measure(transform, 0, ground->grid.width,
                                                                ground->grid.height, &cell);
    if (!rc && GDALSuggestedWarpOutput2(source, GDALGenImgProjTransform, transform, suggested,
                                        &columns, &rows, extent, 0) != CE_None)
        rc = bake_fail_gdal("cannot project the raster");
    if (transform) GDALDestroyGenImgProjTransformer(transform);
    if (source) GDALClose(source);
    if (rc) return rc;
    *area = (bake_area){ extent[0], extent[1], extent[2], extent[3] };
    *spacing_m = suggested[1];
    if (is_turned) *spacing_m = sqrt(fabs(cell.x[0] * cell.y[1] - cell.x[1] * cell.y[0]));
    return 0;
}

/* One axis of the warped grid, from `low` to `high`: where its first sample lies, and how many
 * there are. Coarse grids begin on whole metres, fine ones fill the extent, on whole millimetres;
 * on a pack's lattice its places decide. */
static double plan_axis(const bake_options *o, int axis, double low, double high, double spacing,
                        double *first)
{
    if (o->lattice) return bake_lattice_axis(o->lattice, axis, low, high, spacing, first);
    if (spacing >= WHOLE_METRES_M) {
        *first = ceil(low + spacing / 2);
        return floor((high - spacing / 2 - *first) / spacing) + 1;
    }
    double count = nearbyint((high - low) / spacing);
    *first = nearbyint(((low + high) / 2 - (count - 1) / 2 * spacing) * 1000) / 1000;
    return count;
}

static int plan_warp(const bake_options *o, const bake_ground *ground, bake_warp *warp,
                     double *spacing_m)
{
    bake_area area;
    double spacing, west, south;
    if (plan_extent(ground, warp, &area, &spacing)) return -1;
    if (choose_spacing(o, &spacing)) return -1;
    double columns = plan_axis(o, 0, area.west, area.east, spacing, &west),
           rows = plan_axis(o, 1, area.south, area.north, spacing, &south);
    double source_samples = (double)ground->grid.width * ground->grid.height;
    if (check_size(o, source_samples, spacing, columns, rows)) return -1;
    warp->width = (uint32_t)columns;
    warp->height = (uint32_t)rows;
    double to[6] = { west - spacing / 2, spacing, 0, south + (rows - 0.5) * spacing, 0, -spacing };
    memcpy(warp->to, to, sizeof to);
    *spacing_m = spacing;
    return 0;
}

/* Replaces the grid, and the marks of what was filled in it, by their image; the ground takes
 * plan->warp.target over. */
static int warp_ground(const bake_plan *plan, bake_ground *ground, bake_grid *marks)
{
    bake_warp_count count, ignored;
    OGRSpatialReferenceH target = plan->warp.target;
    int rc = bake_warp_grid(&plan->warp, &ground->grid, &count);
    if (!rc && marks->fd >= 0) rc = bake_warp_grid(&plan->warp, marks, &ignored);
    if (rc) {
        if (target) OSRDestroySpatialReference(target);
        return rc;
    }
    if (count.beyond_m > BEYOND_NOTED_M)
        bake_note("resampling went beyond the source's lowest or highest height at %" PRIu64
                  " samples, by up to %.1f m: kept to it",
                  count.beyond, count.beyond_m);
    memcpy(ground->geotransform, plan->warp.to, sizeof plan->warp.to);
    ground->outside = count.outside;
    ground->resampled = 1;
    ground->shift = plan->warp.shift;
    ground->is_geographic = 0;
    if (target) {
        if (ground->srs) OSRDestroySpatialReference(ground->srs);
        ground->srs = target;
    }
    return 0;
}

/* How far, in samples and from end to end, a grid of upright squares would be off that keeps the
 * samples as they are. */
static double drift_of(const bake_ground *ground, double spacing_m)
{
    const double *gt = ground->geotransform;
    double columns = ground->grid.width, rows = ground->grid.height;
    double x = fabs(gt[1] - spacing_m) * columns + fabs(gt[2]) * rows,
           y = fabs(gt[4]) * columns + fabs(fabs(gt[5]) - spacing_m) * rows;
    return fmax(x, y) / spacing_m;
}

/* Keeps the samples as upright squares round the middle of where they are. */
static void keep_samples(bake_ground *ground, double spacing_m)
{
    double *gt = ground->geotransform, columns = ground->grid.width, rows = ground->grid.height;
    double drift = drift_of(ground, spacing_m), down = gt[5] < 0 ? -spacing_m : spacing_m;
    if (drift > DRIFT_NOTED)
        bake_note("the cells are taken as squares of %.8g m: up to %.2f of a sample off", spacing_m,
                  drift / 2);
    double x = gt[0] + (gt[1] * columns + gt[2] * rows) / 2,
           y = gt[3] + (gt[4] * columns + gt[5] * rows) / 2;
    double kept[6] = { x - spacing_m * columns / 2, spacing_m, 0, y - down * rows / 2, 0, down };
    if (drift > 0) memcpy(gt, kept, sizeof kept);
}

/* Gives ground that lies nowhere the spacing that it is told to have. */
static void space_out(bake_ground *ground, double spacing_m)
{
    double *gt[2] = { ground->geotransform, ground->source_geotransform };
    for (int n = 0; n < 2; n++)
        for (int i = 0; i < 6; i++) gt[n][i] *= spacing_m;
}

/* Finds the spacing of samples that --no-project takes as they are. */
static int take_samples(const bake_options *o, const bake_ground *ground, double *spacing_m)
{
    if (o->spacing_m <= 0 && ground->is_geographic)
        return bake_fail("degrees are no spacing: with --no-project give --spacing too");
    double exact = o->spacing_m > 0 ? o->spacing_m : fabs(ground->geotransform[1]);
    *spacing_m = round_spacing(o, exact);
    double drift = fabs(*spacing_m / exact - 1) * fmax(ground->grid.width, ground->grid.height);
    if (drift > 0.5)
        bake_note("the spacing is rounded to %.8g m: %.1f m from end to end", *spacing_m,
                  drift * exact);
    return 0;
}

/* Prepares samples that --no-project takes as they are. */
static int refuse_projection(const bake_options *o, bake_ground *ground)
{
    const double *gt = ground->geotransform;
    int is_plain = is_upright(gt) &&
                   (ground->is_geographic || drift_of(ground, gt[1]) <= DRIFT_MAX);
    if (o->spacing_m <= 0 && !is_plain)
        return bake_fail("%s: its cells are turned or no squares: leave --no-project out, or give "
                         "--spacing too",
                         o->heights_path);
    if (is_upright(gt)) return 0;
    bake_note("%s: its cells are turned: with --no-project the pack does not tell where they lie",
              o->heights_path);
    bake_ground_forget_place(ground);
    return 0;
}

/* Plans a grid whose samples all stay. */
static int plan_kept(const bake_ground *ground, double spacing_m, bake_plan *plan)
{
    memcpy(plan->warp.to, ground->geotransform, sizeof plan->warp.to);
    plan->warp.width = ground->grid.width;
    plan->warp.height = ground->grid.height;
    plan->spacing_m = spacing_m;
    return 0;
}

/* Chooses how the ground gets from its datum to that of the target. 0 or -1 (said). */
static int plan_shift(const bake_options *o, const bake_ground *ground, bake_warp *warp)
{
    bake_area degrees;
    if (!warp->target || bake_shift_area(ground->srs, ground->geotransform, ground->grid.width,
                                         ground->grid.height, &degrees))
        return 0;
    return bake_shift_find(o->heights_path, ground->srs, warp->target, &degrees, NULL,
                           &warp->shift);
}

/* Plans a grid that is resampled into plan->warp.target (NULL: the same plane). */
static int plan_resampled(const bake_options *o, const bake_ground *ground, bake_plan *plan)
{
    plan->is_resampled = 1;
    plan->warp.srs = ground->srs;
    plan->warp.jobs = (int)o->jobs;
    memcpy(plan->warp.from, ground->geotransform, sizeof plan->warp.from);
    if (!plan_shift(o, ground, &plan->warp) &&
        !plan_warp(o, ground, &plan->warp, &plan->spacing_m)) {
        if (plan->warp.target) bake_target_note(ground, plan->warp.target);
        bake_shift_note(o->heights_path, &plan->warp.shift, plan->spacing_m);
        return 0;
    }
    if (plan->warp.target) OSRDestroySpatialReference(plan->warp.target);
    return -1;
}

/* Plans a grid of a pack's lattice. */
static int plan_on_lattice(const bake_options *o, bake_ground *ground, bake_plan *plan)
{
    double spacing_m = ground->geotransform[1];
    if (bake_lattice_target(o->lattice, ground, &plan->warp.target)) return -1;
    if (plan->warp.target) return plan_resampled(o, ground, plan);
    if (choose_spacing(o, &spacing_m)) return -1;
    if (bake_lattice_keeps(o->lattice, ground, spacing_m))
        return plan_kept(ground, spacing_m, plan);
    bake_note("%s: its samples are no places of the lattice of %s: resampled", o->heights_path,
              o->lattice->path);
    return plan_resampled(o, ground, plan);
}

int bake_project_plan(const bake_options *o, bake_ground *ground, bake_plan *plan)
{
    double spacing_m = 0;
    *plan = (bake_plan){ 0 };
    if (o->target_epsg && !ground->srs)
        return bake_fail("%s names no reference system: nothing to project from", o->heights_path);
    if (!ground->has_place && o->spacing_m <= 0)
        return bake_fail("%s: no georeference: give --spacing", o->heights_path);
    if (o->lattice) return plan_on_lattice(o, ground, plan);
    if (ground->has_place && o->no_project && refuse_projection(o, ground)) return -1;
    if (ground->has_place && bake_target_choose(o, ground, &plan->warp.target)) return -1;
    if (o->no_project)
        return take_samples(o, ground, &spacing_m) ? -1 : plan_kept(ground, spacing_m, plan);
    if (!ground->has_place) space_out(ground, o->spacing_m);
    double wanted = o->spacing_m > 0 ? o->spacing_m : ground->geotransform[1];
    int same_spacing = fabs(wanted / ground->geotransform[1] - 1) < 1e-6;
    spacing_m = round_spacing(o, wanted);
    if (!plan->warp.target && same_spacing && drift_of(ground, spacing_m) <= DRIFT_MAX) {
        keep_samples(ground, spacing_m);
        return plan_kept(ground, spacing_m, plan);
    }
    plan->is_forced = !plan->warp.target && same_spacing;
    return plan_resampled(o, ground, plan);
}

int bake_project(const bake_options *o, bake_ground *ground, bake_grid *marks, double *spacing_m)
{
    bake_plan plan;
    if (bake_project_plan(o, ground, &plan)) return -1;
    *spacing_m = plan.spacing_m;
    if (!plan.is_resampled) return 0;
    if (warp_ground(&plan, ground, marks)) return -1;
    if (plan.is_forced)
        bake_note("%s: its cells are turned, unlike or no multiple of 1/%d m: resampled to squares "
                  "of %.8g m",
                  o->heights_path, FF_WU_PER_METRE, *spacing_m);
    return 0;
}
