/* Seams between grounds, proved in integers on the triangles that are drawn: along the rim of where
 * a ground stands it lies below those after it, and where these are left out they end below it. All
 * are piecewise linear, so who is lower at every bend of either is lower everywhere. */
#include "../../client/terrain/ff_strips.h"
#include "../../client/terrain/ff_tree_local.h"
#include "../rig/grounds_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define M          FF_WU_PER_METRE
#define LEAST_STEP 5000 /* of made-up heights */

__extension__ typedef __int128 wide;

/* Places wu, heights 1/65536 wu. */
typedef struct point {
    int64_t x, y, z;
} point;
typedef struct triangle {
    point corner[3];
    uint32_t ground;
} triangle;

static triangle *drawn;
static uint32_t drawn_count, drawn_room;
static ff_strips strips;

/* ---- what is drawn ---- */

static point vertex_of(const ff_tree *tree, const ff_drawn *d, uint32_t at)
{
    const ff_terrain_info *info = ff_ground_of(tree, d->key);
    uint32_t side = ff_node_side(info);
    int32_t place[3];
    ff_shape_place(info, d->key, &d->node->placed, at % side, at / side, 0, place);
    const uint16_t *drop = ff_tree_drop(tree, d);
    int64_t steps = (int64_t)d->heights[at] - (drop ? drop[at] : 0);
    return (point){ place[0], place[1],
                    (int64_t)info->hoffset_wu * 65536 + steps * (int64_t)info->hscale_q24 };
}

static void add_triangle(const triangle *t)
{
    int64_t doubled = (t->corner[1].x - t->corner[0].x) * (t->corner[2].y - t->corner[0].y) -
                      (t->corner[2].x - t->corner[0].x) * (t->corner[1].y - t->corner[0].y);
    if (doubled <= 0) return; /* padding, or a strip's turn */
    if (drawn_count == drawn_room) {
        drawn_room = drawn_room ? 2 * drawn_room : 1024;
        drawn = realloc(drawn, drawn_room * sizeof *drawn);
    }
    drawn[drawn_count++] = *t;
}

static void collect(grounds_fixture *g)
{
    const ff_drawn *list;
    uint32_t count = ff_tree_in_view(g->tree, &list);
    drawn_count = 0;
    assert_int_equal(ff_strips_make(&strips, 3), FF_OK);
    for (uint32_t n = 0; n < count; n++) {
        uint8_t strip[5];
        for (unsigned s = 0, of = ff_strips_for(list[n].coarser, strip); s < of; s++)
            for (unsigned i = 0; i + 2 < strips.length[strip[s]]; i++) {
                const uint16_t *index = strips.index + strips.first[strip[s]] + i;
                triangle t = { .ground = ff_ground_number(g->tree, ff_key_tile(list[n].key)) };
                for (unsigned v = 0; v < 3; v++)
                    t.corner[v] = vertex_of(g->tree, &list[n],
                                            index[v == 0                 ? 0
                                                  : (v == 1) == !(i & 1) ? 1
                                                                         : 2]);
                add_triangle(&t);
            }
    }
}

/* ---- one line over another ---- */

/* An edge that runs along an axis of the world, from its lesser place to its greater one. */
typedef struct edge {
    point from, to;
    unsigned axis;
} edge;

static int64_t along(const point *p, unsigned axis) { return axis ? p->y : p->x; }
static int64_t across(const point *p, unsigned axis) { return axis ? p->x : p->y; }

/* 1 when a triangle lies all on one side of a box. */
static int apart(const triangle *t, int64_t west, int64_t south, int64_t east, int64_t north)
{
    const point *c = t->corner;
    return (c[0].x < west && c[1].x < west && c[2].x < west) ||
           (c[0].x > east && c[1].x > east && c[2].x > east) ||
           (c[0].y < south && c[1].y < south && c[2].y < south) ||
           (c[0].y > north && c[1].y > north && c[2].y > north);
}

