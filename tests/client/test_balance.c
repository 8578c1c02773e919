/* The balance: its ladders; a client under it; modelled plants (constant, noisy, stepping, late),
 * within and beyond what its argument assumes. Against every plant the balance settles and does not
 * cycle. */
#include "../rig/client_fixture.h"
#include "../../client/balance/ff_balance.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define METRE      FF_WU_PER_METRE
#define SECOND_US  1000000
#define STEP_US    50000
#define DECISION_S 20   /* settling at most 10 s, the link's window 8, a second of the frame's */
#define NOISE      0.12 /* below 1.5 FF_BALANCE_NOISE_Q4 */
#define TOLERANCE  0.14 /* FF_BALANCE_NOISE_Q4 in octaves, and what rounding loses */

static const ff_quality finest = { .measure = FF_MEASURE_DISTANCE,
                                   .c_q8 = 9 * 256,
                                   .error_px_q8 = 512,
                                   .depth_max = 8,
                                   .sigma_q8 = 320,
                                   .view_wu = 30000 * METRE };
static const ff_panorama_desc far_ground = { .enabled = 1,
                                             .back_plane_wu = 7500 * METRE,
                                             .error_px_q8 = 6 * 256 };

/* ---- a modelled plant ---- */

enum { DETAIL, PLANE, PICTURE }; /* knobs; the last is the panorama's error */

/* A plant: log2 of the frame's and the link's cost with the coarsest knobs, and what each step of a
 * knob adds to either cost. */
typedef struct plant {
    double base[2], gain[3][2]; /* gain[knob][load] */
    double jump;                /* the tree's seventh level adds this to the frame's cost */
    double budget[2];           /* log2 */
    double delay_s;             /* until a move has its effect */
    double overrated;           /* log2 of (rate assumed for the link / true rate) */
    double noise;               /* the cost is off by at most this share, drawn anew each second */
    /* running */
    ff_balance balance;
    int64_t now_us, effect_us;
    ff_balance_knobs knobs; /* in effect */
    double bytes, wait_debt, factor[2];
    uint64_t seed;
} plant;

static double random_share(plant *p)
{
    p->seed = p->seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(p->seed >> 40) / (1 << 23) - 1;
}

static double true_load(const plant *p, int load, const ff_balance_knobs *knobs)
{
    const ff_balance_desc *coarsest = &p->balance.desc;
    double plane_wu = knobs->back_plane_wu ? knobs->back_plane_wu : finest.view_wu;
    double step[3] = {
        4 * log2((double)knobs->c_q8 / coarsest->c_min_q8) + knobs->depth_max - coarsest->depth_min,
        4 * log2(plane_wu / coarsest->back_plane_min_wu),
        2 * log2((double)coarsest->panorama_error_max_q8 / knobs->panorama_error_q8)
    };
    double sum = p->base[load] - p->budget[load] +
                 (load == FF_BALANCE_SHARE && knobs->depth_max >= 7 ? p->jump : 0);
    for (int knob = 0; knob < 3; knob++) sum += step[knob] * p->gain[knob][load];
    return sum;
}

static double load_now(const plant *p, int load)
{
    ff_balance_knobs knobs;
    ff_balance_get(&p->balance, &knobs);
    return true_load(p, load, &knobs);
}

static ff_balance_desc desc_of(const plant *p)
{
    return (ff_balance_desc){ .mode = FF_BALANCE_ON,
                              .frame_budget = (uint32_t)(exp2(p->budget[0]) + 0.5),
                              .link_percent = 50 };
}

static void plant_set(plant *p, int fresh)
{
    ff_balance_desc desc = desc_of(p);
    ff_balance_set(&p->balance, &desc, &finest, &far_ground, 1, fresh);
}

static void plant_open(plant *p)
{
    p->seed = 1;
    p->now_us = SECOND_US;
    p->factor[0] = p->factor[1] = 1;
    plant_set(p, 1);
    ff_balance_get(&p->balance, &p->knobs);
}

