/* Places on Earth: the examples of EPSG's guidance note 7-2, there and back; what is refused; any
 * numbers from outside; and results that are the same on every machine, bit for bit. */
#include "../../protocol/geo/ff_geo.h"
#include "../../protocol/geo/ff_geo_math.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define FOOT       (1200.0 / 3937) /* of the US survey */
#define PARAMETERS 7
#define WGS84      6378137, 298.257223563

typedef struct parameter {
    uint16_t code; /* 0: none */
    double value;  /* degrees, metres, or a factor */
} parameter;

typedef struct example {
    const char *name;
    uint16_t method;
    double semi_major_m, inverse_flattening;
    parameter parameter[PARAMETERS];
    double latitude, longitude, east_m, north_m;
    double off_m; /* as well as the note tells it: it has centimetres, or other formulas */
} example;

#define DMS(d, m, s) ((d) + (m) / 60.0 + (s) / 3600.0)
static const example note[] = {
    { "OSGB36 / British National Grid",
      9807,
      6377563.396,
      299.3249646,
      { { 8801, 49 }, { 8802, -2 }, { 8805, 0.9996012717 }, { 8806, 400000 }, { 8807, -100000 } },
      DMS(50, 30, 0),
      DMS(0, 30, 0),
      577274.99,
      69740.50,
      0.01 },
    { "Makassar / NEIEZ",
      9804,
      6377397.155,
      299.1528128,
      { { 8801, 0 }, { 8802, 110 }, { 8805, 0.997 }, { 8806, 3900000 }, { 8807, 900000 } },
      -3,
      120,
      5009726.58,
      569150.82,
      0.01 },
    { "Pulkovo 1942 / Caspian Sea Mercator",
      9805,
      6378245,
      298.3,
      { { 8823, 42 }, { 8802, 51 } },
      53,
      53,
      165704.29,
      5171848.07,
      0.01 },
    { "WGS 84 / Pseudo-Mercator",
      1024,
      WGS84,
      { { 8801, 0 }, { 8802, 0 } },
      DMS(24, 22, 54.433),
      -DMS(100, 20, 0),
      -11169055.58,
      2800000.00,
      0.01 },
    { "JAD69 / Jamaica National Grid",
      9801,
      6378206.4,
      294.978698214,
      { { 8801, 18 }, { 8802, -77 }, { 8805, 1 }, { 8806, 250000 }, { 8807, 150000 } },
      DMS(17, 55, 55.80),
      -DMS(76, 56, 37.26),
      255966.58,
      142493.51,
      0.01 },
    { "NAD27 / Texas South Central",
      9802,
      6378206.4,
      294.978698214,
      { { 8821, DMS(27, 50, 0) },
        { 8822, -99 },
        { 8823, DMS(28, 23, 0) },
        { 8824, DMS(30, 17, 0) },
        { 8826, 2000000 * FOOT },
        { 8827, 0 } },
      28.5,
      -96,
      2963503.91 * FOOT,
      254759.80 * FOOT,
      0.01 },
    { "WGS 84 / UPS North",
      9810,
      WGS84,
      { { 8801, 90 }, { 8802, 0 }, { 8805, 0.994 }, { 8806, 2000000 }, { 8807, 2000000 } },
      73,
      44,
      3320416.75,
      632668.43,
      0.01 },
    { "WGS 84 / Australian Antarctic Polar Stereographic",
      9829,
      WGS84,
      { { 8832, -71 }, { 8833, 70 }, { 8806, 6000000 }, { 8807, 6000000 } },
      -75,
      120,
      7255380.79,
      7053389.56,
      0.01 },
};
#define EXAMPLES (sizeof note / sizeof *note)

