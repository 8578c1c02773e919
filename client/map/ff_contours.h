/* Contours: lines of equal height over the ground as it is drawn, triangle by triangle, so that
 * they lie on it and meet where its triangles meet; and the viewer's place as a point. Made anew
 * for each picture: nothing is kept of a node.
 *
 * The owner zeroes it; memory is the owner's. */
#ifndef FF_CONTOURS_H
#define FF_CONTOURS_H

#include "../../common3d/c3d.h"
#include "../../protocol/ff_terrain.h"

/* Lines of one draw: each has two vertices of a mesh. */
#define FF_CONTOUR_LINES   32u
#define FF_CONTOUR_INDICES (2 * FF_CONTOUR_LINES)

typedef struct ff_contours {
    c3d_device *device; /* has room for one mesh of 2 * FF_CONTOUR_LINES more, and for the lines */
    c3d_vertex *vertex; /* 2 * FF_CONTOUR_LINES; NULL: none are drawn */
    c3d_strip lines;
    int32_t interval_wu; /* between them; 0: none */
    uint32_t count;      /* of vertices that wait */
} ff_contours;

/* A node as it was drawn. */
typedef struct ff_contour_node {
    const ff_terrain_info *info;
    const uint16_t *heights;    /* of the terrain */
    const c3d_vertex *vertices; /* in the frame of `ground`; alpha 0: another ground lies over it */
    const c3d_draw *ground;     /* the call that drew it */
} ff_contour_node;

extern const int ff_contours_built;

/* Makes the lines on the device. FF_OK or FF_ERR_MEMORY. */
int ff_contours_make(ff_contours *contours, c3d_device *device, c3d_vertex *vertex);
/* Draws what lines pass over a triangle strip of the node; at most FF_CONTOURS_OF_ONE over each
 * triangle, and none over one that more would pass, nor over one under another ground. */
#define FF_CONTOURS_OF_ONE 8
void ff_contours_strip(ff_contours *contours, const ff_contour_node *node, const uint16_t *index,
                       uint32_t count);
/* The node's last strip is done: what waits is drawn. */
void ff_contours_flush(ff_contours *contours, const c3d_draw *ground);
/* A place of the world, relative to the camera, as a point that only ground far above it hides. */
void ff_contours_point(ff_contours *contours, const int64_t offset_wu[3]);

#endif
