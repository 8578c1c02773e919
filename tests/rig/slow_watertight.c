/* See slow_watertight.h. Beyond the terrain's last sample vertices are drawn on it: who shares a
 * vertex shares its place, so edges are paired by the samples they come from, and what is drawn
 * must cover the part inside. Points are counted in samples of the finest level, heights in steps;
 * three hash tables with open addressing hold nodes, vertices and edges. */
#include "slow_watertight.h"

#include "../../client/terrain/ff_strips.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct point {
    uint32_t x, y;
} point;
typedef struct vertex {
    point at;
    uint16_t height;
    uint8_t used;
} vertex;
typedef struct edge {
    point from, to;
    uint8_t used, forward, backward;
} edge; /* from < to */

typedef struct check {
    const ff_terrain_info *info;
    const ff_drawn *list;
    uint32_t count;
    ff_strips strips;
    ff_key *nodes;
    vertex *vertices;
    edge *edges;
    uint32_t node_mask, vertex_mask, edge_mask;
    unsigned levels; /* finest level listed */
    char *why;
    size_t why_bytes;
} check;

static int fault(check *c, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    if (c->why && c->why_bytes) vsnprintf(c->why, c->why_bytes, format, arguments);
    va_end(arguments);
    return 0;
}

static uint32_t mixed(uint64_t a, uint64_t b)
{
    uint64_t hash = (a ^ b * UINT64_C(0x9E3779B97F4A7C15)) * UINT64_C(0xD6E8FEB86659FD93);
    return (uint32_t)(hash >> 32);
}

static uint64_t packed(point p) { return (uint64_t)p.x << 32 | p.y; }

static uint32_t table_size(uint64_t entries)
{
    uint32_t size = 16;
    while (size < 2 * entries) size *= 2;
    return size;
}

/* ---- nodes ---- */

static ff_key *node_place(const check *c, ff_key key)
{
    uint32_t at = mixed(key, 0) & c->node_mask;
    while (c->nodes[at] != FF_KEY_NONE && c->nodes[at] != key) at = (at + 1) & c->node_mask;
    return &c->nodes[at];
}

static int node_ok(check *c, const ff_drawn *drawn)
{
    unsigned long long key = (unsigned long long)drawn->key;
    if (!ff_terrain_has_node(c->info, drawn->key))
        return fault(c, "key %llx is not of this terrain", key);
    uint32_t tile = ff_key_tile(drawn->key), code = ff_key_code(drawn->key),
             edge_wu = c->info->spacing_wu << (c->info->tile_log2 - ff_key_level(drawn->key)),
             tile_edge_wu = c->info->spacing_wu << c->info->tile_log2;
    uint32_t x = tile % c->info->tiles_x * tile_edge_wu + ff_morton_x(code) * edge_wu,
             y = tile / c->info->tiles_x * tile_edge_wu + ff_morton_y(code) * edge_wu;
    if (drawn->origin_wu[0] != (int32_t)x || drawn->origin_wu[1] != (int32_t)y ||
        drawn->origin_wu[2] != ff_height_wu(c->info, 32768) ||
        drawn->cell_wu != ff_node_cell_wu(c->info, ff_key_level(drawn->key)))
        return fault(c, "node %llx has a wrong origin or cell", key);
    if (x >= (c->info->samples_x - 1) * c->info->spacing_wu ||
        y >= (c->info->samples_y - 1) * c->info->spacing_wu)
        return fault(c, "node %llx lies beyond the terrain", key);
    ff_key *place = node_place(c, drawn->key);
    if (*place == drawn->key) return fault(c, "node %llx is listed twice", key);
    *place = drawn->key;
    if (ff_key_level(drawn->key) > c->levels) c->levels = ff_key_level(drawn->key);
    return 1;
}

static int no_ancestor_listed(check *c, ff_key key)
{
    for (ff_key up = key; ff_key_level(up) > 0;) {
        up = ff_key_parent(up);
        if (*node_place(c, up) == up)
            return fault(c, "node %llx lies on listed node %llx", (unsigned long long)key,
                         (unsigned long long)up);
    }
    return 1;
}

