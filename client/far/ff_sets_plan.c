/* Where a set is taken, and for which region it is asked. */
#include "ff_sets.h"

#include <string.h>

#define M        FF_WU_PER_METRE
#define SLACK_WU (100 * M)
#define USUAL_WU (7500 * M)

/* How far a set whose front is 7500 m away, or four fifths of how high the viewer is, is good along
 * the way, and how much O lies above the path, by the height above ground: from the measurements in
 * DESIGN.md. Between the rows in proportion. */
typedef struct plan_row {
    int32_t clearance_m, life_m, lift_m;
} plan_row;
static const plan_row rows[] = {
    { 0, 1500, 100 },    { 100, 1800, 150 },    { 600, 3200, 300 },
    { 2000, 4400, 400 }, { 12000, 11500, 400 }, { INT32_MAX, 11500, 0 }
};

static void look_up(int32_t clearance_wu, int32_t *life_wu, int32_t *lift_wu)
{
    int64_t at_m = clearance_wu > 0 ? clearance_wu / M : 0;
    unsigned i = 0;
    FF_ASSERT(at_m < INT32_MAX); /* the last row ends the search */
    while (at_m >= rows[i + 1].clearance_m) i++;
    const plan_row *low = &rows[i], *high = &rows[i + 1];
    FF_ASSERT(high->clearance_m > low->clearance_m);
    int64_t part = at_m - low->clearance_m, whole = high->clearance_m - low->clearance_m;
    *life_wu = (int32_t)(low->life_m + (high->life_m - low->life_m) * part / whole) * M;
    *lift_wu = (int32_t)(low->lift_m + (high->lift_m - low->lift_m) * part / whole) * M;
}

int32_t ff_sets_front_wu(const ff_sets *sets, int32_t clearance_wu)
{
    int32_t high_wu = clearance_wu / 5 * 4; /* what is nearer lies below a level view */
    int32_t front_wu = sets->desc.front_wu > high_wu ? sets->desc.front_wu : high_wu;
    return front_wu < FF_PANORAMA_BACK_WU_MAX / 2 ? front_wu : FF_PANORAMA_BACK_WU_MAX / 2;
}

/* Parallax is the less the farther away ground is. */
static int32_t stretched(int32_t life_wu, int64_t front_wu, int64_t usual_wu)
{
    FF_ASSERT(usual_wu >= USUAL_WU && front_wu >= 0);
    int64_t stretched_wu = life_wu * front_wu / usual_wu;
    return (int32_t)(stretched_wu < 2 * (int64_t)life_wu ? stretched_wu : 2 * (int64_t)life_wu);
}

int32_t ff_sets_life_wu(const ff_sets *sets, int32_t clearance_wu)
{
    int32_t life_wu, lift_wu, high_wu = clearance_wu / 5 * 4,
                              usual_wu = high_wu > USUAL_WU ? high_wu : USUAL_WU;
    look_up(clearance_wu, &life_wu, &lift_wu);
    return stretched(life_wu, ff_sets_front_wu(sets, clearance_wu), usual_wu);
}

/* atan2 in brad16, 0 north, clockwise; within a 256th of a turn. */
static uint16_t azimuth(int64_t east, int64_t north)
{
    uint16_t best = 0;
    int64_t most = INT64_MIN;
    for (uint32_t at = 0; at < 65536; at += 256) {
        int64_t along = (east * c3d_sin_q30((int32_t)at) + north * c3d_cos_q30((int32_t)at)) >> 15;
        if (along > most) most = along, best = (uint16_t)at;
    }
    return best;
}

void ff_sets_plan(const ff_sets *sets, const c3d_camera *camera, const ff_motion *motion,
                  int32_t clearance_wu, ff_set *set)
{
    int32_t life_wu, lift_wu, then_wu[3], later_wu[3];
    uint32_t times_q8 = ff_far_times_q8(sets->choice.rung);
    look_up(clearance_wu, &life_wu, &lift_wu);
    life_wu = (int32_t)((int64_t)ff_sets_life_wu(sets, clearance_wu) * times_q8 >> 8);
    set->front_wu = (int32_t)((int64_t)ff_sets_front_wu(sets, clearance_wu) * times_q8 >> 8);
    memcpy(then_wu, camera->pos_wu, sizeof then_wu);
    int moves = ff_motion_level(motion, sets->lead_us + 1000000, later_wu);
    ff_set_region *region = &set->region;
    region->aside_wu = life_wu / 6;
    region->behind_wu = region->ahead_wu = life_wu / 2;
    region->heading = (uint16_t)camera->yaw;
    if (moves) {
        (void)ff_motion_level(motion, sets->lead_us, then_wu);
        int64_t way[2] = { (int64_t)later_wu[0] - camera->pos_wu[0],
                           (int64_t)later_wu[1] - camera->pos_wu[1] };
        int64_t length = c3d_length64(way[0], way[1], 0);
        region->heading = azimuth(way[0], way[1]);
        /* from where the viewer is now: so it is good while it is on its way */
        region->behind_wu = life_wu / 4 + SLACK_WU +
                            (int32_t)c3d_length64((int64_t)then_wu[0] - camera->pos_wu[0],
                                                  (int64_t)then_wu[1] - camera->pos_wu[1], 0);
        region->ahead_wu = life_wu - life_wu / 4;
        for (int axis = 0; axis < 2 && length > 0; axis++)
            then_wu[axis] += (int32_t)(way[axis] * (life_wu / 4) / length);
    } else {
        region->aside_wu = life_wu / 2;
    }
    memcpy(set->position_wu, then_wu, sizeof then_wu);
    set->position_wu[2] += lift_wu;
    /* who sinks sees less; who climbs above O sees what O did not */
    region->high_wu = 0;
    region->low_wu = -lift_wu - life_wu / 4;
}

int ff_sets_good(const ff_set *set, const int32_t position_wu[3])
{
    const ff_set_region *region = &set->region;
    int64_t away[3], east = c3d_sin_q30(region->heading), north = c3d_cos_q30(region->heading);
    for (int axis = 0; axis < 3; axis++)
        away[axis] = (int64_t)position_wu[axis] - set->position_wu[axis];
    int64_t forward = (away[0] * east + away[1] * north) >> 30,
            right = (away[0] * north - away[1] * east) >> 30;
    return forward >= -region->behind_wu && forward <= region->ahead_wu &&
           right >= -region->aside_wu && right <= region->aside_wu && away[2] >= region->low_wu &&
           away[2] <= region->high_wu;
}
