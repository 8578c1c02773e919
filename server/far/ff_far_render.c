/* One sector: O's picture, what of it is seen, fins, paint, message. */
#include "ff_far_render.h"
#include "ff_far_outline.h"
#include "ff_far_paint.h"

#include <stdlib.h>
#include <string.h>

#define FINE_MAX        4        /* subs to a texel */
#define PIXELS_MAX      5000000u /* of O's picture, unless one sub to a texel has more */
#define SIDE_MAX        4095
#define ERROR_TEXEL_Q8  192 /* of the ground drawn */
#define QUALITY_STEP    10
#define FINS_BYTES_MAX  (16 * FF_FAR_VERTICES_MAX)
#define PAINT_BYTES_MAX (FF_MESSAGE_BODY_MAX - FINS_BYTES_MAX - 64)
#define FRONT_MIN_WU    8

struct ff_far_renderer {
    const ff_pack *pack;
    ff_far_render_stats stats;
    const ff_far_watch *watch; /* NULL: nobody */
    ff_far_stage stage;
    ff_far_room distance; /* of O's picture */
    ff_far_room eye;      /* of an eye's, and O's second */
    uint8_t *rgba;
    size_t rgba_bytes;
    ff_far_spots spots;
    ff_far_outlines outlines;
    ff_far_paint paint;
    ff_fin_vertex vertex[FF_FAR_VERTICES_MAX];
    uint8_t fins[FINS_BYTES_MAX], coded[PAINT_BYTES_MAX];
    ff_paint_room *room;
};

int ff_far_renderer_open(const ff_pack *pack, ff_far_renderer **renderer)
{
    ff_far_renderer *opened = calloc(1, sizeof *opened);
    *renderer = opened;
    if (!opened) return FF_ERR_MEMORY;
    opened->pack = pack;
    opened->stage.pack = pack;
    opened->room = malloc(ff_paint_room_bytes(FF_FAR_BLOCKS_MAX));
    if (opened->room) return FF_OK;
    ff_far_renderer_close(opened);
    *renderer = NULL;
    return FF_ERR_MEMORY;
}

void ff_far_renderer_close(ff_far_renderer *renderer)
{
    if (!renderer) return;
    ff_far_stage_close(&renderer->stage);
    ff_far_paint_free(&renderer->paint);
    free(renderer->distance.value);
    free(renderer->eye.value);
    free(renderer->rgba);
    free(renderer->room);
    free(renderer->spots.spot);
    free(renderer->outlines.outline);
    free(renderer);
}

void ff_far_renderer_get_stats(const ff_far_renderer *renderer, ff_far_render_stats *stats)
{
    *stats = renderer->stats;
    stats->ground = renderer->stage.stats;
}

void ff_far_renderer_watch(ff_far_renderer *renderer, const ff_far_watch *watch)
{
    renderer->watch = watch;
}

/* ---- O's picture ---- */

static int32_t near_of(const ff_get_far *request)
{
    return request->front_wu - request->front_wu / 8;
}

/* All ground lies within this of O and of the region round it, along any direction. */
static int32_t farthest_ground(const ff_terrain_info *info, const ff_frame *frame,
                               const ff_get_far *request)
{
    static const int64_t level_wu[2] = { 0, 0 };
    ff_box box = ff_shape_bounds(info, frame, level_wu, request->position_wu);
    int64_t sum = 0, region_m = (int64_t)request->ahead_m + request->behind_m + request->aside_m;
    for (int axis = 0; axis < 2; axis++) {
        int64_t low = box.lo[axis] < 0 ? -box.lo[axis] : box.lo[axis],
                high = box.hi[axis] < 0 ? -box.hi[axis] : box.hi[axis];
        sum += low > high ? low : high;
    }
    sum += region_m * FF_WU_PER_METRE + FF_WU_PER_METRE;
    return sum > INT32_MAX ? INT32_MAX : (int32_t)sum;
}

/* The same for all grounds of the pack, and those joined to it. */
static int32_t farthest(const ff_pack *pack, const ff_frame *frame, const ff_get_far *request)
{
    int32_t most = 0;
    for (; pack; pack = pack->next) {
        int32_t here = farthest_ground(&pack->header.info, frame, request);
        most = here > most ? here : most;
    }
    return most;
}

