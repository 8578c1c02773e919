/* Below leaves nothing is stored: a client asks for none of it, and makes it, whether it moves or
 * stands still, however it looks ahead. */
#include "../rig/client_fixture.h"
#include "../../client/ff_client_local.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

/* The finest level that is drawn. */
static uint32_t finest_drawn(const client_rig *rig)
{
    const ff_drawn *list;
    uint32_t count = ff_tree_drawn(rig->client->tree, &list), finest = 0;
    for (uint32_t i = 0; i < count; i++)
        if (ff_key_level(list[i].key) > finest) finest = ff_key_level(list[i].key);
    return finest;
}

static void open(client_rig *rig, int prefetch)
{
    rig_open(rig, 0);
    rig_use_leaves(rig);
    rig->desc.no_prefetch = !prefetch;
    rig->desc.quality.measure = FF_MEASURE_DISTANCE;
    rig->desc.quality.c_q8 = 20 * 256;
    rig->desc.panorama.enabled = FF_PANORAMA_OFF;
}

static void a_still_client_makes_all_of_them(void **state)
{
    (void)state;
    for (int local = 0; local < 2; local++) {
        client_rig rig;
        open(&rig, 0);
        if (local)
            rig_local_client(&rig, 4 << 20);
        else
            rig_client(&rig, 4 << 20);
        assert_true(rig_settle(&rig, 400));
        for (int i = 0; i < 100; i++) rig_step(&rig, 50000);
        assert_int_equal(finest_drawn(&rig), ff_terrain_levels(&rig.pack.header.info) - 1);
        assert_int_equal(ff_tree_to_make(rig.client->tree), 0);
        ff_client_stats before = rig_stats(&rig);
        for (int i = 0; i < 50; i++) rig_step(&rig, 50000);
        assert_int_equal(rig_stats(&rig).frames_updated, before.frames_updated);
        assert_int_equal(before.requests_failed, 0);
        if (!local) assert_in_range(rig_heights(&rig), 5, 8); /* roots, and their own */
        rig_close(&rig);
    }
}

static void a_client_in_flight_asks_for_none(void **state)
{
    (void)state;
    client_rig rig;
    open(&rig, 1);
    rig.desc.quality.c_q8 = 3 * 256; /* it splits what it comes to, ahead of its coming */
    rig.camera.pos_wu[0] = 300 * FF_WU_PER_METRE;
    rig.camera.yaw = 8192;
    rig_client(&rig, 4 << 20);
    rig_fly(&rig, 400);
    assert_in_range(rig_heights(&rig), 5, 8);
    assert_int_equal(rig_stats(&rig).requests_failed, 0);
    assert_int_equal(finest_drawn(&rig), ff_terrain_levels(&rig.pack.header.info) - 1);
    rig_close(&rig);
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(a_still_client_makes_all_of_them),
                                        cmocka_unit_test(a_client_in_flight_asks_for_none) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
