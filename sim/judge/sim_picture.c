#include "sim_picture.h"

#include "../../protocol/ff_error.h"

#include <math.h>
#include <stdlib.h>

#define SIGMA_PX 1.5
#define C1       (0.01 * 255 * 0.01 * 255)
#define C2       (0.03 * 255 * 0.03 * 255)

/* What a window takes means of: x is the picture shown, y the truth. */
enum { X, Y, XX, YY, XY, MEANS };

static double luminance(const uint8_t *rgb)
{
    return 0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2];
}

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* ---- difference ---- */

static int compare_pixels(const uint8_t *shown, const uint8_t *truth, size_t count,
                          sim_picture_figures *figures)
{
    double *difference = malloc(count * sizeof *difference), sum = 0;
    if (!difference) return FF_ERR_MEMORY;
    for (size_t i = 0; i < count; i++) {
        difference[i] = fabs(luminance(shown + 3 * i) - luminance(truth + 3 * i));
        sum += difference[i];
    }
    qsort(difference, count, sizeof *difference, by_value);
    figures->diff_mean = sum / (double)count;
    figures->diff_p95 = difference[(count - 1) * 95 / 100];
    free(difference);
    return FF_OK;
}

/* ---- structural similarity ---- */

static void make_weights(double weight[SIM_SSIM_WINDOW])
{
    double sum = 0;
    for (int i = 0; i < SIM_SSIM_WINDOW; i++) {
        double away = i - SIM_SSIM_WINDOW / 2;
        weight[i] = exp(-away * away / (2 * SIGMA_PX * SIGMA_PX));
        sum += weight[i];
    }
    for (int i = 0; i < SIM_SSIM_WINDOW; i++) weight[i] /= sum;
}

/* Means down each column of the windows that begin in row `top`: the Gaussian is a product of
 * one down and one across. */
static void mean_columns(const uint8_t *shown, const uint8_t *truth, unsigned width, unsigned top,
                         const double weight[SIM_SSIM_WINDOW], double (*column)[MEANS])
{
    for (unsigned x = 0; x < width; x++) {
        double *mean = column[x];
        for (int i = 0; i < MEANS; i++) mean[i] = 0;
        for (unsigned i = 0; i < SIM_SSIM_WINDOW; i++) {
            size_t at = 3 * ((size_t)(top + i) * width + x);
            double a = luminance(shown + at), b = luminance(truth + at);
            mean[X] += weight[i] * a;
            mean[Y] += weight[i] * b;
            mean[XX] += weight[i] * a * a;
            mean[YY] += weight[i] * b * b;
            mean[XY] += weight[i] * a * b;
        }
    }
}

static double similarity(double (*const column)[MEANS], const double weight[SIM_SSIM_WINDOW])
{
    double mean[MEANS] = { 0 };
    for (unsigned i = 0; i < SIM_SSIM_WINDOW; i++)
        for (int which = 0; which < MEANS; which++) mean[which] += weight[i] * column[i][which];
    double xy = mean[X] * mean[Y], squares = mean[X] * mean[X] + mean[Y] * mean[Y];
    double covariance = mean[XY] - xy, variances = mean[XX] + mean[YY] - squares;
    return (2 * xy + C1) * (2 * covariance + C2) / ((squares + C1) * (variances + C2));
}

static int compare_structure(const uint8_t *shown, const uint8_t *truth, unsigned width,
                             unsigned height, sim_picture_figures *figures)
{
    double weight[SIM_SSIM_WINDOW], sum = 0;
    figures->ssim = NAN;
    if (width < SIM_SSIM_WINDOW || height < SIM_SSIM_WINDOW) return FF_OK;
    double(*column)[MEANS] = malloc(width * sizeof *column);
    if (!column) return FF_ERR_MEMORY;
    make_weights(weight);
    unsigned across = width - SIM_SSIM_WINDOW + 1, down = height - SIM_SSIM_WINDOW + 1;
    for (unsigned y = 0; y < down; y++) {
        mean_columns(shown, truth, width, y, weight, column);
        for (unsigned x = 0; x < across; x++) sum += similarity(column + x, weight);
    }
    figures->ssim = sum / across / down;
    free(column);
    return FF_OK;
}

int sim_picture_compare(const uint8_t *shown, const uint8_t *truth, unsigned width, unsigned height,
                        sim_picture_figures *figures)
{
    int rc = compare_pixels(shown, truth, (size_t)width * height, figures);
    return rc == FF_OK ? compare_structure(shown, truth, width, height, figures) : rc;
}
