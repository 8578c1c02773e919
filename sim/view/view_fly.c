#include "view_fly.h"

#include "../../protocol/shape/ff_shape.h"

#include <math.h>
#include <string.h>

#define ABOVE_GROUND_WU_MIN (2 * FF_WU_PER_METRE)
#define TURN_BRAD16_S       8192  /* 45 degrees a second */
#define PITCH_BRAD16_MAX    16000 /* a little less than straight up or down */
#define DRAG_BRAD16_PX      40
#define SPEED_WU_S_MIN      FF_WU_PER_METRE
#define SPEED_WU_S_MAX      (20000 * FF_WU_PER_METRE)
#define FAST_FACTOR         5
#define BEYOND_WU           (20000 * FF_WU_PER_METRE) /* how far outside the terrain one may fly */
#define HEIGHT_WU_MAX       (1000000 * FF_WU_PER_METRE)

static int32_t clamp(int64_t value, int64_t low, int64_t high)
{
    return (int32_t)(value < low ? low : value > high ? high : value);
}

void view_fly_init(view_fly *fly, int width, int height, int32_t fov_brad16)
{
    memset(fly, 0, sizeof *fly);
    fly->fov_brad16 = fov_brad16;
    fly->speed_wu_s = VIEW_SPEED_DEFAULT_WU_S;
    fly->above_wu = VIEW_START_ABOVE_WU;
    view_fly_resize(fly, width, height);
}

void view_fly_resize(view_fly *fly, int width, int height)
{
    fly->camera.width = (uint16_t)clamp(width, 1, 4096);
    fly->camera.height = (uint16_t)clamp(height, 1, 4096);
    fly->camera.focal_q8 = c3d_focal_q8(fly->fov_brad16, fly->camera.width);
}

void view_fly_place(view_fly *fly, const ff_terrain_info *info, int anywhere, int32_t x_wu,
                    int32_t y_wu, int32_t above_wu)
{
    int64_t size_wu[2];
    ff_shape_size_wu(info, size_wu);
    fly->camera.pos_wu[0] = anywhere ? (int32_t)(size_wu[0] / 2) : x_wu;
    fly->camera.pos_wu[1] = anywhere ? (int32_t)(size_wu[1] / 2) : y_wu;
    fly->camera.pos_wu[2] = ff_height_wu(info, info->height_max) + above_wu;
    fly->camera.pitch = -1500;
    fly->above_wu = above_wu;
    fly->has_goal = 0;
    fly->placed = 1;
}

/* Angle of (x, y) from the positive y axis, positive towards x. */
static int32_t angle_of(int64_t x, int64_t y)
{
    return (int32_t)lround(atan2((double)x, (double)y) * (32768 / acos(-1)));
}

void view_fly_to(view_fly *fly, int32_t x_wu, int32_t y_wu, int32_t above_wu)
{
    int64_t east = (int64_t)x_wu - fly->camera.pos_wu[0],
            north = (int64_t)y_wu - fly->camera.pos_wu[1];
    fly->goal_wu[0] = x_wu;
    fly->goal_wu[1] = y_wu;
    fly->goal_above_wu = above_wu;
    fly->has_goal = 1;
    if (east || north) fly->camera.yaw = angle_of(east, north) & 65535;
}

int view_fly_key(view_fly *fly, int code, int down)
{
    static const struct {
        int code;
        unsigned bit;
    } keys[] = { { 'w', VIEW_FORWARD },
                 { SYS_KEY_UP, VIEW_FORWARD },
                 { 's', VIEW_BACK },
                 { SYS_KEY_DOWN, VIEW_BACK },
                 { 'a', VIEW_LEFT },
                 { 'd', VIEW_RIGHT },
                 { SYS_KEY_LEFT, VIEW_TURN_LEFT },
                 { SYS_KEY_RIGHT, VIEW_TURN_RIGHT },
                 { SYS_KEY_PAGE_UP, VIEW_RISE },
                 { SYS_KEY_PAGE_DOWN, VIEW_SINK },
                 { SYS_KEY_SHIFT, VIEW_FAST } };
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        if (keys[i].code != code) continue;
        fly->pressed = down ? fly->pressed | keys[i].bit : fly->pressed & ~keys[i].bit;
        fly->has_goal = 0;
        return 1;
    }
    return 0;
}

static void look(view_fly *fly, int yaw, int pitch)
{
    fly->camera.yaw = (fly->camera.yaw + yaw) & 65535;
    fly->camera.pitch = clamp((int64_t)fly->camera.pitch + pitch, -PITCH_BRAD16_MAX,
                              PITCH_BRAD16_MAX);
}

void view_fly_pointer(view_fly *fly, enum sys_pointer_action action, int x, int y, int button)
{
    switch (action) {
        case SYS_POINTER_DOWN: fly->dragging = 1; break;
        case SYS_POINTER_UP: fly->dragging = 0; break;
        case SYS_POINTER_SCROLL: {
            int64_t speed = button > 0 ? (int64_t)fly->speed_wu_s * 5 / 4
                                       : (int64_t)fly->speed_wu_s * 4 / 5;
            fly->speed_wu_s = clamp(speed, SPEED_WU_S_MIN, SPEED_WU_S_MAX);
            return;
        }
        case SYS_POINTER_MOVE: /* the ground follows the finger */
            if (fly->dragging)
                look(fly, (fly->drag_x - x) * DRAG_BRAD16_PX, (y - fly->drag_y) * DRAG_BRAD16_PX);
            break;
    }
    fly->drag_x = x;
    fly->drag_y = y;
}

