/* Far sets without a server: which sectors a view shows, where a set is taken and how long it is
 * good, and what fins and paint look like. */
#include "../rig/flat_ground.h"
#include "../rig/picture.h"
#include "../../client/far/ff_sets.h"
#include "../../client/terrain/ff_tree_local.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define M FF_WU_PER_METRE

enum { WIDE = 240, HIGH = 320, FOCAL = 208, LEAD_US = 2000000, SECOND_US = 1000000 };

static c3d_camera level_camera(int32_t yaw)
{
    c3d_camera camera = flat_ground_camera(WIDE, HIGH, FOCAL);
    camera.yaw = yaw;
    return camera;
}

static void sectors_are_those_of_the_view(void **state)
{
    (void)state;
    static const struct {
        int32_t yaw, pitch, roll;
        unsigned sectors;
    } at[] = { { 0, 0, 0, 0x8003 },     { 2048, 0, 0, 0x8007 },      { 4096, 0, 0, 0x0007 },
               { 63488, 0, 0, 0xC003 }, { 32768, -2000, 0, 0x0380 }, { 30720, 0, 0, 0x03C0 } };
    for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
        c3d_camera camera = level_camera(at[i].yaw);
        camera.pitch = at[i].pitch;
        assert_int_equal(ff_sets_in_view(&camera), at[i].sectors);
        camera.roll = 16384; /* more of the horizon fits upright pictures that lie on their side */
        assert_int_equal(ff_sets_in_view(&camera) & at[i].sectors, at[i].sectors);
    }
    c3d_camera down = level_camera(0);
    down.pitch = -16384;
    assert_true(ff_sets_in_view(&down) == 0 || ff_sets_in_view(&down) == 65535);
}

/* Flies `kmh` along x and y for some seconds. */
static c3d_camera fly(ff_motion *motion, int32_t x_m_s, int32_t y_m_s)
{
    c3d_camera camera = level_camera(8192);
    ff_motion_reset(motion);
    for (int i = 0; i < 60; i++) {
        int32_t pos_wu[3];
        memcpy(pos_wu, camera.pos_wu, sizeof pos_wu);
        pos_wu[0] += x_m_s * M * i / 10;
        pos_wu[1] += y_m_s * M * i / 10;
        ff_motion_feed(motion, (int64_t)i * SECOND_US / 10, pos_wu);
        if (i == 59) memcpy(camera.pos_wu, pos_wu, sizeof pos_wu);
    }
    return camera;
}

static void a_set_is_taken_ahead_and_above(void **state)
{
    (void)state;
    static const int32_t clearance_m[] = { 50, 100, 600, 2000, 12000 };
    static ff_sets sets;
    ff_motion motion;
    ff_terrain_info info = flat_ground();
    const ff_far_desc desc = { .enabled = FF_FAR_PAINT, .front_wu = 7500 * M, .coarse = 4 };
    int32_t life_before = 0;
    ff_sets_init(&sets, NULL, &desc, &info, 256);
    sets.lead_us = LEAD_US;
    c3d_camera camera = fly(&motion, 40, 30);
    for (size_t i = 0; i < sizeof clearance_m / sizeof *clearance_m; i++) {
        ff_set set = { .front_wu = desc.front_wu };
        ff_sets_plan(&sets, &camera, &motion, clearance_m[i] * M, &set);
        /* of which a quarter lies before O */
        int32_t life = set.region.ahead_wu / 3 * 4, at_wu[3];
        assert_true(life > life_before && life >= 1500 * M);
        assert_true(set.position_wu[2] > camera.pos_wu[2]);
        assert_true(set.position_wu[0] > camera.pos_wu[0] + 40 * M); /* ahead */
        /* good when it comes, good for its life along the way, and no longer */
        for (int32_t m = -100; m < life / M + 400; m += 50) {
            int32_t along = m * M + 50 * M * (LEAD_US / SECOND_US);
            at_wu[0] = camera.pos_wu[0] + along / 5 * 4;
            at_wu[1] = camera.pos_wu[1] + along / 5 * 3;
            at_wu[2] = camera.pos_wu[2];
            int good = ff_sets_good(&set, at_wu);
            if (m >= 100 && m <= life / M - 100) assert_true(good);
            if (m > life / M + 100) assert_false(good);
        }
        at_wu[0] = set.position_wu[0] - set.region.aside_wu * 2;
        at_wu[1] = set.position_wu[1] + set.region.aside_wu * 2;
        assert_false(ff_sets_good(&set, at_wu));
        memcpy(at_wu, set.position_wu, sizeof at_wu);
        assert_true(ff_sets_good(&set, at_wu));
        at_wu[2] += M;
        assert_false(ff_sets_good(&set, at_wu)); /* who climbs above O sees what O did not */
        life_before = life;
    }
}