/* 1 when a listed node covers the unit square of samples whose south-west corner is (x, y). */
static int covered(const check *c, int64_t x, int64_t y)
{
    unsigned n = c->info->tile_log2;
    int64_t tile_x = x >> n, tile_y = y >> n;
    if (x < 0 || y < 0 || tile_x >= c->info->tiles_x || tile_y >= c->info->tiles_y) return 0;
    uint32_t tile = (uint32_t)(tile_y * c->info->tiles_x + tile_x);
    uint32_t in_x = (uint32_t)(x & ((1 << n) - 1)), in_y = (uint32_t)(y & ((1 << n) - 1));
    for (unsigned level = 0; level <= c->levels; level++) {
        ff_key key = ff_key_make(tile, level,
                                 ff_morton_encode(in_x >> (n - level), in_y >> (n - level)));
        if (*node_place(c, key) == key) return 1;
    }
    return 0;
}

/* ---- triangles ---- */

static int add_vertex(check *c, point at, uint16_t height)
{
    uint32_t i = mixed(packed(at), 1) & c->vertex_mask;
    while (c->vertices[i].used && packed(c->vertices[i].at) != packed(at))
        i = (i + 1) & c->vertex_mask;
    if (c->vertices[i].used && c->vertices[i].height != height)
        return fault(c, "crack: vertex %u,%u has heights %u and %u", at.x, at.y,
                     c->vertices[i].height, height);
    c->vertices[i] = (vertex){ at, height, 1 };
    return 1;
}

static int add_edge(check *c, point from, point to)
{
    int forward = packed(from) < packed(to);
    point a = forward ? from : to, b = forward ? to : from;
    uint32_t i = mixed(packed(a), packed(b)) & c->edge_mask;
    while (c->edges[i].used &&
           (packed(c->edges[i].from) != packed(a) || packed(c->edges[i].to) != packed(b)))
        i = (i + 1) & c->edge_mask;
    edge *e = &c->edges[i];
    e->used = 1;
    e->from = a;
    e->to = b;
    uint8_t *uses = forward ? &e->forward : &e->backward;
    if (++*uses > 1)
        return fault(c, "edge %u,%u to %u,%u is drawn twice", from.x, from.y, to.x, to.y);
    return 1;
}

/* Where a sample is drawn. */
static point drawn_point(const check *c, point at)
{
    point last = { c->info->samples_x - 1, c->info->samples_y - 1 };
    return (point){ at.x < last.x ? at.x : last.x, at.y < last.y ? at.y : last.y };
}

static int64_t doubled_area(const point p[3])
{
    int64_t ax = (int64_t)p[1].x - p[0].x, ay = (int64_t)p[1].y - p[0].y;
    int64_t bx = (int64_t)p[2].x - p[0].x, by = (int64_t)p[2].y - p[0].y;
    return ax * by - bx * ay;
}

static int add_strip(check *c, const ff_drawn *drawn, unsigned id, int64_t *area)
{
    uint32_t side = ff_node_side(c->info), cell = (uint32_t)drawn->cell_wu / c->info->spacing_wu;
    uint32_t x = (uint32_t)drawn->origin_wu[0] / c->info->spacing_wu,
             y = (uint32_t)drawn->origin_wu[1] / c->info->spacing_wu;
    const uint16_t *index = &c->strips.index[c->strips.first[id]];
    for (unsigned i = 0; i + 2 < c->strips.length[id]; i++) {
        uint16_t v[3] = { index[i], index[i + 1 + (i & 1)], index[i + 2 - (i & 1)] };
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
        point p[3];
        for (unsigned j = 0; j < 3; j++) {
            if (v[j] >= side * side) return fault(c, "strip %u runs out of its node", id);
            p[j] = (point){ x + v[j] % side * cell, y + v[j] / side * cell };
        }
        if (doubled_area(p) <= 0)
            return fault(c, "triangle at %u,%u is degenerate or clockwise", p[0].x, p[0].y);
        point drawn_at[3] = { drawn_point(c, p[0]), drawn_point(c, p[1]), drawn_point(c, p[2]) };
        int64_t doubled = doubled_area(drawn_at);
        if (doubled < 0) return fault(c, "triangle at %u,%u is turned over", p[0].x, p[0].y);
        *area += doubled;
        for (unsigned j = 0; j < 3; j++) {
            if (!add_vertex(c, p[j], drawn->heights[v[j]]) || !add_edge(c, p[j], p[(j + 1) % 3]))
                return 0;
        }
    }
    return 1;
}