/* The link carries twice its budget (link_percent 50). Requests beyond that wait. */
static void plant_step(plant *p)
{
    ff_balance_sample sample = { .now_us = p->now_us += STEP_US, .rtt_us = 300000 };
    if (p->noise > 0 && p->now_us % SECOND_US == 0)
        for (int i = 0; i < 2; i++) p->factor[i] = 1 + p->noise * random_share(p);
    if (p->now_us >= p->effect_us) ff_balance_get(&p->balance, &p->knobs);
    double rate = 2 * exp2(p->budget[1]);
    double wanted = exp2(true_load(p, 1, &p->knobs) + p->budget[1]) * p->factor[1];
    /* requests wait for the share of time that they fill of the link */
    p->wait_debt += wanted < rate ? wanted / rate : 1;
    sample.waiting = p->wait_debt >= 1;
    p->wait_debt -= sample.waiting;
    p->bytes += (wanted < rate ? wanted : rate) * STEP_US / SECOND_US;
    sample.bytes_down = (uint64_t)p->bytes;
    sample.rate_bytes_s = (uint32_t)(rate * exp2(p->overrated));
    sample.frame_cost = (uint32_t)(exp2(true_load(p, 0, &p->knobs) + p->budget[0]) * p->factor[0]);
    sample.in_force = p->now_us >= p->effect_us;
    if (!ff_balance_feed(&p->balance, &sample)) return;
    /* no second move before the first one is in force */
    assert_true(p->delay_s > 9 || p->now_us >= p->effect_us);
    p->effect_us = p->now_us + (int64_t)(p->delay_s * SECOND_US);
}

static void plant_run(plant *p, double seconds)
{
    for (int64_t end_us = p->now_us + (int64_t)(seconds * SECOND_US); p->now_us < end_us;)
        plant_step(p);
}

static unsigned all_steps(const plant *p)
{
    return (unsigned)p->balance.top[0] + p->balance.top[1];
}

/* Within the stated number of decisions the balance stands still, and it stays so. Until then each
 * level turned at most once; twice when the input changed on the way, since the change may turn a
 * level and the answer to it once more. No load that could be lowered is left above its budget. */
static void assert_settles(plant *p, uint32_t turns_most)
{
    uint32_t turns = p->balance.turns, moves = p->balance.moves;
    plant_run(p, 2.0 * all_steps(p) * DECISION_S);
    assert_true(p->balance.moves - moves <= 2 * all_steps(p));
    assert_true(p->balance.turns - turns <= turns_most);
    moves = p->balance.moves;
    turns = p->balance.turns;
    plant_run(p, 3600);
    assert_int_equal(p->balance.turns, turns);
    /* a load close to a threshold may cross the threshold late */
    assert_true(p->balance.moves - moves <= (p->noise > 0 ? 4 : 0));
    for (int load = 0; load < 2; load++)
        assert_true(p->balance.level[load] == 0 ||
                    load_now(p, load) <= log2(1 + p->noise) + TOLERANCE);
}

/* ---- ladders ---- */

