/* Arithmetic of map projections: numbers with 56 bits behind the point (_q56), below 128 either
 * way; angles are radians. Elementary functions turn a vector by angles of 2^-i (Volder 1959;
 * Walther 1971, "A unified algorithm for elementary functions"), shifts and sums alone, until what
 * is left is small enough for its square. Good to 2^-48, the same on every machine.
 */
#ifndef FF_GEO_MATH_H
#define FF_GEO_MATH_H

#include <stdint.h>

#define FF_GEO_ONE INT64_C(0x100000000000000)  /* 1 */
#define FF_GEO_PI  INT64_C(226375608064910089) /* half a turn */

/* a * b / 2^shift, rounded to the nearest; shift 1..126, and the result below 2^63. */
int64_t ff_geo_scale(int64_t a, int64_t b, unsigned shift);
/* a * 2^shift / b, rounded towards zero; b is not 0, shift 0..63, and the result below 2^63. */
int64_t ff_geo_ratio(int64_t a, int64_t b, unsigned shift);
static inline int64_t ff_geo_mul(int64_t a_q56, int64_t b_q56)
{
    return ff_geo_scale(a_q56, b_q56, 56);
}

/* Of angles below 32. */
void ff_geo_circle(int64_t angle_q56, int64_t *sine_q56, int64_t *cosine_q56);
/* The length of (x, y), each below 30, and its angle from the x axis towards y, -pi to pi. */
int64_t ff_geo_polar(int64_t x_q56, int64_t y_q56, int64_t *angle_q56);
/* Of |z| up to 1.1. */
void ff_geo_hyperbola(int64_t z_q56, int64_t *sinh_q56, int64_t *cosh_q56);
/* atanh(y / x), |y| up to 0.8 x, x from 2^-16 to 30. */
int64_t ff_geo_atanh(int64_t y_q56, int64_t x_q56);
/* Of up to 4; far below 0 it is 0. */
int64_t ff_geo_exp(int64_t x_q56);
/* Of what is above 0; 0 counts as the smallest number there is, and so does what is below. */
int64_t ff_geo_log(int64_t x_q56);

#endif
