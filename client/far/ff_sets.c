#include "ff_sets.h"

#include <string.h>

#define SECTOR            (65536u / FF_FAR_SECTORS)
#define TILTED            4096     /* 22.5 degrees */
#define RETRY_US          2000000  /* the server was busy */
#define RETRY_LATER_US    30000000 /* after REFUSALS_IN_A_ROW refusals */
#define REFUSALS_IN_A_ROW 3
#define LEAD_US_MAX       20000000
#define LEFT_BEHIND       3 /* so many times its region's length away a set is dropped */

const uint8_t ff_sets_built = 1;

static ff_far_choice first_choice(const ff_far_desc *desc)
{
    return (ff_far_choice){ .use = desc->enabled == FF_FAR_AUTO ? FF_FAR_OFF : desc->enabled };
}

void ff_sets_init(ff_sets *sets, c3d_device *device, const ff_far_desc *desc,
                  const ff_terrain_info *info, unsigned side)
{
    *sets = (ff_sets){ .device = device,
                       .desc = *desc,
                       .info = info,
                       .side = (uint16_t)side,
                       .paint_bytes = UINT32_MAX,
                       .active = -1,
                       .next = -1,
                       .under = -1,
                       .front_wu = desc->front_wu,
                       .choice = first_choice(desc),
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

static void drop_fins(ff_sets *sets, ff_set_sector *sector)
{
    for (unsigned i = 0; i < sector->chunks; i++) {
        c3d_mesh_free(sets->device, sector->mesh[i]);
        c3d_strip_free(sets->device, sector->strip[i]);
    }
    sector->chunks = 0;
}

static void drop_sector(ff_sets *sets, ff_set_sector *sector)
{
    drop_fins(sets, sector);
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

/* The drawn set, if there is one, stays below the coming one, which is drawn from now on: or below
 * none. */
static void begin_fade(ff_sets *sets, int64_t now_us)
{
    FF_ASSERT(sets->under < 0);
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
    set->rung = sets->choice.rung;
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
    if (sets->seen & ~ff_sets_known(next)) return 0;
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

void ff_sets_set(ff_sets *sets, ff_requests *requests, const ff_far_desc *desc)
{
    ff_requests_cancel_all(requests, FF_KIND_FAR);
    end_fade(sets);
    for (int i = 0; i < 2; i++) drop_set(sets, i);
    sets->active = sets->next = -1;
    sets->desc = *desc;
    sets->choice = first_choice(desc);
    sets->unpaid = 0;
}

/* Who stays or walks has a set with a nearer front, although the newest is still good. */
static int may_be_richer(const ff_sets *sets)
{
    int newest = sets->next >= 0 ? sets->next : sets->active;
    return sets->choice.rung < 0 && newest >= 0 && sets->set[newest].rung > sets->choice.rung;
}

void ff_sets_leave(ff_sets *sets, ff_requests *requests, int64_t now_us)
{
    ff_requests_cancel_all(requests, FF_KIND_FAR);
    end_fade(sets);
    if (sets->next >= 0) drop_set(sets, sets->next);
    sets->next = -1;
    begin_fade(sets, now_us);
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
    if (sets->unpaid || (good_soon(sets, camera, motion) && !may_be_richer(sets))) return changed;
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

/* ---- what comes ---- */

static void take_refusal(ff_sets *sets, int error, int64_t now_us)
{
    if (error == FF_ERR_UNSUPPORTED) sets->off = 1;
    if (sets->refusals < REFUSALS_IN_A_ROW) sets->refusals++;
    sets->retry_us = now_us + (sets->refusals < REFUSALS_IN_A_ROW ? RETRY_US : RETRY_LATER_US);
}

static void lose_sector(ff_sets *sets, ff_set *set, unsigned s)
{
    drop_sector(sets, &set->sector[s]);
    set->held &= (uint16_t) ~(1u << s);
    set->bare &= (uint16_t) ~(1u << s);
}

/* Of some sectors the one that lies farthest from the view. */
static unsigned farthest_of(unsigned sectors, unsigned seen)
{
    unsigned s = 0;
    while (seen && sectors & ~seen) {
        sectors &= ~seen;
        seen = (seen | seen << 1 | seen >> 1 | seen >> (FF_FAR_SECTORS - 1) |
                seen << (FF_FAR_SECTORS - 1)) &
               FF_SETS_ALL;
    }
    while (!(sectors >> s & 1u)) s++;
    return s;
}

/* A sector of a set that is out of view gives way: one with paint, or one with fins. 0: there is
 * none. */
static int make_room_in(ff_sets *sets, int index, int for_paint)
{
    ff_set *set = index >= 0 ? &sets->set[index] : NULL;
    unsigned idle = set ? set->held & ~(unsigned)sets->seen : 0, useful = 0;
    for (unsigned s = 0; idle && s < FF_FAR_SECTORS; s++)
        if (for_paint ? set->sector[s].paint.id != 0 : set->sector[s].chunks) useful |= 1u << s;
    if (!(idle & useful)) return 0;
    lose_sector(sets, set, farthest_of(idle & useful, sets->seen));
    set->crowded = 1;
    return 1;
}

static int make_room(ff_sets *sets, int for_paint)
{
    return make_room_in(sets, sets->under, for_paint) ||
           make_room_in(sets, sets->active, for_paint);
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

/* Of paint on the device, with a rim of a texel. */
static uint32_t paint_bytes(unsigned width, unsigned height)
{
    return 2 * (uint32_t)(width + 2) * (height + 2);
}

/* Room for one more within paint's share: the reserve does not take what is the ground's. */
static int has_room(const ff_sets *sets, const ff_new_item *item)
{
    uint32_t bytes = paint_bytes(item->width, item->height);
    for (int i = 0; i < 2; i++)
        for (unsigned s = 0; s < FF_FAR_SECTORS; s++) {
            const ff_set_sector *sector = &sets->set[i].sector[s];
            if (sector->paint.id) bytes += paint_bytes(sector->width, sector->height);
        }
    return bytes <= sets->paint_bytes;
}

static void make_paint(ff_sets *sets, const ff_set *set, ff_set_sector *sector,
                       const ff_new_item *item, int first)
{
    uint16_t *texels = (uint16_t *)(void *)((uint8_t *)item->pixels + FF_NEW_FINS_BYTES);
    while (!has_room(sets, item))
        if (!first || !make_room(sets, 1)) break;
    if (!first && !has_room(sets, item)) return;
    cut_off(set, item, texels);
    do
        sector->paint = c3d_texture_make(sets->device, C3D_RGBA5551, item->width, item->height,
                                         texels);
    while (!sector->paint.id && first && make_room(sets, 1));
    sector->width = item->width;
    sector->height = item->height;
    sector->middle = item->u.far.middle;
    sector->top = item->u.far.top;
}

/* As many fins as there is room for. 0: not all of them. */
static int make_fins(ff_sets *sets, ff_set *set, const ff_new_item *item, int first)
{
    unsigned s = item->u.far.sector;
    const ff_fin_vertex *fin = (const ff_fin_vertex *)(const void *)item->pixels;
    while (!ff_sets_make_fins(sets, set, s, fin, item->u.far.fins)) {
        if (!first || !make_room(sets, 0)) return 0;
        drop_fins(sets, &set->sector[s]);
    }
    return 1;
}

/* What the sector has already gives way to it. What came for the reserve pushes nothing out, and
 * its fins are all kept or none. */
static void take_sector(ff_sets *sets, ff_set *set, const ff_new_item *item)
{
    unsigned s = item->u.far.sector;
    ff_set_sector *sector = &set->sector[s];
    uint16_t bit = (uint16_t)(1u << s);
    int first = !(item->key & FF_SETS_KEY_RESERVE) || (sets->seen & bit), no_room = 0;
    lose_sector(sets, set, s);
    sets->sectors++;
    if (sets->device && item->width) {
        make_paint(sets, set, sector, item, first);
        no_room = !sector->paint.id && !first;
    }
    if (!make_fins(sets, set, item, first) && !first) {
        drop_sector(sets, sector);
        set->crowded = 1;
        return;
    }
    ff_ridges_make(&sector->ridges, set->focal, (const ff_fin_vertex *)(const void *)item->pixels,
                   item->u.far.fins);
    set->stamp = ++sets->stamps;
    set->crowded |= (uint8_t)no_room;
    set->held |= bit;
    if (item->key & FF_SETS_KEY_FINS || no_room) set->bare |= bit;
}

/* Nothing to be seen, or no fins: then its paint is still to come. */
static void take_empty(ff_sets *sets, ff_set *set, const ff_new_item *item)
{
    uint16_t bit = (uint16_t)(1u << item->u.far.sector);
    lose_sector(sets, set, item->u.far.sector);
    sets->sectors_empty++;
    if (item->key & FF_SETS_KEY_FINS)
        set->held |= bit, set->bare |= bit;
    else
        set->empty |= bit;
}

/* It is not asked for again; its fins stay. */
static void take_failure(ff_sets *sets, ff_set *set, unsigned bit)
{
    sets->sectors_failed++;
    if (!(set->held & bit)) set->failed |= (uint16_t)bit;
    set->bare &= (uint16_t)~bit;
}

int ff_sets_take(ff_sets *sets, const ff_new_item *item, int64_t now_us)
{
    for (int i = 0; i < 2; i++) {
        ff_set *set = &sets->set[i];
        unsigned bit = 1u << item->u.far.sector;
        if (set->key != (item->key & ~(FF_SETS_KEY_RESERVE | FF_SETS_KEY_FINS)) || !set->key)
            continue;
        if (item->refused) {
            if (item->error != FF_ERR_CLOSED) take_refusal(sets, item->error, now_us);
            return 1;
        }
        int fins_alone = (item->key & FF_SETS_KEY_FINS) != 0;
        if (ff_sets_known(set) & ~(fins_alone ? 0u : set->bare) & bit) return 0;
        if (!fins_alone) set->whole++, set->whole_bytes += item->bytes;
        sets->refusals = 0;
        if (item->error != FF_OK)
            take_failure(sets, set, bit);
        else if (item->u.far.empty)
            take_empty(sets, set, item);
        else
            take_sector(sets, set, item);
        return 1;
    }
    return 0;
}