/* The entry's value in bytes, as SPEC.md has it; its length. */
static int value_of(const example *e, uint8_t value[FF_ABOUT_PROJECTION_MAX])
{
    ff_writer out = { value, value + FF_ABOUT_PROJECTION_MAX, FF_OK };
    ff_write_bytes(&out, e->method, 2);
    ff_write_bytes(&out, (uint64_t)llround(e->semi_major_m * 1e6), 8);
    ff_write_bytes(&out, (uint64_t)llround(e->inverse_flattening * 1e9), 8);
    ff_write_bytes(&out, 0, 8);
    for (int i = 0; i < PARAMETERS && e->parameter[i].code; i++) {
        uint16_t code = e->parameter[i].code;
        int is_length = code == 8806 || code == 8807 || code == 8826 || code == 8827;
        double unit = code == 8805 ? 1e12 : is_length ? 1e6 : 1e9;
        ff_write_bytes(&out, code, 2);
        ff_write_bytes(&out, (uint64_t)llround(e->parameter[i].value * unit), 8);
    }
    assert_int_equal(out.error, FF_OK);
    return (int)(out.at - value);
}

/* With the world's origin at a whole metre near the example's place. */
static int make(const example *e, ff_geo *geo, ff_terrain_info *info)
{
    uint8_t value[FF_ABOUT_PROJECTION_MAX];
    ff_about_projection projection;
    assert_int_equal(ff_about_read_projection(value, value_of(e, value), &projection), FF_OK);
    *info = (ff_terrain_info){ .origin_x_mm = (int64_t)floor(e->east_m - 1000) * 1000,
                               .origin_y_mm = (int64_t)floor(e->north_m - 2000) * 1000 };
    return ff_geo_make(geo, &projection, info);
}

static void examples_of_the_guidance_note_come_out(void **state)
{
    (void)state;
    for (size_t i = 0; i < EXAMPLES; i++) {
        const example *e = &note[i];
        ff_geo_place place = { llround(e->latitude * 1e9), llround(e->longitude * 1e9), -1500 },
                     back;
        ff_terrain_info info;
        int32_t wu[3], again[3];
        ff_geo geo;
        assert_int_equal(make(e, &geo, &info), FF_OK);
        assert_int_equal(ff_geo_to(&geo, &place, wu), FF_OK);
        double x = wu[0] / 256.0 + (double)info.origin_x_mm / 1000,
               y = wu[1] / 256.0 + (double)info.origin_y_mm / 1000;
        if (hypot(x - e->east_m, y - e->north_m) > e->off_m)
            fail_msg("%s: %.3f %.3f", e->name, x, y);
        assert_int_equal(wu[2], -384);
        assert_int_equal(ff_geo_of(&geo, wu, &back), FF_OK);
        assert_true(llabs(back.latitude_e9 - place.latitude_e9) < 30);   /* half a wu is 18 */
        assert_true(llabs(back.longitude_e9 - place.longitude_e9) < 80); /* of 71 S, 3 times */
        assert_int_equal(back.height_mm, -1500);
        assert_int_equal(ff_geo_to(&geo, &back, again), FF_OK);
        assert_memory_equal(again, wu, sizeof wu);
    }
}

/* Meridians run together to the north: to the east of the middle one true north is to the left of
 * the plane's. */
static void north_is_where_meridians_lead(void **state)
{
    ff_geo geo;
    ff_terrain_info info;
    ff_geo_place place = { INT64_C(50500000000), INT64_C(500000000), 0 };
    int32_t wu[3], north;
    (void)state;
    assert_int_equal(make(&note[0], &geo, &info), FF_OK);
    assert_int_equal(ff_geo_to(&geo, &place, wu), FF_OK);
    assert_int_equal(ff_geo_north(&geo, wu, &north), FF_OK);
    /* tan of it is tan 2.5 degrees * sin latitude */
    double expected = -atan(tan(2.5 * M_PI / 180) * sin(50.5 * M_PI / 180)) * 32768 / M_PI;
    assert_true(fabs(north - 65536 - expected) < 1);
    assert_int_equal(make(&note[6], &geo, &info), FF_OK); /* 73 N, 44 E of UPS North */
    place = (ff_geo_place){ INT64_C(73000000000), INT64_C(44000000000), 0 };
    assert_int_equal(ff_geo_to(&geo, &place, wu), FF_OK);
    assert_int_equal(ff_geo_north(&geo, wu, &north), FF_OK);
    assert_true(fabs(north - (360 - 44) * 65536 / 360.0) < 1);
    assert_int_equal(make(&note[7], &geo, &info), FF_OK); /* 75 S, 50 degrees from the meridian */
    place = (ff_geo_place){ INT64_C(-75000000000), INT64_C(120000000000), 0 };
    assert_int_equal(ff_geo_to(&geo, &place, wu), FF_OK);
    assert_int_equal(ff_geo_north(&geo, wu, &north), FF_OK);
    assert_true(fabs(north - 50 * 65536 / 360.0) < 1);
    assert_int_equal(make(&note[1], &geo, &info), FF_OK);
    assert_int_equal(ff_geo_north(&geo, wu, &north), FF_OK);
    assert_int_equal(north, 0);
}

