#include "bake_curve.h"

#include "bake_gdal.h"
#include "bake_lattice.h"

#include <math.h>

#define EARTH_RADIUS_M   6371008.8 /* mean radius R1 = (2 a + b) / 3 of GRS 80 (Moritz 2000) */
#define EARTH_REFRACTION 0.13      /* Gauss's mean coefficient, as surveyors use it */

static double mean_radius_m(const bake_ground *ground)
{
    OGRSpatialReferenceH srs = ground->source_srs ? ground->source_srs : ground->srs;
    OGRErr error_a = OGRERR_FAILURE, error_b = OGRERR_FAILURE;
    double a = srs ? OSRGetSemiMajor(srs, &error_a) : 0,
           b = srs ? OSRGetSemiMinor(srs, &error_b) : 0;
    return error_a == OGRERR_NONE && error_b == OGRERR_NONE ? (2 * a + b) / 3 : EARTH_RADIUS_M;
}

uint32_t bake_curve_q60(const bake_options *o, const bake_ground *ground)
{
    double radius_m = mean_radius_m(ground), refraction = o->refraction;
    if (o->lattice) return o->lattice->info.curve_q60;
    if (o->flat) return 0;
    if (isnan(refraction))
        refraction = fabs(radius_m / EARTH_RADIUS_M - 1) < 0.01 ? EARTH_REFRACTION : 0;
    double curve_q60 = ldexp((1 - refraction) / (2 * radius_m * FF_WU_PER_METRE), 60);
    return curve_q60 < FF_CURVE_MAX ? (uint32_t)nearbyint(curve_q60) : FF_CURVE_MAX;
}
