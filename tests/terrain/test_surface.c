/* Off-screen surfaces of several kinds and sizes in one process, and the window where there is a
 * display (tests/platform/window.sh starts one). */
#include "../rig/picture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

static int opens(const sys_surface_api *api, int width, int height, enum sys_gl_kind gl)
{
    sys_surface *surface;
    sys_surface_desc desc = { "surface", width, height, gl };
    int rc = api->open(&desc, &surface);
    if (rc == FF_OK) api->close(surface);
    return rc;
}

static void sizes_and_kinds_out_of_range_are_errors(void **state)
{
    (void)state;
    const sys_surface_api *osmesa = sys_surface_osmesa(), *egl = sys_surface_egl();
    assert_int_equal(opens(osmesa, 0, 10, SYS_GL_DESKTOP), FF_ERR_ARGUMENT);
    assert_int_equal(opens(osmesa, 10, 4097, SYS_GL_DESKTOP), FF_ERR_ARGUMENT);
    assert_int_equal(opens(osmesa, 10, 10, SYS_GL_ES1), FF_ERR_UNSUPPORTED);
    assert_int_equal(opens(egl, -1, 10, SYS_GL_ES1), FF_ERR_ARGUMENT);
    assert_int_equal(opens(osmesa, 1, 1, SYS_GL_DESKTOP), FF_OK);
    assert_int_equal(opens(egl, 1, 1, SYS_GL_ES1), FF_OK);
    assert_int_equal(opens(egl, 2048, 1024, SYS_GL_DESKTOP), FF_OK);
}

static void clear_and_check(picture_kit *kit, uint32_t colour)
{
    uint8_t rgb[32 * 32 * 3];
    kit->frame.clear_colour = colour;
    picture_render(kit, NULL, 0, rgb);
    for (int i = 0; i < kit->width * kit->height; i++)
        for (int j = 0; j < 3; j++) assert_int_equal(rgb[i * 3 + j], colour >> (8 * j) & 0xFF);
}

/* Two of each kind, drawn in turn; then closed one by one, which leaves the others working. */
static void many_surfaces_live_together(void **state)
{
    (void)state;
    static const enum picture_kind kinds[6] = { PICTURE_GL,     PICTURE_GLES1, PICTURE_GL,
                                                PICTURE_EGL_GL, PICTURE_GLES1, PICTURE_GL };
    picture_kit kits[6];
    for (int i = 0; i < 6; i++)
        assert_int_equal(picture_open(&kits[i], kinds[i], 8 + i * 4, 31 - i * 5, 1), FF_OK);
    for (uint32_t round = 0; round < 3; round++)
        for (uint32_t i = 0; i < 6; i++)
            clear_and_check(&kits[i], 0xFF000000u | (round + 1) * 0x102030u * (i + 1));
    for (int closed = 0; closed < 6; closed++) {
        picture_close(&kits[(closed * 5 + 1) % 6]);
        for (int i = closed + 1; i < 6; i++) clear_and_check(&kits[(i * 5 + 1) % 6], 0xFF123456u);
    }
}

/* Switches between two contexts of two libraries: each library would believe that its own context
 * is still current. */
static void two_libraries_take_turns(void **state)
{
    (void)state;
    picture_kit kits[2];
    assert_int_equal(picture_open(&kits[0], PICTURE_GL, 16, 12, 1), FF_OK);
    assert_int_equal(picture_open(&kits[1], PICTURE_GLES1, 12, 16, 1), FF_OK);
    for (uint32_t i = 0; i < 12; i++) clear_and_check(&kits[i & 1], 0xFF000000u | i * 0x0A0B0Cu);
    for (int i = 0; i < 2; i++) picture_close(&kits[i]);
}

static void opening_and_closing_many_times(void **state)
{
    (void)state;
    for (int i = 0; i < 20; i++) {
        picture_kit kit;
        assert_int_equal(picture_open(&kit, i % 2 ? PICTURE_GL : PICTURE_GLES1, 16, 16, 1), FF_OK);
        clear_and_check(&kit, 0xFFA0B0C0u);
        picture_close(&kit);
    }
}

static void draw_in_a_thread(void *arg)
{
    picture_kit kit;
    int *drawn = arg;
    if (picture_open(&kit, *drawn ? PICTURE_GL : PICTURE_GLES1, 16, 12, 1) < 0) return;
    const c3d_draw square = picture_square(&kit, PICTURE_SOUTH, -8 * PICTURE_M, 8 * PICTURE_M,
                                           -8 * PICTURE_M, 16 * PICTURE_M, PICTURE_RED);
    uint8_t rgb[16 * 12 * 3];
    picture_render(&kit, &square, 1, rgb);
    *drawn = rgb[0] == 255 && rgb[1] == 0 ? 2 : 3;
    picture_close(&kit);
}

static void threads_have_contexts_of_their_own(void **state)
{
    (void)state;
    picture_kit kit;
    sys_thread threads[2];
    int drawn[2] = { 0, 1 };
    assert_int_equal(picture_open(&kit, PICTURE_GL, 16, 12, 1), FF_OK);
    for (int i = 0; i < 2; i++)
        assert_int_equal(sys_thread_start(&threads[i], draw_in_a_thread, &drawn[i]), FF_OK);
    for (int i = 0; i < 20; i++) clear_and_check(&kit, 0xFF000000u + (uint32_t)i);
    for (int i = 0; i < 2; i++) sys_thread_join(&threads[i]);
    assert_int_equal(drawn[0], 2);
    assert_int_equal(drawn[1], 2);
    clear_and_check(&kit, 0xFF445566u);
    picture_close(&kit);
}