/* The sign of how much the triangle is higher than a point in it; 2: the point is outside. */
static int over_point(const triangle *t, const point *p)
{
    wide sum = 0, area = 0;
    for (unsigned i = 0; i < 3; i++) {
        const point *a = &t->corner[(i + 1) % 3], *b = &t->corner[(i + 2) % 3];
        wide weight = (wide)(a->x - p->x) * (b->y - p->y) - (wide)(b->x - p->x) * (a->y - p->y);
        if (weight < 0) return 2;
        area += weight;
        sum += weight * t->corner[i].z;
    }
    sum -= area * p->z;
    return sum > 0 ? 1 : sum < 0 ? -1 : 0;
}

/* The same where a side of the triangle crosses the edge: there both have heights that are ratios
 * over the same two lengths. */
static int over_crossing(const triangle *t, unsigned i, const edge *e)
{
    const point *a = &t->corner[i], *b = &t->corner[(i + 1) % 3];
    int64_t line = across(&e->from, e->axis);
    if (across(a, e->axis) > across(b, e->axis)) {
        const point *c = a;
        a = b;
        b = c;
    }
    int64_t run = across(b, e->axis) - across(a, e->axis), at = line - across(a, e->axis),
            length = along(&e->to, e->axis) - along(&e->from, e->axis);
    if (run == 0 || at < 0 || at > run) return 2;
    /* all by run */
    wide place = (wide)along(a, e->axis) * run + (wide)(along(b, e->axis) - along(a, e->axis)) * at,
         z = (wide)a->z * run + (wide)(b->z - a->z) * at,
         in = place - (wide)along(&e->from, e->axis) * run;
    if (in < 0 || in > (wide)length * run) return 2;
    wide own = (wide)e->from.z * run * length + (wide)(e->to.z - e->from.z) * in,
         over = z * length - own;
    return over > 0 ? 1 : over < 0 ? -1 : 0;
}

/* Counts the bends of both along the edge, where a ground lies over it. Fails where the ground lies
 * below; or says 0 then, and where the ground does not lie over both ends of the edge. */
static uint32_t check_edge(const edge *e, uint32_t ground, int may_fail)
{
    uint32_t bends = 0, ends = 0;
    for (uint32_t n = 0; n < drawn_count; n++) {
        const triangle *t = &drawn[n];
        if (t->ground != ground || apart(t, e->from.x, e->from.y, e->to.x, e->to.y)) continue;
        int found[5] = { over_point(t, &e->from), over_point(t, &e->to) };
        for (unsigned i = 0; i < 3; i++) found[2 + i] = over_crossing(t, i, e);
        for (unsigned i = 0; i < 5; i++) {
            if (found[i] == 2) continue;
            bends++;
            ends |= i < 2 ? 1u << i : 0;
            if (found[i] < 0 && may_fail) return 0;
            if (found[i] < 0)
                fail_msg("ground %u too low at the edge from %lld, %lld to %lld, %lld", ground,
                         (long long)e->from.x, (long long)e->from.y, (long long)e->to.x,
                         (long long)e->to.y);
        }
    }
    return may_fail && ends != 3 ? 0 : bends;
}

/* ---- rims and ends ---- */

static edge edge_of(const triangle *t, unsigned i)
{
    const point *a = &t->corner[i], *b = &t->corner[(i + 1) % 3];
    unsigned axis = a->x == b->x;
    edge e = { *a, *b, axis };
    if (along(a, axis) > along(b, axis)) {
        e.from = *b;
        e.to = *a;
    }
    return e;
}

/* Of triangles of the same ground, is it the side of one alone? Neighbours have equal sides, or
 * their own other edges. */
static int is_end(const triangle *t, unsigned i)
{
    const point *a = &t->corner[i], *b = &t->corner[(i + 1) % 3];
    const point middle = { a->x + b->x, a->y + b->y, 0 };
    for (uint32_t n = 0; n < drawn_count; n++) {
        const triangle *other = &drawn[n];
        if (other == t || other->ground != t->ground ||
            apart(other, middle.x / 2, middle.y / 2, (middle.x + 1) / 2, (middle.y + 1) / 2))
            continue;
        triangle twice = *other;
        for (unsigned v = 0; v < 3; v++) {
            twice.corner[v].x *= 2;
            twice.corner[v].y *= 2;
        }
        if (over_point(&twice, &middle) != 2) return 0;
    }
    return 1;
}

