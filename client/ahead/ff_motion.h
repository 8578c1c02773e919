/* Where will the viewer be? For prefetch (Shared: constant rate of change of acceleration, averaged
 * over five frames).
 *
 * Positions are put into five bins a fifth of a second apart or more, so that jitter of frame times
 * and repeated fixes average out; the last four bins give velocity, acceleration and its rate of
 * change. The prediction is clamped so that it stays calm: acceleration terms count only when they
 * agree (both halves of the history point the same way), they may change the way made at constant
 * velocity by at most one half, and a jump (speed above 10 km/s, or a pause above 2 s) starts the
 * history anew. With less than two bins nothing is predicted. */
#ifndef FF_MOTION_H
#define FF_MOTION_H

#include <stdint.h>

#define FF_MOTION_BINS 5

typedef struct ff_motion_bin {
    int64_t time_us;
    int64_t pos_wu[3];
} ff_motion_bin;

typedef struct ff_motion {
    ff_motion_bin bin[FF_MOTION_BINS]; /* newest first, each the mean of its samples */
    uint8_t count;
    /* samples of the bin being filled, relative to open_since_us */
    int64_t open_since_us, open_time_sum_us;
    int64_t open_sum_wu[3];
    int32_t last_wu[3];
    int64_t last_us;
    uint32_t open_samples;
    uint8_t has_last;
} ff_motion;

void ff_motion_reset(ff_motion *motion);
void ff_motion_feed(ff_motion *motion, int64_t now_us, const int32_t pos_wu[3]);
/* 1 and the position expected `ahead_us` from the last one fed (0 .. 30 s), or 0: standing still or
 * nothing known. */
int ff_motion_predict(const ff_motion *motion, int64_t ahead_us, int32_t pos_wu[3]);
/* The same for longer times: straight on and level. Whoever climbs now need not be climbing ten
 * seconds later. */
int ff_motion_level(const ff_motion *motion, int64_t ahead_us, int32_t pos_wu[3]);
/* Over ground, of who goes on so: wu a second; 0: standing still or nothing known. */
int64_t ff_motion_speed_wu_s(const ff_motion *motion);

#endif
