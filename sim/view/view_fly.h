/* The emulator's pilot: keys, drags and position fixes become a camera. */
#ifndef VIEW_FLY_H
#define VIEW_FLY_H

#include "../../client/farfield.h"

#define VIEW_SPEED_DEFAULT_WU_S 10667 /* 150 km/h */
#define VIEW_START_ABOVE_WU     (500 * FF_WU_PER_METRE)

enum view_flying_key {
    VIEW_FORWARD = 1,
    VIEW_BACK = 2,
    VIEW_LEFT = 4,
    VIEW_RIGHT = 8,
    VIEW_TURN_LEFT = 16,
    VIEW_TURN_RIGHT = 32,
    VIEW_RISE = 64,
    VIEW_SINK = 128,
    VIEW_FAST = 256
};

typedef struct view_fly {
    c3d_camera camera;
    int32_t fov_brad16; /* horizontal */
    int32_t speed_wu_s;
    /* height over ground kept until the first move; negative: the pilot's own */
    int32_t above_wu;
    unsigned pressed; /* bits of enum view_flying_key, of the keys held */
    uint8_t cruise;   /* forward without a key */
    uint8_t placed;   /* the terrain is known and the start was chosen */
    uint8_t dragging;
    uint8_t has_goal; /* it flies there by itself until a key is pressed: */
    int32_t goal_wu[2], goal_above_wu;
    int drag_x, drag_y;
} view_fly;

void view_fly_init(view_fly *fly, int width, int height, int32_t fov_brad16);
void view_fly_resize(view_fly *fly, int width, int height);
/* Chooses the first place over a terrain: x_wu, y_wu, or the terrain's middle when `anywhere`;
 * above_wu over the ground. */
void view_fly_place(view_fly *fly, const ff_terrain_info *info, int anywhere, int32_t x_wu,
                    int32_t y_wu, int32_t above_wu);

/* Turns towards a place over ground, and flies there. */
void view_fly_to(view_fly *fly, int32_t x_wu, int32_t y_wu, int32_t above_wu);

/* Takes a key; 1 when it is one that flies. */
int view_fly_key(view_fly *fly, int code, int down);
void view_fly_pointer(view_fly *fly, enum sys_pointer_action action, int x, int y, int button);
/* A position fix moves the eye there; z_wu is the height of the eye. */
void view_fly_position(view_fly *fly, int32_t x_wu, int32_t y_wu, int32_t z_wu);
/* Tilting the device turns the view. The arguments are gravity in device axes: upright the viewer
 * looks ahead, lying with the screen up it looks down. */
void view_fly_tilt(view_fly *fly, int32_t x_mg, int32_t y_mg, int32_t z_mg);

/* Flies for dt_us; then keeps the eye over the ground drawn, when that is known. 1 when the camera
 * moved. */
int view_fly_step(view_fly *fly, int64_t dt_us, const ff_client *client);
/* Lets go of all keys: after an interruption their releases may never come. */
void view_fly_release(view_fly *fly);

#endif
