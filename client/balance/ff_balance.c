#include "ff_balance.h"
#include "../../protocol/ff_assert.h"

#include <string.h>

#define SETTLE_US         500000 /* after a move, besides two round trips */
#define SETTLE_US_MAX     10000000
#define FRAME_WINDOW_US   1000000
#define LINK_WINDOW_US    8000000
#define BLAME_US          30000000 /* a relief sooner than this after a raise undoes the raise */
#define SATURATED_PERCENT 90       /* of the time something waits */
/* A link that brings less than one in SILENT_SHARE of the bytes it can carry is silent: asking for
 * less does not help then. */
#define SILENT_SHARE     32
#define PERCENT_DEFAULT  80
#define DEPTH_LESS       3
#define DEPTH_LEAST      2
#define C_STEPS_MAX      16
#define PLANE_STEPS_MAX  24
#define ERROR_STEPS_MAX  12
#define ERROR_QUARTERS   2  /* the panorama's error changes by half an octave */
#define RELIEF_STEP_Q8   64 /* what a step down is taken to spare: a quarter of an octave */
#define GAIN_Q8(gain_q4) ((int32_t)(gain_q4)*16)
#define BULGE_Q8         88
#define TOLERANCE_Q8     GAIN_Q8(FF_BALANCE_NOISE_Q4)

/* the longest ladders: gain_q4 has a place for each step, and a level is a byte */
FF_STATIC_ASSERT(C_STEPS_MAX + FF_QUALITY_DEPTH_MAX + PLANE_STEPS_MAX <= FF_BALANCE_STEPS_MAX);
FF_STATIC_ASSERT(ERROR_STEPS_MAX <= PLANE_STEPS_MAX && FF_BALANCE_STEPS_MAX <= UINT8_MAX);
FF_STATIC_ASSERT(FF_BALANCE_LEVELS == 2); /* ff_balance_set names both */
FF_STATIC_ASSERT(FF_BALANCE_GAIN_Q4 <= UINT8_MAX);
FF_STATIC_ASSERT(TOLERANCE_Q8 < RELIEF_STEP_Q8 && RELIEF_STEP_Q8 == 256 / 4);
/* what a raise does is measured while it may still be blamed */
FF_STATIC_ASSERT(SETTLE_US < SETTLE_US_MAX && SETTLE_US_MAX + LINK_WINDOW_US < BLAME_US);
/* a link's window has seen frames */
FF_STATIC_ASSERT(FRAME_WINDOW_US < LINK_WINDOW_US);

int32_t ff_balance_log2_q8(uint64_t value)
{
    int32_t whole = 0;
    if (!value) return 0;
    for (uint64_t rest = value; rest >>= 1;) whole++;
    int32_t part = (int32_t)((whole >= 8 ? value >> (whole - 8) : value << (8 - whole)) - 256);
    FF_ASSERT(whole < 64 && part >= 0 && part < 256);
    /* log2(1 + p) is about p + 0.344 p (1 - p) */
    return whole * 256 + part + (part * (256 - part) * BULGE_Q8 >> 16);
}

/* ---- the ladders ---- */

/* value / 2^(quarters / 4) */
static int64_t lessened(int64_t value, unsigned quarters)
{
    static const int32_t root_q16[4] = { 65536, 55109, 46341, 38968 };
    FF_ASSERT(value > 0 && value <= INT32_MAX && quarters / 4 < 32);
    return (value >> quarters / 4) * root_q16[quarters % 4] >> 16;
}

static uint8_t steps_between(int64_t high, int64_t low, unsigned quarters, unsigned most)
{
    unsigned steps = 0;
    FF_ASSERT(low > 0);
    while (steps < most && lessened(high, steps * quarters) > low) steps++;
    return (uint8_t)steps;
}

/* The value that lies `below` steps under the top of a ladder of `steps` steps from `high` down to
 * `low`. */
static int32_t on_ladder(int64_t high, int64_t low, unsigned below, unsigned steps,
                         unsigned quarters)
{
    FF_ASSERT(below <= steps);
    int64_t value = lessened(high, below * quarters);
    return (int32_t)(below && (below == steps || value < low) ? low : value);
}

/* A ladder mixes `first` steps of one kind and `second` steps of another evenly. Returns how many
 * of its lowest `level` steps are of the first kind: each step up changes one of the two kinds by
 * one. */
