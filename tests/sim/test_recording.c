/* Recorded flights: reading them, and where the viewer is between two lines. tests/sim/fly.sh tests
 * the error messages. */
#include "../../sim/fly/fly_recording.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void read_text(fly_recording *recording, const char *text)
{
    char path[] = "/tmp/test_recording_XXXXXX";
    int fd = mkstemp(path);
    assert_true(fd >= 0);
    assert_int_equal(write(fd, text, strlen(text)), (ssize_t)strlen(text));
    close(fd);
    assert_int_equal(fly_recording_read(recording, path), 0);
    unlink(path);
}

static int near(double a, double b) { return fabs(a - b) < 1e-9; }

static void between_lines_is_interpolated(void **state)
{
    (void)state;
    fly_recording recording;
    fly_fix fix;
    read_text(
        &recording,
        "t_s,x_m,y_m,z_m,heading_deg,pitch_deg\n10,100,200,50,350,-10\n14,300,200,70,10,10\n");
    assert_int_equal(recording.count, 2);
    assert_false(recording.above_ground);
    fly_recording_at(&recording, 11, &fix);
    assert_true(near(fix.x_m, 150) && near(fix.y_m, 200) && near(fix.up_m, 55));
    assert_true(near(fix.heading_deg, 355) && near(fix.pitch_deg, -5)); /* by way of north */
    fly_recording_at(&recording, 0, &fix);
    assert_true(near(fix.x_m, 100) && near(fix.heading_deg, 350));
    fly_recording_at(&recording, 14, &fix);
    assert_true(near(fix.x_m, 300) && near(fix.heading_deg, 10));
    fly_recording_at(&recording, 1e6, &fix);
    assert_true(near(fix.x_m, 300) && near(fix.up_m, 70));
    fly_recording_free(&recording);
}

/* Columns may stand in any order, and unknown ones are skipped. Without headings the viewer looks
 * where he goes, and when he stands still he looks as before. */
static void columns_may_stand_in_any_order(void **state)
{
    (void)state;
    fly_recording recording;
    read_text(&recording,
              "y_m,name,h_m,t_s,x_m\r\n0,a b,5,0,0\r\n10,,5,1,0\r\n10,,5,2,-10\r\n10,,5,3,-10\r\n");
    assert_int_equal(recording.count, 4);
    assert_true(recording.above_ground);
    static const double heading_deg[] = { 0, -90, -90, -90 };
    for (size_t i = 0; i < 4; i++)
        assert_true(near(recording.fix[i].heading_deg, heading_deg[i]) &&
                    near(recording.fix[i].pitch_deg, -6));
    fly_recording_free(&recording);
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(between_lines_is_interpolated),
                                        cmocka_unit_test(columns_may_stand_in_any_order) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
