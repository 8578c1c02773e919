/* How far a picture is from what it should be, as a person sees it: two RGB888 pictures of the same
 * size, in double precision. All is of the luminance, Y = 0.299 R + 0.587 G + 0.114 B of the bytes
 * (Rec. ITU-R BT.601), so colour, haze, texture, seams and swaps count as much as they are seen.
 *
 * ssim is the mean structural similarity of Z. Wang, A. C. Bovik, H. R. Sheikh, E. P. Simoncelli,
 * "Image quality assessment: from error visibility to structural similarity", IEEE Transactions on
 * Image Processing 13(4), 2004: equations 13 to 17, windows of 11 x 11 pixels weighted by a
 * Gaussian of 1.5 pixels, every place where a window fits into the picture, K1 = 0.01, K2 = 0.03, L
 * = 255.
 */
#ifndef SIM_PICTURE_H
#define SIM_PICTURE_H

#include <stdint.h>

#define SIM_SSIM_WINDOW 11

typedef struct sim_picture_figures {
    double diff_mean, diff_p95; /* of the absolute difference, of 255 */
    double ssim;                /* 1: the same; NAN where no window fits */
} sim_picture_figures;

/* FF_OK or FF_ERR_MEMORY. */
int sim_picture_compare(const uint8_t *shown, const uint8_t *truth, unsigned width, unsigned height,
                        sim_picture_figures *figures);

#endif