/* Rows above the horizon, in texels, that ground can reach: what is higher than one up to one is
 * left out, or a foot of O's own hill would cost a picture of the sky. */
static int32_t rows_up(const ff_pack *pack, const ff_get_far *request)
{
    int64_t highest_wu = INT64_MIN, up;
    for (; pack; pack = pack->next) {
        const ff_terrain_info *info = &pack->header.info;
        uint32_t top = (uint32_t)info->height_max + info->max_error;
        int64_t top_wu = ff_height_wu(info, top > UINT16_MAX ? UINT16_MAX : top);
        highest_wu = top_wu > highest_wu ? top_wu : highest_wu;
    }
    up = (highest_wu - request->position_wu[2]) * request->focal / near_of(request) + 2;
    return up < 2 ? 2 : up > request->focal ? request->focal : (int32_t)up;
}

/* How finely, and how large: as fine as the limits allow. */
static int size_picture(const ff_pack *pack, const ff_get_far *request, ff_far_picture *picture)
{
    int32_t half = ff_far_half(request->focal) + 1, up = rows_up(pack, request),
            rows = request->down > up ? request->down : up;
    memset(picture, 0, sizeof *picture);
    if (2 * rows > SIDE_MAX) rows = SIDE_MAX / 2;
    for (int32_t fine = FINE_MAX; fine >= 1; fine--) {
        int32_t width = 2 * half * fine + 1, height = 2 * rows * fine;
        picture->fine = (uint16_t)fine;
        picture->focal = request->focal * fine;
        picture->width = (uint16_t)width;
        picture->height = (uint16_t)height;
        if (width <= SIDE_MAX && height <= SIDE_MAX && (uint32_t)(width * height) <= PIXELS_MAX)
            break;
    }
    return picture->width <= SIDE_MAX && picture->height <= SIDE_MAX ? FF_OK : FF_ERR_RANGE;
}

static void look_at(const ff_far_search *search, int32_t near_wu, ff_ground_look *look)
{
    const ff_far_picture *picture = search->picture;
    *look = (ff_ground_look){ .frame = *search->frame,
                              .layer = search->request->layer,
                              .view_wu = INT32_MAX,
                              .hole_wu = near_of(search->request),
                              .error_px_q8 = ERROR_TEXEL_Q8 * picture->fine,
                              .camera = { .yaw = ff_far_yaw(search->sector),
                                          .focal_q8 = picture->focal * 256,
                                          .width = picture->width,
                                          .height = picture->height,
                                          .near_wu = near_wu,
                                          .far_wu = search->far_wu } };
    memcpy(look->camera.pos_wu, search->request->position_wu, sizeof look->camera.pos_wu);
}

static int make_room(ff_far_renderer *renderer, const ff_far_picture *picture)
{
    size_t pixels = (size_t)picture->width * picture->height,
           eye_pixels = ff_far_eye_pixels(picture->focal / picture->fine),
           most = pixels > eye_pixels ? pixels : eye_pixels;
    int rc = ff_far_room_fit(&renderer->distance, pixels);
    if (rc == FF_OK) rc = ff_far_room_fit(&renderer->eye, most);
    if (rc == FF_OK) rc = ff_far_stage_open(&renderer->stage, most);
    if (rc < 0 || pixels * 4 <= renderer->rgba_bytes) return rc;
    free(renderer->rgba);
    renderer->rgba = malloc(pixels * 4);
    renderer->rgba_bytes = renderer->rgba ? pixels * 4 : 0;
    return renderer->rgba ? FF_OK : FF_ERR_MEMORY;
}

/* 1 when a sub shows ground that is nearer than the hole's edge along x and along y. In sectors
 * between the axes the near plane leaves some of that. */
static int in_hole(const ff_far_search *search, int32_t column, int32_t row)
{
    ff_far_place place;
    int64_t near_wu = near_of(search->request);
    ff_far_place_of(search->picture, search->axis, column, row, &place);
    return place.east < near_wu && place.east > -near_wu && place.north < near_wu &&
           place.north > -near_wu;
}

/* Puts what a second picture, with the near plane beyond the hole's corner, shows in place of the
 * hole's ground. */
