#include "ff_geo_project.h"

#include "../ff_assert.h"
#include "../ff_error.h"
#include "ff_geo_math.h"

#define QUARTER       (FF_GEO_PI / 2)
#define BAND_MAX      FF_GEO_ONE                 /* of a transverse plane, either side */
#define TANH_MAX      INT64_C(54878642511518883) /* tanh 1 */
#define ALONG_MAX     (3 * FF_GEO_ONE)           /* from the equator over a pole and beyond */
#define ISOMETRIC_MAX (FF_GEO_ONE / 2 * 9)       /* of Mercator's plane: 88.7 degrees */
#define POLE_MAX      (FF_GEO_PI / 18 * 17)      /* of a cone: from its pole */
#define SLIT          (FF_GEO_ONE >> 30)         /* of a cone laid flat: angles are not exact */
#define CONE_MAX      (FF_GEO_ONE * 30)

/* ---- series ---- */

/* coefficient[k] of row k is the sum of number / divisor * n^power, powers from k + 1 to 4. */
typedef struct term {
    int32_t number, divisor;
} term;
/* clang-format off */
static const term conformal[10] = { { -2, 1 }, { 2, 3 }, { 4, 3 }, { -82, 45 },
                                    { 5, 3 }, { -16, 15 }, { -13, 9 },
                                    { -26, 15 }, { 34, 21 },
                                    { 1237, 630 } },
                  geographic[10] = { { 2, 1 }, { -2, 3 }, { -2, 1 }, { 116, 45 },
                                     { 7, 3 }, { -8, 5 }, { -227, 45 },
                                     { 56, 15 }, { -136, 35 },
                                     { 4279, 630 } },
                  plane[10] = { { 1, 2 }, { -2, 3 }, { 5, 16 }, { 41, 180 },
                                { 13, 48 }, { -3, 5 }, { 557, 1440 },
                                { 61, 240 }, { -103, 140 },
                                { 49561, 161280 } },
                  sphere[10] = { { -1, 2 }, { 2, 3 }, { -37, 96 }, { 1, 360 },
                                 { -1, 48 }, { -1, 15 }, { 437, 1440 },
                                 { -17, 480 }, { 37, 840 },
                                 { -4397, 161280 } };
/* clang-format on */

static void sum_up(const term *from, const int64_t power[4], int64_t coefficient[4])
{
    FF_ASSERT(power[0] >= power[1] && power[1] >= power[2] && power[2] >= power[3]);
    for (int k = 0; k < 4; k++) {
        coefficient[k] = 0;
        for (int i = k; i < 4; i++, from++)
            coefficient[k] += power[i] * from->number / from->divisor;
    }
}

void ff_geo_flatten(ff_geo *geo, int64_t n)
{
    int64_t power[4] = { n };
    FF_ASSERT(n >= 0 && n < FF_GEO_ONE / 100);
    for (int i = 1; i < 4; i++) power[i] = ff_geo_mul(power[i - 1], n);
    sum_up(conformal, power, geo->conformal);
    sum_up(geographic, power, geo->geographic);
    sum_up(plane, power, geo->plane);
    sum_up(sphere, power, geo->sphere);
}

/* Adds to z = (x, y), a complex number, the sum of c[k] sin(2 (k + 1) z), by Clenshaw's recurrence;
 * |y| up to 1. */
static void add_series(const int64_t c[4], int64_t *x, int64_t *y)
{
    int64_t sine, cosine, sinh, cosh, b[3][2] = { { 0 } };
    FF_ASSERT(c[0] < FF_GEO_ONE / 32 && c[0] > -FF_GEO_ONE / 32); /* a correction */
    ff_geo_circle(2 * *x, &sine, &cosine);
    ff_geo_hyperbola(*y, &sinh, &cosh);
    int64_t sinh2 = 2 * ff_geo_mul(sinh, cosh), cosh2 = FF_GEO_ONE + 2 * ff_geo_mul(sinh, sinh);
    int64_t re = 2 * ff_geo_mul(cosine, cosh2), im = -2 * ff_geo_mul(sine, sinh2);
    for (int k = 3; k >= 0; k--) {
        for (int i = 0; i < 2; i++) {
            b[2][i] = b[1][i];
            b[1][i] = b[0][i];
        }
        b[0][0] = c[k] + ff_geo_mul(re, b[1][0]) - ff_geo_mul(im, b[1][1]) - b[2][0];
        b[0][1] = ff_geo_mul(re, b[1][1]) + ff_geo_mul(im, b[1][0]) - b[2][1];
    }
    re = ff_geo_mul(sine, cosh2);
    im = ff_geo_mul(cosine, sinh2);
    *x += ff_geo_mul(re, b[0][0]) - ff_geo_mul(im, b[0][1]);
    *y += ff_geo_mul(re, b[0][1]) + ff_geo_mul(im, b[0][0]);
}

