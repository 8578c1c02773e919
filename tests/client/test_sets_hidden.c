/* A ridge and a plain behind it: ground that the ridge hides from where a far set was taken wears
 * none of its paint, all other ground does, on every back end. */
#include "../rig/picture.h"
#include "../rig/terrain_fixture.h"
#include "../../client/far/ff_sets.h"
#include "../../client/terrain/ff_tree_local.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define M FF_WU_PER_METRE

enum {
    WIDE = 240,
    HIGH = 320,
    FOCAL = 208,
    SIDE = 128,
    ENTRIES = 200,
    SPACING_M = 100,
    O_EAST_M = 3200,
    O_NORTH_M = 200,
    O_UP_M = 400,
    RIDGE_M = 2000, /* from O */
    RIDGE_UP_M = 150
};

/* Uneven, so that nodes are small. */
static uint16_t ridge(uint32_t x, uint32_t y)
{
    return y == (O_NORTH_M + RIDGE_M) / SPACING_M ? RIDGE_UP_M : (uint16_t)((x ^ y) % 3);
}

typedef struct stage {
    picture_kit kit;
    terrain_fixture ground;
    ff_sets sets;
    ff_terrain_view view;
    ff_view_node entry[ENTRIES];
    ff_view_kept kept[ENTRIES + 1];
    c3d_vertex vertices[81];
    uint16_t index[508], part[3 * (2 * 81 + 4)];
    ff_strips strips;
    uint8_t rgb[WIDE * HIGH * 3];
} stage;

/* Looks down on the ground from the south, from so high that the ridge hides none of it. */
static void look(stage *s)
{
    c3d_camera *camera = &s->kit.frame.camera;
    *camera = (c3d_camera){ .pos_wu = { O_EAST_M * M, -500 * M, 3500 * M },
                            .pitch = -65536 / 8,
                            .focal_q8 = FOCAL * 256,
                            .width = WIDE,
                            .height = HIGH,
                            .near_wu = 50 * M,
                            .far_wu = 20000 * M };
    ff_view view = { .camera = *camera };
    ff_quality quality = {
        .measure = FF_MEASURE_DISTANCE, .c_q8 = 1 << 16, .sigma_q8 = 320, .view_wu = INT32_MAX
    };
    fixture_settle(&s->ground, &view, &quality, 100);
}

static void open_stage(stage *s, enum picture_kind kind, int buffers)
{
    const ff_far_desc desc = { .enabled = FF_FAR_PAINT, .front_wu = 500 * M, .coarse = 4 };
    memset(s, 0, sizeof *s);
    assert_int_equal(picture_open(&s->kit, kind, WIDE, HIGH, buffers), FF_OK);
    fixture_make(&s->ground, 3, 6, 1, 1, ridge);
    s->ground.info.spacing_wu = SPACING_M * M;
    s->ground.info.height_max = RIDGE_UP_M;
    fixture_tree(&s->ground, 400, 64);
    s->view = (ff_terrain_view){ .device = s->kit.device,
                                 .entry = s->entry,
                                 .entry_count = ENTRIES,
                                 .vertices = s->vertices,
                                 .heights_per_node = 81,
                                 .kept = s->kept,
                                 .index = s->index,
                                 .part = s->part,
                                 .throws = { ff_sets_lay, &s->sets } };
    assert_int_equal(ff_terrain_view_strips(&s->view, 3, &s->strips), FF_OK);
    ff_terrain_view_attach(&s->view, s->ground.tree, NULL);
    ff_sets_init(&s->sets, s->kit.device, &desc, &s->ground.info, SIDE);
    ff_sets_scratch(&s->sets, s->vertices, s->part, 81);
    look(s);
}

static void close_stage(stage *s)
{
    fixture_free(&s->ground);
    picture_close(&s->kit);
}

