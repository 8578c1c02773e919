/* The skyline: in each column of a picture's pixels the topmost row that shows ground, at the
 * column's middle, in pixels from the picture's top: 0 where ground reaches the top, the picture's
 * height in a column without ground. True and drawn ones are sought alike and compared here. */
#ifndef SIM_SKYLINE_H
#define SIM_SKYLINE_H

#include <stddef.h>

#define SIM_SKYLINE_PX (1.0 / 16) /* how exactly a row is found */

/* A picture that is looked at place by place. */
typedef struct sim_skyline {
    unsigned width, height, step_px;
    /* 1 when a place, in pixels from the top left, shows ground */
    int (*shows)(void *context, const double pixel[2]);
    void *context;
    /* of each column of pixels looked at (sim_cover.h), the topmost of these that shows ground: its
     * row's middle, or the height. A peak above what is found from the column beside is not missed
     * where such a pixel lies in it */
    const double *hint_px;
} sim_skyline;

void sim_skyline_find(const sim_skyline *skyline, double *top_px);

/* The distances between two skylines, column by column, into error_px: returns how many. Where one
 * of the two has no ground, its skyline is the picture's lower border; where neither has, there is
 * no distance. */
size_t sim_skyline_compare(const double *true_px, const double *drawn_px, unsigned width,
                           unsigned height, double *error_px);

#endif
