/* Places on Earth in integers (protocol/geo) against PROJ: random points of many projections, as
 * the baker tells them. POINTS=N: of each, default 2000. */
#include "../../protocol/geo/ff_geo.h"
#include "../../tools/bake/raster/bake_gdal.h"
#include "../../tools/bake/raster/bake_projection.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define DEGREE_M     111319.5
#define RADIAN       (M_PI / 180)
#define WORST_M      0.003  /* asked: 1 m; half a unit of the world each way is 0.0028 */
#define WORST_BACK_M 0.0005 /* 10^-9 degree is 0.0001 */
#define WORST_DEGREE 0.008  /* of north: 1/65536 turn is 0.0055 */

typedef struct system_case {
    const char *name; /* as OSRSetFromUserInput takes it */
    double west, south, east, north;
} system_case;

static const system_case earth[] = {
    { "EPSG:32633", 12, 0, 18, 84 },        /* a zone of UTM */
    { "EPSG:32633", 8.5, 60, 21.5, 84 },    /* and beside it */
    { "EPSG:32719", -72, -80, -66, 0 },     /* south */
    { "EPSG:32701", -180.5, -80, -174, 0 }, /* at 180 degrees, from the other side */
    { "EPSG:32660", 174, 0, 181, 84 },      /* */
    { "EPSG:27700", -8, 49, 2, 61 },        /* Britain: Airy's ellipsoid, origin at 49 N */
    { "EPSG:2193", 166, -48, 179, -34 },    /* New Zealand */
    { "EPSG:31467", 5, 46, 15, 56 },        /* Germany: Bessel's */
    { "EPSG:3857", -180, -85, 180, 85 },    /* maps of the web */
    { "EPSG:3395", -180, -80, 180, 84 },    /* Mercator */
    { "EPSG:3832", 60, -70, 239, 70 },      /* round 150 E, over 180 degrees */
    { "EPSG:3994", -170, -60, 30, 0 },      /* by a parallel, 41 S */
    { "EPSG:2154", -10, 41, 11, 52 },       /* France: Lambert, two parallels */
    { "EPSG:3034", -30, 25, 50, 75 },       /* Europe */
    { "EPSG:3112", 110, -45, 155, -9 },     /* Australia: Lambert of the south */
    { "EPSG:24200", -79, 17, -76, 19 },     /* Jamaica: one parallel, a scale */
    { "EPSG:27572", 0, 42, 9, 51 },         /* France: degrees from Paris, in grads */
    { "EPSG:5041", -180, 60, 180, 90 },     /* UPS north */
    { "EPSG:5042", -180, -90, 180, -60 },   /* UPS south */
    { "EPSG:3413", -180, 45, 180, 90 },     /* by a parallel, 70 N */
    { "EPSG:3031", -180, -90, 180, -45 },   /* by a parallel, 71 S */
    { "+proj=tmerc +lat_0=30 +lon_0=40 +k=1 +x_0=0 +y_0=0 +R=1737400 +units=m", 20, -20, 60, 80 },
    { "+proj=tmerc +lon_0=40 +k=1 +a=6378137 +rf=150 +units=m", 20, -60, 60, 89 }, /* very flat */
    { "+proj=lcc +lat_1=-20 +lat_2=-40 +lat_0=-30 +lon_0=7 +a=6378137 +rf=150 +units=m", -30, -70,
      40, 0 },
    { "+proj=lcc +lat_1=20 +lat_2=-5 +lat_0=10 +lon_0=7 +R=3396190 +units=m", -40, -30, 60, 60 },
};

typedef struct worst {
    double to_m, of_m, north_degree, again_wu;
} worst;

typedef struct rig {
    ff_geo geo;
    ff_terrain_info info;
    OGRCoordinateTransformationH plane, degrees;
    double radian_m; /* metres in a radian of that ellipsoid */
    double prime;    /* longitude of its prime meridian */
    double unit;     /* degrees in its unit of angles: some count in grads */
} rig;

static uint64_t state = 1;
static double chance(double low, double high)
{
    state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return low + (high - low) * (double)(state >> 11) / 9007199254740992.0;
}

static void project(const rig *r, double latitude, double longitude, double xy[2])
{
    xy[0] = (longitude - r->prime) / r->unit;
    xy[1] = latitude / r->unit;
    assert_true(OCTTransform(r->plane, 1, &xy[0], &xy[1], NULL));
}

