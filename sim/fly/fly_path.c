#include "fly_path.h"

#include "../../protocol/ff_assert.h"
#include "../../protocol/shape/ff_shape.h"

#include <math.h>

#define PI              3.14159265358979323846
#define PITCH_DEGREES   (-6.0)
#define ABOVE_M         1.0 /* ground that a recorded flight keeps below */
#define WORLD_M         8e6 /* as far as recorded positions go (fly_recording.c) */
#define HOVER_DEGREES_S 6.0
#define TURN_EVERY_S    20.0
#define TURN_S          2.0
/* A path keeps a height above the highest ground within this distance along it, averaged over
 * the same distance. */
#define SMOOTH_M     150.0
#define SMOOTH_STEPS 15 /* on each side */

void fly_path_init(fly_path *path, const fly_options *options, const ff_terrain_info *info,
                   const sim_ground *ground)
{
    int64_t size_wu[2];
    ff_shape_size_wu(info, size_wu);
    double size_x = (double)size_wu[0] / FF_WU_PER_METRE,
           size_y = (double)size_wu[1] / FF_WU_PER_METRE;
    double shorter = fmin(size_x, size_y);
    *path = (fly_path){ .kind = options->path,
                        .ground = ground,
                        .recording = &options->recording,
                        .settle_s = options->settle_s,
                        .speed_ms = options->speed_kmh / 3.6,
                        .height_m = options->height_m,
                        .size_m = { size_x, size_y },
                        .pitch_degrees = NAN };
    path->end_height_m = path->height_m;
    if (options->path == FLY_RECORDED) return;
    if (options->path == FLY_CIRCLE) {
        path->start_m[0] = size_x / 2;
        path->start_m[1] = size_y / 2;
        path->radius_m = fmin(3000, shorter / 4);
        return;
    }
    /* A straight line along the diagonal and another one back, 2 radii to its left, joined by half
     * circles: three radii from a corner are enough for all of it to stay inside; one twentieth of
     * the shorter side more keeps it off the border. */
    path->radius_m = fmin(500, shorter / 20);
    double inset = 3 * path->radius_m + shorter / 20;
    double run_x = size_x - 2 * inset, run_y = size_y - 2 * inset;
    path->length_m = sqrt(run_x * run_x + run_y * run_y);
    path->start_m[0] = path->start_m[1] = inset;
    path->direction[0] = run_x / path->length_m;
    path->direction[1] = run_y / path->length_m;
    path->from_m = path->length_m * options->start;
}

void fly_path_begin_at(fly_path *path, const double at_m[2], const double *to_m)
{
    double way[2] = { 0, 1 };
    if (!to_m) {
        fly_path_teleport(path, 0, at_m[0] / path->size_m[0], at_m[1] / path->size_m[1]);
        return;
    }
    FF_ASSERT(path->kind == FLY_STRAIGHT);
    for (int i = 0; i < 2; i++) {
        path->start_m[i] = at_m[i];
        way[i] = to_m[i] - at_m[i];
    }
    path->length_m = hypot(way[0], way[1]);
    for (int i = 0; i < 2 && path->length_m > 0; i++) path->direction[i] = way[i] / path->length_m;
    path->from_m = 0;
}

/* Position and direction of flight at an arc length, before teleports. */
static void place_unmoved(const fly_path *path, double arc_m, double pos_m[2], double heading[2])
{
    if (path->kind == FLY_CIRCLE) {
        double angle = arc_m / path->radius_m;
        pos_m[0] = path->start_m[0] + path->radius_m * cos(angle);
        pos_m[1] = path->start_m[1] + path->radius_m * sin(angle);
        heading[0] = -sin(angle);
        heading[1] = cos(angle);
        return;
    }
    if (path->kind == FLY_STRAIGHT) {
        for (int i = 0; i < 2; i++) {
            pos_m[i] = path->start_m[i] + arc_m * path->direction[i];
            heading[i] = path->direction[i];
        }
        return;
    }
    double half = PI * path->radius_m, s = fmod(arc_m, 2 * (path->length_m + half)), along,
           across = 0, turn = 0;
    double r = path->radius_m, left[2] = { -path->direction[1], path->direction[0] };
    if (s < 0) s += 2 * (path->length_m + half);
    if (s <= path->length_m) {
        along = s;
    } else if (s <= path->length_m + half) {
        turn = (s - path->length_m) / r;
        along = path->length_m + r * sin(turn);
        across = r - r * cos(turn);
    } else if (s <= 2 * path->length_m + half) {
        turn = PI;
        along = path->length_m - (s - path->length_m - half);
        across = 2 * r;
    } else {
        turn = PI + (s - 2 * path->length_m - half) / r;
        along = r * sin(turn);
        across = r - r * cos(turn);
    }
    for (int i = 0; i < 2; i++) {
        pos_m[i] = path->start_m[i] + along * path->direction[i] + across * left[i];
        heading[i] = cos(turn) * path->direction[i] + sin(turn) * left[i];
    }
}

/* Moves a position by what teleports have moved the path; a border stops it. A recorded path may
 * leave the terrain: what stops it is the end of the world's positions. */
static void move(const fly_path *path, double pos_m[2])
{
    int recorded = path->kind == FLY_RECORDED;
    for (int i = 0; i < 2; i++)
        pos_m[i] = fmin(fmax(pos_m[i] + path->moved_m[i], recorded ? -WORLD_M : 0),
                        recorded ? WORLD_M : path->size_m[i]);
}

static void place(const fly_path *path, double arc_m, double pos_m[2], double heading[2])
{
    place_unmoved(path, arc_m, pos_m, heading);
    move(path, pos_m);
}

