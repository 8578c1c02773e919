#include "ff_far_seen.h"

#include <stdlib.h>
#include <string.h>

#define EYES          10
#define EYE_NEAR_WU   (2 * FF_WU_PER_METRE)
#define EYE_ERROR_PX  2
#define EYE_WIDTH_Q8  512 /* twice the tangent of half its picture, 45 degrees */
#define EYE_HEIGHT_Q8 512
#define EYE_SIDE_MAX  2048
#define SLACK         32 /* a place may be a 32nd of its distance behind what is drawn there */

int64_t ff_far_spots_add(ff_far_spots *spots, uint32_t column, uint32_t row)
{
    if (spots->count == spots->capacity) {
        uint32_t capacity = spots->capacity ? 2 * spots->capacity : 65536;
        ff_far_spot *grown = realloc(spots->spot, capacity * sizeof *grown);
        if (!grown) return FF_ERR_MEMORY;
        spots->spot = grown;
        spots->capacity = capacity;
    }
    spots->spot[spots->count] = (ff_far_spot){ (uint16_t)column, (uint16_t)row, 0 };
    return spots->count++;
}

int ff_far_room_fit(ff_far_room *room, size_t count)
{
    if (count <= room->count) return FF_OK;
    free(room->value);
    room->value = malloc(count * sizeof *room->value);
    room->count = room->value ? count : 0;
    return room->value ? FF_OK : FF_ERR_MEMORY;
}

/* ---- eyes ---- */

/* Where eyes stand: parts of the way ahead (or behind, if negative), aside, and of the height
 * between the region's lowest and highest. The first ones see most. */
static const int8_t stands[EYES][3] = { { 0, 0, 1 },   { 1, 1, 1 }, { 1, -1, 1 }, { -1, 1, 1 },
                                        { -1, -1, 1 }, { 1, 0, 1 }, { -1, 0, 1 }, { 0, 0, 0 },
                                        { 1, 0, 0 },   { -1, 0, 0 } };

/* East, north and up of O, wu. */
static void stand(const ff_get_far *request, const int8_t part[3], int64_t offset_wu[3])
{
    c3d_camera along = { .yaw = request->heading };
    c3d_rotation rotation;
    int64_t forward_m = part[0] < 0 ? -(int64_t)request->behind_m
                                    : (int64_t)request->ahead_m * part[0],
            right_m = (int64_t)request->aside_m * part[1];
    c3d_rotation_from_camera(&along, &rotation);
    for (int i = 0; i < 2; i++)
        offset_wu[i] =
            ((forward_m * rotation.m[2][i] + right_m * rotation.m[0][i]) * FF_WU_PER_METRE) >> 30;
    offset_wu[2] = (int64_t)(part[2] ? request->high_m : request->low_m) * FF_WU_PER_METRE;
}

/* 1 when two eyes are the same. */
static int stood_before(const ff_get_far *request, unsigned eye, const int64_t offset_wu[3])
{
    for (unsigned i = 0; i < eye; i++) {
        int64_t other_wu[3];
        stand(request, stands[i], other_wu);
        if (memcmp(other_wu, offset_wu, sizeof other_wu) == 0) return 1;
    }
    return 0;
}

static uint16_t side_of(int32_t focal, int32_t twice_tangent_q8)
{
    int32_t side = focal * twice_tangent_q8 / 256;
    return (uint16_t)(side < 16 ? 16 : side);
}

/* A wide picture of few pixels is worth more than a narrow one of many. */
static int32_t eye_focal(int32_t focal)
{
    while (focal * EYE_WIDTH_Q8 / 256 > EYE_SIDE_MAX) focal /= 2;
    return focal;
}

size_t ff_far_eye_pixels(int32_t focal)
{
    focal = eye_focal(focal);
    return (size_t)side_of(focal, EYE_WIDTH_Q8) * side_of(focal, EYE_HEIGHT_Q8);
}

/* 0: the eye would be off the world. */
static int eye_look(const ff_far_search *search, const int64_t offset_wu[3], ff_ground_look *look)
{
    const ff_get_far *request = search->request;
    int32_t focal = eye_focal(request->focal);
    *look = (ff_ground_look){ .frame = *search->frame,
                              .view_wu = INT32_MAX,
                              .error_px_q8 = EYE_ERROR_PX * 256,
                              .bare = 1,
                              .camera = { .yaw = ff_far_yaw(search->sector),
                                          .focal_q8 = focal * 256,
                                          .width = side_of(focal, EYE_WIDTH_Q8),
                                          .height = side_of(focal, EYE_HEIGHT_Q8),
                                          .near_wu = EYE_NEAR_WU,
                                          .far_wu = search->far_wu } };
    for (int i = 0; i < 3; i++) {
        int64_t at_wu = request->position_wu[i] + offset_wu[i];
        if (at_wu > INT32_MAX || at_wu < INT32_MIN) return 0;
        look->camera.pos_wu[i] = (int32_t)at_wu;
    }
    return 1;
}

/* ---- pictures of distances ---- */

static int32_t greater(int32_t a, int32_t b) { return a > b ? a : b; }

