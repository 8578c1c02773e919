#include "ff_sets.h"

#include <string.h>

#define SECTOR            (65536u / FF_FAR_SECTORS)
#define TILTED            4096     /* 22.5 degrees */
#define RETRY_US          2000000  /* the server was busy */
#define RETRY_LATER_US    30000000 /* after REFUSALS_IN_A_ROW refusals */
#define REFUSALS_IN_A_ROW 3
#define LEAD_US_MAX       20000000
#define PRIORITY_SECTOR   0x8000u /* among the first: behind roots */
#define LEFT_BEHIND       3       /* so many times its region's length away a set is dropped */

const uint8_t ff_sets_built = 1;

void ff_sets_init(ff_sets *sets, c3d_device *device, const ff_far_desc *desc,
                  const ff_terrain_info *info, unsigned side)
{
    *sets =
        (ff_sets){ .device = device,
                   .desc = *desc,
                   .info = info,
                   .side = (uint16_t)side,
                   .active = -1,
                   .next = -1,
                   .under = -1,
                   .front_wu = desc->front_wu,
                   .choice = { .use = desc->enabled == FF_FAR_AUTO ? FF_FAR_OFF : desc->enabled },
                   .retry_us = INT64_MIN };
}

void ff_sets_scratch(ff_sets *sets, c3d_vertex *scratch, uint16_t *indices, unsigned vertices)
{
    sets->scratch = scratch;
    sets->indices = indices;
    sets->vertices = (uint16_t)vertices;
}

unsigned ff_sets_side(int32_t focal_q8)
{
    int32_t focal = focal_q8 / 256;
    unsigned side = 64;
    if (focal > FF_FAR_FOCAL_MAX) focal = FF_FAR_FOCAL_MAX;
    if (focal < FF_FAR_FOCAL_MIN) focal = FF_FAR_FOCAL_MIN;
    while (side < (unsigned)ff_far_blocks_x(focal) * FF_FAR_BLOCK + 2) side *= 2;
    return side;
}

static void drop_sector(ff_sets *sets, ff_set_sector *sector)
{
    for (unsigned i = 0; i < sector->chunks; i++) {
        c3d_mesh_free(sets->device, sector->mesh[i]);
        c3d_strip_free(sets->device, sector->strip[i]);
    }
    if (sector->paint.id) c3d_texture_free(sets->device, sector->paint);
    memset(sector, 0, sizeof *sector);
}

static void drop_set(ff_sets *sets, int index)
{
    FF_ASSERT(index == 0 || index == 1);
    ff_set *set = &sets->set[index];
    for (unsigned s = 0; s < FF_FAR_SECTORS; s++) drop_sector(sets, &set->sector[s]);
    memset(set, 0, sizeof *set);
}

/* ---- from set to set ---- */

static void end_fade(ff_sets *sets)
{
    if (sets->under >= 0) drop_set(sets, sets->under);
    sets->under = -1;
    sets->through = 0;
}

/* The drawn set, if there is one, stays below the coming one, which is drawn from now on. */
static void begin_fade(ff_sets *sets, int64_t now_us)
{
    FF_ASSERT(sets->next >= 0 && sets->under < 0);
    sets->under = sets->active;
    sets->active = sets->next;
    sets->next = -1;
    sets->through = UINT8_MAX;
    sets->fade_us = now_us;
}

/* 1 while sets fade, and when that ends. */
static int step_fade(ff_sets *sets, int64_t now_us)
{
    int64_t past_us = now_us - sets->fade_us;
    if (!sets->through) return 0;
    if (past_us >= 0 && past_us < FF_SETS_FADE_US)
        sets->through = (uint8_t)(UINT8_MAX - past_us * (UINT8_MAX - 1) / FF_SETS_FADE_US);
    else
        end_fade(sets);
    return 1;
}

static unsigned known(const ff_set *set)
{
    FF_ASSERT(!(set->held & set->empty) && !((set->held | set->empty) & set->failed));
    return (unsigned)set->held | set->empty | set->failed;
}

