/* The integer back end against GL ES on real frames of a client: the same ground, sky, panoramas,
 * images and fog. A pixel agrees when it is within 8/255 of the other picture's, or of one of its
 * eight neighbours there (edges may lie a pixel apart): at most 0.5 % do not. */
#include "../rig/client_fixture.h"
#include "../rig/picture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define MB    ((size_t)1 << 20)
#define METRE FF_WU_PER_METRE
enum { WIDTH = 240, HEIGHT = 320, PIXELS = WIDTH * HEIGHT, HEADINGS = 6, TOLERANCE = 8 };
#define PART_MAX 200 /* one pixel in PART_MAX may disagree */

enum { GLES1, SOFT, SOFT_565, KINDS };
static const char *const kind_name[KINDS] = { "gles1", "soft", "soft, RGB565" };

typedef struct view {
    client_rig rig;
    const sys_surface_api *api;
    sys_surface *surface;
    uint8_t rgb[PIXELS * 3];
} view;
static view views[KINDS];

typedef struct soft_scene {
    const char *name;
    unsigned texture_log2;
    int panorama, fog;
} soft_scene;

static void open_view(view *v, int kind, const soft_scene *scene)
{
    sys_surface_desc desc = { "agrees", WIDTH, HEIGHT, kind == GLES1 ? SYS_GL_ES1 : SYS_GL_NONE };
    v->api = kind == GLES1 ? sys_surface_egl() : sys_surface_memory();
    assert_int_equal(v->api->open(&desc, &v->surface), FF_OK);
    rig_open(&v->rig, scene->texture_log2);
    v->rig.desc.backend = kind == GLES1 ? c3d_backend_gles1() : c3d_backend_soft();
    v->rig.desc.surface_api = v->api;
    v->rig.desc.frame_format = kind == SOFT_565 ? C3D_RGB565 : C3D_RGBA8888;
    v->rig.desc.panorama.enabled = (uint8_t)scene->panorama;
    v->rig.desc.panorama.back_plane_wu = 2000 * METRE;
    v->rig.desc.quality = (ff_quality){ .measure = FF_MEASURE_DISTANCE,
                                        .c_q8 = 6 * 256,
                                        .depth_max = 4,
                                        .sigma_q8 = 320,
                                        .view_wu = 4000 * METRE };
    rig_client(&v->rig, 16 * MB);
    ff_client_set_show(v->rig.client, scene->fog ? 0 : FF_SHOW_NO_FOG);
}

static void close_view(view *v)
{
    (void)v->api->make_current(v->surface);
    rig_close(&v->rig);
    v->api->close(v->surface);
}

static void draw(view *v, int heading)
{
    (void)v->api->make_current(v->surface);
    v->rig.camera.yaw = 3000 + heading * (65536 / HEADINGS);
    v->rig.camera.pitch = -1200 - 900 * (heading % 3);
    v->rig.camera.roll = heading == 4 ? 2000 : 0;
    v->rig.camera.pos_wu[2] = (heading & 1 ? 1900 : 1300) * METRE;
    assert_true(rig_settle(&v->rig, 600));
    ff_client_draw(v->rig.client);
    assert_int_equal(c3d_read_rgb(ff_client_device(v->rig.client), v->rgb), FF_OK);
}

/* Counts colours: a picture that shows next to nothing would agree with anything. */
static int colours_in(const uint8_t *rgb)
{
    uint8_t seen[512] = { 0 };
    int count = 0;
    for (int i = 0; i < PIXELS; i++, rgb += 3) {
        uint8_t *at = &seen[(rgb[0] >> 5) << 6 | (rgb[1] >> 5) << 3 | rgb[2] >> 5];
        count += !*at;
        *at = 1;
    }
    return count;
}

static void write_difference(const char *path, const view *a, const view *b)
{
    static uint8_t wide[PIXELS * 9];
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            int at = (y * WIDTH + x) * 3, difference = 8 * picture_apart(a->rgb + at, b->rgb + at);
            uint8_t *out = wide + (y * WIDTH * 3 + x) * 3;
            memcpy(out, a->rgb + at, 3);
            memcpy(out + WIDTH * 3, b->rgb + at, 3);
            memset(out + WIDTH * 6, difference > 255 ? 255 : difference, 3);
        }
    (void)sys_png_write(path, wide, WIDTH * 3, HEIGHT);
}

static void compare_scene(const soft_scene *scene)
{
    int worst[KINDS] = { 0 }, worst_strict[KINDS] = { 0 };
    for (int kind = 0; kind < KINDS; kind++) open_view(&views[kind], kind, scene);
    for (int heading = 0; heading < HEADINGS; heading++) {
        for (int kind = 0; kind < KINDS; kind++) draw(&views[kind], heading);
        assert_true(colours_in(views[GLES1].rgb) >= 5);
        for (int kind = SOFT; kind < KINDS; kind++) {
            int strict, count = picture_disagreement(views[GLES1].rgb, views[kind].rgb, WIDTH,
                                                     HEIGHT, TOLERANCE, &strict);
            assert_true(rig_same_picture(&views[GLES1].rig, &views[kind].rig));
            if (count >= worst[kind]) {
                char path[128];
                worst[kind] = count;
                (void)snprintf(path, sizeof path, "build/tests/soft-agrees-%s-%d.png", scene->name,
                               kind);
                write_difference(path, &views[GLES1], &views[kind]);
            }
            if (strict > worst_strict[kind]) worst_strict[kind] = strict;
        }
    }
    for (int kind = SOFT; kind < KINDS; kind++) {
        print_message(
            "# %s, %s: at most %.3f %% of pixels disagree (%.3f %% without allowing for edges)\n",
            scene->name, kind_name[kind], 100.0 * worst[kind] / PIXELS,
            100.0 * worst_strict[kind] / PIXELS);
        assert_in_range(worst[kind], 0, PIXELS / PART_MAX);
    }
    for (int kind = 0; kind < KINDS; kind++) close_view(&views[kind]);
}

#define SCENE_TEST(test, ...)                            \
    static void test(void **state)                       \
    {                                                    \
        static const soft_scene scene = { __VA_ARGS__ }; \
        (void)state;                                     \
        compare_scene(&scene);                           \
    }
SCENE_TEST(coloured_ground_agrees, "coloured", 0, 0, 0)
SCENE_TEST(fogged_ground_agrees, "fogged", 0, 0, 1)
SCENE_TEST(images_agree, "images", 5, 0, 0)
SCENE_TEST(fogged_images_agree, "images-fogged", 5, 0, 1)
SCENE_TEST(panoramas_agree, "panorama", 5, 1, 0)

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(coloured_ground_agrees), cmocka_unit_test(fogged_ground_agrees),
        cmocka_unit_test(images_agree),           cmocka_unit_test(fogged_images_agree),
        cmocka_unit_test(panoramas_agree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
