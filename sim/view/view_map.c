#include "view_map.h"

#include "../../protocol/shape/ff_shape.h"

#include <string.h>

#define WAY_US       700000 /* from the flight to the map */
#define TURN_BRAD_S  8192
#define PAN_PART_S   1      /* so many widths of the picture a second */
#define ZOOM_US      500000 /* twice as large in this time */
#define LOOK_AHEAD   8      /* a map shows so many times the height over ground to each side */
#define AHEAD_MOST   20
#define PX_WU_Q8_MIN (64 << 8)
#define PX_WU_Q8_MAX ((int64_t)20000 * FF_WU_PER_METRE << 8)

static int64_t within(int64_t value, int64_t least, int64_t most)
{
    return value < least ? least : value > most ? most : value;
}

/* How high the pilot is above the ground, and how high that lies. */
static int64_t above_ground(const view_fly *fly, const ff_client *client, int32_t *ground_wu)
{
    const c3d_camera *camera = &fly->camera;
    const ff_terrain_info *info = ff_client_terrain(client);
    if (!ff_client_ground(client, camera->pos_wu[0], camera->pos_wu[1], ground_wu))
        *ground_wu = info ? ff_height_wu(info, info->height_min) : 0;
    return within((int64_t)camera->pos_wu[2] - *ground_wu, FF_WU_PER_METRE, INT32_MAX);
}

/* The flight as a view of the ground it looks at, or of what lies some way ahead. */
static ff_map of_flight(const view_fly *fly, const ff_client *client)
{
    int32_t ground_wu, down = -c3d_sin_q30(fly->camera.pitch);
    int64_t above_wu = above_ground(fly, client, &ground_wu), away_wu = AHEAD_MOST * above_wu;
    if (down > C3D_ONE_Q30 / AHEAD_MOST) away_wu = c3d_muldiv64(above_wu, C3D_ONE_Q30, down);
    return ff_map_of_camera(&fly->camera, away_wu);
}

void view_map_toggle(view_map *map, const view_fly *fly, const ff_client *client, int smoothly)
{
    int32_t place_wu[3];
    map->wanted = !map->wanted;
    map->dragging = 0;
    if (!smoothly) map->part_q16 = map->wanted ? 0 : 65536;
    if (!map->wanted) return;
    memcpy(place_wu, fly->camera.pos_wu, sizeof place_wu);
    int64_t above_wu = above_ground(fly, client, &place_wu[2]);
    int64_t px_wu_q8 = 2 * LOOK_AHEAD * (above_wu << 8) / fly->camera.width;
    map->map = ff_map_make(place_wu, fly->camera.yaw, within(px_wu_q8, PX_WU_Q8_MIN, PX_WU_Q8_MAX),
                           &fly->camera);
}

/* ---- panning, turning, zooming ---- */

static void zoom(view_map *map, int64_t times_q16)
{
    int64_t focal_q8 = map->map.focal_q8, most_wu = PX_WU_Q8_MAX * focal_q8 >> 16;
    map->map.away_wu = within(c3d_muldiv64(map->map.away_wu, times_q16, 65536),
                              PX_WU_Q8_MIN * focal_q8 >> 16,
                              most_wu < FF_MAP_AWAY_WU_MAX ? most_wu : FF_MAP_AWAY_WU_MAX);
}

static void pan(view_map *map, int64_t right_wu, int64_t up_wu)
{
    int64_t sine = c3d_sin_q30(map->map.yaw), cosine = c3d_cos_q30(map->map.yaw);
    int32_t *place_wu = map->map.place_wu;
    int64_t east = (up_wu * sine + right_wu * cosine) / C3D_ONE_Q30,
            north = (up_wu * cosine - right_wu * sine) / C3D_ONE_Q30;
    place_wu[0] = (int32_t)within(place_wu[0] + east, -INT32_MAX, INT32_MAX);
    place_wu[1] = (int32_t)within(place_wu[1] + north, -INT32_MAX, INT32_MAX);
}

void view_map_pointer(view_map *map, enum sys_pointer_action action, int x, int y, int button)
{
    int64_t px_wu_q8 = ff_map_px_wu_q8(&map->map);
    switch (action) {
        case SYS_POINTER_DOWN: map->dragging = 1; break;
        case SYS_POINTER_UP: map->dragging = 0; break;
        case SYS_POINTER_SCROLL: zoom(map, button > 0 ? 65536 * 4 / 5 : 65536 * 5 / 4); return;
        case SYS_POINTER_MOVE: /* the ground follows the finger */
            if (map->dragging)
                pan(map, (map->drag_x - x) * px_wu_q8 >> 8, (y - map->drag_y) * px_wu_q8 >> 8);
            break;
    }
    map->drag_x = x;
    map->drag_y = y;
}

static void move(view_map *map, const view_fly *fly, int64_t dt_us)
{
    unsigned pressed = fly->pressed;
    int64_t way_wu = (ff_map_px_wu_q8(&map->map) * fly->camera.width >> 8) * PAN_PART_S * dt_us /
                     1000000;
    int turn = (int)(TURN_BRAD_S * dt_us / 1000000);
    pan(map, way_wu * (!!(pressed & VIEW_RIGHT) - !!(pressed & VIEW_LEFT)),
        way_wu * (!!(pressed & VIEW_FORWARD) - !!(pressed & VIEW_BACK)));
    turn *= !!(pressed & VIEW_TURN_RIGHT) - !!(pressed & VIEW_TURN_LEFT);
    map->map.yaw = (map->map.yaw + turn) & 65535;
    int64_t step_q16 = 65536 * dt_us / ZOOM_US * 45 / 64; /* close to ln 2 */
    if (pressed & VIEW_RISE) zoom(map, 65536 + step_q16);
    if (pressed & VIEW_SINK) zoom(map, (int64_t)65536 * 65536 / (65536 + step_q16));
}

int view_map_step(view_map *map, const view_fly *fly, int64_t dt_us, const ff_client *client,
                  c3d_camera *camera)
{
    int64_t step_q16 = 65536 * dt_us / WAY_US;
    int32_t ground_wu;
    ff_map flight = of_flight(fly, client), now = flight;
    *camera = fly->camera;
    if (map->wanted) {
        move(map, fly, dt_us);
        if (ff_client_ground(client, map->map.place_wu[0], map->map.place_wu[1], &ground_wu))
            map->map.place_wu[2] = ground_wu;
    }
    map->part_q16 = (uint32_t)within((int64_t)map->part_q16 + (map->wanted ? -step_q16 : step_q16),
                                     0, 65536);
    if (map->part_q16 < 65536) {
        now = ff_map_between(&map->map, &flight, map->part_q16);
        ff_map_camera(&now, camera);
    }
    map->px_wu_q8 = ff_map_px_wu_q8(&now);
    return map->part_q16 < 32768;
}

void view_map_tell(view_map *map, const view_fly *fly, ff_client *client)
{
    ff_map_show show = { .has_place = map->part_q16 < 65536 };
    int32_t ground_wu = 0;
    if (show.has_place || map->contours) show.contour_wu = ff_map_contour_wu(map->px_wu_q8);
    if (show.has_place) {
        (void)above_ground(fly, client, &ground_wu);
        memcpy(show.place_wu, fly->camera.pos_wu, sizeof show.place_wu);
        show.place_wu[2] = ground_wu;
    }
    map->told = show;
    (void)ff_client_set_map(client, &show);
}
