#include "ff_geo.h"

#include "../ff_assert.h"
#include "../ff_error.h"
#include "ff_geo_math.h"
#include "ff_geo_project.h"

#define DEGREE_E9     INT64_C(1000000000)
#define FACTOR        INT64_C(1000000000000)       /* 1, as parameters have it */
#define RADIANS       INT64_C(5531169184716246338) /* in 10^-9 degree, times 2^98 */
#define NANODEGREES   INT64_C(7690109350234855385) /* in a radian, times 2^27 */
#define BRAD16        INT64_C(44798133900177)      /* in a radian, times 2^32 */
#define RADIUS_MIN    (INT64_C(1) << 39)           /* micrometres */
#define RADIUS_MAX    (INT64_C(1) << 46)
#define UNIT_MAX      (INT64_C(1) << 48) /* of a plane: of a cone much larger than the ellipsoid */
#define STANDARD_MAX  (FF_GEO_PI / 180 * 89) /* of a standard parallel */
#define SAME_PARALLEL (FF_GEO_ONE >> 20)
#define FAR_UNITS     32 /* from its own origin to the world's */
#define INVERSE_MIN   (100 * DEGREE_E9)
#define LENGTH_MAX    (INT64_C(1) << 50) /* micrometres: a million kilometres */
#define NORTH_E9      (DEGREE_E9 / 1000) /* how far a look to the north goes: 111 m */
#define UM_PER_WU_Q2  15625              /* 1/256 m is 15625 / 4 micrometres */

/* EPSG's codes. */
enum {
    TRANSVERSE_MERCATOR = 9807,
    MERCATOR_A = 9804,
    MERCATOR_B = 9805,
    MERCATOR_WEB = 1024,
    LAMBERT_1SP = 9801,
    LAMBERT_2SP = 9802,
    STEREOGRAPHIC_A = 9810,
    STEREOGRAPHIC_B = 9829
};
enum {
    LATITUDE = 8801,
    LONGITUDE = 8802,
    SCALE = 8805,
    EASTING = 8806,
    NORTHING = 8807,
    FALSE_LATITUDE = 8821,
    FALSE_LONGITUDE = 8822,
    PARALLEL_1 = 8823,
    PARALLEL_2 = 8824,
    FALSE_EASTING = 8826,
    FALSE_NORTHING = 8827,
    POLAR_PARALLEL = 8832,
    POLAR_LONGITUDE = 8833
};

static int64_t radians(int64_t degrees_e9) { return ff_geo_scale(degrees_e9, RADIANS, 42); }
static int64_t degrees_e9(int64_t angle) { return ff_geo_scale(angle, NANODEGREES, 83); }

/* ---- making ready ---- */

typedef struct maker {
    const ff_about_projection *projection;
    ff_geo *geo;
    int64_t e2;                /* eccentricity, squared */
    int64_t east_um, north_um; /* of the world's origin, from the plane's false origin */
} maker;

/* A parameter's value, `fallback` where it is missing. */
static int64_t value_of(const maker *m, unsigned code, int64_t fallback)
{
    int64_t value;
    for (uint32_t i = 0; i < m->projection->parameter_count; i++)
        if (ff_about_parameter(m->projection, i, &value) == code) return value;
    return fallback;
}

static int is_within(int64_t value, int64_t low, int64_t high)
{
    return value >= low && value <= high;
}

/* An angle, of a cone's own half of the Earth. */
static int latitude_of(const maker *m, unsigned code, int64_t *latitude)
{
    int64_t value = value_of(m, code, 0);
    if (!is_within(value, -90 * DEGREE_E9, 90 * DEGREE_E9)) return FF_ERR_RANGE;
    *latitude = radians(m->geo->south ? -value : value);
    return FF_OK;
}

/* The radius of a parallel, in those of the equator. */
static int64_t parallel_radius(const maker *m, int64_t latitude)
{
    int64_t sine, cosine;
    FF_ASSERT(m->e2 >= 0 && m->e2 < FF_GEO_ONE / 16);
    ff_geo_circle(latitude, &sine, &cosine);
    int64_t bulge = FF_GEO_ONE - ff_geo_mul(m->e2, ff_geo_mul(sine, sine));
    return ff_geo_mul(cosine, ff_geo_exp(-ff_geo_log(bulge) / 2));
}

