/* The shapes that are built, and what each keeps. A second one is two files of its own
 * (ff_shape_NAME.h, .c), a member in each union, its header, and its row in FF_SHAPE_CALL:
 *
 *   ((info)->shape == FF_SHAPE_NAME ? ff_NAME_##question arguments : ff_planar_##question
 * arguments)
 *
 * Included by ff_shape.h, which says what the questions are.
 */
#ifndef FF_SHAPES_H
#define FF_SHAPES_H

typedef union ff_frame {
    uint8_t planar; /* 0: there is one frame only, world axes */
} ff_frame;

typedef union ff_placed {
    struct {
        int32_t x_wu, y_wu; /* south-west corner */
    } planar;
} ff_placed;

typedef union ff_reach {
    struct {
        int32_t x0, x1, y0, y1; /* tiles x0..x1, y0..y1; x1 < x0: none */
    } planar;
} ff_reach;

typedef union ff_walk {
    struct {
        ff_reach reach;
        int32_t x, y;        /* of the middle; walking by number: of the next row */
        int32_t ring;        /* number of the ring, -1: walking by number */
        int32_t side;        /* of the ring, the one under way */
        uint32_t tile, left; /* the next tile of this run, and how many there are */
        uint32_t step;
    } planar;
} ff_walk;

/* Places and numbers of tiles along an axis are int32_t above. */
FF_STATIC_ASSERT(FF_KEY_TILES_MAX <= INT32_MAX);

#include "ff_shape_planar.h"

#define FF_SHAPE_CALL(info, question, arguments) ff_planar_##question arguments

#endif