/* A system, and a pack's corner in the middle of the box. FF_OK, or what ff_geo_make said. */
static int open_rig(rig *r, const system_case *c)
{
    uint8_t numbers[BAKE_PROJECTION_BYTES_MAX], list[BAKE_PROJECTION_BYTES_MAX + 8];
    ff_about_projection projection;
    ff_writer out = { list, list + sizeof list, FF_OK };
    OGRSpatialReferenceH srs = OSRNewSpatialReference(NULL);
    assert_int_equal(OSRSetFromUserInput(srs, c->name), OGRERR_NONE);
    OSRSetAxisMappingStrategy(srs, OAMS_TRADITIONAL_GIS_ORDER);
    OGRSpatialReferenceH degrees = OSRCloneGeogCS(srs);
    OSRSetAxisMappingStrategy(degrees, OAMS_TRADITIONAL_GIS_ORDER);
    *r = (rig){ .plane = OCTNewCoordinateTransformation(degrees, srs),
                .degrees = OCTNewCoordinateTransformation(srs, degrees),
                .radian_m = OSRGetSemiMajor(srs, NULL),
                .prime = OSRGetPrimeMeridian(srs, NULL),
                .unit = OSRGetAngularUnits(degrees, NULL) / RADIAN };
    char *wkt = bake_projection_wkt(srs);
    uint32_t count = bake_projection_numbers(srs, wkt, numbers);
    if (!count) print_message("%s\n", wkt);
    assert_true(count > 0);
    ff_list_write(&out, FF_ABOUT_PROJECTION, numbers, count);
    assert_int_equal(
        ff_about_get_projection((ff_list){ list, (uint32_t)(out.at - list) }, &projection), FF_OK);
    int rc = ff_geo_make(&r->geo, &projection, &r->info);
    if (rc == FF_OK) {
        double xy[2];
        project(r, (c->south + c->north) / 2, (c->west + c->east) / 2, xy);
        r->info.origin_x_mm = (int64_t)floor(xy[0] * 1000);
        r->info.origin_y_mm = (int64_t)floor(xy[1] * 1000);
        rc = ff_geo_make(&r->geo, &projection, &r->info);
    }
    CPLFree(wkt);
    OSRDestroySpatialReference(degrees);
    OSRDestroySpatialReference(srs);
    return rc;
}

static void close_rig(rig *r)
{
    OCTDestroyCoordinateTransformation(r->plane);
    OCTDestroyCoordinateTransformation(r->degrees);
}

static void note(double *most, double error)
{
    if (!(error <= *most)) *most = error;
}

/* Degrees between directions. */
static double between(double a, double b) { return fabs(remainder(a - b, 360)); }

static double north_of(const rig *r, double latitude, double longitude)
{
    double half = 1e-4, a[2], b[2];
    if (latitude > 89.9) latitude = 89.9;
    if (latitude < -89.9) latitude = -89.9;
    project(r, latitude - half, longitude, a);
    project(r, latitude + half, longitude, b);
    return atan2(b[0] - a[0], b[1] - a[1]) / RADIAN;
}

static void one_point(const rig *r, double latitude, double longitude, worst *w)
{
    ff_geo_place place = { llround(latitude * 1e9), llround(longitude * 1e9), 123456 }, back;
    double xy[2], x0 = (double)r->info.origin_x_mm / 1000, y0 = (double)r->info.origin_y_mm / 1000;
    int32_t wu[3], again[3], north;
    latitude = (double)place.latitude_e9 / 1e9;
    longitude = (double)place.longitude_e9 / 1e9;
    project(r, latitude, longitude, xy);
    if (fabs(xy[0] - x0) > 8.3e6 || fabs(xy[1] - y0) > 8.3e6) return;
    assert_int_equal(ff_geo_to(&r->geo, &place, wu), FF_OK);
    assert_int_equal(wu[2], 31605);
    note(&w->to_m, hypot(wu[0] / 256.0 + x0 - xy[0], wu[1] / 256.0 + y0 - xy[1]));
    assert_int_equal(ff_geo_of(&r->geo, wu, &back), FF_OK);
    assert_int_equal(back.height_mm, 123457);
    double x = wu[0] / 256.0 + x0, y = wu[1] / 256.0 + y0;
    assert_true(OCTTransform(r->degrees, 1, &x, &y, NULL));
    x = x * r->unit + r->prime;
    y *= r->unit;
    double aside = between((double)back.longitude_e9 / 1e9, x) * cos(y * RADIAN),
           ahead = (double)back.latitude_e9 / 1e9 - y;
    note(&w->of_m, hypot(aside, ahead) * RADIAN * r->radian_m);
    assert_int_equal(ff_geo_to(&r->geo, &back, again), FF_OK);
    note(&w->again_wu, hypot(again[0] - wu[0], again[1] - wu[1]));
    assert_int_equal(ff_geo_north(&r->geo, wu, &north), FF_OK);
    assert_in_range(north, 0, 65535);
    if (fabs(latitude) < 89.9)
        note(&w->north_degree, between(north * 360 / 65536.0, north_of(r, y, x)));
}

