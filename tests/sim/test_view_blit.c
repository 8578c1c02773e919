/* The integer back end's picture in a window of the desktop emulator. */
#include "../rig/picture.h"
#include "../../sim/view/view_blit.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#define M PICTURE_M

/* An overlay drawn by the window's GL, here at twice the size. */
static void a_picture_reaches_a_window(void **state)
{
    (void)state;
    static uint8_t drawn[16 * 12 * 3], shown[32 * 24 * 3];
    picture_kit kit;
    view_blit blit;
    sys_surface *window;
    sys_surface_desc desc = { "window", 32, 24, SYS_GL_ES1 };
    assert_int_equal(picture_open(&kit, PICTURE_SOFT, 16, 12, 0), FF_OK);
    c3d_draw draw = picture_square(&kit, PICTURE_SOUTH, -4 * M, 8 * M, -4 * M, 4 * M, PICTURE_RED);
    picture_render(&kit, &draw, 1, drawn);
    assert_int_equal(sys_surface_egl()->open(&desc, &window), FF_OK);
    assert_int_equal(view_blit_open(&blit, c3d_backend_gles1(), sys_surface_egl(), 16, 12), FF_OK);
    blit.window_width = 32;
    blit.window_height = 24;
    assert_int_equal(view_blit_show(&blit, kit.device), FF_OK);
    assert_int_equal(c3d_read_rgb(blit.device, shown), FF_OK);
    for (int y = 1; y < 23; y++)
        for (int x = 1; x < 31; x++) {
            int inside = y / 2 > 6 && y / 2 < 9 && x / 2 > 4 && x / 2 < 7,
                outside = y / 2 < 5 || y / 2 > 10 || x / 2 < 3 || x / 2 > 8;
            if (inside || outside)
                assert_int_equal(shown[(y * 32 + x) * 3], drawn[(y / 2 * 16 + x / 2) * 3]);
        }
    view_blit_close(&blit);
    sys_surface_egl()->close(window);
    picture_close(&kit);
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(a_picture_reaches_a_window) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
