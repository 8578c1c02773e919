/* The client as a whole: pictures over a stream and over a pack, panoramas, images, memory,
 * settings, stillness, sameness. */
#include "../rig/client_fixture.h"
#include "../../client/ff_client_local.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define MB    ((size_t)1 << 20)
#define METRE FF_WU_PER_METRE

static ff_request_counts counts_of(client_rig *rig)
{
    ff_request_counts counts;
    ff_requests_get_counts(&rig->client->first.requests, &counts, NULL);
    return counts;
}

/* Every request is counted once: in a final state or in a slot. */
static void assert_requests_add_up(client_rig *rig)
{
    ff_request_counts c = counts_of(rig);
    assert_int_equal(c.made, c.done + c.failed + c.cancelled + c.dropped + c.queued + c.in_flight +
                                 c.arriving);
}

static void same_picture_over_stream_and_pack(void **state)
{
    (void)state;
    client_rig far, near;
    rig_open(&far, 0);
    rig_open(&near, 0);
    rig_client(&far, 2 * MB);
    rig_local_client(&near, 2 * MB);
    assert_true(rig_settle(&far, 400));
    assert_true(rig_settle(&near, 400));
    assert_true(rig_same_picture(&far, &near));
    assert_true(rig_stats(&far).tree.nodes_drawn > 10);
    assert_int_equal(rig_stats(&far).requests_failed, 0);
    assert_int_equal(rig_stats(&far).requests_sent, rig_stats(&far).requests_done);
    assert_int_equal(rig_stats(&near).bytes_down, 0);
    assert_int_equal(rig_stats(&near).link, FF_LINK_NONE);
    assert_requests_add_up(&far);
    rig_close(&far);
    rig_close(&near);
}

static void still_camera_means_stillness(void **state)
{
    (void)state;
    client_rig rig;
    rig_open(&rig, 5);
    rig.desc.panorama.enabled = 1;
    rig.desc.panorama.back_plane_wu = 1500 * METRE;
    rig_client(&rig, 4 * MB);
    assert_true(rig_settle(&rig, 600));
    ff_client_stats before = rig_stats(&rig);
    uint64_t hash = ff_client_geometry_hash(rig.client);
    unsigned updates = rig.updates;
    for (int i = 0; i < 200; i++) rig_step(&rig, 50000);
    ff_client_stats after = rig_stats(&rig);
    assert_int_equal(rig.updates, updates);
    assert_int_equal(after.requests_sent, before.requests_sent);
    assert_int_equal(after.frames_skipped, before.frames_skipped + 200);
    assert_int_equal(after.bytes_up, before.bytes_up);
    assert_int_equal(after.tree.selects + after.tree.selects_skipped,
                     before.tree.selects + before.tree.selects_skipped);
    assert_int_equal(ff_client_geometry_hash(rig.client), hash);
    rig_close(&rig);
}

/* A flight with turns and hops; its hashes. */
static void fly(client_rig *rig, uint64_t *geometry, uint64_t *requests)
{
    for (int i = 0; i < 400; i++) {
        rig->camera.pos_wu[0] += i < 200 ? 3 * METRE : -2 * METRE;
        rig->camera.pos_wu[1] += 4 * METRE;
        rig->camera.yaw += i % 50 == 0 ? 3000 : 20;
        rig_step(rig, 33333 + i % 7 * 5000);
        assert_requests_add_up(rig);
    }
    *geometry = ff_client_geometry_hash(rig->client);
    *requests = ff_client_request_hash(rig->client);
}

static void same_script_same_hashes(void **state)
{
    (void)state;
    uint64_t geometry[3], requests[3];
    for (int i = 0; i < 3; i++) {
        client_rig rig;
        rig_open(&rig, 5);
        rig.desc.no_prefetch = 0;
        rig.desc.panorama.enabled = 1;
        rig.desc.panorama.back_plane_wu = 1200 * METRE;
        rig.camera.yaw += i == 2; /* the third flight turns otherwise */
        rig_client(&rig, 4 * MB);
        fly(&rig, &geometry[i], &requests[i]);
        rig_close(&rig);
    }
    assert_int_equal(geometry[0], geometry[1]);
    assert_int_equal(requests[0], requests[1]);
    assert_int_not_equal(geometry[0], geometry[2]);
}