/* Gives each pixel the greatest distance of itself and the eight round it. */
static void widen(int32_t *distance, uint32_t width, uint32_t height)
{
    for (uint32_t row = 0; row < height; row++) {
        int32_t *at = distance + (size_t)row * width, before = at[0];
        for (uint32_t x = 0; x < width; x++) {
            int32_t here = at[x], after = x + 1 < width ? at[x + 1] : here;
            at[x] = greater(here, greater(before, after));
            before = here;
        }
    }
    for (uint32_t x = 0; x < width; x++) {
        int32_t before = distance[x];
        for (uint32_t row = 0; row < height; row++) {
            int32_t *at = distance + (size_t)row * width + x, here = *at,
                    after = row + 1 < height ? at[width] : here;
            *at = greater(here, greater(before, after));
            before = here;
        }
    }
}

/* What an eye sees: its place in the sector's axes, its picture. */
typedef struct far_eye {
    int64_t offset_wu[3], forward, right;
    const c3d_camera *camera;
    const int32_t *distance;
} far_eye;

/* Ground falls away from the eye in its picture, as it does from O in O's. */
static int64_t up_for(const ff_far_axis *axis, const ff_far_place *place, const far_eye *eye)
{
    int64_t up = place->up - eye->offset_wu[2];
    if (!axis->info->curve_q60) return up;
    return up + ff_shape_drop_wu(axis->info, place->east, place->north) -
           ff_shape_drop_wu(axis->info, place->east - eye->offset_wu[0],
                            place->north - eye->offset_wu[1]);
}

static int eye_sees(const ff_far_axis *axis, const ff_far_place *place, const far_eye *eye)
{
    const c3d_camera *camera = eye->camera;
    int64_t f = place->forward - eye->forward, r = place->right - eye->right,
            u = up_for(axis, place, eye);
    if (f < camera->near_wu) return 1;
    int64_t x = camera->width * (int64_t)128 + r * camera->focal_q8 / f,
            y = camera->height * (int64_t)128 - u * camera->focal_q8 / f;
    if (x < 0 || y < 0 || x >> 8 >= camera->width || y >> 8 >= camera->height) return 1;
    int64_t drawn = eye->distance[(size_t)(y >> 8) * camera->width + (size_t)(x >> 8)];
    return f <= drawn + drawn / SLACK;
}

/* How many spots nobody has seen yet. */
static uint32_t mark(const ff_far_search *search, const far_eye *eye, ff_far_spots *spots)
{
    uint32_t unseen = 0;
    for (uint32_t i = 0; i < spots->count; i++) {
        ff_far_spot *spot = &spots->spot[i];
        ff_far_place place;
        if (spot->seen) continue;
        ff_far_place_of(search->picture, search->axis, spot->column, spot->row, &place);
        spot->seen = (uint8_t)eye_sees(search->axis, &place, eye);
        unseen += !spot->seen;
    }
    return unseen;
}

static int under_ground(const ff_far_stage *stage, const c3d_camera *camera)
{
    int32_t ground_wu;
    return ff_tree_drawn_height(stage->ground.tree, camera->pos_wu[0], camera->pos_wu[1],
                                &ground_wu) &&
           ground_wu >= camera->pos_wu[2];
}

/* 1: it has looked, and left so many spots unseen; 0: it is under ground; or a negative error. */
static int look_from(ff_far_stage *stage, ff_far_room *room, const ff_far_search *search,
                     const int64_t offset_wu[3], ff_far_spots *spots, uint32_t *unseen)
{
    ff_ground_look look;
    if (!eye_look(search, offset_wu, &look)) return 0;
    size_t pixels = (size_t)look.camera.width * look.camera.height;
    int rc = pixels > room->count ? FF_ERR_MEMORY : ff_far_stage_draw(stage, &look, room->value);
    if (rc < 0) return rc;
    if (under_ground(stage, &look.camera)) return 0;
    far_eye eye = { .camera = &look.camera, .distance = room->value };
    const ff_far_axis *axis = search->axis;
    memcpy(eye.offset_wu, offset_wu, sizeof eye.offset_wu);
    eye.forward = (offset_wu[0] * axis->forward_q30[0] + offset_wu[1] * axis->forward_q30[1]) >> 30;
    eye.right = (offset_wu[0] * axis->right_q30[0] + offset_wu[1] * axis->right_q30[1]) >> 30;
    widen(room->value, look.camera.width, look.camera.height);
    *unseen = mark(search, &eye, spots);
    return 1;
}

int ff_far_find_seen(ff_far_stage *stage, ff_far_room *room, const ff_far_search *search,
                     ff_far_spots *spots)
{
    int looked = 0;
    uint32_t unseen = spots->count;
    for (unsigned i = 0; i < EYES && unseen > 0; i++) {
        int64_t offset_wu[3];
        stand(search->request, stands[i], offset_wu);
        if (stood_before(search->request, i, offset_wu)) continue;
        int rc = look_from(stage, room, search, offset_wu, spots, &unseen);
        if (rc < 0) return rc;
        looked |= rc;
    }
    for (uint32_t i = 0; i < spots->count && !looked; i++) spots->spot[i].seen = 1;
    return FF_OK;
}
