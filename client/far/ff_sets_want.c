/* What of the sets is asked for: what is in view, what a turn will show, and on an idle link the
 * rest of the set that is drawn. */
#include "ff_sets.h"

#include <string.h>

#define SECTOR           (65536u / FF_FAR_SECTORS)
#define PRIORITY_SECTOR  0x8000u   /* among the first: behind roots */
#define PRIORITY_RESERVE 0x400000u /* among the reserve: behind its roots */
#define RESERVE_PAINTED  4         /* sectors at a time: some 1000 bytes, as fins of all are */

/* Sectors to ask for, were they in view. */
static unsigned lacking(const ff_set *set)
{
    FF_ASSERT(!(set->bare & ~set->held));
    return (FF_SETS_ALL & ~ff_sets_known(set)) | set->bare;
}

static uint16_t metres(int32_t wu)
{
    int32_t m = wu / FF_WU_PER_METRE;
    return (uint16_t)(m < 0 ? 0 : m > UINT16_MAX ? UINT16_MAX : m);
}

/* Sectors in the order of how far they lie from the middle of the view, `most` of them. */
static void list_sectors(ff_get_far *request, unsigned missing, unsigned most,
                         const c3d_camera *camera)
{
    unsigned middle = (((uint32_t)camera->yaw + SECTOR / 2) & 65535u) / SECTOR;
    int right_first = ((uint32_t)camera->yaw + SECTOR / 2) % SECTOR >= SECTOR / 2;
    for (unsigned step = 0; step < 2 * FF_FAR_SECTORS && request->sector_count < most; step++) {
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
                         const ff_set *set, unsigned missing, enum ff_request_class rank,
                         ff_key how)
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
                           .quality = set->painted && !(how & FF_SETS_KEY_FINS) ? sets->desc.quality
                                                                                : 0,
                           .tolerance_q2 = sets->desc.tolerance_q2 };
    ff_shape_leave(sets->info, &view->frame, set->position_wu, request.position_wu);
    list_sectors(&request, missing,
                 rank == FF_CLASS_RESERVE && request.quality ? RESERVE_PAINTED : FF_FAR_SECTORS,
                 &view->camera);
    FF_ASSERT(request.sector_count > 0);
    ask.far = request;
    ff_requests_want(requests, FF_KIND_FAR, set->key | how, rank,
                     rank == FF_CLASS_FIRST     ? PRIORITY_SECTOR
                     : rank == FF_CLASS_RESERVE ? PRIORITY_RESERVE
                                                : 1,
                     0, &ask);
}

void ff_sets_want(const ff_sets *sets, ff_requests *requests, const ff_view *view, unsigned soon,
                  int64_t now_us)
{
    int newest = sets->next >= 0 ? sets->next : sets->active;
    if (!sets->choice.use || sets->off || newest < 0 || now_us < sets->retry_us) return;
    const ff_set *set = &sets->set[newest];
    unsigned in_view = sets->seen & lacking(set), missing = in_view;
    if (!in_view && sets->next < 0) missing = soon & lacking(set);
    if (missing)
        want_sectors(sets, requests, view, set, missing,
                     in_view ? FF_CLASS_FIRST : FF_CLASS_PREFETCH, 0);
}

static unsigned count_of(unsigned sectors)
{
    unsigned count = 0;
    for (; sectors; sectors &= sectors - 1) count++;
    return count;
}

/* Whether the set will be good for so long, if the viewer goes on as now. */
static int good_for(const ff_set *set, const c3d_camera *camera, const ff_motion *motion,
                    unsigned seconds)
{
    int32_t then_wu[3];
    memcpy(then_wu, camera->pos_wu, sizeof then_wu);
    (void)ff_motion_level(motion, 1000000, then_wu);
    for (int axis = 0; axis < 3; axis++) {
        int64_t at_wu = camera->pos_wu[axis] +
                        ((int64_t)then_wu[axis] - camera->pos_wu[axis]) * seconds;
        then_wu[axis] = (int32_t)(at_wu > INT32_MAX   ? INT32_MAX
                                  : at_wu < INT32_MIN ? INT32_MIN
                                                      : at_wu);
    }
    return ff_sets_good(set, then_wu);
}

/* Bytes of so many sectors, by those that have come. */
static uint32_t bytes_of(const ff_set *set, unsigned sectors)
{
    return (set->whole ? set->whole_bytes / set->whole : 0) * count_of(sectors);
}

/* Seconds for which the set must be good, that so many sectors are worth their bytes. */
static unsigned worth_s(const ff_set *set, unsigned sectors)
{
    unsigned seconds = bytes_of(set, sectors) / FF_SETS_IDLE_BYTES_S;
    return seconds > FF_SETS_FINS_S ? seconds : FF_SETS_FINS_S;
}

void ff_sets_want_reserve(const ff_sets *sets, ff_requests *requests, const ff_view *view,
                          const ff_motion *motion, int64_t now_us)
{
    if (!sets->choice.use || sets->off || sets->active < 0 || sets->next >= 0 ||
        now_us < sets->retry_us || sets->through) /* what fades has the room still */
        return;
    const ff_set *set = &sets->set[sets->active];
    if (set->crowded || (sets->seen & lacking(set)) ||
        !good_for(set, &view->camera, motion, FF_SETS_FINS_S))
        return;
    unsigned missing = lacking(set);
    int whole = !set->painted || (bytes_of(set, missing) <= FF_SETS_RESERVE_BYTES &&
                                  good_for(set, &view->camera, motion, worth_s(set, missing)));
    if (!whole) missing &= ~ff_sets_known(set);
    if (missing)
        want_sectors(sets, requests, view, set, missing, FF_CLASS_RESERVE,
                     whole ? FF_SETS_KEY_RESERVE : FF_SETS_KEY_RESERVE | FF_SETS_KEY_FINS);
}
