/* What the client draws: all of the cut, the panorama where it belongs, the same picture from
 * buffers and from plain arrays. */
#include "../rig/client_fixture.h"
#include "../../client/ff_client_local.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define MB                ((size_t)1 << 20)
#define METRE             FF_WU_PER_METRE
#define WIDTH             240
#define HEIGHT            320
#define SKY_TRIANGLES_MAX 165

static sys_surface *surface;

static int open_surface(void **state)
{
    (void)state;
    sys_surface_desc desc = { "test", WIDTH, HEIGHT, SYS_GL_DESKTOP };
    return !sys_surface_osmesa() || sys_surface_osmesa()->open(&desc, &surface) != FF_OK;
}

static int close_surface(void **state)
{
    (void)state;
    sys_surface_osmesa()->close(surface);
    return 0;
}

static void open_rig(client_rig *rig, unsigned texture_log2)
{
    rig_open(rig, texture_log2);
    rig->desc.backend = c3d_backend_gl();
    rig->desc.surface_api = sys_surface_osmesa();
}

static uint8_t *draw(client_rig *rig)
{
    uint8_t *rgb = calloc(WIDTH * HEIGHT, 3);
    ff_client_draw(rig->client);
    assert_int_equal(c3d_read_rgb(ff_client_device(rig->client), rgb), FF_OK);
    return rgb;
}

static unsigned count_colour(const uint8_t *rgb, int r, int g, int b, int within)
{
    unsigned count = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++, rgb += 3)
        count += abs(rgb[0] - r) <= within && abs(rgb[1] - g) <= within &&
                 abs(rgb[2] - b) <= within;
    return count;
}

static void all_of_the_cut_is_drawn(void **state)
{
    (void)state;
    client_rig rig;
    open_rig(&rig, 5);
    rig_client(&rig, 4 * MB);
    assert_true(rig_settle(&rig, 600));
    uint8_t *first = draw(&rig), *again = draw(&rig);
    ff_client_stats stats = rig_stats(&rig);
    assert_in_range(stats.c3d.frame_triangles, stats.tree.triangles,
                    stats.tree.triangles + SKY_TRIANGLES_MAX);
    assert_int_equal(stats.c3d.stale_handles, 0);
    assert_memory_equal(first, again, WIDTH * HEIGHT * 3);
    free(first);
    free(again);
    rig_close(&rig);
}

/* Images are drawn down to their finest level, whether ground has nodes of it or not: the same
 * ground and images in nodes of 8 cells, three levels of them, and of 32, two. */
static void images_finer_than_nodes_are_drawn(void **state)
{
    (void)state;
    uint8_t *picture[2];
    for (int large = 0; large < 2; large++) {
        client_rig rig;
        open_rig(&rig, 5);
        if (large) rig_use_node_log2(&rig, 5, 5);
        rig.desc.quality = (ff_quality){ .error_px_q8 = 1,
                                         .measure = FF_MEASURE_PIXELS,
                                         .triangles_max = 1000000,
                                         .view_wu = INT32_MAX };
        rig.camera.pitch = -12000;
        rig_client(&rig, 16 * MB);
        assert_true(rig_settle(&rig, 900));
        unsigned finest = 0;
        for (unsigned i = 0; i < rig.client->textures.slot_count; i++) {
            const ff_texture_slot *slot = &rig.client->textures.slot[i];
            finest += slot->tag && ff_key_level(slot->key) == 2;
        }
        assert_true(finest > 4);
        picture[large] = draw(&rig);
        rig_close(&rig);
    }
    unsigned sum = 0;
    for (int i = 0; i < WIDTH * HEIGHT * 3; i++)
        sum += (unsigned)abs(picture[0][i] - picture[1][i]);
    assert_true(sum < WIDTH * HEIGHT * 3 / 4);
    free(picture[0]);
    free(picture[1]);
}

static void plain_arrays_draw_the_same(void **state)
{
    (void)state;
    uint8_t *picture[2];
    uint64_t hash[2];
    for (int plain = 0; plain < 2; plain++) {
        client_rig rig;
        open_rig(&rig, 5);
        rig.desc.use_plain_arrays = (uint8_t)plain;
        rig_client(&rig, 4 * MB);
        assert_true(rig_settle(&rig, 600));
        picture[plain] = draw(&rig);
        hash[plain] = ff_client_geometry_hash(rig.client);
        assert_int_equal(rig_stats(&rig).c3d.vertex_buffers_used, !plain);
        rig_close(&rig);
    }
    assert_memory_equal(picture[0], picture[1], WIDTH * HEIGHT * 3);
    assert_int_equal(hash[0], hash[1]);
    free(picture[0]);
    free(picture[1]);
}