static void each_step_changes_one_knob(void **state)
{
    (void)state;
    ff_balance balance;
    ff_balance_desc desc = { .mode = FF_BALANCE_ON };
    ff_balance_knobs before, now;
    ff_balance_set(&balance, &desc, &finest, &far_ground, 1, 1);
    for (int which = 0; which < 2; which++) {
        balance.level[!which] = balance.top[!which];
        balance.level[which] = 0;
        ff_balance_get(&balance, &before);
        while (balance.level[which]++ < balance.top[which]) {
            ff_balance_get(&balance, &now);
            int plane = before.back_plane_wu != now.back_plane_wu,
                error = before.panorama_error_q8 != now.panorama_error_q8;
            assert_int_equal(
                (before.c_q8 != now.c_q8) + (before.depth_max != now.depth_max) + plane + error, 1);
            assert_int_equal(error, error && which == FF_BALANCE_FIDELITY);
            assert_int_equal(plane, plane && which == FF_BALANCE_SHARE);
            assert_true(now.c_q8 >= before.c_q8 && now.c_q8 * 4 <= before.c_q8 * 5 &&
                        now.depth_max >= before.depth_max);
            assert_true(now.depth_max <= before.depth_max + 1 &&
                        now.panorama_error_q8 <= before.panorama_error_q8);
            assert_true(!now.back_plane_wu || (now.back_plane_wu >= before.back_plane_wu &&
                                               now.back_plane_wu / 5 <= before.back_plane_wu / 4));
            before = now;
        }
        assert_int_equal(now.c_q8, finest.c_q8);
        assert_int_equal(now.depth_max, finest.depth_max);
    }
    assert_int_equal(now.back_plane_wu, 0);
    assert_int_equal(now.panorama_error_q8, far_ground.error_px_q8);
    balance.level[0] = balance.level[1] = 0;
    ff_balance_get(&balance, &now);
    assert_int_equal(now.c_q8, finest.c_q8 / 4);
    assert_int_equal(now.depth_max, 5);
    assert_int_equal(now.back_plane_wu, far_ground.back_plane_wu / 4 + 1);
    assert_int_equal(now.panorama_error_q8, far_ground.error_px_q8 * 4);
}

static void limits_are_kept(void **state)
{
    (void)state;
    ff_balance balance;
    ff_balance_knobs knobs;
    ff_quality pixels = {
        .measure = FF_MEASURE_PIXELS, .c_q8 = 768, .error_px_q8 = 256, .view_wu = 9000 * METRE
    };
    ff_balance_desc desc = { .mode = FF_BALANCE_ALL_SERVER,
                             .error_px_max_q8 = 1000,
                             .back_plane_min_wu = 2000 * METRE,
                             .panorama_error_max_q8 = 10 };
    ff_balance_set(&balance, &desc, &pixels, &far_ground, 1, 1);
    ff_balance_get(&balance, &knobs);
    assert_int_equal(knobs.error_px_q8, 1000);
    assert_int_equal(knobs.depth_max, 0);
    assert_int_equal(knobs.back_plane_wu, 2000 * METRE);
    /* a limit finer than the finest step limits nothing */
    assert_int_equal(knobs.panorama_error_q8, far_ground.error_px_q8);
    desc.mode = FF_BALANCE_ALL_CLIENT;
    ff_balance_set(&balance, &desc, &pixels, &far_ground, 1, 1);
    ff_balance_get(&balance, &knobs);
    assert_int_equal(knobs.error_px_q8, 256);
    assert_int_equal(knobs.back_plane_wu, 0);
    desc.mode = FF_BALANCE_ON;
    /* nobody draws panoramas: share moves detail alone */
    ff_balance_set(&balance, &desc, &pixels, &far_ground, 0, 1);
    for (int level = 0; level <= balance.top[0]; level++) {
        balance.level[0] = (uint8_t)level;
        ff_balance_get(&balance, &knobs);
        assert_int_equal(knobs.back_plane_wu, 0);
    }
    int32_t before = -1;
    for (uint64_t value = 1; value < UINT64_C(1) << 40; value += value / 7 + 1) {
        int32_t q8 = ff_balance_log2_q8(value);
        assert_true(q8 >= before && fabs(q8 - 256 * log2((double)value)) <= 5);
        before = q8;
    }
}

/* ---- settling ---- */

/* Every plant within the assumptions: a step adds to each load from nothing to half an octave, and
 * couplings have either sign. */
