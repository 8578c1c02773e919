#include "bake_estimate.h"

#include "../../platform/sys.h"
#include "../../protocol/shape/ff_shape.h"
#include "image/bake_image_sample.h"
#include "bake_say.h"
#include "bake_window.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define WINDOWS_SIDE      4u
#define WINDOWS_MAX       (WINDOWS_SIDE * WINDOWS_SIDE)
#define WINDOW_LOG2       6u
#define LARGE_SAMPLES     (1u << 22) /* ground of more has larger windows */
#define WHOLE_SAMPLES     (1u << 17) /* ground of fewer is made as a whole */
#define RECORD_BYTES      3.3        /* index and checksum of a record */
#define SECTION_BYTES     60         /* of an index that is not full */
#define DEVIATIONS        2          /* from the middle to the ends of a range */
#define PROBES            32
#define PLACES            (5 * WINDOWS_MAX + PROBES * PROBES)
#define ROWS_APART        3    /* for roughness */
#define MODEL_DEVIATION   0.04 /* of what is not sampled but reckoned */
#define MEMORY_BYTES      (130.0 * (1 << 20))
#define DISK_SAMPLE_BYTES 12.0

/* All that is found out. */
typedef struct estimate {
    bake *b;
    bake_plan plan;
    bake_ground place; /* the ground as it will be, without samples */
    bake_window_count window[WINDOWS_MAX];
    uint32_t count;
    double window_cells; /* of a window, invented ones too */
    int whole;           /* the only window is the ground */
    double inside;       /* part of the new grid that the source reaches */
    bake_guess heights;
    double index; /* bytes of indexes and checksums of heights */
    bake_image_guess textures;
    double read_s, ground_s, encode_s;
    double share; /* of the samples that were made */
} estimate;

/* ---- what is known ---- */

/* The new grid, as the bake will have it; its samples are not made. */
static int plan_ground(estimate *e)
{
    bake *b = e->b;
    const bake_options *o = b->options;
    if (bake_project_plan(o, &b->ground, &e->plan)) return -1;
    const bake_warp *warp = &e->plan.warp;
    double half = 0.5 - 0.5 / o->densify;
    e->place = b->ground;
    e->place.grid = (bake_grid){ .fd = -1,
                                 .width = (warp->width - 1) * o->densify + 1,
                                 .height = (warp->height - 1) * o->densify + 1 };
    double gt[6] = { warp->to[0] + half * warp->to[1],
                     warp->to[1] / o->densify,
                     0,
                     warp->to[3] + half * warp->to[5],
                     0,
                     warp->to[5] / o->densify };
    memcpy(e->place.geotransform, gt, sizeof gt);
    e->place.resampled = e->plan.is_resampled;
    e->place.is_geographic = !e->plan.is_resampled && b->ground.is_geographic;
    if (warp->target) e->place.srs = warp->target;
    b->info.spacing_wu = bake_spacing_wu(o, e->plan.spacing_m);
    return bake_steps_choose(o, &b->ground, &b->steps);
}

/* Describes the terrain, of which quantising sets the units. */
static int describe(estimate *e)
{
    bake *b = e->b;
    bake_ground source = b->ground, corner = b->ground;
    bake_grid heights = BAKE_GRID_CLOSED;
    if (bake_grid_open(&corner.grid, 2, 2, sizeof(float))) return -1;
    int rc = 0;
    for (uint32_t j = 0; !rc && j < 2; j++)
        rc = bake_grid_write(&corner.grid, j, 0, 2,
                             (float[]){ (float)b->steps.min_m, (float)b->steps.max_m });
    if (!rc) rc = bake_quantise(b->options, &corner, &b->steps, &b->info, &heights);
    bake_grid_close(&corner.grid);
    bake_grid_close(&heights);
    if (rc) return rc;
    b->ground = e->place;
    b->heights.width = e->place.grid.width;
    b->heights.height = e->place.grid.height;
    rc = bake_describe(b);
    b->ground = source;
    return rc;
}

/* ---- windows ---- */

