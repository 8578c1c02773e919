/* A client under the balance: budgets of triangles, costs that are reported, both ends. */
#include "../rig/client_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#define METRE   FF_WU_PER_METRE
#define STEP_US 50000

static void open_balanced(client_rig *rig, enum ff_balance_mode mode, uint32_t frame_budget)
{
    rig_open(rig, 0);
    rig->desc.quality = (ff_quality){ .c_q8 = 12 * 256, .view_wu = 4000 * METRE };
    rig->desc.panorama = (ff_panorama_desc){ .enabled = 1, .back_plane_wu = 1500 * METRE };
    rig->desc.balance = (ff_balance_desc){ .mode = mode, .frame_budget = frame_budget };
    rig_client(rig, 4u << 20);
}

/* The client draws all ground. */
static void open_budgeted(client_rig *rig, uint32_t frame_budget)
{
    open_balanced(rig, FF_BALANCE_ON, frame_budget);
    rig->desc.panorama.enabled = 0;
    ff_client_set_panorama(rig->client, &rig->desc.panorama);
}

static void set_budget(client_rig *rig, uint32_t frame_budget)
{
    rig->desc.balance.frame_budget = frame_budget;
    ff_client_set_balance(rig->client, &rig->desc.balance);
}

/* A picture every other frame. */
static void step(client_rig *rig, unsigned frame)
{
    rig->camera.yaw = 3000 + 300 * (frame / 2 % 2);
    rig_step(rig, STEP_US);
}

static void run(client_rig *rig, unsigned seconds)
{
    for (unsigned frame = 0; frame < seconds * 20; frame++) step(rig, frame);
}

static void a_client_keeps_a_budget_of_triangles(void **state)
{
    (void)state;
    static const uint32_t budget[] = { 5000, 2500, 8000, 1000000 };
    client_rig rig;
    uint32_t triangles = 0;
    open_budgeted(&rig, budget[0]);
    for (int i = 0; i < 4; i++) {
        set_budget(&rig, budget[i]);
        for (unsigned frame = 0; frame < 20 * 20; frame++) {
            step(&rig, frame);
            assert_true(rig_stats(&rig).tree.triangles <= budget[i]);
        }
        ff_client_stats settled = rig_stats(&rig);
        assert_true(i == 3 || settled.tree.triangles >= budget[i] * 4 / 5); /* a node has 128 */
        assert_true(i == 0 || (settled.tree.triangles > triangles) == (budget[i] > budget[i - 1]));
        assert_int_equal(settled.balance.moves, 0);
        triangles = settled.tree.triangles;
    }
    assert_int_equal(rig_stats(&rig).balance.share_percent, 100);
    rig_close(&rig);
}

/* Microseconds, as a device may take them: a constant part, a part for each triangle, noise. */
static uint32_t device_cost(uint32_t triangles, uint32_t *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    uint32_t cost = 2000 + 3 * triangles;
    return cost - cost / 10 + cost / 5 * (*seed >> 20) / 4096;
}

static void run_costed(client_rig *rig, unsigned seconds, double *mean)
{
    static uint32_t seed = 1;
    double sum = 0;
    for (unsigned frame = 0; frame < seconds * 20; frame++) {
        step(rig, frame);
        uint32_t cost = device_cost(rig_stats(rig).tree.triangles, &seed);
        ff_client_frame_cost(rig->client, cost);
        sum += cost;
    }
    *mean = sum / (seconds * 20);
}

static void a_client_follows_costs_that_are_reported(void **state)
{
    (void)state;
    static const uint32_t budget[] = { 20000, 10000, 25000, 10000 };
    client_rig rig;
    double mean;
    open_budgeted(&rig, budget[0]);
    for (int i = 0; i < 4; i++) {
        set_budget(&rig, budget[i]);
        run_costed(&rig, 120, &mean);
        ff_client_stats settled = rig_stats(&rig);
        run_costed(&rig, 120, &mean);
        assert_int_equal(rig_stats(&rig).balance.moves, settled.balance.moves);
        assert_true(mean <= budget[i] * 1.09 && mean >= budget[i] * 0.85);
    }
    ff_client_frame_cost(rig.client, 0); /* triangles again */
    run(&rig, 20);
    assert_int_equal(rig_stats(&rig).quality.triangles_max, budget[3]);
    assert_true(rig_stats(&rig).balance.frame_load_q8 < 0);
    ff_client_frame_cost(rig.client, 2000000); /* far above the budget: as coarse as can be */
    run(&rig, 60);
    assert_int_equal(rig_stats(&rig).balance.share_percent, 0);
    assert_true(rig_stats(&rig).balance.frame_load_q8 > 200);
    assert_true(rig_stats(&rig).tree.triangles <= FF_TRIANGLES_MIN);
    rig_close(&rig);
}