static void who_stays_has_a_set_all_round(void **state)
{
    (void)state;
    static ff_sets sets;
    ff_motion motion;
    ff_terrain_info info = flat_ground();
    const ff_far_desc desc = { .enabled = FF_FAR_PAINT, .front_wu = 7500 * M };
    ff_set set = { .front_wu = desc.front_wu };
    ff_sets_init(&sets, NULL, &desc, &info, 256);
    c3d_camera camera = fly(&motion, 0, 0);
    ff_sets_plan(&sets, &camera, &motion, 600 * M, &set);
    assert_int_equal(set.position_wu[0], camera.pos_wu[0]);
    assert_int_equal(set.position_wu[1], camera.pos_wu[1]);
    assert_int_equal(set.region.ahead_wu, set.region.behind_wu);
    assert_true(set.region.aside_wu >= set.region.ahead_wu - M);
    assert_true(ff_sets_good(&set, camera.pos_wu));
}

/* A set is taken ahead of who flies fast: it is asked for once, not given up while it is on its
 * way. */
static void a_set_on_its_way_is_waited_for(void **state)
{
    (void)state;
    static ff_sets sets;
    static uint64_t memory[4096];
    ff_requests requests;
    ff_motion motion;
    ff_terrain_info info = flat_ground();
    const ff_far_desc desc = { .enabled = FF_FAR_PAINT, .front_wu = 7500 * M };
    assert_true(ff_requests_bytes(8) <= sizeof memory);
    ff_requests_init(&requests, 8, memory);
    ff_sets_init(&sets, NULL, &desc, &info, 256);
    sets.serial = 0;
    sets.lead_us = 5 * SECOND_US;
    c3d_camera camera = fly(&motion, 200, 150);
    int32_t from_wu[2] = { camera.pos_wu[0], camera.pos_wu[1] };
    assert_int_equal(ff_sets_update(&sets, &requests, &camera, &motion, 600 * M, 0, 0), 1);
    assert_int_equal(sets.serial, 1);
    for (int i = 0; i < 50; i++) { /* while nothing comes, for longer than sets take */
        int32_t moved_m = 250 * i / 5;
        camera.pos_wu[0] = from_wu[0] + moved_m * M / 5 * 4;
        camera.pos_wu[1] = from_wu[1] + moved_m * M / 5 * 3;
        ff_motion_feed(&motion, (6 + (int64_t)i / 5) * SECOND_US + i % 5 * 200000, camera.pos_wu);
        (void)ff_sets_update(&sets, &requests, &camera, &motion, 600 * M, 0, i * 200000);
        assert_int_equal(sets.serial, 1);
    }
    /* he has flown past it: another one */
    camera.pos_wu[0] += 4000 * M;
    camera.pos_wu[1] += 3000 * M;
    ff_motion_feed(&motion, 16 * SECOND_US, camera.pos_wu);
    (void)ff_sets_update(&sets, &requests, &camera, &motion, 600 * M, 0, 10 * SECOND_US);
    assert_int_equal(sets.serial, 2);
}

