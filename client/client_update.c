/* A frame: take in new data, apply the panorama's rules, choose the cut, rank what is missing; then
 * draw. */
#include "several/ff_several.h"
#include "../protocol/ff_assert.h"

#include <string.h>

#define NEAR_WU_MIN       (FF_WU_PER_METRE / 4)
#define NEAR_WU_MAX       (4096 * FF_WU_PER_METRE)
#define NEAR_GIVEN_WU_MAX (16384 * FF_WU_PER_METRE) /* the sky is drawn 16 times as far away */
#define LOW_POWER_DIVISOR 2       /* C and triangles halved, pixels of error doubled */
#define REST_US           1000000 /* who is going nowhere within this time stays */

FF_STATIC_ASSERT((FF_QUALITY_ERROR_PX_MAX << 8) <= INT32_MAX / LOW_POWER_DIVISOR);
FF_STATIC_ASSERT(0 < NEAR_WU_MIN && NEAR_WU_MIN < NEAR_WU_MAX && NEAR_WU_MAX <= INT32_MAX / 16);

ff_quality ff_client_quality(const ff_client *client)
{
    ff_quality quality = client->desc.quality;
    ff_client_balance_quality(client, &quality);
    if (client->far_painted) quality.view_wu = ff_panorama_front_wu(&client->panorama);
    quality.fine_wu = client->fine_wu;
    quality.coarse = client->coarse;
    FF_ASSERT(quality.view_wu > 0);
    if (ff_client_low_power(client)) {
        if (quality.c_q8 > 1) quality.c_q8 /= LOW_POWER_DIVISOR; /* never none */
        quality.error_px_q8 *= LOW_POWER_DIVISOR;
        quality.triangles_max = quality.triangles_max / LOW_POWER_DIVISOR + 1;
    }
    return quality;
}

/* Carves pools for another terrain than before, or none when it does not fit. */
static int carve_anew(ff_client *client)
{
    ff_client_uncarve(client);
    client->has_camera = 0; /* another frame, too */
    int rc = ff_client_carve(client);
    FF_ASSERT(client->have_terrain == (rc == FF_OK));
    if (rc != FF_OK) ff_client_carve_sky(client);
    return rc;
}

/* The worker has met a terrain. */
static void settle_welcome(ff_client *client)
{
    sys_mutex_lock(&client->gate);
    ff_client_take_welcome(client, &client->first);
    client->info = client->first.intake.info[0];
    ff_terrain_show_images(&client->info, &client->first.intake.info[0],
                           ff_client_layer_levels(client, &client->first.layers, 0));
    int rc = ff_several_keep(client) ? FF_OK : carve_anew(client);
    client->terrain_error = rc;
    ff_stream_accept(&client->first.stream, rc == FF_OK);
    sys_mutex_unlock(&client->gate);
}

void ff_client_note_link(ff_client *client, ff_source *source, const ff_stream_shared *shared)
{
    uint8_t down = shared->state == FF_STREAM_DOWN || shared->state == FF_STREAM_DEAD;
    FF_ASSERT(shared->losses >= source->losses_seen);
    /* what was asked is queued again: is it still wanted, and who is to be asked? */
    if (shared->losses != source->losses_seen || down != source->down) client->unranked = 1;
    source->losses_seen = shared->losses;
    source->down = down;
    source->lacks = shared->lacks;
}

static void look_at_links(ff_client *client)
{
    ff_stream_shared shared;
    if (client->desc.stream) {
        ff_stream_get_shared(&client->first.stream, &shared);
        if (shared.state == FF_STREAM_WELCOMED) settle_welcome(client);
        ff_client_note_link(client, &client->first, &shared);
    }
    ff_several_look(client);
}

static int same_camera(const c3d_camera *a, const c3d_camera *b)
{
    return memcmp(a->pos_wu, b->pos_wu, sizeof a->pos_wu) == 0 && a->yaw == b->yaw &&
           a->pitch == b->pitch && a->roll == b->roll && a->focal_q8 == b->focal_q8 &&
           a->width == b->width && a->height == b->height && a->near_wu == b->near_wu &&
           a->far_wu == b->far_wu;
}

/* The camera as given, in world axes and with angles of any number of turns, as one in the client's
 * frame: yaw and roll 0 to 65535, pitch from -32768, so that angles can be added. */