/* Whether the picture may show the horizon's direction east, north. A picture that lies on its
 * side, or looks far up or down, shows more of the horizon than its width: there its diagonal
 * counts. */
static int shows(const c3d_camera *camera, const c3d_rotation *rotation, int32_t east,
                 int32_t north)
{
    int64_t eye[3], focal = camera->focal_q8 / 256;
    int tilted = camera->roll != 0 || camera->pitch > TILTED || camera->pitch < -TILTED;
    for (int row = 0; row < 3; row++)
        eye[row] = ((int64_t)rotation->m[row][0] * east + (int64_t)rotation->m[row][1] * north) >>
                   30;
    if (eye[2] <= 0) return 0;
    if (!tilted) return (eye[0] < 0 ? -eye[0] : eye[0]) * focal <= eye[2] * (camera->width / 2);
    int64_t half = c3d_length64(camera->width / 2, camera->height / 2, 0);
    return eye[2] * c3d_length64(half, focal, 0) > focal << 30;
}

unsigned ff_sets_in_view(const c3d_camera *camera)
{
    c3d_rotation rotation;
    unsigned seen = 0;
    c3d_rotation_from_camera(camera, &rotation);
    for (unsigned s = 0; s < FF_FAR_SECTORS; s++)
        for (int step = -4; step <= 4 && !(seen >> s & 1u); step++) {
            int32_t azimuth = (int32_t)(s * SECTOR) + step * (int32_t)(SECTOR / 8);
            if (shows(camera, &rotation, c3d_sin_q30(azimuth), c3d_cos_q30(azimuth)))
                seen |= 1u << s;
        }
    return seen;
}

int ff_sets_in_use(const ff_sets *sets, const c3d_camera *camera, int32_t *fine_wu, uint8_t *coarse)
{
    if (!sets->choice.use || !sets->side || sets->off) return 0;
    if (sets->active < 0 && sets->refusals >= REFUSALS_IN_A_ROW)
        return 0; /* nothing will mend it */
    if (sets->active < 0 && sets->desc.enabled == FF_FAR_AUTO)
        return 0; /* fine ground is here already */
    int64_t away_wu = 0;
    const ff_set *set = sets->active >= 0 ? &sets->set[sets->active] : NULL;
    for (int axis = 0; set && axis < 2; axis++) {
        int64_t off_wu = (int64_t)set->position_wu[axis] - camera->pos_wu[axis];
        off_wu = off_wu < 0 ? -off_wu : off_wu;
        away_wu = off_wu > away_wu ? off_wu : away_wu;
    }
    int64_t step_wu = 512 * FF_WU_PER_METRE;
    away_wu = (away_wu + step_wu - 1) / step_wu * step_wu;
    int64_t wu = (set ? set->front_wu : sets->front_wu) + away_wu;
    *fine_wu = wu > INT32_MAX ? INT32_MAX : (int32_t)wu;
    *coarse = sets->desc.coarse;
    return 1;
}

static void begin_set(ff_sets *sets, const c3d_camera *camera, const ff_motion *motion,
                      int32_t clearance_wu, int64_t now_us)
{
    int index = sets->active == 0 ? 1 : 0;
    ff_set *set = &sets->set[index];
    drop_set(sets, index);
    int32_t focal = camera->focal_q8 / 256;
    set->focal = (uint16_t)(focal > FF_FAR_FOCAL_MAX   ? FF_FAR_FOCAL_MAX
                            : focal < FF_FAR_FOCAL_MIN ? FF_FAR_FOCAL_MIN
                                                       : focal);
    set->paint_shift = sets->desc.paint_shift > sets->choice.shift ? sets->desc.paint_shift
                                                                   : sets->choice.shift;
    while (ff_sets_side((int32_t)(set->focal >> set->paint_shift) * 256) > sets->side)
        set->paint_shift++;
    set->painted = sets->choice.use != FF_FAR_FINS;
    ff_sets_plan(sets, camera, motion, clearance_wu, set);
    set->key = ++sets->serial;
    set->asked_us = now_us;
    sets->next = (int8_t)index;
}

