#include "bake_own.h"

#include "../../../client/terrain/ff_shade.h"
#include "../bake_say.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define RGB    3
#define NODE   1 /* log2 of the cells of the node that ff_shade looks at: the least */
#define FRAME  5 /* samples a side of that, and one more on every side */
#define LEVELS 16

/* A cell of level k is the mean of 2^k x 2^k samples, or as many as there are. */
struct bake_own {
    ff_terrain_info info;
    int32_t cell_wu;
    const bake_samples *heights;
    bake_grid level[LEVELS]; /* RGB, rows south to north */
    uint32_t levels;
    /* of the row that was turned to */
    uint32_t at_level;
    int64_t row[2];  /* held: of cells, the even one first; -1: none */
    uint8_t *rgb[2]; /* theirs */
    double part;     /* of the way from the lower row to the upper one */
    uint32_t lower;  /* which of the two */
};

static uint32_t inside(int64_t at, uint32_t count)
{
    return (uint32_t)(at < 0 ? 0 : at >= count ? (int64_t)count - 1 : at);
}

/* ---- making ---- */

/* Shades a row of samples between two others. */
static void shade_row(const bake_own *own, uint16_t *const height[3], uint8_t *rgb)
{
    uint16_t framed[FRAME * FRAME] = { 0 }, *here = framed + 2 * FRAME + 2;
    uint32_t width = own->heights->width;
    const ff_shade_grid grid = { .info = &own->info,
                                 .cell_wu = own->cell_wu,
                                 .framed = framed,
                                 .ramp = { own->info.height_min, own->info.height_max } };
    for (uint32_t x = 0; x < width; x++, rgb += RGB) {
        uint8_t rgba[4];
        here[0] = height[1][x];
        here[1] = height[1][inside((int64_t)x + 1, width)];
        here[-1] = height[1][inside((int64_t)x - 1, width)];
        here[FRAME] = height[2][x];
        here[-FRAME] = height[0][x];
        ff_shade(&grid, 1, 1, rgba);
        memcpy(rgb, rgba, RGB);
    }
}

/* All samples; beyond the ground its rim's heights go on. */
static int shade(const bake_own *own)
{
    const bake_samples *heights = own->heights;
    size_t width = heights->width;
    uint16_t *memory = malloc(width * (3 * sizeof *memory + RGB));
    uint16_t *const height[3] = { memory, memory + width, memory + 2 * width };
    uint8_t *rgb = (uint8_t *)(memory + 3 * width);
    int rc = memory ? 0 : bake_fail("out of memory");
    for (uint32_t row = 0; !rc && row < heights->height; row++) {
        for (int i = 0; !rc && i < 3; i++)
            rc = heights->read(heights, inside((int64_t)row + i - 1, heights->height), 0,
                               heights->width, height[i], NULL);
        if (!rc) shade_row(own, height, rgb);
        if (!rc) rc = bake_grid_write(&own->level[0], row, 0, heights->width, rgb);
    }
    free(memory);
    return rc;
}

static int halve(const bake_grid *fine, const bake_grid *coarse)
{
    uint8_t *two = malloc((size_t)RGB * (2 * (size_t)fine->width + coarse->width));
    uint8_t *const rows[2] = { two, two + (size_t)RGB * fine->width };
    uint8_t *out = rows[1] + (size_t)RGB * fine->width;
    int rc = two ? 0 : bake_fail("out of memory");
    for (uint32_t j = 0; !rc && j < coarse->height; j++) {
        for (uint32_t r = 0; !rc && r < 2; r++)
            rc = bake_grid_read(fine, inside(2 * (int64_t)j + r, fine->height), 0, fine->width,
                                rows[r]);
        for (uint32_t i = 0; !rc && i < coarse->width * RGB; i++) {
            uint32_t a = 2 * (i / RGB), b = inside((int64_t)a + 1, fine->width), c = i % RGB;
            out[i] = (uint8_t)((rows[0][a * RGB + c] + rows[0][b * RGB + c] + rows[1][a * RGB + c] +
                                rows[1][b * RGB + c] + 2) /
                               4);
        }
        if (!rc) rc = bake_grid_write(coarse, j, 0, coarse->width, out);
    }
    free(two);
    return rc;
}

