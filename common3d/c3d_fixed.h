/* Fixed-point arithmetic of the core. Fraction bits are in the names: _q8, _q16, _q30.
 * Angles are int32_t in 1/65536 turn ("brad16"), any value, wrapping. No function overflows for the
 * ranges it states.
 */
#ifndef C3D_FIXED_H
#define C3D_FIXED_H

#include <stdint.h>

#define C3D_ONE_Q30 (1 << 30)

int32_t c3d_sin_q30(int32_t angle_brad16); /* within 2 units of 2^-30 */
int32_t c3d_cos_q30(int32_t angle_brad16);
/* the same of angles in 2^-32 turn: no steps between neighbouring angles */
int32_t c3d_sin_turn32_q30(uint32_t angle);
uint32_t c3d_isqrt64(uint64_t value); /* floor of the square root */
/* a * b >> shift with 64-bit intermediate, rounding towards minus infinity; |a*b| must be below
 * 2^63 */
static inline int32_t c3d_mul_q30(int32_t a, int32_t b)
{
    return (int32_t)(((int64_t)a * b) >> 30);
}
/* a * b / c, rounded towards zero, 128-bit safe intermediate, saturated to int64; c != 0 */
int64_t c3d_muldiv64(int64_t a, int64_t b, int64_t c);
/* a / b rounded down, at most UINT32_MAX; b = 0 counts as infinitely small. Fast where b fits 32
 * bits. */
uint32_t c3d_divide_saturated(uint64_t a, uint64_t b);
/* Length of a vector of int64 components, each |.| < 2^40; saturates at 2^62. */
int64_t c3d_length64(int64_t x, int64_t y, int64_t z);

#endif
