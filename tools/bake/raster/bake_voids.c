#include "bake_voids.h"

#include "../bake_say.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MARKED 0.01f /* by projection: so much of the sample's height comes of filled ones */

/* A row of zeros in all of the grid. */
static int clear(const bake_grid *marks, float *row)
{
    memset(row, 0, marks->width * sizeof *row);
    for (uint32_t j = 0; j < marks->height; j++)
        if (bake_grid_write(marks, j, 0, marks->width, row)) return -1;
    return 0;
}

static int mark_row(const bake_grid *grid, const bake_grid *marks, uint32_t j, float *ground,
                    float *row)
{
    if (bake_grid_read(grid, j, 0, grid->width, ground)) return -1;
    if (bake_grid_read(marks, j, 0, marks->width, row)) return -1;
    for (uint32_t i = 0; i < grid->width; i++)
        if (isnan(ground[i])) row[i] = 1;
    return bake_grid_write(marks, j, 0, marks->width, row);
}

int bake_voids_mark(const bake_grid *grid, bake_grid *marks)
{
    float *memory = malloc(2 * (size_t)grid->width * sizeof *memory);
    if (!memory) return bake_fail("out of memory");
    int rc = 0;
    if (marks->fd < 0) {
        rc = bake_grid_open(marks, grid->width, grid->height, sizeof(float));
        if (!rc) rc = clear(marks, memory);
    }
    for (uint32_t j = 0; !rc && j < grid->height; j++)
        rc = mark_row(grid, marks, j, memory, memory + grid->width);
    free(memory);
    return rc;
}

/* 1 when one of the two marks is set between which the sample lies, `densify` of which come of one.
 */
static int is_marked(const float *row, uint32_t at, uint32_t densify)
{
    float low = row[at / densify], high = row[(at + densify - 1) / densify];
    return !(fabsf(low) <= MARKED && fabsf(high) <= MARKED); /* NaN lies outside the source */
}

int bake_voids_finish(const bake_grid *marks, int north_up, uint32_t densify, bake_grid *filled)
{
    uint32_t width = (marks->width - 1) * densify + 1, height = (marks->height - 1) * densify + 1;
    float *row = malloc(marks->width * sizeof *row);
    uint8_t *out = malloc(width);
    int rc = row && out ? bake_grid_open(filled, width, height, 1) : bake_fail("out of memory");
    for (uint32_t j = 0; !rc && j < height; j++) {
        uint32_t from[2] = { j / densify, (j + densify - 1) / densify };
        memset(out, 0, width);
        for (int k = 0; !rc && k < 2; k++) {
            rc = bake_grid_read(marks, from[k], 0, marks->width, row);
            for (uint32_t i = 0; !rc && i < width; i++) out[i] |= is_marked(row, i, densify) != 0;
        }
        if (!rc) rc = bake_grid_write(filled, north_up ? height - 1 - j : j, 0, width, out);
    }
    free(row);
    free(out);
    return rc;
}