static int64_t log_t(const maker *m, int64_t latitude)
{
    return ff_geo_log_t(ff_geo_conformal(m->geo, latitude));
}

/* Sets the unit of the plane to so many radii of the equator. */
static int set_unit(const maker *m, int64_t radii)
{
    ff_geo *geo = m->geo;
    if (radii < FF_GEO_ONE / 64 || radii > 64 * FF_GEO_ONE) return FF_ERR_RANGE;
    geo->radius_um = ff_geo_scale(m->projection->semi_major_um, radii, 56);
    if (!is_within(geo->radius_um, RADIUS_MIN, UNIT_MAX)) return FF_ERR_RANGE;
    geo->per_radius = ff_geo_ratio(FF_GEO_ONE, geo->radius_um, 44);
    return FF_OK;
}

static int64_t scale_of(const maker *m)
{
    int64_t scale = value_of(m, SCALE, FACTOR);
    return is_within(scale, FACTOR / 2, 2 * FACTOR) ? ff_geo_ratio(scale, FACTOR, 56) : 0;
}

/* Sets where the world's origin lies; the plane's false origin lies `north` units from its own. */
static int set_origin(const maker *m, int64_t north)
{
    ff_geo *geo = m->geo;
    const int64_t most = FAR_UNITS * geo->radius_um;
    FF_ASSERT(geo->radius_um >= RADIUS_MIN && geo->radius_um <= UNIT_MAX);
    geo->east_um = m->east_um;
    geo->north_um = m->north_um + ff_geo_scale(north, geo->radius_um, 56);
    return is_within(geo->east_um, -most, most) && is_within(geo->north_um, -most, most)
               ? FF_OK
               : FF_ERR_RANGE;
}

/* The meridian's length, in radii, of that ellipsoid to those of the equator: (1 + n^2/4 + n^4/64)
 * / (1 + n). */
static int64_t meridian_radius(int64_t n)
{
    int64_t n2 = ff_geo_mul(n, n);
    FF_ASSERT(n >= 0 && n < FF_GEO_ONE / 100);
    return ff_geo_ratio(FF_GEO_ONE + n2 / 4 + ff_geo_mul(n2, n2) / 64, FF_GEO_ONE + n, 56);
}

static int make_transverse(const maker *m, int64_t n)
{
    int64_t latitude, origin[2];
    int rc = latitude_of(m, LATITUDE, &latitude);
    m->geo->kind = FF_GEO_TRANSVERSE;
    if (rc == FF_OK) rc = set_unit(m, ff_geo_mul(scale_of(m), meridian_radius(n)));
    if (rc == FF_OK) rc = ff_geo_project(m->geo, latitude, 0, origin);
    if (rc == FF_OK) rc = set_origin(m, origin[1]);
    return rc;
}

static int make_mercator(const maker *m)
{
    int64_t parallel = 0, unit;
    int rc = latitude_of(m, PARALLEL_1, &parallel);
    m->geo->kind = FF_GEO_MERCATOR;
    if (value_of(m, LATITUDE, 0)) return FF_ERR_UNSUPPORTED;
    if (m->projection->method == MERCATOR_WEB) ff_geo_flatten(m->geo, 0);
    unit = m->projection->method == MERCATOR_B ? parallel_radius(m, parallel) : scale_of(m);
    if (rc == FF_OK) rc = set_unit(m, unit);
    if (rc == FF_OK) rc = set_origin(m, 0);
    return rc;
}

/* `radii`: of the equator, how far from the pole the plane shows where t is 1; its false origin is
 * at `false_latitude`. */
static int make_cone(const maker *m, int64_t cone, int64_t radii, int64_t false_latitude)
{
    ff_geo *geo = m->geo;
    int64_t origin[2] = { 0, 0 };
    if (cone < FF_GEO_ONE / 32 || cone > FF_GEO_ONE) return FF_ERR_RANGE;
    geo->kind = FF_GEO_CONE;
    geo->cone_q56 = cone;
    geo->per_cone_q56 = ff_geo_ratio(FF_GEO_ONE, cone, 56);
    int rc = set_unit(m, radii), at_pole = false_latitude >= FF_GEO_PI / 2;
    if (rc == FF_OK && !at_pole)
        rc = ff_geo_project(geo, geo->south ? -false_latitude : false_latitude, 0, origin);
    if (rc == FF_OK) rc = set_origin(m, origin[1]);
    return rc;
}