static void what_is_off_costs_nothing(void **state)
{
    (void)state;
    client_rig rig;
    rig_open(&rig, 5);
    rig.desc.no_textures = 1;
    rig_client(&rig, 2 * MB);
    assert_true(rig_settle(&rig, 400));
    assert_int_equal(rig.asked[FF_KIND_TEXTURE], 0);
    assert_int_equal(rig.asked[FF_KIND_FACE], 0);
    assert_true(rig_heights(&rig) > 10);
    assert_null(rig.client->textures.slot);
    assert_null(rig.client->first.intake.rgb);
    assert_null(rig.client->news.images);
    assert_int_equal(rig_stats(&rig).textures_held, 0);
    rig_close(&rig);
}

static void images_come_from_coarse_to_fine(void **state)
{
    (void)state;
    client_rig rig;
    rig_open(&rig, 5);
    rig_client(&rig, 2 * MB);
    assert_true(rig_settle(&rig, 600));
    const ff_drawn *drawn;
    uint32_t count = ff_tree_drawn(ff_client_tree(rig.client), &drawn);
    ff_textures *textures = &rig.client->textures;
    const ff_view *view = &rig.client->last_view;
    const ff_texel_look look = ff_textures_look(textures, &view->frame, &view->camera);
    for (uint32_t i = 0; i < count; i++) {
        ff_wear wanted[FF_WEAR_MAX];
        unsigned parts = ff_textures_wanted(textures, ff_client_tree(rig.client), &drawn[i], &look,
                                            wanted);
        for (unsigned part = 0; part < parts; part++)
            assert_true(ff_client_wears(rig.client, wanted[part].image));
    }
    assert_int_equal(rig_stats(&rig).requests_failed, 0);
    assert_int_equal(rig.asked[FF_KIND_TEXTURE], rig_stats(&rig).textures_held);
    rig_close(&rig);
}

static void panorama_follows_the_rules(void **state)
{
    (void)state;
    client_rig rig;
    int32_t taken_wu[3];
    unsigned faces;
    rig_open(&rig, 0);
    rig.desc.panorama.enabled = 1;
    rig.desc.no_prefetch = 0;
    rig.desc.no_reserve = 1;
    rig.desc.panorama.back_plane_wu = 1500 * METRE;
    rig_client(&rig, 4 * MB);
    assert_false(ff_client_panorama(rig.client, taken_wu, &faces));
    assert_true(rig_settle(&rig, 400));
    assert_true(ff_client_panorama(rig.client, taken_wu, &faces));
    assert_memory_equal(taken_wu, rig.camera.pos_wu, sizeof taken_wu);
    /* no other faces are asked for, however long the viewer stays */
    assert_int_equal(faces, ff_panorama_faces_in_view(&rig.camera));
    for (int i = 0; i < 62; i++) rig_step(&rig, 500000);
    assert_int_equal(rig.asked[FF_KIND_FACE], 1);
    unsigned seen = 0;
    /* 18 degrees a second: a face is there before it comes into view */
    for (int i = 0; i < 200; i++) {
        rig.camera.yaw = (rig.camera.yaw + 164) & 0xFFFF;
        seen |= ff_panorama_faces_in_view(&rig.camera);
        rig_step(&rig, 50000);
        if (i > 10) {
            ff_client_panorama(rig.client, taken_wu, &faces);
            assert_int_equal(seen & ~faces, 0);
        }
    }
    rig_settle(&rig, 100);
    assert_true(ff_client_panorama(rig.client, taken_wu, &faces));
    /* a viewer who has turned may turn again: all faces are asked for */
    assert_int_equal(faces, 0x3f);
    assert_int_equal(rig_stats(&rig).panorama_faces, 4);
    assert_int_equal(rig_stats(&rig).panorama_faces_empty, 2);
    unsigned asked = rig.asked[FF_KIND_FACE];

    rig.camera.pos_wu[2] += 20 * METRE; /* too little to make the set outdated */
    rig_settle(&rig, 100);
    assert_int_equal(rig.asked[FF_KIND_FACE], asked);
    rig.camera.pos_wu[2] += 200 * METRE;
    rig_settle(&rig, 100);
    assert_true(rig.asked[FF_KIND_FACE] > asked);
    ff_client_panorama(rig.client, taken_wu, &faces);
    assert_memory_equal(taken_wu, rig.camera.pos_wu, sizeof taken_wu);
    assert_requests_add_up(&rig);
    rig_close(&rig);
}