int64_t ff_geo_conformal(const ff_geo *geo, int64_t latitude)
{
    int64_t none = 0;
    FF_ASSERT(latitude <= QUARTER && latitude >= -QUARTER);
    add_series(geo->conformal, &latitude, &none);
    return latitude;
}

/* ---- transverse: the sphere's own plane, bent by a series of complex numbers ---- */

static int to_transverse(const ff_geo *geo, int64_t latitude, int64_t longitude, int64_t xy[2])
{
    int64_t sine, cosine, aside, ahead;
    FF_ASSERT(longitude <= 2 * FF_GEO_PI && longitude >= -2 * FF_GEO_PI);
    ff_geo_circle(latitude, &sine, &cosine);
    ff_geo_circle(longitude, &aside, &ahead);
    aside = ff_geo_mul(aside, cosine);
    ahead = ff_geo_mul(ahead, cosine);
    if (aside > TANH_MAX || aside < -TANH_MAX) return FF_ERR_RANGE;
    (void)ff_geo_polar(ahead, sine, &xy[1]);
    xy[0] = ff_geo_atanh(aside, FF_GEO_ONE);
    add_series(geo->plane, &xy[1], &xy[0]);
    return FF_OK;
}

static int from_transverse(const ff_geo *geo, const int64_t xy[2], int64_t *latitude,
                           int64_t *longitude)
{
    int64_t x = xy[0], y = xy[1], sine, cosine, sinh, cosh;
    if (x > BAND_MAX || x < -BAND_MAX || y > ALONG_MAX || y < -ALONG_MAX) return FF_ERR_RANGE;
    add_series(geo->sphere, &y, &x);
    ff_geo_circle(y, &sine, &cosine);
    ff_geo_hyperbola(x, &sinh, &cosh);
    (void)ff_geo_polar(ff_geo_polar(cosine, sinh, longitude), sine, latitude);
    return FF_OK;
}

/* ---- Mercator, and cones, by t ---- */

/* tan of half the angle to the north pole, 2^-56 at least. */
static int64_t t_of(int64_t conformal_latitude)
{
    int64_t sine, cosine;
    ff_geo_circle((QUARTER - conformal_latitude) / 2, &sine, &cosine);
    FF_ASSERT(cosine > 0);
    return sine > 0 ? ff_geo_ratio(sine, cosine, 56) : 1;
}

static int64_t latitude_of_t(int64_t t)
{
    int64_t half;
    FF_ASSERT(t >= -16); /* the length of nothing may round to less */
    (void)ff_geo_polar(FF_GEO_ONE, t, &half);
    return QUARTER - 2 * half;
}

int64_t ff_geo_log_t(int64_t conformal_latitude) { return ff_geo_log(t_of(conformal_latitude)); }

static int to_mercator(int64_t latitude, int64_t longitude, int64_t xy[2])
{
    int64_t north = latitude < 0 ? -latitude : latitude, isometric = -ff_geo_log_t(north);
    if (isometric > ISOMETRIC_MAX) return FF_ERR_RANGE;
    xy[0] = longitude;
    xy[1] = latitude < 0 ? -isometric : isometric;
    return FF_OK;
}

