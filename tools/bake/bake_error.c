#include "bake_error.h"

static uint64_t distance(int64_t a, int64_t b) { return (uint64_t)(a > b ? a - b : b - a); }

static uint32_t least(uint32_t a, uint32_t b) { return a < b ? a : b; }

/* Largest distance in one cell, `wide` by `deep` samples of which are ground, rounded up. Heights
 * on a triangle are whole multiples of 1/scale. */
static uint32_t cell_error(const uint16_t *source, const uint16_t *drawn, size_t pitch,
                           uint32_t cell, uint32_t wide, uint32_t deep)
{
    int64_t sw = drawn[0], se = drawn[cell], nw = drawn[cell * pitch],
            ne = drawn[cell * pitch + cell];
    int64_t a = wide == deep ? 1 : deep, b = wide == deep ? 1 : wide, scale = wide * a;
    uint64_t worst = 0;
    for (uint32_t v = 0; v <= deep; v++) {
        const uint16_t *row = source + v * pitch;
        for (uint32_t u = 0; u <= wide; u++) {
            int64_t x = u * a, y = v * b;
            int64_t rise = x >= y ? (se - sw) * x + (ne - se) * y : (nw - sw) * y + (ne - nw) * x;
            uint64_t error = distance(sw * scale + rise, row[u] * scale);
            if (error > worst) worst = error;
        }
    }
    return (uint32_t)((worst + (uint64_t)scale - 1) / (uint64_t)scale);
}

uint32_t bake_node_error(const uint16_t *source, const uint16_t *drawn, size_t pitch,
                         ff_extent extent, uint32_t cell)
{
    uint32_t worst = 0;
    for (uint32_t row = 0; row < extent.rows; row += cell)
        for (uint32_t column = 0; column < extent.columns; column += cell) {
            size_t at = row * pitch + column;
            uint32_t error = cell_error(source + at, drawn + at, pitch, cell,
                                        least(cell, extent.columns - column),
                                        least(cell, extent.rows - row));
            if (error > worst) worst = error;
        }
    return worst;
}