static int on_rim(const ff_area *area, const edge *e)
{
    int64_t at = across(&e->from, e->axis);
    return at == area->lo[!e->axis] || at == area->hi[!e->axis];
}

/* 1 when all that is drawn within a cell or so of an edge is in view. */
static int all_in_view(const grounds_fixture *g, const edge *e)
{
    const ff_drawn *list;
    uint32_t count = ff_tree_cut(g->tree, &list), seen = ff_tree_in_view(g->tree, &list);
    for (uint32_t i = seen; i < count; i++) {
        ff_area area = ff_area_of(g->tree, list[i].key, &list[i].node->placed);
        if (area.lo[0] <= e->to.x && area.hi[0] >= e->from.x && area.lo[1] <= e->to.y &&
            area.hi[1] >= e->from.y)
            return 0;
    }
    return 1;
}

static int deep_in(const ff_area *area, const edge *e)
{
    return e->from.x > area->lo[0] && e->to.x < area->hi[0] && e->from.y > area->lo[1] &&
           e->to.y < area->hi[1];
}

static int deep_in_one(const ff_cover *cover, uint32_t rank, const edge *e)
{
    while (rank-- > 0)
        if (deep_in(&cover->stands[cover->ranked[rank]], e)) return 1;
    return 0;
}

typedef struct proved {
    uint32_t rim, end;
} proved;

/* An edge in which the sheet of a ground ends is below one of those before it; where they are in
 * view, and the picture does not end there. */
static uint32_t check_end(const grounds_fixture *g, const edge *e, uint32_t rank)
{
    const ff_cover *cover = g->tree->cover;
    uint32_t bends = 0, inside = 0;
    for (uint32_t r = 0; r < rank && !bends; r++) {
        if (!deep_in(&cover->stands[cover->ranked[r]], e)) continue;
        inside++;
        bends = check_edge(e, cover->ranked[r], 1);
    }
    if (inside && !bends && all_in_view(g, e))
        fail_msg("the sheet ends above others from %lld, %lld to %lld, %lld", (long long)e->from.x,
                 (long long)e->from.y, (long long)e->to.x, (long long)e->to.y);
    return bends;
}

/* Every side of a triangle on the rim of its ground is below all grounds after it; every side that
 * ends a sheet inside another ground's rectangle is below that one. */
static proved prove(grounds_fixture *g)
{
    const ff_cover *cover = g->tree->cover;
    proved sum = { 0, 0 };
    for (uint32_t n = 0; n < drawn_count; n++)
        for (unsigned i = 0; i < 3; i++) {
            const triangle *t = &drawn[n];
            const point *a = &t->corner[i], *b = &t->corner[(i + 1) % 3];
            if (a->x != b->x && a->y != b->y) continue;
            edge e = edge_of(t, i);
            uint32_t rank = cover->rank[t->ground];
            if (on_rim(&cover->stands[t->ground], &e))
                for (uint32_t r = rank + 1; r < g->count; r++)
                    sum.rim += check_edge(&e, cover->ranked[r], 0);
            else if (deep_in_one(cover, rank, &e) && is_end(t, i))
                sum.end += check_end(g, &e, rank);
        }
    return sum;
}

/* ---- grounds by chance ---- */

static uint32_t stride[FF_GROUNDS_MAX], shift[FF_GROUNDS_MAX], ground_made;

/* Of the ground being made: hills or cliffs seen through its own lattice. */
#define HEIGHT_OF(n)                                                                      \
    static uint16_t height_of_##n(uint32_t x, uint32_t y)                                 \
    {                                                                                     \
        return (uint16_t)(LEAST_STEP + shift[n] +                                         \
                          fixture_hills(x * stride[n] / 64 + n % 2, y * stride[n] / 64)); \
    }
HEIGHT_OF(0)
HEIGHT_OF(1)
HEIGHT_OF(2)
static const fixture_height height_of[] = { height_of_0, height_of_1, height_of_2 };

static uint32_t between(sys_random *random, uint32_t lo, uint32_t hi)
{
    return lo + sys_random_below(random, hi - lo + 1);
}

