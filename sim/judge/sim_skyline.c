#include "sim_skyline.h"

#include <math.h>

#define STRIDE_PX (2 * SIM_SKYLINE_PX) /* the first step away from the row of the column beside */

/* The row of a column at which ground ends upwards, sought from a row near it in doubled steps,
 * then by halving. */
static double top_from(const sim_skyline *skyline, double x, double near_px)
{
    double ground = near_px, sky = near_px, pixel[2] = { x, near_px };
    int up = skyline->shows(skyline->context, pixel);
    for (double stride = STRIDE_PX;; stride *= 2) {
        if (up ? ground <= 0 : sky >= skyline->height) return up ? 0 : skyline->height;
        pixel[1] = up ? fmax(ground - stride, 0) : fmin(sky + stride, skyline->height);
        int shows = skyline->shows(skyline->context, pixel);
        *(shows ? &ground : &sky) = pixel[1];
        if (shows != up) break;
    }
    while (ground - sky > SIM_SKYLINE_PX) {
        pixel[1] = (sky + ground) / 2;
        *(skyline->shows(skyline->context, pixel) ? &ground : &sky) = pixel[1];
    }
    return (sky + ground) / 2;
}

void sim_skyline_find(const sim_skyline *skyline, double *top_px)
{
    double near_px = skyline->hint_px[0];
    for (unsigned column = 0; column < skyline->width; column++) {
        double x = column + 0.5, hint = skyline->hint_px[column / skyline->step_px];
        const double pixel[2] = { x, hint };
        near_px = top_from(skyline, x, near_px);
        if (hint < near_px && skyline->shows(skyline->context, pixel))
            near_px = top_from(skyline, x, hint);
        top_px[column] = near_px;
    }
}

size_t sim_skyline_compare(const double *true_px, const double *drawn_px, unsigned width,
                           unsigned height, double *error_px)
{
    size_t count = 0;
    for (unsigned i = 0; i < width; i++) {
        if (true_px[i] >= height && drawn_px[i] >= height) continue;
        error_px[count] = fabs(true_px[i] - drawn_px[i]);
        if (true_px[i] >= height || drawn_px[i] >= height)
            error_px[count] = fmax(error_px[count], SIM_SKYLINE_PX);
        count++;
    }
    return count;
}