static unsigned first_kind(unsigned level, unsigned first, unsigned second)
{
    unsigned all = first + second, kind = all ? (level * first + all / 2) / all : 0;
    FF_ASSERT(level <= all && kind <= first && level - kind <= second);
    return kind;
}

static unsigned detail_steps(const ff_balance *balance)
{
    return (unsigned)balance->c_steps + balance->depth_steps;
}

/* What two levels stand for: how many steps of each kind they have climbed. */
typedef struct place {
    unsigned detail, cap, plane, error;
} place;

static place place_of(const ff_balance *balance, unsigned share, unsigned fidelity)
{
    place at = { .detail = first_kind(share, detail_steps(balance), balance->plane_steps),
                 .cap = first_kind(fidelity, detail_steps(balance), balance->error_steps) };
    at.plane = share - at.detail;
    at.error = fidelity - at.cap;
    return at;
}

void ff_balance_get(const ff_balance *balance, ff_balance_knobs *knobs)
{
    const ff_balance_desc *desc = &balance->desc;
    const ff_quality *finest = &balance->finest;
    place at = place_of(balance, balance->level[FF_BALANCE_SHARE],
                        balance->level[FF_BALANCE_FIDELITY]);
    unsigned detail = at.detail < at.cap ? at.detail : at.cap,
             c = first_kind(detail, balance->c_steps, balance->depth_steps);
    knobs->c_q8 = finest->c_q8;
    knobs->error_px_q8 = finest->error_px_q8;
    if (finest->measure == FF_MEASURE_DISTANCE)
        knobs->c_q8 = on_ladder(finest->c_q8, desc->c_min_q8, balance->c_steps - c,
                                balance->c_steps, 1);
    else /* the least error is the finest: this ladder is climbed downwards */
        knobs->error_px_q8 = on_ladder(desc->error_px_max_q8, finest->error_px_q8, c,
                                       balance->c_steps, 1);
    knobs->depth_max = (uint8_t)(finest->depth_max - (balance->depth_steps - (detail - c)));
    knobs->back_plane_wu = at.plane == balance->plane_steps
                               ? 0
                               : on_ladder(finest->view_wu, desc->back_plane_min_wu,
                                           balance->plane_steps - at.plane, balance->plane_steps,
                                           1);
    knobs->panorama_error_q8 = on_ladder(desc->panorama_error_max_q8, balance->panorama_error_q8,
                                         at.error, balance->error_steps, ERROR_QUARTERS);
    FF_ASSERT(knobs->c_q8 > 0 && knobs->c_q8 <= finest->c_q8);
    FF_ASSERT(knobs->error_px_q8 >= finest->error_px_q8);
    FF_ASSERT(knobs->depth_max >= desc->depth_min && knobs->depth_max <= finest->depth_max);
    FF_ASSERT(knobs->panorama_error_q8 >= balance->panorama_error_q8);
}

/* Fills in limits that were left out; a limit finer than the finest becomes the finest. */
static void complete(ff_balance_desc *desc, const ff_quality *finest,
                     const ff_panorama_desc *panorama)
{
    FF_ASSERT(finest->c_q8 > 0 && finest->error_px_q8 > 0 && finest->view_wu > 0);
    FF_ASSERT(panorama->error_px_q8 > 0 && panorama->back_plane_wu > 0);
    if (!desc->link_percent || desc->link_percent > 100) desc->link_percent = PERCENT_DEFAULT;
    if (desc->c_min_q8 <= 0) desc->c_min_q8 = finest->c_q8 / 4;
    if (desc->c_min_q8 > finest->c_q8 || desc->c_min_q8 <= 0) desc->c_min_q8 = finest->c_q8;
    if (desc->error_px_max_q8 <= 0)
        desc->error_px_max_q8 = finest->error_px_q8 > INT32_MAX / 8 ? INT32_MAX
                                                                    : finest->error_px_q8 * 8;
    if (desc->error_px_max_q8 < finest->error_px_q8) desc->error_px_max_q8 = finest->error_px_q8;
    if (!desc->depth_min)
        desc->depth_min = (uint8_t)(finest->depth_max > DEPTH_LESS + DEPTH_LEAST
                                        ? finest->depth_max - DEPTH_LESS
                                        : DEPTH_LEAST);
    if (desc->depth_min > finest->depth_max) desc->depth_min = finest->depth_max;
    if (desc->back_plane_min_wu <= 0) desc->back_plane_min_wu = panorama->back_plane_wu / 4 + 1;
    if (desc->panorama_error_max_q8 <= 0)
        desc->panorama_error_max_q8 = panorama->error_px_q8 > INT32_MAX / 4
                                          ? INT32_MAX
                                          : panorama->error_px_q8 * 4;
    if (desc->panorama_error_max_q8 < panorama->error_px_q8)
        desc->panorama_error_max_q8 = panorama->error_px_q8;
}

