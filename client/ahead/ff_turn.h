/* How fast does the viewer turn, and which way will it look? For prefetch, beside ff_motion.h: what
 * lies outside the window is asked for only when the window is about to reach it. The rate is the
 * mean over the last fifth of a second or more. */
#ifndef FF_TURN_H
#define FF_TURN_H

#include "../../common3d/c3d.h"

#define FF_TURN_VIEWS_MAX 4

typedef struct ff_turn {
    int64_t since_us;
    int32_t last_yaw, last_pitch; /* brad16 */
    int64_t yaw_sum, pitch_sum;   /* turned since since_us */
    int32_t yaw_rate, pitch_rate; /* brad16 a second */
    uint8_t has_last;
} ff_turn;

void ff_turn_reset(ff_turn *turn);
void ff_turn_feed(ff_turn *turn, int64_t now_us, int32_t yaw, int32_t pitch);
/* Yaw and pitch added within ahead_us at this rate; yaw at most half a turn, pitch at most a
 * quarter. Returns the number of steps, each at most an eighth of a turn, that this makes; 0 when
 * the viewer does not turn. */
unsigned ff_turn_predict(const ff_turn *turn, int64_t ahead_us, int32_t *yaw, int32_t *pitch);

#endif