static int make_levels(bake_own *own)
{
    uint32_t width = own->heights->width, height = own->heights->height;
    for (;; width = (width + 1) / 2, height = (height + 1) / 2) {
        bake_grid *level = &own->level[own->levels];
        if (bake_grid_open(level, width, height, RGB)) return -1;
        own->levels++;
        if (own->levels == 1 ? shade(own) : halve(level - 1, level)) return -1;
        if ((width <= 2 && height <= 2) || own->levels == LEVELS) return 0;
    }
}

bake_own *bake_own_open(const ff_terrain_info *info, const bake_samples *heights)
{
    bake_own *own = calloc(1, sizeof *own);
    uint8_t *memory = malloc((size_t)2 * RGB * heights->width);
    if (!own || !memory) {
        bake_fail("out of memory");
        free(memory);
        free(own);
        return NULL;
    }
    own->info = *info;
    own->cell_wu = ff_node_cell_wu(info, ff_terrain_levels(info) - 1u);
    own->info.node_log2 = NODE;
    own->heights = heights;
    own->row[0] = own->row[1] = -1;
    for (size_t i = 0; i < 2; i++) own->rgb[i] = memory + i * RGB * heights->width;
    if (!make_levels(own)) return own;
    bake_own_close(own);
    return NULL;
}

void bake_own_close(bake_own *own)
{
    if (!own) return;
    for (uint32_t l = 0; l < own->levels; l++) bake_grid_close(&own->level[l]);
    free(own->rgb[0]);
    free(own);
}

/* ---- asking ---- */

/* The cell below or left of a place on a level, and how far from it to the next. */
static uint32_t cell_of(double at, uint32_t level, uint32_t count, double *part)
{
    double cell = (at + 0.5) / (double)(1u << level) - 0.5;
    double first = fmin(fmax(floor(cell), 0), count > 1 ? count - 2.0 : 0);
    *part = fmin(fmax(cell - first, 0), 1);
    return (uint32_t)first;
}

static void turn_to_level(bake_own *own, double texel_samples)
{
    uint32_t level = 0;
    while (level + 1 < own->levels && texel_samples >= (double)(2u << level)) level++;
    if (level != own->at_level) own->row[0] = own->row[1] = -1;
    own->at_level = level;
}

int bake_own_row(bake_own *own, double y, double texel_samples)
{
    turn_to_level(own, texel_samples);
    const bake_grid *grid = &own->level[own->at_level];
    uint32_t lower = cell_of(y, own->at_level, grid->height, &own->part);
    for (uint32_t i = 0; i < 2; i++) {
        uint32_t row = inside((int64_t)lower + i, grid->height), held = (lower + i) & 1;
        if (own->row[held] == row) continue;
        if (bake_grid_read(grid, row, 0, grid->width, own->rgb[held])) return -1;
        own->row[held] = row;
    }
    own->lower = lower & 1;
    return 0;
}

void bake_own_at(const bake_own *own, double x, uint8_t rgb[3])
{
    double part;
    uint32_t width = own->level[own->at_level].width,
             west = cell_of(x, own->at_level, width, &part),
             east = inside((int64_t)west + 1, width);
    const uint8_t *lower = own->rgb[own->lower], *upper = own->rgb[!own->lower];
    for (uint32_t c = 0; c < RGB; c++) {
        double south = lower[west * RGB + c] +
                       part * (lower[east * RGB + c] - lower[west * RGB + c]),
               north = upper[west * RGB + c] +
                       part * (upper[east * RGB + c] - upper[west * RGB + c]);
        rgb[c] = (uint8_t)(south + own->part * (north - south) + 0.5);
    }
}
