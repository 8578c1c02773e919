/* Who draws how much: a controller that keeps a frame's cost and the link's load within budgets.
 *
 * What a frame may cost. Where that is counted in triangles there is nothing to control: the budget
 * is the limit of triangles (ff_quality.triangles_max), kept in every picture from the first on.
 * Where the embedder reports costs, in microseconds say, nobody knows what a triangle costs: then
 * the limit is a level on a ladder.
 *
 * Two levels, each on a ladder; up is finer:
 *   share     the limit of triangles, steps of a sixteenth of an octave, from FF_TRIANGLES_MIN to
 *             the one set. No steps where costs are counted in triangles.
 *   fidelity  what may travel: a bound on detail (pixels of error, or C), steps of a quarter of an
 *             octave, and the panorama's allowed error, of a half. Top: as set by the embedder.
 * Two loads, each log2(cost / budget): of a frame as reported, and of the link (bytes a second, and
 * the share of time in which something in view waits for the link: the larger). Decisions:
 *   relief    a load above 0 by more than NOISE: its level goes down, by as many steps as spare the
 *             load if cost is proportional to triangles; or the raise that caused it is undone;
 *   raise     both loads so low that they stay below 0 by a margin with the most that the steps are
 *             known to add: fidelity goes up; when it cannot, share does.
 * After a raise that was too high the level goes down as for relief, but no further than to where
 * it was. A step that changes nothing is passed for nothing: the bound on detail where the limit of
 * triangles makes detail coarser than that, the limit where fewer triangles are drawn. So relief
 * begins at what is drawn; and a raise takes the frame for one that fills its limit, so the limit
 * does not drift up while the ground needs few triangles, to be found too high later.
 *
 * After a move nothing is measured until it is in force (settled: at least 0.5 s and two round
 * trips, until nothing waits, at most 10 s); then a frame's load is taken over 2 s, the link's over
 * 8 s, from new windows. So a move comes after what was asked for by the last one has arrived. A
 * raise goes by the largest frame's load of two of the link's windows: costs that go up and down
 * more quickly do not drag the level along.
 *
 * Why it settles. Assume, for a constant input, and with x the loads at a pair of levels in log2
 * units:
 *   A1  a window after a move contains all of the move's effect;
 *   A2  the frame's load that a raise goes by is within NOISE of the largest one ever measured at
 *       these levels; a link's load is within 1.5 NOISE of the true one, x;
 *   A3  a step up adds at most its known gain to either load: of the share to a frame's load what
 *       it adds to the limit, for a cost in proportion to triangles or with a constant part; else
 *       GAIN; or what was learned.
 * A frame's load grows only while the limit binds, so a frame that fills the limit costs what A3
 * says. Hence after a raise at most NOISE is measured, of a frame and of the link, and that is
 * answered by no relief: no relief ever follows a raise. Hence all
 * reliefs come first; they only go down and there are at most as many as steps; then raises, at
 * most as many as steps; then rest. At most 2 * (all steps) decisions, one change of direction a
 * level, no limit cycle, whatever the plant is in other respects: it may be flat, saturate, or
 * couple the loads. If relief also lowers its own load (A4, monotone), it rests with no load above
 * the tolerance, or with that level at its bottom. And where the limit binds and the link's load
 * does not, the dearest frames, had they filled the limit, would cost less than a step and a
 * sixteenth of an octave, 8 %, below the budget.
 *
 * Where A3 does not hold (a cache that overflows), the raise is undone, and the steps' gains are
 * set to what was seen: they only grow, so each step can be wrong a bounded number of times and
 * there is no limit cycle either. Relief teaches in the same way: what it spared is what a raise
 * would add. Relief that no raise explains means another input: gains are forgotten, and the
 * argument starts anew. Noise beyond A2 is taken for a dear step in the same way.
 *
 * Integers only, no clock: time and measurements are given. Nothing is allocated. */
#ifndef FF_BALANCE_H
#define FF_BALANCE_H

#include "../farfield.h"