static int add_node(check *c, const ff_drawn *drawn)
{
    uint8_t strip[5];
    unsigned strips = ff_strips_for(drawn->coarser, strip);
    uint32_t edge_samples = 1u << (c->info->tile_log2 - ff_key_level(drawn->key));
    int64_t area = 0;
    for (unsigned i = 0; i < strips; i++) {
        if (!add_strip(c, drawn, strip[i], &area)) return 0;
    }
    point first = { (uint32_t)drawn->origin_wu[0] / c->info->spacing_wu,
                    (uint32_t)drawn->origin_wu[1] / c->info->spacing_wu },
          last = drawn_point(c, (point){ first.x + edge_samples, first.y + edge_samples });
    if (area != 2 * (int64_t)(last.x - first.x) * (last.y - first.y))
        return fault(c, "node %llx is not covered exactly", (unsigned long long)drawn->key);
    return 1;
}

/* ---- edges used once ---- */

static int border_ok(check *c, const edge *e)
{
    point from = e->forward ? e->from : e->to, to = e->forward ? e->to : e->from;
    int64_t dx = (int64_t)to.x - from.x, dy = (int64_t)to.y - from.y;
    if (dx != 0 && dy != 0)
        return fault(c, "crack: slanting edge %u,%u to %u,%u has no partner", from.x, from.y, to.x,
                     to.y);
    /* The inside is on the left; the unit squares just to the right, at both ends, must be free. */
    int64_t x_first = from.x - (dy < 0) - (dx < 0), y_first = from.y - (dx > 0) - (dy < 0);
    int64_t x_last = to.x - (dy < 0) - (dx > 0), y_last = to.y - (dx > 0) - (dy > 0);
    if (covered(c, x_first, y_first) || covered(c, x_last, y_last))
        return fault(c, "crack: edge %u,%u to %u,%u has no partner", from.x, from.y, to.x, to.y);
    return 1;
}

static int all_ok(check *c)
{
    for (uint32_t i = 0; i < c->count; i++) {
        if (!node_ok(c, &c->list[i])) return 0;
    }
    for (uint32_t i = 0; i < c->count; i++) {
        if (!no_ancestor_listed(c, c->list[i].key) || !add_node(c, &c->list[i])) return 0;
    }
    for (uint32_t i = 0; i <= c->edge_mask; i++) {
        if (c->edges[i].forward != c->edges[i].backward && !border_ok(c, &c->edges[i])) return 0;
    }
    return 1;
}

int slow_watertight_check(const ff_terrain_info *info, const ff_drawn *list, uint32_t count,
                          char *why, size_t why_bytes)
{
    check *c = calloc(1, sizeof *c);
    if (!c) return 0;
    uint64_t side = ff_node_side(info), cells = (side - 1) * (side - 1);
    *c = (check){ .info = info, .list = list, .count = count, .why = why, .why_bytes = why_bytes };
    c->node_mask = table_size(count) - 1;
    c->vertex_mask = table_size(count * side * side) - 1;
    c->edge_mask = table_size(count * (3 * cells + 2 * side)) - 1;
    c->nodes = malloc(((size_t)c->node_mask + 1) * sizeof *c->nodes);
    c->vertices = calloc((size_t)c->vertex_mask + 1, sizeof *c->vertices);
    c->edges = calloc((size_t)c->edge_mask + 1, sizeof *c->edges);
    int ok = 0;
    if (!c->nodes || !c->vertices || !c->edges) {
        fault(c, "out of memory");
    } else if (ff_strips_make(&c->strips, info->node_log2) < 0) {
        fault(c, "terrain's nodes have no strips");
    } else {
        for (uint32_t i = 0; i <= c->node_mask; i++) c->nodes[i] = FF_KEY_NONE;
        ok = all_ok(c);
    }
    free(c->nodes);
    free(c->vertices);
    free(c->edges);
    free(c);
    return ok;
}