/* Arc length at a time. */
static double arc_at(const fly_path *path, double flown_s)
{
    double leg_s = fmod(flown_s, 2 * TURN_EVERY_S);
    if (path->kind == FLY_HOVER) return path->from_m;
    if (path->kind == FLY_TURN)
        return path->from_m + path->speed_ms * fmin(leg_s, 2 * TURN_EVERY_S - leg_s);
    if (path->kind == FLY_STRAIGHT) return fmin(flown_s * path->speed_ms, path->length_m);
    return path->from_m + flown_s * path->speed_ms;
}

double fly_path_seconds(const fly_path *path)
{
    return path->speed_ms > 0 ? path->length_m / path->speed_ms : 0;
}

/* Above ground, at an arc length. */
static double height_at(const fly_path *path, double arc_m)
{
    double share = path->kind == FLY_STRAIGHT && path->length_m > 0 ? arc_m / path->length_m : 0;
    return path->height_m + share * (path->end_height_m - path->height_m);
}

/* How far the viewer has turned from the path's direction at a time. */
static double turned_at(const fly_path *path, double flown_s)
{
    if (path->kind == FLY_HOVER) return flown_s * HOVER_DEGREES_S / 360;
    if (path->kind != FLY_TURN || flown_s < TURN_EVERY_S) return 0;
    double legs = floor(flown_s / TURN_EVERY_S), in_leg_s = flown_s - legs * TURN_EVERY_S;
    return 0.5 * (legs - 1 + fmin(1, in_leg_s / TURN_S));
}

/* The highest ground within SMOOTH_M along the path, averaged over SMOOTH_M on both sides: calm,
 * and never below the ground. */
static double smooth_ground_m(const fly_path *path, double arc_m)
{
    double height[4 * SMOOTH_STEPS + 1], pos_m[2], heading[2], sum = 0;
    for (int i = 0; i <= 4 * SMOOTH_STEPS; i++) {
        place(path, arc_m + (i - 2 * SMOOTH_STEPS) * SMOOTH_M / SMOOTH_STEPS, pos_m, heading);
        height[i] = sim_ground_height_m(path->ground, pos_m[0], pos_m[1]);
    }
    for (int i = SMOOTH_STEPS; i <= 3 * SMOOTH_STEPS; i++) {
        double most = height[i];
        for (int j = i - SMOOTH_STEPS; j <= i + SMOOTH_STEPS; j++) most = fmax(most, height[j]);
        sum += most;
    }
    return sum / (2 * SMOOTH_STEPS + 1);
}

static void set_camera(const fly_path *path, c3d_camera *camera, const double pos_m[2], double z_m,
                       double yaw_turns, double pitch_degrees)
{
    yaw_turns += path->turned_degrees / 360;
    if (!isnan(path->pitch_degrees)) pitch_degrees = path->pitch_degrees;
    camera->pos_wu[0] = (int32_t)floor(pos_m[0] * FF_WU_PER_METRE + 0.5);
    camera->pos_wu[1] = (int32_t)floor(pos_m[1] * FF_WU_PER_METRE + 0.5);
    camera->pos_wu[2] = (int32_t)floor(z_m * FF_WU_PER_METRE + 0.5);
    camera->yaw = (int32_t)floor(yaw_turns * 65536 + 0.5) & 65535;
    camera->pitch = (int32_t)floor(pitch_degrees / 360 * 65536 + 0.5);
    camera->roll = 0;
}

/* Outside the terrain there is no ground to keep above; heights above ground are above its rim. */
static void recorded_at(const fly_path *path, double t_s, c3d_camera *camera)
{
    fly_fix fix;
    fly_recording_at(path->recording, t_s, &fix);
    double pos_m[2] = { fix.x_m, fix.y_m };
    move(path, pos_m);
    double ground_m = sim_ground_height_m(path->ground, pos_m[0], pos_m[1]);
    double z_m = path->recording->above_ground ? ground_m + fix.up_m : fix.up_m;
    if (sim_ground_has(path->ground, pos_m[0], pos_m[1])) z_m = fmax(z_m, ground_m + ABOVE_M);
    set_camera(path, camera, pos_m, z_m, fix.heading_deg / 360, fmin(fmax(fix.pitch_deg, -90), 90));
}

void fly_path_at(const fly_path *path, double t_s, c3d_camera *camera)
{
    double pos_m[2], heading[2], flown_s = fmax(0, t_s - path->settle_s);
    if (path->kind == FLY_RECORDED) {
        recorded_at(path, t_s, camera);
        return;
    }
    double arc_m = arc_at(path, flown_s);
    place(path, arc_m, pos_m, heading);
    double yaw_turns = atan2(heading[0], heading[1]) / (2 * PI) + turned_at(path, flown_s);
    set_camera(path, camera, pos_m, smooth_ground_m(path, arc_m) + height_at(path, arc_m),
               yaw_turns, PITCH_DEGREES);
}

void fly_path_teleport(fly_path *path, double t_s, double x, double y)
{
    double pos_m[2], heading[2];
    fly_fix fix;
    if (path->kind == FLY_RECORDED) {
        fly_recording_at(path->recording, t_s, &fix);
        pos_m[0] = fix.x_m;
        pos_m[1] = fix.y_m;
    } else {
        place_unmoved(path, arc_at(path, fmax(0, t_s - path->settle_s)), pos_m, heading);
    }
    path->moved_m[0] = x * path->size_m[0] - pos_m[0];
    path->moved_m[1] = y * path->size_m[1] - pos_m[1];
}