/* The set that is coming takes over once all of its sectors in view are here. */
static int take_over(ff_sets *sets, const c3d_camera *camera, int64_t now_us)
{
    if (sets->next < 0) return 0;
    FF_ASSERT(sets->next < 2 && sets->next != sets->active);
    ff_set *next = &sets->set[sets->next];
    if (sets->seen & ~known(next)) return 0;
    if (!next->ready) {
        int64_t took_us = now_us - next->asked_us < LEAD_US_MAX ? now_us - next->asked_us
                                                                : LEAD_US_MAX;
        next->ready = 1;
        sets->lead_us = sets->lead_us ? (sets->lead_us + took_us) / 2 : took_us;
    }
    if (sets->active >= 0) {
        const ff_set *drawn = &sets->set[sets->active];
        if (ff_sets_good(drawn, camera->pos_wu) && !ff_sets_good(next, camera->pos_wu)) return 0;
    }
    begin_fade(sets, now_us);
    return 1;
}

/* Far behind it a set shows more that is wrong than it mends. */
static int leave_behind(ff_sets *sets, const c3d_camera *camera)
{
    if (sets->active < 0) return 0;
    const ff_set *set = &sets->set[sets->active];
    int64_t reach_wu = set->region.ahead_wu + set->region.behind_wu;
    for (int axis = 0; axis < 3; axis++) {
        int64_t away_wu = (int64_t)camera->pos_wu[axis] - set->position_wu[axis];
        if (away_wu <= LEFT_BEHIND * reach_wu && away_wu >= -LEFT_BEHIND * reach_wu) continue;
        end_fade(sets);
        drop_set(sets, sets->active);
        sets->active = -1;
        return 1;
    }
    return 0;
}

/* Whether the newest set will be of use when another one could be here. */
static int good_soon(const ff_sets *sets, const c3d_camera *camera, const ff_motion *motion)
{
    int newest = sets->next >= 0 ? sets->next : sets->active;
    int32_t then_wu[3];
    if (newest < 0) return 0;
    memcpy(then_wu, camera->pos_wu, sizeof then_wu);
    if (sets->next < 0) (void)ff_motion_level(motion, sets->lead_us, then_wu);
    return ff_sets_good(&sets->set[newest], then_wu);
}

void ff_sets_leave(ff_sets *sets, ff_requests *requests)
{
    ff_requests_cancel_all(requests, FF_KIND_FAR);
    end_fade(sets);
    for (int i = 0; i < 2; i++) drop_set(sets, i);
    sets->active = sets->next = -1;
}

int ff_sets_update(ff_sets *sets, ff_requests *requests, const c3d_camera *camera,
                   const ff_motion *motion, int32_t clearance_wu, int hold, int64_t now_us)
{
    if (!sets->side) return 0;
    sets->front_wu = ff_sets_front_wu(sets, clearance_wu);
    sets->seen = (uint16_t)ff_sets_in_view(camera);
    int changed = step_fade(sets, now_us);
    changed |= take_over(sets, camera, now_us);
    changed |= leave_behind(sets, camera);
    if (sets->through) return changed; /* the next one has no room yet */
    if (hold || sets->off || !sets->choice.use || now_us < sets->retry_us) return changed;
    if (sets->retry_us != INT64_MIN) { /* the wait is over: want again */
        sets->retry_us = INT64_MIN;
        changed = 1;
    }
    if (good_soon(sets, camera, motion)) return changed;
    /* one set outstanding at most: one that comes too late gives way when it is cancelled */
    if (sets->next >= 0) {
        if (ff_requests_cancel(requests, FF_KIND_FAR, sets->set[sets->next].key)) return changed;
        drop_set(sets, sets->next);
        sets->next = -1;
    }
    ff_request_counts counts;
    ff_requests_get_counts(requests, &counts, NULL);
    if (counts.of[FF_KIND_FAR].in_flight) return changed;
    begin_set(sets, camera, motion, clearance_wu, now_us);
    return 1;
}

