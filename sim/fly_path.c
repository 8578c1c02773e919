#include "fly_path.h"

#include <math.h>

#define PI 3.14159265358979323846
#define PITCH_DEGREES (-6.0)
#define HOVER_DEGREES_S 6.0
#define TURN_EVERY_S 20.0
#define TURN_S 2.0
#define SMOOTH_M 150.0  /* the height follows the highest ground within this distance along the path, averaged over it */
#define SMOOTH_STEPS 15 /* on each side */

void fly_path_init(fly_path *path, const fly_options *options, const ff_terrain_info *info, const sim_ground *ground)
{
    double spacing_m = (double)info->spacing_wu / FF_WU_PER_METRE;
    double size_x = (info->samples_x - 1) * spacing_m, size_y = (info->samples_y - 1) * spacing_m;
    double shorter = fmin(size_x, size_y);
    *path = (fly_path){ .kind = options->path, .ground = ground, .settle_s = options->settle_s, .speed_ms = options->speed_kmh / 3.6,
                        .height_m = options->height_m, .size_m = { size_x, size_y } };
    if (options->path == FLY_CIRCLE) {
        path->start_m[0] = size_x / 2;
        path->start_m[1] = size_y / 2;
        path->radius_m = fmin(3000, shorter / 4);
        return;
    }
    /* A straight line along the diagonal and another one back, 2 radii to its left, joined by half circles: three radii from a corner
     * are enough for all of it to stay inside; one twentieth of the shorter side more keeps it off the border. */
    path->radius_m = fmin(500, shorter / 20);
    double inset = 3 * path->radius_m + shorter / 20;
    double run_x = size_x - 2 * inset, run_y = size_y - 2 * inset;
    path->length_m = sqrt(run_x * run_x + run_y * run_y);
    path->start_m[0] = path->start_m[1] = inset;
    path->direction[0] = run_x / path->length_m;
    path->direction[1] = run_y / path->length_m;
    path->from_m = path->length_m * options->start;
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
    double half = PI * path->radius_m, s = fmod(arc_m, 2 * (path->length_m + half)), along, across = 0, turn = 0;
    double r = path->radius_m, left[2] = { -path->direction[1], path->direction[0] };
    if (s < 0)
        s += 2 * (path->length_m + half);
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

static void place(const fly_path *path, double arc_m, double pos_m[2], double heading[2])
{
    place_unmoved(path, arc_m, pos_m, heading);
    for (int i = 0; i < 2; i++)
        pos_m[i] = fmin(fmax(pos_m[i] + path->moved_m[i], 0), path->size_m[i]);
}

/* Arc length at a time. */
static double arc_at(const fly_path *path, double flown_s)
{
    double leg_s = fmod(flown_s, 2 * TURN_EVERY_S);
    if (path->kind == FLY_HOVER)
        return path->from_m;
    if (path->kind == FLY_TURN)
        return path->from_m + path->speed_ms * fmin(leg_s, 2 * TURN_EVERY_S - leg_s);
    return path->from_m + flown_s * path->speed_ms;
}

/* Turned by so much from the path's direction at a time. */
static double turned_at(const fly_path *path, double flown_s)
{
    if (path->kind == FLY_HOVER)
        return flown_s * HOVER_DEGREES_S / 360;
    if (path->kind != FLY_TURN || flown_s < TURN_EVERY_S)
        return 0;
    double legs = floor(flown_s / TURN_EVERY_S), in_leg_s = flown_s - legs * TURN_EVERY_S;
    return 0.5 * (legs - 1 + fmin(1, in_leg_s / TURN_S));
}

/* The highest ground within SMOOTH_M along the path, averaged over SMOOTH_M on both sides: calm, and never below the ground. */
static double smooth_ground_m(const fly_path *path, double arc_m)
{
    double height[4 * SMOOTH_STEPS + 1], pos_m[2], heading[2], sum = 0;
    for (int i = 0; i <= 4 * SMOOTH_STEPS; i++) {
        place(path, arc_m + (i - 2 * SMOOTH_STEPS) * SMOOTH_M / SMOOTH_STEPS, pos_m, heading);
        height[i] = sim_ground_height_m(path->ground, pos_m[0], pos_m[1]);
    }
    for (int i = SMOOTH_STEPS; i <= 3 * SMOOTH_STEPS; i++) {
        double most = height[i];
        for (int j = i - SMOOTH_STEPS; j <= i + SMOOTH_STEPS; j++)
            most = fmax(most, height[j]);
        sum += most;
    }
    return sum / (2 * SMOOTH_STEPS + 1);
}

void fly_path_at(const fly_path *path, double t_s, c3d_camera *camera)
{
    double pos_m[2], heading[2], flown_s = fmax(0, t_s - path->settle_s);
    double arc_m = arc_at(path, flown_s);
    place(path, arc_m, pos_m, heading);
    double yaw_turns = atan2(heading[0], heading[1]) / (2 * PI) + turned_at(path, flown_s);
    double z_m = smooth_ground_m(path, arc_m) + path->height_m;
    camera->pos_wu[0] = (int32_t)floor(pos_m[0] * FF_WU_PER_METRE + 0.5);
    camera->pos_wu[1] = (int32_t)floor(pos_m[1] * FF_WU_PER_METRE + 0.5);
    camera->pos_wu[2] = (int32_t)floor(z_m * FF_WU_PER_METRE + 0.5);
    camera->yaw = (int32_t)floor(yaw_turns * 65536 + 0.5) & 65535;
    camera->pitch = (int32_t)floor(PITCH_DEGREES / 360 * 65536 + 0.5);
    camera->roll = 0;
}

void fly_path_teleport(fly_path *path, double t_s, double x, double y)
{
    double pos_m[2], heading[2];
    place_unmoved(path, arc_at(path, fmax(0, t_s - path->settle_s)), pos_m, heading);
    path->moved_m[0] = x * path->size_m[0] - pos_m[0];
    path->moved_m[1] = y * path->size_m[1] - pos_m[1];
}