static c3d_camera enter_frame(ff_client *client, const c3d_camera *camera)
{
    ff_frame *frame = &client->last_view.frame;
    c3d_camera here = *camera;
    if (!client->has_camera) *frame = ff_shape_frame(&client->info, camera->pos_wu);
    ff_shape_enter(&client->info, frame, camera->pos_wu, here.pos_wu);
    here.yaw &= 65535;
    here.roll &= 65535;
    here.pitch = (int16_t)(here.pitch & 65535);
    return here;
}

static void make_view(const ff_client *client, const c3d_camera *camera, const ff_quality *quality,
                      ff_view *view)
{
    view->camera = *camera;
    view->frame = client->last_view.frame;
    if (!view->camera.width || !view->camera.height) {
        view->camera.width = client->desc.width;
        view->camera.height = client->desc.height;
    }
    if (view->camera.near_wu <= 0) view->camera.near_wu = NEAR_WU_MIN;
    /* Ground is drawn in a box of half-edge view_wu round O. Its corners lie sqrt(3) times as far
     * from O, and the camera is not at O: three times covers both. */
    if (view->camera.far_wu <= view->camera.near_wu)
        view->camera.far_wu = quality->view_wu > INT32_MAX / 3 ? INT32_MAX : 3 * quality->view_wu;
    memcpy(view->centre_wu, camera->pos_wu, sizeof view->centre_wu);
    FF_ASSERT(client->panorama.shown < 2);
    if (client->panorama.shown >= 0 && client->far_painted)
        memcpy(view->centre_wu, client->panorama.set[client->panorama.shown].position_wu,
               sizeof view->centre_wu);
}

/* The ranges of c3d.h; without a size the picture's is taken. */
static int can_look(const c3d_camera *camera)
{
    return camera->focal_q8 >= 256 && camera->width <= FF_PICTURE_SIDE_MAX &&
           camera->height <= FF_PICTURE_SIDE_MAX && camera->near_wu <= NEAR_GIVEN_WU_MAX;
}

/* No terrain is known: the sky, as the camera sees it. */
static int update_sky(ff_client *client, const c3d_camera *camera)
{
    int changed = !client->has_camera || client->dirty || !same_camera(&client->camera, camera);
    client->camera = *camera;
    client->has_camera = 1;
    client->dirty = 0;
    ff_client_greet_view(client, camera);
    *(changed ? &client->frames_updated : &client->frames_skipped) += 1;
    return changed;
}

/* By its own rule the client waits for a panorama behind its own ground. */
static uint8_t is_far_painted(const ff_client *client, const c3d_camera *camera)
{
    return !ff_client_own_ground(client) && (client->panorama.desc.enabled == FF_PANORAMA_ON ||
                                             ff_panorama_whole(&client->panorama, camera));
}

/* All of the client's own ground is here, or was asked for: the panorama goes. */
static void leave_panorama(ff_client *client)
{
    if (!ff_client_own_ground(client) || client->panorama.active < 0 || client->dirty ||
        ff_client_waiting(client, FF_CLASS_IN_VIEW))
        return;
    ff_panorama_drop(&client->panorama);
    client->dirty = 1;
}

/* Whoever stops may have the panorama's other faces, although nothing else changes. */
static void look_for_rest(ff_client *client)
{
    int32_t expected_wu[3];
    uint8_t resting = !ff_motion_predict(&client->motion, REST_US, expected_wu);
    if (resting && !client->resting) client->unranked = 1;
    client->resting = resting;
}

/* How high the camera is above the ground; 0 where that is not known. */
static int32_t above_ground_wu(const ff_client *client, const c3d_camera *camera)
{
    int32_t ground_wu;
    if (!ff_client_ground(client, camera->pos_wu[0], camera->pos_wu[1], &ground_wu)) return 0;
    int64_t above_wu = (int64_t)camera->pos_wu[2] - ground_wu;
    return above_wu > INT32_MAX ? INT32_MAX : above_wu < 0 ? 0 : (int32_t)above_wu;
}