/* Whom the server refuses sets three times in a row draws ground as finely as without. */
static void without_sets_far_ground_is_fine(void **state)
{
    (void)state;
    static ff_sets sets;
    const ff_terrain_info info = flat_ground();
    const ff_far_desc desc = { .enabled = FF_FAR_PAINT, .front_wu = 7500 * M, .coarse = 4 };
    ff_new_item refusal = { .key = 1, .kind = FF_KIND_FAR, .refused = 1, .error = FF_ERR_FULL };
    c3d_camera camera = level_camera(0);
    int32_t fine_wu = 0;
    uint8_t coarse = 0;
    ff_sets_init(&sets, NULL, &desc, &info, 256);
    sets.set[0].key = 1;
    sets.next = 0;
    for (int i = 0; i < 3; i++) {
        assert_int_equal(ff_sets_in_use(&sets, &camera, &fine_wu, &coarse), 1);
        assert_int_equal(coarse, 4);
        assert_int_equal(fine_wu, 7500 * M);
        assert_int_equal(ff_sets_take(&sets, &refusal, i), 1);
    }
    assert_int_equal(ff_sets_in_use(&sets, &camera, &fine_wu, &coarse), 0);
    ff_sets_init(&sets, NULL, &desc, &info, 256);
    sets.set[0].key = 1;
    sets.next = 0;
    refusal.error = FF_ERR_UNSUPPORTED; /* once will do */
    assert_int_equal(ff_sets_take(&sets, &refusal, 0), 1);
    assert_int_equal(ff_sets_in_use(&sets, &camera, &fine_wu, &coarse), 0);
}

/* From 9.4 km up the front is farther away than what is set: below a level view. A set is good for
 * the longer the farther its front is, by whoever sets it or chooses it. */
static void the_front_lies_below_a_level_view(void **state)
{
    (void)state;
    static ff_sets sets;
    ff_motion motion;
    ff_terrain_info info = flat_ground();
    ff_far_desc desc = { .enabled = FF_FAR_PAINT, .front_wu = 7500 * M };
    ff_set set = { 0 };
    c3d_camera camera = fly(&motion, 40, 30);
    ff_sets_init(&sets, NULL, &desc, &info, 256);
    assert_int_equal(ff_sets_front_wu(&sets, 600 * M), 7500 * M);
    assert_int_equal(ff_sets_front_wu(&sets, 9000 * M), 7500 * M);
    assert_int_equal(ff_sets_front_wu(&sets, 12000 * M), 9600 * M);
    assert_true(ff_sets_front_wu(&sets, INT32_MAX) <= FF_PANORAMA_BACK_WU_MAX / 2);
    int32_t life_wu = ff_sets_life_wu(&sets, 600 * M);
    assert_int_equal(life_wu, 3200 * M);
    for (int rung = -2; rung <= 2; rung++) {
        const double times[] = { 0.5, 0.7071, 1, 1.4142, 2 };
        sets.choice.rung = (int8_t)rung;
        ff_sets_plan(&sets, &camera, &motion, 600 * M, &set);
        assert_true(fabs(set.front_wu / (7500.0 * M) - times[rung + 2]) < 0.01);
        assert_true(fabs(set.region.ahead_wu / (0.75 * life_wu) - times[rung + 2]) < 0.01);
    }
    desc.front_wu = 15000 * M;
    ff_sets_init(&sets, NULL, &desc, &info, 256);
    assert_int_equal(ff_sets_life_wu(&sets, 600 * M), 2 * life_wu);
    desc.front_wu = 3750 * M;
    ff_sets_init(&sets, NULL, &desc, &info, 256);
    assert_int_equal(ff_sets_life_wu(&sets, 600 * M), life_wu / 2);
}

/* By FF_FAR_AUTO: nothing before a choice; then ground stays fine until a set is drawn; a nearer
 * front for who stays gives another set; what does not pay is not renewed. */
