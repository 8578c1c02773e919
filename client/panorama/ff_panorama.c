#include "ff_panorama.h"

#include <string.h>

#define ALL_FACES         ((1u << FF_FACE_COUNT) - 1)
#define RETRY_US          2000000  /* the server was busy */
#define RETRY_LATER_US    30000000 /* after REFUSALS_IN_A_ROW refusals */
#define REFUSALS_IN_A_ROW 3
#define TURNS_US          60000000 /* for this long after a turn all faces are wanted */
#define TURN              8192     /* an eighth of a circle */
#define TURN_WITHIN_US    10000000
#define LEAD_US_MAX       10000000
#define PRIORITY_FACE     0x10000u /* among the first: before refinements, beside roots */

FF_STATIC_ASSERT(RETRY_US < RETRY_LATER_US && REFUSALS_IN_A_ROW <= UINT8_MAX);
FF_STATIC_ASSERT(2 * TURN < 65536 && TURN_WITHIN_US < TURNS_US);

const uint8_t ff_panorama_built = 1;

void ff_panorama_init(ff_panorama *panorama, c3d_device *device, const ff_panorama_desc *desc,
                      const ff_terrain_info *info, unsigned face_size)
{
    uint32_t serial = panorama->serial;
    FF_ASSERT(face_size <= FF_FACE_SIZE_MAX && (face_size & (face_size - 1)) == 0);
    memset(panorama, 0, sizeof *panorama);
    panorama->serial = serial;
    panorama->device = device;
    panorama->desc = *desc;
    panorama->face_size = (uint16_t)face_size;
    panorama->info = info;
    panorama->active = panorama->next = panorama->shown = -1;
    panorama->retry_us = INT64_MIN;
    static const uint16_t quad[4] = { 0, 1, 2, 3 };
    if (device && face_size) panorama->quad = c3d_strip_make(device, quad, 4);
}

static void drop_set(ff_panorama *panorama, int index)
{
    ff_panorama_set *set = &panorama->set[index];
    FF_ASSERT(index == 0 || index == 1);
    for (unsigned face = 0; face < FF_FACE_COUNT; face++) {
        if (set->texture[face].id) c3d_texture_free(panorama->device, set->texture[face]);
        if (set->mesh[face].id) c3d_mesh_free(panorama->device, set->mesh[face]);
    }
    memset(set, 0, sizeof *set);
}

void ff_panorama_drop(ff_panorama *panorama)
{
    drop_set(panorama, 0);
    drop_set(panorama, 1);
    panorama->active = panorama->next = panorama->shown = -1;
}

static unsigned known(const ff_panorama_set *set)
{
    FF_ASSERT(!(set->held & set->empty) && !((set->held | set->empty) & set->failed));
    return (unsigned)set->held | set->empty | set->failed;
}

static void begin_set(ff_panorama *panorama, const c3d_camera *camera, const ff_motion *motion,
                      int64_t now_us)
{
    int index = panorama->active == 0 ? 1 : 0;
    ff_panorama_set *set = &panorama->set[index];
    FF_ASSERT(panorama->next < 0 || panorama->next == index); /* a set that is shown stays */
    drop_set(panorama, index);
    set->front_wu = panorama->desc.back_plane_wu;
    ff_panorama_plan(panorama, camera, motion, set);
    set->key = ++panorama->serial;
    FF_ASSERT(set->key != panorama->set[1 - index].key);
    set->asked_us = now_us;
    panorama->next = (int8_t)index;
}

static void measure_lead(ff_panorama *panorama, ff_panorama_set *set, int64_t now_us)
{
    int64_t took_us = now_us - set->asked_us < LEAD_US_MAX ? now_us - set->asked_us : LEAD_US_MAX;
    set->ready = 1;
    panorama->lead_us = panorama->lead_us ? (panorama->lead_us + took_us) / 2 : took_us;
    FF_ASSERT(panorama->lead_us <= LEAD_US_MAX);
}

/* Lets the set that is coming take over once all its faces in view are here, but not while the
 * drawn set is still good and the new one is not good yet. */
