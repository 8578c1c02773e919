/* Strips of which some triangles are left out. */
#include "ff_strips.h"

#include "../../protocol/ff_assert.h"

/* The bit of the square in which a triangle's middle lies. */
static ff_squares square_of(const uint16_t *corner, unsigned node_log2)
{
    unsigned side = (1u << node_log2) + 1, inverse_q16 = 65536 / side + 1, columns = 0, rows = 0,
             shift = node_log2 - ff_squares_log2(node_log2);
    for (int i = 0; i < 3; i++) {
        unsigned row = corner[i] * inverse_q16 >> 16; /* exact: there are so few */
        columns += corner[i] - row * side;
        rows += row;
    }
    FF_ASSERT(columns / 3 < side - 1 && rows / 3 < side - 1);
    return (ff_squares)1 << ((rows / 3 >> shift) * FF_SQUARES_ROW + (columns / 3 >> shift));
}

static int is_degenerate(const uint16_t *corner)
{
    return corner[0] == corner[1] || corner[1] == corner[2] || corner[0] == corner[2];
}

uint32_t ff_strips_without(const uint16_t *index, uint32_t length, unsigned node_log2,
                           ff_squares squares, uint16_t *out, uint32_t count)
{
    int goes_on = 0;
    for (uint32_t i = 0; i + 2 < length; i++) {
        const uint16_t *corner = index + i;
        if (is_degenerate(corner)) {
            if (goes_on) out[count++] = corner[2];
            continue;
        }
        if (square_of(corner, node_log2) & squares) {
            goes_on = 0;
            continue;
        }
        if (!goes_on) { /* at a place as even as it was */
            if (count > 0) {
                out[count] = out[count - 1];
                count++;
                if ((count + 1) % 2 != i % 2) out[count] = out[count - 1], count++;
                out[count++] = corner[0];
            } else if (i % 2) {
                out[count++] = corner[0];
            }
            out[count++] = corner[0];
            out[count++] = corner[1];
        }
        out[count++] = corner[2];
        goes_on = 1;
    }
    return count;
}