void view_fly_position(view_fly *fly, int32_t x_wu, int32_t y_wu, int32_t z_wu)
{
    fly->camera.pos_wu[0] = x_wu;
    fly->camera.pos_wu[1] = y_wu;
    fly->camera.pos_wu[2] = z_wu;
    fly->above_wu = -1;
    fly->has_goal = 0;
}

void view_fly_tilt(view_fly *fly, int32_t x_mg, int32_t y_mg, int32_t z_mg)
{
    if (!x_mg && !y_mg && !z_mg) return;
    fly->camera.pitch = clamp(-(int64_t)angle_of(z_mg, y_mg), -PITCH_BRAD16_MAX, PITCH_BRAD16_MAX);
    fly->camera.roll = x_mg || y_mg ? -angle_of(x_mg, y_mg) : 0;
}

static void move(view_fly *fly, int64_t forward_wu, int64_t right_wu)
{
    int64_t sine = c3d_sin_q30(fly->camera.yaw), cosine = c3d_cos_q30(fly->camera.yaw);
    int64_t east = (forward_wu * sine + right_wu * cosine) / C3D_ONE_Q30;
    int64_t north = (forward_wu * cosine - right_wu * sine) / C3D_ONE_Q30;
    fly->camera.pos_wu[0] = clamp(fly->camera.pos_wu[0] + east, INT32_MIN, INT32_MAX);
    fly->camera.pos_wu[1] = clamp(fly->camera.pos_wu[1] + north, INT32_MIN, INT32_MAX);
}

/* Goes some of the way to the goal; the height above ground goes with it. */
static void approach(view_fly *fly, int64_t way_wu)
{
    int64_t way[2], height = (int64_t)fly->goal_above_wu - fly->above_wu;
    for (int i = 0; i < 2; i++) way[i] = (int64_t)fly->goal_wu[i] - fly->camera.pos_wu[i];
    int64_t left_wu = c3d_length64(way[0], way[1], 0);
    if (left_wu <= way_wu) {
        left_wu = way_wu = 1;
        fly->has_goal = 0;
    }
    for (int i = 0; i < 2; i++) fly->camera.pos_wu[i] += (int32_t)(way[i] * way_wu / left_wu);
    fly->above_wu += (int32_t)(height * way_wu / left_wu);
}

static void stay_inside(view_fly *fly, const ff_terrain_info *info)
{
    static const int64_t height_wu[2] = { -HEIGHT_WU_MAX, HEIGHT_WU_MAX };
    static const int32_t from_wu[3] = { 0, 0, 0 };
    ff_frame frame = ff_shape_frame(info, fly->camera.pos_wu);
    ff_box all = ff_shape_bounds(info, &frame, height_wu, from_wu);
    for (int axis = 0; axis < 3; axis++) {
        int64_t beyond_wu = axis < 2 ? BEYOND_WU : 0;
        fly->camera.pos_wu[axis] = clamp(fly->camera.pos_wu[axis], all.lo[axis] - beyond_wu,
                                         all.hi[axis] + beyond_wu);
    }
}

int view_fly_step(view_fly *fly, int64_t dt_us, const ff_client *client)
{
    const c3d_camera before = fly->camera;
    unsigned pressed = fly->pressed;
    int64_t way = (int64_t)fly->speed_wu_s * (pressed & VIEW_FAST ? FAST_FACTOR : 1) * dt_us /
                  1000000;
    int turn = (int)(TURN_BRAD16_S * dt_us / 1000000);
    int32_t ground_wu;
    const ff_terrain_info *info = ff_client_terrain(client);
    if (!fly->placed || !info) return 0;
    look(fly, turn * (!!(pressed & VIEW_TURN_RIGHT) - !!(pressed & VIEW_TURN_LEFT)), 0);
    if (fly->has_goal) approach(fly, way);
    move(fly, way * ((pressed & VIEW_FORWARD || fly->cruise) - !!(pressed & VIEW_BACK)),
         way * (!!(pressed & VIEW_RIGHT) - !!(pressed & VIEW_LEFT)));
    if (pressed & (VIEW_RISE | VIEW_SINK)) {
        int64_t z_wu = fly->camera.pos_wu[2] +
                       way * (!!(pressed & VIEW_RISE) - !!(pressed & VIEW_SINK));
        fly->camera.pos_wu[2] = clamp(z_wu, -HEIGHT_WU_MAX, HEIGHT_WU_MAX);
    }
    if (fly->cruise ||
        pressed & (VIEW_FORWARD | VIEW_BACK | VIEW_LEFT | VIEW_RIGHT | VIEW_RISE | VIEW_SINK))
        fly->above_wu = -1;
    stay_inside(fly, info);
    if (ff_client_ground(client, fly->camera.pos_wu[0], fly->camera.pos_wu[1], &ground_wu)) {
        if (fly->above_wu >= 0) fly->camera.pos_wu[2] = ground_wu + fly->above_wu;
        if (fly->camera.pos_wu[2] < ground_wu + ABOVE_GROUND_WU_MIN)
            fly->camera.pos_wu[2] = ground_wu + ABOVE_GROUND_WU_MIN;
    }
    return memcmp(&before, &fly->camera, sizeof before) != 0;
}

void view_fly_release(view_fly *fly)
{
    fly->pressed = 0;
    fly->dragging = 0;
    fly->cruise = 0;
}
