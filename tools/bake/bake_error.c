#include "bake_error.h"

#include "bake_samples.h"

static uint64_t distance(int64_t a, int64_t b) { return (uint64_t)(a > b ? a - b : b - a); }

static uint32_t least(uint32_t a, uint32_t b) { return a < b ? a : b; }
static uint32_t most(uint32_t a, uint32_t b) { return a > b ? a : b; }

/* Of a cell of which `wide` by `deep` samples are ground, those that are looked at: columns west to
 * east, rows south to north, both ends within. */
typedef struct looked_at {
    uint32_t wide, deep, west, east, south, north;
} looked_at;

/* Largest distance of the samples looked at, of which `sample` is the south-western one, rounded
 * up. Heights on a triangle are whole multiples of 1/scale. */
static uint32_t cell_error(const uint16_t *sample, const uint8_t *marks, size_t pitch,
                           const bake_drawn *drawn, const uint16_t *vertex, const looked_at *at)
{
    int64_t sw = vertex[0], se = vertex[drawn->east], nw = vertex[drawn->north],
            ne = vertex[drawn->north + drawn->east];
    int64_t a = at->wide == at->deep ? 1 : at->deep, b = at->wide == at->deep ? 1 : at->wide,
            scale = at->wide * a;
    uint64_t worst = 0;
    for (uint32_t v = at->south; v <= at->north; v++, sample += pitch) {
        const uint16_t *row = sample;
        const uint8_t *mark = marks;
        if (marks) marks += pitch;
        for (uint32_t u = at->west; u <= at->east; u++) {
            int64_t x = u * a, y = v * b;
            if (mark && *mark++ & BAKE_BETWEEN) {
                row++;
                continue;
            }
            int64_t rise = x >= y ? (se - sw) * x + (ne - se) * y : (nw - sw) * y + (ne - nw) * x;
            uint64_t error = distance(sw * scale + rise, *row++ * scale);
            if (error > worst) worst = error;
        }
    }
    return (uint32_t)((worst + (uint64_t)scale - 1) / (uint64_t)scale);
}

/* The last sample of a cell that is looked at: the one that the next cell begins with is left to
 * that, whose triangles are no other there. */
static uint32_t last_of(uint32_t first, uint32_t cell, uint32_t end)
{
    return first + cell < end ? cell - 1 : end - first;
}

uint32_t bake_patch_error(const bake_patch *patch, const bake_drawn *drawn)
{
    uint32_t worst = 0, cell = drawn->cell, west = patch->first.columns, south = patch->first.rows,
             east = west + patch->size.columns, north = south + patch->size.rows;
    for (uint32_t row = south / cell * cell; row < north; row += cell)
        for (uint32_t column = west / cell * cell; column < east; column += cell) {
            looked_at at = { .wide = least(cell, drawn->extent.columns - column),
                             .deep = least(cell, drawn->extent.rows - row),
                             .west = most(column, west) - column,
                             .east = last_of(column, cell, east),
                             .south = most(row, south) - row,
                             .north = last_of(row, cell, north) };
            size_t first = (row + at.south - south) * patch->pitch + (column + at.west - west);
            const uint16_t *vertex = drawn->vertex + row / cell * drawn->north +
                                     column / cell * drawn->east;
            uint32_t error = cell_error(patch->sample + first,
                                        patch->marks ? patch->marks + first : NULL, patch->pitch,
                                        drawn, vertex, &at);
            if (error > worst) worst = error;
        }
    return worst;
}

uint32_t bake_node_error(const uint16_t *source, const uint8_t *marks, const uint16_t *drawn,
                         size_t pitch, ff_extent extent, uint32_t cell)
{
    bake_patch patch = { source, marks, pitch, { 0, 0 }, extent };
    bake_drawn node = { drawn, cell, cell * pitch, cell, extent };
    return bake_patch_error(&patch, &node);
}
