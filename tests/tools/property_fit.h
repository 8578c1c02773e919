/* Least squares: how a ground would have to be shifted, scaled and turned to be the surface. */
#ifndef PROPERTY_FIT_H
#define PROPERTY_FIT_H

#include <stdint.h>

typedef struct property_fit {
    double shift;                  /* samples */
    double scale;                  /* how much longer, along x or y: a part of 1 */
    double gain;                   /* how much higher: a part of 1 */
    double rotation;               /* radians, of a turn or a shear */
    double bias_m, rms_m, error_m; /* mean (signed), root of the mean square, largest */
    double tilt_m; /* mean gradient, a sample: what a shift of one does to the bias */
    /* how far errors of 1 m, by chance in each sample, move the four above: one sigma */
    double shift_sd, scale_sd, gain_sd;
    uint32_t samples;
} property_fit;

/* Fits `height` to `wanted` (rows of `columns`; NaN is not judged). 0, or -1 with too few samples
 * to tell. */
int property_fit_grid(const double *height, const double *wanted, uint32_t columns, uint32_t rows,
                      property_fit *fit);

#endif