/* A ground of `samples` each way with a lattice that fits no other, or the first one's. */
static void add(grounds_fixture *g, sys_random *random, int32_t spacing_wu, uint32_t samples_x,
                uint32_t samples_y, int32_t west_wu, int32_t south_wu, uint32_t off_m)
{
    terrain_fixture fx;
    unsigned log2 = 4;
    uint32_t n = g->count;
    while ((1u << log2) + 1 < samples_x || (1u << log2) + 1 < samples_y) log2++;
    stride[n] = (uint32_t)(spacing_wu * 64 / (10 * M));
    shift[n] = off_m;
    if (log2 > 5 && sys_random_below(random, 3) == 0) log2 = 5; /* several tiles */
    fixture_make(&fx, 3, log2, 1, 1, height_of[n]);
    fixture_samples(&fx, samples_x, samples_y);
    fx.info.spacing_wu = (uint32_t)spacing_wu;
    if (sys_random_below(random, 2)) {
        fx.info.hscale_q24 = 1 << 23; /* half a metre, and as high */
        fx.info.hoffset_wu = LEAST_STEP * M / 2;
    }
    grounds_add(g, &fx, west_wu, south_wu);
}

/* Metres that a ground is off: a little, or as much as another datum. */
static uint32_t datum(sys_random *random)
{
    return between(random, 0, sys_random_below(random, 3) ? 30 : 500);
}

static void make(grounds_fixture *g, sys_random *random, unsigned count)
{
    memset(g, 0, sizeof *g);
    int32_t fine_wu = 10 * M, coarse_wu = (int32_t)between(random, 1, 6) * 10 * M;
    int same_lattice = sys_random_below(random, 2) == 0;
    if (!same_lattice) coarse_wu += (int32_t)between(random, 0, 9 * M);
    int32_t west_wu = (int32_t)between(random, 10, 60) * 10 * M,
            south_wu = (int32_t)between(random, 10, 60) * 10 * M;
    if (!same_lattice) {
        west_wu += (int32_t)between(random, 0, 10 * M);
        south_wu += (int32_t)between(random, 0, 10 * M);
    }
    add(g, random, coarse_wu, between(random, 60, 200), between(random, 60, 200), 0, 0,
        datum(random));
    add(g, random, fine_wu, between(random, 40, 180), between(random, 40, 180), west_wu, south_wu,
        datum(random));
    if (count > 2)
        add(g, random, (int32_t)between(random, 11, 30) * M, between(random, 30, 80),
            between(random, 30, 80), west_wu + (int32_t)between(random, 0, 900) * M,
            south_wu - 300 * M + (int32_t)between(random, 0, 900) * M, datum(random));
    ground_made = count;
    grounds_tree(g, 6000, 64);
}

static ff_view view_by_chance(const grounds_fixture *g, sys_random *random)
{
    const ff_terrain_info *fine = &g->ground[1].info;
    int32_t x = fine->west_wu / M + (int32_t)between(random, 0, 1200) - 300,
            y = fine->south_wu / M + (int32_t)between(random, 0, 1200) - 300;
    ff_view view = fixture_view(x, y, LEAST_STEP + (int32_t)between(random, 1300, 3000),
                                (int32_t)between(random, 0, 359),
                                -(int32_t)between(random, 20, 90));
    view.camera.focal_q8 = 60 * 256; /* 127 degrees wide */
    return view;
}

/* Delivers wishes by chance, of one ground roots alone: it stays coarse, and its rim's cells wide.
 */
static void arrive(grounds_fixture *g, sys_random *random, const ff_view *view,
                   const ff_quality *quality, uint32_t starved)
{
    for (uint32_t round = between(random, 5, 60); round-- > 0;) {
        const ff_wish *list;
        ff_wish wish[FIXTURE_BAG];
        ff_tree_select(g->tree, view, quality);
        uint32_t count = ff_tree_wishes(g->tree, &list);
        count = count > FIXTURE_BAG ? FIXTURE_BAG : count;
        memcpy(wish, list, count * sizeof *wish);
        for (uint32_t i = 0; i < count; i++) {
            terrain_fixture *fx = grounds_of(g, wish[i].key);
            if (sys_random_below(random, 3) == 0 ||
                (fx == &g->ground[starved % FF_GROUNDS_MAX] && wish[i].kind != FF_KIND_ROOT))
                continue;
            fixture_deliver(fx, wish[i].key, wish[i].kind);
        }
    }
    ff_tree_select(g->tree, view, quality);
}

