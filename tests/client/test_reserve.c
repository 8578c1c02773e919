/* The reserve: coarse ground in every direction, asked for while the link is idle. */
#include "../rig/client_fixture.h"
#include "../../client/ff_client_local.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define MB    ((size_t)1 << 20)
#define METRE FF_WU_PER_METRE

/* What the client asks for while the viewer stands still: requests, and those for the reserve. */
static void hover(client_rig *rig, int32_t y_m, int no_reserve, uint32_t *sent, uint32_t *reserve)
{
    rig_open(rig, 0);
    rig->desc.no_prefetch = 0;
    rig->desc.no_reserve = (uint8_t)no_reserve;
    rig->desc.quality =
        (ff_quality){ .measure = FF_MEASURE_PIXELS, .error_px_q8 = 256, .view_wu = INT32_MAX };
    rig->camera.pos_wu[1] = y_m * METRE;
    rig->camera.pos_wu[2] = 700 * METRE;
    rig_client(rig, 4 * MB);
    assert_true(rig_settle(rig, 600));
    *sent = rig_stats(rig).requests_sent;
    *reserve = rig_stats(rig).reserve_requests;
}

/* Standing still: what is in view is asked for first, then the reserve, then nothing: more ground
 * could be had, but it would not be missed. Turning brings it. */
static void first_what_is_in_view_then_the_reserve_then_nothing(void **state)
{
    (void)state;
    client_rig plain, rig;
    uint32_t plain_sent, sent, reserve;
    hover(&plain, 2400, 1, &plain_sent, &reserve);
    assert_int_equal(reserve, 0);
    hover(&rig, 2400, 0, &sent, &reserve);
    assert_true(reserve > 2);
    assert_int_equal(sent, plain_sent + reserve);
    assert_true(rig_stats(&rig).reserve_bytes > 0);
    const ff_wish *wish;
    uint32_t count = ff_tree_wishes(rig.client->tree, &wish);
    assert_true(count > 0); /* out of view there is more ground to have */
    for (uint32_t i = 0; i < count; i++) assert_false(wish[i].in_view);
    for (int i = 0; i < 200; i++) rig_step(&rig, 50000);
    assert_int_equal(rig_stats(&rig).requests_sent, sent);
    assert_true(rig_same_picture(&plain, &rig));
    for (int i = 0; i < 200; i++) {
        rig.camera.yaw = (rig.camera.yaw + 328) & 0xFFFF;
        rig_step(&rig, 50000);
    }
    assert_true(rig_settle(&rig, 400));
    assert_true(rig_stats(&rig).requests_sent > sent + 2);
    rig_close(&plain);
    rig_close(&rig);
}

/* At once after a turn: the client's own estimate of its error, pixels Q8, and how many tiles and
 * nodes in view are empty or off by more than 20 pixels. */
static uint32_t turn_at_once(int32_t y_m, int no_reserve, uint32_t *misses)
{
    client_rig rig;
    uint32_t sent, reserve;
    const ff_wish *wish;
    hover(&rig, y_m, no_reserve, &sent, &reserve);
    rig.camera.yaw = (rig.camera.yaw + 0x8000) & 0xFFFF;
    assert_true(ff_client_update(rig.client, rig.frame_us, &rig.camera));
    uint32_t error_q8 = ff_client_error_px_q8(rig.client),
             count = ff_tree_wishes(rig.client->tree, &wish);
    *misses = 0;
    for (uint32_t i = 0; i < count; i++)
        *misses += wish[i].in_view && (wish[i].kind == FF_KIND_ROOT || wish[i].priority > 20 * 256);
    rig_close(&rig);
    return error_q8;
}

/* At the first two places what is missed is less than 5 % of the ground in view, so that the
 * estimate, which is of the other 95 %, does not tell; from the last one all of it lies behind. */
static void a_turn_at_once_meets_ground(void **state)
{
    (void)state;
    static const int32_t y_m[] = { 2600, 3500, 4900 };
    uint32_t with = 0, without = 0;
    for (int i = 0; i < 3; i++) {
        uint32_t misses;
        without = turn_at_once(y_m[i], 1, &misses);
        assert_true(misses > 0);
        with = turn_at_once(y_m[i], 0, &misses);
        assert_int_equal(misses, 0);
        assert_true(with <= 20 * 256);
    }
    assert_true(with < without / 2);
}

static void low_power_keeps_no_reserve(void **state)
{
    (void)state;
    client_rig rig;
    sys_event event = { .type = SYS_EVENT_BATTERY, .u.battery.low = 1 };
    rig_open(&rig, 0);
    rig.desc.quality =
        (ff_quality){ .measure = FF_MEASURE_PIXELS, .error_px_q8 = 256, .view_wu = INT32_MAX };
    rig_client(&rig, 4 * MB);
    ff_client_event(rig.client, &event);
    assert_true(rig_settle(&rig, 600));
    assert_int_equal(rig_stats(&rig).reserve_requests, 0);
    event.u.battery.low = 0;
    ff_client_event(rig.client, &event);
    assert_true(rig_settle(&rig, 600));
    assert_true(rig_stats(&rig).reserve_requests > 0);
    rig_close(&rig);
}

/* Who stays gets the other faces one by one, who flies does not. */
static void faces_of_the_reserve_are_for_who_stays(void **state)
{
    (void)state;
    client_rig rig;
    int32_t taken_wu[3];
    unsigned faces;
    rig_open(&rig, 0);
    rig.desc.panorama.enabled = 1;
    rig.desc.panorama.back_plane_wu = 1500 * METRE;
    rig_client(&rig, 4 * MB);
    for (int i = 0; i < 100; i++) {
        rig.camera.pos_wu[1] += 2 * METRE;
        rig_step(&rig, 50000);
    }
    assert_true(ff_client_panorama(rig.client, taken_wu, &faces));
    assert_int_not_equal(faces, 0x3f);
    for (int i = 0; i < 200; i++) rig_step(&rig, 50000);
    assert_true(ff_client_panorama(rig.client, taken_wu, &faces));
    assert_int_equal(faces, 0x3f);
    rig_close(&rig);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(first_what_is_in_view_then_the_reserve_then_nothing),
        cmocka_unit_test(a_turn_at_once_meets_ground),
        cmocka_unit_test(low_power_keeps_no_reserve),
        cmocka_unit_test(faces_of_the_reserve_are_for_who_stays),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