/* A set with the ridge as a fin in sector 0, under paint of one colour. */
static void give_set(stage *s, int index, uint16_t colour)
{
    static uint8_t slot[FF_FAR_VERTICES_MAX * sizeof(ff_fin_vertex) + SIDE * SIDE * 2];
    ff_set *set = &s->sets.set[index];
    ff_fin_vertex *fin = (ff_fin_vertex *)(void *)slot;
    uint16_t *texel = (uint16_t *)(void *)(fin + FF_FAR_VERTICES_MAX);
    *set = (ff_set){ .key = (ff_key)index + 1, .front_wu = 500 * M, .focal = FOCAL, .painted = 1 };
    set->position_wu[0] = O_EAST_M * M;
    set->position_wu[1] = O_NORTH_M * M;
    set->position_wu[2] = O_UP_M * M;
    for (int i = 0; i < 2; i++)
        fin[i] = (ff_fin_vertex){ .column = (int16_t)(84 * i - 42),
                                  .up_q2 = 4 * FOCAL * (RIDGE_UP_M - O_UP_M) / RIDGE_M,
                                  .distance = (uint16_t)ff_far_distance_step(RIDGE_M * M),
                                  .begins = i == 0 };
    for (int i = 0; i < SIDE * SIDE; i++) {
        int x = i % SIDE, y = i / SIDE;
        texel[i] = x > 0 && x < SIDE - 1 && y > 0 && y < SIDE - 1 ? colour : 0;
    }
    ff_new_item item = { .key = set->key,
                         .kind = FF_KIND_FAR,
                         .pixels = (uint16_t *)(void *)slot,
                         .width = SIDE,
                         .height = SIDE,
                         .u.far = { .fins = 2, .middle = SIDE / 2, .top = 8 } };
    assert_int_equal(ff_sets_take(&s->sets, &item, 0), 1);
}

static void show(stage *s)
{
    const ff_drawn *list;
    const c3d_camera *camera = &s->kit.frame.camera;
    uint32_t count = ff_tree_drawn(s->ground.tree, &list);
    s->kit.frame.clear_colour = 0xFFFF00FF; /* magenta */
    c3d_begin(s->kit.device, &s->kit.frame);
    ff_sets_aim(&s->sets, camera);
    ff_terrain_view_begin(&s->view, list, count);
    ff_terrain_view_draw(&s->view, list, count, camera, 0);
    c3d_end(s->kit.device);
    assert_int_equal(c3d_read_rgb(s->kit.device, s->rgb), FF_OK);
}

/* The pixel of a place on the plain, forward and to the right of O. */
static const uint8_t *pixel_at(const stage *s, int forward_m, int right_m)
{
    const c3d_camera *camera = &s->kit.frame.camera;
    c3d_rotation rotation;
    int64_t eye[3], offset[3] = { (int64_t)(O_EAST_M + right_m) * M - camera->pos_wu[0],
                                  (int64_t)(O_NORTH_M + forward_m) * M - camera->pos_wu[1],
                                  -camera->pos_wu[2] };
    c3d_rotation_from_camera(camera, &rotation);
    c3d_to_eye(&rotation, offset, eye);
    int x = (int)(WIDE / 2 + eye[0] * FOCAL / eye[2]),
        y = (int)(HIGH / 2 - eye[1] * FOCAL / eye[2]);
    assert_true(eye[2] > 0 && x >= 0 && x < WIDE && y >= 0 && y < HIGH);
    return s->rgb + 3 * (y * WIDE + x);
}

static int is_red(const uint8_t *rgb) { return rgb[0] > 240 && rgb[1] < 10 && rgb[2] < 10; }
static int is_blue(const uint8_t *rgb) { return rgb[0] < 10 && rgb[1] < 10 && rgb[2] > 240; }

/* What is painted and what is not meet: nothing of the background between them. */
static void nothing_is_open(const stage *s)
{
    for (int right_m = -800; right_m <= 800; right_m += 10)
        for (int forward_m = 600; forward_m <= 5000; forward_m += 5) {
            const uint8_t *pixel = pixel_at(s, forward_m, right_m);
            assert_false(pixel[0] == 255 && pixel[1] == 0 && pixel[2] == 255);
        }
}

/* From O at 400 m over a ridge of 150 m, 2 km away, one sees the plain again from 3.2 km on. */
static void paint_lies_on_what_was_seen(stage *s)
{
    nothing_is_open(s);
    for (int right_m = -150; right_m <= 150; right_m += 50) {
        for (int forward_m = 1350; forward_m <= 1800; forward_m += 50)
            assert_true(is_red(pixel_at(s, forward_m, right_m)));
        for (int forward_m = 2450; forward_m <= 2950; forward_m += 50) {
            const uint8_t *pixel = pixel_at(s, forward_m, right_m);
            assert_true(!is_red(pixel) && pixel[1] > 20); /* its own colour, and no sky */
        }
        for (int forward_m = 3550; forward_m <= 4800; forward_m += 50)
            assert_true(is_red(pixel_at(s, forward_m, right_m)));
    }
}

