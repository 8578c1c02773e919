/* Ground as a client tells of it: it ends with the samples, and what was void in the source is told
 * from what was measured. */
#include "../rig/client_fixture.h"
#include "../../client/ff_client_local.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define MB    ((size_t)1 << 20)
#define METRE FF_WU_PER_METRE

/* Over the last sample there is ground, and a unit beyond there is none, wherever the viewer is. */
static void assert_ends(const client_rig *rig, int32_t east_wu, int32_t north_wu)
{
    int32_t z_wu;
    assert_int_equal(ff_client_ground(rig->client, east_wu, north_wu, &z_wu), 1);
    assert_int_equal(z_wu, pack_fixture_hills(NULL, 99, 69) * METRE);
    assert_int_equal(ff_client_ground(rig->client, east_wu + 1, north_wu, &z_wu), 0);
    assert_int_equal(ff_client_ground(rig->client, east_wu, north_wu + 1, &z_wu), 0);
    assert_int_equal(ff_client_ground(rig->client, 0, 0, &z_wu), 1);
    assert_int_equal(ff_client_ground(rig->client, -1, 0, &z_wu), 0);
    assert_int_equal(ff_client_ground(rig->client, 0, -1, &z_wu), 0);
}

static void ground_ends_with_the_samples(void **state)
{
    (void)state;
    int32_t east_wu = 99 * 32 * METRE, north_wu = 69 * 32 * METRE;
    for (int images = 0; images < 2; images++) {
        client_rig rig;
        rig_open(&rig, 0);
        rig_use_samples(&rig, 100, 70, images ? 5 : 0);
        rig.desc.quality = (ff_quality){ .measure = FF_MEASURE_PIXELS, .error_px_q8 = 8 };
        rig.desc.no_prefetch = 0;
        rig_client(&rig, 4 * MB);
        assert_true(rig_settle(&rig, 800));
        assert_ends(&rig, east_wu, north_wu);
        /* out over the corner, and a look back */
        for (int i = 0; i < 100; i++) {
            for (int axis = 0; axis < 2; axis++) rig.camera.pos_wu[axis] += 40 * METRE;
            rig_step(&rig, 50000);
        }
        rig.camera.yaw = 40960;
        assert_true(rig_settle(&rig, 800));
        assert_true(rig.camera.pos_wu[0] > east_wu && rig.camera.pos_wu[1] > north_wu);
        assert_true(rig_stats(&rig).tree.nodes_drawn > 4);
        assert_ends(&rig, east_wu, north_wu);
        assert_int_equal(rig_stats(&rig).requests_failed, 0);
        rig_close(&rig);
    }
}

/* Ground near the filled void is told from measured ground, by nodes of 256 m: what lies in a node
 * with a filled sample may be filled, all else is not. */
static void filled_ground_is_told(void **state)
{
    (void)state;
    for (int local = 0; local < 2; local++) {
        client_rig rig;
        rig_open(&rig, 0);
        rig_use_filled(&rig);
        /* near and flat enough that all is refined to the finest there */
        rig.desc.quality = (ff_quality){ .measure = FF_MEASURE_DISTANCE, .c_q8 = 20 * 256 };
        rig.camera.pos_wu[0] = 45 * 32 * METRE;
        rig.camera.pos_wu[1] = 8 * 32 * METRE;
        if (local)
            rig_local_client(&rig, 4 * MB);
        else
            rig_client(&rig, 4 * MB);
        assert_int_equal(ff_client_filled(rig.client, 45 * 32 * METRE, 25 * 32 * METRE), 0);
        assert_true(rig_settle(&rig, 800));
        for (int32_t y = 8; y < 56; y++)
            for (int32_t x = 24; x < 72; x++) {
                int in_node = x >= 32 && x < 56 && y >= 16 && y < 32;
                assert_int_equal(
                    ff_client_filled(rig.client, x * 32 * METRE + 99, y * 32 * METRE + 99),
                    in_node);
            }
        const ff_drawn *drawn;
        uint32_t count = ff_tree_drawn(ff_client_tree(rig.client), &drawn), filled = 0;
        for (uint32_t i = 0; i < count; i++) filled += drawn[i].filled;
        assert_in_range(filled, 1, 6);
        /* it is kept while the view changes */
        for (int i = 0; i < 40; i++) {
            rig.camera.pos_wu[1] += 4 * METRE;
            rig_step(&rig, 50000);
        }
        assert_int_equal(ff_client_filled(rig.client, 45 * 32 * METRE, 25 * 32 * METRE), 1);
        /* and when nodes above are drawn again */
        rig.desc.quality.c_q8 = 64;
        ff_client_set_quality(rig.client, &rig.desc.quality);
        assert_true(rig_settle(&rig, 800));
        assert_int_equal(ff_client_filled(rig.client, 45 * 32 * METRE, 25 * 32 * METRE), 1);
        assert_int_equal(ff_client_filled(rig.client, 20 * 32 * METRE, 5 * 32 * METRE), 1);
        assert_int_equal(ff_client_filled(rig.client, -1, 25 * 32 * METRE), 0);
        rig_close(&rig);
    }
}
int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ground_ends_with_the_samples),
        cmocka_unit_test(filled_ground_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