static void over_plants(double noise, double delay_s)
{
    static const double own[] = { 0, 0.05, 0.2, 0.48 }, cross[] = { -0.3, 0, 0.25 };
    for (int f = 0; f < 4; f++)
        for (int l = 0; l < 4; l++)
            for (int c = 0; c < 3; c++)
                for (int start = 0; start < 2; start++) {
                    plant p = { .base = { 9 + 3 * start, 8 + 4 * start },
                                .budget = { 12, 12 },
                                .noise = noise,
                                .delay_s = delay_s };
                    p.gain[DETAIL][0] = p.gain[PLANE][0] = own[f];
                    p.gain[DETAIL][1] = p.gain[PICTURE][1] = own[l];
                    p.gain[PLANE][1] = cross[c];
                    plant_open(&p);
                    assert_settles(&p, 2);
                }
}

static void settles_on_a_constant_input(void **state)
{
    (void)state;
    over_plants(0, 0.2);
}

static void settles_in_noise(void **state)
{
    (void)state;
    over_plants(NOISE, 0.2);
}

static void settles_when_moves_come_into_force_late(void **state)
{
    (void)state;
    over_plants(0, 7);
}

/* The frame's budget is halved and doubled, the link gets nine times slower and recovers: after
 * each change the balance settles anew, and uses the budgets. */
static void settles_after_steps_of_the_input(void **state)
{
    (void)state;
    static const double budget[][2] = { { 12, 14 }, { 11, 14 },   { 12, 14 }, { 12, 10.8 },
                                        { 12, 14 }, { 13, 10.8 }, { 11, 14 } };
    for (int noisy = 0; noisy < 2; noisy++) {
        plant p = { .base = { 8, 9 },
                    .gain = { { 0.22, 0.2 }, { 0.22, -0.1 }, { 0, 0.45 } },
                    .budget = { 12, 14 },
                    .delay_s = 1,
                    .noise = noisy ? NOISE : 0 };
        plant_open(&p);
        for (size_t i = 0; i < sizeof budget / sizeof *budget; i++) {
            memcpy(p.budget, budget[i], sizeof p.budget);
            plant_set(&p, 0);
            assert_settles(&p, 4);
            int frame_used = load_now(&p, 0) > -1 || p.balance.level[0] == p.balance.top[0];
            /* a budget, nothing else, holds the levels down */
            assert_true(frame_used || load_now(&p, 1) > -1);
            if (budget[i][1] > 13 && i < 5) /* with the good link fidelity came back */
                assert_int_equal(p.balance.level[1], p.balance.top[1]);
        }
    }
}

/* The frame's overload ends within seconds; it does not wait for the link's decisions. */
static void frame_overload_is_relieved_quickly(void **state)
{
    (void)state;
    plant p = { .base = { 8, 6 },
                .gain = { { 0.22, 0.1 }, { 0.22, 0 }, { 0, 0.1 } },
                .budget = { 13, 14 },
                .delay_s = 0.5 };
    plant_open(&p);
    assert_settles(&p, 4);
    p.budget[0] = 11;
    plant_set(&p, 0);
    plant_run(&p, 10);
    assert_true(load_now(&p, 0) <= TOLERANCE);
}

/* The link carries a sixteenth of what is asked for. The balance assumes a higher rate, but the
 * time that requests wait shows the truth: detail falls until they wait no more, and rises when the
 * link recovers. */
static void a_link_much_too_slow_is_spared(void **state)
{
    (void)state;
    for (int overrated = 0; overrated < 5; overrated += 4) {
        plant p = { .base = { 4, 9 },
                    .gain = { { 0.1, 0.3 }, { 0.1, 0 }, { 0, 0.4 } },
                    .budget = { 14, 16 },
                    .overrated = overrated };
        plant_open(&p);
        assert_settles(&p, 4);
        assert_int_equal(p.balance.level[0], p.balance.top[0]);
        p.budget[1] = 10;
        plant_set(&p, 0);
        plant_run(&p, 100);
        assert_true(load_now(&p, 1) <= TOLERANCE);
        assert_settles(&p, 4);
        p.base[1] = 7; /* the view asks for less */
        plant_set(&p, 0);
        p.balance.level[0] = 0;
        assert_settles(&p, 4);
        assert_true(p.balance.level[0] < p.balance.top[0] && p.knobs.depth_max < finest.depth_max);
        p.budget[1] = 16;
        plant_set(&p, 0);
        assert_settles(&p, 4);
        assert_int_equal(p.balance.level[0], p.balance.top[0]);
        assert_int_equal(p.balance.level[1], p.balance.top[1]);
    }
}

