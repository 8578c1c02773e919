/* The balance: its ladders; modelled plants (constant, noisy, stepping, late), within and beyond
 * what its argument assumes. Against each of them it settles, does not cycle, and uses its budget.
 */
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
#define DECISION_S 20   /* settling at most 10 s, the link's window 8, two seconds of the frame's */
#define NOISE      0.12 /* of a second's cost: below 1.5 FF_BALANCE_NOISE_Q4 */
#define TOLERANCE  0.14 /* FF_BALANCE_NOISE_Q4 in octaves, and what rounding loses */
#define USED       0.85 /* of the frame's budget, where the ground needs it */

static const ff_quality finest = { .measure = FF_MEASURE_PIXELS,
                                   .c_q8 = 9 * 256,
                                   .error_px_q8 = 256,
                                   .sigma_q8 = 320,
                                   .view_wu = 30000 * METRE,
                                   .triangles_max = 38400 };
static const ff_panorama_desc far_ground = { .enabled = 1,
                                             .back_plane_wu = 7500 * METRE,
                                             .error_px_q8 = 6 * 256 };

/* ---- a modelled plant ---- */

enum { FRAME, LINK };

/* A plant. All in log2 units. The ground needs `needed` triangles at a pixel of error, and `slope`
 * octaves fewer for each octave of error. A frame costs `fixed` and `each` for each triangle; the
 * link's bytes go with the triangles, `per_triangle` octaves for each octave, and with the
 * panorama's error, `per_error`. */
typedef struct plant {
    double needed, slope, each, fixed, bytes, per_triangle, per_error;
    double jump, jump_at; /* a frame of more triangles than jump_at costs this more */
    double dearer;        /* a frame costs this more */
    double budget[2];
    double delay_s;   /* until a move has its effect */
    double overrated; /* rate assumed for the link / true rate */
    double noise;     /* the cost is off by at most this share, drawn anew each second */
    int counted;      /* frames cost triangles */
    /* running */
    ff_balance balance;
    int64_t now_us, effect_us;
    uint64_t seed;
    ff_balance_knobs knobs; /* in effect */
    double received, wait_debt, factor[2];
} plant;

/* needs more triangles than any budget */
static const plant rough = { .needed = 18,
                             .slope = 1,
                             .each = 1,
                             .bytes = 6,
                             .budget = { 14, 14 } };

static double random_share(plant *p)
{
    p->seed = p->seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(p->seed >> 40) / (1 << 23) - 1;
}

static double needed_at(const plant *p, double error_px_q8)
{
    return p->needed - p->slope * log2(error_px_q8 / finest.error_px_q8);
}

static double drawn_with(const plant *p, const ff_balance_knobs *knobs)
{
    return fmin(needed_at(p, knobs->error_px_q8), log2(knobs->triangles_max));
}

static double frame_cost(const plant *p, double drawn)
{
    double cost = p->dearer + (drawn > p->jump_at ? p->jump : 0);
    return cost + log2(exp2(p->fixed) + exp2(p->each + drawn));
}

static double true_load(const plant *p, int load, const ff_balance_knobs *knobs)
{
    double drawn = drawn_with(p, knobs);
    if (load == FRAME) return (p->counted ? drawn : frame_cost(p, drawn)) - p->budget[FRAME];
    return p->bytes + p->per_triangle * (drawn - 10) - p->budget[LINK] -
           p->per_error * log2((double)knobs->panorama_error_q8 / far_ground.error_px_q8);
}

static ff_balance_knobs knobs_now(const plant *p)
{
    ff_balance_knobs knobs;
    ff_balance_get(&p->balance, &knobs);
    return knobs;
}

static double load_now(const plant *p, int load)
{
    ff_balance_knobs knobs = knobs_now(p);
    return true_load(p, load, &knobs);
}

static uint32_t limit_now(const plant *p) { return knobs_now(p).triangles_max; }

