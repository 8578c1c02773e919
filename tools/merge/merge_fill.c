#include "merge_fill.h"

#include "../bake/bake_say.h"
#include "../bake/raster/bake_fill.h"

#include <math.h>
#include <stdlib.h>

#define CELLS_MAX 32 /* of the fill along the longer side */

/* Coarse, as it is nobody's ground, and on the lattice of the coarsest pack. */
static uint32_t choose_log2(const merge_lattice *lattice)
{
    uint32_t longer = lattice->width > lattice->height ? lattice->width : lattice->height,
             log2 = lattice->apart_log2;
    while ((longer - 1) >> log2 > CELLS_MAX && log2 < lattice->info.tile_log2) log2++;
    return log2;
}

static uint32_t place_of(uint32_t number, uint32_t last, uint32_t log2)
{
    uint64_t at = (uint64_t)number << log2;
    return at < last ? (uint32_t)at : last;
}

/* Reads what packs have at the places of a row of the fill; NaN: nothing. */
static int read_row(const merge_samples *m, uint32_t row, uint32_t width, float *cells)
{
    for (uint32_t i = 0; i < width; i++) {
        uint16_t height;
        uint8_t mark;
        if (m->samples.read(&m->samples, place_of(row, m->lattice->height - 1, m->fill_log2),
                            place_of(i, m->lattice->width - 1, m->fill_log2), 1, &height, &mark))
            return -1;
        cells[i] = mark & BAKE_BETWEEN ? NAN : height;
    }
    return 0;
}

/* A pack that has no sample at those places counts with its south-west one, at the nearest. */
static int put_corner(const merge_samples *m, const merge_layer *layer, const bake_grid *cells)
{
    uint16_t height;
    uint8_t mark;
    float cell, value;
    uint32_t half = m->fill_log2 ? 1u << (m->fill_log2 - 1) : 0,
             column = (layer->place.left + half) >> m->fill_log2,
             row = (layer->place.bottom + half) >> m->fill_log2;
    if (column >= cells->width) column = cells->width - 1;
    if (row >= cells->height) row = cells->height - 1;
    if (m->samples.read(&m->samples, layer->place.bottom, layer->place.left, 1, &height, &mark) ||
        bake_grid_read(cells, row, column, 1, &cell))
        return -1;
    value = height;
    return isnan(cell) ? bake_grid_write(cells, row, column, 1, &value) : 0;
}

static int round_rows(const bake_grid *cells, bake_grid *fill)
{
    float *row = malloc(cells->width * sizeof *row);
    uint16_t *heights = malloc(cells->width * sizeof *heights);
    int rc = row && heights ? bake_grid_open(fill, cells->width, cells->height, sizeof *heights)
                            : bake_fail("out of memory");
    for (uint32_t j = 0; !rc && j < cells->height; j++) {
        rc = bake_grid_read(cells, j, 0, cells->width, row);
        for (uint32_t i = 0; !rc && i < cells->width; i++)
            heights[i] = (uint16_t)fminf(fmaxf(nearbyintf(row[i]), 0), UINT16_MAX);
        if (!rc) rc = bake_grid_write(fill, j, 0, cells->width, heights);
    }
    free(row);
    free(heights);
    return rc;
}

static int read_cells(const merge_samples *m, const bake_grid *cells)
{
    float *row = malloc(cells->width * sizeof *row);
    int rc = row ? 0 : bake_fail("out of memory");
    for (uint32_t j = 0; !rc && j < cells->height; j++) {
        rc = read_row(m, j, cells->width, row);
        if (!rc) rc = bake_grid_write(cells, j, 0, cells->width, row);
    }
    for (uint32_t i = 0; !rc && i < m->count; i++) rc = put_corner(m, &m->layer[i], cells);
    free(row);
    return rc;
}

/* Columns or rows of the fill: the last place has one, too. */
static uint32_t count_cells(uint32_t places, uint32_t log2)
{
    uint32_t last = places - 1;
    return (last >> log2) + 1 + ((last & ((1u << log2) - 1)) != 0);
}

int merge_fill_make(merge_samples *m)
{
    bake_grid cells = BAKE_GRID_CLOSED;
    m->fill_log2 = choose_log2(m->lattice);
    int rc = bake_grid_open(&cells, count_cells(m->lattice->width, m->fill_log2),
                            count_cells(m->lattice->height, m->fill_log2), sizeof(float));
    if (!rc) rc = read_cells(m, &cells);
    if (!rc) rc = bake_fill_voids(&cells);
    if (!rc) rc = round_rows(&cells, &m->fill);
    bake_grid_close(&cells);
    return rc;
}
