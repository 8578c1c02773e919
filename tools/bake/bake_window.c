#include "bake_window.h"

#include "../../platform/sys.h"
#include "../../protocol/shape/ff_shape.h"
#include "raster/bake_densify.h"
#include "raster/bake_fill.h"
#include "bake_say.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double now_s(void) { return (double)sys_time_us() / 1e6; }

/* Copies a part of a grid. */
static int copy_part(const bake_grid *from, const bake_window *window, bake_grid *to)
{
    if (bake_grid_open(to, window->width, window->height, sizeof(float))) return -1;
    float *row = malloc(window->width * sizeof *row);
    int rc = row ? 0 : bake_fail("out of memory");
    for (uint32_t j = 0; !rc && j < window->height; j++) {
        rc = bake_grid_read(from, window->row + j, window->column, window->width, row);
        if (!rc) rc = bake_grid_write(to, j, 0, window->width, row);
    }
    free(row);
    return rc;
}

/* Ground beyond the source is filled from its border: far away it is nearly flat. */
static int make_flat(const bake *b, const bake_grid *grid)
{
    float height_m = (float)b->steps.min_m;
    int rc = 0;
    for (uint32_t j = 0; !rc && j < grid->height; j++)
        for (uint32_t i = 0; !rc && i < grid->width; i++)
            rc = bake_grid_write(grid, j, i, 1, &height_m);
    return rc;
}

/* Makes the window's samples in metres, without voids. */
static int make_samples(const bake *b, const bake_plan *plan, const bake_window *window,
                        bake_ground *ground)
{
    const double *to = plan->warp.to;
    double gt[6] = {
        to[0] + to[1] * window->column, to[1], 0, to[3] + to[5] * window->row, 0, to[5]
    };
    bake_warp warp = plan->warp;
    bake_warp_count count = { 0 };
    memcpy(ground->geotransform, gt, sizeof gt);
    memcpy(warp.to, gt, sizeof gt);
    warp.width = window->width;
    warp.height = window->height;
    ground->grid = BAKE_GRID_CLOSED;
    int rc = plan->is_resampled ? bake_warp_part(&warp, &b->ground.grid, &ground->grid, &count)
                                : copy_part(&b->ground.grid, window, &ground->grid);
    uint64_t all = (uint64_t)window->width * window->height;
    if (!rc && count.outside == all)
        rc = make_flat(b, &ground->grid);
    else if (!rc && count.outside)
        rc = bake_fill_voids(&ground->grid);
    return rc ? rc : bake_densify(&ground->grid, ground->geotransform, b->options->densify);
}

/* Of a window, while its records come. */
typedef struct counting {
    bake_window_count *count;
    uint32_t length_max[BAKE_LEVELS_MAX];
} counting;

static int count_records(void *context, uint32_t section, const bake_blob *records,
                         const bake_blob *above)
{
    counting *c = context;
    (void)above;
    for (size_t i = 0; i < records->record_count; i++) {
        c->count->records[section] += records->length[i] > 0;
        if (records->length[i] > c->length_max[section])
            c->length_max[section] = records->length[i];
    }
    c->count->bytes[section] += records->byte_count;
    return 0;
}

/* What ff_pack_section_at's sections have: roots no places, refinements one for each child of a
 * record above, the first ones for each root. */
static void count_indexes(counting *c)
{
    const uint64_t *records = c->count->records;
    for (uint32_t l = 0; l < c->count->levels; l++) {
        ff_index index = { .records = (uint32_t)records[l] };
        if (l) index.places = records[l - 1] * (l > 1 ? 4 : 1);
        while (c->length_max[l] >> index.length_bits) index.length_bits++;
        c->count->index_bytes += ff_index_bytes(&index);
    }
}

/* Bakes heights in tiles, and counts their records. */
static int encode(const ff_terrain_info *info, const bake_grid *heights, bake_window_count *count)
{
    bake_grid none = BAKE_GRID_CLOSED;
    bake_image no_image = { .levels = 0 };
    counting c = { .count = count };
    bake_grid_samples samples = bake_samples_of(heights, &none);
    bake_tiles tiles = { .info = info,
                         .samples = &samples.samples,
                         .image = &no_image,
                         .block_log2 = BAKE_BLOCK_LOG2,
                         .jobs = 1,
                         .context = &c,
                         .take = count_records };
    count->levels = ff_terrain_levels(info);
    int rc = bake_tiles_make(&tiles);
    count_indexes(&c);
    return rc;
}

int bake_window_make(const bake *b, const bake_plan *plan, const bake_window *window,
                     uint32_t tile_log2, bake_window_count *count)
{
    bake_ground ground = b->ground;
    ff_terrain_info info = b->info;
    bake_grid heights = BAKE_GRID_CLOSED;
    *count = (bake_window_count){ 0 };
    double started_s = now_s();
    int rc = make_samples(b, plan, window, &ground);
    if (!rc) rc = bake_quantise(b->options, &ground, &b->steps, &info, &heights);
    double made_s = now_s();
    info.tile_log2 = (uint8_t)tile_log2;
    if (!rc) ff_shape_cover(&info, heights.width, heights.height);
    if (!rc) rc = encode(&info, &heights, count);
    count->ground_s = made_s - started_s;
    count->encode_s = now_s() - made_s;
    bake_grid_close(&ground.grid);
    bake_grid_close(&heights);
    return rc;
}

int bake_roughness(const bake_grid *grid, const bake_part *part, uint32_t stride, double quantum_m,
                   double *roughness)
{
    uint32_t width = part->east - part->west + 1;
    float *z = malloc(width * sizeof *z);
    double sum = 0, count = 0;
    int rc = z ? 0 : bake_fail("out of memory");
    for (uint32_t j = part->north; !rc && j <= part->south; j += stride) {
        rc = bake_grid_read(grid, j, part->west, width, z);
        for (uint32_t i = 1; !rc && i + 1 < width; i++) {
            double e = fabs(z[i] - (z[i - 1] + z[i + 1]) / 2.0);
            sum += log2(1 + e / quantum_m);
            count++;
        }
    }
    free(z);
    *roughness = count > 0 ? sum / count : 0;
    return rc;
}
