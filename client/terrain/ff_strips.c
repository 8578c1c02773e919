/* Strip masks. A side is a band between two chains of vertices, the rim and the first row inside;
 * both are walked from one end to the other, each step closing one triangle, and the walk is
 * written down as a triangle strip. */
#include "ff_strips.h"

#include "../../protocol/codec/ff_codec.h"
#include "ff_tree_local.h"

#define STRIPS (sizeof((ff_strips *)0)->first / sizeof((ff_strips *)0)->first[0])
FF_STATIC_ASSERT(FF_STRIP_SIDE(0, FF_NODE_LOG2_MAX + 1) <= STRIPS);
FF_STATIC_ASSERT(FF_NODE_HEIGHTS_MAX <= UINT16_MAX); /* indices */

/* Grid index of (column, row) given in the frame of the south side, turned so that south becomes
 * `side`. */
static uint16_t turned(unsigned n, enum ff_side side, unsigned column, unsigned row)
{
    FF_ASSERT(column <= n && row <= n);
    switch (side) {
        case FF_SIDE_EAST: return (uint16_t)(column * (n + 1) + (n - row));
        case FF_SIDE_NORTH: return (uint16_t)((n - row) * (n + 1) + (n - column));
        case FF_SIDE_WEST: return (uint16_t)((n - column) * (n + 1) + row);
        default: return (uint16_t)(row * (n + 1) + column);
    }
}

unsigned ff_side_triangles(unsigned node_log2, enum ff_side side, unsigned difference,
                           uint16_t triangle[][3])
{
    unsigned n = 1u << node_log2, step = 1u << difference, outer = 0, inner = 1, count = 0;
    FF_ASSERT(step <= n);
    while (outer < n || inner < n - 1) {
        /* Advance the chain whose next edge has its middle further west; equal middles: the inner
         * one, diagonal to north-east. */
        int advance_inner = outer == n || (inner < n - 1 && 2 * inner + 1 <= 2 * outer + step);
        uint16_t rim = turned(n, side, outer, 0), inside = turned(n, side, inner, 1);
        triangle[count][0] = advance_inner ? inside : rim;
        if (advance_inner) {
            triangle[count][1] = rim;
            triangle[count][2] = turned(n, side, ++inner, 1);
        } else {
            triangle[count][1] = turned(n, side, outer += step, 0);
            triangle[count][2] = inside;
        }
        count++;
    }
    FF_ASSERT(count == n / step + n - 2);
    return count;
}

static void append(ff_strips *strips, unsigned id, uint16_t vertex)
{
    unsigned at = strips->first[id] + strips->length[id];
    FF_ASSERT(at < sizeof strips->index / sizeof strips->index[0]);
    strips->index[at] = vertex;
    strips->length[id]++;
}

/* Cells first..end-1 in both directions, row by row. A row is north-west, south-west, next
 * north-west ...: an even number of indices, so that every row starts with the same winding. */
static void make_rows(ff_strips *strips, unsigned id, unsigned n, unsigned first, unsigned end)
{
    FF_ASSERT(first <= end && end <= n);
    for (unsigned row = first; row < end; row++) {
        uint16_t start = (uint16_t)((row + 1) * (n + 1) + first);
        if (row > first) {
            append(strips, id, strips->index[strips->first[id] + strips->length[id] - 1]);
            append(strips, id, start);
        }
        for (unsigned column = first; column <= end; column++) {
            append(strips, id, (uint16_t)((row + 1) * (n + 1) + column));
            append(strips, id, (uint16_t)(row * (n + 1) + column));
        }
        strips->triangles[id] = (uint16_t)(strips->triangles[id] + 2 * (end - first));
        FF_ASSERT(strips->length[id] % 2 == 0);
    }
}

static void make_side(ff_strips *strips, unsigned id, unsigned node_log2, enum ff_side side,
                      unsigned difference)
{
    uint16_t triangle[2 << FF_NODE_LOG2_MAX][3];
    unsigned count = ff_side_triangles(node_log2, side, difference, triangle);
    FF_ASSERT(count <= sizeof triangle / sizeof triangle[0]);
    strips->triangles[id] = (uint16_t)count;

    /* A triangle replaces the older of the last two vertices. Where it should replace the younger,
     * the older is repeated: a degenerate triangle that swaps them. Winding comes right by itself:
     * an edge (rim, inside) is always at an odd place, (inside, rim) at an even one. */
    uint16_t older = turned(1u << node_log2, side, 0, 0),
             younger = turned(1u << node_log2, side, 1, 1);
    append(strips, id, older);
    append(strips, id, older);
    append(strips, id, younger);
    for (unsigned i = 0; i < count; i++) {
        FF_ASSERT(older == triangle[i][0] || younger == triangle[i][0]);
        uint16_t kept = older == triangle[i][0] ? younger : older;
        if (kept == older) append(strips, id, older);
        older = kept;
        younger = triangle[i][1] == kept ? triangle[i][2] : triangle[i][1];
        append(strips, id, younger);
    }
}

static void begin_strip(ff_strips *strips, unsigned id)
{
    FF_ASSERT(id < STRIPS);
    strips->first[id] = id == 0 ? 0 : (uint16_t)(strips->first[id - 1] + strips->length[id - 1]);
    strips->length[id] = 0;
    strips->triangles[id] = 0;
}

int ff_strips_make(ff_strips *strips, unsigned node_log2)
{
    if (node_log2 < 1 || node_log2 > FF_NODE_LOG2_MAX) return FF_ERR_RANGE;
    unsigned n = 1u << node_log2;
    strips->count = (uint16_t)FF_STRIP_SIDE(0, node_log2 + 1);
    begin_strip(strips, FF_STRIP_FULL);
    make_rows(strips, FF_STRIP_FULL, n, 0, n);
    begin_strip(strips, FF_STRIP_INNER);
    make_rows(strips, FF_STRIP_INNER, n, 1, n - 1);
    for (unsigned difference = 0; difference <= node_log2; difference++) {
        for (unsigned side = 0; side < FF_SIDE_COUNT; side++) {
            unsigned id = FF_STRIP_SIDE(side, difference);
            begin_strip(strips, id);
            make_side(strips, id, node_log2, (enum ff_side)side, difference);
        }
    }
    FF_ASSERT(strips->first[strips->count - 1] + (uint32_t)strips->length[strips->count - 1] ==
              ff_strips_indices(node_log2));
    return FF_OK;
}

uint32_t ff_strips_indices(unsigned node_log2)
{
    static const uint16_t indices[FF_NODE_LOG2_MAX + 1] = { 0, 54, 160, 508, 1656, 5620 };
    return node_log2 <= FF_NODE_LOG2_MAX ? indices[node_log2] : 0;
}

unsigned ff_strips_for(unsigned coarser, uint8_t strip[5])
{
    FF_ASSERT(coarser < 1u << FF_SIDE_COUNT);
    if (coarser == 0) {
        strip[0] = FF_STRIP_FULL;
        return 1;
    }
    strip[0] = FF_STRIP_INNER;
    for (unsigned side = 0; side < FF_SIDE_COUNT; side++)
        strip[1 + side] = (uint8_t)FF_STRIP_SIDE(side, coarser >> side & 1u);
    return 5;
}