/* Sky above, the colour of bare ground far below the horizon, nothing black anywhere. */
static void expect_sky(client_rig *rig)
{
    uint8_t *rgb = draw(rig);
    for (int i = 0; i < WIDTH * HEIGHT; i++) assert_true(rgb[3 * i] > 80);
    for (int i = 0; i < WIDTH * HEIGHT / 3; i++) assert_true(rgb[3 * i + 2] > rgb[3 * i] + 20);
    assert_true(count_colour(rgb, 138, 126, 102, 5) > WIDTH * HEIGHT / 8);
    free(rgb);
}

static void sky_stands_until_a_terrain_is_known(void **state)
{
    (void)state;
    for (int kind = 0; kind < 3; kind++) {
        client_rig rig;
        ff_panorama_desc panorama = { .enabled = 1 };
        open_rig(&rig, 0);
        if (kind) rig.desc.backend = c3d_backend_soft();
        if (kind == 2) rig.desc.frame_format = C3D_RGBA8888;
        rig.camera.pitch = 0;
        rig.silent_at = 0;
        rig_client(&rig, 4 * MB);
        rig_step(&rig, 50000);
        assert_null(ff_client_terrain(rig.client));
        assert_int_equal(rig.updates, 1);
        expect_sky(&rig);
        rig_step(&rig, 50000);
        assert_int_equal(rig.updates, 1); /* the same sky */
        rig.camera.roll += 100;
        rig_step(&rig, 50000);
        assert_int_equal(rig.updates, 2);
        rig.silent_at = UINT64_MAX;
        rig.camera.roll = 0;
        assert_true(rig_settle(&rig, 600) && rig_stats(&rig).tree.nodes_drawn > 0);
        ff_client_set_panorama(rig.client, &panorama); /* the block is shared out anew */
        assert_null(ff_client_terrain(rig.client));
        expect_sky(&rig);
        assert_true(rig_settle(&rig, 600) && rig_stats(&rig).tree.nodes_drawn > 0);
        assert_int_equal(rig_stats(&rig).c3d.stale_handles, 0);
        rig_close(&rig);
    }
}

/* Where rounding leaves a pixel between two nodes empty nothing bright shines through: below the
 * horizon the backdrop looks like ground. */
static void no_sky_below_the_horizon(void **state)
{
    (void)state;
    client_rig rig;
    open_rig(&rig, 0);
    rig_client(&rig, 4 * MB);
    assert_true(rig_settle(&rig, 600));
    rig.camera.pos_wu[0] = rig.camera.pos_wu[1] = -1000 * METRE; /* the terrain is behind */
    rig.camera.yaw = 5 * 65536 / 8;
    rig.camera.pitch = -65536 / 5;
    rig_settle(&rig, 20);
    uint8_t *rgb = draw(&rig);
    assert_int_equal(count_colour(rgb, 138, 126, 102, 2), WIDTH * HEIGHT);
    free(rgb);
    rig_close(&rig);
}

/* The least memory is enough for any terrain, with everything on. */
static void least_memory_is_true(void **state)
{
    (void)state;
    for (unsigned node_log2 = 1; node_log2 <= FF_NODE_LOG2_MAX; node_log2++)
        for (int plain = 0; plain < 2; plain++) {
            client_rig rig;
            open_rig(&rig, 8);
            rig_use_node_log2(&rig, node_log2, 5);
            rig.desc.use_plain_arrays = (uint8_t)plain;
            rig.desc.panorama.enabled = 1;
            rig.desc.panorama.face_size = 1024;
            rig_client(&rig, ff_client_bytes_min());
            assert_true(rig_settle(&rig, 3000));
            free(draw(&rig));
            assert_true(rig_stats(&rig).tree.nodes_drawn > 0);
            rig_close(&rig);
        }
}