static double samples_of(const bake *b) { return (double)b->heights.width * b->heights.height; }

static uint32_t window_log2(const bake *b)
{
    uint32_t log2 = samples_of(b) > LARGE_SAMPLES ? WINDOW_LOG2 + 1 : WINDOW_LOG2;
    while (1u << log2 < 8 * b->options->densify) log2++;
    return log2 < b->info.tile_log2 ? log2 : b->info.tile_log2;
}

/* Windows along an axis. */
static uint32_t fields(uint32_t samples, uint32_t size)
{
    uint32_t most = samples / size;
    return most < 1 ? 1 : most < WINDOWS_SIDE ? most : WINDOWS_SIDE;
}

/* Spreads windows over the middles of equal fields of the new grid. */
static uint32_t spread(estimate *e, uint32_t size, bake_window *window)
{
    uint32_t width = e->plan.warp.width, height = e->plan.warp.height, count = 0;
    e->whole = samples_of(e->b) <= WHOLE_SAMPLES;
    if (e->whole) {
        window[0] = (bake_window){ 0, 0, width, height };
        return 1;
    }
    uint32_t w = width < size ? width : size, h = height < size ? height : size;
    uint32_t columns = fields(width, w), rows = fields(height, h);
    for (uint32_t j = 0; j < rows; j++)
        for (uint32_t i = 0; i < columns; i++)
            window[count++] = (bake_window){ (uint32_t)((i + 0.5) * (width - w) / columns),
                                             (uint32_t)((j + 0.5) * (height - h) / rows), w, h };
    return count;
}

/* Of the source, the part that a window shows: between the places of its corners. 0, or -1: its
 * middle lies beyond the source. */
static int part_of(const bake_grid *source, const double *x, const double *y, bake_part *part)
{
    double low_x = x[4], high_x = x[4], low_y = y[4], high_y = y[4];
    if (isnan(x[4])) return -1;
    for (int i = 0; i < 4; i++) {
        low_x = fmin(low_x, x[i]); /* of NaN and a number the number */
        high_x = fmax(high_x, x[i]);
        low_y = fmin(low_y, y[i]);
        high_y = fmax(high_y, y[i]);
    }
    *part = (bake_part){ (uint32_t)low_x, (uint32_t)low_y,
                         (uint32_t)fmin(high_x, source->width - 1.0),
                         (uint32_t)fmin(high_y, source->height - 1.0) };
    return 0;
}

/* Corners and middle of a window, in columns and rows. */
static void mark(const bake_window *w, double *x, double *y)
{
    for (int i = 0; i < 5; i++) {
        x[i] = w->column + w->width * (i == 4 ? 0.5 : i & 1);
        y[i] = w->row + w->height * (i == 4 ? 0.5 : i >> 1);
    }
}

/* Which part of the new grid the source reaches, of PROBES x PROBES places. */
static double part_inside(const double *x)
{
    int inside = 0;
    for (int i = 0; i < PROBES * PROBES; i++) inside += !isnan(x[i]);
    return (double)inside / (PROBES * PROBES);
}

/* Places of all windows and of the probes in the source. */
static int look_back(const estimate *e, const bake_window *window, uint32_t count, double *x,
                     double *y)
{
    const bake_warp *warp = &e->plan.warp;
    double *px = x + 5 * WINDOWS_MAX, *py = y + 5 * WINDOWS_MAX;
    for (uint32_t i = 0; i < count; i++) mark(&window[i], x + 5 * i, y + 5 * i);
    for (uint32_t i = count; i < WINDOWS_MAX; i++) mark(&window[0], x + 5 * i, y + 5 * i);
    for (int i = 0; i < PROBES * PROBES; i++) {
        px[i] = (i % PROBES + 0.5) / PROBES * warp->width;
        py[i] = (i / PROBES + 0.5) / PROBES * warp->height;
    }
    if (!e->plan.is_resampled) return 0;
    return bake_warp_back(warp, &e->b->ground.grid, PLACES, x, y);
}