/* One step costs four times what the balance assumes: it tries the step, undoes it, remembers its
 * cost, and does not try it again and again. */
static void a_step_too_high_is_learned(void **state)
{
    (void)state;
    for (int noisy = 0; noisy < 2; noisy++) {
        plant p = { .base = { 6, 6 },
                    .gain = { { 0.2, 0 }, { 0.2, 0 }, { 0, 0.1 } },
                    .jump = 2,
                    .budget = { 10, 14 },
                    .noise = noisy ? NOISE : 0 };
        plant_open(&p);
        plant_run(&p, 2.0 * all_steps(&p) * DECISION_S);
        uint32_t moves = p.balance.moves;
        plant_run(&p, 36000);
        assert_true(p.balance.turns <= 8);
        assert_int_equal(p.balance.moves, moves);
        assert_int_equal(p.knobs.depth_max, 6);
        p.budget[0] = 14; /* the budget has room for the dear step */
        plant_set(&p, 0);
        assert_settles(&p, 4);
        assert_true(p.knobs.depth_max > 6);
    }
}

/* Every forty seconds rough ground costs a fifth more: the balance leaves the level that then
 * passes the budget once, and does not return to it. When the input changes, it forgets what that
 * relief taught. */
static void a_regular_input_does_not_drag_it_along(void **state)
{
    (void)state;
    plant p = { .base = { 6, 6 },
                .gain = { { 0.2, 0 }, { 0.2, 0 }, { 0, 0.1 } },
                .jump = 1,
                .budget = { 10, 14 } };
    plant_open(&p);
    plant_run(&p, 200);
    assert_int_equal(p.knobs.depth_max, 7);
    for (int i = 0; i < 100; i++) {
        p.base[0] += i % 2 ? -0.6 : 0.6;
        plant_run(&p, 20);
    }
    assert_true(p.balance.turns <= 4);
    assert_true(load_now(&p, 0) <= TOLERANCE);
    p.jump = 0;
    p.base[0] += 3;
    assert_settles(&p, 4);
    p.base[0] -= 3;
    assert_settles(&p, 4);
    assert_true(p.knobs.depth_max >= 7);
}

/* Nothing arrives: to ask for less would not help. Pauses measure nothing. */
static void silence_and_pauses_move_nothing(void **state)
{
    (void)state;
    plant p = { .base = { 8, 6 },
                .gain = { { 0.2, 0 }, { 0.2, 0 }, { 0, 0.2 } },
                .budget = { 12, 14 } };
    plant_open(&p);
    assert_settles(&p, 4);
    ff_balance_sample sample = { .now_us = p.now_us,
                                 .bytes_down = (uint64_t)p.bytes,
                                 .rate_bytes_s = 20000,
                                 .waiting = 1,
                                 .in_force = 1 };
    sample.frame_cost = 3000;
    for (int i = 0; i < 200; i++, sample.now_us += STEP_US)
        (void)ff_balance_feed(&p.balance, &sample); /* a window in which some bytes still arrived */
    uint32_t moves = p.balance.moves;
    for (int i = 0; i < 2000; i++, sample.now_us += STEP_US)
        assert_false(ff_balance_feed(&p.balance, &sample));
    sample.frame_cost = 1 << 20;
    for (int i = 0; i < 2000; i++, sample.now_us += STEP_US) {
        ff_balance_pause(&p.balance);
        assert_false(ff_balance_feed(&p.balance, &sample));
    }
    assert_int_equal(p.balance.moves, moves);
}