static void what_is_chosen_is_asked_for(void **state)
{
    (void)state;
    static ff_sets sets;
    static uint64_t memory[4096];
    ff_requests requests;
    ff_motion motion;
    ff_terrain_info info = flat_ground();
    const ff_far_desc desc = { .enabled = FF_FAR_AUTO, .front_wu = 7500 * M, .coarse = 4 };
    int32_t fine_wu;
    uint8_t coarse;
    ff_requests_init(&requests, 8, memory);
    ff_sets_init(&sets, NULL, &desc, &info, 256);
    c3d_camera camera = fly(&motion, 0, 0);
    assert_int_equal(ff_sets_update(&sets, &requests, &camera, &motion, 600 * M, 0, 0), 0);
    assert_int_equal(sets.serial, 0);
    sets.choice = (ff_far_choice){ FF_FAR_PAINT, 0, 1 };
    assert_int_equal(ff_sets_update(&sets, &requests, &camera, &motion, 600 * M, 0, 0), 1);
    assert_int_equal(sets.serial, 1);
    assert_int_equal(sets.set[sets.next].paint_shift, 1);
    assert_int_equal(ff_sets_in_use(&sets, &camera, &fine_wu, &coarse), 0);
    sets.set[sets.next].empty = FF_SETS_ALL; /* all of it is here */
    (void)ff_sets_update(&sets, &requests, &camera, &motion, 600 * M, 0, SECOND_US);
    assert_int_equal(ff_sets_in_use(&sets, &camera, &fine_wu, &coarse), 1);
    assert_int_equal(coarse, 4);
    for (int i = 2; i < 5; i++)
        (void)ff_sets_update(&sets, &requests, &camera, &motion, 600 * M, 0, i * SECOND_US);
    assert_int_equal(sets.serial, 1); /* it is good */
    sets.choice = (ff_far_choice){ FF_FAR_PAINT, -1, 0 };
    sets.unpaid = 1;
    (void)ff_sets_update(&sets, &requests, &camera, &motion, 600 * M, 0, 6 * SECOND_US);
    assert_int_equal(sets.serial, 1);
    sets.unpaid = 0;
    for (int i = 7; i < 10; i++)
        (void)ff_sets_update(&sets, &requests, &camera, &motion, 600 * M, 0, i * SECOND_US);
    assert_int_equal(sets.serial, 2);
    sets.choice.use = FF_FAR_OFF;
    assert_int_equal(ff_sets_in_use(&sets, &camera, &fine_wu, &coarse), 0);
    ff_sets_set(&sets, &requests, &desc);
    assert_int_equal(sets.active, -1);
    assert_int_equal(sets.next, -1);
    assert_int_equal(sets.choice.use, FF_FAR_OFF);
}

/* ---- what is thrown on a node ---- */

/* Bits of the sectors whose pictures are thrown on a root that begins east_m, north_m of O. */
static unsigned thrown_on(const ff_sets *sets, const ff_terrain_info *info, uint32_t texture_of,
                          int *plain)
{
    const ff_frame world = { 0 };
    ff_node node = { .key = ff_key_make(0, 0, 0) };
    ff_drawn drawn = { .key = node.key, .node = &node };
    c3d_draw draws[FF_THROWS_MAX] = { { .flags = C3D_DRAW_COLOURED | texture_of } };
    node.placed = ff_shape_put(info, &world, node.key);
    uint16_t heights[81] = { 0 };
    ff_view_kept kept = { 0 };
    const ff_squares *without[FF_THROWS_MAX] = { NULL };
    drawn.heights = heights;
    unsigned count = ff_sets_lay(sets, info, &drawn, &kept, draws, without), sectors = 0;
    assert_in_range(count, 1, FF_THROWS_MAX);
    *plain = !(draws[0].flags & C3D_DRAW_PROJECTED);
    for (unsigned i = 0; i < count; i++) {
        if (!(draws[i].flags & C3D_DRAW_PROJECTED)) continue;
        assert_int_equal(draws[i].flags & C3D_DRAW_TEXTURED, 0);
        /* the first without the test where nothing lies below it */
        assert_int_equal(!(draws[i].flags & C3D_DRAW_ALPHA_TEST), i == 0);
        sectors |= 1u << (draws[i].texture.id - 1);
        assert_ptr_equal(draws[i].projector, &sets->projector[0][draws[i].texture.id - 1]);
    }
    return sectors;
}

static void nodes_wear_the_sectors_that_they_lie_in(void **state)
{
    (void)state;
    static ff_sets sets;
    /* a root of 23 km, by where O lies from its south-west corner */
    static const struct {
        int32_t east_km, north_km;
        unsigned sectors;
    } at[] = { { 11, -40, 0x8003 }, { -40, 11, 0x0038 }, { -20, -20, 0x000E },
               { 11, 11, 0 },       { 11, -5, 0 },       { 11, 63, 0x0380 } };
    ff_terrain_info info = flat_ground();
    const ff_far_desc desc = { .enabled = FF_FAR_PAINT, .front_wu = 7500 * M };
    int plain;
    ff_sets_init(&sets, NULL, &desc, &info, 256);
    sets.active = 0;
    sets.set[0].front_wu = desc.front_wu;
    for (unsigned s = 0; s < FF_FAR_SECTORS; s++) sets.set[0].sector[s].paint.id = s + 1;
    for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
        sets.set[0].position_wu[0] = at[i].east_km * 1000 * M;
        sets.set[0].position_wu[1] = at[i].north_km * 1000 * M;
        assert_int_equal(thrown_on(&sets, &info, 0, &plain), at[i].sectors);
        assert_int_equal(plain, at[i].sectors == 0);
        /* over an image all are thrown on top */
        assert_int_equal(thrown_on(&sets, &info, C3D_DRAW_TEXTURED, &plain), at[i].sectors);
        assert_true(plain);
    }
}

