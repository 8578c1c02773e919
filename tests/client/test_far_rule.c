/* The rule of FF_FAR_AUTO by its numbers. */
#include "../../client/far/ff_far_rule.h"
#include "../../client/farfield.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#define M FF_WU_PER_METRE

static const ff_far_choice none = { FF_FAR_OFF, 0, 0 }, paint = { FF_FAR_PAINT, 0, 0 };

/* 240x320 over mountains: a tenth of the picture is far, the skyline is off by 4 pixels. At 50 m/s
 * on 3000 bytes a second all of it may be had. */
static const ff_far_case usual = { .ground = { .pixels = { 20000, 12000, 7680, 3840, 1920, 960,
                                                           480 },
                                               .error_q8 = 768,
                                               .skyline_q8 = 1024,
                                               .nodes = 40,
                                               .far_nodes = 16 },
                                   .window = 76800,
                                   .width = 240,
                                   .coarse = 1,
                                   .triangles = 5000,
                                   .triangles_max = 5485,
                                   .asked_px_q8 = 512,
                                   .ground_px_q8 = 1536,
                                   .life_wu = 3200 * M,
                                   .speed_wu_s = 50 * M,
                                   .link_bytes_s = 3000 };

static int is(ff_far_choice choice, uint8_t use, int rung, uint8_t shift)
{
    return choice.use == use && choice.rung == rung && choice.shift == shift;
}

static void mountains_under_a_limit_of_triangles_have_a_set(void **state)
{
    (void)state;
    assert_true(is(ff_far_choose(&usual, &none), FF_FAR_PAINT, 0, 0));
    assert_true(is(ff_far_choose(&usual, &paint), FF_FAR_PAINT, 0, 0));
}

static void a_right_skyline_needs_none(void **state)
{
    (void)state;
    ff_far_case c = usual;
    c.has_images = 1;
    c.ground.skyline_q8 = 448;
    assert_true(ff_far_choose(&c, &none).use);
    c.ground.skyline_q8 = 447;
    assert_false(ff_far_choose(&c, &none).use);
    assert_true(ff_far_choose(&c, &paint).use); /* who has one keeps it a while */
    c.ground.skyline_q8 = 204;
    assert_false(ff_far_choose(&c, &paint).use);
}

/* Bare ground takes its shading from its shape: 5.5 pixels off in a tenth of the picture. */
static void bare_ground_needs_one_for_its_shading(void **state)
{
    (void)state;
    ff_far_case c = usual;
    c.ground.skyline_q8 = 0;
    c.ground.error_q8 = 1420;
    assert_true(ff_far_choose(&c, &none).use);
    c.has_images = 1;
    assert_false(ff_far_choose(&c, &none).use);
    c.has_images = 0;
    c.ground.error_q8 = 1400;
    assert_false(ff_far_choose(&c, &none).use);
    assert_true(ff_far_choose(&c, &paint).use);
}

static void where_hardly_any_far_ground_shows_fins_do(void **state)
{
    (void)state;
    ff_far_case c = usual;
    c.ground.pixels[FF_FAR_NEARER] = 383;
    assert_true(is(ff_far_choose(&c, &none), FF_FAR_FINS, 0, 0));
    assert_true(is(ff_far_choose(&c, &paint), FF_FAR_PAINT, 0, 0));
    c.ground.pixels[FF_FAR_NEARER] = 76;
    assert_false(ff_far_choose(&c, &none).use);
    assert_true(is(ff_far_choose(&c, &paint), FF_FAR_FINS, 0, 0));
    c.ground.pixels[FF_FAR_NEARER] = 38;
    assert_false(ff_far_choose(&c, &paint).use);
    c = usual;
    c.no_paint = 1;
    assert_true(is(ff_far_choose(&c, &paint), FF_FAR_FINS, 0, 0));
}

/* A set of 360 + 600 + 1920 bytes each 3200 m, and what takes less of the link. */
static void a_thinner_link_or_a_faster_flight_has_less(void **state)
{
    (void)state;
    static const struct {
        int32_t speed_m_s;
        ff_far_choice is;
    } at[] = { { 800, { FF_FAR_PAINT, 0, 0 } },  { 900, { FF_FAR_PAINT, 1, 0 } },
               { 1700, { FF_FAR_PAINT, 1, 0 } }, { 2000, { FF_FAR_PAINT, 2, 0 } },
               { 4000, { FF_FAR_PAINT, 2, 1 } }, { 6600, { FF_FAR_FINS, 0, 0 } },
               { 12000, { FF_FAR_FINS, 2, 0 } }, { 14000, { FF_FAR_OFF, 0, 0 } } };
    for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
        ff_far_case c = usual;
        c.speed_wu_s = (int64_t)at[i].speed_m_s * M;
        ff_far_choice choice = ff_far_choose(&c, &at[i].is);
        assert_true(is(choice, at[i].is.use, at[i].is.rung, at[i].is.shift));
        c.link_bytes_s /= 10;
        c.speed_wu_s /= 10;
        choice = ff_far_choose(&c, &at[i].is);
        assert_true(is(choice, at[i].is.use, at[i].is.rung, at[i].is.shift));
    }
    /* more than was chosen only with room to spare */
    ff_far_case c = usual;
    const ff_far_choice farther = { FF_FAR_PAINT, 1, 0 };
    c.speed_wu_s = 800 * M;
    assert_true(is(ff_far_choose(&c, &farther), FF_FAR_PAINT, 1, 0));
    c.speed_wu_s = 550 * M;
    assert_true(is(ff_far_choose(&c, &farther), FF_FAR_PAINT, 0, 0));
}