static int draw_behind_hole(ff_far_renderer *renderer, const ff_far_search *search)
{
    const ff_far_picture *picture = search->picture;
    ff_ground_look look;
    /* the edge's farthest place in the sector: its corner in the middle ones, else less */
    int32_t far_q8 = search->sector % 4 == 2 ? 362 : 320;
    look_at(search, (int32_t)((int64_t)near_of(search->request) * far_q8 / 256), &look);
    if (look.camera.near_wu >= look.camera.far_wu) look.camera.far_wu = look.camera.near_wu + 1;
    int rc = ff_far_stage_draw(&renderer->stage, &look, renderer->eye.value);
    if (rc < 0) return rc;
    const uint8_t *behind = ff_far_stage_pixels(&renderer->stage);
    for (int32_t row = 0; row < picture->height; row++)
        for (int32_t column = 0; column < picture->width; column++) {
            size_t at = (size_t)row * picture->width + (size_t)column;
            if (picture->distance[at] == FF_FAR_NOTHING || !in_hole(search, column, row)) continue;
            renderer->distance.value[at] = renderer->eye.value[at];
            memcpy(renderer->rgba + 4 * at, behind + 4 * at, 4);
        }
    return FF_OK;
}

static int draw_picture(ff_far_renderer *renderer, const ff_far_search *search)
{
    const ff_far_picture *picture = search->picture;
    ff_ground_look look;
    look_at(search, near_of(search->request), &look);
    int rc = ff_far_stage_draw(&renderer->stage, &look, renderer->distance.value);
    if (rc < 0) return rc;
    memcpy(renderer->rgba, ff_far_stage_pixels(&renderer->stage),
           (size_t)picture->width * picture->height * 4);
    return search->sector % 4 ? draw_behind_hole(renderer, search) : FF_OK;
}

/* ---- message ---- */

static void look_away(void *context, unsigned column, unsigned row, uint8_t rgb[64][3])
{
    (void)context, (void)column, (void)row, (void)rgb;
}

static ff_paint_source source_of(const ff_far_paint *paint)
{
    return (ff_paint_source){ .columns = paint->width / FF_FAR_BLOCK,
                              .rows = paint->height / FF_FAR_BLOCK,
                              .there = paint->there,
                              .rgb = paint->rgb };
}

/* At the wanted quality, or the best below it that fits. */
static int encode_paint(ff_far_renderer *renderer, int quality)
{
    static const ff_paint_sink nobody = { .block = look_away };
    const ff_paint_source source = source_of(&renderer->paint);
    for (;; quality -= QUALITY_STEP) {
        int bytes = ff_paint_encode(&source, quality < 1 ? 1 : (unsigned)quality, renderer->room,
                                    &nobody, renderer->coded, sizeof renderer->coded);
        if (bytes != FF_ERR_FULL || quality < 1) return bytes;
    }
}

static int put_paint(ff_far_renderer *renderer, const ff_get_far *request, ff_far *far)
{
    const ff_far_paint *paint = &renderer->paint;
    if (paint->blocks_there == 0) return FF_OK;
    int bytes = encode_paint(renderer, request->quality);
    if (bytes < 0) return bytes;
    far->blocks_x = (uint8_t)(paint->width / FF_FAR_BLOCK);
    far->blocks_y = (uint8_t)(paint->height / FF_FAR_BLOCK);
    far->top = (int16_t)paint->top;
    far->paint = renderer->coded;
    far->paint_bytes = (uint32_t)bytes;
    renderer->stats.blocks += paint->blocks_there;
    renderer->stats.paint_bytes += (uint32_t)bytes;
    return FF_OK;
}

static int put_fins(ff_far_renderer *renderer, const ff_far_picture *picture,
                    const ff_get_far *request, ff_far *far)
{
    int count = ff_far_fins_make(&renderer->outlines, picture, &renderer->spots,
                                 request->tolerance_q2, renderer->vertex);
    if (count >= 0 && renderer->watch) {
        const ff_paint_source source = source_of(&renderer->paint);
        renderer->watch->sector(renderer->watch->context,
                                renderer->paint.blocks_there ? &source : NULL,
                                renderer->paint.needed, renderer->vertex, (uint32_t)count);
    }
    if (count <= 0) return count;
    int bytes = ff_fins_encode(renderer->vertex, (uint32_t)count, renderer->fins,
                               sizeof renderer->fins);
    if (bytes < 0) return bytes;
    far->fins = renderer->fins;
    far->fins_bytes = (uint32_t)bytes;
    renderer->stats.vertices += (uint32_t)count;
    renderer->stats.fins_bytes += (uint32_t)bytes;
    for (int i = 0; i < count; i++) renderer->stats.fins += renderer->vertex[i].begins;
    return FF_OK;
}

