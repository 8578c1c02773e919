/* What the drawn ground covers of a picture: its triangles, and those of fins, projected in double
 * precision, cut where they come too near to the eye. Panoramas are drawn behind all of it. */
#ifndef SIM_COVER_H
#define SIM_COVER_H

#include "sim_eye.h"
#include "sim_fins.h"
#include "sim_mesh.h"

#define SIM_COVER_FIN UINT32_MAX /* instead of a node */

/* A point of the picture, pixels from its top left; 1 / depth, per metre. */
typedef struct sim_corner {
    double x, y, closeness;
} sim_corner;

typedef struct sim_vertex {
    double eye[3]; /* right, up, depth */
    int before;    /* the eye: it has a place in the picture */
    sim_corner at;
} sim_vertex;

typedef struct sim_cover {
    unsigned width, height, step_px;
    /* of each column of pixels: topmost row that drawn ground covers at the column's middle, pixels
     * from the picture's top, 0 at least; the picture's height where it covers none */
    double *top_px;
    /* of each pixel looked at, row by row: which node is nearest, as 1 + its index in the drawn
     * list; SIM_COVER_FIN: a fin is; 0: none. Every step-th pixel is looked at, from step / 2 on */
    uint32_t *node;
    double *closeness;              /* of those: 1 / depth, per metre */
    sim_vertex *point;              /* of one node */
    size_t columns, pixels, points; /* room for so many */
} sim_cover;

/* `cover` starts as zeros and is used again for the next picture. FF_OK or FF_ERR_MEMORY. */
int sim_cover_make(sim_cover *cover, const sim_mesh *mesh, const c3d_camera *camera,
                   unsigned step_px, const ff_drawn *drawn, uint32_t count);
/* Fins as well, in a picture made before. */
void sim_cover_fins(sim_cover *cover, const c3d_camera *camera, const sim_drawn_fins *drawn);
void sim_cover_free(sim_cover *cover);

/* How many pixels are looked at along `size` of them. */
static inline unsigned sim_looked_at(unsigned size, unsigned step_px)
{
    return (size + step_px - 1 - step_px / 2) / step_px;
}

#endif