/* Flying straight on: O lies ahead when a set is taken, the set serves as long before O as behind
 * it, and the next set arrives in time. */
static void panorama_is_taken_ahead(void **state)
{
    (void)state;
    client_rig rig;
    unsigned sets = 0, faces, late = 0, frames = 400;
    int32_t taken_wu[3], last_y_wu = 0, longest_ahead_wu = 0, started_y_wu = 0;
    rig_open(&rig, 0);
    rig.desc.panorama.enabled = 1;
    rig.desc.panorama.back_plane_wu = 1500 * METRE;
    rig_client(&rig, 4 * MB);
    assert_true(rig_settle(&rig, 400));
    rig.camera.pos_wu[1] -= 600 * METRE;
    for (unsigned i = 0; i < frames; i++) {
        rig.camera.pos_wu[1] += 3 * METRE;
        rig_step(&rig, 50000);
        /* the viewer's motion is not known yet */
        if (i < 60 || !ff_client_panorama(rig.client, taken_wu, &faces)) continue;
        const ff_panorama *panorama = &rig.client->panorama;
        late += (unsigned)ff_panorama_set_outdated(panorama, &panorama->set[panorama->shown],
                                                   &rig.camera);
        int32_t ahead_wu = taken_wu[1] - rig.camera.pos_wu[1];
        longest_ahead_wu = ahead_wu > longest_ahead_wu ? ahead_wu : longest_ahead_wu;
        if (taken_wu[1] != last_y_wu && sets++ == 0) started_y_wu = taken_wu[1];
        last_y_wu = taken_wu[1];
        assert_int_equal(taken_wu[0], rig.camera.pos_wu[0]);
    }
    assert_in_range(sets, 4, 20);
    int32_t each_wu = (last_y_wu - started_y_wu) / (int32_t)(sets - 1);
    assert_in_range(longest_ahead_wu, 20 * METRE, 375 * METRE);
    assert_true(each_wu > longest_ahead_wu * 3 / 2); /* each set served on both sides of its O */
    assert_true(late * 20 < frames);
    rig_close(&rig);
}

/* The renderer stands still and the viewer flies on: one set stays outstanding, and ground still
 * arrives. */
