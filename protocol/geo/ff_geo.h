/* Where on Earth: latitude, longitude, height and heading of places in a pack's ground, there and
 * back, in integers, from what the pack says of its projection (SPEC.md, 4.1, type 7). Bit for bit
 * the same on every machine, no allocation; within a millimetre of the methods' own formulas.
 *
 *   ff_geo geo;
 *   if (ff_geo_pack(&geo, &pack) == FF_OK) ff_geo_of(&geo, camera.pos_wu, &place);
 *
 * Methods: Transverse Mercator (EPSG 9807, all UTM zones) up to one radius of the ellipsoid from
 * its meridian, by Krueger's series to n^4 (Karney 2011, "Transverse Mercator with an accuracy of a
 * few nanometers"); Mercator (9804, 9805, and 1024 of web maps) up to 89 degrees; Lambert Conic
 * Conformal (9801, 9802) and Polar Stereographic (9810, 9829) to 80 degrees of the other half of
 * the Earth. Ellipsoids of 600 to 70000 km, flattened by up to 1/100, or spheres.
 *
 * Degrees are those of the pack's own datum: of WGS84 as a rule, since that is what the baker
 * projects to; of NAD83 or ETRS89 within two metres of it, of older ones up to some hundred.
 */
#ifndef FF_GEO_H
#define FF_GEO_H

#include "../ff_about.h"
#include "../ff_pack.h"

typedef struct ff_geo_place {
    int64_t latitude_e9, longitude_e9; /* 10^-9 degrees: north, -90 to 90; east, -180 to 180 */
    int64_t height_mm;                 /* above what the pack's heights are above */
} ff_geo_place;

/* A pack's projection, made ready. Numbers _q56 have 56 bits behind the point. */
typedef struct ff_geo {
    uint8_t kind;       /* enum ff_geo_kind of ff_geo_project.h */
    uint8_t south;      /* a cone round the south pole: all is mirrored */
    int64_t radius_um;  /* the unit of the plane */
    int64_t per_radius; /* 2^100 / radius_um */
    /* the world's x = y = 0 from where the projection has its own: on its meridian, at the equator,
     * or at the pole */
    int64_t east_um, north_um;
    int64_t meridian_e9;            /* east of Greenwich */
    int64_t west_q56;               /* where the ground begins, from that meridian */
    int64_t cone_q56, per_cone_q56; /* n of a cone, and 1 / n */
    /* by n of the ellipsoid: conformal latitudes from geographic ones, and back; a transverse plane
     * from the sphere's, and back */
    int64_t conformal[4], geographic[4], plane[4], sphere[4];
} ff_geo;

/* FF_OK; FF_ERR_UNSUPPORTED: by another method, or on an ellipsoid of another kind; FF_ERR_RANGE:
 * with parameters that make no projection. `info`: of the ground whose corner is the world's
 * origin. */
int ff_geo_make(ff_geo *geo, const ff_about_projection *projection, const ff_terrain_info *info);
/* The same of a pack; FF_ERR_NOT_FOUND: it does not say where it lies; and errors of
 * ff_pack_about. */
int ff_geo_pack(ff_geo *geo, const ff_pack *pack);

/* From a place in the world, 1/256 m, to one on Earth. FF_OK, or FF_ERR_RANGE: the projection shows
 * nothing there. */
int ff_geo_of(const ff_geo *geo, const int32_t position_wu[3], ff_geo_place *place);
/* And back, to the nearest unit. FF_ERR_RANGE: the projection does not show it, or it lies beyond
 * the world's coordinates. The ground may end long before. */
int ff_geo_to(const ff_geo *geo, const ff_geo_place *place, int32_t position_wu[3]);
/* The yaw (1/65536 turn) at which a viewer there looks true north. A heading is yaw minus that, and
 * a yaw heading plus that. */
int ff_geo_north(const ff_geo *geo, const int32_t position_wu[3], int32_t *north_brad16);

#endif