/* 360 + 600 + 5000 bytes each 1600 m; with a front 1.4 times as far 360 + 600 + 3000 each 2263. */
static void who_stays_or_walks_has_a_nearer_front(void **state)
{
    (void)state;
    ff_far_case c = usual;
    c.speed_wu_s = 0;
    assert_true(is(ff_far_choose(&c, &paint), FF_FAR_PAINT, -2, 0));
    c.speed_wu_s = 26 * M / 10;
    const ff_far_choice nearest = { FF_FAR_PAINT, -2, 0 };
    assert_true(is(ff_far_choose(&c, &nearest), FF_FAR_PAINT, -2, 0));
    assert_true(is(ff_far_choose(&c, &paint), FF_FAR_PAINT, -1, 0));
    c.speed_wu_s = 3 * M;
    assert_true(is(ff_far_choose(&c, &nearest), FF_FAR_PAINT, -1, 0));
    c.speed_wu_s = 6 * M;
    assert_true(is(ff_far_choose(&c, &nearest), FF_FAR_PAINT, 0, 0));
    c.speed_wu_s = 0;
    c.ground.pixels[0] = 36200; /* 10 kB in all, and a little more */
    assert_true(is(ff_far_choose(&c, &nearest), FF_FAR_PAINT, -1, 0));
    c.has_images = 1;
    assert_true(is(ff_far_choose(&c, &paint), FF_FAR_PAINT, 0, 0));
}

/* A sixteenth of the link is 187 bytes a second. */
static void who_lacks_triangles_has_a_nearer_front(void **state)
{
    (void)state;
    ff_far_case c = usual;
    const ff_far_choice nearest = { FF_FAR_PAINT, -2, 0 };
    c.has_images = 1;
    c.speed_wu_s = 45 * M;
    assert_true(is(ff_far_choose(&c, &nearest), FF_FAR_PAINT, 0, 0));
    c.ground_px_q8 = 4 * c.asked_px_q8;
    assert_true(is(ff_far_choose(&c, &nearest), FF_FAR_PAINT, -2, 0));
    c.speed_wu_s = 60 * M;
    assert_true(is(ff_far_choose(&c, &nearest), FF_FAR_PAINT, -1, 0));
    c.speed_wu_s = 120 * M;
    assert_true(is(ff_far_choose(&c, &nearest), FF_FAR_PAINT, 0, 0));
}

/* While sets are drawn far ground is coarse for their sake: with as many triangles as it could have
 * it would be right. */
static void triangles_in_plenty_need_none(void **state)
{
    (void)state;
    ff_far_case c = usual;
    c.has_images = 1;
    c.coarse = 4;
    c.ground_px_q8 = c.asked_px_q8;
    c.ground.skyline_q8 = 700;
    assert_true(ff_far_choose(&c, &paint).use);
    c.triangles_max = 20000;
    assert_false(ff_far_choose(&c, &paint).use);
    c.triangles_max = 0;
    assert_false(ff_far_choose(&c, &paint).use);
}

/* Extreme numbers: nothing overflows, and nothing is asked for that could not come. */
static void the_rule_bears_any_numbers(void **state)
{
    (void)state;
    ff_far_case c = usual;
    for (unsigned i = 0; i < FF_FAR_RUNGS; i++) c.ground.pixels[i] = 8192 * 8192;
    c.window = 8192 * 8192;
    c.width = 8192;
    c.coarse = 16;
    c.ground.error_q8 = c.ground.skyline_q8 = 12800;
    c.ground.nodes = c.ground.far_nodes = UINT32_MAX;
    c.triangles = UINT32_MAX;
    c.asked_px_q8 = c.ground_px_q8 = INT32_MAX;
    c.speed_wu_s = INT64_C(10000000) * M;
    c.link_bytes_s = UINT32_MAX;
    (void)ff_far_choose(&c, &none);
    c.link_bytes_s = 1;
    assert_false(ff_far_choose(&c, &none).use);
    c = (ff_far_case){ .life_wu = 1 };
    assert_false(ff_far_choose(&c, &paint).use);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mountains_under_a_limit_of_triangles_have_a_set),
        cmocka_unit_test(a_right_skyline_needs_none),
        cmocka_unit_test(bare_ground_needs_one_for_its_shading),
        cmocka_unit_test(where_hardly_any_far_ground_shows_fins_do),
        cmocka_unit_test(a_thinner_link_or_a_faster_flight_has_less),
        cmocka_unit_test(who_stays_or_walks_has_a_nearer_front),
        cmocka_unit_test(who_lacks_triangles_has_a_nearer_front),
        cmocka_unit_test(triangles_in_plenty_need_none),
        cmocka_unit_test(the_rule_bears_any_numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
