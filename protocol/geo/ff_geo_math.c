#include "ff_geo_math.h"

#include "../ff_assert.h"

#define TURNS 20
#define LN2   INT64_C(49946518145322874)

/* atan(2^-i), and atanh(2^-i) from i = 1 on */
static const int64_t turn[2][TURNS] = {
    { 56593902016227522, 33409331186036030, 17652573055549883, 8960721713639278, 4497749271019253,
      2251067235130761,  1125808294293075,  562938500594601,   281473545067998,  140737309398767,
      70368721808055,    35184369292630,    17592185694891,    8796092978517,    4398046505643,
      2199023254869,     1099511627691,     549755813877,      274877906943,     137438953472 },
    { 0,
      39581679150962773,
      18404432710750535,
      9054556524469743,
      4509477471745453,
      2252533251233649,
      1125991546235719,
      562961407086883,
      281476408379529,
      140737667312708,
      70368766547298,
      35184374885035,
      17592186393941,
      8796093065899,
      4398046516565,
      2199023256235,
      1099511627861,
      549755813899,
      274877906945,
      137438953472 }
};
/* What all turns together make of a vector's length: it begins, or ends, that much shorter. */
static const int64_t shrink[2] = { 43757185469236734, 87009333510807055 };

/* ---- products and quotients of 128 bits ---- */

static uint64_t magnitude(int64_t a) { return a < 0 ? 0 - (uint64_t)a : (uint64_t)a; }
static int64_t with_sign(uint64_t a, int negative) { return negative ? -(int64_t)a : (int64_t)a; }

int64_t ff_geo_scale(int64_t a, int64_t b, unsigned shift)
{
    const uint64_t half = 0xffffffffu, x = magnitude(a), y = magnitude(b);
    uint64_t low = (x & half) * (y & half), middle = (x >> 32) * (y & half) + (low >> 32),
             other = (x & half) * (y >> 32) + (middle & half),
             high = (x >> 32) * (y >> 32) + (middle >> 32) + (other >> 32), twice;
    FF_ASSERT(shift >= 1 && shift <= 126);
    low = other << 32 | (low & half);
    if (shift > 64)
        twice = high >> (shift - 65);
    else
        twice = shift == 1 ? low : high << (65 - shift) | low >> (shift - 1);
    FF_ASSERT(shift <= 64 ? high >> (shift - 1) == 0 : 1); /* the result's own 64 bits */
    return with_sign((twice >> 1) + (twice & 1), (a < 0) != (b < 0));
}

int64_t ff_geo_ratio(int64_t a, int64_t b, unsigned shift)
{
    const uint64_t x = magnitude(a), y = magnitude(b);
    FF_ASSERT(y && shift < 64);
    uint64_t quotient = x / y, rest = x % y;
    while (shift--) {
        rest <<= 1;
        quotient <<= 1;
        if (rest < y) continue;
        rest -= y;
        quotient |= 1;
    }
    return with_sign(quotient, (a < 0) != (b < 0));
}

/* ---- turning ---- */

typedef struct vector {
    int64_t x, y, z;
} vector;

/* Turns (x, y) on a circle, or moves it along a hyperbola, by z, which becomes 0; `inverse`: until
 * y is 0, and z becomes greater by as much. Some steps along a hyperbola are made twice, for all of
 * those after together fall short of them. What is left is less than 2^-19: its cube is nothing. */
static void take_turns(vector *v, int hyperbolic, int inverse)
{
    int64_t x = v->x, y = v->y, z = v->z;
    FF_ASSERT(hyperbolic == 0 || hyperbolic == 1);
    for (int i = hyperbolic, again = 0; i < TURNS; i += !again) {
        int64_t dx = hyperbolic ? -(y >> i) : y >> i, dy = x >> i;
        if (inverse ? y > 0 : z < 0) {
            x += dx;
            y -= dy;
            z += turn[hyperbolic][i];
        } else {
            x -= dx;
            y += dy;
            z -= turn[hyperbolic][i];
        }
        again = hyperbolic && !again && (i == 4 || i == 13);
    }
    int64_t rest = inverse ? 0 : z, sign = hyperbolic ? 1 : -1;
    /* a vector of a few units has no direction */
    if (inverse && x >> 16 > (y < 0 ? -y : y)) rest = -ff_geo_ratio(y, x, 56);
    int64_t square = ff_geo_mul(rest, rest) / 2;
    v->x = x + sign * (ff_geo_mul(y, rest) + ff_geo_mul(x, square));
    v->y = y + ff_geo_mul(x, rest) + sign * ff_geo_mul(y, square);
    v->z = z - rest;
}

void ff_geo_circle(int64_t angle, int64_t *sine, int64_t *cosine)
{
    int64_t quarters = angle / (FF_GEO_PI / 4);
    FF_ASSERT(magnitude(angle) < (uint64_t)FF_GEO_ONE * 32);
    quarters = (quarters + (angle < 0 ? -1 : 1)) / 2;
    vector v = { shrink[0], 0, angle - quarters * FF_GEO_PI / 2 };
    take_turns(&v, 0, 0);
    FF_ASSERT(v.x > 0); /* less than a quarter is left */
    *sine = quarters & 1 ? v.x : v.y;
    *cosine = quarters & 1 ? -v.y : v.x;
    if (quarters & 2) {
        *sine = -*sine;
        *cosine = -*cosine;
    }
}

int64_t ff_geo_polar(int64_t x, int64_t y, int64_t *angle)
{
    vector v = { x, y, 0 };
    FF_ASSERT(magnitude(x) < (uint64_t)FF_GEO_ONE * 30 && magnitude(y) < (uint64_t)FF_GEO_ONE * 30);
    if (x < 0) v = (vector){ -x, -y, y < 0 ? -FF_GEO_PI : FF_GEO_PI };
    take_turns(&v, 0, 1);
    FF_ASSERT(v.x >= -TURNS); /* rounding alone is left of nothing */
    *angle = v.z;
    return ff_geo_mul(v.x, shrink[0]);
}

void ff_geo_hyperbola(int64_t z, int64_t *sinh, int64_t *cosh)
{
    vector v = { shrink[1], 0, z };
    FF_ASSERT(magnitude(z) <= (uint64_t)FF_GEO_ONE / 10 * 11);
    take_turns(&v, 1, 0);
    FF_ASSERT(v.x > 0 && magnitude(v.y) < magnitude(v.x));
    *sinh = v.y;
    *cosh = v.x;
}

int64_t ff_geo_atanh(int64_t y, int64_t x)
{
    vector v = { x, y, 0 };
    FF_ASSERT(x > 0 && magnitude(y) / 4 <= magnitude(x) / 5);
    take_turns(&v, 1, 1);
    return v.z;
}

int64_t ff_geo_exp(int64_t x)
{
    int64_t sinh, cosh, halves = x / LN2;
    FF_ASSERT(x <= 4 * FF_GEO_ONE);
    ff_geo_hyperbola(x - halves * LN2, &sinh, &cosh);
    if (halves < 0) return halves < -62 ? 0 : (sinh + cosh) >> -halves;
    return (sinh + cosh) << halves;
}

int64_t ff_geo_log(int64_t x)
{
    int64_t doublings = 0;
    if (x < 1) x = 1;
    for (; x >= FF_GEO_ONE / 2 * 3; doublings++) x = (x + 1) >> 1;
    for (; x < FF_GEO_ONE / 4 * 3; doublings--) x <<= 1;
    FF_ASSERT(doublings >= -57 && doublings < 8);
    return 2 * ff_geo_atanh(x - FF_GEO_ONE, x + FF_GEO_ONE) + doublings * LN2;
}