static int make_lambert(const maker *m)
{
    int two = m->projection->method == LAMBERT_2SP;
    int64_t from, first, second, base, unit, scale = two ? FF_GEO_ONE : scale_of(m), cone, cosine;
    const unsigned parallel[2] = { two ? PARALLEL_1 : LATITUDE, two ? PARALLEL_2 : LATITUDE };
    m->geo->south = value_of(m, parallel[0], 0) / 2 + value_of(m, parallel[1], 0) / 2 < 0;
    if (latitude_of(m, two ? FALSE_LATITUDE : LATITUDE, &from) ||
        latitude_of(m, parallel[0], &first) || latitude_of(m, parallel[1], &second))
        return FF_ERR_RANGE;
    if (!is_within(first, -STANDARD_MAX, STANDARD_MAX) ||
        !is_within(second, -STANDARD_MAX, STANDARD_MAX) || from < -FF_GEO_PI / 180 * 79 || !scale)
        return FF_ERR_RANGE;
    unit = parallel_radius(m, first);
    base = log_t(m, first);
    ff_geo_circle(first, &cone, &cosine);
    if (!is_within(first - second, -SAME_PARALLEL, SAME_PARALLEL)) {
        int64_t higher = ff_geo_log(unit) - ff_geo_log(parallel_radius(m, second)),
                further = base - log_t(m, second);
        cone = ff_geo_ratio(higher, further, 56);
    }
    if (cone < FF_GEO_ONE / 32) return FF_ERR_RANGE;
    unit = ff_geo_ratio(ff_geo_mul(unit, scale), cone, 56);
    return make_cone(m, cone, ff_geo_ratio(unit, ff_geo_exp(ff_geo_mul(base, cone)), 56), from);
}

/* The radius of the stereographic plane at t = 1: 2 / sqrt((1 + e)^(1 + e) (1 - e)^(1 - e)); the
 * root's logarithm is half the sum of e^2k / (k (2k - 1)). */
static int64_t polar_radius(int64_t e2)
{
    int64_t power = e2, sum = 0;
    FF_ASSERT(e2 >= 0 && e2 < FF_GEO_ONE / 16);
    for (int k = 1; k <= 6; k++, power = ff_geo_mul(power, e2)) sum += power / (k * (2 * k - 1));
    return 2 * ff_geo_exp(-sum / 2);
}

static int make_polar(const maker *m)
{
    int by_scale = m->projection->method == STEREOGRAPHIC_A;
    int64_t latitude = value_of(m, by_scale ? LATITUDE : POLAR_PARALLEL, 0), parallel, unit;
    m->geo->south = latitude < 0;
    if (by_scale && latitude != 90 * DEGREE_E9 && latitude != -90 * DEGREE_E9)
        return FF_ERR_UNSUPPORTED;
    if (latitude_of(m, by_scale ? LATITUDE : POLAR_PARALLEL, &parallel)) return FF_ERR_RANGE;
    if (parallel < FF_GEO_PI / 18) return FF_ERR_RANGE;
    if (by_scale)
        unit = ff_geo_mul(polar_radius(m->e2), scale_of(m));
    else if (parallel >= FF_GEO_PI / 2)
        unit = polar_radius(m->e2);
    else
        unit = ff_geo_ratio(parallel_radius(m, parallel), ff_geo_exp(log_t(m, parallel)), 56);
    return make_cone(m, FF_GEO_ONE, unit, FF_GEO_PI / 2);
}

static int make_method(const maker *m, int64_t n)
{
    switch (m->projection->method) {
        case TRANSVERSE_MERCATOR: return make_transverse(m, n);
        case MERCATOR_A:
        case MERCATOR_B:
        case MERCATOR_WEB: return make_mercator(m);
        case LAMBERT_1SP:
        case LAMBERT_2SP: return make_lambert(m);
        case STEREOGRAPHIC_A:
        case STEREOGRAPHIC_B: return make_polar(m);
        default: return FF_ERR_UNSUPPORTED;
    }
}