static void the_ends_and_off(void **state)
{
    (void)state;
    client_rig server, client, off;
    int32_t position_wu[3];
    unsigned faces;
    open_balanced(&server, FF_BALANCE_ALL_SERVER, 0);
    open_balanced(&client, FF_BALANCE_ALL_CLIENT, 0);
    open_balanced(&off, FF_BALANCE_OFF, 700);
    assert_true(rig_settle(&server, 600) && rig_settle(&client, 600) && rig_settle(&off, 600));
    ff_client_stats s = rig_stats(&server), c = rig_stats(&client), o = rig_stats(&off);
    assert_int_equal(s.back_plane_wu, 375 * METRE + 1);
    assert_true(s.tree.triangles <= FF_TRIANGLES_MIN);
    assert_int_equal(s.balance.share_percent, 0);
    assert_int_equal(c.balance.share_percent, 100);
    assert_int_equal(c.back_plane_wu, 0);
    assert_int_equal(c.quality.c_q8, 12 * 256);
    assert_int_equal(c.quality.view_wu, 4000 * METRE);
    assert_int_equal(o.back_plane_wu, 1500 * METRE);
    assert_true(s.tree.triangles < o.tree.triangles && o.tree.triangles < c.tree.triangles);
    assert_true(ff_client_panorama(server.client, position_wu, &faces));
    assert_false(ff_client_panorama(client.client, position_wu, &faces));
    assert_int_equal(client.asked[FF_KIND_FACE], 0);
    assert_int_equal(o.balance.moves + o.balance.share_percent, 0);
    /* the balance is off again: quality is what was set */
    server.desc.balance.mode = FF_BALANCE_OFF;
    ff_client_set_balance(server.client, &server.desc.balance);
    assert_true(rig_settle(&server, 600));
    assert_true(rig_same_picture(&server, &off));
    rig_close(&server);
    rig_close(&client);
    rig_close(&off);
}

/* A new back plane comes into force with the panorama that was taken for it, not before: no ring
 * without ground lies between the two. */
static void the_back_plane_waits_for_its_panorama(void **state)
{
    (void)state;
    client_rig rig;
    open_balanced(&rig, FF_BALANCE_OFF, 0);
    assert_true(rig_settle(&rig, 600));
    rig.no_faces = 1;
    rig.desc.balance.mode = FF_BALANCE_ALL_SERVER;
    ff_client_set_balance(rig.client, &rig.desc.balance);
    run(&rig, 1);
    assert_int_equal(rig_stats(&rig).back_plane_wu, 1500 * METRE);
    rig.no_faces = 0;
    run(&rig, 10);
    assert_int_equal(rig_stats(&rig).back_plane_wu, 375 * METRE + 1);
    rig_close(&rig);
}

/* Who shall draw all ground keeps the panorama behind it until that was asked for. */
static void the_panorama_waits_for_the_ground(void **state)
{
    (void)state;
    client_rig rig;
    int32_t position_wu[3];
    unsigned faces;
    open_balanced(&rig, FF_BALANCE_OFF, 0);
    assert_true(rig_settle(&rig, 600));
    rig.desc.balance.mode = FF_BALANCE_ALL_CLIENT;
    ff_client_set_balance(rig.client, &rig.desc.balance);
    rig_step(&rig, STEP_US);
    assert_true(ff_client_panorama(rig.client, position_wu, &faces));
    assert_true(rig_settle(&rig, 600));
    assert_false(ff_client_panorama(rig.client, position_wu, &faces));
    rig_close(&rig);
}

/* A nearest back plane that lies beyond the back plane itself is that one. */
static void no_nearest_back_plane_is_too_far(void **state)
{
    (void)state;
    client_rig rig;
    open_balanced(&rig, FF_BALANCE_OFF, 0);
    rig.desc.balance.mode = FF_BALANCE_ALL_SERVER;
    rig.desc.balance.back_plane_min_wu = INT32_MAX;
    ff_client_set_balance(rig.client, &rig.desc.balance);
    run(&rig, 10);
    assert_int_equal(rig_stats(&rig).back_plane_wu, 1500 * METRE);
    rig_close(&rig);
}

/* A budget of bytes counts from when it is set: what came before is not owed. */
static void a_budget_of_bytes_begins_when_it_is_set(void **state)
{
    (void)state;
    client_rig rig;
    open_balanced(&rig, FF_BALANCE_OFF, 0);
    rig.desc.panorama.enabled = 0;
    ff_client_set_panorama(rig.client, &rig.desc.panorama);
    assert_true(rig_settle(&rig, 600));
    uint64_t before = rig.bytes_down;
    rig.desc.balance = (ff_balance_desc){ .mode = FF_BALANCE_ON, .link_bytes_s = 200 };
    ff_client_set_balance(rig.client, &rig.desc.balance);
    rig.camera.pos_wu[0] = 3000 * METRE;
    rig.camera.yaw += 32768;
    for (int i = 0; i < 10 * 20; i++) rig_step(&rig, STEP_US);
    assert_true(before > (10 + 4) * 200); /* else it could be paid meanwhile */
    assert_in_range(rig.bytes_down - before, 10 * 200 / 4, (10 + 4 + 2) * 200);
    rig_close(&rig);
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(a_client_keeps_a_budget_of_triangles),
                                        cmocka_unit_test(a_client_follows_costs_that_are_reported),
                                        cmocka_unit_test(the_ends_and_off),
                                        cmocka_unit_test(the_back_plane_waits_for_its_panorama),
                                        cmocka_unit_test(the_panorama_waits_for_the_ground),
                                        cmocka_unit_test(no_nearest_back_plane_is_too_far),
                                        cmocka_unit_test(a_budget_of_bytes_begins_when_it_is_set) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
