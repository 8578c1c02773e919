#include "ff_balance.h"
#include "../../protocol/ff_assert.h"

#include <string.h>

#define SETTLE_US         500000 /* after a move, besides two round trips */
#define SETTLE_US_MAX     10000000
#define FRAME_WINDOW_US   2000000
#define LINK_WINDOW_US    8000000
#define BLAME_US          30000000 /* a relief sooner than this after a raise undoes the raise */
#define SATURATED_PERCENT 90       /* of the time something waits */
/* A link that brings less than one in SILENT_SHARE of the bytes it can carry is silent: asking for
 * less does not help then. */
#define SILENT_SHARE    32
#define PERCENT_DEFAULT 80
/* steps in sixteenths of an octave */
#define SHARE_SIXTEENTHS  1
#define DETAIL_SIXTEENTHS 4
#define ERROR_SIXTEENTHS  8
#define SHARE_OCTAVES     15 /* of the share's ladder at most: no picture has more triangles */
#define DETAIL_STEPS_MAX  16
#define ERROR_STEPS_MAX   12
#define SHARE_STEP_Q8     (256 * SHARE_SIXTEENTHS / 16)
#define DETAIL_STEP_Q8    (256 * DETAIL_SIXTEENTHS / 16)
#define BULGE_Q8          88
#define GAIN_Q8(gain_q4)  ((int32_t)(gain_q4)*16)
#define TOLERANCE_Q8      GAIN_Q8(FF_BALANCE_NOISE_Q4)
#define FRAME_MARGIN_Q8   16 /* of a raise */
#define LINK_MARGIN_Q8    (2 * TOLERANCE_Q8)
/* A link that idles says that there was nothing to ask for, not how little finer detail would take:
 * it counts as loaded so much, and detail comes back by two steps at a time. */
#define LINK_IDLE_Q8 (-LINK_MARGIN_Q8 - 2 * GAIN_Q8(8))

/* gain_q4 has a place for each step of the longest ladder, and a level is a byte */
FF_STATIC_ASSERT(16 * SHARE_OCTAVES / SHARE_SIXTEENTHS <= FF_BALANCE_STEPS_MAX);
FF_STATIC_ASSERT(DETAIL_STEPS_MAX + ERROR_STEPS_MAX <= FF_BALANCE_STEPS_MAX);
FF_STATIC_ASSERT(FF_BALANCE_STEPS_MAX <= UINT8_MAX);
FF_STATIC_ASSERT((uint64_t)FF_TRIANGLES_MIN << SHARE_OCTAVES <= INT32_MAX);
FF_STATIC_ASSERT(FF_BALANCE_LEVELS == 2); /* ff_balance_set names both */
/* no relief follows a raise */
FF_STATIC_ASSERT(FRAME_MARGIN_Q8 <= TOLERANCE_Q8 && TOLERANCE_Q8 <= LINK_MARGIN_Q8);
/* what a raise does is measured while it may still be blamed */
FF_STATIC_ASSERT(SETTLE_US < SETTLE_US_MAX && SETTLE_US_MAX + LINK_WINDOW_US < BLAME_US);
/* a link's window has seen frames */
FF_STATIC_ASSERT(FRAME_WINDOW_US < LINK_WINDOW_US);

/* The most that a step up is taken to add to a load before anything is learned; to a frame's load,
 * a step of the share adds what it adds to the limit, and this. */
static const uint8_t gain_q4[FF_BALANCE_LEVELS][FF_BALANCE_LEVELS] = { { 0, 2 }, { 8, 8 } };

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

/* value / 2^(sixteenths / 16) */
static int64_t lessened(int64_t value, unsigned sixteenths)
{
    static const int32_t root_q16[16] = { 65536, 62757, 60097, 57549, 55109, 52773, 50535, 48393,
                                          46341, 44376, 42495, 40693, 38968, 37316, 35734, 34219 };
    FF_ASSERT(value > 0 && value <= INT32_MAX && sixteenths / 16 < 32);
    return (value >> sixteenths / 16) * root_q16[sixteenths % 16] >> 16;
}

static uint8_t steps_between(int64_t high, int64_t low, unsigned sixteenths, unsigned most)
{
    unsigned steps = 0;
    FF_ASSERT(low > 0);
    while (steps < most && lessened(high, steps * sixteenths) > low) steps++;
    return (uint8_t)steps;
}

/* The value that lies `below` steps under the top of a ladder of `steps` steps from `high` down to
 * `low`. */
