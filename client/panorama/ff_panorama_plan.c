/* Where is the next set taken, and when is it asked for? The viewer's motion decides both. Hybrid
 * takes a set where the viewer is when the old one is outdated: but then half of the ground over
 * which the set is good lies behind, and the set comes too late by a round trip. */
#include "ff_panorama.h"

#include <string.h>

#define HALVINGS 7
/* O is placed at 7/8 of the farthest distance ahead at which the set would still be good: the
 * viewer's path may bend. */
#define TRUST_OF_8   7
#define AHEAD_US_MAX 30000000

FF_STATIC_ASSERT(TRUST_OF_8 < 8 && AHEAD_US_MAX >> HALVINGS > 0);

int ff_panorama_set_outdated(const ff_panorama *panorama, const ff_panorama_set *set,
                             const c3d_camera *camera)
{
    return set->front_wu != panorama->desc.back_plane_wu ||
           ff_panorama_outdated(camera, set->position_wu, &set->sight, set->front_wu,
                                panorama->desc.error_px_q8);
}

/* The camera where the viewer will be when a set asked for now is here. */
static c3d_camera camera_then(const ff_panorama *panorama, const c3d_camera *camera,
                              const ff_motion *motion)
{
    c3d_camera then = *camera;
    FF_ASSERT(panorama->lead_us <= AHEAD_US_MAX);
    (void)ff_motion_level(motion, panorama->lead_us, then.pos_wu);
    return then;
}

int ff_panorama_outdated_soon(const ff_panorama *panorama, const c3d_camera *camera,
                              const ff_motion *motion)
{
    FF_ASSERT(panorama->active < 2);
    if (panorama->active < 0) return 1;
    const ff_panorama_set *set = &panorama->set[panorama->active];
    c3d_camera then = camera_then(panorama, camera, motion);
    return ff_panorama_set_outdated(panorama, set, camera) ||
           ff_panorama_set_outdated(panorama, set, &then);
}

/* Fills in what another set is expected to show: on each upright face as much as the drawn set
 * shows on any of them; without a drawn set, all that the terrain has. */
static void expect(const ff_panorama *panorama, ff_panorama_set *set)
{
    int32_t z_wu = set->front_wu, low_wu = INT32_MAX, high_wu = INT32_MIN;
    int64_t height_wu[2];
    FF_ASSERT(z_wu == panorama->desc.back_plane_wu && z_wu > 0);
    ff_terrain_range_wu(panorama->info, height_wu);
    const int32_t ground_wu[2] = { (int32_t)(height_wu[0] -
                                             ff_shape_drop_wu(panorama->info, z_wu, z_wu)),
                                   (int32_t)height_wu[1] };
    ff_panorama_sight_terrain(&set->sight, set->position_wu, ground_wu, z_wu);
    if (panorama->active < 0 || panorama->set[panorama->active].front_wu != z_wu) return;
    const ff_panorama_sight *drawn = &panorama->set[panorama->active].sight;
    for (unsigned face = 0; face < FF_FACE_UP; face++)
        if (drawn->low_wu[face] <= drawn->high_wu[face]) {
            low_wu = drawn->low_wu[face] < low_wu ? drawn->low_wu[face] : low_wu;
            high_wu = drawn->high_wu[face] > high_wu ? drawn->high_wu[face] : high_wu;
        }
    for (unsigned face = 0; face < FF_FACE_COUNT && low_wu <= high_wu; face++) {
        int there = face < FF_FACE_UP || drawn->low_wu[face] <= drawn->high_wu[face];
        set->sight.low_wu[face] = there ? low_wu : 1;
        set->sight.high_wu[face] = there ? high_wu : 0;
    }
}

/* 1 when a set taken where the viewer will be `ahead_us` from now is good as soon as it is here. */
static int is_good(const ff_panorama *panorama, const c3d_camera *camera, const c3d_camera *then,
                   const ff_motion *motion, int64_t ahead_us, ff_panorama_set *set)
{
    FF_ASSERT(ahead_us >= panorama->lead_us);
    if (!ff_motion_level(motion, ahead_us, set->position_wu)) return 0;
    for (int axis = 0; axis < 2; axis++) {
        int64_t away_wu = (int64_t)set->position_wu[axis] - camera->pos_wu[axis];
        /* O is the middle of the client's own ground: it stays near the viewer */
        if (away_wu > set->front_wu / 4 || away_wu < -set->front_wu / 4) return 0;
    }
    expect(panorama, set);
    return !ff_panorama_set_outdated(panorama, set, then);
}

void ff_panorama_plan(const ff_panorama *panorama, const c3d_camera *camera,
                      const ff_motion *motion, ff_panorama_set *set)
{
    c3d_camera then = camera_then(panorama, camera, motion);
    int64_t good_us = 0, bad_us = AHEAD_US_MAX;
    for (int i = 0; i < HALVINGS; i++) {
        int64_t ahead_us = (good_us + bad_us) / 2;
        if (is_good(panorama, camera, &then, motion, panorama->lead_us + ahead_us, set))
            good_us = ahead_us;
        else
            bad_us = ahead_us;
    }
    FF_ASSERT(good_us < bad_us && bad_us - good_us <= (AHEAD_US_MAX >> HALVINGS) + 1);
    memcpy(set->position_wu, camera->pos_wu, sizeof set->position_wu);
    (void)ff_motion_level(motion, panorama->lead_us + good_us / 8 * TRUST_OF_8, set->position_wu);
    expect(panorama, set);
}