/* Mercator's plane is cut where the ground is not. */
static void ground_across_the_date_line_is_in_one_piece(void **state)
{
    example e = note[3];
    ff_geo geo;
    ff_terrain_info info;
    ff_geo_place place = { 0, INT64_C(-178000000000), 0 };
    int32_t wu[3];
    (void)state;
    e.east_m = 179 * 111319.490793; /* a degree west of the line */
    e.north_m = 0;
    assert_int_equal(make(&e, &geo, &info), FF_OK);
    assert_int_equal(ff_geo_to(&geo, &place, wu), FF_OK);
    assert_true(fabs(wu[0] / 256.0 - 1000 - 3 * 111319.490793) < 2);
    assert_int_equal(ff_geo_of(&geo, wu, &place), FF_OK);
    assert_true(llabs(place.longitude_e9 - INT64_C(-178000000000)) < 40);
}

static void what_no_projection_shows_is_refused(void **state)
{
    ff_geo geo;
    ff_terrain_info info;
    ff_geo_place place = { 0 };
    int32_t wu[3];
    (void)state;
    assert_int_equal(make(&note[0], &geo, &info), FF_OK);
    place.longitude_e9 = INT64_C(100000000000); /* far beside the meridian */
    assert_int_equal(ff_geo_to(&geo, &place, wu), FF_ERR_RANGE);
    place = (ff_geo_place){ INT64_C(90000000001), 0, 0 };
    assert_int_equal(ff_geo_to(&geo, &place, wu), FF_ERR_RANGE);
    place = (ff_geo_place){ 0, INT64_MIN, 0 };
    assert_int_equal(ff_geo_to(&geo, &place, wu), FF_ERR_RANGE);
    place = (ff_geo_place){ 0, 0, INT64_MAX };
    assert_int_equal(ff_geo_to(&geo, &place, wu), FF_ERR_RANGE);
    assert_int_equal(ff_geo_of(&geo, (int32_t[3]){ INT32_MAX, 0, 0 }, &place), FF_ERR_RANGE);
    assert_int_equal(make(&note[2], &geo, &info), FF_OK);
    place = (ff_geo_place){ INT64_C(89900000000), 0, 0 }; /* Mercator has no poles */
    assert_int_equal(ff_geo_to(&geo, &place, wu), FF_ERR_RANGE);
    assert_int_equal(make(&note[6], &geo, &info), FF_OK);
    place.latitude_e9 = INT64_C(-85000000000); /* nor has a stereographic plane the other one */
    assert_int_equal(ff_geo_to(&geo, &place, wu), FF_ERR_RANGE);
    place = (ff_geo_place){ 0, 0, 0 }; /* beyond the world's coordinates */
    info.origin_x_mm = -INT64_C(100000000000);
    example far = note[6];
    far.east_m = -1e7;
    assert_int_equal(make(&far, &geo, &info), FF_OK);
    place.longitude_e9 = INT64_C(90000000000);
    assert_int_equal(ff_geo_to(&geo, &place, wu), FF_ERR_RANGE);
}