static void one_set_outstanding_at_most(void **state)
{
    (void)state;
    client_rig rig;
    rig_open(&rig, 0);
    rig.no_faces = 1;
    rig.desc.panorama.enabled = 1;
    rig.desc.panorama.back_plane_wu = 1500 * METRE;
    rig_client(&rig, 4 * MB);
    for (int i = 0; i < 140; i++) {
        rig.camera.pos_wu[1] += 5 * METRE;
        rig_step(&rig, 50000);
    }
    assert_int_equal(rig.asked[FF_KIND_FACE], 1);
    /* further than half the back plane: the set is left behind and cancelled, and another is asked
     * for */
    for (int i = 0; i < 60; i++) {
        rig.camera.pos_wu[1] += 5 * METRE;
        rig_step(&rig, 50000);
    }
    assert_int_equal(rig.asked[FF_KIND_FACE], 2);
    assert_int_equal(rig_stats(&rig).requests_cancelled, 1);
    assert_int_equal(rig_stats(&rig).panoramas_in_flight_high, 1);
    assert_true(rig_stats(&rig).tree.nodes_drawn > 5);
    int32_t taken_wu[3], old_wu[3];
    unsigned faces, old_faces;
    /* no set is complete: none is shown */
    assert_false(ff_client_panorama(rig.client, taken_wu, &faces));
    rig.no_faces = 0;
    assert_true(rig_settle(&rig, 400));
    assert_true(ff_client_panorama(rig.client, old_wu, &old_faces));
    assert_int_equal(ff_panorama_faces_in_view(&rig.camera) & ~old_faces, 0);

    rig.no_faces = 1; /* a new set is due and does not come: the old one stays whole */
    rig.camera.pos_wu[1] -= 200 * METRE;
    for (int i = 0; i < 20; i++) rig_step(&rig, 50000);
    assert_true(ff_client_panorama(rig.client, taken_wu, &faces));
    assert_memory_equal(taken_wu, old_wu, sizeof taken_wu);
    assert_int_equal(faces, old_faces);

    /* after 800 m the viewer is too far from O: the client draws its own ground all round him */
    for (int i = 0; i < 160; i++) {
        rig.camera.pos_wu[1] -= 5 * METRE;
        rig_step(&rig, 50000);
    }
    assert_false(ff_client_panorama(rig.client, taken_wu, &faces));
    assert_true(rig_stats(&rig).tree.nodes_drawn > 5);
    assert_requests_add_up(&rig);
    rig_close(&rig);
}

/* Panoramas are switched off and on again at once: the first request is cancelled, and a second is
 * made only after the answer to the first. */
static void switched_panoramas_do_not_queue_up(void **state)
{
    (void)state;
    client_rig rig;
    rig_open(&rig, 0);
    rig.no_faces = 1;
    rig.desc.panorama.enabled = 1;
    rig.desc.panorama.back_plane_wu = 1500 * METRE;
    rig_client(&rig, 4 * MB);
    ff_panorama_desc panorama = rig.desc.panorama;
    for (int i = 0; i < 100; i++) {
        rig_step(&rig, 50000);
        for (int on = 0; i % 20 == 19 && on < 2; on++) {
            panorama.enabled = (uint8_t)on;
            ff_client_set_panorama(rig.client, &panorama);
        }
        /* before the worker sees the change */
        rig.updates += (unsigned)ff_client_update(rig.client, rig.frame_us, &rig.camera);
    }
    assert_true(rig.asked[FF_KIND_FACE] > 2);
    assert_int_equal(rig_stats(&rig).panoramas_in_flight_high, 1);
    assert_requests_add_up(&rig);
    rig_close(&rig);
}

/* Off, on, with panoramas, which go, and off again. */
static void far_sets_may_be_switched_while_flying(void **state)
{
    (void)state;
    client_rig rig;
    rig_open(&rig, 0);
    rig.desc.panorama.enabled = FF_PANORAMA_ON;
    rig.desc.panorama.back_plane_wu = 1500 * METRE;
    rig_client(&rig, 8 * MB);
    ff_far_desc far = { .enabled = FF_FAR_FINS, .front_wu = 300 * METRE };
    for (int i = 0; i < 60; i++) rig_step(&rig, 50000);
    assert_int_equal(rig.asked[FF_KIND_FAR], 0);
    assert_true(rig_stats(&rig).back_plane_wu > 0);
    ff_client_set_far(rig.client, &far);
    for (int i = 0; i < 60; i++) rig_step(&rig, 50000);
    assert_true(rig.asked[FF_KIND_FAR] > 0);
    assert_true(rig_stats(&rig).far_sectors > 0);
    assert_int_equal(rig_stats(&rig).back_plane_wu, 0);
    uint32_t faces = rig.asked[FF_KIND_FACE];
    rig_fly(&rig, 200);
    assert_int_equal(rig.asked[FF_KIND_FACE], faces);
    far = (ff_far_desc){ .enabled = 200, .coarse = 200, .paint_shift = 200, .quality = 200 };
    ff_client_set_far(rig.client, &far); /* brought into range */
    assert_int_equal(rig.client->desc.far.enabled, FF_FAR_AUTO);
    far.enabled = FF_FAR_OFF;
    ff_client_set_far(rig.client, &far);
    uint32_t asked = rig.asked[FF_KIND_FAR];
    for (int i = 0; i < 60; i++) rig_step(&rig, 50000);
    assert_int_equal(rig.asked[FF_KIND_FAR], asked);
    ff_client_set_panorama(rig.client, &rig.desc.panorama);
    for (int i = 0; i < 60; i++) rig_step(&rig, 50000);
    assert_true(rig_stats(&rig).back_plane_wu > 0);
    far.enabled = FF_FAR_FINS;
    ff_client_set_far(rig.client, &far);
    faces = rig.asked[FF_KIND_FACE];
    rig_fly(&rig, 200);
    assert_int_equal(rig.asked[FF_KIND_FACE], faces);
    assert_int_equal(rig_stats(&rig).back_plane_wu, 0);
    assert_requests_add_up(&rig);
    rig_close(&rig);
}

