/* Random views of ordinary scenes for tests against the reference, all from one seed. */
#ifndef REFERENCE_VIEWS_H
#define REFERENCE_VIEWS_H

#include "reference.h"

/* VIEWS of the environment (default 1,000,000) divided by `share`, at least 1. */
uint32_t ref_views(uint32_t share);
/* Evenly from lo to hi, both included. */
int32_t ref_between(sys_random *random, int32_t lo, int32_t hi);
/* Anywhere in the world, 240x320 to 640x480, 20 to 120 degrees wide. */
c3d_camera ref_ordinary_camera(sys_random *random);
/* A point that shows in the window (or up to a quarter beyond), 0.25 m to 100 km deep, whole wu. */
void ref_point_in_view(sys_random *random, const ref_camera *ref, double point_wu[3]);
/* Pixels between two places of the window. */
double ref_apart(const double a[2], const double b[2]);

#endif
