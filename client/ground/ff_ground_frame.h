/* One frame of coordinates for all ground in the picture, so that what nodes share stays shared
 * after projection.
 *
 * A renderer multiplies each vertex with its draw call's matrix and rounds. Two nodes with matrices
 * of their own round their common rim differently, and now and then a pixel between them stays
 * empty, however whole the mesh is. Vertices are therefore moved into one frame: units of the
 * finest samples, counted from a sample near the camera, in the 32 bits that reach over any
 * terrain. All nodes then use the same matrix, equal vertices give equal pixels, and the numbers
 * stay small enough for single precision (no jitter far from the origin). Heights, too, count from
 * one near those of the terrain. Grounds that a tree holds together share no vertices: each has
 * units of its own, and an origin on its own samples by the common one.
 */
#ifndef FF_GROUND_FRAME_H
#define FF_GROUND_FRAME_H

#include "../terrain/ff_tree.h"

typedef struct ff_ground_frame {
    int32_t origin_wu[2]; /* the position of a sample of the first ground; see below for others */
    int32_t centre_wu[2]; /* from here curved ground falls away */
    uint8_t set;          /* 0: not chosen yet */
} ff_ground_frame;

/* Keeps the origin within about 512 m (at least one sample) of the camera, or of the nearest edge
 * of what holds all grounds of the tree, and on curved ground the centre within 512 m of the
 * camera: what lies there is tilted by less than 8e-5, a sixtieth of a pixel on a handheld. 1 when
 * one of them moved: all vertices made with it are void. */
int ff_ground_frame_follow(ff_ground_frame *frame, const ff_terrain_info *grounds, uint32_t count,
                           const c3d_camera *camera);

/* Moves ff_tree_vertices' output, `count` vertices of `drawn`, into the frame. Columns and rows
 * beyond the terrain's last sample come to lie on it: of cells that are all padding nothing is
 * left, and of one that the edge crosses the part inside. What two nodes share they move alike. */
void ff_ground_frame_vertices(const ff_ground_frame *frame, const ff_terrain_info *info,
                              const ff_drawn *drawn, c3d_vertex *vertices, uint32_t count);

/* Where a texture ends on such a node, for its draw call, unless it ends before. */
void ff_ground_frame_last(const ff_terrain_info *info, const ff_drawn *drawn, c3d_draw *draw);

/* Fills what all calls that draw them have in common: origin, scales and the grid's columns. */
void ff_ground_frame_draw(const ff_ground_frame *frame, const ff_terrain_info *info,
                          const c3d_camera *camera, c3d_draw *draw);

#endif
