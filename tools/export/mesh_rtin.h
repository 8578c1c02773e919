/* A square of heights as few triangles: a right-triangulated irregular network (W. Evans, D.
 * Kirkpatrick, G. Townsend, "Right-triangulated irregular networks", 2001).
 *
 * The square of 2^k cells a side is two right triangles; one is halved from the middle of its
 * longest side to its right angle where that middle, or any below it, is further from the triangles
 * than allowed. A middle is halved on both its sides, so there is no crack within a square. Squares
 * that touch tell each other which middles on their common side they use, and take the other's.
 */
#ifndef MESH_RTIN_H
#define MESH_RTIN_H

#include <stdint.h>

#define MESH_CELLS_LOG2 6
#define MESH_CELLS      (1 << MESH_CELLS_LOG2)
#define MESH_SIDE       (MESH_CELLS + 1)
#define MESH_POINTS     (MESH_SIDE * MESH_SIDE)

/* Point (column, row) has number row * MESH_SIDE + column; row 0 is the southern one. */

typedef struct mesh_rtin {
    float error[MESH_POINTS];        /* of middles: with what error they may be left out */
    uint32_t index[6 * MESH_POINTS]; /* of points, three a triangle, counter-clockwise */
    uint32_t triangle_count;
} mesh_rtin;

/* Points of a square's sides, from the south or the west. The side across is `side ^ 1`. */
enum mesh_side { MESH_WEST, MESH_EAST, MESH_SOUTH, MESH_NORTH, MESH_SIDES };
typedef struct mesh_sides {
    uint8_t used[MESH_SIDES][MESH_SIDE];
} mesh_sides;

/* Works out all errors. `height` has MESH_POINTS. The ground also falls away between two points: a
 * cell is cell_m[row] metres from west to east in its row, and `cell_y_m` from south to north, on a
 * sphere of the Earth's size. */
void mesh_rtin_measure(const float *height, const double cell_m[MESH_SIDE], double cell_y_m,
                       mesh_rtin *rtin);
/* Which points of the sides are used when no error may be more than `error_m`. */
void mesh_rtin_sides(const mesh_rtin *rtin, float error_m, mesh_sides *sides);
/* Makes the triangles; on its sides they have the points of `sides`, which hold the square's own.
 */
void mesh_rtin_triangulate(mesh_rtin *rtin, float error_m, const mesh_sides *sides);

#endif