static void run(uint64_t seed, unsigned grounds, int terrains)
{
    sys_random random;
    proved all = { 0, 0 };
    uint32_t seams = 0;
    sys_random_seed(&random, seed, 17);
    for (int i = 0; i < terrains; i++) {
        grounds_fixture g;
        make(&g, &random, grounds);
        for (int step = 0; step < 3; step++) {
            ff_view view = view_by_chance(&g, &random);
            ff_quality quality = fixture_quality((enum ff_measure)between(&random, 0, 1));
            quality.c_q8 = (int32_t)between(&random, 128, 1500);
            quality.error_px_q8 = (int32_t)between(&random, 64, 4000);
            if (i % 2)
                arrive(&g, &random, &view, &quality, step == 2 ? grounds : (uint32_t)step);
            else
                grounds_settle(&g, &view, &quality, between(&random, 1, 30));
            assert_int_equal(fixture_stats(&g.ground[0]).seams_short, 0);
            seams += fixture_stats(&g.ground[0]).seams;
            collect(&g);
            grounds_assert_whole(&g);
            proved of = prove(&g);
            all.rim += of.rim;
            all.end += of.end;
        }
        grounds_free(&g);
    }
    print_message("# %u nodes in seams, %u bends along rims, %u along ends\n", seams, all.rim,
                  all.end);
    assert_true(all.rim > 1000u && all.end > 1000u);
}

static void a_fine_ground_in_a_coarse_one_leaves_no_gap(void **state)
{
    (void)state;
    run(1, 2, 40);
}

static void grounds_that_cross_leave_no_gap(void **state)
{
    (void)state;
    run(2, 3, 40);
}

static uint16_t cliff(uint32_t x, uint32_t y)
{
    return (uint16_t)(LEAST_STEP + (x < 10 ? 0 : 500) + (x + y) % 2);
}
static uint16_t plateau(uint32_t x, uint32_t y) { return (void)x, (void)y, LEAST_STEP + 500; }

/* The fine one is level, so its root is never split: its rim at the cliff's foot pulls 320 m of it
 * down. The coarse one's small nodes are left out beyond that alone. */
static void sheets_end_beyond_what_the_rim_pulls_down(void **state)
{
    (void)state;
    grounds_fixture g;
    terrain_fixture fx;
    memset(&g, 0, sizeof g);
    fixture_make(&fx, 3, 7, 1, 1, cliff);
    fx.info.spacing_wu = 40 * M;
    grounds_add(&g, &fx, 0, 0);
    fixture_make(&fx, 3, 8, 1, 1, plateau);
    grounds_add(&g, &fx, 361 * M, 1000 * M);
    grounds_tree(&g, 6000, 64);
    ff_view view = fixture_view(300, 2300, LEAST_STEP + 900, 90, -50);
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    view.camera.focal_q8 = 60 * 256;
    quality.error_px_q8 = 16;
    grounds_settle(&g, &view, &quality, 300);
    collect(&g);
    grounds_assert_whole(&g);
    proved of = prove(&g);
    assert_true(of.rim > 50 && of.end > 50);
    grounds_free(&g);
}

static uint16_t slope(uint32_t x, uint32_t y) { return (uint16_t)(LEAST_STEP + x / 2 + y); }

static void make_touching(grounds_fixture *g)
{
    terrain_fixture fx;
    memset(g, 0, sizeof *g);
    fixture_make(&fx, 3, 6, 1, 1, slope);
    grounds_add(g, &fx, 0, 0);
    grounds_add(g, &fx, 640 * M, 0);
    grounds_tree(g, 6000, 64);
}

