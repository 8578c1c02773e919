/* The arithmetic of the core once more, in double precision and straight from the definitions: the
 * integers are judged by it. For tests only, never linked into the core. Positions in wu, pixels as
 * c3d.h counts them. */
#ifndef REFERENCE_H
#define REFERENCE_H

#include "../../common3d/c3d.h"
#include "../../protocol/ff_terrain.h"

#define REF_PI 3.14159265358979323846

typedef struct ref_camera {
    double pos_wu[3], right[3], up[3], forward[3];
    double focal_px, half_px[2];
} ref_camera;

void ref_camera_of(const c3d_camera *camera, ref_camera *ref);
/* Direction from the eye: right, up, forward. */
void ref_to_eye(const ref_camera *ref, const double direction_wu[3], double eye_wu[3]);
/* Pixel of a direction from the eye: 1, or 0 when it does not point forward. */
int ref_project_direction(const ref_camera *ref, const double direction_wu[3], double px[2]);
int ref_project(const ref_camera *ref, const double point_wu[3], double px[2]);
/* 1 when a pixel lies in the window, grown by margin_px on every side. */
int ref_in_window(const ref_camera *ref, const double px[2], double margin_px);

/* Hybrid, eq. 3: f = d / (e * C), from the eye to the middle of a node at its mean height. */
double ref_node_f(const ref_camera *ref, const double middle_wu[3], double edge_wu, double c);
/* Pixels of a vertical error seen from the nearest point of a box; infinite inside it. */
double ref_error_px(const ref_camera *ref, const double low_wu[3], const double high_wu[3],
                    double error_wu);

/* Hybrid, eq. 6 and 7: sideways; eq. 13: forwards. */
double ref_sideways_max(double error_px, double z, double focal_px);
double ref_forwards_max(double error_px, double z, double half_width_px);
/* Pixels between the place where a panorama taken at taken_wu shows a point and the place where the
 * point is; -1 when one of the two is not in front of the eye or neither is in the window. */
double ref_panorama_error_px(const ref_camera *ref, const double taken_wu[3],
                             const double point_wu[3]);

/* Four-point interpolation half-way between b and c, its form at an end of the line (between a and
 * b), and the middle of a cell from the four new samples round it and the four old ones at its
 * corners (SPEC.md, "Prediction"); before rounding, clamped. */
double ref_predict_inside(double a, double b, double c, double d);
double ref_predict_end(double a, double b, double c);
double ref_predict_centre(const double cross[4], const double corner[4]);

/* Height over a cell of two triangles, the diagonal from south-west to north-east; corners sw, se,
 * nw, ne; u, v in 0..1. */
double ref_cell_height(const double corner[4], double u, double v);

#endif
