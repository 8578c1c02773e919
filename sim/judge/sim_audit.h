/* The auditor: how wrong is a picture, in pixels, judged from the whole true ground in double
 * precision (DESIGN, "Judging the picture").
 *
 * For a grid of pixels it finds the true visible ground point P, then what the client draws for P:
 *   ground    P's (x, y) lies under a drawn triangle: P at the drawn height is projected again; the
 *             distance to P's own pixel is the error.
 *   panorama  no triangle, but a panorama in use shows P, in the direction in which P lies from O,
 *             where the panorama was taken. That direction, taken from the camera, is projected;
 *             the distance to P's pixel is its parallax. A texel of the face is one colour, and
 *             the ground's edge in it runs along texels: the error is
 *               parallax + max(w, h) / 2
 *             where w and h are how far the middles of the texel's left and right, upper and lower
 *             sides lie apart in the picture there, in pixels. Ground that O could not see is not
 *             counted.
 *   nothing   neither: the error is the distance to the nearest pixel at which something is drawn
 *             for the ground there (one-sided Hausdorff: how far the drawn ground's edge would have
 *             to come), the picture's diagonal where there is none. Counted in undrawn_percent too.
 *
 * A pixel that truly shows the sky has an error, too, when ground is drawn there: by a triangle, a
 * fin's too, or by a texel of a panorama (sim_faces.h). The error is the distance to the nearest
 * true ground of the picture, where ground would be right, the picture's diagonal where there is
 * none. Its cause is what keeps that node, or the panorama, from being right.
 *
 * The skyline is judged apart, over the whole picture: in each column of pixels the topmost true
 * ground, found by rays to 1/16 pixel, against the topmost drawn ground, by triangles cut at the
 * eye, fins' among them, and by the texels of panoramas. Where ground is drawn by nodes and a fin
 * is before it the error of its pixels is still that of the nodes. Where only one of the two exists
 * the other counts as the picture's lower border; columns without ground do not count.
 *
 * Of several grounds the upper is what is drawn at a place. Where the drawn grounds of two meet and
 * do not touch, the sky shows through below drawn ground: such a pixel counts as undrawn, too, with
 * the error that it has.
 *
 * Each pixel's error has one cause (enum sim_audit_cause), found from the quality asked for, not
 * from the client's selection. The auditor does not depend on the client's estimates: it makes
 * triangles anew from the drawn list's heights and border masks.
 */
#ifndef SIM_AUDIT_H
#define SIM_AUDIT_H

#include "sim_faces.h"
#include "sim_fins.h"
#include "sim_ground.h"
#include "sim_mesh.h"

#define SIM_SEAM_CELLS 4 /* of the coarser ground: what is near a border */

enum sim_audit_cause {
    /* the quality asks for finer ground here, and there is some: it has not come */
    SIM_CAUSE_WAITING,
    SIM_CAUSE_DEPTH,    /* the quality would ask for finer ground, but its depth_max forbids it */
    SIM_CAUSE_STUB,     /* the quality asks for finer ground, and there is some: not in the pack */
    SIM_CAUSE_QUALITY,  /* fine enough for the quality, or as fine as the terrain is */
    SIM_CAUSE_PANORAMA, /* parallax, and the size of a face's texels */
    SIM_CAUSE_FAR,      /* a fin over the sky */
    SIM_CAUSE_UNDRAWN,  /* nothing is drawn there */
    SIM_CAUSES
};

typedef struct sim_audit_view {
    c3d_camera camera;     /* near and far are not looked at */
    ff_quality quality;    /* for the causes alone: measure, c, error_px, depth_max */
    const ff_drawn *drawn; /* what is drawn */
    uint32_t drawn_count;
    sim_drawn_grounds grounds;
    unsigned faces; /* of the panorama in use, bit per enum ff_face_name held; 0: none is */
    sim_panorama panorama;
    sim_drawn_fins fins;
} sim_audit_view;

typedef struct sim_audit_result {
    /* pixels that truly show ground, by what draws it */
    uint32_t ground_pixels, panorama_pixels, undrawn_pixels;
    uint32_t sky_pixels;                       /* that truly show sky, and show ground */
    double err_px_rms, err_px_p95, err_px_max; /* over all four; 0 without any */
    double square_px[SIM_CAUSES]; /* mean squares by cause: their sum is err_px_rms squared */
    double undrawn_percent;       /* of all pixels that truly show ground */
    uint32_t skyline_columns;     /* of pixels, with true or drawn ground */
    double skyline_px_rms, skyline_px_p95, skyline_px_max; /* over these; 0 without any */
    double filled_percent;                 /* of them: those whose ground was void in the source */
    uint32_t drawn_pixels[FF_GROUNDS_MAX]; /* of ground_pixels, by the ground drawn there */
    /* pixels whose true ground lies within SIM_SEAM_CELLS of another one's; their errors; 0 without
     * any */
    uint32_t seam_pixels;
    double seam_px_p95, seam_px_max;
} sim_audit_result;

typedef struct sim_auditor sim_auditor;
/* step_px: every step-th pixel in x and y is looked at. `ground` must outlive the auditor. NULL
 * when out of memory. */
sim_auditor *sim_auditor_create(const sim_ground *ground, const ff_terrain_info *info,
                                unsigned step_px);
void sim_auditor_destroy(sim_auditor *auditor);
/* FF_OK or FF_ERR_MEMORY. */
int sim_audit_frame(sim_auditor *auditor, const sim_audit_view *view, sim_audit_result *result);

/* Height of the triangles drawn at (x, y): 1 and *z_m, or 0 where there is none. */
int sim_audit_drawn_height(const sim_auditor *auditor, const ff_drawn *drawn, uint32_t count,
                           double x_m, double y_m, double *z_m);
/* World point (metres) to pixels as c3d.h projects; 0 when it is not in front of the eye. */
int sim_audit_project(const c3d_camera *camera, const double point_m[3], double pixel[2]);

#endif