static void plant_set(plant *p, int fresh)
{
    ff_balance_desc desc = { .mode = FF_BALANCE_ON,
                             .frame_budget = (uint32_t)(exp2(p->budget[FRAME]) + 0.5),
                             .link_percent = 50 };
    ff_balance_set(&p->balance, &desc, &finest, &far_ground, !p->counted, fresh);
}

static void plant_open(plant *p)
{
    p->seed = 1;
    p->now_us = SECOND_US;
    p->factor[FRAME] = p->factor[LINK] = 1;
    if (!p->jump) p->jump_at = 99;
    plant_set(p, 1);
    p->knobs = knobs_now(p);
}

/* What is in force: where the limit binds, as much coarser as it takes. */
static double error_in_force(const plant *p)
{
    double more = needed_at(p, p->knobs.error_px_q8) - log2(p->knobs.triangles_max);
    return more > 0 ? p->knobs.error_px_q8 * exp2(more / p->slope) : p->knobs.error_px_q8;
}

/* The link carries twice its budget (link_percent 50). Requests beyond that wait. */
static void plant_step(plant *p)
{
    ff_balance_sample sample = { .now_us = p->now_us += STEP_US,
                                 .rtt_us = 300000,
                                 .c_q8 = finest.c_q8 };
    if (p->noise > 0 && p->now_us % SECOND_US == 0)
        for (int i = 0; i < 2; i++) p->factor[i] = 1 + p->noise * random_share(p);
    if (p->now_us >= p->effect_us) p->knobs = knobs_now(p);
    double rate = 2 * exp2(p->budget[LINK]);
    double wanted = exp2(true_load(p, LINK, &p->knobs) + p->budget[LINK]) * p->factor[LINK];
    /* requests wait for the share of time that they fill of the link */
    p->wait_debt += wanted < rate ? wanted / rate : 1;
    sample.waiting = p->wait_debt >= 1;
    p->wait_debt -= sample.waiting;
    p->received += (wanted < rate ? wanted : rate) * STEP_US / SECOND_US;
    sample.bytes_down = (uint64_t)p->received;
    sample.rate_bytes_s = (uint32_t)(rate * exp2(p->overrated));
    sample.frame_cost = p->counted ? 0
                                   : (uint32_t)(exp2(frame_cost(p, drawn_with(p, &p->knobs))) *
                                                p->factor[FRAME]);
    sample.triangles = (uint32_t)exp2(drawn_with(p, &p->knobs));
    sample.error_px_q8 = (int32_t)fmin(error_in_force(p), INT32_MAX);
    if (!ff_balance_feed(&p->balance, &sample)) return;
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

/* Whether steps down are left that change anything. */
static int could_go_down(const plant *p, int load)
{
    double coarsest = needed_at(p, p->balance.desc.error_px_max_q8);
    if (!p->balance.level[load]) return 0;
    return load == FRAME ? drawn_with(p, &p->knobs) > log2(FF_TRIANGLES_MIN)
                         : coarsest < drawn_with(p, &p->knobs) - p->slope / 4;
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
    /* a load close to a threshold may cross the threshold late: half an octave of the share */
    assert_true(p->balance.moves - moves <= (p->noise > 0 ? 8 : 0));
    for (int load = 0; load < 2; load++)
        assert_true(!could_go_down(p, load) || load_now(p, load) <= log2(1 + p->noise) + TOLERANCE);
}

/* Where the ground needs more triangles than the limit, and the link has room for more, the frame's
 * budget is used. */
static void assert_uses_the_budget(const plant *p)
{
    int limited = needed_at(p, p->knobs.error_px_q8) > log2(p->knobs.triangles_max) + 0.01;
    if (!limited || p->balance.level[FRAME] == p->balance.top[FRAME]) return;
    assert_true(load_now(p, LINK) > -0.75 ||
                load_now(p, FRAME) >= log2(USED) - 2 * log2(1 + p->noise));
}

/* ---- ladders ---- */

static void each_step_changes_one_knob(void **state)
{
    (void)state;
    for (int distance = 0; distance < 2; distance++) {
        ff_balance balance;
        ff_balance_desc desc = { .mode = FF_BALANCE_ON, .frame_budget = 9 };
        ff_balance_knobs before, now;
        ff_quality quality = finest;
        if (distance) quality.measure = FF_MEASURE_DISTANCE;
        ff_balance_set(&balance, &desc, &quality, &far_ground, 1, 1);
        for (int which = 0; which < 2; which++) {
            balance.level[!which] = balance.top[!which];
            balance.level[which] = 0;
            ff_balance_get(&balance, &before);
            while (balance.level[which]++ < balance.top[which]) {
                ff_balance_get(&balance, &now);
                int limit = before.triangles_max != now.triangles_max,
                    detail = before.c_q8 != now.c_q8 || before.error_px_q8 != now.error_px_q8,
                    error = before.panorama_error_q8 != now.panorama_error_q8;
                assert_int_equal(limit + detail + error, 1);
                assert_int_equal(limit, which == FF_BALANCE_SHARE);
                assert_true(now.triangles_max >= before.triangles_max &&
                            now.triangles_max <= before.triangles_max * 1.0451);
                assert_true(now.c_q8 >= before.c_q8 && now.c_q8 * 4 <= before.c_q8 * 5);
                assert_true(now.error_px_q8 <= before.error_px_q8 &&
                            now.error_px_q8 * 5 >= before.error_px_q8 * 4 - 4);
                assert_true(now.panorama_error_q8 <= before.panorama_error_q8);
                assert_int_equal(now.back_plane_wu, far_ground.back_plane_wu);
                before = now;
            }
        }
        assert_int_equal(now.c_q8, finest.c_q8);
        assert_int_equal(now.error_px_q8, finest.error_px_q8);
        assert_int_equal(now.triangles_max, finest.triangles_max);
        assert_int_equal(now.panorama_error_q8, far_ground.error_px_q8);
        balance.level[0] = balance.level[1] = 0;
        ff_balance_get(&balance, &now);
        assert_int_equal(now.c_q8, distance ? finest.c_q8 / 4 : finest.c_q8);
        assert_int_equal(now.error_px_q8, distance ? finest.error_px_q8 : 8 * finest.error_px_q8);
        assert_int_equal(now.triangles_max, FF_TRIANGLES_MIN);
        assert_int_equal(now.panorama_error_q8, far_ground.error_px_q8 * 4);
    }
}

static ff_balance_knobs knobs_of(const ff_balance_desc *desc, const ff_panorama_desc *panorama,
                                 int reported)
{
    ff_balance balance;
    ff_balance_knobs knobs;
    ff_balance_set(&balance, desc, &finest, panorama, reported, 1);
    ff_balance_get(&balance, &knobs);
    return knobs;
}

static void limits_are_kept(void **state)
{
    (void)state;
    ff_balance_desc desc = { .mode = FF_BALANCE_ALL_SERVER,
                             .frame_budget = 5000,
                             .back_plane_min_wu = 2000 * METRE,
                             .panorama_error_max_q8 = 10 };
    ff_balance_knobs knobs = knobs_of(&desc, &far_ground, 0);
    assert_int_equal(knobs.error_px_q8, finest.error_px_q8);
    assert_int_equal(knobs.triangles_max, FF_TRIANGLES_MIN);
    assert_int_equal(knobs.back_plane_wu, 2000 * METRE);
    /* a limit finer than the finest step limits nothing */
    assert_int_equal(knobs.panorama_error_q8, far_ground.error_px_q8);
    desc.mode = FF_BALANCE_ALL_CLIENT;
    knobs = knobs_of(&desc, &far_ground, 0);
    assert_int_equal(knobs.error_px_q8, finest.error_px_q8);
    assert_int_equal(knobs.triangles_max, finest.triangles_max);
    assert_int_equal(knobs.back_plane_wu, 0);
    desc.mode = FF_BALANCE_ON;
    /* a budget of triangles is the limit, at once and exactly */
    knobs = knobs_of(&desc, NULL, 0);
    assert_true(knobs.triangles_max == 5000 && !knobs.back_plane_wu);
    desc.frame_budget = 7;
    assert_int_equal(knobs_of(&desc, NULL, 0).triangles_max, FF_TRIANGLES_MIN);
    /* without a budget, or with one beyond it, the limit is the one set */
    desc.frame_budget = UINT32_MAX;
    assert_int_equal(knobs_of(&desc, NULL, 0).triangles_max, finest.triangles_max);
    desc.frame_budget = 0;
    assert_int_equal(knobs_of(&desc, NULL, 0).triangles_max, finest.triangles_max);
    assert_int_equal(knobs_of(&desc, NULL, 1).triangles_max, finest.triangles_max);
    int32_t before = -1;
    for (uint64_t value = 1; value < UINT64_C(1) << 40; value += value / 7 + 1) {
        int32_t q8 = ff_balance_log2_q8(value);
        assert_true(q8 >= before && fabs(q8 - 256 * log2((double)value)) <= 5);
        before = q8;
    }
}

/* ---- settling ---- */

/* Every plant within the assumptions: costs in proportion to triangles or with a constant part,
 * bytes that follow the triangles or do not, or go against them. */
static void over_plants(double noise, double delay_s)
{
    static const double slope[] = { 0.5, 1, 2 }, link[] = { -0.3, 0, 0.5, 1 },
                        fixed[] = { 0, 12.5, 14.5 };
    for (int s = 0; s < 3; s++)
        for (int l = 0; l < 4; l++)
            for (int f = 0; f < 3; f++)
                for (int start = 0; start < 6; start++) {
                    plant p = { .needed = start % 2 ? 18 : 12.5,
                                .slope = slope[s],
                                .each = start / 2 - 1,
                                .fixed = fixed[f],
                                .bytes = 9 + start,
                                .per_triangle = link[l],
                                .per_error = start % 2 ? 0.9 : 0.2,
                                .budget = { 14, 12 },
                                .noise = noise,
                                .delay_s = delay_s };
                    plant_open(&p);
                    assert_settles(&p, noise > 0 ? 4 : 2);
                    assert_uses_the_budget(&p);
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

/* A budget of triangles is kept by the limit: whatever the costs, no level follows the frames, and
 * fidelity follows the link. */
static void a_budget_of_triangles_needs_no_controller(void **state)
{
    (void)state;
    plant p = rough;
    p.counted = 1;
    p.bytes = 9;
    p.per_triangle = 0.5;
    p.per_error = 0.4;
    p.budget[FRAME] = 12;
    plant_open(&p);
    assert_int_equal(limit_now(&p), 4096);
    assert_settles(&p, 0);
    assert_int_equal(p.balance.moves, 0);
    assert_true(fabs(load_now(&p, FRAME)) < 0.01 && p.balance.load_q8[FRAME] < 8);
    p.budget[FRAME] = 9; /* fewer than the fewest triangles */
    plant_set(&p, 0);
    assert_settles(&p, 0);
    assert_int_equal(p.balance.moves, 0);
    p.budget[LINK] = 8;
    plant_set(&p, 0);
    assert_settles(&p, 2);
    assert_true(p.balance.level[FF_BALANCE_FIDELITY] < p.balance.top[FF_BALANCE_FIDELITY]);
}

/* The frame's budget is halved and doubled, the link gets nine times slower and recovers: after
 * each change the balance settles anew, and uses the budgets. */
static void settles_after_steps_of_the_input(void **state)
{
    (void)state;
    static const double budget[][2] = { { 14, 14 }, { 13, 14 },   { 14, 14 }, { 14, 10.8 },
                                        { 14, 14 }, { 15, 10.8 }, { 13, 14 } };
    for (int noisy = 0; noisy < 2; noisy++) {
        plant p = rough;
        p.slope = 1.2;
        p.fixed = p.bytes = 10;
        p.per_triangle = 0.8;
        p.per_error = 0.5;
        p.delay_s = 1;
        p.noise = noisy ? NOISE : 0;
        plant_open(&p);
        for (size_t i = 0; i < sizeof budget / sizeof *budget; i++) {
            memcpy(p.budget, budget[i], sizeof p.budget);
            plant_set(&p, 0);
            assert_settles(&p, 4);
            assert_uses_the_budget(&p);
            if (budget[i][1] > 13) /* with the good link fidelity came back */
                assert_int_equal(p.balance.level[1], p.balance.top[1]);
        }
    }
}

/* The frame's overload ends within seconds, however far the limit lies above what is drawn; it does
 * not wait for the link's decisions. */
static void frame_overload_is_relieved_quickly(void **state)
{
    (void)state;
    for (int loose = 0; loose < 2; loose++) {
        plant p = rough;
        p.delay_s = 0.5;
        p.needed = loose ? 13 : 18;
        p.budget[FRAME] = loose ? 17 : 14.5;
        plant_open(&p);
        p.balance.level[FRAME] = p.balance.top[FRAME];
        if (!loose) assert_settles(&p, 4);
        assert_true(limit_now(&p) > (loose ? 4 << 13 : 1 << 13));
        p.budget[FRAME] = 12.5;
        plant_set(&p, 0);
        plant_run(&p, 4);
        assert_true(load_now(&p, FRAME) <= TOLERANCE);
        assert_true(load_now(&p, FRAME) >= log2(USED));
    }
}

/* Ground that needs few triangles does not let the limit drift up: when it needs more again, the
 * budget is kept from the first frame on. */
static void the_limit_stays_where_the_budget_allows(void **state)
{
    (void)state;
    plant p = rough;
    plant_open(&p);
    assert_settles(&p, 2);
    uint32_t limit = limit_now(&p);
    p.needed = 10.5;
    plant_run(&p, 600);
    assert_true(load_now(&p, FRAME) < -2);
    p.needed = 18;
    assert_true(limit_now(&p) <= limit * 1.0451);
    assert_true(load_now(&p, FRAME) <= 0);
}

/* The link carries a sixteenth of what is asked for. The balance assumes a higher rate, but the
 * time that requests wait shows the truth: detail falls until they wait no more, though at first
 * the limit of triangles is what makes it coarse, and rises when the link recovers. */
static void a_link_much_too_slow_is_spared(void **state)
{
    (void)state;
    for (int overrated = 0; overrated < 5; overrated += 4) {
        plant p = rough;
        p.needed = 14.5;
        p.slope = 1.2;
        p.bytes = 11;
        p.per_triangle = 1.5;
        p.per_error = 0.6;
        p.budget[LINK] = 19;
        p.overrated = overrated;
        plant_open(&p);
        assert_settles(&p, 4);
        uint8_t share = p.balance.level[FRAME];
        assert_int_equal(p.balance.level[LINK], p.balance.top[LINK]);
        p.budget[LINK] = 11.5;
        plant_set(&p, 0);
        plant_run(&p, 100);
        assert_true(load_now(&p, LINK) <= TOLERANCE);
        assert_settles(&p, 4);
        assert_true(needed_at(&p, p.knobs.error_px_q8) < log2(p.knobs.triangles_max));
        p.bytes = 9; /* the view asks for less */
        plant_set(&p, 0);
        p.balance.level[LINK] = 0;
        assert_settles(&p, 4);
        assert_in_range(p.balance.level[LINK], 1, p.balance.top[LINK] - 1);
        p.budget[LINK] = 19;
        plant_set(&p, 0);
        assert_settles(&p, 4);
        assert_true(p.balance.level[FRAME] >= share - 1);
        assert_int_equal(p.balance.level[LINK], p.balance.top[LINK]);
        assert_uses_the_budget(&p);
    }
}

/* One step costs four times what the balance assumes: it tries the step, undoes it, remembers its
 * cost, and does not try it again and again. */
static void a_step_too_high_is_learned(void **state)
{
    (void)state;
    for (int noisy = 0; noisy < 2; noisy++) {
        plant p = rough;
        p.each = 0;
        p.jump = 2;
        p.jump_at = 13;
        p.noise = noisy ? NOISE : 0;
        plant_open(&p);
        plant_run(&p, 2.0 * all_steps(&p) * DECISION_S);
        uint32_t moves = p.balance.moves;
        plant_run(&p, 36000);
        assert_true(p.balance.turns <= 10);
        assert_int_equal(p.balance.moves, moves);
        /* the next step is the dear one */
        assert_true(limit_now(&p) <= 8192 && limit_now(&p) * 1.0451 > 8192);
        p.budget[FRAME] = 16; /* the budget has room for the dear step */
        plant_set(&p, 0);
        assert_settles(&p, 4);
        assert_true(limit_now(&p) > 8192);
        assert_uses_the_budget(&p);
    }
}

/* Every fourteen seconds frames cost half as much again for four: the balance leaves the level that
 * then passes the budget once, and does not return to it. When that is over, it does. */
static void a_regular_input_does_not_drag_it_along(void **state)
{
    (void)state;
    plant p = rough;
    plant_open(&p);
    plant_run(&p, 200);
    uint32_t limit = limit_now(&p), turns = p.balance.turns;
    for (int i = 0; i < 400; i++) {
        p.dearer = i % 2 ? 0 : 0.6;
        plant_run(&p, i % 2 ? 10 : 4);
    }
    assert_true(p.balance.turns - turns <= 2);
    assert_true(load_now(&p, FRAME) + 0.6 <= TOLERANCE && load_now(&p, FRAME) + 0.6 >= log2(USED));
    p.dearer += 3;
    assert_settles(&p, 4);
    p.dearer -= 3;
    assert_settles(&p, 4);
    assert_true(limit_now(&p) >= limit);
}

/* Every forty seconds the view asks for half as many bytes again. */
static void a_regular_link_does_not_drag_it_along(void **state)
{
    (void)state;
    plant p = { .needed = 14,
                .slope = 1,
                .bytes = 8,
                .per_triangle = 0.8,
                .per_error = 0.4,
                .budget = { 16, 9.5 } };
    plant_open(&p);
    plant_run(&p, 400);
    uint32_t turns = p.balance.turns;
    for (int i = 0; i < 100; i++) {
        p.bytes += i % 2 ? -0.6 : 0.6;
        plant_run(&p, 20);
    }
    assert_true(p.balance.turns - turns <= 4);
    assert_true(load_now(&p, LINK) <= TOLERANCE);
}

/* Nothing arrives: to ask for less would not help. Pauses measure nothing. */
static void silence_and_pauses_move_nothing(void **state)
{
    (void)state;
    plant p = {
        .needed = 18, .slope = 1, .each = 1, .bytes = 6, .per_error = 0.4, .budget = { 14, 14 }
    };
    plant_open(&p);
    assert_settles(&p, 4);
    ff_balance_sample sample = { .now_us = p.now_us,
                                 .frame_cost = 15500,
                                 .triangles = limit_now(&p),
                                 .c_q8 = finest.c_q8,
                                 .error_px_q8 = finest.error_px_q8,
                                 .bytes_down = (uint64_t)p.received,
                                 .rate_bytes_s = 20000,
                                 .waiting = 1 };
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

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(each_step_changes_one_knob),
                                        cmocka_unit_test(limits_are_kept),
                                        cmocka_unit_test(settles_on_a_constant_input),
                                        cmocka_unit_test(settles_in_noise),
                                        cmocka_unit_test(settles_when_moves_come_into_force_late),
                                        cmocka_unit_test(a_budget_of_triangles_needs_no_controller),
                                        cmocka_unit_test(settles_after_steps_of_the_input),
                                        cmocka_unit_test(the_limit_stays_where_the_budget_allows),
                                        cmocka_unit_test(frame_overload_is_relieved_quickly),
                                        cmocka_unit_test(a_link_much_too_slow_is_spared),
                                        cmocka_unit_test(a_regular_input_does_not_drag_it_along),
                                        cmocka_unit_test(a_regular_link_does_not_drag_it_along),
                                        cmocka_unit_test(a_step_too_high_is_learned),
                                        cmocka_unit_test(silence_and_pauses_move_nothing) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
