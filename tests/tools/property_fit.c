#include "property_fit.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define UNKNOWNS    8
#define SAMPLES_MIN 300
#define WIDTH       (2 * UNKNOWNS + 1) /* the matrix, the right side, and what becomes the inverse */

/* Gauss-Jordan with pivots; -1 where the samples do not tell all unknowns apart. */
static int solve(double m[UNKNOWNS][WIDTH])
{
    for (int c = 0; c < UNKNOWNS; c++) {
        int best = c;
        for (int r = c; r < UNKNOWNS; r++)
            if (fabs(m[r][c]) > fabs(m[best][c])) best = r;
        for (int k = 0; k < WIDTH; k++) {
            double swap = m[c][k];
            m[c][k] = m[best][k];
            m[best][k] = swap;
        }
        if (m[c][c] == 0) return -1;
        for (int r = 0; r < UNKNOWNS; r++) {
            double factor = r == c ? 0 : m[r][c] / m[c][c];
            for (int k = c; k < WIDTH; k++) m[r][k] -= factor * m[c][k];
        }
    }
    return 0;
}

typedef struct grid {
    const double *height, *wanted;
    uint32_t columns, rows;
    double mean_m;
} grid;

/* One sample's equation: height - wanted = bias + gain * wanted + gradient . (shift + M . place).
 */
static int equation(const grid *g, uint32_t i, uint32_t j, double *row)
{
    const double *w = g->wanted + (size_t)j * g->columns + i;
    double x = i - (g->columns - 1) / 2.0, y = j - (g->rows - 1) / 2.0;
    double gx = (w[1] - w[-1]) / 2, gy = (w[g->columns] - w[-(ptrdiff_t)g->columns]) / 2;
    double all[UNKNOWNS + 1] = { 1,
                                 gx,
                                 gy,
                                 gx * x,
                                 gx * y,
                                 gy * x,
                                 gy * y,
                                 w[0] - g->mean_m,
                                 g->height[(size_t)j * g->columns + i] - w[0] };
    memcpy(row, all, sizeof all);
    return !isnan(gx + gy + all[UNKNOWNS]);
}

static double mean_of(const double *wanted, size_t count)
{
    double sum = 0;
    size_t known = 0;
    for (size_t n = 0; n < count; n++)
        if (!isnan(wanted[n])) sum += wanted[n], known++;
    return known ? sum / (double)known : 0;
}

/* What was found, and its standard deviations: roots of the inverse's diagonal. */
static void take_found(double m[UNKNOWNS][WIDTH], property_fit *fit)
{
    double found[UNKNOWNS], sd[UNKNOWNS];
    for (int r = 0; r < UNKNOWNS; r++) {
        found[r] = m[r][UNKNOWNS] / m[r][r];
        sd[r] = sqrt(fabs(m[r][UNKNOWNS + 1 + r] / m[r][r]));
    }
    fit->shift = hypot(found[1], found[2]);
    fit->scale = fmax(fabs(found[3]), fabs(found[6]));
    fit->rotation = fmax(fabs(found[4]), fabs(found[5]));
    fit->gain = fabs(found[7]);
    fit->shift_sd = hypot(sd[1], sd[2]);
    fit->scale_sd = fmax(fmax(sd[3], sd[4]), fmax(sd[5], sd[6]));
    fit->gain_sd = sd[7];
}

int property_fit_grid(const double *height, const double *wanted, uint32_t columns, uint32_t rows,
                      property_fit *fit)
{
    grid g = { height, wanted, columns, rows, mean_of(wanted, (size_t)columns * rows) };
    double m[UNKNOWNS][WIDTH] = { { 0 } }, row[UNKNOWNS + 1];
    *fit = (property_fit){ 0 };
    for (uint32_t j = 1; j + 1 < rows; j++)
        for (uint32_t i = 1; i + 1 < columns; i++) {
            if (!equation(&g, i, j, row)) continue;
            fit->samples++;
            fit->error_m = fmax(fit->error_m, fabs(row[UNKNOWNS]));
            fit->rms_m += row[UNKNOWNS] * row[UNKNOWNS];
            fit->bias_m += row[UNKNOWNS];
            for (int r = 0; r < UNKNOWNS; r++)
                for (int c = 0; c <= UNKNOWNS; c++) m[r][c] += row[r] * row[c];
        }
    if (fit->samples) fit->tilt_m = hypot(m[0][1], m[0][2]) / fit->samples;
    for (int r = 0; r < UNKNOWNS; r++) m[r][UNKNOWNS + 1 + r] = 1;
    if (fit->samples < SAMPLES_MIN || solve(m)) return -1;
    fit->bias_m /= fit->samples;
    fit->rms_m = sqrt(fit->rms_m / fit->samples);
    take_found(m, fit);
    return 0;
}