/* ---- pictures ---- */

typedef struct stage {
    picture_kit kit;
    ff_sets sets;
    ff_terrain_info info;
    c3d_vertex scratch[81];
    uint16_t indices[2 * 81];
    uint8_t rgb[WIDE * HIGH * 3];
} stage;

static void open_stage(stage *s, enum ff_far_use use)
{
    const ff_far_desc desc = { .enabled = (uint8_t)use, .front_wu = 1000 * M, .coarse = 4 };
    assert_int_equal(picture_open(&s->kit, PICTURE_SOFT, WIDE, HIGH, 0), FF_OK);
    s->info = flat_ground();
    memset(&s->sets, 0, sizeof s->sets);
    ff_sets_init(&s->sets, s->kit.device, &desc, &s->info, 256);
    ff_sets_scratch(&s->sets, s->scratch, s->indices, 16);
    s->kit.frame.camera = level_camera(0);
}

/* The viewer is far away: the set goes. */
static void leave(stage *s)
{
    c3d_camera camera = s->kit.frame.camera;
    camera.pos_wu[0] += 50000 * M;
    assert_int_equal(ff_sets_update(&s->sets, NULL, &camera, NULL, 0, 1, 0), 1);
    assert_int_equal(s->sets.active, -1);
}

static void show(stage *s)
{
    c3d_begin(s->kit.device, &s->kit.frame);
    ff_sets_aim(&s->sets, &s->kit.frame.camera);
    ff_sets_draw(&s->sets, &s->kit.frame.camera);
    c3d_end(s->kit.device);
    assert_int_equal(c3d_read_rgb(s->kit.device, s->rgb), FF_OK);
}

static int top_of_column(const stage *s, int x)
{
    for (int y = 0; y < HIGH; y++) {
        const uint8_t *pixel = s->rgb + 3 * (y * WIDE + x);
        if (pixel[0] | pixel[1] | pixel[2]) return y;
    }
    return HIGH;
}

/* Sector 0 with one fin, 10 km away, that rises from left to right; and paint if there are pixels.
 */
static void give_sector(stage *s, uint16_t *pixels, unsigned side)
{
    static uint8_t slot[FF_FAR_VERTICES_MAX * sizeof(ff_fin_vertex) + 256 * 256 * 2];
    ff_set *set = &s->sets.set[0];
    ff_fin_vertex *fin = (ff_fin_vertex *)(void *)slot;
    memcpy(set->position_wu, s->kit.frame.camera.pos_wu, sizeof set->position_wu);
    set->front_wu = 1000 * M;
    set->focal = FOCAL;
    set->painted = pixels != NULL;
    set->key = 1;
    for (int i = 0; i <= 20; i++)
        fin[i] = (ff_fin_vertex){ .column = (int16_t)(8 * i - 80),
                                  .up_q2 = (int16_t)(4 * i),
                                  .distance = (uint16_t)ff_far_distance_step(10000 * M),
                                  .begins = i == 0 };
    ff_new_item item = { .key = 1, .kind = FF_KIND_FAR, .pixels = (uint16_t *)(void *)slot };
    item.u.far.fins = 21;
    if (pixels) {
        memcpy(fin + FF_FAR_VERTICES_MAX, pixels, side * side * sizeof *pixels);
        item.width = item.height = (uint16_t)side;
        item.u.far.middle = (int16_t)(side / 2);
        item.u.far.top = (int16_t)(side / 2);
    }
    assert_int_equal(ff_sets_take(&s->sets, &item, 0), 1);
    assert_int_equal(ff_sets_take(&s->sets, &item, 0), 0); /* once */
    s->sets.active = 0;
}