/* The meridian, and where the world's origin lies from the false origin. */
static int take_place(maker *m, const ff_terrain_info *info)
{
    unsigned method = m->projection->method;
    int64_t meridian = value_of(m,
                                method == LAMBERT_2SP       ? FALSE_LONGITUDE
                                : method == STEREOGRAPHIC_B ? POLAR_LONGITUDE
                                                            : LONGITUDE,
                                0),
            false_east = value_of(m, method == LAMBERT_2SP ? FALSE_EASTING : EASTING, 0),
            false_north = value_of(m, method == LAMBERT_2SP ? FALSE_NORTHING : NORTHING, 0);
    if (!is_within(meridian, -360 * DEGREE_E9, 360 * DEGREE_E9) ||
        !is_within(m->projection->prime_meridian, -360 * DEGREE_E9, 360 * DEGREE_E9) ||
        !is_within(false_east, -LENGTH_MAX, LENGTH_MAX) ||
        !is_within(false_north, -LENGTH_MAX, LENGTH_MAX) ||
        !is_within(info->origin_x_mm, -LENGTH_MAX / 1000, LENGTH_MAX / 1000) ||
        !is_within(info->origin_y_mm, -LENGTH_MAX / 1000, LENGTH_MAX / 1000))
        return FF_ERR_RANGE;
    m->geo->meridian_e9 = meridian + m->projection->prime_meridian;
    m->east_um = info->origin_x_mm * 1000 - false_east;
    m->north_um = info->origin_y_mm * 1000 - false_north;
    return FF_OK;
}

int ff_geo_make(ff_geo *geo, const ff_about_projection *projection, const ff_terrain_info *info)
{
    int64_t inverse = projection->inverse_flattening, n = 0;
    *geo = (ff_geo){ .west_q56 = -FF_GEO_PI };
    maker m = { .projection = projection, .geo = geo };
    if (!is_within(projection->semi_major_um, RADIUS_MIN, RADIUS_MAX)) return FF_ERR_UNSUPPORTED;
    if (inverse && !is_within(inverse, INVERSE_MIN, INT64_MAX / 4)) return FF_ERR_UNSUPPORTED;
    if (inverse) n = ff_geo_ratio(DEGREE_E9, 2 * inverse - DEGREE_E9, 56);
    int64_t once = FF_GEO_ONE + n;
    m.e2 = ff_geo_ratio(4 * n, ff_geo_mul(once, once), 56);
    ff_geo_flatten(geo, n);
    int rc = take_place(&m, info);
    if (rc == FF_OK) rc = make_method(&m, n);
    if (rc == FF_OK && geo->kind == FF_GEO_MERCATOR)
        geo->west_q56 = ff_geo_scale(geo->east_um, geo->per_radius, 44) - FF_GEO_PI / 2;
    return rc;
}

int ff_geo_pack(ff_geo *geo, const ff_pack *pack)
{
    ff_about_projection projection;
    ff_list about;
    int rc = ff_pack_about(pack, &about);
    if (rc == FF_OK) rc = ff_about_get_projection(about, &projection);
    return rc == FF_OK ? ff_geo_make(geo, &projection, &pack->header.info) : rc;
}

/* ---- places ---- */

static int64_t um_of_wu(int32_t wu) { return ((int64_t)wu * UM_PER_WU_Q2 + 2) >> 2; }

/* To the nearest; *error is set where there is none. */
static int32_t wu_of_um(int64_t um, int *error)
{
    int64_t wu = (um * 8 + UM_PER_WU_Q2) / (2 * UM_PER_WU_Q2);
    if (um * 8 + UM_PER_WU_Q2 < 0 && (um * 8 + UM_PER_WU_Q2) % (2 * UM_PER_WU_Q2)) wu--;
    if (!is_within(wu, INT32_MIN, INT32_MAX)) *error = FF_ERR_RANGE;
    return *error == FF_OK ? (int32_t)wu : 0;
}

