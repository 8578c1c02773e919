/* Who draws how much: a controller that shares the work between server and client, and follows the
 * frame budget and the link.
 *
 * Two levels, each on a ladder on which every step changes one knob by a quarter of an octave (the
 * panorama's error by a half, the depth by one; larger only where the limits lie further apart than
 * the ladder has steps). Up is finer, and more for the client:
 *   share     what the client draws itself: detail (C or pixels, and depth) and back plane. Bottom:
 *             coarse ground up to the nearest back plane, the server draws the rest. Top: the
 *             finest ground as far as one sees, no panoramas.
 *   fidelity  what may travel: allowed error of panoramas, and a cap on detail. Top: as set by the
 *             embedder.
 * Two loads, each log2(cost / budget): of a frame (triangles, or what the embedder reports), and of
 * the link (bytes a second, and the share of time in which something in view waits for the link:
 * the larger). Decisions:
 *   relief    a load above 0 by more than NOISE: its level goes down, a step for each quarter of an
 *             octave; or the raise that caused it is undone;
 *   raise     both loads so low that they stay 2 NOISE below 0 with the most that the steps are
 *             known to add: fidelity goes up; when it cannot, share does.
 * After a move nothing is measured until it is in force (settled, at least 0.5 s and two round
 * trips, at most 10 s); then a frame's load is taken over 1 s, the link's over 8 s, from new
 * windows. So a move comes after what was asked for by the last one has arrived, and a panorama is
 * asked for because of the back plane at most once for each move.
 *
 * Why it settles. Assume, for a constant input, and with x the loads at a pair of levels in log2
 * units:
 *   A1  a window after a move contains all of the move's effect;
 *   A2  a measured load is within 1.5 NOISE of the true one, x;
 *   A3  a step up adds at most its known gain to either load: GAIN, or what was learned.
 * A raise is made only where x + noise + gains + 2 NOISE <= 0 is measured for both loads, so that
 * afterwards at most NOISE is measured: no relief ever follows a raise. Hence all reliefs come
 * first; they only go down and there are at most as many as steps; then raises, at most as many as
 * steps; then rest. At most 2 * (all steps) decisions, one change of direction a level, no limit
 * cycle, whatever the plant is in other respects: it may be flat, saturate, or couple the loads (a
 * nearer back plane saves triangles and costs bytes). If relief also lowers its own load (A4,
 * monotone), it rests with no load above the tolerance, or with that level at its bottom.
 *
 * Where A3 does not hold (a depth may quadruple the triangles), the raise is undone, and the steps'
 * gains are set to what was seen: they only grow, so each step can be wrong a bounded number of
 * times and there is no limit cycle either. Relief teaches in the same way: what it spared is what
 * a raise would add, so ground that is rough every other minute does not drag the level along.
 * Relief that no raise explains means another input: gains are forgotten, and the argument starts
 * anew.
 *
 * Integers only, no clock: time and measurements are given. Nothing is allocated. */
#ifndef FF_BALANCE_H
#define FF_BALANCE_H

#include "../farfield.h"

#define FF_BALANCE_STEPS_MAX 64
#define FF_BALANCE_GAIN_Q4   8 /* half an octave */
#define FF_BALANCE_NOISE_Q4  2 /* 9 %; also what a budget may be passed by */

/* the levels, and the loads that lower them: frame, link */
enum { FF_BALANCE_SHARE, FF_BALANCE_FIDELITY, FF_BALANCE_LEVELS };

typedef struct ff_balance_knobs {
    int32_t c_q8, error_px_q8; /* of ff_quality */
    uint8_t depth_max;
    int32_t back_plane_wu;     /* 0: no panoramas, the client draws all */
    int32_t panorama_error_q8; /* of the screen's pixels */
} ff_balance_knobs;

/* What is measured, once an update. */
typedef struct ff_balance_sample {
    int64_t now_us;
    uint32_t frame_cost;           /* of the picture shown */
    uint64_t bytes_down;           /* since the start */
    uint32_t rate_bytes_s, rtt_us; /* as estimated; 0: unknown, or no link */
    /* something in view waits for room on the link, or a panorama for the one before it */
    uint8_t waiting;
    uint8_t in_force; /* the back plane wished for is the one drawn */
} ff_balance_sample;

typedef struct ff_balance {
    ff_balance_desc desc;
    ff_quality finest;
    int32_t panorama_error_q8;
    uint8_t c_steps, depth_steps, plane_steps, error_steps;
    uint8_t level[FF_BALANCE_LEVELS], top[FF_BALANCE_LEVELS];
    /* [level][load][step]: the most a step up adds */
    uint8_t gain_q4[FF_BALANCE_LEVELS][FF_BALANCE_LEVELS][FF_BALANCE_STEPS_MAX];
    int32_t load_q8[FF_BALANCE_LEVELS]; /* log2, as last measured */
    int32_t frame_most_q8;              /* largest frame's load since the link's window began */
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
    uint64_t frame_sum, bytes_since;
    uint32_t frame_samples;
    int64_t waited_us;
    /* moves: how often a level changed; turns: how often against the direction of its last change
     */
    uint32_t moves, turns;
    int8_t direction[FF_BALANCE_LEVELS];
} ff_balance;

/* Limits and budgets; `quality` and `panorama` as set by the embedder are the finest. can_panorama
 * 0: the back plane is no knob. Levels keep their places on the ladder when called again; `fresh`
 * starts at the middle of the share and at full fidelity. */
void ff_balance_set(ff_balance *balance, const ff_balance_desc *desc, const ff_quality *quality,
                    const ff_panorama_desc *panorama, int can_panorama, int fresh);
/* 1 when a level changed. Time never goes back. */
int ff_balance_feed(ff_balance *balance, const ff_balance_sample *sample);
/* Forgets what is being measured: after times that say nothing (low power, no terrain). */
void ff_balance_pause(ff_balance *balance);
void ff_balance_get(const ff_balance *balance, ff_balance_knobs *knobs);
/* 256 * log2(value), value 0 taken as 1; at most 5 off; monotone. */
int32_t ff_balance_log2_q8(uint64_t value);

#endif
