/* See sim_rim.h. The check: all triangles are counter-clockwise and inside the node, every edge is
 * used once in each direction or lies on the border, and the areas add up to the node's. Then the
 * triangles tile the node: the number of triangles over a point changes nowhere inside, so it is 1
 * everywhere. */
#include "sim_rim.h"

#include "../../protocol/codec/ff_codec.h"

#include <string.h>

/* places of a hash table: 6 edges for each cell of the largest node, and room */
enum { EDGES = 16 << 2 * FF_NODE_LOG2_MAX };

typedef struct point {
    int32_t x, y;
} point;
typedef struct edge {
    uint16_t from, to;
} edge; /* from == to: a free place */

typedef struct tiling {
    unsigned n;
    uint32_t places; /* used of the table: a power of two */
    int64_t doubled_area;
    edge edges[EDGES];
} tiling;

unsigned sim_rim_vertex(unsigned n, enum ff_side side, unsigned i)
{
    switch (side) {
        case FF_SIDE_SOUTH: return i;
        case FF_SIDE_NORTH: return n * (n + 1) + i;
        case FF_SIDE_EAST: return i * (n + 1) + n;
        default: return i * (n + 1);
    }
}

static edge *edge_place(tiling *t, unsigned from, unsigned to)
{
    uint32_t at = (from * 40503u ^ to * 30011u) & (t->places - 1);
    while (t->edges[at].from != t->edges[at].to &&
           (t->edges[at].from != from || t->edges[at].to != to))
        at = (at + 1) & (t->places - 1);
    return &t->edges[at];
}

static const char *add_triangle(tiling *t, const uint16_t v[3])
{
    point p[3];
    for (unsigned i = 0; i < 3; i++)
        p[i] = (point){ (int32_t)(v[i] % (t->n + 1)), (int32_t)(v[i] / (t->n + 1)) };
    int32_t doubled = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[2].x - p[0].x) * (p[1].y - p[0].y);
    if (doubled <= 0) return "a triangle is degenerate or clockwise";
    t->doubled_area += doubled;
    for (unsigned i = 0; i < 3; i++) {
        edge *place = edge_place(t, v[i], v[(i + 1) % 3]);
        if (place->from != place->to) return "an edge is drawn twice";
        *place = (edge){ v[i], v[(i + 1) % 3] };
    }
    return NULL;
}

static const char *add_strip(tiling *t, const ff_strips *strips, unsigned id)
{
    const uint16_t *index = &strips->index[strips->first[id]];
    const char *wrong = NULL;
    for (unsigned i = 0; !wrong && i + 2 < strips->length[id]; i++) {
        uint16_t v[3] = { index[i], index[i + 1 + (i & 1)], index[i + 2 - (i & 1)] };
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
        for (unsigned j = 0; j < 3; j++)
            if (v[j] >= (t->n + 1) * (t->n + 1)) return "a strip runs out of its node";
        wrong = add_triangle(t, v);
    }
    return wrong;
}

/* An edge without a partner must run along one side. */
static const char *add_to_rim(const tiling *t, const edge *e, sim_rim *rim)
{
    unsigned n = t->n, x[2] = { e->from % (n + 1), e->to % (n + 1) },
             y[2] = { e->from / (n + 1), e->to / (n + 1) };
    if (y[0] == y[1] && (y[0] == 0 || y[0] == n)) {
        rim->used[y[0] ? FF_SIDE_NORTH : FF_SIDE_SOUTH] |= UINT64_C(1) << x[0] | UINT64_C(1)
                                                                                     << x[1];
        return NULL;
    }
    if (x[0] == x[1] && (x[0] == 0 || x[0] == n)) {
        rim->used[x[0] ? FF_SIDE_EAST : FF_SIDE_WEST] |= UINT64_C(1) << y[0] | UINT64_C(1) << y[1];
        return NULL;
    }
    return "an edge inside has no partner";
}

const char *sim_rim_of_strips(const ff_strips *strips, unsigned node_log2, unsigned coarser,
                              sim_rim *rim)
{
    tiling t;
    uint8_t strip[5];
    unsigned count = ff_strips_for(coarser, strip);
    const char *wrong = NULL;
    t.n = 1u << node_log2;
    t.places = 16u << 2 * node_log2;
    t.doubled_area = 0;
    memset(t.edges, 0, t.places * sizeof t.edges[0]);
    *rim = (sim_rim){ { 0 } };
    for (unsigned i = 0; !wrong && i < count; i++) wrong = add_strip(&t, strips, strip[i]);
    if (!wrong && t.doubled_area != 2 * (int64_t)t.n * t.n) wrong = "a node is not covered exactly";
    for (unsigned i = 0; !wrong && i < t.places; i++) {
        edge *e = &t.edges[i], *partner = e->from != e->to ? edge_place(&t, e->to, e->from) : e;
        if (partner->from == partner->to && e->from != e->to) wrong = add_to_rim(&t, e, rim);
    }
    return wrong;
}
