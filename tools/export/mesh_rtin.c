#include "mesh_rtin.h"

#include "../../protocol/ff_assert.h"

#include <math.h>
#include <string.h>

#define EARTH_M 6371000.0

/* A point's number. */
static uint32_t at(int column, int row) { return (uint32_t)(row * MESH_SIDE + column); }

/* A right triangle: the ends of its longest side, then its right angle, counter-clockwise. */
typedef struct corner {
    int x, y;
} corner;
typedef struct triangle {
    corner a, b, c;
} triangle;

static const triangle halves[2] = {
    { { 0, 0 }, { MESH_CELLS, MESH_CELLS }, { 0, MESH_CELLS } },
    { { MESH_CELLS, MESH_CELLS }, { 0, 0 }, { MESH_CELLS, 0 } },
};

static corner middle_of(const triangle *t)
{
    return (corner){ (t->a.x + t->b.x) / 2, (t->a.y + t->b.y) / 2 };
}

/* A triangle of single cells has no middle among the points. */
static int has_middle(const triangle *t)
{
    return (t->a.x + t->b.x) % 2 == 0 && (t->a.y + t->b.y) % 2 == 0;
}

static triangle first_half(const triangle *t) { return (triangle){ t->c, t->a, middle_of(t) }; }
static triangle second_half(const triangle *t) { return (triangle){ t->b, t->c, middle_of(t) }; }

/* What measuring needs to know. */
typedef struct gauge {
    const float *height;
    const double *cell_m;
    double cell_y_m;
    float *error;
} gauge;

/* How far the middle of a triangle's longest side is from that side, which is a chord of the Earth.
 */
static float miss(const gauge *g, const triangle *t)
{
    corner m = middle_of(t);
    double x = (t->a.x - t->b.x) * g->cell_m[m.y], y = (t->a.y - t->b.y) * g->cell_y_m;
    double chord = (g->height[at(t->a.x, t->a.y)] + g->height[at(t->b.x, t->b.y)]) / 2.0 -
                   (x * x + y * y) / (8 * EARTH_M);
    return (float)fabs(g->height[at(m.x, m.y)] - chord);
}

/* Takes into the errors of one size of triangles those of the halves, which are known. */
static void measure(const gauge *g, const triangle *t, int depth)
{
    if (!has_middle(t)) return;
    triangle half[2] = { first_half(t), second_half(t) };
    if (depth > 0) {
        measure(g, &half[0], depth - 1);
        measure(g, &half[1], depth - 1);
        return;
    }
    corner m = middle_of(t);
    float *error = &g->error[at(m.x, m.y)];
    *error = fmaxf(*error, miss(g, t));
    for (int i = 0; i < 2; i++) {
        corner below = middle_of(&half[i]);
        if (has_middle(&half[i])) *error = fmaxf(*error, g->error[at(below.x, below.y)]);
    }
}

void mesh_rtin_measure(const float *height, const double cell_m[MESH_SIDE], double cell_y_m,
                       mesh_rtin *rtin)
{
    gauge g = { height, cell_m, cell_y_m, rtin->error };
    memset(rtin->error, 0, sizeof rtin->error);
    /* from the smallest triangles up: both that share a middle come before those above them */
    for (int depth = 2 * MESH_CELLS_LOG2 - 1; depth >= 0; depth--)
        for (int i = 0; i < 2; i++) measure(&g, &halves[i], depth);
}

/* ---- sides ---- */

static uint32_t side_point(enum mesh_side side, int i)
{
    switch (side) {
        case MESH_WEST: return at(0, i);
        case MESH_SOUTH: return at(i, 0);
        case MESH_EAST: return at(MESH_CELLS, i);
        default: return at(i, MESH_CELLS);
    }
}

void mesh_rtin_sides(const mesh_rtin *rtin, float error_m, mesh_sides *sides)
{
    for (int s = 0; s < MESH_SIDES; s++)
        for (int i = 0; i < MESH_SIDE; i++)
            sides->used[s][i] = i % MESH_CELLS == 0 ||
                                rtin->error[side_point((enum mesh_side)s, i)] > error_m;
}

/* The side that a triangle's edge lies on, or MESH_SIDES. */
static enum mesh_side side_of(corner a, corner b)
{
    if (a.x == b.x) return a.x == 0 ? MESH_WEST : a.x == MESH_CELLS ? MESH_EAST : MESH_SIDES;
    if (a.y == b.y) return a.y == 0 ? MESH_SOUTH : a.y == MESH_CELLS ? MESH_NORTH : MESH_SIDES;
    return MESH_SIDES;
}

/* ---- triangles ---- */

typedef struct weaver {
    mesh_rtin *rtin;
    float error_m;
    const mesh_sides *sides;
} weaver;

static void add(const weaver *w, corner a, corner b, corner c)
{
    uint32_t *index = w->rtin->index + 3 * (size_t)w->rtin->triangle_count++;
    FF_ASSERT(w->rtin->triangle_count <= 2 * MESH_POINTS);
    index[0] = at(a.x, a.y);
    index[1] = at(b.x, b.y);
    index[2] = at(c.x, c.y);
}

/* The used point of a side that follows `from` on the way to `to`, or `to`. */
static corner next_on(const weaver *w, enum mesh_side side, corner from, corner to)
{
    int step_x = (to.x > from.x) - (to.x < from.x), step_y = (to.y > from.y) - (to.y < from.y);
    corner p = { from.x + step_x, from.y + step_y };
    while ((p.x != to.x || p.y != to.y) && !w->sides->used[side][step_x ? p.x : p.y]) {
        p.x += step_x;
        p.y += step_y;
    }
    return p;
}

/* A triangle, as a fan where an edge on a side of the square has points that only the square next
 * to it uses. At most two edges do: what the first one's fan leaves is a fan of the second one's.
 */
static void add_fans(const weaver *w, corner a, corner b, corner c, int edges_left)
{
    enum mesh_side side = side_of(a, b);
    if (side != MESH_SIDES) {
        corner p = next_on(w, side, a, b);
        if (p.x != b.x || p.y != b.y) {
            /* a - p - b: the part at a keeps the edge from c to a, the rest that from b to c */
            add_fans(w, c, a, p, 1);
            add_fans(w, p, b, c, edges_left);
            return;
        }
    }
    if (edges_left > 0)
        add_fans(w, b, c, a, edges_left - 1);
    else
        add(w, a, b, c);
}

static void weave(const weaver *w, const triangle *t)
{
    corner m = middle_of(t);
    if (has_middle(t) && w->rtin->error[at(m.x, m.y)] > w->error_m) {
        triangle half[2] = { first_half(t), second_half(t) };
        weave(w, &half[0]);
        weave(w, &half[1]);
        return;
    }
    add_fans(w, t->a, t->b, t->c, 2);
}

void mesh_rtin_triangulate(mesh_rtin *rtin, float error_m, const mesh_sides *sides)
{
    weaver w = { rtin, error_m, sides };
    rtin->triangle_count = 0;
    for (int i = 0; i < 2; i++) weave(&w, &halves[i]);
}