/* ---- measuring ---- */

static void forget(ff_balance *balance)
{
    memset(balance->gain_q4, FF_BALANCE_GAIN_Q4, sizeof balance->gain_q4);
    balance->raised = balance->lowered = 0;
}

void ff_balance_set(ff_balance *balance, const ff_balance_desc *desc, const ff_quality *quality,
                    const ff_panorama_desc *panorama, int can_panorama, int fresh)
{
    if (fresh) memset(balance, 0, sizeof *balance);
    balance->desc = *desc;
    balance->finest = *quality;
    balance->panorama_error_q8 = panorama->error_px_q8;
    complete(&balance->desc, quality, panorama);
    desc = &balance->desc;
    balance->c_steps = quality->measure == FF_MEASURE_DISTANCE
                           ? steps_between(quality->c_q8, desc->c_min_q8, 1, C_STEPS_MAX)
                           : steps_between(desc->error_px_max_q8, quality->error_px_q8, 1,
                                           C_STEPS_MAX);
    balance->depth_steps = (uint8_t)(quality->depth_max - desc->depth_min);
    balance->plane_steps = can_panorama ? steps_between(quality->view_wu, desc->back_plane_min_wu,
                                                        1, PLANE_STEPS_MAX)
                                        : 0;
    balance->error_steps = can_panorama
                               ? steps_between(desc->panorama_error_max_q8, panorama->error_px_q8,
                                               ERROR_QUARTERS, ERROR_STEPS_MAX)
                               : 0;
    FF_ASSERT(detail_steps(balance) + balance->plane_steps <= FF_BALANCE_STEPS_MAX);
    unsigned old[FF_BALANCE_LEVELS] = { balance->top[0], balance->top[1] };
    balance->top[FF_BALANCE_SHARE] = (uint8_t)(detail_steps(balance) + balance->plane_steps);
    balance->top[FF_BALANCE_FIDELITY] = (uint8_t)(detail_steps(balance) + balance->error_steps);
    /* A level keeps its part of a ladder that has changed its length. The first time, share starts
     * half-way up its ladder, and fidelity at the top of its own. */
    for (int i = 0; i < FF_BALANCE_LEVELS; i++) {
        FF_ASSERT(balance->level[i] <= old[i]);
        balance->level[i] = (uint8_t)(old[i] ? balance->level[i] * balance->top[i] / old[i]
                                             : balance->top[i] / (2u - (unsigned)i));
    }
    if (desc->mode == FF_BALANCE_ALL_SERVER)
        balance->level[FF_BALANCE_SHARE] = 0;
    else if (desc->mode == FF_BALANCE_ALL_CLIENT)
        balance->level[FF_BALANCE_SHARE] = balance->top[FF_BALANCE_SHARE];
    if (desc->mode != FF_BALANCE_ON)
        balance->level[FF_BALANCE_FIDELITY] = balance->top[FF_BALANCE_FIDELITY];
    forget(balance);
    ff_balance_pause(balance);
}

void ff_balance_pause(ff_balance *balance)
{
    balance->moved_us = INT64_MIN;
    balance->raised = balance->lowered = 0;
}

static void begin_frame_window(ff_balance *balance, const ff_balance_sample *sample)
{
    balance->frame_since_us = sample->now_us;
    balance->frame_sum = balance->frame_samples = 0;
}

static void begin_link_window(ff_balance *balance, const ff_balance_sample *sample)
{
    balance->link_since_us = sample->now_us;
    balance->bytes_since = sample->bytes_down;
    balance->waited_us = 0;
    balance->frame_most_q8 = INT32_MIN;
}

static int is_settled(ff_balance *balance, const ff_balance_sample *sample)
{
    if (balance->settled) return 1;
    int64_t age_us = sample->now_us - balance->moved_us;
    balance->settled = age_us >= SETTLE_US_MAX ||
                       (sample->in_force && !sample->waiting &&
                        age_us >= SETTLE_US + 2 * (int64_t)sample->rtt_us);
    return 0;
}

static int32_t load_of(uint64_t cost, uint64_t budget)
{
    return ff_balance_log2_q8(cost) - ff_balance_log2_q8(budget);
}