static void fins_stand_where_ridges_were_seen(void **state)
{
    (void)state;
    static stage s;
    open_stage(&s, FF_FAR_FINS);
    give_sector(&s, NULL, 0);
    show(&s);
    for (int x = 45; x < 195; x++) {
        double up = (x + 0.5 - 40) / 8; /* a texel is a pixel here */
        assert_in_range(top_of_column(&s, x) + 1, (int)(HIGH / 2 - up), (int)(HIGH / 2 - up) + 2);
    }
    assert_int_equal(top_of_column(&s, 30), HIGH);
    assert_int_equal(top_of_column(&s, 210), HIGH);
    /* from a kilometre nearer it stands higher, from one side elsewhere: it has its distance */
    s.kit.frame.camera.pos_wu[1] += 5000 * M;
    show(&s);
    assert_in_range(top_of_column(&s, WIDE / 2), HIGH / 2 - 22, HIGH / 2 - 18);
    picture_close(&s.kit);
}

static void fins_wear_the_paint(void **state)
{
    (void)state;
    enum { SIDE = 256 };
    static stage s;
    static uint16_t pixels[SIDE * SIDE];
    open_stage(&s, FF_FAR_PAINT);
    /* red left, green right, nothing in the outermost texels */
    for (int y = 1; y < SIDE - 1; y++)
        for (int x = 1; x < SIDE - 1; x++) pixels[y * SIDE + x] = x < SIDE / 2 ? 0xF801 : 0x07C1;
    give_sector(&s, pixels, SIDE);
    show(&s);
    for (int x = 80; x < 160; x++) { /* a sector is 86 texels wide */
        const uint8_t *pixel = s.rgb + 3 * ((top_of_column(&s, x) + 4) * WIDE + x);
        if (x > 118 && x < 122) continue;
        assert_int_equal(pixel[0], x < 120 ? 255 : 0);
        assert_int_equal(pixel[1], x < 120 ? 0 : 255);
    }
    /* beyond the sector the picture is made up: there the fin has its own colour */
    for (int x = 45; x < 75; x++) {
        const uint8_t *pixel = s.rgb + 3 * ((top_of_column(&s, x) + 4) * WIDE + x);
        assert_true(pixel[1] > 20);
    }
    leave(&s);
    c3d_stats stats;
    c3d_get_stats(s.kit.device, &stats);
    assert_int_equal(stats.stale_handles, 0);
    picture_close(&s.kit);
}

typedef struct told {
    ff_key set;
    unsigned sector, parts;
    uint32_t triangles;
    int32_t west_wu, east_wu;
} told;

static void tell(void *context, ff_key set, unsigned sector, const c3d_vertex *vertex,
                 uint32_t vertices, const uint16_t *index, uint32_t indices)
{
    told *t = context;
    t->set = set;
    t->sector = sector;
    t->parts++;
    for (uint32_t i = 0; i + 2 < indices; i++)
        t->triangles += index[i] != index[i + 1] && index[i + 1] != index[i + 2] &&
                        index[i] != index[i + 2];
    for (uint32_t i = 0; i < vertices; i++) {
        t->west_wu = vertex[i].x < t->west_wu ? vertex[i].x : t->west_wu;
        t->east_wu = vertex[i].x > t->east_wu ? vertex[i].x : t->east_wu;
    }
}

/* In parts, as meshes have room, each joined to the one before; without a device, too. */
static void who_watches_is_told_of_all_fins(void **state)
{
    (void)state;
    for (int device = 0; device < 2; device++) {
        static stage s;
        told t = { 0 };
        open_stage(&s, FF_FAR_FINS);
        s.sets.watch = tell;
        s.sets.watch_context = &t;
        if (!device) s.sets.device = NULL;
        give_sector(&s, NULL, 0);
        assert_int_equal(t.set, 1);
        assert_int_equal(t.sector, 0);
        assert_int_equal(t.parts, 3); /* 8 vertices of the 21 and their feet in a mesh */
        assert_int_equal(t.triangles, 40);
        assert_in_range(t.east_wu - t.west_wu, 7700 * M * 98 / 100, 7700 * M * 102 / 100);
        assert_in_range(t.east_wu + t.west_wu + 100, 0, 200);
        picture_close(&s.kit);
    }
}