static void other_methods_and_bodies_are_told_apart(void **state)
{
    ff_geo geo;
    ff_terrain_info info;
    (void)state;
    example e = note[5];
    e.method = 9822; /* Albers */
    assert_int_equal(make(&e, &geo, &info), FF_ERR_UNSUPPORTED);
    e = note[6];
    e.parameter[0].value = 89; /* a stereographic plane beside the pole */
    assert_int_equal(make(&e, &geo, &info), FF_ERR_UNSUPPORTED);
    e = note[0];
    e.inverse_flattening = 12; /* Saturn is nearer to 10 */
    assert_int_equal(make(&e, &geo, &info), FF_ERR_UNSUPPORTED);
    e.inverse_flattening = -298;
    assert_int_equal(make(&e, &geo, &info), FF_ERR_UNSUPPORTED);
    e = note[0];
    e.semi_major_m = 200e3;
    assert_int_equal(make(&e, &geo, &info), FF_ERR_UNSUPPORTED);
    e = note[5];
    e.parameter[3].value = -e.parameter[2].value; /* a cone that is a cylinder */
    assert_int_equal(make(&e, &geo, &info), FF_ERR_RANGE);
    e.parameter[3].value = 91;
    assert_int_equal(make(&e, &geo, &info), FF_ERR_RANGE);
    e = note[0];
    e.parameter[2].value = 0;
    assert_int_equal(make(&e, &geo, &info), FF_ERR_RANGE);
    e = note[0];
    e.east_m = 2e9;
    assert_int_equal(make(&e, &geo, &info), FF_ERR_RANGE);
}

static uint64_t state_of_chance = 7;
static uint64_t chance(void)
{
    state_of_chance = state_of_chance * UINT64_C(6364136223846793005) +
                      UINT64_C(1442695040888963407);
    return state_of_chance >> 11 ^ state_of_chance << 53;
}

/* Sanitizers and assertions look on. */
static void any_numbers_end_in_a_place_or_an_error(void **state)
{
    static const uint16_t method[] = { 9807, 9804, 9805, 1024, 9801, 9802, 9810, 9829 };
    unsigned made = 0;
    (void)state;
    for (int draw = 0; draw < 20000; draw++) {
        const example *e = &note[draw % (int)EXAMPLES];
        uint8_t value[FF_ABOUT_PROJECTION_MAX];
        ff_about_projection projection;
        int count = value_of(e, value);
        for (int n = (int)(chance() % 4); n >= 0; n--)
            value[chance() % (uint64_t)count] = (uint8_t)chance();
        assert_int_equal(ff_about_read_projection(value, count, &projection), FF_OK);
        if (draw % 3) projection.method = method[chance() % 8];
        ff_terrain_info info = { .origin_x_mm = (int64_t)chance() >> chance() % 64,
                                 .origin_y_mm = (int64_t)chance() >> chance() % 64 };
        ff_geo geo;
        if (ff_geo_make(&geo, &projection, &info) != FF_OK) continue;
        made++;
        for (int n = 0; n < 8; n++) {
            int32_t wu[3] = { (int32_t)chance(), (int32_t)chance(), (int32_t)chance() }, north;
            ff_geo_place place = { 0 };
            if (ff_geo_of(&geo, wu, &place) == FF_OK) {
                assert_true(llabs(place.latitude_e9) <= INT64_C(90000000000));
                assert_true(llabs(place.longitude_e9) <= INT64_C(180000000000));
                (void)ff_geo_north(&geo, wu, &north);
            }
            place = (ff_geo_place){ (int64_t)chance() >> chance() % 64, (int64_t)chance() >> 24,
                                    (int64_t)chance() >> chance() % 64 };
            (void)ff_geo_to(&geo, &place, wu);
        }
    }
    assert_true(made > 1000);
}

