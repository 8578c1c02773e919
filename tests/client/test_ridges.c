/* What ridges hide from where a far set was taken: ground behind a fin and below its line. */
#include "../../client/far/ff_ridges.h"
#include "../../protocol/ff_terrain.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#define M FF_WU_PER_METRE

enum { FOCAL = 208, HALF = 41 /* texels of the sector */ };

static ff_ridges ridges;

/* A vertex so many texels above O's horizon. */
static ff_fin_vertex vertex(int column, int up, int32_t distance_m, int begins)
{
    return (ff_fin_vertex){ .column = (int16_t)column,
                            .up_q2 = (int16_t)(4 * up),
                            .distance = (uint16_t)ff_far_distance_step(distance_m * M),
                            .begins = (uint8_t)begins };
}

/* Whether a place is hidden that stands at a column and so many texels up. */
static int hidden(int column, int up, int32_t distance_m)
{
    int64_t forward = (int64_t)distance_m * M;
    return ff_ridges_hide(&ridges, forward, forward * column / FOCAL, forward * up / FOCAL);
}

static void ground_behind_a_ridge_and_below_its_line_is_hidden(void **state)
{
    (void)state;
    const ff_fin_vertex fin[] = { vertex(-HALF - 1, 20, 10000, 1), vertex(HALF + 1, 20, 10000, 0) };
    ff_ridges_make(&ridges, FOCAL, fin, 2);
    for (int column = -HALF; column < HALF; column += 3) {
        assert_true(hidden(column, 18, 12000) && hidden(column, -100, 200000));
        assert_false(hidden(column, 18, 9000));  /* its own side */
        assert_false(hidden(column, 18, 10500)); /* as coarse ground has it */
        assert_false(hidden(column, 23, 12000) || hidden(column, 23, 200000));
    }
    assert_false(hidden(HALF + 2, 0, 20000) || hidden(-HALF - 2, 0, 20000));
    assert_false(ff_ridges_hide(&ridges, -20000 * M, 0, 0));
    assert_false(ff_ridges_hide(&ridges, 0, 0, 0));
}

/* It rises from left to right, and goes away; it ends before the sector does. */
static void a_line_hides_where_it_runs(void **state)
{
    (void)state;
    const ff_fin_vertex fin[] = { vertex(-30, 0, 8000, 1), vertex(10, 40, 16000, 0),
                                  vertex(-30, -60, 4000, 1), vertex(-29, -60, 4000, 0) };
    ff_ridges_make(&ridges, FOCAL, fin, 4);
    for (int column = -28; column < 8; column++) {
        int line = column + 30;
        assert_true(hidden(column, line - 3, 19000));
        assert_false(hidden(column, line + 4, 19000));
    }
    assert_true(hidden(-20, 5, 12000));
    assert_false(hidden(5, 5, 12000)); /* there it is farther away */
    for (int column = 12; column < HALF; column++) assert_false(hidden(column, -80, 19000));
    for (int column = -HALF; column < -32; column++) assert_false(hidden(column, -80, 19000));
}

/* Whatever their order. */
static void of_several_ridges_the_highest_before_it_hides(void **state)
{
    (void)state;
    static const struct {
        int up, distance_m;
    } line[3] = { { -20, 8000 }, { 0, 16000 }, { 10, 40000 } };
    static const int order[6][3] = { { 0, 1, 2 }, { 0, 2, 1 }, { 1, 0, 2 },
                                     { 1, 2, 0 }, { 2, 0, 1 }, { 2, 1, 0 } };
    for (int i = 0; i < 6; i++) {
        ff_fin_vertex fin[6];
        for (int k = 0; k < 6; k++) {
            int of = order[i][k / 2];
            fin[k] = vertex(k % 2 ? HALF : -HALF, line[of].up, line[of].distance_m, k % 2 == 0);
        }
        ff_ridges_make(&ridges, FOCAL, fin, 6);
        assert_true(hidden(0, -23, 12000));
        assert_false(hidden(0, -10, 12000));
        assert_true(hidden(0, -10, 30000));
        assert_false(hidden(0, 5, 30000));
        assert_true(hidden(0, 5, 60000));
        assert_false(hidden(0, 15, 60000));
    }
}

/* Where there are more than there is room for, nothing is hidden that is seen, and the highest
 * hides what it hides. */
static void of_too_many_ridges_some_hide_nothing(void **state)
{
    (void)state;
    enum { LINES = 3 * FF_RIDGES_LINES };
    int32_t distance_m[LINES] = { 6000 };
    for (int of = 1; of < LINES; of++) distance_m[of] = distance_m[of - 1] * 5 / 4;
    for (int upward = 0; upward < 2; upward++) {
        ff_fin_vertex fin[2 * LINES];
        for (int k = 0; k < 2 * LINES; k++) {
            int of = upward ? k / 2 : LINES - 1 - k / 2;
            fin[k] = vertex(k % 2 ? HALF : -HALF, 4 * of - 40, distance_m[of], k % 2 == 0);
        }
        ff_ridges_make(&ridges, FOCAL, fin, 2 * LINES);
        for (int of = 0; of < LINES; of++)
            assert_false(hidden(0, 4 * of - 40 + 3, distance_m[of] * 8 / 7));
        assert_true(hidden(0, 4 * (LINES - 1) - 40 - 3, distance_m[LINES - 1] * 8 / 7));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ground_behind_a_ridge_and_below_its_line_is_hidden),
        cmocka_unit_test(a_line_hides_where_it_runs),
        cmocka_unit_test(of_several_ridges_the_highest_before_it_hides),
        cmocka_unit_test(of_too_many_ridges_some_hide_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
