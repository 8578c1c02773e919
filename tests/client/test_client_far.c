/* FF_FAR_AUTO in the client as a whole: when its rule is asked, and how sets are left. */
#include "../rig/client_fixture.h"
#include "../../client/ff_client_local.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

#define MB       ((size_t)1 << 20)
#define METRE    FF_WU_PER_METRE
#define FRAME_US 50000

static void open_auto(client_rig *rig)
{
    rig_open(rig, 0);
    rig->desc.far = (ff_far_desc){ .enabled = FF_FAR_AUTO, .front_wu = 300 * METRE };
    rig_client(rig, 4 * MB);
}

static void fly_for(client_rig *rig, int64_t us)
{
    for (int64_t end_us = rig->frame_us + us; rig->frame_us < end_us;) rig_step(rig, FRAME_US);
}

/* When the rule was asked, counted from the first frame; `silent`: from 1 s on what is asked for
 * does not come. */
static int64_t asked_after_us(int silent)
{
    client_rig rig;
    open_auto(&rig);
    while (!rig.client->far_asked) rig_step(&rig, FRAME_US);
    int64_t begin_us = rig.client->far_us;
    fly_for(&rig, 800000);
    if (silent) rig.silent_at = rig.bytes_down;
    for (int i = 0; i < 200 && rig.client->far_us == begin_us; i++) {
        if (silent) rig.camera.yaw = (rig.camera.yaw + 400) & 0xFFFF; /* more is asked for */
        rig_step(&rig, FRAME_US);
    }
    int64_t after_us = rig.client->far_us - begin_us;
    rig_close(&rig);
    return after_us;
}

static void the_rule_waits_for_ground_but_not_for_ever(void **state)
{
    (void)state;
    int64_t at_once_us = asked_after_us(0), late_us = asked_after_us(1);
    assert_true(at_once_us >= 2000000 && at_once_us <= 2000000 + 2 * FRAME_US);
    assert_true(late_us >= 6000000 && late_us <= 6000000 + 2 * FRAME_US);
}

static void a_drawn_set_goes_once_ground_is_here(void **state)
{
    (void)state;
    client_rig rig;
    open_auto(&rig);
    assert_true(rig_settle(&rig, 400));
    rig.client->sets->choice = (ff_far_choice){ FF_FAR_FINS, 0, 0 };
    rig.client->far_us = rig.frame_us + 60000000; /* it is not asked meanwhile */
    rig.client->dirty = 1;
    fly_for(&rig, 3000000);
    assert_true(rig.client->sets->active >= 0);
    assert_true(rig_stats(&rig).far_sectors > 0);
    ff_balance_desc alone = { .mode = FF_BALANCE_ALL_CLIENT };
    ff_client_set_balance(rig.client, &alone);
    uint32_t asked = rig.asked[FF_KIND_FAR];
    fly_for(&rig, 3000000);
    assert_int_equal(rig.client->sets->active, -1);
    assert_int_equal(rig.client->sets->next, -1);
    assert_int_equal(rig.asked[FF_KIND_FAR], asked);
    rig_close(&rig);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_rule_waits_for_ground_but_not_for_ever),
        cmocka_unit_test(a_drawn_set_goes_once_ground_is_here),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