static double quantum_m(const bake *b) { return b->steps.step_m * (2.0 * b->info.max_error + 1); }

/* Makes all windows that show the source. */
static int make_windows(estimate *e)
{
    static double x[PLACES], y[PLACES];
    bake_window window[WINDOWS_MAX];
    bake *b = e->b;
    uint32_t log2 = window_log2(b),
             count = spread(e, (1u << log2) / b->options->densify + 1, window);
    if (look_back(e, window, count, x, y)) return -1;
    e->inside = part_inside(x + 5 * WINDOWS_MAX);
    bake_say_setup("farfield-bake", 1); /* what is noted of the whole is not noted of each window */
    for (uint32_t i = 0; i < count; i++) {
        bake_part part;
        bake_window_count *made = &e->window[e->count];
        if (part_of(&b->ground.grid, x + 5 * i, y + 5 * i, &part)) continue;
        if (bake_window_make(b, &e->plan, &window[i], e->whole ? b->info.tile_log2 : log2, made) ||
            bake_roughness(&b->ground.grid, &part, 1, quantum_m(b), &made->roughness))
            return -1;
        e->window_cells = (double)(window[i].width - 1) * (window[i].height - 1) *
                          b->options->densify * b->options->densify;
        e->count++;
    }
    bake_say_setup("farfield-bake", b->options->quiet);
    return e->count ? 0 : bake_fail("the projected ground shows nothing of its middle");
}

/* ---- sums ---- */

/* Bytes of all refinements of a window that a tile of the pack has too. */
static double refinement_bytes(const bake_window_count *w)
{
    double bytes = 0;
    for (uint32_t l = 1; l < w->levels; l++) bytes += (double)w->bytes[l];
    return bytes;
}

/* Bytes of a window's refinements on ground of this roughness, by the line that fits the windows
 * best. */
static bake_guess regress(const estimate *e, double roughness)
{
    double n = e->count, x = 0, y = 0, xx = 0, xy = 0, rest = 0;
    for (uint32_t i = 0; i < e->count; i++) {
        x += e->window[i].roughness / n;
        y += refinement_bytes(&e->window[i]) / n;
    }
    for (uint32_t i = 0; i < e->count; i++) {
        double dx = e->window[i].roughness - x, dy = refinement_bytes(&e->window[i]) - y;
        xx += dx * dx;
        xy += dx * dy;
    }
    double slope = xx > 1e-9 && n > 2 ? fmax(0, xy / xx) : 0;
    for (uint32_t i = 0; i < e->count; i++) {
        double dy = refinement_bytes(&e->window[i]) - y - slope * (e->window[i].roughness - x);
        rest += dy * dy;
    }
    return (bake_guess){ fmax(y / 10, y + slope * (roughness - x)),
                         n > 2 ? sqrt(rest / (n - 2) / n) : 0 };
}

/* Bytes and records of the levels that are coarser than a window's, and of the roots: by the
 * record, as the windows' coarsest ones. `cells`: of ground. */
static void add_coarse(const estimate *e, double cells, double *all_bytes, double *all_records)
{
    const ff_terrain_info *info = &e->b->info;
    uint32_t above = ff_terrain_levels(info) - e->window[0].levels;
    double bytes[2] = { 0 }, records[2] = { 0 }, roots = ff_shape_tiles(info), refinements = 0;
    for (uint32_t i = 0; i < e->count; i++)
        for (uint32_t l = 0; l < 2 && l < e->window[i].levels; l++) {
            bytes[l] += (double)e->window[i].bytes[l];
            records[l] += (double)e->window[i].records[l];
        }
    for (uint32_t l = 0; l < above; l++)
        refinements += fmax(roots, cells / pow(4, info->tile_log2 - l));
    *all_bytes += roots * bytes[0] / records[0] +
                  (records[1] > 0 ? refinements * bytes[1] / records[1] : 0);
    *all_records += roots + refinements;
}

