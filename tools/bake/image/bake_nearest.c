#include "bake_nearest.h"

#include "../bake_say.h"

#include <stdlib.h>
#include <string.h>

#define RGB 3

typedef struct nearest_row {
    uint8_t *rgb;
    uint32_t *distance;
} nearest_row;

/* Texel k of `to` takes over the colour of texel i of `from`, when that colour comes from nearer
 * than its own. */
static void take_nearer(const nearest_row *from, uint32_t i, const nearest_row *to, uint32_t k)
{
    if (from->distance[i] == BAKE_NEAREST_FAR || from->distance[i] + 1 >= to->distance[k]) return;
    to->distance[k] = from->distance[i] + 1;
    memcpy(to->rgb + (size_t)k * RGB, from->rgb + (size_t)i * RGB, RGB);
}

static void sweep_row(const nearest_row *before, const nearest_row *row, uint32_t width)
{
    for (uint32_t i = 0; i < width; i++) {
        if (before) take_nearer(before, i, row, i);
        if (i) take_nearer(row, i - 1, row, i);
    }
    for (uint32_t i = width - 1; i-- > 0;) take_nearer(row, i + 1, row, i);
}

/* One pass over all rows, from row 0 up or from the last row down. */
static int sweep(const bake_grid *colour, const bake_grid *distance, int down, nearest_row rows[2])
{
    for (uint32_t n = 0; n < colour->height; n++) {
        uint32_t j = down ? colour->height - 1 - n : n;
        const nearest_row *row = &rows[n & 1];
        if (bake_grid_read(colour, j, 0, colour->width, row->rgb)) return -1;
        if (bake_grid_read(distance, j, 0, colour->width, row->distance)) return -1;
        sweep_row(n ? &rows[~n & 1] : NULL, row, colour->width);
        if (bake_grid_write(colour, j, 0, colour->width, row->rgb)) return -1;
        if (bake_grid_write(distance, j, 0, colour->width, row->distance)) return -1;
    }
    return 0;
}

int bake_nearest_fill(const bake_grid *colour, const bake_grid *distance)
{
    nearest_row rows[2];
    size_t width = colour->width;
    uint32_t *memory = malloc(2 * width * (sizeof *memory + RGB));
    if (!memory) return bake_fail("out of memory");
    for (size_t r = 0; r < 2; r++) {
        rows[r].distance = memory + r * width;
        rows[r].rgb = (uint8_t *)(memory + 2 * width) + r * width * RGB;
    }
    int rc = sweep(colour, distance, 0, rows);
    if (!rc) rc = sweep(colour, distance, 1, rows);
    free(memory);
    return rc;
}