static int take_over(ff_panorama *panorama, const c3d_camera *camera, int64_t now_us)
{
    if (panorama->next < 0) return 0;
    FF_ASSERT(panorama->next < 2 && panorama->next != panorama->active);
    ff_panorama_set *next = &panorama->set[panorama->next];
    if ((ff_panorama_faces_in_view(camera) & ~known(next)) != 0) return 0;
    if (!next->ready) measure_lead(panorama, next, now_us);
    if (panorama->active >= 0 && ff_panorama_set_outdated(panorama, next, camera) &&
        !ff_panorama_set_outdated(panorama, &panorama->set[panorama->active], camera))
        return 0;
    for (unsigned face = 0; face < FF_FACE_COUNT; face++) /* a face not here shows no ground */
        if (!(next->held >> face & 1u))
            ff_panorama_sight_face(&next->sight, face, 1, 0, 0, next->front_wu);
    if (panorama->active >= 0) drop_set(panorama, panorama->active);
    panorama->active = panorama->next;
    panorama->next = -1;
    return 1;
}

static void look_for_turns(ff_panorama *panorama, const c3d_camera *camera, int64_t now_us)
{
    uint32_t turned = (uint32_t)(camera->yaw - panorama->yaw + TURN) & 65535u;
    if (turned > 2 * TURN && panorama->active >= 0) /* the first direction of all is no turn */
        panorama->turns_until_us = now_us + TURNS_US;
    if (turned > 2 * TURN || now_us - panorama->yaw_us > TURN_WITHIN_US) {
        panorama->yaw = camera->yaw;
        panorama->yaw_us = now_us;
    }
}

static int left_behind(const ff_panorama *panorama, const c3d_camera *camera, int index)
{
    FF_ASSERT(index < 2 && (index < 0 || panorama->set[index].front_wu > 0));
    return index >= 0 && ff_panorama_left_behind(camera->pos_wu, panorama->set[index].position_wu,
                                                 panorama->set[index].front_wu);
}

static int refresh(ff_panorama *panorama, ff_requests *requests, const c3d_camera *camera,
                   const ff_motion *motion, int hold, int64_t now_us)
{
    int changed = take_over(panorama, camera, now_us);
    look_for_turns(panorama, camera, now_us);
    if (hold || now_us < panorama->retry_us) return changed;
    if (panorama->retry_us != INT64_MIN) { /* the wait is over: want again */
        panorama->retry_us = INT64_MIN;
        changed = 1;
    }
    if (panorama->next >= 0
            ? !ff_panorama_set_outdated(panorama, &panorama->set[panorama->next], camera)
            : !ff_panorama_outdated_soon(panorama, camera, motion))
        return changed;
    if (left_behind(panorama, camera, panorama->next) &&
        !ff_requests_cancel(requests, FF_KIND_FACE, panorama->set[panorama->next].key)) {
        /* it was not yet asked for, or its cancellation was answered */
        drop_set(panorama, panorama->next);
        panorama->next = -1;
    }
    /* one set outstanding at most */
    if (panorama->next >= 0 && !panorama->desc.hold_back) return changed;
    int newest = panorama->next >= 0 ? panorama->next : panorama->active;
    if (newest >= 0 && ff_requests_cancel(requests, FF_KIND_FACE, panorama->set[newest].key) &&
        !panorama->desc.hold_back)
        /* the old set's last faces are still on their way: wait for the answer to the
         * cancellation */
        return changed;
    ff_request_counts counts;
    ff_requests_get_counts(requests, &counts, NULL);
    if (counts.of[FF_KIND_FACE].in_flight && !panorama->desc.hold_back)
        return changed; /* a set was dropped with panoramas off, but its request is still out */
    begin_set(panorama, camera, motion, now_us);
    FF_ASSERT(panorama->next >= 0 && panorama->next != panorama->active);
    return 1;
}

int ff_panorama_update(ff_panorama *panorama, ff_requests *requests, const c3d_camera *camera,
                       const ff_motion *motion, int hold, int64_t now_us)
{
    if (!panorama->desc.enabled || !panorama->face_size) return 0;
    int changed = refresh(panorama, requests, camera, motion, hold, now_us);
    int8_t shown = left_behind(panorama, camera, panorama->active) ? -1 : panorama->active;
    changed |= shown != panorama->shown;
    panorama->shown = shown;
    return changed;
}

int ff_panorama_whole(const ff_panorama *panorama, const c3d_camera *camera)
{
    FF_ASSERT(panorama->shown < 2);
    return panorama->shown >= 0 &&
           !(ff_panorama_faces_in_view(camera) & ~known(&panorama->set[panorama->shown]));
}

int ff_panorama_late(const ff_panorama *panorama, const c3d_camera *camera)
{
    FF_ASSERT(panorama->active < 2);
    const ff_panorama_set *set = &panorama->set[panorama->active >= 0 ? panorama->active : 0];
    return panorama->next >= 0 && panorama->active >= 0 &&
           set->front_wu == panorama->desc.back_plane_wu &&
           ff_panorama_set_outdated(panorama, set, camera);
}