/* Angles of many turns, and a face size that ff_client_create would refuse. */
static void wild_angles_and_sizes_are_made_whole(void **state)
{
    (void)state;
    client_rig rig, calm;
    rig_open(&rig, 0);
    rig_open(&calm, 0);
    rig_client(&rig, 4 * MB);
    rig_client(&calm, 4 * MB);
    ff_panorama_desc panorama = { .enabled = 1, .back_plane_wu = 1500 * METRE, .face_size = 1 };
    ff_client_set_panorama(rig.client, &panorama);
    panorama.face_size = FF_PANORAMA_FACE_MIN;
    ff_client_set_panorama(calm.client, &panorama);
    calm.camera.yaw = (int32_t)(rig.camera.yaw = INT32_MAX) & 65535;
    calm.camera.roll = (int32_t)(rig.camera.roll = INT32_MIN) & 65535;
    calm.camera.pitch = rig.camera.pitch;
    rig.camera.pitch -= 100 << 16;
    assert_true(rig_settle(&rig, 400) && rig_settle(&calm, 400));
    assert_true(rig_stats(&rig).panorama_faces > 0);
    assert_true(rig_same_picture(&rig, &calm));
    rig.camera.yaw = INT32_MIN;
    assert_true(rig_settle(&rig, 400));
    /* a camera that no picture has is no camera; settings end where ff_client_create's do */
    c3d_camera wide = rig.camera, far_off = rig.camera;
    wide.width = FF_PICTURE_SIDE_MAX + 1;
    far_off.near_wu = INT32_MAX;
    assert_false(ff_client_update(rig.client, rig.frame_us, &wide));
    assert_false(ff_client_update(rig.client, rig.frame_us, &far_off));
    ff_quality quality = { .measure = FF_MEASURE_PIXELS,
                           .error_px_q8 = INT32_MAX,
                           .depth_max = UINT8_MAX,
                           .view_wu = INT32_MAX };
    ff_client_set_quality(rig.client, &quality);
    panorama.back_plane_wu = panorama.server_back_wu = INT32_MAX;
    ff_client_set_panorama(rig.client, &panorama);
    assert_true(rig_settle(&rig, 400));
    assert_int_equal(rig_stats(&rig).quality.error_px_q8, FF_QUALITY_ERROR_PX_MAX << 8);
    assert_int_equal(rig_stats(&rig).back_plane_wu, FF_PANORAMA_BACK_WU_MAX);
    rig_close(&rig);
    rig_close(&calm);
}