/* Refinements that windows store, on average. */
static double refinement_records(const estimate *e)
{
    double records = 0;
    for (uint32_t i = 0; i < e->count; i++)
        for (uint32_t l = 1; l < e->window[i].levels; l++)
            records += (double)e->window[i].records[l];
    return records / e->count;
}

/* Bytes of all heights, from windows that are a part of the ground. */
static int guess_heights(estimate *e)
{
    double ground = (e->place.grid.width - 1.0) * (e->place.grid.height - 1.0) * e->inside;
    bake_part whole = { 0, 0, e->b->ground.grid.width - 1, e->b->ground.grid.height - 1 };
    double roughness;
    if (bake_roughness(&e->b->ground.grid, &whole, ROWS_APART, quantum_m(e->b), &roughness))
        return -1;
    bake_guess refinements = regress(e, roughness);
    double cell = refinements.value / e->window_cells, fine = cell * ground;
    double share = fmin(1, e->count * e->window_cells / ground);
    e->heights.value = fine;
    double records = refinement_records(e) / e->window_cells * ground;
    add_coarse(e, ground, &e->heights.value, &records);
    e->index = SECTION_BYTES * (double)ff_terrain_levels(&e->b->info) + RECORD_BYTES * records;
    e->heights.deviation = hypot(refinements.deviation / e->window_cells * ground * sqrt(1 - share),
                                 MODEL_DEVIATION * fine);
    e->share = share;
    return 0;
}

/* The only window is the ground. */
static void take_heights(estimate *e)
{
    const bake_window_count *w = &e->window[0];
    e->index = (double)w->index_bytes;
    for (uint32_t l = 0; l < w->levels; l++) {
        e->heights.value += (double)w->bytes[l];
        e->index += FF_RECORD_CRC_BYTES * (double)w->records[l];
    }
    e->share = 1;
}

/* What the windows took, as if they were all. */
static void guess_time(estimate *e)
{
    double ground_s = 0, encode_s = 0;
    for (uint32_t i = 0; i < e->count; i++) {
        ground_s += e->window[i].ground_s;
        encode_s += e->window[i].encode_s;
    }
    e->ground_s = ground_s / e->share;
    e->encode_s = encode_s / e->share;
}

/* ---- telling ---- */

typedef struct verdict {
    double file_bytes, low_bytes, high_bytes, seconds, memory_bytes, disk_bytes, spent_s;
} verdict;

static verdict conclude(const estimate *e)
{
    const bake *b = e->b;
    const ff_terrain_info *info = &b->info;
    double samples = (double)e->place.grid.width * e->place.grid.height, textures = 0;
    for (uint32_t l = 0; l < info->texture_levels; l++)
        textures += fmax(1, e->textures.reach * samples / pow(4, info->tile_log2 - l));
    uint32_t jobs = bake_tiles_workers(info, BAKE_BLOCK_LOG2, b->options->jobs);
    uint32_t about = bake_about_of(e->b, &e->place).byte_count;
    double known = FF_PACK_HEADER_BYTES + about + e->index +
                   SECTION_BYTES * (double)info->texture_levels + RECORD_BYTES * textures;
    double spread = DEVIATIONS * hypot(e->heights.deviation, e->textures.deviation);
    verdict v = { .file_bytes = known + e->heights.value + e->textures.bytes,
                  .seconds = e->read_s + e->ground_s + e->textures.lattice_s +
                             (e->encode_s + e->textures.encode_s) / jobs,
                  .memory_bytes = MEMORY_BYTES + bake_tiles_bytes(info, BAKE_BLOCK_LOG2, jobs),
                  .disk_bytes = DISK_SAMPLE_BYTES * samples,
                  .spent_s = (double)(sys_time_us() - b->started_us) / 1e6 };
    v.low_bytes = fmax(known, v.file_bytes - spread);
    v.high_bytes = v.file_bytes + spread;
    return v;
}