/* ---- a client ---- */

static void open_balanced(client_rig *rig, enum ff_balance_mode mode, uint32_t frame_budget)
{
    rig_open(rig, 0);
    rig->desc.quality = (ff_quality){ .c_q8 = 6 * 256, .depth_max = 4, .view_wu = 4000 * METRE };
    rig->desc.panorama = (ff_panorama_desc){ .enabled = 1, .back_plane_wu = 1500 * METRE };
    rig->desc.balance = (ff_balance_desc){ .mode = mode, .frame_budget = frame_budget };
    rig_client(rig, 4u << 20);
}

static void run(client_rig *rig, unsigned seconds)
{
    for (unsigned i = 0; i < seconds * 20; i++) {
        rig->camera.yaw = 3000 + 300 * (i / 2 % 2); /* a picture every other frame */
        rig_step(rig, STEP_US);
    }
}

static void a_client_follows_its_frame_budget(void **state)
{
    (void)state;
    static const uint32_t budget[] = { 1500, 700, 2500, 1000000 };
    client_rig rig;
    uint32_t triangles = 0;
    open_balanced(&rig, FF_BALANCE_ON, budget[0]);
    for (int i = 0; i < 4; i++) {
        rig.desc.balance.frame_budget = budget[i];
        ff_client_set_balance(rig.client, &rig.desc.balance);
        run(&rig, 300);
        ff_client_stats settled = rig_stats(&rig);
        assert_true(settled.tree.triangles <= budget[i] + budget[i] / 8 ||
                    settled.balance.share_percent == 0);
        assert_true(i == 0 || (settled.tree.triangles > triangles) == (budget[i] > budget[i - 1]));
        triangles = settled.tree.triangles;
        run(&rig, 120);
        assert_int_equal(rig_stats(&rig).balance.moves, settled.balance.moves);
    }
    int32_t position_wu[3];
    unsigned faces;
    /* a budget without end: all client */
    assert_int_equal(rig_stats(&rig).balance.share_percent, 100);
    assert_int_equal(rig_stats(&rig).back_plane_wu, 0);
    assert_false(ff_client_panorama(rig.client, position_wu, &faces));
    ff_client_frame_cost(rig.client, 2000000); /* a cost in another unit, above the budget */
    run(&rig, 60);
    assert_true(rig_stats(&rig).balance.share_percent < 30);
    assert_true(rig_stats(&rig).balance.frame_load_q8 > 200);
    assert_true(ff_client_panorama(rig.client, position_wu, &faces));
    assert_int_equal(rig_stats(&rig).panoramas_in_flight_high, 1);
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
    assert_int_equal(s.quality.c_q8, 6 * 64);
    assert_int_equal(s.quality.depth_max, 2);
    assert_int_equal(c.back_plane_wu, 0);
    assert_int_equal(c.quality.c_q8, 6 * 256);
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

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(each_step_changes_one_knob),
                                        cmocka_unit_test(limits_are_kept),
                                        cmocka_unit_test(settles_on_a_constant_input),
                                        cmocka_unit_test(settles_in_noise),
                                        cmocka_unit_test(settles_when_moves_come_into_force_late),
                                        cmocka_unit_test(settles_after_steps_of_the_input),
                                        cmocka_unit_test(frame_overload_is_relieved_quickly),
                                        cmocka_unit_test(a_link_much_too_slow_is_spared),
                                        cmocka_unit_test(a_regular_input_does_not_drag_it_along),
                                        cmocka_unit_test(a_step_too_high_is_learned),
                                        cmocka_unit_test(silence_and_pauses_move_nothing),
                                        cmocka_unit_test(a_client_follows_its_frame_budget),
                                        cmocka_unit_test(the_ends_and_off),
                                        cmocka_unit_test(the_back_plane_waits_for_its_panorama) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
