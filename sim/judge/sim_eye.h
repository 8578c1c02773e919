/* A camera in double precision, for all that judges pictures from outside: rays through pixels,
 * points to pixels, as c3d.h projects. */
#ifndef SIM_EYE_H
#define SIM_EYE_H

#include "../../common3d/c3d.h"

typedef struct sim_eye {
    double pos_m[3], right[3], up[3], forward[3], focal_px, centre_px[2];
} sim_eye;

void sim_eye_of(const c3d_camera *camera, sim_eye *eye);
/* Direction through a pixel; its depth along the view is 1. */
void sim_eye_ray(const sim_eye *eye, const double pixel[2], double along[3]);
/* A direction in the eye's own axes: right, up, depth. */
void sim_eye_turn(const sim_eye *eye, const double direction[3], double turned[3]);
/* Pixel of a direction from the eye: 1, or 0 when the direction does not lead forward. */
int sim_eye_project(const sim_eye *eye, const double direction[3], double pixel[2]);

#endif
