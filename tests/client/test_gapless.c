/* No gap between nodes in the picture: ground drawn over magenta leaves none of it below the first
 * ground of a column of pixels, on any back end. The integer mesh is whole (test_watertight); this
 * asks whether vertices that are shared stay shared once a graphics library has projected them. */
#include "../../client/ff_client_local.h"
#include "../../common3d/c3d_backend.h"
#include "../rig/pack_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH = 1024, HEIGHT = 256, VIEWS = 250, BLOCK = 4 << 20 };
#define MAGENTA 0xFFFF00FFu

typedef struct gap_rig {
    const sys_surface_api *api;
    sys_surface *surface;
    uint8_t *pack_bytes, *block, *rgb;
    ff_pack pack;
    ff_client *client;
} gap_rig;

static void meadow(void *context, int64_t x_wu, int64_t y_wu, uint8_t rgb[3])
{
    (void)context, (void)x_wu, (void)y_wu;
    rgb[0] = 60, rgb[1] = 150, rgb[2] = 40;
}

static void open_rig(gap_rig *rig, const sys_surface_api *api, enum sys_gl_kind gl,
                     const struct c3d_backend *backend, int images)
{
    size_t bytes;
    sys_surface_desc surface = { "test", WIDTH, HEIGHT, gl };
    pack_fixture_desc pack = { .info = pack_fixture_info(6, 8, 8), .height = pack_fixture_hills };
    pack.info.spacing_wu = 19913; /* not a power of two: products round */
    pack.info.samples_x -= 37;    /* the ground ends within its tiles */
    pack.info.samples_y -= 22;
    pack.info.texture_log2 = images ? 5 : 0;
    pack.info.texture_levels = images ? 1 : 0;
    pack.colour = meadow;
    memset(rig, 0, sizeof *rig);
    rig->api = api;
    assert_int_equal(api->open(&surface, &rig->surface), FF_OK);
    rig->pack_bytes = pack_fixture_make(&pack, &bytes);
    assert_int_equal(ff_pack_open(&rig->pack, rig->pack_bytes, bytes), FF_OK);
    rig->block = malloc(BLOCK);
    rig->rgb = malloc(WIDTH * HEIGHT * 3);
    ff_client_desc desc = { .memory = rig->block,
                            .memory_bytes = BLOCK,
                            .pack = &rig->pack,
                            .backend = backend,
                            .surface_api = api,
                            .width = WIDTH,
                            .height = HEIGHT };
    desc.quality = (ff_quality){ .measure = FF_MEASURE_PIXELS,
                                 .error_px_q8 = 256,
                                 .sigma_q8 = 320,
                                 .view_wu = 60000 * FF_WU_PER_METRE }; /* all there is */
    assert_int_equal(ff_client_create(&desc, &rig->client), FF_OK);
}

static void close_rig(gap_rig *rig)
{
    ff_client_destroy(rig->client);
    rig->api->close(rig->surface);
    free(rig->pack_bytes);
    free(rig->block);
    free(rig->rgb);
}

/* Low over the middle of the terrain or by its edge, looking in any direction: far ground is seen
 * at grazing angles. */
static c3d_camera camera_at(sys_random *random, int by_edge)
{
    c3d_camera camera = { .yaw = (int32_t)sys_random_below(random, 65536),
                          .pitch = -(int32_t)sys_random_below(random, 800),
                          .width = WIDTH,
                          .height = HEIGHT,
                          .focal_q8 = c3d_focal_q8(10923, WIDTH) };
    for (int axis = 0; axis < 2; axis++)
        camera.pos_wu[axis] =
            ((by_edge ? 30800 : 17000) + (int32_t)sys_random_below(random, 6000)) * FF_WU_PER_METRE;
    camera.pos_wu[2] = (1500 + (int32_t)sys_random_below(random, 300)) * FF_WU_PER_METRE;
    return camera;
}

/* The client's ground, without sky or panorama behind it. */
static void draw_ground(gap_rig *rig, const c3d_camera *camera)
{
    c3d_frame frame = { .camera = *camera, .clear_colour = MAGENTA };
    frame.camera.near_wu = 16 * FF_WU_PER_METRE;
    frame.camera.far_wu = 100000 * FF_WU_PER_METRE;
    c3d_begin(rig->client->device, &frame);
    const ff_drawn *list;
    uint32_t count = ff_tree_drawn(rig->client->tree, &list);
    ff_terrain_view_draw(&rig->client->view, list, count, camera, 0);
    c3d_end(rig->client->device);
    assert_int_equal(c3d_read_rgb(rig->client->device, rig->rgb), FF_OK);
}

static int is_magenta(const uint8_t *rgb) { return rgb[0] == 255 && rgb[1] == 0 && rgb[2] == 255; }

/* Magenta pixels that have ground above them in their column. */
static unsigned gaps_in(const uint8_t *rgb)
{
    unsigned count = 0;
    for (unsigned column = 0; column < WIDTH; column++) {
        int ground = 0;
        for (unsigned row = 0; row < HEIGHT; row++) {
            int empty = is_magenta(rgb + 3 * (row * WIDTH + column));
            count += (unsigned)(empty && ground);
            ground |= !empty;
        }
    }
    return count;
}

static void count_gaps(const sys_surface_api *api, enum sys_gl_kind gl,
                       const struct c3d_backend *backend, int images)
{
    gap_rig rig;
    sys_random random;
    unsigned gaps = 0, stitched = 0;
    int64_t now_us = 0;
    sys_random_seed(&random, 7, 1);
    open_rig(&rig, api, gl, backend, images);
    for (int i = 0; i < VIEWS; i++) {
        c3d_camera camera = camera_at(&random, i % 3 == 2);
        for (int step = 0; step < 12; step++, now_us += 33000) {
            ff_client_work(rig.client, now_us);
            ff_client_update(rig.client, now_us, &camera);
        }
        ff_client_stats stats;
        draw_ground(&rig, &camera);
        ff_client_get_stats(rig.client, &stats);
        stitched += stats.tree.stitched;
        gaps += gaps_in(rig.rgb);
    }
    print_message("# %s%s: %u views, %u stitched nodes, %u gaps\n", backend->name,
                  images ? " under images" : "", VIEWS, stitched, gaps);
    assert_true(stitched > VIEWS && rig.client->has_textures == images);
    assert_int_equal(gaps, 0);
    close_rig(&rig);
}

static void no_gap_with_gl(void **state)
{
    (void)state;
    count_gaps(sys_surface_osmesa(), SYS_GL_DESKTOP, c3d_backend_gl(), 0);
}

static void no_gap_with_gles1(void **state)
{
    (void)state;
    count_gaps(sys_surface_egl(), SYS_GL_ES1, c3d_backend_gles1(), 0);
}

static void no_gap_with_integers(void **state)
{
    (void)state;
    count_gaps(sys_surface_memory(), SYS_GL_NONE, c3d_backend_soft(), 0);
    /* triangles of these kinds have code of their own */
    count_gaps(sys_surface_memory(), SYS_GL_NONE, c3d_backend_soft(), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(no_gap_with_gl),
                                        cmocka_unit_test(no_gap_with_gles1),
                                        cmocka_unit_test(no_gap_with_integers) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
