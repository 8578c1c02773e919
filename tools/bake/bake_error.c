#include "bake_error.h"

#include "bake_samples.h"

static uint32_t least(uint32_t a, uint32_t b) { return a < b ? a : b; }
static uint32_t most(uint32_t a, uint32_t b) { return a > b ? a : b; }

/* Of a cell of which `wide` by `deep` samples are ground, those that are looked at: columns west to
 * east, rows south to north, both ends within. */
typedef struct looked_at {
    uint32_t wide, deep, west, east, south, north;
} looked_at;

/* Samples beside each other, up to `end`, and the triangle over them, which rises evenly there, in
 * units of 1/scale: the larger one of `worst` and their distances. */
static inline uint64_t run_error(const uint16_t *sample, const uint16_t *end, const uint8_t *mark,
                                 int64_t height, int64_t rise, int64_t scale, uint64_t worst)
{
    for (const uint16_t *at = sample; at < end; at++, height += rise) {
        int64_t above = height - *at * scale;
        uint64_t error = (uint64_t)(above < 0 ? -above : above);
        if (error > worst && !(mark && mark[at - sample] & BAKE_BETWEEN)) worst = error;
    }
    return worst;
}

/* Largest distance of the samples looked at, of which `sample` is the south-western one, rounded
 * up. Heights on a triangle are whole multiples of 1/scale. A row runs through the north-western
 * triangle first; `north` and `south` are where the triangles' planes meet its western end. */
static uint32_t cell_error(const uint16_t *sample, const uint8_t *marks, size_t pitch,
                           const bake_drawn *drawn, const uint16_t *vertex, const looked_at *at)
{
    int32_t sw = vertex[0], se = vertex[drawn->east], nw = vertex[drawn->north],
            ne = vertex[drawn->north + drawn->east];
    uint32_t square = at->wide == at->deep, a = square ? 1 : at->deep, b = square ? 1 : at->wide,
             count = at->east + 1 - at->west;
    int64_t scale = (int64_t)at->wide * a, north_rise = (int64_t)(ne - nw) * a,
            south_rise = (int64_t)(se - sw) * a, north_step = (int64_t)(nw - sw) * b,
            south_step = (int64_t)(ne - se) * b,
            north = sw * scale + north_step * at->south + north_rise * at->west,
            south = sw * scale + south_step * at->south + south_rise * at->west;
    uint64_t worst = 0;
    for (uint32_t v = at->south; v <= at->north; v++, sample += pitch) {
        uint32_t diagonal = square ? v : (v * b + a - 1) / a,
                 first = diagonal > at->west ? least(diagonal - at->west, count) : 0;
        const uint16_t *middle = sample + first;
        worst = run_error(sample, middle, marks, north, north_rise, scale, worst);
        worst = run_error(middle, sample + count, marks ? marks + first : NULL,
                          south + south_rise * first, south_rise, scale, worst);
        north += north_step;
        south += south_step;
        if (marks) marks += pitch;
    }
    return (uint32_t)((worst + (uint64_t)scale - 1) / (uint64_t)scale);
}

/* Where every sample is a vertex. */
static uint32_t vertices_error(const bake_patch *patch, const bake_drawn *drawn)
{
    uint32_t worst = 0;
    for (uint32_t row = 0; row <= patch->size.rows; row++) {
        const uint16_t *sample = patch->sample + row * patch->pitch;
        const uint8_t *mark = patch->marks ? patch->marks + row * patch->pitch : NULL;
        const uint16_t *vertex = drawn->vertex + (patch->first.rows + row) * drawn->north +
                                 patch->first.columns * drawn->east;
        for (uint32_t i = 0; i <= patch->size.columns; i++, vertex += drawn->east) {
            uint32_t error = (uint32_t)(*vertex > sample[i] ? *vertex - sample[i]
                                                            : sample[i] - *vertex);
            if (error > worst && !(mark && mark[i] & BAKE_BETWEEN)) worst = error;
        }
    }
    return worst;
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
    if (!patch->size.columns || !patch->size.rows) return 0;
    if (cell == 1) return vertices_error(patch, drawn);
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