static void hidden_ground_shows_its_own_colour(enum picture_kind kind, int buffers)
{
    static stage s;
    uint8_t own[3];
    open_stage(&s, kind, buffers);
    show(&s);
    memcpy(own, pixel_at(&s, 2700, 0), 3);
    give_set(&s, 0, 0xF801);
    s.sets.active = 0;
    for (int twice = 0; twice < 2; twice++) { /* found out, and kept */
        show(&s);
        paint_lies_on_what_was_seen(&s);
        assert_memory_equal(pixel_at(&s, 2700, 0), own, 3);
    }
    c3d_stats stats;
    c3d_get_stats(s.kit.device, &stats);
    assert_int_equal(stats.stale_handles, 0);
    assert_int_equal(stats.strip_held, 1u + s.strips.count + s.sets.set[0].sector[0].chunks);
    close_stage(&s);
}

static void on_integers(void **state)
{
    (void)state;
    hidden_ground_shows_its_own_colour(PICTURE_SOFT, 0);
    hidden_ground_shows_its_own_colour(PICTURE_SOFT_565, 0);
}

static void on_gl(void **state)
{
    (void)state;
    hidden_ground_shows_its_own_colour(PICTURE_GL, 0);
    hidden_ground_shows_its_own_colour(PICTURE_GL, 1);
}

static void on_gles1(void **state)
{
    (void)state;
    hidden_ground_shows_its_own_colour(PICTURE_GLES1, 1);
}

/* Of both sets; and when there is no room for parts of nodes none of them is painted. */
static void of_a_set_that_fades_out_too(void **state)
{
    (void)state;
    static stage s;
    open_stage(&s, PICTURE_SOFT, 0);
    give_set(&s, 0, 0x003F);
    give_set(&s, 1, 0xF801);
    s.sets.under = 0;
    s.sets.active = 1;
    s.sets.through = 1;
    show(&s);
    paint_lies_on_what_was_seen(&s);
    s.sets.under = 1;
    s.sets.active = 0;
    s.sets.through = 255;
    show(&s);
    paint_lies_on_what_was_seen(&s);
    close_stage(&s);
}

/* Another set in the same place has ridges of its own. */
static void what_is_kept_is_of_this_set(void **state)
{
    (void)state;
    static stage s;
    open_stage(&s, PICTURE_SOFT, 0);
    give_set(&s, 0, 0xF801);
    s.sets.active = 0;
    show(&s);
    paint_lies_on_what_was_seen(&s);
    give_set(&s, 0, 0x003F);
    memset(&s.sets.set[0].sector[0].ridges, 0, sizeof(ff_ridges)); /* it has none */
    show(&s);
    for (int forward_m = 2450; forward_m <= 4800; forward_m += 50)
        assert_true(is_blue(pixel_at(&s, forward_m, 0)));
    close_stage(&s);
}

/* Ground that may be higher than it is drawn may have been seen. */
static void what_is_coarse_is_hidden_less(void **state)
{
    (void)state;
    static stage s;
    const ff_frame world = { 0 };
    const uint16_t heights[81] = { 0 };
    ff_node node = { .key = ff_key_make(0, 1, 3) }; /* its north-east: 3000 to 6200 m from O */
    ff_drawn drawn = { .key = node.key, .node = &node, .heights = heights };
    open_stage(&s, PICTURE_SOFT, 0);
    give_set(&s, 0, 0xF801);
    node.placed = ff_shape_put(&s.ground.info, &world, node.key);
    ff_squares exact = ff_sets_hidden(&s.sets.set[0], 1, &s.ground.info, &drawn);
    assert_int_equal(exact, 3); /* of the first row what lies in the sector: up to 3300 m or so */
    while (ff_tree_error_wu(&s.ground.info, &node) < 60 * M) node.error_code++;
    assert_int_equal(ff_sets_hidden(&s.sets.set[0], 1, &s.ground.info, &drawn), 0);
    close_stage(&s);
}

static void without_room_nothing_partly_hidden_is_painted(void **state)
{
    (void)state;
    static stage s;
    open_stage(&s, PICTURE_SOFT, 0);
    give_set(&s, 0, 0xF801);
    s.sets.active = 0;
    while (c3d_strip_make(s.kit.device, s.strips.index, 3).id) {
    }
    show(&s);
    for (int forward_m = 2450; forward_m <= 2950; forward_m += 50)
        assert_false(is_red(pixel_at(&s, forward_m, 0)));
    nothing_is_open(&s);
    assert_true(is_red(pixel_at(&s, 4600, 0)));
    close_stage(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(on_integers),
        cmocka_unit_test(on_gl),
        cmocka_unit_test(on_gles1),
        cmocka_unit_test(of_a_set_that_fades_out_too),
        cmocka_unit_test(what_is_kept_is_of_this_set),
        cmocka_unit_test(what_is_coarse_is_hidden_less),
        cmocka_unit_test(without_room_nothing_partly_hidden_is_painted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
