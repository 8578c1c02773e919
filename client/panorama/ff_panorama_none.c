/* Stands in for ff_panorama.c in builds without panoramas. */
#include "../ask/ff_intake_local.h"
#include "../ff_client_local.h"
#include "ff_panorama.h"
#include "ff_panorama_rules.h"

#include <string.h>

const uint8_t ff_panorama_built = 0;

void ff_panorama_init(ff_panorama *panorama, c3d_device *device, const ff_panorama_desc *desc,
                      const ff_terrain_info *info, unsigned face_size)
{
    (void)device, (void)info, (void)face_size;
    memset(panorama, 0, sizeof *panorama);
    panorama->desc = *desc;
    panorama->active = panorama->next = panorama->shown = -1;
}

void ff_panorama_drop(ff_panorama *panorama) { (void)panorama; }

int ff_panorama_update(ff_panorama *panorama, ff_requests *requests, const c3d_camera *camera,
                       const ff_motion *motion, int hold, int64_t now_us)
{
    (void)panorama, (void)requests, (void)camera, (void)motion, (void)hold, (void)now_us;
    return 0;
}

unsigned ff_panorama_faces_in_view(const c3d_camera *camera) { return (void)camera, 0; }

int ff_panorama_whole(const ff_panorama *panorama, const c3d_camera *camera)
{
    return (void)panorama, (void)camera, 0;
}

int ff_panorama_late(const ff_panorama *panorama, const c3d_camera *camera)
{
    return (void)panorama, (void)camera, 0;
}

void ff_panorama_want(const ff_panorama *panorama, ff_requests *requests, const ff_view *view,
                      unsigned soon, int64_t now_us)
{
    (void)panorama, (void)requests, (void)view, (void)soon, (void)now_us;
}

void ff_panorama_want_reserve(const ff_panorama *panorama, ff_requests *requests,
                              const ff_view *view, int64_t now_us)
{
    (void)panorama, (void)requests, (void)view, (void)now_us;
}

int ff_panorama_take(ff_panorama *panorama, const ff_new_item *item, int64_t now_us)
{
    (void)panorama, (void)item, (void)now_us;
    return 0;
}

void ff_panorama_draw(const ff_panorama *panorama, int32_t near_wu)
{
    (void)panorama, (void)near_wu;
}

void ff_client_auto_begin(ff_client *client) { (void)client; }

void ff_client_auto_step(ff_client *client, const c3d_camera *camera, int64_t now_us)
{
    (void)client, (void)camera, (void)now_us;
}

/* Never asked for. */
int ff_intake_face(ff_intake *intake, const ff_message *answer, ff_new_item *item)
{
    (void)intake, (void)answer, (void)item;
    return FF_ERR_UNSUPPORTED;
}