static int update_sets(ff_client *client, const c3d_camera *camera, int64_t now_us)
{
    if (!client->sets) return 0;
    int hold = ff_client_low_power(client) || !client->first.serves;
    int32_t clearance_wu = above_ground_wu(client, camera);
    if (client->first.lacks & FF_LACKS_FAR) client->sets->off = 1;
    ff_client_far_step(client, camera, clearance_wu, now_us);
    int turned = ff_sets_update(client->sets, &client->first.requests, camera, &client->motion,
                                clearance_wu, hold, now_us);
    client->coarse = 0;
    if (!ff_sets_in_use(client->sets, camera, &client->fine_wu, &client->coarse))
        client->fine_wu = 0;
    return turned;
}

int ff_client_update(ff_client *client, int64_t now_us, const c3d_camera *given)
{
    int pictures_changed = 0;
    look_at_links(client);
    if (!can_look(given)) {
        client->frames_skipped++;
        return 0;
    }
    if (!client->have_terrain) return update_sky(client, given);
    const c3d_camera entered = enter_frame(client, given), *camera = &entered;
    unsigned taken = ff_client_take_new_data(client, now_us, &pictures_changed);
    int moved = !client->has_camera || !same_camera(&client->camera, camera);
    ff_quality quality = ff_client_quality(client);
    ff_view view;
    make_view(client, camera, &quality, &view);
    leave_panorama(client);
    ff_client_balance_step(client, &view.camera, now_us);
    ff_motion_feed(&client->motion, now_us, camera->pos_wu);
    ff_turn_feed(&client->turn, now_us, camera->yaw, camera->pitch);
    look_for_rest(client);
    ff_client_auto_step(client, camera, now_us);
    int hold = ff_client_low_power(client) || ff_client_own_ground(client) ||
               !client->first.serves || (client->first.lacks & FF_LACKS_PANORAMAS) != 0;
    int turned = ff_panorama_update(&client->panorama, &client->first.requests, &view.camera,
                                    &client->motion, hold, now_us);
    turned |= update_sets(client, &view.camera, now_us);
    client->far_painted = is_far_painted(client, camera);
    if (!taken && !moved && !turned && !client->dirty && !client->unranked) {
        client->frames_skipped++;
        return 0;
    }
    quality = ff_client_quality(client);
    /* the panorama's centre and front may be others now */
    make_view(client, camera, &quality, &view);
    ff_tree_select(client->tree, &view, &quality);
    pictures_changed |= ff_client_rank(client, &view, &quality, now_us);
    const ff_drawn *list;
    uint32_t count = ff_tree_drawn(client->tree, &list);
    ff_terrain_view_begin(&client->view, list, count);
    uint64_t hash = ff_terrain_view_hash(&client->view, list, count);
    int changed = moved || turned || pictures_changed || client->dirty ||
                  hash != client->frame_hash;
    client->camera = *camera;
    client->last_view = view;
    client->has_camera = 1;
    client->dirty = 0;
    client->unranked = ff_tree_to_make(client->tree) > 0 || client->textures.waits;
    client->frame_hash = hash;
    if (!changed) {
        client->frames_skipped++;
        return 0;
    }
    client->geometry_hash = (client->geometry_hash ^ hash) * UINT64_C(0x100000001b3);
    client->frames_updated++;
    return 1;
}

/* ---- drawing ---- */

/* How near ground may be: as far as the camera is above it, or from the terrain's border when it is
 * outside. 0: nobody knows. */
static int64_t clearance_wu(const ff_client *client, const c3d_camera *camera)
{
    int64_t height_wu[2], away_wu = 0;
    int32_t ground_wu;
    if (ff_client_ground(client, camera->pos_wu[0], camera->pos_wu[1], &ground_wu))
        return (int64_t)camera->pos_wu[2] - ground_wu;
    ff_terrain_range_wu(&client->info, height_wu);
    ff_box all = ff_shape_bounds(&client->info, &client->last_view.frame, height_wu,
                                 camera->pos_wu);
    for (int axis = 0; axis < 2; axis++) {
        int64_t beyond_wu = all.lo[axis] > -all.hi[axis] ? all.lo[axis] : -all.hi[axis];
        away_wu = beyond_wu > away_wu ? beyond_wu : away_wu;
    }
    return away_wu;
}

/* Near and far planes where the camera leaves them open: an eighth of the way to the ground, and
 * the farthest node in view, hidden or not: depths are rounded alike. */
