/* Flight paths: where the camera is at a time of the flight. Always inside the terrain's source,
 * but for a recorded one, which goes where it went; always above the true ground where there is
 * some (a recorded one at least a metre). */
#ifndef FLY_PATH_H
#define FLY_PATH_H

#include "fly_options.h"
#include "../judge/sim_ground.h"

typedef struct fly_path {
    enum fly_path_kind kind;
    const sim_ground *ground;
    const fly_recording *recording;
    double settle_s, speed_ms, height_m;
    double start_m[2];     /* of the straight part, or the circle's centre */
    double direction[2];   /* of the straight part, unit */
    double length_m;       /* of the straight part, or of the way from --at to --to */
    double end_height_m;   /* above ground, there */
    double radius_m;       /* of the half circles at its ends, or of the circle */
    double from_m;         /* arc length where the flight begins */
    double size_m[2];      /* of the terrain's source */
    double moved_m[2];     /* by teleports */
    double turned_degrees; /* by events, on top of the path's own turns */
    double pitch_degrees;  /* by an event, instead of the path's; NAN: none */
} fly_path;

/* `ground` and `options` must outlive the path. */
void fly_path_init(fly_path *path, const fly_options *options, const ff_terrain_info *info,
                   const sim_ground *ground);
/* Has the path begin at a place, metres from the south-west corner, and, where `to_m` is not NULL,
 * end at that one. */
void fly_path_begin_at(fly_path *path, const double at_m[2], const double *to_m);
/* How long the way from --at to --to takes. */
double fly_path_seconds(const fly_path *path);
/* Position and yaw after t_s seconds; pitch is slightly down, or as recorded. Sets pos_wu, yaw,
 * pitch, roll. */
void fly_path_at(const fly_path *path, double t_s, c3d_camera *camera);

/* Moves the path so that it is at (x, y), shares 0..1 of the source's size, at t_s. From then on it
 * stays where a border stops it, unless it is recorded. */
void fly_path_teleport(fly_path *path, double t_s, double x, double y);

#endif
