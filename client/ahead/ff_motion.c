#include "ff_motion.h"

#include "../../common3d/c3d_fixed.h"
#include "../../protocol/ff_assert.h"
#include "../../protocol/ff_terrain.h"

#include <string.h>

#define BIN_US         200000
#define PAUSE_US_MAX   2000000
#define SPEED_WU_S_MAX (10000 * FF_WU_PER_METRE)
#define AHEAD_US_MAX   30000000
#define STILL_WU       (FF_WU_PER_METRE / 4) /* a way shorter than this is no motion */

FF_STATIC_ASSERT(FF_MOTION_BINS == 5); /* curve() names bins 0, 1, 3 and 4 */
FF_STATIC_ASSERT(BIN_US < PAUSE_US_MAX && PAUSE_US_MAX < AHEAD_US_MAX);
FF_STATIC_ASSERT((int64_t)SPEED_WU_S_MAX *(AHEAD_US_MAX / 1000) < INT64_MAX / 1000);

void ff_motion_reset(ff_motion *motion) { memset(motion, 0, sizeof *motion); }

static int is_jump(const ff_motion *motion, int64_t now_us, const int32_t pos_wu[3])
{
    int64_t elapsed_us = now_us - motion->last_us;
    if (elapsed_us < 0 || elapsed_us > PAUSE_US_MAX) return 1;
    int64_t moved_wu = c3d_length64((int64_t)pos_wu[0] - motion->last_wu[0],
                                    (int64_t)pos_wu[1] - motion->last_wu[1],
                                    (int64_t)pos_wu[2] - motion->last_wu[2]);
    FF_ASSERT(moved_wu >= 0 && moved_wu < (int64_t)1 << 34); /* times a million fits */
    return moved_wu * 1000000 > (elapsed_us + 20000) * SPEED_WU_S_MAX;
}

static void close_bin(ff_motion *motion)
{
    FF_ASSERT(motion->open_samples > 0 && motion->count <= FF_MOTION_BINS);
    memmove(motion->bin + 1, motion->bin, sizeof motion->bin - sizeof motion->bin[0]);
    ff_motion_bin *bin = &motion->bin[0];
    int64_t samples = motion->open_samples;
    bin->time_us = motion->open_since_us + motion->open_time_sum_us / samples;
    for (int i = 0; i < 3; i++) bin->pos_wu[i] = motion->open_sum_wu[i] / samples;
    if (motion->count < FF_MOTION_BINS) motion->count++;
    FF_ASSERT(motion->count < 2 || bin->time_us > motion->bin[1].time_us);
    motion->open_samples = 0;
}

void ff_motion_feed(ff_motion *motion, int64_t now_us, const int32_t pos_wu[3])
{
    if (motion->has_last && is_jump(motion, now_us, pos_wu)) ff_motion_reset(motion);
    motion->has_last = 1;
    motion->last_us = now_us;
    memcpy(motion->last_wu, pos_wu, sizeof motion->last_wu);
    if (motion->open_samples && now_us - motion->open_since_us >= BIN_US) close_bin(motion);
    if (!motion->open_samples) {
        motion->open_since_us = now_us;
        motion->open_time_sum_us = 0;
        memset(motion->open_sum_wu, 0, sizeof motion->open_sum_wu);
    }
    motion->open_samples++;
    motion->open_time_sum_us += now_us - motion->open_since_us;
    for (int i = 0; i < 3; i++) motion->open_sum_wu[i] += pos_wu[i];
}

/* Mean velocity between two bins, wu/s. */
static int64_t velocity(const ff_motion *motion, int newer, int older, int axis)
{
    FF_ASSERT(newer < older && older < motion->count);
    int64_t elapsed_us = motion->bin[newer].time_us - motion->bin[older].time_us;
    return elapsed_us > 0 ? (motion->bin[newer].pos_wu[axis] - motion->bin[older].pos_wu[axis]) *
                                1000000 / elapsed_us
                          : 0;
}

/* What acceleration and its change add to the way, wu; 0 when the history is short or disagrees
 * with itself. */
static int64_t curve(const ff_motion *motion, int axis, int64_t ahead_ms)
{
    if (motion->count < FF_MOTION_BINS) return 0;
    int64_t v_new = velocity(motion, 0, 1, axis), v_mid = velocity(motion, 1, 3, axis),
            v_old = velocity(motion, 3, 4, axis);
    int64_t half_ms = (motion->bin[0].time_us - motion->bin[4].time_us) / 2000;
    if (half_ms <= 0) return 0;
    /* wu/s^2 */
    int64_t a_new = (v_new - v_mid) * 1000 / half_ms, a_old = (v_mid - v_old) * 1000 / half_ms;
    if ((a_new > 0) != (a_old > 0)) return 0;
    int64_t a = (a_new + a_old) / 2, jerk = (a_new - a_old) * 1000 / half_ms;
    return a * ahead_ms / 1000 * ahead_ms / 2000 +
           jerk * ahead_ms / 1000 * ahead_ms / 1000 * ahead_ms / 6000;
}

static int64_t clamp(int64_t value, int64_t limit)
{
    limit = limit < 0 ? -limit : limit;
    return value > limit ? limit : value < -limit ? -limit : value;
}

/* The way made in ahead_ms at the mean velocity of the last bins. Returns its length, 0 for a
 * viewer who stands still. */
static int64_t straight_way(const ff_motion *motion, int64_t ahead_ms, int64_t way_wu[3])
{
    FF_ASSERT(ahead_ms <= AHEAD_US_MAX / 1000);
    if (motion->count < 2) return 0;
    for (int i = 0; i < 3; i++)
        way_wu[i] = clamp(velocity(motion, 0, motion->count - 1, i), SPEED_WU_S_MAX) * ahead_ms /
                    1000;
    int64_t length_wu = c3d_length64(way_wu[0], way_wu[1], way_wu[2]);
    return length_wu < STILL_WU ? 0 : length_wu;
}

static int32_t position(int64_t to_wu)
{
    return to_wu > INT32_MAX ? INT32_MAX : to_wu < INT32_MIN ? INT32_MIN : (int32_t)to_wu;
}

int ff_motion_predict(const ff_motion *motion, int64_t ahead_us, int32_t pos_wu[3])
{
    int64_t way[3], ahead_ms = (ahead_us > AHEAD_US_MAX ? AHEAD_US_MAX : ahead_us) / 1000;
    int64_t length = straight_way(motion, ahead_ms, way);
    if (!length) return 0;
    for (int i = 0; i < 3; i++)
        pos_wu[i] = position(motion->last_wu[i] + way[i] +
                             clamp(curve(motion, i, ahead_ms), length / 2));
    return 1;
}

int ff_motion_level(const ff_motion *motion, int64_t ahead_us, int32_t pos_wu[3])
{
    int64_t way[3], ahead_ms = (ahead_us > AHEAD_US_MAX ? AHEAD_US_MAX : ahead_us) / 1000;
    if (!straight_way(motion, ahead_ms, way)) return 0;
    for (int i = 0; i < 3; i++) pos_wu[i] = position(motion->last_wu[i] + (i < 2 ? way[i] : 0));
    return 1;
}

int64_t ff_motion_speed_wu_s(const ff_motion *motion)
{
    int64_t way[3];
    return straight_way(motion, 1000, way) ? c3d_length64(way[0], way[1], 0) : 0;
}