static void surfaces_hand_out_injected_events(void **state)
{
    (void)state;
    static const enum picture_kind kinds[2] = { PICTURE_GL, PICTURE_GLES1 };
    for (int i = 0; i < 2; i++) {
        picture_kit kit;
        sys_event event = { .type = SYS_EVENT_BATTERY, .u.battery = { 7, 1 } }, taken;
        assert_int_equal(picture_open(&kit, kinds[i], 16, 12, 1), FF_OK);
        assert_int_equal(kit.api->poll(kit.surface, &taken), 0);
        assert_int_equal(sys_event_inject(&event), FF_OK);
        assert_int_equal(kit.api->poll(kit.surface, &taken), 1);
        assert_int_equal(taken.type, SYS_EVENT_BATTERY);
        assert_int_equal(taken.u.battery.percent, 7);
        assert_int_equal(kit.api->poll(kit.surface, &taken), 0);
        picture_close(&kit);
    }
}

/* ---- the window ---- */

static int has_display(void) { return getenv("DISPLAY") || getenv("WAYLAND_DISPLAY"); }

static void without_a_display_the_window_is_an_error(void **state)
{
    (void)state;
    if (has_display()) skip();
    assert_true(opens(sys_surface_glfw(), 64, 64, SYS_GL_ES1) < 0);
    assert_true(opens(sys_surface_glfw(), 64, 64, SYS_GL_DESKTOP) < 0);
}

static void render_window(enum sys_gl_kind gl, uint8_t *rgb, const char *png)
{
    const struct c3d_backend *backend = gl == SYS_GL_ES1 ? c3d_backend_gles1() : c3d_backend_gl();
    picture_kit kit = { .api = sys_surface_glfw(), .width = 64, .height = 48 };
    sys_surface_desc surface_desc = { "window", 64, 48, gl };
    c3d_desc desc = { .surface_api = kit.api,
                      .mesh_count = 4,
                      .strip_count = 4,
                      .texture_count = 4,
                      .mesh_vertices_max = 16,
                      .strip_indices_max = 64,
                      .use_vertex_buffers = 1 };
    static const uint16_t strip[4] = { 0, 1, 2, 3 };
    static const c3d_vertex corners[4] = { { 0, 0, 0, { 255, 0, 0, 255 } },
                                           { 1, 0, 0, { 0, 255, 0, 255 } },
                                           { 0, 1, 0, { 0, 0, 255, 255 } },
                                           { 1, 1, 0, { 255, 255, 255, 255 } } };
    size_t bytes = c3d_bytes(backend, &desc);
    kit.memory = malloc(bytes);
    assert_int_equal(kit.api->open(&surface_desc, &kit.surface), FF_OK);
    assert_int_equal(c3d_open(backend, &desc, kit.memory, bytes, &kit.device), FF_OK);
    kit.frame.camera = (c3d_camera){ .focal_q8 = c3d_focal_q8(16384, 64),
                                     .width = 64,
                                     .height = 48,
                                     .near_wu = 64,
                                     .far_wu = 65536 };
    kit.frame.clear_colour = 0xFF804020u;
    c3d_draw draw = { .mesh = c3d_mesh_make(kit.device, corners, 4),
                      .strip = c3d_strip_make(kit.device, strip, 4),
                      .origin_wu = { -5 * PICTURE_M, 5 * PICTURE_M, -3 * PICTURE_M },
                      .xy_scale_wu = 10 * PICTURE_M,
                      .z_scale_q16 = 65536,
                      .flags = C3D_DRAW_COLOURED };
    picture_render(&kit, &draw, 1, rgb);
    assert_int_equal(sys_png_write(png, rgb, 64, 48), FF_OK);
    sys_event event = { .type = SYS_EVENT_POSITION }, taken;
    while (kit.api->poll(kit.surface, &taken)) assert_int_not_equal(taken.type, SYS_EVENT_POSITION);
    assert_int_equal(sys_event_inject(&event), FF_OK);
    assert_int_equal(kit.api->poll(kit.surface, &taken), 1);
    assert_int_equal(taken.type, SYS_EVENT_POSITION);
    picture_close(&kit);
}

static void windows_show_the_same_on_both_kinds_of_gl(void **state)
{
    (void)state;
    static uint8_t es1[64 * 48 * 3], desktop[64 * 48 * 3];
    if (!has_display()) skip();
    render_window(SYS_GL_ES1, es1, "build/tests/window-es1.png");
    render_window(SYS_GL_DESKTOP, desktop, "build/tests/window-gl.png");
    int differ = 0;
    for (size_t i = 0; i < sizeof es1; i++) differ += abs(es1[i] - desktop[i]) > 2;
    assert_true(differ < (int)sizeof es1 / 100);
    assert_memory_equal(es1, "\040\100\200", 3);
    assert_true(es1[(42 * 64 + 3) * 3] > 128); /* red in the south-west corner */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sizes_and_kinds_out_of_range_are_errors),
        cmocka_unit_test(many_surfaces_live_together),
        cmocka_unit_test(two_libraries_take_turns),
        cmocka_unit_test(opening_and_closing_many_times),
        cmocka_unit_test(threads_have_contexts_of_their_own),
        cmocka_unit_test(surfaces_hand_out_injected_events),
        cmocka_unit_test(without_a_display_the_window_is_an_error),
        cmocka_unit_test(windows_show_the_same_on_both_kinds_of_gl),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
