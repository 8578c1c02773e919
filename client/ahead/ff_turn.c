#include "ff_turn.h"
#include "../../protocol/ff_assert.h"

#include <string.h>

#define BIN_US         200000
#define PAUSE_US_MAX   2000000
#define STILL_BRAD     128 /* a smaller turn is none: 0.7 degrees */
#define STEP_BRAD      8192
#define YAW_BRAD_MAX   (FF_TURN_VIEWS_MAX * STEP_BRAD)
#define PITCH_BRAD_MAX 16384
#define AHEAD_US_MAX   30000000
#define RATE_BRAD_MAX  (1 << 24) /* a second: 256 turns */

FF_STATIC_ASSERT(YAW_BRAD_MAX == 65536 / 2); /* half a turn */
FF_STATIC_ASSERT(PITCH_BRAD_MAX == 65536 / 4 && PITCH_BRAD_MAX <= YAW_BRAD_MAX);
FF_STATIC_ASSERT(STILL_BRAD < STEP_BRAD && BIN_US < PAUSE_US_MAX);

void ff_turn_reset(ff_turn *turn) { memset(turn, 0, sizeof *turn); }

static int32_t within(int64_t value, int32_t limit)
{
    return value > limit ? limit : value < -limit ? -limit : (int32_t)value;
}

/* From one angle to another the short way round. */
static int32_t turned(int32_t from, int32_t to)
{
    FF_ASSERT(from >= 0 && from <= 0xFFFF && to >= 0 && to <= 0xFFFF);
    int32_t by = (to - from) & 0xFFFF;
    return by < 0x8000 ? by : by - 0x10000;
}

void ff_turn_feed(ff_turn *turn, int64_t now_us, int32_t yaw, int32_t pitch)
{
    int64_t elapsed_us = now_us - turn->since_us;
    yaw &= 0xFFFF; /* angles come from outside */
    pitch &= 0xFFFF;
    if (!turn->has_last || elapsed_us < 0 || elapsed_us > PAUSE_US_MAX) {
        *turn =
            (ff_turn){ .since_us = now_us, .last_yaw = yaw, .last_pitch = pitch, .has_last = 1 };
        return;
    }
    turn->yaw_sum += turned(turn->last_yaw, yaw);
    turn->pitch_sum += turned(turn->last_pitch, pitch);
    turn->last_yaw = yaw;
    turn->last_pitch = pitch;
    if (elapsed_us < BIN_US) return;
    turn->yaw_rate = within(turn->yaw_sum * 1000000 / elapsed_us, RATE_BRAD_MAX);
    turn->pitch_rate = within(turn->pitch_sum * 1000000 / elapsed_us, RATE_BRAD_MAX);
    turn->yaw_sum = turn->pitch_sum = 0;
    turn->since_us = now_us;
}

static int32_t size_of(int32_t value) { return value < 0 ? -value : value; }

unsigned ff_turn_predict(const ff_turn *turn, int64_t ahead_us, int32_t *yaw, int32_t *pitch)
{
    int64_t ahead_ms = (ahead_us < AHEAD_US_MAX ? ahead_us : AHEAD_US_MAX) / 1000;
    *yaw = within(turn->yaw_rate * ahead_ms / 1000, YAW_BRAD_MAX);
    *pitch = within(turn->pitch_rate * ahead_ms / 1000, PITCH_BRAD_MAX);
    int32_t most = size_of(*yaw) > size_of(*pitch) ? size_of(*yaw) : size_of(*pitch);
    FF_ASSERT(most <= FF_TURN_VIEWS_MAX * STEP_BRAD);
    return most < STILL_BRAD ? 0 : (unsigned)(most + STEP_BRAD - 1) / STEP_BRAD;
}
