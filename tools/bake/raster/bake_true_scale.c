#include "bake_true_scale.h"

#include <math.h>
#include <string.h>

#define STEP_RAD     1e-5 /* 64 m on the Earth: derivatives keep seven digits */
#define COSINE_LEAST 1e-4 /* nearer to a pole, meridians are no axis */

typedef struct scale_rule {
    OGRCoordinateTransformationH to_degrees, to_plane;
    double radian, metre; /* in the units of degrees and plane */
    double a, e2;         /* ellipsoid: major axis, squared eccentricity */
} scale_rule;

/* Singular values of a 2 x 2 matrix: the longest and the shortest image of a unit vector. */
static void stretch(double ax, double ay, double bx, double by, double *most, double *least)
{
    double p = hypot(ax + by, ay - bx), q = hypot(ax - by, ay + bx);
    *most = (p + q) / 2;
    *least = fabs(p - q) / 2;
}

/* Widens `scale` by one place, in the plane of the ground; 0, or -1 when the projection does not
 * show it. */
static int measure(const scale_rule *rule, double x, double y, bake_scale *scale)
{
    if (!OCTTransform(rule->to_degrees, 1, &x, &y, NULL) || !isfinite(x) || !isfinite(y)) return -1;
    double latitude = y / rule->radian, half = STEP_RAD / 2 * rule->radian;
    double px[4] = { x - half, x + half, x, x }, py[4] = { y, y, y - half, y + half };
    if (fabs(cos(latitude)) < COSINE_LEAST || fabs(latitude) > 1.5707963) return -1;
    if (!OCTTransform(rule->to_plane, 4, px, py, NULL)) return -1;
    double w2 = 1 - rule->e2 * sin(latitude) * sin(latitude);
    double east_m = rule->a / sqrt(w2) * cos(latitude) * STEP_RAD;
    double north_m = rule->a * (1 - rule->e2) / (w2 * sqrt(w2)) * STEP_RAD;
    double most, least;
    stretch((px[1] - px[0]) * rule->metre / east_m, (py[1] - py[0]) * rule->metre / east_m,
            (px[3] - px[2]) * rule->metre / north_m, (py[3] - py[2]) * rule->metre / north_m, &most,
            &least);
    if (!isfinite(most) || !isfinite(least)) return -1;
    scale->most = fmax(scale->most, most);
    scale->least = fmin(scale->least, least);
    return 0;
}

static int measure_all(const scale_rule *rule, const bake_ground *ground, bake_scale *scale)
{
    const double *gt = ground->geotransform;
    int measured = 0;
    *scale = (bake_scale){ INFINITY, 0 };
    for (int place = 0; place < 9; place++) {
        double column = place % 3 * 0.5 * ground->grid.width,
               row = place / 3 * 0.5 * ground->grid.height;
        double x = gt[0] + gt[1] * column + gt[2] * row, y = gt[3] + gt[4] * column + gt[5] * row;
        measured += !measure(rule, x, y, scale);
    }
    return measured ? 0 : -1;
}

int bake_true_scale(const bake_ground *ground, OGRSpatialReferenceH projection, bake_scale *scale)
{
    OGRSpatialReferenceH degrees = OSRCloneGeogCS(projection);
    if (!degrees) return -1;
    OSRSetAxisMappingStrategy(degrees, OAMS_TRADITIONAL_GIS_ORDER);
    double a = OSRGetSemiMajor(projection, NULL), b = OSRGetSemiMinor(projection, NULL);
    scale_rule rule = { .to_degrees = OCTNewCoordinateTransformation(ground->srs, degrees),
                        .to_plane = OCTNewCoordinateTransformation(degrees, projection),
                        .radian = 1 / OSRGetAngularUnits(degrees, NULL),
                        .metre = OSRGetLinearUnits(projection, NULL),
                        .a = a,
                        .e2 = 1 - b * b / (a * a) };
    int rc = rule.to_degrees && rule.to_plane ? measure_all(&rule, ground, scale) : -1;
    if (rule.to_degrees) OCTDestroyCoordinateTransformation(rule.to_degrees);
    if (rule.to_plane) OCTDestroyCoordinateTransformation(rule.to_plane);
    OSRDestroySpatialReference(degrees);
    return rc;
}

double bake_scale_error(const bake_scale *scale)
{
    return fmax(fabs(scale->least - 1), fabs(scale->most - 1));
}
