/* FF_PANORAMA_AUTO in a client: asks the rule (ff_panorama_auto.h) every other second, and leaves a
 * panorama sooner. */
#include "../ff_client_local.h"
#include "ff_panorama_auto.h"
#include "../../protocol/ff_assert.h"

#define DECIDE_US INT64_C(2000000)
#define LEAVE_US  INT64_C(250000)   /* while a panorama is drawn: the viewer may set off */
#define AGAIN_US  INT64_C(20000000) /* after that: it shall not go to and fro */

/* Triangles drawn of nodes that lie beyond the back plane; each node counts alike. */
static uint32_t far_share(const ff_client *client, const c3d_camera *camera, int32_t front_wu,
                          uint32_t triangles)
{
    const ff_drawn *list;
    uint32_t count = ff_tree_drawn(client->tree, &list), beyond = 0;
    for (uint32_t i = 0; i < count; i++) {
        int64_t x = (int64_t)list[i].origin_wu[0] - camera->pos_wu[0],
                y = (int64_t)list[i].origin_wu[1] - camera->pos_wu[1];
        beyond += x > front_wu || x < -front_wu || y > front_wu || y < -front_wu;
    }
    FF_ASSERT(beyond <= count);
    return count ? (uint32_t)((uint64_t)triangles * beyond / count) : 0;
}

static void look_at_ground(ff_client *client, const c3d_camera *camera)
{
    ff_panorama_case *now = &client->far_ground;
    ff_tree_stats tree;
    ff_tree_get_stats(client->tree, &tree);
    now->front_wu = client->panorama.desc.back_plane_wu;
    const ff_quality *quality = ff_tree_quality(client->tree);
    now->asked_px_q8 = ff_client_quality(client).error_px_q8;
    now->ground_px_q8 = quality->measure == FF_MEASURE_PIXELS ? quality->error_px_q8 : 0;
    now->triangles = tree.triangles;
    now->far_triangles = far_share(client, camera, now->front_wu, tree.triangles);
}

static void look_at_link(ff_client *client, const c3d_camera *camera)
{
    ff_panorama_case *now = &client->far_ground;
    ff_stream_shared shared;
    unsigned faces = 0;
    ff_client_link(client, &shared);
    for (unsigned seen = ff_panorama_faces_in_view(camera); seen; seen &= seen - 1) faces++;
    now->focal_q8 = camera->focal_q8;
    now->half_width_q8 = (camera->width ? camera->width : client->desc.width) * 128;
    now->face_size = client->panorama.face_size;
    now->speed_wu_s = ff_motion_speed_wu_s(&client->motion);
    now->link_bytes_s = shared.bytes_s;
    now->set_bytes = faces * ff_requests_answer_bytes(&client->first.requests, FF_KIND_FACE, 0);
}

static void decide(ff_client *client, int32_t allowed_q8)
{
    int ground = allowed_q8 == 0;
    if (ground == client->auto_ground) return;
    client->auto_ground = (uint8_t)ground;
    client->dirty = 1;
    if (ground) {
        ff_requests_cancel_all(&client->first.requests, FF_KIND_FACE);
        client->auto_us += AGAIN_US - DECIDE_US;
    } else {
        client->panorama.desc.error_px_q8 = allowed_q8;
    }
}

void ff_client_auto_begin(ff_client *client)
{
    client->auto_ground = client->panorama.desc.enabled == FF_PANORAMA_AUTO;
    client->auto_us = 0;
}

void ff_client_auto_step(ff_client *client, const c3d_camera *camera, int64_t now_us)
{
    if (client->panorama.desc.enabled != FF_PANORAMA_AUTO || ff_client_low_power(client)) return;
    int drawn = !client->auto_ground;
    if (now_us - client->auto_us < (drawn ? LEAVE_US : DECIDE_US)) return;
    client->auto_us = now_us;
    /* faces do not make ground wait */
    if (!drawn && ff_client_waiting(client, FF_CLASS_IN_VIEW)) return;
    if (!drawn) look_at_ground(client, camera);
    look_at_link(client, camera);
    decide(client, ff_panorama_worth_q8(&client->far_ground, drawn));
}