static int make_sector(ff_far_renderer *renderer, const ff_far_search *search, ff_far *far)
{
    const ff_get_far *request = search->request;
    const ff_far_picture *picture = search->picture;
    int32_t near_wu = near_of(request);
    renderer->spots.count = 0;
    int rc = draw_picture(renderer, search);
    if (rc == FF_OK)
        rc = ff_far_outlines_find(&renderer->outlines, picture, request, near_wu + near_wu / 64,
                                  &renderer->spots);
    if (rc == FF_OK) rc = ff_far_paint_take(&renderer->paint, picture, request, &renderer->spots);
    if (rc == FF_OK)
        rc = ff_far_find_seen(&renderer->stage, &renderer->eye, search, &renderer->spots);
    if (rc == FF_OK) rc = ff_far_paint_keep(&renderer->paint, &renderer->spots);
    if (rc == FF_OK) rc = put_fins(renderer, picture, request, far);
    if (rc == FF_OK) rc = put_paint(renderer, request, far);
    renderer->stats.texels += renderer->paint.ground;
    renderer->stats.texels_seen += renderer->paint.seen;
    if (far->fins_bytes || far->blocks_x) far->flags &= (uint8_t)~FF_FACE_EMPTY;
    return rc;
}

/* O comes in world axes; from here on it is a point of the frame at O. */
static int render_sector(ff_far_renderer *renderer, const ff_get_far *asked, ff_far *far)
{
    const ff_terrain_info *info = &renderer->pack->header.info;
    ff_frame frame = ff_shape_frame(info, asked->position_wu);
    ff_get_far request = *asked;
    ff_far_picture picture;
    ff_far_axis axis = { .info = info };
    ff_shape_enter(info, &frame, asked->position_wu, request.position_wu);
    ff_far_axes(far->sector, axis.forward_q30, axis.right_q30);
    int32_t far_wu = farthest(renderer->pack, &frame, &request);
    if (far_wu <= near_of(&request)) return FF_OK; /* all ground is near */
    int rc = size_picture(renderer->pack, &request, &picture);
    if (rc == FF_OK) rc = make_room(renderer, &picture);
    if (rc < 0) return rc;
    picture.rgba = renderer->rgba;
    picture.distance = renderer->distance.value;
    ff_far_search search = { .request = &request,
                             .frame = &frame,
                             .axis = &axis,
                             .picture = &picture,
                             .sector = far->sector,
                             .far_wu = far_wu };
    rc = make_sector(renderer, &search, far);
    ff_far_paint_free(&renderer->paint);
    return rc;
}

int ff_far_render_sector(ff_far_renderer *renderer, const ff_get_far *request, uint8_t sector,
                         int last, uint8_t *out, size_t capacity)
{
    if (sector >= FF_FAR_SECTORS || request->focal < FF_FAR_FOCAL_MIN ||
        request->focal > FF_FAR_FOCAL_MAX || request->front_wu < FRONT_MIN_WU ||
        request->down < 1 || request->low_m > request->high_m)
        return FF_ERR_RANGE;
    ff_message message = { .type = FF_MSG_ANSWER, .kind = FF_KIND_FAR };
    message.u.far = (ff_far){ .sector = sector,
                              .flags = (uint8_t)(FF_FACE_EMPTY | (last ? FF_FACE_LAST : 0)) };
    int64_t start_us = sys_time_us();
    int rc = render_sector(renderer, request, &message.u.far);
    if (rc == FF_OK) rc = ff_message_encode(&message, out, capacity);
    renderer->stats.sectors++;
    renderer->stats.sectors_empty += (message.u.far.flags & FF_FACE_EMPTY) != 0;
    renderer->stats.time_us += sys_time_us() - start_us;
    if (rc > 0) renderer->stats.bytes += (uint64_t)rc;
    return rc;
}