static void results_are_the_same_on_every_machine(void **state)
{
    uint64_t hash = UINT64_C(14695981039346656037);
    (void)state;
    for (size_t i = 0; i < EXAMPLES; i++) {
        ff_terrain_info info;
        ff_geo geo;
        assert_int_equal(make(&note[i], &geo, &info), FF_OK);
        for (int n = 0; n < 200; n++) {
            const int32_t wu[3] = { n * 654321, n * 123457, n * 1000 };
            int32_t again[3] = { 0 }, north = 0;
            ff_geo_place place = { 0 };
            assert_int_equal(ff_geo_of(&geo, wu, &place), FF_OK);
            assert_int_equal(ff_geo_north(&geo, wu, &north), FF_OK);
            assert_int_equal(ff_geo_to(&geo, &place, again), FF_OK);
            const int64_t all[] = { place.latitude_e9, place.longitude_e9, north, again[0],
                                    again[1] };
            for (int k = 0; k < 5; k++) hash = (hash ^ (uint64_t)all[k]) * UINT64_C(1099511628211);
            assert_int_equal(again[0], wu[0]);
            assert_int_equal(again[1], wu[1]);
        }
    }
    assert_int_equal(hash, UINT64_C(0x6f2eaff7804c47d9));
}

static double q56(int64_t value) { return (double)value / (double)FF_GEO_ONE; }

static void functions_are_as_near_as_they_say(void **state)
{
    double worst = 0;
    (void)state;
    for (int n = -1000; n <= 1000; n++) {
        int64_t a = n * (FF_GEO_ONE / 32), s, c, angle;
        ff_geo_circle(a, &s, &c);
        worst = fmax(worst, fmax(fabs(q56(s) - sin(q56(a))), fabs(q56(c) - cos(q56(a)))));
        int64_t length = ff_geo_polar(3 * c, 3 * s, &angle);
        worst = fmax(worst, fabs(q56(length) - 3));
        worst = fmax(worst, fabs(remainder(q56(angle) - q56(a), 2 * M_PI)));
        int64_t z = n * (FF_GEO_ONE / 1000);
        ff_geo_hyperbola(z, &s, &c);
        worst = fmax(worst, fmax(fabs(q56(s) - sinh(q56(z))), fabs(q56(c) - cosh(q56(z)))));
        worst = fmax(worst, fabs(q56(ff_geo_atanh(s, c)) - q56(z)));
        worst = fmax(worst, fabs(q56(ff_geo_exp(z * 4)) / exp(4 * q56(z)) - 1));
        worst = fmax(worst, fabs(q56(ff_geo_log(ff_geo_exp(z * 4))) - 4 * q56(z)));
    }
    assert_true(worst < ldexp(1, -48));
    int64_t angle;
    assert_true(llabs(ff_geo_polar(0, 0, &angle)) < 100); /* in any direction */
    assert_true(llabs(angle) < 4 * FF_GEO_PI);
    assert_int_equal(ff_geo_scale(INT64_MAX, INT64_MAX, 64), (INT64_C(1) << 62) - 1);
    assert_int_equal(ff_geo_scale(-3, 1, 1), -2);
    assert_int_equal(ff_geo_scale(INT64_C(1) << 40, -(INT64_C(1) << 40), 80), -1);
    assert_int_equal(ff_geo_scale(INT64_C(5) << 40, INT64_C(1) << 40, 64), INT64_C(5) << 16);
    assert_int_equal(ff_geo_ratio(-7, 2, 1), -7);
    assert_int_equal(ff_geo_ratio(INT64_MAX, INT64_MAX, 62), INT64_C(1) << 62);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(examples_of_the_guidance_note_come_out),
        cmocka_unit_test(north_is_where_meridians_lead),
        cmocka_unit_test(ground_across_the_date_line_is_in_one_piece),
        cmocka_unit_test(what_no_projection_shows_is_refused),
        cmocka_unit_test(other_methods_and_bodies_are_told_apart),
        cmocka_unit_test(any_numbers_end_in_a_place_or_an_error),
        cmocka_unit_test(results_are_the_same_on_every_machine),
        cmocka_unit_test(functions_are_as_near_as_they_say),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