/* Lists the missing faces, the one in the middle of the view first: it is found by narrowing the
 * view to its middle. */
static void list_faces(ff_get_panorama *request, unsigned missing, const c3d_camera *camera)
{
    c3d_camera narrow = *camera;
    narrow.width = narrow.height = 1;
    narrow.focal_q8 = 1 << 20;
    FF_ASSERT(missing > 0 && missing <= ALL_FACES);
    unsigned middle = ff_panorama_faces_in_view(&narrow) & missing;
    for (int pass = 0; pass < 2; pass++)
        for (unsigned face = 0; face < FF_FACE_COUNT; face++)
            if ((pass ? missing & ~middle : middle) >> face & 1u)
                request->face[request->face_count++] = (uint8_t)face;
}

static void want_faces(const ff_panorama *panorama, ff_requests *requests, const ff_view *view,
                       const ff_panorama_set *set, unsigned missing, enum ff_request_class rank)
{
    ff_ask ask;
    ff_get_panorama request = { .front_wu = set->front_wu,
                                .back_wu = panorama->desc.server_back_wu > set->front_wu
                                               ? panorama->desc.server_back_wu
                                               : INT32_MAX,
                                .face_size = panorama->face_size,
                                .quality = panorama->desc.quality };
    ff_shape_leave(panorama->info, &view->frame, set->position_wu, request.position_wu);
    list_faces(&request, missing, &view->camera);
    FF_ASSERT(request.face_count > 0 && request.face_count <= FF_FACE_COUNT);
    ask.panorama = request;
    ff_requests_want(requests, FF_KIND_FACE, set->key, rank,
                     rank == FF_CLASS_FIRST ? PRIORITY_FACE : 1, 0, &ask);
}

void ff_panorama_want(const ff_panorama *panorama, ff_requests *requests, const ff_view *view,
                      unsigned soon, int64_t now_us)
{
    int newest = panorama->next >= 0 ? panorama->next : panorama->active;
    if (!panorama->desc.enabled || newest < 0 || now_us < panorama->retry_us) return;
    const ff_panorama_set *set = &panorama->set[newest];
    unsigned in_view = ff_panorama_faces_in_view(&view->camera) & ~known(set), missing = in_view;
    if (!in_view && panorama->next < 0)
        missing = (now_us < panorama->turns_until_us ? ALL_FACES : soon) & ~known(set);
    if (missing)
        want_faces(panorama, requests, view, set, missing,
                   in_view ? FF_CLASS_FIRST : FF_CLASS_PREFETCH);
}

void ff_panorama_want_reserve(const ff_panorama *panorama, ff_requests *requests,
                              const ff_view *view, int64_t now_us)
{
    if (!panorama->desc.enabled || panorama->next >= 0 || panorama->active < 0 ||
        now_us < panorama->retry_us)
        return;
    const ff_panorama_set *set = &panorama->set[panorama->active];
    unsigned missing = ALL_FACES & ~known(set);
    if (missing)
        want_faces(panorama, requests, view, set, missing & (0 - missing), FF_CLASS_RESERVE);
}

/* ---- faces ---- */

/* Corners of a face's quad and where its image lies, in units of half a texel: the cube reaches
 * from -size to size. Side faces: columns run along x or y, rows along z. UP and DOWN: columns
 * along x, rows along y. */
static void make_quad(unsigned face, int size, int top_row, int rows, c3d_vertex quad[4])
{
    int high = size - 2 * top_row, low = high - 2 * rows;
    if (face == FF_FACE_UP) { /* its image's top edge looks south */
        int swap = high;
        high = -low;
        low = -swap;
    }
    FF_ASSERT(-size <= low && low < high && high <= size);
    for (int corner = 0; corner < 4; corner++) {
        int across = corner & 1 ? size : -size, along = corner & 2 ? high : low;
        c3d_vertex *vertex = &quad[corner];
        memset(vertex, 0, sizeof *vertex);
        memset(vertex->rgba, 255, sizeof vertex->rgba);
        int forward = face == FF_FACE_NORTH || face == FF_FACE_EAST || face == FF_FACE_UP ? size
                                                                                          : -size;
        int x = face == FF_FACE_EAST || face == FF_FACE_WEST ? forward : across;
        int y = face == FF_FACE_NORTH || face == FF_FACE_SOUTH ? forward
                : face == FF_FACE_EAST || face == FF_FACE_WEST ? across
                                                               : along;
        vertex->x = x;
        vertex->y = y;
        vertex->z = face == FF_FACE_UP || face == FF_FACE_DOWN ? forward : along;
    }
}