static void panorama_can_be_switched(void **state)
{
    (void)state;
    client_rig rig;
    int32_t taken_wu[3];
    unsigned faces;
    rig_open(&rig, 0);
    rig_client(&rig, 4 * MB);
    assert_true(rig_settle(&rig, 400));
    ff_panorama_desc panorama = { .enabled = 1, .back_plane_wu = 1500 * METRE };
    /* the block was shared out without panoramas: it is shared out anew */
    ff_client_set_panorama(rig.client, &panorama);
    assert_true(rig_settle(&rig, 400));
    assert_true(ff_client_panorama(rig.client, taken_wu, &faces));
    panorama.enabled = 0;
    ff_client_set_panorama(rig.client, &panorama);
    assert_true(rig_settle(&rig, 400));
    assert_false(ff_client_panorama(rig.client, taken_wu, &faces));
    panorama.enabled = 1;
    /* this time the block holds pools for panoramas */
    ff_client_set_panorama(rig.client, &panorama);
    unsigned connections = rig.connections;
    assert_true(rig_settle(&rig, 400));
    assert_true(ff_client_panorama(rig.client, taken_wu, &faces));
    assert_int_equal(rig.connections, connections);
    assert_requests_add_up(&rig);
    rig_close(&rig);
}

static void little_memory_draws_coarser(void **state)
{
    (void)state;
    client_rig rig;
    rig_open(&rig, 6);
    rig.desc.panorama.enabled = 1;
    rig.desc.quality = (ff_quality){ .measure = FF_MEASURE_PIXELS, .error_px_q8 = 8 };
    rig_client(&rig, ff_client_bytes_min());
    assert_true(rig_settle(&rig, 2000));
    ff_client_stats stats = rig_stats(&rig);
    assert_true(stats.tree.nodes_drawn > 0);
    assert_true(stats.memory_used <= stats.memory_bytes);
    assert_true(stats.textures_high > 0);
    unsigned sent = stats.requests_sent;
    for (int i = 0; i < 100; i++) rig_step(&rig, 50000);
    /* a full pool asks for nothing twice */
    assert_int_equal(rig_stats(&rig).requests_sent, sent);
    rig_close(&rig);
}

static void wrong_descriptions_are_refused(void **state)
{
    (void)state;
    static unsigned char block[1 << 20];
    client_rig rig;
    ff_client *client;
    rig_open(&rig, 0);
    ff_client_desc desc = { .memory = block, .memory_bytes = sizeof block };
    /* neither stream nor pack */
    assert_int_equal(ff_client_create(&desc, &client), FF_ERR_ARGUMENT);
    desc.stream = &rig.stream;
    desc.pack = &rig.pack;
    assert_int_equal(ff_client_create(&desc, &client), FF_ERR_ARGUMENT);
    desc.stream = NULL;
    desc.memory_bytes = ff_client_bytes_min() - 1;
    assert_int_equal(ff_client_create(&desc, &client), FF_ERR_MEMORY);
    desc.memory = block + 3; /* any alignment */
    desc.memory_bytes = ff_client_bytes_min() + 32;
    assert_int_equal(ff_client_create(&desc, &client), FF_OK);
    ff_client_destroy(client);
    ff_client_destroy(NULL);
    rig_close(&rig);
}

static void low_power_is_coarser_and_recovers(void **state)
{
    (void)state;
    client_rig rig;
    rig_open(&rig, 0);
    rig.desc.quality = (ff_quality){ .c_q8 = 5 * 256, .depth_max = 4 };
    rig_client(&rig, 2 * MB);
    assert_true(rig_settle(&rig, 400));
    uint32_t triangles = rig_stats(&rig).tree.triangles;
    sys_event touch = { .type = SYS_EVENT_POINTER };
    unsigned updates = rig.updates;
    ff_client_event(rig.client, &touch); /* the client has no use for touches */
    rig_step(&rig, 50000);
    assert_int_equal(rig.updates, updates);
    sys_event event = { .type = SYS_EVENT_BATTERY };
    event.u.battery.low = 1;
    ff_client_event(rig.client, &event);
    assert_true(rig_settle(&rig, 400));
    assert_true(rig_stats(&rig).low_power);
    assert_true(rig_stats(&rig).tree.triangles < triangles);
    event.u.battery.low = 0;
    ff_client_event(rig.client, &event);
    assert_true(rig_settle(&rig, 400));
    assert_int_equal(rig_stats(&rig).tree.triangles, triangles);
    rig_close(&rig);
}

