/* Stands in for this room in builds without far sets. */
#include "../ask/ff_intake_local.h"
#include "../ff_client_local.h"

#include <string.h>

const uint8_t ff_sets_built = 0;

void ff_sets_init(ff_sets *sets, c3d_device *device, const ff_far_desc *desc,
                  const ff_terrain_info *info, unsigned side)
{
    (void)device, (void)info, (void)side;
    memset(sets, 0, sizeof *sets);
    sets->desc = *desc;
    sets->active = sets->next = sets->under = -1;
}

void ff_sets_set(ff_sets *sets, ff_requests *requests, const ff_far_desc *desc)
{
    (void)sets, (void)requests, (void)desc;
}

void ff_sets_scratch(ff_sets *sets, c3d_vertex *scratch, uint16_t *indices, unsigned vertices)
{
    (void)sets, (void)scratch, (void)indices, (void)vertices;
}

unsigned ff_sets_side(int32_t focal_q8) { return (void)focal_q8, 0; }

int ff_sets_in_use(const ff_sets *sets, const c3d_camera *camera, int32_t *fine_wu, uint8_t *coarse)
{
    return (void)sets, (void)camera, (void)fine_wu, (void)coarse, 0;
}

void ff_client_far_step(ff_client *client, const c3d_camera *camera, int32_t clearance_wu,
                        int64_t now_us)
{
    (void)client, (void)camera, (void)clearance_wu, (void)now_us;
}

int ff_sets_update(ff_sets *sets, ff_requests *requests, const c3d_camera *camera,
                   const ff_motion *motion, int32_t clearance_wu, int hold, int64_t now_us)
{
    (void)sets, (void)requests, (void)camera, (void)motion, (void)clearance_wu, (void)hold;
    (void)now_us;
    return 0;
}

void ff_sets_want(const ff_sets *sets, ff_requests *requests, const ff_view *view, unsigned soon,
                  int64_t now_us)
{
    (void)sets, (void)requests, (void)view, (void)soon, (void)now_us;
}

void ff_sets_want_reserve(const ff_sets *sets, ff_requests *requests, const ff_view *view,
                          const ff_motion *motion, int64_t now_us)
{
    (void)sets, (void)requests, (void)view, (void)motion, (void)now_us;
}

unsigned ff_sets_in_view(const c3d_camera *camera) { return (void)camera, 0; }

int ff_sets_take(ff_sets *sets, const ff_new_item *item, int64_t now_us)
{
    return (void)sets, (void)item, (void)now_us, 0;
}

void ff_sets_aim(ff_sets *sets, const c3d_camera *camera) { (void)sets, (void)camera; }

unsigned ff_sets_lay(const void *sets, const ff_terrain_info *info, const ff_drawn *drawn,
                     ff_view_kept *kept, c3d_draw draws[FF_THROWS_MAX],
                     const ff_squares *without[FF_THROWS_MAX])
{
    return (void)sets, (void)info, (void)drawn, (void)kept, (void)draws, (void)without, 1;
}

void ff_sets_draw(const ff_sets *sets, const c3d_camera *camera) { (void)sets, (void)camera; }

/* Never asked for. */
int ff_intake_far(ff_intake *intake, const ff_message *answer, ff_new_item *item)
{
    (void)intake, (void)answer, (void)item;
    return FF_ERR_UNSUPPORTED;
}
