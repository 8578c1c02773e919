#include "bake_own.h"

#include "../../../client/terrain/ff_shade.h"
#include "../bake_say.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define RGB   3
#define NODE  1 /* log2 of the cells of the node that ff_shade looks at: the least */
#define FRAME 5 /* samples a side of that, and one more on every side */

/* Two rows of colours, that of an even row first; and three rows of heights. */
struct bake_own {
    ff_terrain_info info;
    int32_t cell_wu;
    const bake_samples *heights;
    int64_t row[2]; /* of samples; -1: none */
    uint8_t *rgb[2];
    uint16_t *height[3];
    double part; /* of the way from the lower row to the upper one */
    int lower;   /* which of the two */
};

bake_own *bake_own_open(const ff_terrain_info *info, const bake_samples *heights)
{
    size_t width = heights->width;
    bake_own *own = calloc(1, sizeof *own);
    uint8_t *memory = malloc(width * (2 * RGB + 3 * sizeof(uint16_t)));
    if (!own || !memory) {
        free(own);
        free(memory);
        bake_fail("out of memory");
        return NULL;
    }
    own->info = *info;
    own->cell_wu = ff_node_cell_wu(info, ff_terrain_levels(info) - 1u);
    own->info.node_log2 = NODE;
    own->heights = heights;
    own->row[0] = own->row[1] = -1;
    for (size_t i = 0; i < 3; i++) own->height[i] = (uint16_t *)memory + i * width;
    for (size_t i = 0; i < 2; i++)
        own->rgb[i] = (uint8_t *)(own->height[2] + width) + i * RGB * width;
    return own;
}

void bake_own_close(bake_own *own)
{
    if (!own) return;
    free(own->height[0]);
    free(own);
}

static uint32_t inside(int64_t at, uint32_t count)
{
    return (uint32_t)(at < 0 ? 0 : at >= count ? (int64_t)count - 1 : at);
}

/* Shades a row; beyond its ends, and beyond the first and the last row, the heights there go on. */
static int shade(bake_own *own, uint32_t row, uint8_t *rgb)
{
    const bake_samples *heights = own->heights;
    uint16_t framed[FRAME * FRAME] = { 0 }, *here = framed + 2 * FRAME + 2;
    const ff_shade_grid grid = { .info = &own->info,
                                 .cell_wu = own->cell_wu,
                                 .framed = framed,
                                 .ramp = { own->info.height_min, own->info.height_max } };
    for (int i = 0; i < 3; i++)
        if (heights->read(heights, inside((int64_t)row + i - 1, heights->height), 0, heights->width,
                          own->height[i], NULL))
            return -1;
    for (uint32_t x = 0; x < heights->width; x++, rgb += RGB) {
        uint8_t rgba[4];
        here[0] = own->height[1][x];
        here[1] = own->height[1][inside((int64_t)x + 1, heights->width)];
        here[-1] = own->height[1][inside((int64_t)x - 1, heights->width)];
        here[FRAME] = own->height[2][x];
        here[-FRAME] = own->height[0][x];
        ff_shade(&grid, 1, 1, rgba);
        memcpy(rgb, rgba, RGB);
    }
    return 0;
}

int bake_own_row(bake_own *own, double y)
{
    uint32_t last = own->heights->height - 1;
    uint32_t lower = (uint32_t)fmin(fmax(floor(y), 0), last > 0 ? last - 1.0 : 0);
    for (uint32_t row = lower; row <= lower + 1 && row <= last; row++) {
        if (own->row[row & 1] == row) continue;
        if (shade(own, row, own->rgb[row & 1])) return -1;
        own->row[row & 1] = row;
    }
    own->part = fmin(fmax(y - lower, 0), 1);
    own->lower = lower & 1;
    return 0;
}

void bake_own_at(const bake_own *own, double x, uint8_t rgb[3])
{
    uint32_t last = own->heights->width - 1;
    uint32_t west = (uint32_t)fmin(fmax(floor(x), 0), last > 0 ? last - 1.0 : 0);
    double east = fmin(fmax(x - west, 0), 1);
    const uint8_t *lower = own->rgb[own->lower] + (size_t)RGB * west,
                  *upper = own->rgb[!own->lower] + (size_t)RGB * west;
    for (int c = 0; c < RGB; c++) {
        double south = lower[c] + east * (lower[c + RGB] - lower[c]),
               north = upper[c] + east * (upper[c + RGB] - upper[c]);
        rgb[c] = (uint8_t)(south + own->part * (north - south) + 0.5);
    }
}