static void tell(const estimate *e, const verdict *v)
{
    const bake *b = e->b;
    const ff_terrain_info *info = &b->info;
    ff_sheet samples = ff_shape_sheet_samples(info), tiles = ff_shape_sheet_tiles(info);
    double spacing_m = (double)info->spacing_wu / FF_WU_PER_METRE;
    printf("samples         %u x %u, %.9g m apart (%.3f x %.3f km)\n", samples.x, samples.y,
           spacing_m, (samples.x - 1) * spacing_m / 1000, (samples.y - 1) * spacing_m / 1000);
    printf("heights         %.3f to %.3f m in steps of %.9g m, error at most %.9g m\n",
           b->steps.min_m, b->steps.max_m, b->steps.step_m, info->max_error * b->steps.step_m);
    printf("tiles           %u x %u of (2^%u+1)^2 heights, %u levels of textures\n", tiles.x,
           tiles.y, info->tile_log2, info->texture_levels);
    printf("pack            %.0f kB, likely %.0f to %.0f (heights %.0f, textures %.0f)\n",
           v->file_bytes / 1000, v->low_bytes / 1000, v->high_bytes / 1000, e->heights.value / 1000,
           e->textures.bytes / 1000);
    printf("time            about %.1f s on this machine, %u jobs\n", v->seconds, b->options->jobs);
    printf("memory          about %.0f MiB, and %.0f MiB of disk while baking\n",
           v->memory_bytes / (1 << 20), v->disk_bytes / (1 << 20));
    printf("estimated from  %u windows, %.1f %% of the samples, in %.1f s\n", e->count,
           100 * e->share, v->spent_s);
}

static void tell_json(const estimate *e, const verdict *v)
{
    const bake *b = e->b;
    const ff_terrain_info *info = &b->info;
    ff_sheet samples = ff_shape_sheet_samples(info), tiles = ff_shape_sheet_tiles(info);
    printf("{\"samples_x\": %u, \"samples_y\": %u, \"spacing_m\": %.9g, \"hscale_m\": %.9g, "
           "\"max_error_m\": %.9g, \"height_min_m\": %.9g, \"height_max_m\": %.9g, ",
           samples.x, samples.y, (double)info->spacing_wu / FF_WU_PER_METRE, b->steps.step_m,
           info->max_error * b->steps.step_m, b->steps.min_m, b->steps.max_m);
    printf("\"tiles_x\": %u, \"tiles_y\": %u, \"tile_log2\": %u, \"node_log2\": %u, \"epsg\": %d, "
           "\"texture_levels\": %u, ",
           tiles.x, tiles.y, info->tile_log2, info->node_log2, info->epsg, info->texture_levels);
    printf("\"height_bytes\": %.0f, \"texture_bytes\": %.0f, \"file_bytes\": %.0f, "
           "\"file_bytes_low\": %.0f, \"file_bytes_high\": %.0f, ",
           e->heights.value, e->textures.bytes, v->file_bytes, v->low_bytes, v->high_bytes);
    printf("\"seconds\": %.3f, \"memory_bytes\": %.0f, \"disk_bytes\": %.0f, \"windows\": %u, "
           "\"share\": %.4f, \"estimate_seconds\": %.3f}\n",
           v->seconds, v->memory_bytes, v->disk_bytes, e->count, e->share, v->spent_s);
}

static int find_out(estimate *e)
{
    bake *b = e->b;
    if (bake_read(b)) return -1;
    e->read_s = (double)(sys_time_us() - b->started_us) / 1e6;
    if (plan_ground(e) || describe(e) || make_windows(e)) return -1;
    if (e->whole)
        take_heights(e);
    else if (guess_heights(e))
        return -1;
    guess_time(e);
    if (!b->options->color_path) return 0;
    return bake_image_sample(b->options, &e->place, &b->info, &e->textures);
}

int bake_estimate(bake *b)
{
    estimate e = { .b = b };
    verdict v = { 0 };
    int rc = find_out(&e);
    if (!rc) v = conclude(&e);
    if (e.plan.warp.target) OSRDestroySpatialReference(e.plan.warp.target);
    if (rc) return rc;
    (b->options->json ? tell_json : tell)(&e, &v);
    return 0;
}
