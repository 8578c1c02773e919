#include "bake_turn.h"

#include "../bake_say.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BLOCK       256  /* samples along a side of what is exchanged at once */
#define SLANT_MAX_S 1e-6 /* samples, over the whole grid: what is left of a turn is none */

/* Writes the square of `from` at (column, row) into `to` at (row, column). */
static int exchange_block(const bake_grid *from, const bake_grid *to, uint32_t column, uint32_t row,
                          float *in, float *out)
{
    uint32_t columns = from->width - column < BLOCK ? from->width - column : BLOCK;
    uint32_t rows = from->height - row < BLOCK ? from->height - row : BLOCK;
    for (uint32_t j = 0; j < rows; j++)
        if (bake_grid_read(from, row + j, column, columns, in + (size_t)j * BLOCK)) return -1;
    for (uint32_t i = 0; i < columns; i++) {
        for (uint32_t j = 0; j < rows; j++) out[j] = in[(size_t)j * BLOCK + i];
        if (bake_grid_write(to, column + i, row, rows, out)) return -1;
    }
    return 0;
}

static int exchange(const bake_grid *from, bake_grid *to)
{
    float *memory = malloc((BLOCK + 1) * BLOCK * sizeof *memory);
    if (!memory) return bake_fail("out of memory");
    int rc = bake_grid_open(to, from->height, from->width, sizeof(float));
    for (uint32_t row = 0; !rc && row < from->height; row += BLOCK) {
        for (uint32_t column = 0; !rc && column < from->width; column += BLOCK)
            rc = exchange_block(from, to, column, row, memory, memory + BLOCK * BLOCK);
        bake_progress("turning", row + BLOCK < from->height ? row + BLOCK : from->height,
                      from->height);
    }
    free(memory);
    return rc;
}

static int mirror(const bake_grid *grid)
{
    float *row = malloc(grid->width * sizeof *row);
    if (!row) return bake_fail("out of memory");
    int rc = 0;
    for (uint32_t j = 0; !rc && j < grid->height; j++) {
        rc = bake_grid_read(grid, j, 0, grid->width, row);
        for (uint32_t i = 0; i < grid->width / 2; i++) {
            float swap = row[i];
            row[i] = row[grid->width - 1 - i];
            row[grid->width - 1 - i] = swap;
        }
        if (!rc) rc = bake_grid_write(grid, j, 0, grid->width, row);
    }
    free(row);
    return rc;
}

int bake_turn(bake_grid *grid, double *gt)
{
    double across = fabs(gt[2]), down = fabs(gt[4]);
    int is_exchanged = fabs(gt[1]) * grid->width < SLANT_MAX_S * across &&
                       fabs(gt[5]) * grid->height < SLANT_MAX_S * down;
    if (is_exchanged) {
        bake_grid turned = BAKE_GRID_CLOSED;
        double exchanged[6] = { gt[0], gt[2], gt[1], gt[3], gt[5], gt[4] };
        int rc = exchange(grid, &turned);
        bake_grid_close(rc ? &turned : grid);
        if (rc) return rc;
        *grid = turned;
        memcpy(gt, exchanged, sizeof exchanged);
    }
    int runs_west = gt[1] < 0 && fabs(gt[2]) * grid->height < SLANT_MAX_S * -gt[1] &&
                    fabs(gt[4]) * grid->width < SLANT_MAX_S * fabs(gt[5]);
    if (!runs_west) return 0;
    gt[0] += gt[1] * grid->width;
    gt[3] += gt[4] * grid->width;
    gt[1] = -gt[1];
    gt[4] = -gt[4];
    return mirror(grid);
}