static void take_image(ff_panorama *panorama, ff_panorama_set *set, const ff_new_item *item)
{
    unsigned face = item->u.face.face, top_row = item->u.face.top_row,
             row_count = item->u.face.row_count;
    FF_ASSERT(top_row + row_count <= item->width && row_count <= item->height);
    FF_ASSERT(!(known(set) >> face & 1u));
    set->held |= (uint8_t)(1u << face);
    ff_panorama_sight_face(&set->sight, face, item->width, top_row, row_count, set->front_wu);
    panorama->faces++;
    if (!panorama->device) return;
    c3d_vertex quad[4];
    make_quad(face, item->width, top_row, row_count, quad);
    set->height[face] = item->height;
    set->rows[face] = row_count;
    set->texture[face] = c3d_texture_make(panorama->device, C3D_RGBA5551, item->width, item->height,
                                          item->pixels);
    set->mesh[face] = c3d_mesh_make(panorama->device, quad, 4);
}

static void take_refusal(ff_panorama *panorama, int64_t now_us)
{
    FF_ASSERT(panorama->refusals <= REFUSALS_IN_A_ROW);
    if (panorama->refusals < REFUSALS_IN_A_ROW) panorama->refusals++;
    panorama->retry_us = now_us +
                         (panorama->refusals < REFUSALS_IN_A_ROW ? RETRY_US : RETRY_LATER_US);
}

int ff_panorama_take(ff_panorama *panorama, const ff_new_item *item, int64_t now_us)
{
    FF_ASSERT(item->u.face.face < FF_FACE_COUNT);
    for (int i = 0; i < 2; i++) {
        ff_panorama_set *set = &panorama->set[i];
        unsigned bit = 1u << item->u.face.face;
        if (set->key != item->key || !set->key) continue;
        if (item->refused) {
            if (item->error != FF_ERR_CLOSED) take_refusal(panorama, now_us);
            return 1;
        }
        if (known(set) & bit) return 0;
        panorama->refusals = 0;
        if (item->error != FF_OK)
            set->failed |= (uint8_t)bit;
        else if (item->u.face.empty) {
            set->empty |= (uint8_t)bit;
            ff_panorama_sight_face(&set->sight, item->u.face.face, 1, 0, 0, set->front_wu);
            panorama->faces_empty++;
        } else {
            take_image(panorama, set, item);
        }
        return 1;
    }
    return 0;
}

static void draw_face(const ff_panorama *panorama, const ff_panorama_set *set, unsigned face,
                      int32_t scale_wu)
{
    FF_ASSERT(set->rows[face] > 0 && set->rows[face] <= set->height[face]);
    int32_t across = 65536, along = set->rows[face] * (65536 / set->height[face]);
    int s_backward = face == FF_FACE_SOUTH || face == FF_FACE_EAST, t_backward = face == FF_FACE_UP;
    c3d_draw draw = { .mesh = set->mesh[face],
                      .strip = panorama->quad,
                      .xy_scale_wu = scale_wu,
                      .z_scale_q16 = (uint32_t)scale_wu << 16,
                      .texture = set->texture[face],
                      .colour = 0xFFFFFFFFu,
                      .flags = C3D_DRAW_TEXTURED | C3D_DRAW_BACKDROP | C3D_DRAW_ALPHA_TEST,
                      .tex_columns = 2 };
    draw.tex_scale_q16[0] = s_backward ? -across : across;
    draw.tex_offset_q16[0] = s_backward ? across : 0;
    draw.tex_scale_q16[1] = t_backward ? -along : along;
    draw.tex_offset_q16[1] = t_backward ? along : 0;
    c3d_draw_strip(panorama->device, &draw);
}

void ff_panorama_draw(const ff_panorama *panorama, int32_t near_wu)
{
    if (panorama->shown < 0 || !panorama->desc.enabled) return;
    const ff_panorama_set *set = &panorama->set[panorama->shown];
    /* the cube's faces lie two near planes away */
    FF_ASSERT(panorama->face_size > 0 && near_wu > 0);
    int32_t scale_wu = 2 * (near_wu / panorama->face_size + 1);
    for (unsigned face = 0; face < FF_FACE_COUNT; face++)
        if (set->texture[face].id && set->mesh[face].id) draw_face(panorama, set, face, scale_wu);
}
