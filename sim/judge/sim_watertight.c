/* See sim_watertight.h. A table of keys holds the listed nodes and all nodes above them: the check
 * finds in it which nodes touch. */
#include "sim_watertight.h"

#include "sim_rim.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ABOVE UINT32_MAX /* in place of an index: no listed node, but listed ones lie in it */

typedef struct entry {
    ff_key key;
    uint32_t index;
} entry;
/* Where a node's corner would lie at no height, and its height: on any shape, whoever shares the
 * sample agrees in both. */
typedef struct corner {
    int32_t foot_wu[3];
    int32_t height;
    uint8_t used;
} corner;

typedef struct check {
    const ff_terrain_info *info;
    const ff_frame *frame;
    const ff_tree *lowered; /* whose seams lower vertices; NULL: none does */
    const ff_drawn *list;
    uint32_t count;
    unsigned n; /* cells of a node each way */
    ff_strips strips;
    sim_rim rim[16];     /* by mask of coarser sides */
    unsigned rims_known; /* bit for each mask whose rim is known */
    entry *entries;
    corner *corners;
    uint32_t entry_mask, corner_mask;
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

static uint32_t mixed(uint64_t value)
{
    return (uint32_t)((value ^ value >> 32) * UINT64_C(0xD6E8FEB86659FD93) >> 32);
}

static uint32_t table_size(uint64_t entries)
{
    uint32_t size = 16;
    while (size < 2 * entries) size *= 2;
    return size;
}

static entry *entry_place(const check *c, ff_key key)
{
    uint32_t at = mixed(key) & c->entry_mask;
    while (c->entries[at].key != FF_KEY_NONE && c->entries[at].key != key)
        at = (at + 1) & c->entry_mask;
    return &c->entries[at];
}

/* ---- nodes alone ---- */

static int kind_ok(check *c, unsigned coarser)
{
    if (coarser > 15) return fault(c, "a node has no such sides: %x", coarser);
    if (c->rims_known >> coarser & 1u) return 1;
    c->rims_known |= 1u << coarser;
    const char *wrong = sim_rim_of_strips(&c->strips, c->info->node_log2, coarser,
                                          &c->rim[coarser]);
    return !wrong || fault(c, "crack: strips of a node with coarser sides %x: %s", coarser, wrong);
}

/* Along each axis the node is as long as its edge, or ends with the terrain. */
static int ends_with_ground(const check *c, ff_key key, const ff_placed *placed)
{
    static const int64_t height_wu[2] = { 0, 0 };
    static const int32_t from_wu[3] = { 0, 0, 0 };
    ff_box all = ff_shape_bounds(c->info, c->frame, height_wu, from_wu);
    int64_t lo[2] = { INT64_MAX, INT64_MAX }, hi[2] = { INT64_MIN, INT64_MIN };
    for (unsigned i = 0; i < 4; i++) {
        int32_t at_wu[3];
        ff_shape_place(c->info, key, placed, (i & 1) * c->n, (i >> 1) * c->n, 0, at_wu);
        for (unsigned axis = 0; axis < 2; axis++) {
            lo[axis] = at_wu[axis] < lo[axis] ? at_wu[axis] : lo[axis];
            hi[axis] = at_wu[axis] > hi[axis] ? at_wu[axis] : hi[axis];
        }
    }
    for (unsigned axis = 0; axis < 2; axis++) {
        int64_t end = lo[axis] + ff_node_edge_wu(c->info, ff_key_level(key));
        if (hi[axis] != (end < all.hi[axis] ? end : all.hi[axis])) return 0;
    }
    return 1;
}

static int node_ok(check *c, uint32_t index)
{
    int32_t origin_wu[3];
    const ff_drawn *drawn = &c->list[index];
    unsigned long long key = (unsigned long long)drawn->key;
    if (!ff_terrain_has_node(c->info, drawn->key))
        return fault(c, "key %llx is not of this terrain", key);
    if (!ff_shape_has_ground(c->info, drawn->key))
        return fault(c, "node %llx lies beyond the terrain", key);
    ff_placed placed = ff_shape_put(c->info, c->frame, drawn->key);
    ff_shape_place(c->info, drawn->key, &placed, 0, 0, 32768, origin_wu);
    if (memcmp(drawn->origin_wu, origin_wu, sizeof origin_wu) != 0 ||
        drawn->cell_wu != ff_node_cell_wu(c->info, ff_key_level(drawn->key)))
        return fault(c, "node %llx has a wrong origin or cell", key);
    if (!ends_with_ground(c, drawn->key, &placed))
        return fault(c, "node %llx is not drawn up to the terrain's edge", key);
    entry *place = entry_place(c, drawn->key);
    if (place->key == drawn->key) return fault(c, "node %llx is listed twice", key);
    *place = (entry){ drawn->key, index };
    return kind_ok(c, drawn->coarser);
}

/* Enters all nodes above a listed one; none of them may be listed. */
static int enter_above(check *c, ff_key key)
{
    for (ff_key up = key; ff_key_level(up) > 0;) {
        up = ff_key_parent(up);
        entry *place = entry_place(c, up);
        if (place->key == up && place->index != ABOVE)
            return fault(c, "node %llx lies on listed node %llx", (unsigned long long)key,
                         (unsigned long long)up);
        if (place->key == up) return 1;
        *place = (entry){ up, ABOVE };
    }
    return 1;
}

/* ---- nodes that touch ---- */

/* Steps. */
static int32_t height_of(const check *c, const ff_drawn *drawn, uint32_t vertex)
{
    const uint16_t *drop = c->lowered ? ff_tree_drop(c->lowered, drawn) : NULL;
    return drawn->heights[vertex] - (drop ? drop[vertex] : 0);
}

/* Compares the vertices drawn along one side of `drawn` with those of the listed node `across`,
 * which is `finer` levels coarser. `beside` is what lies across at the level of `drawn`. */
static int rims_agree(check *c, const ff_drawn *drawn, enum ff_side side, const ff_beside *beside,
                      const ff_drawn *across, unsigned finer)
{
    enum ff_side back = beside->side;
    uint32_t code = ff_key_code(beside->key), n = c->n;
    uint32_t along = back == FF_SIDE_SOUTH || back == FF_SIDE_NORTH ? ff_morton_x(code)
                                                                    : ff_morton_y(code);
    /* of the coarser side's length, in cells of ours, as that side runs */
    uint32_t from = (along & ((1u << finer) - 1)) * n;
    uint64_t used = c->rim[drawn->coarser].used[side], missing = used,
             other = c->rim[across->coarser].used[back];
    for (uint32_t j = (from + (1u << finer) - 1) >> finer; j << finer <= from + n; j++) {
        uint32_t i = ff_beside_along(beside, (j << finer) - from, n);
        if (!(other >> j & 1u)) continue;
        int32_t here = height_of(c, drawn, sim_rim_vertex(n, side, i)),
                there = height_of(c, across, sim_rim_vertex(n, back, j));
        if (!(used >> i & 1u))
            return fault(c, "crack: vertex %u on side %u of node %llx is drawn by node %llx alone",
                         i, side, (unsigned long long)drawn->key, (unsigned long long)across->key);
        if (here != there)
            return fault(
                c, "crack: vertex %u on side %u of node %llx has heights %d and %d (node %llx)", i,
                side, (unsigned long long)drawn->key, here, there, (unsigned long long)across->key);
        missing &= ~(UINT64_C(1) << i);
    }
    return !missing ||
           fault(c, "crack: node %llx draws vertices on side %u that node %llx does not",
                 (unsigned long long)drawn->key, side, (unsigned long long)across->key);
}

/* The listed node across a side when it is coarser, or as coarse and of the larger key: each pair
 * is looked at once, but for a node that is its own neighbour. */
static int side_ok(check *c, const ff_drawn *drawn, enum ff_side side)
{
    ff_beside beside = ff_shape_neighbour(c->info, drawn->key, side);
    ff_key key = beside.key;
    for (unsigned finer = 0; key != FF_KEY_NONE; finer++) {
        const entry *place = entry_place(c, key);
        if (place->key == key && (place->index == ABOVE || (!finer && key < drawn->key))) return 1;
        if (place->key == key)
            return rims_agree(c, drawn, side, &beside, &c->list[place->index], finer);
        key = ff_key_level(key) > 0 ? ff_key_parent(key) : FF_KEY_NONE;
    }
    return 1;
}

static corner *corner_place(const check *c, const int32_t foot_wu[3])
{
    uint64_t xy = (uint64_t)(uint32_t)foot_wu[0] << 32 | (uint32_t)foot_wu[1];
    uint32_t at = (mixed(xy) ^ mixed((uint32_t)foot_wu[2])) & c->corner_mask;
    while (c->corners[at].used && memcmp(c->corners[at].foot_wu, foot_wu, sizeof(int32_t[3])) != 0)
        at = (at + 1) & c->corner_mask;
    return &c->corners[at];
}

/* Corners beyond the last sample lie where others do and are not theirs: along a side they have
 * been compared. */
static int corners_ok(check *c, const ff_drawn *drawn)
{
    ff_placed placed = ff_shape_put(c->info, c->frame, drawn->key);
    uint32_t edge = 1u << (c->info->tile_log2 - ff_key_level(drawn->key));
    ff_extent extent = ff_shape_extent(c->info, drawn->key);
    for (unsigned i = 0; i < 4; i++) {
        uint32_t column = (i & 1) * c->n, row = (i >> 1) * c->n;
        if ((column && extent.columns < edge) || (row && extent.rows < edge)) continue;
        corner at = { .height = height_of(c, drawn, row * (c->n + 1) + column), .used = 1 };
        ff_shape_place(c->info, drawn->key, &placed, column, row, 0, at.foot_wu);
        corner *place = corner_place(c, at.foot_wu);
        if (place->used && place->height != at.height)
            return fault(c, "crack: corner %d,%d,%d has heights %d and %d", at.foot_wu[0],
                         at.foot_wu[1], at.foot_wu[2], place->height, at.height);
        *place = at;
    }
    return 1;
}

static int all_ok(check *c)
{
    for (uint32_t i = 0; i < c->count; i++)
        if (!node_ok(c, i)) return 0;
    for (uint32_t i = 0; i < c->count; i++)
        if (!enter_above(c, c->list[i].key)) return 0;
    for (uint32_t i = 0; i < c->count; i++) {
        for (unsigned side = 0; side < FF_SIDE_COUNT; side++)
            if (!side_ok(c, &c->list[i], (enum ff_side)side)) return 0;
        if (!corners_ok(c, &c->list[i])) return 0;
    }
    return 1;
}

static int check_ground(const ff_terrain_info *info, const ff_frame *frame, const ff_tree *lowered,
                        const ff_drawn *list, uint32_t count, char *why, size_t why_bytes)
{
    check *c = calloc(1, sizeof *c);
    if (!c) return 0;
    *c = (check){ .info = info,
                  .frame = frame,
                  .lowered = lowered,
                  .list = list,
                  .count = count,
                  .n = 1u << info->node_log2,
                  .why = why,
                  .why_bytes = why_bytes };
    /* with all that can lie above */
    c->entry_mask = table_size((uint64_t)count * (info->tile_log2 - info->node_log2 + 1u)) - 1;
    c->corner_mask = table_size((uint64_t)count * 4) - 1;
    c->entries = malloc(((size_t)c->entry_mask + 1) * sizeof *c->entries);
    c->corners = calloc((size_t)c->corner_mask + 1, sizeof *c->corners);
    int ok = 0;
    if (!c->entries || !c->corners) {
        fault(c, "out of memory");
    } else if (ff_strips_make(&c->strips, info->node_log2) < 0) {
        fault(c, "terrain's nodes have no strips");
    } else {
        for (uint32_t i = 0; i <= c->entry_mask; i++) c->entries[i].key = FF_KEY_NONE;
        ok = all_ok(c);
    }
    free(c->entries);
    free(c->corners);
    free(c);
    return ok;
}

int sim_watertight_check(const ff_terrain_info *info, const ff_frame *frame, const ff_drawn *list,
                         uint32_t count, char *why, size_t why_bytes)
{
    return check_ground(info, frame, NULL, list, count, why, why_bytes);
}

int sim_watertight_check_tree(const ff_tree *tree, int lowered, const ff_drawn *list,
                              uint32_t count, char *why, size_t why_bytes)
{
    uint32_t grounds, listed = 0;
    const ff_terrain_info *info = ff_tree_grounds(tree, &grounds);
    ff_drawn *own = malloc((count + 1u) * sizeof *own);
    int ok = own != NULL;
    if (!ok && why && why_bytes) snprintf(why, why_bytes, "out of memory");
    for (uint32_t i = 0; ok && i < grounds; i++) {
        uint32_t of_it = 0;
        for (uint32_t k = 0; k < count; k++)
            if (ff_terrain_has_node(&info[i], list[k].key)) own[of_it++] = list[k];
        listed += of_it;
        ok = check_ground(&info[i], ff_tree_frame(tree), lowered ? tree : NULL, own, of_it, why,
                          why_bytes);
    }
    free(own);
    if (ok && listed != count && why && why_bytes)
        snprintf(why, why_bytes, "%u nodes are of no ground", count - listed);
    return ok && listed == count;
}
