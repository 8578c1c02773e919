#include "far_rays.h"

#include <math.h>

#define STEP_M  10
#define REACH_M 40000
#define BEHIND  1.5 /* times as far is what stands behind an outline */

/* Height of the mesh of all samples, metres, at metres from the south-west corner. */
static double ground_at(far_height *height, const ff_terrain_info *info, double x_m, double y_m)
{
    double cell_m = (double)info->spacing_wu / FF_WU_PER_METRE, last = info->samples_x - 1.0;
    double column = x_m / cell_m, row = y_m / cell_m;
    if (column < 0 || row < 0 || column >= last || row >= last) return NAN;
    uint32_t i = (uint32_t)column, j = (uint32_t)row;
    double fx = column - i, fy = row - j, sw = height(NULL, i, j), se = height(NULL, i + 1, j),
           nw = height(NULL, i, j + 1), ne = height(NULL, i + 1, j + 1);
    return fx >= fy ? sw + (se - sw) * fx + (ne - se) * fy : sw + (nw - sw) * fy + (ne - nw) * fx;
}

unsigned far_march(const ff_terrain_info *info, far_height *height, const ff_get_far *request,
                   unsigned sector, double column, far_true_outline out[FAR_TRUE_OUTLINES])
{
    double azimuth = sector * atan(1) / 2, most = -1e9, top_at = 0, o[3],
           curve = info->curve_q60 * ldexp(FF_WU_PER_METRE, -60),
           from = (double)request->front_wu / FF_WU_PER_METRE * 0.875 * (sector % 4 ? 1.25 : 1);
    unsigned count = 0;
    for (int i = 0; i < 3; i++) o[i] = (double)request->position_wu[i] / FF_WU_PER_METRE;
    for (double f = from; f < REACH_M; f += STEP_M) {
        double r = f * column / request->focal, x = f * sin(azimuth) + r * cos(azimuth),
               y = f * cos(azimuth) - r * sin(azimuth),
               z = ground_at(height, info, o[0] + x, o[1] + y) - curve * (x * x + y * y);
        double up = request->focal * (z - o[2]) / f;
        if (!(up > most)) continue; /* hidden, or no ground */
        if (top_at > 0 && f > BEHIND * top_at && count + 1 < FAR_TRUE_OUTLINES)
            out[count++] = (far_true_outline){ most, top_at };
        most = up;
        top_at = f;
    }
    if (top_at > 0) out[count++] = (far_true_outline){ most, top_at };
    return count;
}

double far_off_outline(const far_true_outline *outline, unsigned count, double up,
                       double distance_m)
{
    double least = 1e9;
    for (unsigned i = 0; i < count; i++) {
        double ratio = outline[i].distance_m / distance_m;
        if (ratio > 0.9 && ratio < 1.1) least = fmin(least, fabs(outline[i].up - up));
    }
    return least;
}