static int from_mercator(const int64_t xy[2], int64_t *latitude, int64_t *longitude)
{
    int64_t x = xy[0], y = xy[1], isometric = y < 0 ? -y : y;
    if (isometric > ISOMETRIC_MAX || x > 3 * FF_GEO_PI || x < -3 * FF_GEO_PI) return FF_ERR_RANGE;
    int64_t north = latitude_of_t(ff_geo_exp(-isometric));
    *latitude = y < 0 ? -north : north;
    *longitude = x;
    return FF_OK;
}

/* t to the power of n, or 0 beyond what a cone shows. */
static int64_t cone_distance(const ff_geo *geo, int64_t t)
{
    FF_ASSERT(t > 0 && geo->cone_q56 > 0);
    if (geo->cone_q56 == FF_GEO_ONE) return t;
    return ff_geo_exp(ff_geo_mul(ff_geo_log(t), geo->cone_q56));
}

static int to_cone(const ff_geo *geo, int64_t latitude, int64_t longitude, int64_t xy[2])
{
    int64_t sine, cosine;
    if (QUARTER - latitude > POLE_MAX) return FF_ERR_RANGE;
    int64_t distance = cone_distance(geo, t_of(latitude));
    if (!distance) return FF_ERR_RANGE;
    ff_geo_circle(ff_geo_mul(longitude, geo->cone_q56), &sine, &cosine);
    xy[0] = ff_geo_mul(distance, sine);
    xy[1] = -ff_geo_mul(distance, cosine);
    return FF_OK;
}

static int from_cone(const ff_geo *geo, const int64_t xy[2], int64_t *latitude, int64_t *longitude)
{
    int64_t turned, t, half_turn = ff_geo_mul(FF_GEO_PI, geo->cone_q56) + SLIT;
    for (int axis = 0; axis < 2; axis++)
        if (xy[axis] > CONE_MAX / 2 || xy[axis] < -CONE_MAX / 2) return FF_ERR_RANGE;
    t = ff_geo_polar(-xy[1], xy[0], &turned);
    int has_slit = geo->cone_q56 < FF_GEO_ONE;
    if (has_slit && (turned > half_turn || turned < -half_turn)) return FF_ERR_RANGE;
    if (has_slit) {
        int64_t power = ff_geo_mul(ff_geo_log(t), geo->per_cone_q56);
        if (power > 3 * FF_GEO_ONE) return FF_ERR_RANGE;
        t = ff_geo_exp(power);
    }
    *latitude = latitude_of_t(t);
    *longitude = ff_geo_mul(turned, geo->per_cone_q56);
    return FF_OK;
}

/* ---- all ---- */

int ff_geo_project(const ff_geo *geo, int64_t latitude, int64_t longitude, int64_t xy[2])
{
    int64_t conformal_latitude = ff_geo_conformal(geo, geo->south ? -latitude : latitude);
    int rc = FF_ERR_UNSUPPORTED;
    switch (geo->kind) {
        case FF_GEO_MERCATOR: rc = to_mercator(conformal_latitude, longitude, xy); break;
        case FF_GEO_TRANSVERSE: rc = to_transverse(geo, conformal_latitude, longitude, xy); break;
        case FF_GEO_CONE: rc = to_cone(geo, conformal_latitude, longitude, xy); break;
    }
    if (rc == FF_OK && geo->south) xy[1] = -xy[1];
    return rc;
}

int ff_geo_unproject(const ff_geo *geo, const int64_t xy[2], int64_t *latitude, int64_t *longitude)
{
    FF_ASSERT(geo->radius_um > 0);
    const int64_t north[2] = { xy[0], geo->south ? -xy[1] : xy[1] };
    int64_t none = 0;
    int rc = FF_ERR_UNSUPPORTED;
    switch (geo->kind) {
        case FF_GEO_MERCATOR: rc = from_mercator(north, latitude, longitude); break;
        case FF_GEO_TRANSVERSE: rc = from_transverse(geo, north, latitude, longitude); break;
        case FF_GEO_CONE: rc = from_cone(geo, north, latitude, longitude); break;
    }
    if (rc != FF_OK) return rc;
    add_series(geo->geographic, latitude, &none);
    if (geo->south) *latitude = -*latitude;
    FF_ASSERT(*latitude <= QUARTER + 65536 && *latitude >= -QUARTER - 65536);
    return FF_OK;
}
