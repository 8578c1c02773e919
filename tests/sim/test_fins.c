/* Fins as the judge sees them: a strip's triangles, those that are still drawn, and what they are
 * in a picture: ground that raises the skyline, hides what is behind it, and is wrong over the sky.
 */
#include "../../sim/judge/sim_cover.h"
#include "../rig/scene_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <math.h>

#define M FF_WU_PER_METRE

enum { WEST_M = -3000, EAST_M = 3000, AWAY_M = 4096, SECTOR = 0 };

/* A wall 1000 m high from west to east, 4096 m north of the terrain's middle. */
static uint16_t wall(void *context, uint32_t x, uint32_t y)
{
    (void)context;
    (void)x;
    return y == 24 ? 1000 : 0;
}

/* A fin so far north of O, between two heights above O, all across the picture. */
static void give_fin(sim_fins *fins, ff_key set, unsigned sector, int32_t away_m, int32_t foot_m,
                     int32_t top_m)
{
    static const uint16_t index[] = { 0, 1, 2, 3 };
    const c3d_vertex vertex[] = { { WEST_M * M, away_m * M, top_m * M, { 0 } },
                                  { WEST_M * M, away_m * M, foot_m * M, { 0 } },
                                  { EAST_M * M, away_m * M, top_m * M, { 0 } },
                                  { EAST_M * M, away_m * M, foot_m * M, { 0 } } };
    sim_fins_take(fins, set, sector, vertex, 4, index, 4);
}

/* Of set 1, taken 100 m above the viewer and 500 m ahead of him. */
static void draw_fins(scene *s, const sim_fins *fins)
{
    s->view.fins = (sim_drawn_fins){ .fins = fins, .set = 1, .sectors = 1u << SECTOR };
    for (int i = 0; i < 3; i++) s->view.fins.position_wu[i] = s->view.camera.pos_wu[i];
    s->view.fins.position_wu[1] += 500 * M;
    s->view.fins.position_wu[2] += 100 * M;
}

static sim_audit_result audit(const scene *s)
{
    sim_audit_result result;
    assert_int_equal(sim_audit_frame(s->auditor, &s->view, &result), FF_OK);
    return result;
}

/* Two fins in one strip, joined by a degenerate way: two triangles each, and none between them. */
static void a_strip_is_its_triangles(void **state)
{
    (void)state;
    static const uint16_t index[] = { 0, 1, 2, 3, 3, 4, 4, 5, 6, 7 };
    c3d_vertex vertex[8];
    sim_fins fins = { 0 };
    for (int i = 0; i < 8; i++) vertex[i] = (c3d_vertex){ i * M / 2, i * M, -i * M, { 0 } };
    sim_fins_take(&fins, 5, 2, vertex, 8, index, 10);
    assert_int_equal(fins.rc, FF_OK);
    assert_int_equal(fins.count, 4);
    for (size_t i = 0; i < fins.count; i++) {
        int first = 0;
        assert_int_equal(fins.fin[i].set, 5);
        assert_int_equal(fins.fin[i].sector, 2);
        for (int k = 0; k < 3; k++) {
            int at = (int)fins.fin[i].corner_m[k][1];
            first += at < 4;
            assert_true(fins.fin[i].corner_m[k][0] == at * 0.5);
            assert_true(fins.fin[i].corner_m[k][2] == -at);
        }
        assert_int_equal(first, i < 2 ? 3 : 0);
    }
    sim_fins_free(&fins);
}

/* A sector that has given way and comes again is not there twice, one in two parts is whole; sets
 * of the past go, the one that is coming stays. */
static void only_what_may_be_drawn_is_kept(void **state)
{
    (void)state;
    sim_fins fins = { 0 };
    for (int part = 0; part < 2; part++) give_fin(&fins, 1, 3, 100, 0, 10);
    give_fin(&fins, 1, 4, 200, 0, 10);
    give_fin(&fins, 2, 3, 300, 0, 10);
    assert_int_equal(fins.count, 8);
    give_fin(&fins, 1, 3, 400, 0, 10);
    assert_int_equal(fins.count, 6);
    for (size_t i = 0; i < fins.count; i++) assert_true(fins.fin[i].corner_m[0][1] != 100);
    sim_fins_forget(&fins, 2);
    assert_int_equal(fins.count, 2);
    assert_int_equal(fins.fin[0].set, 2);
    sim_fins_forget(&fins, 3);
    assert_int_equal(fins.count, 0);
    sim_fins_free(&fins);
}

