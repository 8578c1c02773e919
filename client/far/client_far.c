/* Sets in a client: when the rule of FF_FAR_AUTO is asked, with what, and what follows. */
#include "../ff_client_local.h"
#include "../../protocol/ff_assert.h"

#define DECIDE_US   INT64_C(2000000)
#define PATIENCE_US INT64_C(6000000)  /* while ground in view is missing */
#define QUIET_US    INT64_C(1000000)  /* since something in view was waited for */
#define AGAIN_US    INT64_C(20000000) /* between sets and none: it shall not go to and fro */
#define LEAVE_US    INT64_C(60000000) /* since sets paid last */

static void describe(ff_client *client, const c3d_camera *camera, int32_t clearance_wu,
                     ff_far_case *now)
{
    ff_tree_stats tree;
    ff_stream_shared shared;
    const ff_quality *quality = ff_tree_quality(client->tree);
    ff_tree_get_stats(client->tree, &tree);
    ff_client_link(client, &shared);
    *now = (ff_far_case){ .window = (uint32_t)camera->width * camera->height,
                          .width = camera->width,
                          .coarse = client->coarse,
                          .has_images = client->has_textures,
                          .no_paint = client->desc.far.no_paint,
                          .triangles = tree.triangles,
                          .triangles_max = quality->triangles_max,
                          .life_wu = ff_sets_life_wu(client->sets, clearance_wu),
                          .speed_wu_s = ff_motion_speed_wu_s(&client->motion),
                          .link_bytes_s = shared.bytes_s };
    if (quality->measure == FF_MEASURE_PIXELS) {
        now->asked_px_q8 = ff_client_quality(client).error_px_q8;
        now->ground_px_q8 = quality->error_px_q8;
    }
    ff_estimate_far(client->tree, ff_sets_front_wu(client->sets, clearance_wu), &now->ground);
}

/* Sets that do not pay now may do so in the next valley or to the other side: for a while no new
 * one is asked for, and only then they are left. */
static void choose(ff_client *client, const ff_far_choice *next, int64_t now_us)
{
    ff_far_choice *choice = &client->sets->choice;
    int turns = !next->use != !choice->use;
    if (next->use || !choice->use) client->far_paid_us = now_us;
    client->sets->unpaid = !next->use;
    if (turns && client->far_turns && now_us - client->far_turned_us < AGAIN_US) return;
    if (turns && !next->use && now_us - client->far_paid_us < LEAVE_US) return;
    if (turns) {
        client->far_turned_us = now_us;
        client->far_turns++;
        client->dirty = 1;
    }
    *choice = *next;
}

/* Something in view waits to be asked for, or ground is on its way. */
static int ground_is_missing(ff_client *client)
{
    ff_request_counts counts;
    if (ff_client_waiting(client, FF_CLASS_IN_VIEW)) return 1;
    ff_client_counts(client, &counts);
    return counts.of[FF_KIND_ROOT].in_flight || counts.of[FF_KIND_REFINEMENT].in_flight ||
           counts.of[FF_KIND_VIEW].in_flight;
}

/* All of the client's own ground is here, or was asked for: what is left of sets goes. */
static void leave(ff_client *client, int64_t now_us)
{
    if (client->sets->choice.use || client->dirty || client->unranked) return;
    if (client->sets->active < 0 && client->sets->next < 0) return;
    if (ground_is_missing(client)) return;
    ff_sets_leave(client->sets, &client->first.requests, now_us);
    client->dirty = 1;
}

static void decide(ff_client *client, const c3d_camera *camera, int32_t clearance_wu,
                   int64_t now_us)
{
    if (!client->far_asked) client->far_us = client->far_waiting_us = now_us;
    client->far_asked = 1;
    int64_t past_us = now_us - client->far_us;
    if (past_us < DECIDE_US - QUIET_US) return;
    if (ground_is_missing(client)) client->far_waiting_us = now_us;
    int64_t quiet_us = now_us - client->far_waiting_us;
    if (past_us < DECIDE_US || (quiet_us < QUIET_US && past_us < PATIENCE_US)) return;
    ff_far_case now;
    describe(client, camera, clearance_wu, &now);
    if (!now.ground.nodes) return;
    client->far_us = now_us;
    ff_far_choice next = ff_far_choose(&now, &client->sets->choice);
    choose(client, &next, now_us);
}

void ff_client_far_step(ff_client *client, const c3d_camera *camera, int32_t clearance_wu,
                        int64_t now_us)
{
    if (client->desc.far.enabled != FF_FAR_AUTO || ff_client_low_power(client)) return;
    leave(client, now_us);
    if (client->desc.balance.mode == FF_BALANCE_ALL_CLIENT)
        client->sets->choice.use = FF_FAR_OFF;
    else
        decide(client, camera, clearance_wu, now_us);
}