/* ---- asking ---- */

static uint16_t metres(int32_t wu)
{
    int32_t m = wu / FF_WU_PER_METRE;
    return (uint16_t)(m < 0 ? 0 : m > UINT16_MAX ? UINT16_MAX : m);
}

/* Sectors in the order of how far they lie from the middle of the view. */
static void list_sectors(ff_get_far *request, unsigned missing, const c3d_camera *camera)
{
    unsigned middle = (((uint32_t)camera->yaw + SECTOR / 2) & 65535u) / SECTOR;
    int right_first = ((uint32_t)camera->yaw + SECTOR / 2) % SECTOR >= SECTOR / 2;
    for (unsigned step = 0; step < 2 * FF_FAR_SECTORS; step++) {
        unsigned way = (step + 1) / 2,
                 s = (((step & 1u) == (unsigned)right_first) ? middle + way
                                                             : middle + FF_FAR_SECTORS - way) %
                     FF_FAR_SECTORS;
        if (missing >> s & 1u) request->sector[request->sector_count++] = (uint8_t)s;
        missing &= ~(1u << s);
    }
}

/* Texels below O's horizon that the picture can show: where its lowest ray meets the front, as seen
 * from O, which stands above the viewer. */
static uint16_t down_of(const ff_set *set, const c3d_camera *camera)
{
    c3d_rotation rotation;
    c3d_camera level = { .pitch = camera->pitch };
    c3d_rotation_from_camera(&level, &rotation);
    int64_t half = c3d_length64(camera->roll ? camera->width / 2 : 0, camera->height / 2, 0),
            cosine = rotation.m[2][1] > 1 << 24 ? rotation.m[2][1] : 1 << 24,
            tilt = -(int64_t)rotation.m[2][2] * set->focal / cosine, /* of the view's middle */
        lift = (int64_t)set->focal * (set->position_wu[2] - camera->pos_wu[2]) / set->front_wu;
    int64_t down = half * (1 << 30) / cosine + (tilt > 0 ? tilt : 0) + (lift > 0 ? lift : 0) +
                   FF_FAR_BLOCK;
    int64_t most = 2 * (int64_t)set->focal;
    return (uint16_t)(down > most ? most : down);
}

static void want_sectors(const ff_sets *sets, ff_requests *requests, const ff_view *view,
                         const ff_set *set, unsigned missing, enum ff_request_class rank)
{
    ff_ask ask;
    const ff_set_region *region = &set->region;
    ff_get_far request = { .front_wu = set->front_wu,
                           .heading = region->heading,
                           .behind_m = metres(region->behind_wu),
                           .ahead_m = metres(region->ahead_wu),
                           .aside_m = metres(region->aside_wu),
                           .low_m = (int16_t)(region->low_wu / FF_WU_PER_METRE),
                           .high_m = (int16_t)(region->high_wu / FF_WU_PER_METRE),
                           .focal = set->focal,
                           .down = down_of(set, &view->camera),
                           .paint_shift = set->paint_shift,
                           .quality = set->painted ? sets->desc.jpeg_quality : 0,
                           .tolerance_q2 = sets->desc.tolerance_q2 };
    ff_shape_leave(sets->info, &view->frame, set->position_wu, request.position_wu);
    list_sectors(&request, missing, &view->camera);
    FF_ASSERT(request.sector_count > 0);
    ask.far = request;
    ff_requests_want(requests, FF_KIND_FAR, set->key, rank,
                     rank == FF_CLASS_FIRST ? PRIORITY_SECTOR : 1, &ask);
}

void ff_sets_want(const ff_sets *sets, ff_requests *requests, const ff_view *view, unsigned soon,
                  int64_t now_us)
{
    int newest = sets->next >= 0 ? sets->next : sets->active;
    if (!sets->choice.use || sets->off || newest < 0 || now_us < sets->retry_us) return;
    const ff_set *set = &sets->set[newest];
    unsigned in_view = sets->seen & ~known(set), missing = in_view;
    if (!in_view && sets->next < 0) missing = soon & ~known(set);
    if (missing)
        want_sectors(sets, requests, view, set, missing,
                     in_view ? FF_CLASS_FIRST : FF_CLASS_PREFETCH);
}