/* Neither lies under the other's rim: the one lowered would end in sky. */
static void grounds_that_only_touch_keep_their_rims(void **state)
{
    (void)state;
    grounds_fixture g;
    const ff_drawn *list;
    uint32_t of_ground[2] = { 0 };
    make_touching(&g);
    ff_view view = fixture_view(640, -200, LEAST_STEP + 500, 0, -40);
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    grounds_settle(&g, &view, &quality, 300);
    uint32_t count = ff_tree_in_view(g.tree, &list);
    for (uint32_t n = 0; n < count; n++) {
        const uint16_t *drop = ff_tree_drop(g.tree, &list[n]);
        of_ground[ff_ground_number(g.tree, ff_key_tile(list[n].key))]++;
        for (size_t i = 0; drop && i < ff_heights_per_node(g.tree); i++)
            assert_int_equal(drop[i], 0);
    }
    assert_true(of_ground[0] > 0 && of_ground[1] > 0);
    grounds_free(&g);
}

/* A seam may lower a node's vertices to the depth of a viewer who stands below all ground: it is
 * looked for there, and comes no sooner in the order. */
static void nodes_of_a_seam_are_ordered_by_where_they_lie(void **state)
{
    (void)state;
    grounds_fixture g;
    const ff_drawn *list;
    uint32_t touching = 0;
    int64_t last = 0;
    make_touching(&g);
    ff_view view = fixture_view(740, 100, LEAST_STEP - 100, 270, 60);
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    grounds_settle(&g, &view, &quality, 300);
    uint32_t count = ff_tree_in_view(g.tree, &list);
    for (uint32_t n = 0; n < count; n++) {
        ff_box box;
        ff_node_box(g.tree, list[n].node, &box);
        assert_true(ff_box_distance(&box) >= last);
        last = ff_box_distance(&box);
        touching += (uint32_t)ff_seam_touches(g.tree, list[n].node);
    }
    assert_true(touching > 0 && touching < count);
    grounds_free(&g);
}

/* Half-way up the hills of `make`. */
static ff_view view_along(int32_t x_m, int32_t y_m)
{
    ff_view view = fixture_view(x_m, y_m, LEAST_STEP + 700, 45, -30);
    view.camera.focal_q8 = 60 * 256;
    return view;
}

/* What is kept of a seam is made of the cut, not of what of it is within the view: nodes that come
 * into it fit those that were there. */
static void seams_fit_as_a_short_view_moves(void **state)
{
    (void)state;
    sys_random random;
    uint32_t seams = 0;
    sys_random_seed(&random, 9, 3);
    for (int i = 0; i < 6; i++) {
        grounds_fixture g;
        make(&g, &random, 2);
        ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
        quality.error_px_q8 = 2048;
        ff_view view = view_along(0, 500);
        grounds_settle(&g, &view, &quality, 300);
        for (int step = 0; step < 100; step++) {
            view = view_along(20 * step, 500 + 10 * step);
            quality.view_wu = 900 * M;
            ff_tree_select(g.tree, &view, &quality);
            grounds_assert_whole(&g);
            seams += fixture_stats(&g.ground[0]).seams;
        }
        grounds_free(&g);
    }
    print_message("# %u nodes in seams\n", seams);
    assert_true(seams > 1000);
}

/* What finds no room stays as it is held. */
static void seams_that_find_no_room_are_counted(void **state)
{
    (void)state;
    grounds_fixture g;
    sys_random random;
    sys_random_seed(&random, 5, 5);
    make(&g, &random, 2);
    free(g.memory);
    for (uint32_t i = 0; i < g.count; i++) free(g.ground[i].decoder);
    g.seam_max = 3;
    grounds_tree(&g, 6000, 64);
    ff_view view = view_by_chance(&g, &random);
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    grounds_settle(&g, &view, &quality, 100);
    ff_tree_stats stats = fixture_stats(&g.ground[0]);
    assert_int_equal(stats.seams, 3);
    assert_true(stats.seams_short > 0);
    grounds_free(&g);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_fine_ground_in_a_coarse_one_leaves_no_gap),
        cmocka_unit_test(grounds_that_cross_leave_no_gap),
        cmocka_unit_test(sheets_end_beyond_what_the_rim_pulls_down),
        cmocka_unit_test(grounds_that_only_touch_keep_their_rims),
        cmocka_unit_test(nodes_of_a_seam_are_ordered_by_where_they_lie),
        cmocka_unit_test(seams_fit_as_a_short_view_moves),
        cmocka_unit_test(seams_that_find_no_room_are_counted),
    };
    int rc = cmocka_run_group_tests(tests, NULL, NULL);
    free(drawn);
    return rc;
}