static int32_t frame_load(const ff_balance *balance)
{
    FF_ASSERT(balance->frame_samples > 0);
    return balance->desc.frame_budget
               ? load_of(balance->frame_sum / balance->frame_samples, balance->desc.frame_budget)
               : INT16_MIN;
}

/* Measures the link's load. 0 when the link is silent and says nothing about what it can carry. */
static int link_load(const ff_balance *balance, const ff_balance_sample *sample, int32_t *load_q8)
{
    uint64_t age_us = (uint64_t)(sample->now_us - balance->link_since_us),
             percent = balance->desc.link_percent;
    FF_ASSERT(age_us >= LINK_WINDOW_US && percent >= 1 && percent <= 100);
    FF_ASSERT(sample->bytes_down >= balance->bytes_since);
    uint64_t waited_percent = (uint64_t)balance->waited_us * 100 / age_us;
    uint64_t bytes_s = (sample->bytes_down - balance->bytes_since) * 1000000u / age_us;
    uint64_t budget = sample->rate_bytes_s * percent / 100;
    if (balance->desc.link_bytes_s && (!budget || budget > balance->desc.link_bytes_s))
        budget = balance->desc.link_bytes_s;
    int32_t wait_q8 = load_of(waited_percent, percent);
    *load_q8 = budget ? load_of(bytes_s, budget) : INT16_MIN;
    if (wait_q8 > *load_q8) *load_q8 = wait_q8;
    return waited_percent < SATURATED_PERCENT || bytes_s * SILENT_SHARE >= sample->rate_bytes_s;
}

/* ---- moving ---- */

static void move(ff_balance *balance, int which, int level, int64_t now_us)
{
    FF_ASSERT(level >= 0 && level <= balance->top[which] && level != balance->level[which]);
    int8_t direction = level > balance->level[which] ? 1 : -1;
    balance->turns += balance->direction[which] == -direction;
    balance->direction[which] = direction;
    balance->level[which] = (uint8_t)level;
    balance->moves++;
    balance->moved_us = now_us;
    balance->settled = 0;
}

/* The most that a step up adds to a load, in log2 units, Q8. A step of fidelity adds nothing to
 * either load while it only lifts a cap that lies above the detail in force; and a step that allows
 * the panorama less error adds nothing to a frame's load, only to the link's. */
static int gain_q8(const ff_balance *balance, int which, int load, int step)
{
    FF_ASSERT(step >= 0 && step < balance->top[which]);
    if (which == FF_BALANCE_FIDELITY) {
        place low = place_of(balance, balance->level[FF_BALANCE_SHARE], (unsigned)step);
        place high = place_of(balance, balance->level[FF_BALANCE_SHARE], (unsigned)step + 1);
        int finer = high.cap > low.cap && low.cap < low.detail;
        if (!finer && (load == FF_BALANCE_SHARE || high.error == low.error)) return 0;
    }
    return GAIN_Q8(balance->gain_q4[which][load][step]);
}

static int gains_q8(const ff_balance *balance, int which, int load, int from, int to)
{
    int sum = 0;
    for (int step = from; step < to; step++) sum += gain_q8(balance, which, load, step);
    return sum;
}

/* Between the levels `low` and `high` a load has changed by change_q8. When that is more than the
 * steps between them were known to add, they are known to add as much from now on, the missing part
 * shared out equally. */
static void learn(ff_balance *balance, int which, int low, int high, int load, int change_q8)
{
    FF_ASSERT(low < high);
    int missing_q8 = change_q8 - gains_q8(balance, which, load, low, high);
    int more_q4 = missing_q8 > 0 ? missing_q8 / (16 * (high - low)) + 1 : 0;
    for (int step = low; step < high; step++) {
        int gain_q4 = balance->gain_q4[which][load][step] + more_q4;
        balance->gain_q4[which][load][step] = (uint8_t)(gain_q4 > UINT8_MAX ? UINT8_MAX : gain_q4);
    }
}