static void fit_planes(const ff_client *client, c3d_camera *camera)
{
    if (client->camera.near_wu <= 0) {
        int64_t near_wu = clearance_wu(client, camera) / 8;
        camera->near_wu = near_wu < NEAR_WU_MIN   ? NEAR_WU_MIN
                          : near_wu > NEAR_WU_MAX ? NEAR_WU_MAX
                                                  : (int32_t)near_wu;
    }
    if (client->camera.far_wu > camera->near_wu) return;
    const ff_drawn *list;
    uint32_t count = ff_tree_in_view(client->tree, &list);
    int32_t lowest_wu = ff_height_wu(&client->info, client->info.height_min);
    int64_t far_wu = 16 * (int64_t)camera->near_wu; /* sky and panorama lie within */
    for (uint32_t i = 0; i < count; i++) {
        int64_t edge_wu = ff_node_edge_wu(&client->info, ff_key_level(list[i].key)), way_wu[3];
        ff_shape_to_middle(&client->info, list[i].key, ff_tree_placed(list[i].node), lowest_wu,
                           camera->pos_wu, way_wu);
        int64_t reach = c3d_length64(way_wu[0], way_wu[1], way_wu[2]) + edge_wu;
        far_wu = reach > far_wu ? reach : far_wu;
    }
    camera->far_wu = far_wu > INT32_MAX ? INT32_MAX : (int32_t)far_wu;
}

static void set_fog(const ff_client *client, c3d_frame *frame)
{
    const ff_view *view = &client->last_view;
    int32_t sight_wu = ff_tree_quality(client->tree)->view_wu;
    if (client->panorama.shown >= 0 || (client->show & FF_SHOW_NO_FOG))
        return; /* the join with the panorama must not show */
    if (sight_wu >= ff_shape_horizon_wu(&client->info, &view->frame, view->centre_wu))
        return; /* all is drawn that can be seen: nothing to hide */
    FF_ASSERT(sight_wu > 0);
    frame->fog_start_wu = sight_wu / 2;
    frame->fog_end_wu = sight_wu;
    frame->fog_colour = FF_SKY_HORIZON_COLOUR;
}

static void draw_sky(ff_client *client)
{
    c3d_frame frame = { .camera = client->camera, .clear_colour = FF_SKY_HORIZON_COLOUR };
    if (!frame.camera.width || !frame.camera.height) {
        frame.camera.width = client->desc.width;
        frame.camera.height = client->desc.height;
    }
    frame.camera.near_wu = NEAR_WU_MIN;
    frame.camera.far_wu = 16 * NEAR_WU_MIN; /* the sky lies within */
    c3d_begin(client->device, &frame);
    ff_sky_draw(&client->sky, client->device, frame.camera.near_wu);
    c3d_end(client->device);
}

/* The viewer's, over a map of it. */
static void draw_place(ff_client *client)
{
    const ff_view *view = &client->last_view;
    int32_t place_wu[3];
    int64_t offset_wu[3];
    FF_ASSERT(client->have_terrain && client->desc.use_map);
    ff_shape_enter(&client->info, &view->frame, client->map.place_wu, place_wu);
    for (int axis = 0; axis < 3; axis++)
        offset_wu[axis] = (int64_t)place_wu[axis] - view->camera.pos_wu[axis];
    ff_contours_point(&client->view.contours, offset_wu);
}

void ff_client_draw(ff_client *client)
{
    if (!client->device || !client->has_camera) return;
    if (!client->have_terrain) {
        draw_sky(client);
        return;
    }
    c3d_frame frame = { .camera = client->last_view.camera, .clear_colour = FF_SKY_HORIZON_COLOUR };
    fit_planes(client, &frame.camera);
    set_fog(client, &frame);
    c3d_begin(client->device, &frame);
    ff_sky_draw(&client->sky, client->device, frame.camera.near_wu);
    ff_panorama_draw(&client->panorama, frame.camera.near_wu);
    const ff_drawn *list;
    uint32_t count = ff_tree_drawn(client->tree, &list);
    if (client->sets) ff_sets_aim(client->sets, &frame.camera);
    client->view.contours.interval_wu = client->map.contour_wu;
    ff_terrain_view_draw(&client->view, list, count, &frame.camera, client->show);
    if (client->sets) ff_sets_draw(client->sets, &frame.camera);
    if (client->map.has_place) draw_place(client);
    c3d_end(client->device);
}