/* The least distance is halved to none nowhere: a view cannot be asked for with that. */
static void the_least_quality_has_no_half(void **state)
{
    (void)state;
    client_rig rig;
    sys_event event = { .type = SYS_EVENT_BATTERY, .u.battery.low = 1 };
    rig_open(&rig, 0);
    rig.desc.quality = (ff_quality){ .c_q8 = 1 };
    rig_client(&rig, 2 * MB);
    ff_client_event(rig.client, &event);
    assert_true(rig_settle(&rig, 400));
    assert_true(rig_stats(&rig).low_power && rig_stats(&rig).tree.nodes_held > 0);
    rig_close(&rig);
}

static void interruption_asks_for_nothing(void **state)
{
    (void)state;
    client_rig rig;
    rig_open(&rig, 0);
    rig_client(&rig, 2 * MB);
    for (int i = 0; i < 5; i++) rig_step(&rig, 50000);
    sys_event event = { .type = SYS_EVENT_INTERRUPTION };
    event.u.interruption.begins = 1;
    ff_client_event(rig.client, &event);
    rig.camera.pos_wu[0] += 1000 * METRE;
    uint32_t sent = rig_stats(&rig).requests_sent;
    for (int i = 0; i < 100; i++) rig_step(&rig, 5000000); /* minutes: the link is kept alive */
    assert_int_equal(rig_stats(&rig).requests_sent, sent);
    assert_true(rig.pings > 2);
    assert_int_equal(rig_stats(&rig).link, FF_LINK_UP);
    event.u.interruption.begins = 0;
    ff_client_event(rig.client, &event);
    assert_true(rig_settle(&rig, 400));
    assert_true(rig_stats(&rig).requests_sent > sent);
    rig_close(&rig);
}

static void prefetch_asks_ahead_only_in_motion(void **state)
{
    (void)state;
    uint32_t sent[2];
    for (int i = 0; i < 2; i++) {
        client_rig rig;
        rig_open(&rig, 0);
        rig.desc.no_prefetch = (uint8_t)!i;
        rig.desc.quality = (ff_quality){ .c_q8 = 2 * 256, .depth_max = 0, .view_wu = 1000 * METRE };
        rig.camera.pos_wu[2] = 600 * METRE;
        rig_client(&rig, 2 * MB);
        assert_true(rig_settle(&rig, 400));
        for (int frame = 0; frame < 40; frame++) {
            rig.camera.pos_wu[1] += 2 * METRE;
            rig_step(&rig, 50000);
        }
        sent[i] = rig_stats(&rig).requests_sent;
        assert_requests_add_up(&rig);
        rig_close(&rig);
    }
    assert_true(sent[1] > sent[0]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(same_picture_over_stream_and_pack),
        cmocka_unit_test(still_camera_means_stillness),
        cmocka_unit_test(same_script_same_hashes),
        cmocka_unit_test(what_is_off_costs_nothing),
        cmocka_unit_test(images_come_from_coarse_to_fine),
        cmocka_unit_test(panorama_follows_the_rules),
        cmocka_unit_test(panorama_is_taken_ahead),
        cmocka_unit_test(one_set_outstanding_at_most),
        cmocka_unit_test(panorama_can_be_switched),
        cmocka_unit_test(switched_panoramas_do_not_queue_up),
        cmocka_unit_test(far_sets_may_be_switched_while_flying),
        cmocka_unit_test(wild_angles_and_sizes_are_made_whole),
        cmocka_unit_test(little_memory_draws_coarser),
        cmocka_unit_test(wrong_descriptions_are_refused),
        cmocka_unit_test(low_power_is_coarser_and_recovers),
        cmocka_unit_test(the_least_quality_has_no_half),
        cmocka_unit_test(interruption_asks_for_nothing),
        cmocka_unit_test(prefetch_asks_ahead_only_in_motion),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