static int relieve(ff_balance *balance, int load, int64_t now_us)
{
    FF_ASSERT(balance->load_q8[load] > TOLERANCE_Q8);
    if (balance->raised && now_us - balance->moved_us < BLAME_US) {
        int which = balance->raised - 1;
        FF_ASSERT(which < FF_BALANCE_LEVELS);
        learn(balance, which, balance->moved_from, balance->level[which], load,
              balance->load_q8[load] - balance->before_q8[load]);
        balance->raised = 0;
        move(balance, which, balance->moved_from, now_us);
        return 1;
    }
    int level = balance->level[load], steps = 1 + balance->load_q8[load] / RELIEF_STEP_Q8;
    if (!level) return 0;
    forget(balance);
    balance->raised = 0;
    balance->lowered = (uint8_t)(load + 1);
    balance->moved_from = (uint8_t)level;
    balance->before_q8[load] = balance->load_q8[load];
    move(balance, load, steps > level ? 0 : level - steps, now_us);
    return 1;
}

/* Raises a level by as many steps as leave both loads below their budgets, whatever noise there
 * was. */
static int raise_level(ff_balance *balance, int which, int64_t now_us)
{
    int from = balance->level[which], to = from;
    for (int fits = 1; fits && to < balance->top[which]; to += fits)
        for (int load = 0; load < FF_BALANCE_LEVELS; load++)
            fits &= balance->load_q8[load] + gains_q8(balance, which, load, from, to + 1) +
                        2 * GAIN_Q8(FF_BALANCE_NOISE_Q4) <=
                    0;
    if (to == from) return 0;
    FF_ASSERT(balance->load_q8[FF_BALANCE_SHARE] < 0 && balance->load_q8[FF_BALANCE_FIDELITY] < 0);
    memcpy(balance->before_q8, balance->load_q8, sizeof balance->before_q8);
    balance->raised = (uint8_t)(which + 1);
    balance->moved_from = (uint8_t)from;
    balance->lowered = 0;
    move(balance, which, to, now_us);
    return 1;
}

/* The link's window is over: relief for the link, or a raise. */
static int decide(ff_balance *balance, const ff_balance_sample *sample)
{
    FF_ASSERT(balance->settled);
    int told = link_load(balance, sample, &balance->load_q8[FF_BALANCE_FIDELITY]);
    int32_t last_q8 = balance->load_q8[FF_BALANCE_SHARE];
    int moved = 0;
    if (told && balance->lowered) { /* what the relief spared, a raise would add */
        int which = balance->lowered - 1,
            now_q8 = which == FF_BALANCE_SHARE ? balance->frame_most_q8 : balance->load_q8[which];
        FF_ASSERT(which < FF_BALANCE_LEVELS && !balance->raised);
        learn(balance, which, balance->level[which], balance->moved_from, which,
              balance->before_q8[which] - now_q8);
        balance->lowered = 0;
    }
    if (told && balance->load_q8[FF_BALANCE_FIDELITY] > TOLERANCE_Q8) {
        moved = relieve(balance, FF_BALANCE_FIDELITY, sample->now_us);
    } else if (told && balance->frame_most_q8 != INT32_MIN) {
        balance->load_q8[FF_BALANCE_SHARE] = balance->frame_most_q8;
        moved = raise_level(balance, FF_BALANCE_FIDELITY, sample->now_us) ||
                raise_level(balance, FF_BALANCE_SHARE, sample->now_us);
        balance->load_q8[FF_BALANCE_SHARE] = last_q8;
    }
    begin_link_window(balance, sample);
    return moved;
}

int ff_balance_feed(ff_balance *balance, const ff_balance_sample *sample)
{
    if (balance->desc.mode != FF_BALANCE_ON) return 0;
    if (balance->moved_us == INT64_MIN) {
        balance->moved_us = sample->now_us;
        balance->settled = 0;
    }
    if (!is_settled(balance, sample)) {
        begin_frame_window(balance, sample);
        begin_link_window(balance, sample);
        balance->last_us = sample->now_us;
        return 0;
    }
    balance->frame_sum += sample->frame_cost;
    balance->frame_samples++;
    balance->waited_us += sample->waiting ? sample->now_us - balance->last_us : 0;
    balance->last_us = sample->now_us;
    if (sample->now_us - balance->frame_since_us >= FRAME_WINDOW_US) {
        int32_t load_q8 = balance->load_q8[FF_BALANCE_SHARE] = frame_load(balance);
        if (load_q8 > balance->frame_most_q8) balance->frame_most_q8 = load_q8;
        begin_frame_window(balance, sample);
        if (load_q8 > TOLERANCE_Q8 && relieve(balance, FF_BALANCE_SHARE, sample->now_us)) return 1;
    }
    return sample->now_us - balance->link_since_us >= LINK_WINDOW_US ? decide(balance, sample) : 0;
}