static int32_t on_ladder(int64_t high, int64_t low, unsigned below, unsigned steps,
                         unsigned sixteenths)
{
    FF_ASSERT(below <= steps);
    int64_t value = lessened(high, below * sixteenths);
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

static unsigned detail_of(const ff_balance *balance, unsigned fidelity)
{
    return first_kind(fidelity, balance->detail_steps, balance->error_steps);
}

static uint32_t limit_at(const ff_balance *balance, unsigned share)
{
    unsigned top = balance->top[FF_BALANCE_SHARE];
    return (uint32_t)on_ladder(balance->finest.triangles_max, FF_TRIANGLES_MIN, top - share, top,
                               SHARE_SIXTEENTHS);
}

/* The bound on detail: C, or pixels of error; the least error is the finest, that ladder is climbed
 * downwards. */
static int32_t bound_at(const ff_balance *balance, unsigned fidelity)
{
    const ff_quality *finest = &balance->finest;
    unsigned up = detail_of(balance, fidelity), steps = balance->detail_steps;
    if (finest->measure == FF_MEASURE_DISTANCE)
        return on_ladder(finest->c_q8, balance->desc.c_min_q8, steps - up, steps,
                         DETAIL_SIXTEENTHS);
    return on_ladder(balance->desc.error_px_max_q8, finest->error_px_q8, up, steps,
                     DETAIL_SIXTEENTHS);
}

void ff_balance_get(const ff_balance *balance, ff_balance_knobs *knobs)
{
    const ff_balance_desc *desc = &balance->desc;
    const ff_quality *finest = &balance->finest;
    unsigned fidelity = balance->level[FF_BALANCE_FIDELITY];
    int distance = finest->measure == FF_MEASURE_DISTANCE;
    *knobs = (ff_balance_knobs){
        .c_q8 = distance ? bound_at(balance, fidelity) : finest->c_q8,
        .error_px_q8 = distance ? finest->error_px_q8 : bound_at(balance, fidelity),
        .triangles_max = limit_at(balance, balance->level[FF_BALANCE_SHARE]),
        .back_plane_wu = balance->back_plane_wu
    };
    if (balance->back_plane_wu)
        knobs->panorama_error_q8 = on_ladder(
            desc->panorama_error_max_q8, balance->panorama_error_q8,
            fidelity - detail_of(balance, fidelity), balance->error_steps, ERROR_SIXTEENTHS);
    if (desc->mode == FF_BALANCE_ALL_CLIENT) knobs->back_plane_wu = 0;
    if (desc->mode == FF_BALANCE_ALL_SERVER) {
        knobs->triangles_max = FF_TRIANGLES_MIN;
        if (knobs->back_plane_wu) knobs->back_plane_wu = desc->back_plane_min_wu;
    }
    FF_ASSERT(knobs->c_q8 > 0 && knobs->c_q8 <= finest->c_q8);
    FF_ASSERT(knobs->error_px_q8 >= finest->error_px_q8);
    FF_ASSERT(knobs->triangles_max >= FF_TRIANGLES_MIN);
    FF_ASSERT(knobs->panorama_error_q8 >= balance->panorama_error_q8);
}

/* A limit that was left out, or one finer than the finest. */
static int32_t at_least(int32_t given, int32_t finest, int32_t times)
{
    FF_ASSERT(finest > 0);
    if (given <= 0) given = finest > INT32_MAX / times ? INT32_MAX : finest * times;
    return given > finest ? given : finest;
}

static void complete(ff_balance_desc *desc, const ff_quality *finest,
                     const ff_panorama_desc *panorama)
{
    if (!desc->link_percent || desc->link_percent > 100) desc->link_percent = PERCENT_DEFAULT;
    if (desc->c_min_q8 <= 0) desc->c_min_q8 = finest->c_q8 / 4;
    if (desc->c_min_q8 > finest->c_q8 || desc->c_min_q8 <= 0) desc->c_min_q8 = finest->c_q8;
    desc->error_px_max_q8 = at_least(desc->error_px_max_q8, finest->error_px_q8, 8);
    if (!panorama) return;
    if (desc->back_plane_min_wu <= 0) desc->back_plane_min_wu = panorama->back_plane_wu / 4 + 1;
    if (desc->back_plane_min_wu > panorama->back_plane_wu)
        desc->back_plane_min_wu = panorama->back_plane_wu;
    desc->panorama_error_max_q8 = at_least(desc->panorama_error_max_q8, panorama->error_px_q8, 4);
}

/* The finest limit of triangles: as set, or the budget for them. */
static uint32_t limit_set(const ff_balance_desc *desc, const ff_quality *quality, int reported)
{
    const uint32_t most = FF_TRIANGLES_MIN << SHARE_OCTAVES;
    uint32_t limit = quality->triangles_max < most ? quality->triangles_max : most;
    int budgeted = desc->mode == FF_BALANCE_ON && desc->frame_budget && !reported;
    if (budgeted && limit > desc->frame_budget) limit = desc->frame_budget;
    return limit > FF_TRIANGLES_MIN ? limit : FF_TRIANGLES_MIN;
}

/* ---- measuring ---- */

static void forget(ff_balance *balance)
{
    for (int which = 0; which < FF_BALANCE_LEVELS; which++)
        for (int load = 0; load < FF_BALANCE_LEVELS; load++)
            memset(balance->gain_q4[which][load], gain_q4[which][load],
                   sizeof balance->gain_q4[which][load]);
    balance->raised = balance->lowered = 0;
}

static void set_ladders(ff_balance *balance, const ff_panorama_desc *panorama, int shares)
{
    const ff_quality *finest = &balance->finest;
    const ff_balance_desc *desc = &balance->desc;
    int distance = finest->measure == FF_MEASURE_DISTANCE;
    balance->detail_steps = steps_between(distance ? finest->c_q8 : desc->error_px_max_q8,
                                          distance ? desc->c_min_q8 : finest->error_px_q8,
                                          DETAIL_SIXTEENTHS, DETAIL_STEPS_MAX);
    balance->error_steps = panorama
                               ? steps_between(desc->panorama_error_max_q8, panorama->error_px_q8,
                                               ERROR_SIXTEENTHS, ERROR_STEPS_MAX)
                               : 0;
    balance->top[FF_BALANCE_SHARE] = shares ? steps_between(finest->triangles_max, FF_TRIANGLES_MIN,
                                                            SHARE_SIXTEENTHS, FF_BALANCE_STEPS_MAX)
                                            : 0;
    balance->top[FF_BALANCE_FIDELITY] = (uint8_t)(balance->detail_steps + balance->error_steps);
}

void ff_balance_set(ff_balance *balance, const ff_balance_desc *desc, const ff_quality *quality,
                    const ff_panorama_desc *panorama, int reported, int fresh)
{
    if (fresh) memset(balance, 0, sizeof *balance);
    balance->desc = *desc;
    balance->finest = *quality;
    balance->reported = reported != 0;
    balance->finest.triangles_max = limit_set(desc, quality, reported);
    balance->back_plane_wu = panorama ? panorama->back_plane_wu : 0;
    balance->panorama_error_q8 = panorama ? panorama->error_px_q8 : 0;
    complete(&balance->desc, quality, panorama);
    unsigned old[FF_BALANCE_LEVELS] = { balance->top[0], balance->top[1] };
    set_ladders(balance, panorama, reported && desc->frame_budget);
    /* A level keeps its part of a ladder that has changed its length. The first time, share starts
     * half-way up its ladder, and fidelity at the top of its own. */
    for (int i = 0; i < FF_BALANCE_LEVELS; i++) {
        FF_ASSERT(balance->level[i] <= old[i]);
        balance->level[i] = (uint8_t)(old[i] ? balance->level[i] * balance->top[i] / old[i]
                                             : balance->top[i] / (2u - (unsigned)i));
    }
    if (desc->mode != FF_BALANCE_ON)
        for (int i = 0; i < FF_BALANCE_LEVELS; i++) balance->level[i] = balance->top[i];
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
    balance->frame_sum = balance->triangles_sum = balance->frame_samples = 0;
}

static void begin_link_window(ff_balance *balance, const ff_balance_sample *sample)
{
    balance->link_since_us = sample->now_us;
    balance->bytes_since = sample->bytes_down;
    balance->waited_us = 0;
    balance->frames_before = balance->frames;
    balance->frames = (ff_balance_dearest){ INT32_MIN, INT32_MIN };
    balance->coarser_least_q8 = INT32_MAX;
}

static int is_settled(ff_balance *balance, const ff_balance_sample *sample)
{
    if (balance->settled) return 1;
    int64_t age_us = sample->now_us - balance->moved_us;
    balance->settled = age_us >= SETTLE_US_MAX ||
                       (!sample->waiting && age_us >= SETTLE_US + 2 * (int64_t)sample->rtt_us);
    return 0;
}

static int32_t load_of(uint64_t cost, uint64_t budget)
{
    return ff_balance_log2_q8(cost) - ff_balance_log2_q8(budget);
}

/* How much coarser a detail is than the finest, in log2 units. */
static int32_t coarser_q8(const ff_balance *balance, int32_t c_q8, int32_t error_px_q8)
{
    FF_ASSERT(c_q8 >= 0 && error_px_q8 >= 0);
    return balance->finest.measure == FF_MEASURE_DISTANCE
               ? load_of((uint64_t)balance->finest.c_q8, (uint64_t)c_q8)
               : load_of((uint64_t)error_px_q8, (uint64_t)balance->finest.error_px_q8);
}

static int32_t bound_coarser_q8(const ff_balance *balance, unsigned fidelity)
{
    int32_t bound_q8 = bound_at(balance, fidelity);
    return coarser_q8(balance, bound_q8, bound_q8);
}

static void most(ff_balance_dearest *frames, int32_t load_q8, int32_t full_q8)
{
    if (load_q8 > frames->load_q8) frames->load_q8 = load_q8;
    if (full_q8 > frames->full_q8) frames->full_q8 = full_q8;
}

/* The frame's window is over. */
static void measure_frames(ff_balance *balance)
{
    FF_ASSERT(balance->frame_samples > 0);
    uint64_t cost = balance->frame_sum / balance->frame_samples;
    uint32_t limit = limit_at(balance, balance->level[FF_BALANCE_SHARE]),
             drawn = (uint32_t)(balance->triangles_sum / balance->frame_samples);
    int32_t load_q8 = balance->desc.frame_budget ? load_of(cost, balance->desc.frame_budget)
                                                 : INT16_MIN;
    int32_t full_q8 = load_q8 + (drawn < limit ? load_of(limit, drawn) : 0);
    balance->triangles_mean = drawn;
    balance->load_q8[FF_BALANCE_SHARE] = load_q8;
    most(&balance->frames, load_q8, full_q8);
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

/* The most that the steps between two levels add to a load, in log2 units, Q8. */
static int gains_q8(const ff_balance *balance, int which, int load, int from, int to)
{
    FF_ASSERT(from >= 0 && from <= to && to <= balance->top[which]);
    int sum = 0, share = which == FF_BALANCE_SHARE;
    /* the bound on detail binds: it is as coarse as what is in force */
    int binds = share || balance->coarser_least_q8 <=
                             bound_coarser_q8(balance, (unsigned)from) + DETAIL_STEP_Q8 / 2;
    if (share && load == FF_BALANCE_SHARE)
        sum = load_of(limit_at(balance, (unsigned)to), limit_at(balance, (unsigned)from));
    for (int step = from; step < to; step++) {
        int of_detail = share || detail_of(balance, (unsigned)step) !=
                                     detail_of(balance, (unsigned)step + 1);
        /* the panorama's error adds nothing to a frame's load */
        if (of_detail ? binds : load != FF_BALANCE_SHARE)
            sum += GAIN_Q8(balance->gain_q4[which][load][step]);
    }
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
        int gain = balance->gain_q4[which][load][step] + more_q4;
        balance->gain_q4[which][load][step] = (uint8_t)(gain > UINT8_MAX ? UINT8_MAX : gain);
    }
}

/* Whether the level changes anything when it goes down to `to`, a step below. */
static int matters(const ff_balance *balance, int which, int to)
{
    if (which == FF_BALANCE_SHARE) return limit_at(balance, (unsigned)to) < balance->triangles_mean;
    return detail_of(balance, (unsigned)to) == detail_of(balance, (unsigned)to + 1) ||
           bound_coarser_q8(balance, (unsigned)to) > balance->coarser_least_q8;
}

/* The level at which relief for the load ends: a step of the share spares a sixteenth of an octave,
 * a step of fidelity is taken to spare a quarter. Where no step changes anything it is this one. */
static int relieved(const ff_balance *balance, int load)
{
    int spares_q8 = load == FF_BALANCE_SHARE ? SHARE_STEP_Q8 : DETAIL_STEP_Q8,
        steps = (balance->load_q8[load] + spares_q8 - 1) / spares_q8, level = balance->level[load];
    FF_ASSERT(steps > 0);
    for (int to = level - 1; to >= 0 && steps; to--) {
        if (!matters(balance, load, to)) continue;
        level = to;
        steps--;
    }
    return level;
}

/* Undoes a raise that a load did not bear, or the part of it that relief would take back, and
 * learns from it. What is left of it may still be blamed. */
static void undo(ff_balance *balance, int load, int64_t now_us)
{
    int which = balance->raised - 1, to = balance->moved_from, eased = relieved(balance, load);
    FF_ASSERT(which >= 0 && which < FF_BALANCE_LEVELS);
    learn(balance, which, to, balance->level[which], load,
          balance->load_q8[load] - balance->before_q8[load]);
    if (which == load && eased > to && eased < balance->level[which])
        to = eased;
    else
        balance->raised = 0;
    move(balance, which, to, now_us);
}

static int relieve(ff_balance *balance, int load, int64_t now_us)
{
    FF_ASSERT(balance->load_q8[load] > TOLERANCE_Q8);
    if (balance->raised && now_us - balance->moved_us < BLAME_US &&
        balance->before_q8[load] <= TOLERANCE_Q8) {
        undo(balance, load, now_us);
        return 1;
    }
    int level = balance->level[load], to = relieved(balance, load);
    if (to == level) return 0;
    forget(balance);
    balance->lowered = (uint8_t)(load + 1);
    balance->moved_from = (uint8_t)level;
    balance->before_q8[load] = balance->load_q8[load];
    move(balance, load, to, now_us);
    return 1;
}

/* Whether both loads stay below their budgets when the level is raised. A frame never costs more
 * than one that fills the limit. */
static int fits(const ff_balance *balance, const ff_balance_dearest *frames, int which, int from,
                int to)
{
    int32_t frame_q8 = frames->load_q8 + FRAME_MARGIN_Q8, full_q8 = frames->full_q8,
            gain_q8 = gains_q8(balance, which, FF_BALANCE_SHARE, from, to),
            told_q8 = balance->load_q8[FF_BALANCE_FIDELITY],
            link_q8 = (told_q8 < LINK_IDLE_Q8 ? LINK_IDLE_Q8 : told_q8) + LINK_MARGIN_Q8 +
                      gains_q8(balance, which, FF_BALANCE_FIDELITY, from, to);
    if (full_q8 < frame_q8) full_q8 = frame_q8;
    if (link_q8 > 0) return 0;
    if (which == FF_BALANCE_SHARE) return full_q8 + gain_q8 <= 0;
    return !balance->top[FF_BALANCE_SHARE] || !gain_q8 || full_q8 <= 0 || frame_q8 + gain_q8 <= 0;
}

static int raise_level(ff_balance *balance, const ff_balance_dearest *frames, int which,
                       int64_t now_us)
{
    int from = balance->level[which], to = from;
    while (to < balance->top[which] && fits(balance, frames, which, from, to + 1)) to++;
    if (to == from) return 0;
    balance->before_q8[FF_BALANCE_SHARE] = frames->load_q8;
    balance->before_q8[FF_BALANCE_FIDELITY] = balance->load_q8[FF_BALANCE_FIDELITY];
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
    int moved = 0;
    if (told && balance->lowered) { /* what the relief spared, a raise would add */
        int which = balance->lowered - 1,
            now_q8 = which == FF_BALANCE_SHARE ? balance->frames.load_q8 : balance->load_q8[which];
        FF_ASSERT(which < FF_BALANCE_LEVELS && !balance->raised);
        learn(balance, which, balance->level[which], balance->moved_from, which,
              balance->before_q8[which] - now_q8);
        balance->lowered = 0;
    }
    if (told && balance->load_q8[FF_BALANCE_FIDELITY] > TOLERANCE_Q8)
        moved = relieve(balance, FF_BALANCE_FIDELITY, sample->now_us);
    else if (told && balance->frames.load_q8 != INT32_MIN) {
        ff_balance_dearest frames = balance->frames;
        most(&frames, balance->frames_before.load_q8, balance->frames_before.full_q8);
        moved = raise_level(balance, &frames, FF_BALANCE_FIDELITY, sample->now_us) ||
                raise_level(balance, &frames, FF_BALANCE_SHARE, sample->now_us);
    }
    begin_link_window(balance, sample);
    return moved;
}

static void take(ff_balance *balance, const ff_balance_sample *sample)
{
    int32_t detail_q8 = coarser_q8(balance, sample->c_q8, sample->error_px_q8);
    balance->frame_sum += balance->reported ? sample->frame_cost : sample->triangles;
    balance->triangles_sum += sample->triangles;
    balance->frame_samples++;
    balance->waited_us += sample->waiting ? sample->now_us - balance->last_us : 0;
    balance->last_us = sample->now_us;
    if (detail_q8 < balance->coarser_least_q8) balance->coarser_least_q8 = detail_q8;
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
    take(balance, sample);
    if (sample->now_us - balance->frame_since_us >= FRAME_WINDOW_US) {
        measure_frames(balance);
        begin_frame_window(balance, sample);
        if (balance->top[FF_BALANCE_SHARE] && balance->load_q8[FF_BALANCE_SHARE] > TOLERANCE_Q8 &&
            relieve(balance, FF_BALANCE_SHARE, sample->now_us))
            return 1;
    }
    return sample->now_us - balance->link_since_us >= LINK_WINDOW_US ? decide(balance, sample) : 0;
}