static void places_are_where_proj_has_them(void **unused)
{
    const char *points = getenv("POINTS");
    int count = points ? atoi(points) : 2000;
    (void)unused;
    print_message("# worst over %d points: plane m, degrees m, there and back wu, north degrees\n",
                  count);
    for (size_t i = 0; i < sizeof earth / sizeof *earth; i++) {
        const system_case *c = &earth[i];
        worst w = { 0 };
        rig r;
        assert_int_equal(open_rig(&r, c), FF_OK);
        for (int n = 0; n < count; n++)
            one_point(&r, chance(c->south, c->north), chance(c->west, c->east), &w);
        one_point(&r, c->north, c->west, &w);
        one_point(&r, c->south, c->east, &w);
        print_message("# %.5f %.5f %.1f %.4f  %s\n", w.to_m, w.of_m, w.again_wu, w.north_degree,
                      c->name);
        assert_true(w.to_m <= WORST_M && w.of_m <= WORST_BACK_M && w.again_wu <= 0);
        assert_true(w.north_degree <= WORST_DEGREE);
        close_rig(&r);
    }
}

/* Of a code of EPSG: 1 when it is a plane in metres. */
static int in_metres(const char *name)
{
    OGRSpatialReferenceH srs = OSRNewSpatialReference(NULL);
    int is = OSRSetFromUserInput(srs, name) == OGRERR_NONE && OSRIsProjected(srs) &&
             OSRGetAxesCount(srs) == 2 && fabs(OSRGetLinearUnits(srs, NULL) - 1) < 1e-12;
    OSRDestroySpatialReference(srs);
    return is;
}

/* Points of where a system is meant to be used, of all that PROJ knows. */
static void all_systems_of_epsg_are_told_right_or_not_at_all(void **unused)
{
    int all, made = 0, other = 0;
    worst w = { 0 };
    (void)unused;
    OSRCRSInfo **list = OSRGetCRSInfoListFromDatabase("EPSG", NULL, &all);
    for (int i = 0; i < all; i++) {
        const OSRCRSInfo *info = list[i];
        char name[32];
        rig r;
        snprintf(name, sizeof name, "EPSG:%s", info->pszCode);
        if (info->eType != OSR_CRS_TYPE_PROJECTED || info->bDeprecated || !info->bBboxValid)
            continue;
        if (!in_metres(name)) continue;
        double east = info->dfEastLongitudeDeg, west = info->dfWestLongitudeDeg;
        system_case c = { name, west, info->dfSouthLatitudeDeg, east < west ? east + 360 : east,
                          info->dfNorthLatitudeDeg };
        int rc = open_rig(&r, &c);
        made += rc == FF_OK;
        other += rc == FF_ERR_UNSUPPORTED;
        if (rc != FF_OK && rc != FF_ERR_UNSUPPORTED) fail_msg("%s: %s", name, ff_error_text(rc));
        for (int n = 0; rc == FF_OK && n < 8; n++)
            one_point(&r, chance(c.south, c.north), chance(c.west, c.east), &w);
        if (!(w.to_m <= WORST_M)) fail_msg("%s: %g m", name, w.to_m);
        if (!(w.of_m <= WORST_BACK_M)) fail_msg("%s: %g m back", name, w.of_m);
        if (!(w.north_degree <= WORST_DEGREE)) fail_msg("%s: %g degrees", name, w.north_degree);
        close_rig(&r);
    }
    OSRDestroyCRSInfoList(list);
    print_message("# %d systems of EPSG, %d of other methods: %.5f %.5f %.1f %.4f\n", made, other,
                  w.to_m, w.of_m, w.again_wu, w.north_degree);
    assert_true(made > 3000 && w.again_wu <= 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(places_are_where_proj_has_them),
                                        cmocka_unit_test(
                                            all_systems_of_epsg_are_told_right_or_not_at_all) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