/* ---- what comes ---- */

static void take_refusal(ff_sets *sets, int error, int64_t now_us)
{
    if (error == FF_ERR_UNSUPPORTED) sets->off = 1;
    if (sets->refusals < REFUSALS_IN_A_ROW) sets->refusals++;
    sets->retry_us = now_us + (sets->refusals < REFUSALS_IN_A_ROW ? RETRY_US : RETRY_LATER_US);
}

/* A sector of a set that is out of view gives way. 0: there is none. */
static int make_room_in(ff_sets *sets, int index)
{
    ff_set *set = index >= 0 ? &sets->set[index] : NULL;
    unsigned idle = set ? set->held & ~(unsigned)sets->seen : 0;
    for (unsigned s = 0; s < FF_FAR_SECTORS; s++) {
        if (!(idle >> s & 1u)) continue;
        drop_sector(sets, &set->sector[s]);
        set->held &= (uint16_t) ~(1u << s);
        return 1;
    }
    return 0;
}

static int make_room(ff_sets *sets)
{
    return make_room_in(sets, sets->under) || make_room_in(sets, sets->active);
}

/* What lies beyond the sector in its outermost blocks is the neighbour's: here it is made up. */
static void cut_off(const ff_set *set, const ff_new_item *item, uint16_t *texels)
{
    int32_t half = ff_far_half(set->focal >> set->paint_shift), left = item->u.far.middle - half,
            right = item->u.far.middle + half;
    for (unsigned y = 0; y < item->height; y++, texels += item->width) {
        for (int32_t x = 0; x < left && x < item->width; x++) texels[x] &= (uint16_t)~1u;
        for (int32_t x = right < 0 ? 0 : right; x < item->width; x++) texels[x] &= (uint16_t)~1u;
    }
}

static c3d_texture make_paint(ff_sets *sets, const ff_set *set, const ff_new_item *item,
                              uint16_t *texels)
{
    c3d_texture texture;
    cut_off(set, item, texels);
    do texture = c3d_texture_make(sets->device, C3D_RGBA5551, item->width, item->height, texels);
    while (!texture.id && make_room(sets));
    return texture;
}

static void take_sector(ff_sets *sets, ff_set *set, const ff_new_item *item)
{
    unsigned s = item->u.far.sector;
    ff_set_sector *sector = &set->sector[s];
    const ff_fin_vertex *fin = (const ff_fin_vertex *)(const void *)item->pixels;
    set->held |= (uint16_t)(1u << s);
    sets->sectors++;
    if (sets->device && item->width) {
        sector->paint = make_paint(
            sets, set, item, (uint16_t *)(void *)((uint8_t *)item->pixels + FF_NEW_FINS_BYTES));
        sector->width = item->width;
        sector->height = item->height;
        sector->middle = item->u.far.middle;
        sector->top = item->u.far.top;
    }
    ff_sets_make_fins(sets, set, s, fin, item->u.far.fins);
}

int ff_sets_take(ff_sets *sets, const ff_new_item *item, int64_t now_us)
{
    for (int i = 0; i < 2; i++) {
        ff_set *set = &sets->set[i];
        unsigned bit = 1u << item->u.far.sector;
        if (set->key != item->key || !set->key) continue;
        if (item->refused) {
            if (item->error != FF_ERR_CLOSED) take_refusal(sets, item->error, now_us);
            return 1;
        }
        if (known(set) & bit) return 0;
        sets->refusals = 0;
        if (item->error != FF_OK)
            set->failed |= (uint16_t)bit;
        else if (item->u.far.empty)
            set->empty |= (uint16_t)bit, sets->sectors_empty++;
        else
            take_sector(sets, set, item);
        return 1;
    }
    return 0;
}