/* A wall that coarse ground lacks: its fin has its skyline, wherever it was taken from. */
static void fins_are_the_skyline(void **state)
{
    (void)state;
    static scene s;
    sim_fins fins = { 0 };
    scene_make(&s, wall);
    scene_draw(&s, 0);
    double focal = s.view.camera.focal_q8 / 256.0,
           missing = focal * 800 / AWAY_M + scene_border_px(&s, 200);
    assert_true(fabs(audit(&s).skyline_px_max - missing) < 1.0 / 16);
    give_fin(&fins, 1, SECTOR, AWAY_M - 500, -300, 700);
    draw_fins(&s, &fins);
    sim_audit_result result = audit(&s);
    assert_true(result.skyline_px_max < 2.0 / 16);
    assert_int_equal(result.sky_pixels, 0);
    /* another sector is here, or another set is drawn */
    s.view.fins.sectors = 1u << (SECTOR + 1);
    assert_true(fabs(audit(&s).skyline_px_max - missing) < 1.0 / 16);
    draw_fins(&s, &fins);
    s.view.fins.set = 2;
    assert_true(fabs(audit(&s).skyline_px_max - missing) < 1.0 / 16);
    sim_fins_free(&fins);
    scene_free(&s);
}

/* Half of that wall too high, it stands over the sky. */
static void fins_over_the_sky_are_wrong(void **state)
{
    (void)state;
    static scene s;
    sim_fins fins = { 0 };
    scene_make(&s, wall);
    scene_draw(&s, 0);
    double over = s.view.camera.focal_q8 / 256.0 * 500 / AWAY_M;
    give_fin(&fins, 1, SECTOR, AWAY_M - 500, -300, 1200);
    draw_fins(&s, &fins);
    sim_audit_result result = audit(&s);
    assert_true(fabs(result.skyline_px_max - over) < 2.0 / 16);
    /* 25 pixels: three rows of 30 that are looked at */
    assert_int_equal(result.sky_pixels, 90);
    assert_true(result.square_px[SIM_CAUSE_FAR] > 0);
    s.view.fins.fins = NULL;
    assert_true(audit(&s).square_px[SIM_CAUSE_FAR] == 0);
    sim_fins_free(&fins);
    scene_free(&s);
}

/* What is nearer is seen: the fin before far ground, not the one behind a drawn hill. */
static void fins_hide_and_are_hidden(void **state)
{
    (void)state;
    static scene s;
    sim_cover cover = { 0 };
    sim_mesh mesh;
    sim_fins fins = { 0 };
    scene_flat(&s);
    scene_draw(&s, 0);
    assert_int_equal(sim_mesh_make(&mesh, &s.pack.header.info), FF_OK);
    give_fin(&fins, 1, SECTOR, 2000 - 500, -300, -150); /* its foot on the ground, 150 m high */
    draw_fins(&s, &fins);
    for (int hidden = 0; hidden < 2; hidden++) {
        unsigned seen = 0, across = sim_looked_at(240, SCENE_STEP_PX);
        if (hidden) scene_draw(&s, 190);
        assert_int_equal(sim_cover_make(&cover, &mesh, &s.view.camera, SCENE_STEP_PX, s.view.drawn,
                                        s.view.drawn_count),
                         FF_OK);
        sim_cover_fins(&cover, &s.view.camera, &s.view.fins);
        for (unsigned i = 0; i < across * sim_looked_at(320, SCENE_STEP_PX); i++) {
            if (cover.node[i] != SIM_COVER_FIN) continue;
            assert_true(fabs(cover.closeness[i] * 2000 - 1) < 1e-9);
            seen++;
        }
        /* the fin covers rows 160 + 208 * 50 / 2000 to 160 + 208 * 200 / 2000: two are looked at */
        assert_int_equal(seen, hidden ? 0 : 60);
    }
    sim_fins_free(&fins);
    sim_cover_free(&cover);
    sim_mesh_free(&mesh);
    scene_free(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_strip_is_its_triangles),
        cmocka_unit_test(only_what_may_be_drawn_is_kept),
        cmocka_unit_test(fins_are_the_skyline),
        cmocka_unit_test(fins_over_the_sky_are_wrong),
        cmocka_unit_test(fins_hide_and_are_hidden),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