#define FF_BALANCE_STEPS_MAX 240
#define FF_BALANCE_NOISE_Q4  2 /* 9 %; also what a budget may be passed by */

/* the levels, and the loads that lower them: frame, link */
enum { FF_BALANCE_SHARE, FF_BALANCE_FIDELITY, FF_BALANCE_LEVELS };

typedef struct ff_balance_knobs {
    int32_t c_q8, error_px_q8; /* of ff_quality */
    uint32_t triangles_max;
    int32_t back_plane_wu;     /* 0: no panoramas, the client draws all */
    int32_t panorama_error_q8; /* of the screen's pixels */
} ff_balance_knobs;

/* What is measured, once an update. */
typedef struct ff_balance_sample {
    int64_t now_us;
    uint32_t frame_cost;           /* of the picture shown, as reported */
    uint32_t triangles;            /* of that picture */
    int32_t c_q8, error_px_q8;     /* of the quality in force, as coarse as the limit made it */
    uint64_t bytes_down;           /* since the start */
    uint32_t rate_bytes_s, rtt_us; /* as estimated; 0: unknown, or no link */
    /* something in view waits for room on the link, or a panorama for the one before it */
    uint8_t waiting;
} ff_balance_sample;

/* The largest frame's load, and the largest one that there would have been, had the frame filled
 * its limit of triangles. */
typedef struct ff_balance_dearest {
    int32_t load_q8, full_q8;
} ff_balance_dearest;

typedef struct ff_balance {
    ff_balance_desc desc;
    ff_quality finest;
    int32_t back_plane_wu, panorama_error_q8; /* as set; 0: no panoramas */
    uint8_t reported, detail_steps, error_steps;
    uint8_t level[FF_BALANCE_LEVELS], top[FF_BALANCE_LEVELS];
    /* [level][load][step]: the most a step up adds */
    uint8_t gain_q4[FF_BALANCE_LEVELS][FF_BALANCE_LEVELS][FF_BALANCE_STEPS_MAX];
    int32_t load_q8[FF_BALANCE_LEVELS]; /* log2, as last measured */
    /* since the link's window began, and in the window before where no move lies between */
    ff_balance_dearest frames, frames_before;
    /* the finest detail in force in the link's window, in log2 units coarser than the finest */
    int32_t coarser_least_q8;
    /* the move last made */
    int64_t moved_us; /* INT64_MIN: none yet */
    uint8_t settled;
    /* the level moved, + 1, when the last move was a raise, or a relief not yet learned from; else
     * 0 */
    uint8_t raised, lowered;
    uint8_t moved_from;
    int32_t before_q8[FF_BALANCE_LEVELS];
    /* windows */
    int64_t frame_since_us, link_since_us, last_us;
    uint64_t frame_sum, triangles_sum, bytes_since;
    uint32_t frame_samples, triangles_mean;
    int64_t waited_us;
    /* moves: how often a level changed; turns: how often against the direction of its last change
     */
    uint32_t moves, turns;
    int8_t direction[FF_BALANCE_LEVELS];
} ff_balance;

/* Limits and budgets; `quality` and `panorama` as set by the embedder are the finest. `panorama`
 * NULL: there are none. reported 0: costs are counted in triangles. Levels keep their places on the
 * ladder when called again; `fresh` starts at the middle of the share and at full fidelity. */
void ff_balance_set(ff_balance *balance, const ff_balance_desc *desc, const ff_quality *quality,
                    const ff_panorama_desc *panorama, int reported, int fresh);
/* 1 when a level changed. Time never goes back. */
int ff_balance_feed(ff_balance *balance, const ff_balance_sample *sample);
/* Forgets what is being measured: after times that say nothing (low power, no terrain). */
void ff_balance_pause(ff_balance *balance);
void ff_balance_get(const ff_balance *balance, ff_balance_knobs *knobs);
/* 256 * log2(value), value 0 taken as 1; at most 5 off; monotone. */
int32_t ff_balance_log2_q8(uint64_t value);

#endif
