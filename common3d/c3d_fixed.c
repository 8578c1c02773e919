#include "c3d_fixed.h"
#include "c3d_assert.h"

#define EIGHTH_TURN (UINT32_C(1) << 29)
#define PI_Q32      UINT64_C(13493037705)

FF_STATIC_ASSERT(EIGHTH_TURN <= (UINT64_MAX - (UINT64_C(1) << 31)) / PI_Q32); /* radians_q31 */
FF_STATIC_ASSERT(UINT64_C(1) << 62 <= UINT64_MAX / 3); /* c3d_length64: three squares of 31 bits */

static int64_t round_q31(int64_t product) { return (product + (INT64_C(1) << 30)) >> 31; }

/* Taylor's polynomials over an eighth of a turn: x up to 0.786, so the first term left out is below
 * 2^-33 (sine: x^13/13!, cosine: x^12/12!). Coefficients are the reciprocal factorials in Q31; no
 * product exceeds 2^62. */
static int64_t polynomial(const int32_t *coefficient, int count, int64_t x2_q31)
{
    C3D_ASSERT(x2_q31 >= 0 && x2_q31 < INT64_C(1) << 31);
    int64_t sum = coefficient[0];
    for (int i = 1; i < count; i++) sum = coefficient[i] + round_q31(sum * x2_q31);
    return sum;
}

/* An angle of at most an eighth of a turn, in 2^-32 turn, to radians in Q31: times 2 pi, and half
 * of that because Q32 becomes Q31. */
static int64_t radians_q31(uint32_t angle)
{
    C3D_ASSERT(angle <= EIGHTH_TURN);
    return (int64_t)((angle * PI_Q32 + (UINT64_C(1) << 31)) >> 32);
}

static int64_t sine_q31(uint32_t angle)
{
    static const int32_t coefficient[] = { -54, 5918, -426089, 17895697, -357913941 };
    int64_t x = radians_q31(angle), x2 = round_q31(x * x);
    return x + round_q31(x * round_q31(polynomial(coefficient, 5, x2) * x2));
}

static int64_t cosine_q31(uint32_t angle)
{
    static const int32_t coefficient[] = { -592, 53261, -2982616, 89478485, -1073741824 };
    int64_t x = radians_q31(angle), x2 = round_q31(x * x);
    return (INT64_C(1) << 31) + round_q31(polynomial(coefficient, 5, x2) * x2);
}

int32_t c3d_sin_turn32_q30(uint32_t angle)
{
    uint32_t octant = angle >> 29, within = angle & (EIGHTH_TURN - 1);
    if (octant & 1) within = EIGHTH_TURN - within;
    int use_cosine = (octant + 1) & 2; /* octants 1, 2 and 5, 6 */
    int64_t value = ((use_cosine ? cosine_q31(within) : sine_q31(within)) + 1) >> 1;
    C3D_ASSERT(value >= 0 && value <= C3D_ONE_Q30);
    return (int32_t)(octant & 4 ? -value : value);
}

int32_t c3d_sin_q30(int32_t angle_brad16)
{
    return c3d_sin_turn32_q30((uint32_t)angle_brad16 << 16);
}

int32_t c3d_cos_q30(int32_t angle_brad16)
{
    return c3d_sin_turn32_q30(((uint32_t)angle_brad16 + 16384u) << 16);
}

static int leading_zeros(uint64_t n)
{
    C3D_ASSERT(n > 0);
#if defined(__GNUC__)
    return __builtin_clzll(n);
#else
    int count = 0;
    while (!(n >> 63)) n <<= 1, count++;
    return count;
#endif
}

static uint32_t upper(uint32_t a, uint32_t b) { return (uint32_t)(((uint64_t)a * b) >> 32); }

/* 1/sqrt(t) in Q30 for t in 1/4 .. 1, Q32. A line gives it within 9 %; three of Newton's steps, all
 * from below, bring it within 2^-13, 2^-24 and about 2^-26. */
static uint32_t reciprocal_root_q30(uint32_t t)
{
    C3D_ASSERT(t >= 1u << 30);
    uint32_t y = 2290055000u - upper(t, 1308600000u);
    for (int i = 0; i < 3; i++)
        y = (uint32_t)(((uint64_t)y * ((3u << 28) - upper(t, upper(y, y)))) >> 29);
    return y;
}

/* n * 1/sqrt(n) is off by about 2^7; the rest n - root^2 corrects that to a unit or two; the last
 * steps make it exact. */