/* Fewer meshes than drawn nodes: slower, never a hole. */
static void a_full_mesh_pool_leaves_no_hole(void **state)
{
    (void)state;
    client_rig rig;
    open_rig(&rig, 0);
    rig.desc.use_plain_arrays = 1;
    rig.desc.quality = (ff_quality){ .c_q8 = 6 * 256 };
    rig.camera.focal_q8 /= 3; /* much ground comes into view */
    rig_client(&rig, ff_client_bytes_min());
    assert_true(rig_settle(&rig, 2000));
    for (int i = 0; i < 20; i++) {
        rig.camera.yaw += 2500;
        rig_settle(&rig, 100);
        free(draw(&rig));
        ff_client_stats stats = rig_stats(&rig);
        assert_in_range(stats.c3d.frame_triangles, stats.tree.triangles,
                        stats.tree.triangles + SKY_TRIANGLES_MAX);
        assert_int_equal(stats.c3d.stale_handles, 0);
    }
    assert_true(rig.client->view.held == rig.client->view.entry_count);
    rig_close(&rig);
}

static void faces_stand_behind_the_ground(void **state)
{
    (void)state;
    client_rig rig;
    int32_t taken_wu[3];
    unsigned faces;
    open_rig(&rig, 0);
    rig.desc.panorama.enabled = 1;
    rig.desc.panorama.back_plane_wu = 500 * METRE;
    rig.camera.pos_wu[2] = 3000 * METRE; /* nothing of the ground within the back plane */
    rig.camera.pitch = 0;
    static const struct {
        int32_t yaw;
        int grey;
    } look[] = { { 0, 40 }, { 16384, 80 }, { 32768, 120 }, { 49152, 160 } };
    rig_client(&rig, 4 * MB);
    for (unsigned i = 0; i < 4; i++) {
        rig.camera.yaw = look[i].yaw;
        rig.camera.pitch = 40 * (int32_t)i; /* other pixels of the faces meet the sky */
        assert_true(rig_settle(&rig, 400));
        uint8_t *rgb = draw(&rig);
        /* the faces show 20 of 256 rows: 32 pixels high at a focal distance of 208, all along the
         * horizon, cut by the columns' spans in part */
        assert_in_range(count_colour(rgb, look[i].grey, look[i].grey, look[i].grey, 10), WIDTH * 16,
                        WIDTH * 34);
        for (int p = 0; p < WIDTH * HEIGHT / 2; p++) /* no dark line where ground and sky meet */
            assert_true(rgb[3 * p + 2] > look[i].grey - 12);
        memset(rgb + 3 * WIDTH * (HEIGHT / 2 - 20), 0, 3 * WIDTH * 40); /* 16 and the pitch */
        assert_int_equal(count_colour(rgb, look[i].grey, look[i].grey, look[i].grey, 3), 0);
        free(rgb);
    }
    assert_true(ff_client_panorama(rig.client, taken_wu, &faces));
    assert_int_equal(rig_stats(&rig).c3d.stale_handles, 0);
    rig_close(&rig);
}

static void meshes_show_stitching_in_another_colour(void **state)
{
    (void)state;
    client_rig rig;
    open_rig(&rig, 0);
    rig_client(&rig, 4 * MB);
    assert_true(rig_settle(&rig, 400));
    assert_true(rig_stats(&rig).tree.stitched > 0);
    uint8_t *plain = draw(&rig);
    ff_client_set_show(rig.client, FF_SHOW_WIREFRAME | FF_SHOW_NO_FOG);
    unsigned updates = rig.updates;
    rig_step(&rig, 50000);
    assert_int_equal(rig.updates, updates + 1); /* a new setting makes a new picture */
    uint8_t *mesh = draw(&rig);
    assert_int_equal(count_colour(plain, 255, 32, 32, 8), 0);
    assert_true(count_colour(mesh, 255, 32, 32, 8) > 20);
    ff_client_set_show(rig.client, FF_SHOW_NODE_BORDERS);
    rig_step(&rig, 50000);
    uint8_t *borders = draw(&rig);
    assert_true(memcmp(borders, plain, WIDTH * HEIGHT * 3) != 0);
    free(plain);
    free(mesh);
    free(borders);
    rig_close(&rig);
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(all_of_the_cut_is_drawn),
                                        cmocka_unit_test(images_finer_than_nodes_are_drawn),
                                        cmocka_unit_test(plain_arrays_draw_the_same),
                                        cmocka_unit_test(sky_stands_until_a_terrain_is_known),
                                        cmocka_unit_test(a_full_mesh_pool_leaves_no_hole),
                                        cmocka_unit_test(least_memory_is_true),
                                        cmocka_unit_test(faces_stand_behind_the_ground),
                                        cmocka_unit_test(no_sky_below_the_horizon),
                                        cmocka_unit_test(meshes_show_stitching_in_another_colour) };
    return cmocka_run_group_tests(tests, open_surface, close_surface);
}