/* From -180 to 180 degrees. */
static int64_t one_turn(int64_t longitude_e9)
{
    int64_t turn = 360 * DEGREE_E9;
    FF_ASSERT(is_within(longitude_e9, -8 * turn, 8 * turn));
    longitude_e9 %= turn;
    if (longitude_e9 > turn / 2) return longitude_e9 - turn;
    return longitude_e9 < -turn / 2 ? longitude_e9 + turn : longitude_e9;
}

int ff_geo_of(const ff_geo *geo, const int32_t position_wu[3], ff_geo_place *place)
{
    const int64_t east_um = um_of_wu(position_wu[0]) + geo->east_um,
                  north_um = um_of_wu(position_wu[1]) + geo->north_um,
                  xy[2] = { ff_geo_scale(east_um, geo->per_radius, 44),
                            ff_geo_scale(north_um, geo->per_radius, 44) };
    int64_t latitude, longitude, quarter = 90 * DEGREE_E9;
    FF_ASSERT(geo->per_radius > 0);
    int rc = ff_geo_unproject(geo, xy, &latitude, &longitude);
    if (rc != FF_OK) return rc;
    latitude = degrees_e9(latitude);
    place->latitude_e9 = latitude > quarter ? quarter : latitude < -quarter ? -quarter : latitude;
    place->longitude_e9 = one_turn(degrees_e9(longitude) + geo->meridian_e9);
    place->height_mm = (int64_t)position_wu[2] * 1000 / FF_WU_PER_METRE;
    return FF_OK;
}

/* The plane's place of a latitude and longitude, from the world's origin. */
static int project(const ff_geo *geo, int64_t latitude_e9, int64_t longitude_e9, int64_t um[2])
{
    int64_t xy[2], east = radians(one_turn(longitude_e9 - geo->meridian_e9));
    if (!is_within(latitude_e9, -90 * DEGREE_E9, 90 * DEGREE_E9)) return FF_ERR_RANGE;
    if (east < geo->west_q56) east += 2 * FF_GEO_PI;
    if (east > geo->west_q56 + 2 * FF_GEO_PI) east -= 2 * FF_GEO_PI;
    int rc = ff_geo_project(geo, radians(latitude_e9), east, xy);
    if (rc != FF_OK) return rc;
    um[0] = ff_geo_scale(xy[0], geo->radius_um, 56) - geo->east_um;
    um[1] = ff_geo_scale(xy[1], geo->radius_um, 56) - geo->north_um;
    return FF_OK;
}

int ff_geo_to(const ff_geo *geo, const ff_geo_place *place, int32_t position_wu[3])
{
    int64_t um[2];
    if (!is_within(place->height_mm, -LENGTH_MAX / 1000, LENGTH_MAX / 1000) ||
        !is_within(place->longitude_e9, -720 * DEGREE_E9, 720 * DEGREE_E9))
        return FF_ERR_RANGE;
    int rc = project(geo, place->latitude_e9, place->longitude_e9, um);
    if (rc != FF_OK) return rc;
    position_wu[0] = wu_of_um(um[0], &rc);
    position_wu[1] = wu_of_um(um[1], &rc);
    position_wu[2] = wu_of_um((int64_t)place->height_mm * 1000, &rc);
    return rc;
}

int ff_geo_north(const ff_geo *geo, const int32_t position_wu[3], int32_t *north_brad16)
{
    ff_geo_place place;
    int64_t there[2], angle;
    int rc = ff_geo_of(geo, position_wu, &place);
    if (rc != FF_OK) return rc;
    int back = place.latitude_e9 > 0; /* towards the equator, away from poles */
    rc = project(geo, place.latitude_e9 + (back ? -NORTH_E9 : NORTH_E9), place.longitude_e9, there);
    if (rc != FF_OK) return rc;
    int64_t east = there[0] - um_of_wu(position_wu[0]), north = there[1] - um_of_wu(position_wu[1]);
    if (back) {
        east = -east;
        north = -north;
    }
    (void)ff_geo_polar(north * (1 << 16), east * (1 << 16), &angle);
    *north_brad16 = (int32_t)ff_geo_scale(angle, BRAD16, 88) & 65535;
    return FF_OK;
}
