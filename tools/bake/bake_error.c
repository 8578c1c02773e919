#include "bake_error.h"

static uint32_t distance(int64_t a, int64_t b) { return (uint32_t)(a > b ? a - b : b - a); }

/* Largest distance in one cell, times `cell`: heights on a triangle are whole multiples of
 * 1/cell. */
static uint32_t cell_error(const uint16_t *source, const uint16_t *drawn, size_t pitch,
                           uint32_t cell)
{
    int64_t sw = drawn[0], se = drawn[cell], nw = drawn[cell * pitch],
            ne = drawn[cell * pitch + cell];
    uint32_t worst = 0;
    for (uint32_t v = 0; v <= cell; v++) {
        const uint16_t *row = source + v * pitch;
        for (uint32_t u = 0; u <= cell; u++) {
            int64_t rise = u >= v ? (se - sw) * u + (ne - se) * v : (nw - sw) * v + (ne - nw) * u;
            uint32_t error = distance(sw * cell + rise, (int64_t)row[u] * cell);
            if (error > worst) worst = error;
        }
    }
    return worst;
}

uint32_t bake_node_error(const uint16_t *source, const uint16_t *drawn, size_t pitch,
                         uint32_t cells, uint32_t cell)
{
    uint32_t worst = 0;
    for (uint32_t j = 0; j < cells; j++)
        for (uint32_t i = 0; i < cells; i++) {
            size_t at = (size_t)j * cell * pitch + (size_t)i * cell;
            uint32_t error = cell_error(source + at, drawn + at, pitch, cell);
            if (error > worst) worst = error;
        }
    return (worst + cell - 1) / cell;
}