uint32_t c3d_isqrt64(uint64_t value)
{
    if (value == 0) return 0;
    int half = leading_zeros(value) >> 1;
    uint64_t n = value << (2 * half);
    uint32_t top = (uint32_t)(n >> 32), y = reciprocal_root_q30(top);
    uint64_t root = ((uint64_t)top * y) >> 30;
    C3D_ASSERT(root >> 32 == 0); /* as y is too small */
    int64_t left = (int64_t)(n - root * root);
    root = (root + (uint64_t)(((left >> 10) * (int64_t)y) >> 53)) >> half; /* left/2 * y */
    if (root > UINT32_MAX) root = UINT32_MAX;
    while (root * root > value) root--;
    while (value - root * root > 2 * root) root++;
    return (uint32_t)root;
}

/* 1/d in Q31 for d in 1/2 .. 1, Q32. A line gives it within 1/17; three of Newton's steps, all from
 * below, bring it within 2^-29. */
static uint32_t reciprocal_q31(uint32_t d)
{
    C3D_ASSERT(d >> 31 == 1);
    uint32_t x = (3031741620u - upper(d, 2021161080u)) << 1;
    for (int i = 0; i < 3; i++) x = (uint32_t)(((uint64_t)x * ~upper(d, x)) >> 31);
    return x;
}

uint32_t c3d_divide_saturated(uint64_t a, uint64_t b)
{
    if (a >> 32 >= b) return UINT32_MAX;
    if (b >> 32) return (uint32_t)(a / b);
    int lead = leading_zeros(b) - 32;
    uint32_t reciprocal = reciprocal_q31((uint32_t)b << lead);
    uint64_t quotient = ((a << lead >> 32) * reciprocal) >> 31, left = a - quotient * b;
    C3D_ASSERT(left <= a && left >> 4 < b); /* too small by a few */
    for (; left >= b; left -= b) quotient++;
    return (uint32_t)quotient;
}

static uint64_t magnitude(int64_t value)
{
    return value < 0 ? 0 - (uint64_t)value : (uint64_t)value;
}

static void multiply128(uint64_t a, uint64_t b, uint64_t *high, uint64_t *low)
{
    uint64_t a0 = a & UINT32_MAX, a1 = a >> 32, b0 = b & UINT32_MAX, b1 = b >> 32;
    uint64_t middle = a1 * b0 + (a0 * b0 >> 32); /* at most (2^32-1)^2 + 2^32-1: no overflow */
    uint64_t middle2 = a0 * b1 + (middle & UINT32_MAX);
    *low = a * b;
    *high = a1 * b1 + (middle >> 32) + (middle2 >> 32);
}

/* (high:low) / divisor by long division; high < divisor, so the quotient has 64 bits. */
static uint64_t divide128(uint64_t high, uint64_t low, uint64_t divisor)
{
    uint64_t quotient = 0;
    C3D_ASSERT(high < divisor);
    for (int bit = 63; bit >= 0; bit--) {
        uint64_t carry = high >> 63;
        high = high << 1 | (low >> bit & 1);
        if (carry || high >= divisor) {
            high -= divisor;
            quotient |= UINT64_C(1) << bit;
        }
    }
    return quotient;
}

int64_t c3d_muldiv64(int64_t a, int64_t b, int64_t c)
{
    C3D_ASSERT(c != 0);
    int negative = (a < 0) ^ (b < 0) ^ (c < 0);
    uint64_t high, low, divisor = magnitude(c), quotient;
    multiply128(magnitude(a), magnitude(b), &high, &low);
    if (high >= divisor)
        quotient = UINT64_MAX;
    else
        quotient = high ? divide128(high, low, divisor) : low / divisor;
    if (quotient > INT64_MAX) return negative ? INT64_MIN : INT64_MAX;
    return negative ? -(int64_t)quotient : (int64_t)quotient;
}

int64_t c3d_length64(int64_t x, int64_t y, int64_t z)
{
    uint64_t a = magnitude(x), b = magnitude(y), c = magnitude(z), all = a | b | c;
    int shift = 0;
    /* three squares of 31 bits fit 64; 30 bits of precision stay */
    while (all >> shift >= UINT64_C(1) << 31) shift++;
    C3D_ASSERT(shift <= 64 - 31);
    a >>= shift;
    b >>= shift;
    c >>= shift;
    uint32_t a32 = (uint32_t)a, b32 = (uint32_t)b, c32 = (uint32_t)c;
    uint64_t length = c3d_isqrt64((uint64_t)a32 * a32 + (uint64_t)b32 * b32 + (uint64_t)c32 * c32);
    if (shift == 0) return (int64_t)length;
    if (length > (UINT64_C(1) << 62) >> shift) return INT64_C(1) << 62;
    return (int64_t)(length << shift);
}