/* A set that lacks a sector in view is not shown; nor while the drawn one is good and it is not. */
static void a_set_takes_over_when_all_in_view_is_here(void **state)
{
    (void)state;
    static stage s;
    open_stage(&s, FF_FAR_FINS);
    c3d_camera *camera = &s.kit.frame.camera;
    unsigned in_view = ff_sets_in_view(camera);
    ff_set *next = &s.sets.set[1];
    *next = (ff_set){ .key = 2, .region = { .high_wu = 1, .low_wu = -1 } };
    memcpy(next->position_wu, camera->pos_wu, sizeof next->position_wu);
    s.sets.next = 1;
    next->empty = (uint16_t)(in_view & (in_view - 1)); /* all but one */
    (void)ff_sets_update(&s.sets, NULL, camera, NULL, 0, 1, 0);
    assert_int_equal(s.sets.active, -1);
    next->empty = (uint16_t)in_view;
    assert_int_equal(ff_sets_update(&s.sets, NULL, camera, NULL, 0, 1, 0), 1);
    assert_int_equal(s.sets.active, 1);
    picture_close(&s.kit);
}

/* Paint in view finds room where only pictures out of view are in the way. */
static void sectors_out_of_view_give_way(void **state)
{
    (void)state;
    enum { SIDE = 64 };
    static stage s;
    static uint16_t pixels[SIDE * SIDE];
    open_stage(&s, FF_FAR_PAINT);
    give_sector(&s, pixels, SIDE);
    while (c3d_texture_make(s.kit.device, C3D_RGBA5551, SIDE, SIDE, pixels).id) {
    }
    static uint8_t slot[FF_FAR_VERTICES_MAX * sizeof(ff_fin_vertex) + SIDE * SIDE * 2];
    ff_new_item item = { .key = 1, .kind = FF_KIND_FAR, .pixels = (uint16_t *)(void *)slot };
    item.width = item.height = SIDE;
    item.u.far.sector = 1;
    s.sets.seen = 1 << 0 | 1 << 1; /* all are in view */
    assert_int_equal(ff_sets_take(&s.sets, &item, 0), 1);
    assert_int_equal(s.sets.set[0].sector[1].paint.id, 0);
    item.u.far.sector = 2;
    s.sets.seen = 1 << 1 | 1 << 2;
    assert_int_equal(ff_sets_take(&s.sets, &item, 0), 1);
    assert_true(s.sets.set[0].sector[2].paint.id);
    assert_int_equal(s.sets.set[0].held, 1 << 1 | 1 << 2); /* the first is to be asked for again */
    picture_close(&s.kit);
}

/* All meshes and textures that a set had are free again. */
static void a_set_gives_back_what_it_held(void **state)
{
    (void)state;
    static stage s;
    c3d_stats before, after;
    open_stage(&s, FF_FAR_FINS);
    c3d_get_stats(s.kit.device, &before);
    give_sector(&s, NULL, 0);
    c3d_get_stats(s.kit.device, &after);
    assert_true(after.mesh_held > before.mesh_held);
    leave(&s);
    c3d_get_stats(s.kit.device, &after);
    assert_int_equal(after.mesh_held, before.mesh_held);
    assert_int_equal(after.strip_held, before.strip_held);
    picture_close(&s.kit);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sectors_are_those_of_the_view),
        cmocka_unit_test(a_set_is_taken_ahead_and_above),
        cmocka_unit_test(who_stays_has_a_set_all_round),
        cmocka_unit_test(without_sets_far_ground_is_fine),
        cmocka_unit_test(the_front_lies_below_a_level_view),
        cmocka_unit_test(what_is_chosen_is_asked_for),
        cmocka_unit_test(nodes_wear_the_sectors_that_they_lie_in),
        cmocka_unit_test(fins_stand_where_ridges_were_seen),
        cmocka_unit_test(fins_wear_the_paint),
        cmocka_unit_test(a_set_takes_over_when_all_in_view_is_here),
        cmocka_unit_test(sectors_out_of_view_give_way),
        cmocka_unit_test(a_set_gives_back_what_it_held),
        cmocka_unit_test(a_set_on_its_way_is_waited_for),
        cmocka_unit_test(who_watches_is_told_of_all_fins),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
