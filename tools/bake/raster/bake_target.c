#include "bake_target.h"

#include "../bake_say.h"
#include "bake_area.h"
#include "bake_true_scale.h"

#include <math.h>
#include <stdio.h>

#define LONGITUDES_MAX 20.0      /* further from its middle a UTM zone shows another Earth */
#define EARTH_RADIUS_M 6371008.8 /* mean radius */
#define ERROR_NOTED    0.002     /* UTM itself has 0.001 at the rim of a zone */
#define ERROR_MAX      0.01      /* with more, the ground is projected where that is better */

static int is_of_earth(OGRSpatialReferenceH srs)
{
    return fabs(OSRGetSemiMajor(srs, NULL) / EARTH_RADIUS_M - 1) < 0.01;
}

/* The UTM zone (polar: UPS) round a place, as an EPSG code of WGS84. */
static int local_zone(double longitude, double latitude)
{
    if (latitude > 84) return 32661;
    if (latitude < -80) return 32761;
    int zone = ((int)floor((longitude + 180) / 6) % 60 + 60) % 60 + 1;
    return (latitude < 0 ? 32700 : 32600) + zone;
}

/* Middle of the ground in `degrees`. */
static int middle_of(const bake_ground *ground, OGRSpatialReferenceH degrees, double *longitude,
                     double *latitude)
{
    const double *gt = ground->geotransform;
    double column = ground->grid.width / 2.0, row = ground->grid.height / 2.0;
    *longitude = gt[0] + gt[1] * column + gt[2] * row;
    *latitude = gt[3] + gt[4] * column + gt[5] * row;
    CPLErrorReset();
    OGRCoordinateTransformationH to = OCTNewCoordinateTransformation(ground->srs, degrees);
    int ok = to && OCTTransform(to, 1, longitude, latitude, NULL);
    if (to) OCTDestroyCoordinateTransformation(to);
    return ok ? 0 : bake_fail_gdal("cannot tell where on the Earth the raster lies");
}

/* Whether an axis of a plane points west, as in southern Africa or Bohemia: kept as it is, ground
 * would lie turned round in a pack, or mirrored. */
static int runs_west(OGRSpatialReferenceH srs)
{
    OGRAxisOrientation axis[2] = { OAO_Other, OAO_Other };
    for (int i = 0; i < 2; i++) OSRGetAxis(srs, "PROJCS", i, &axis[i]);
    return OSRIsProjected(srs) && (axis[0] == OAO_West || axis[1] == OAO_West);
}

/* Whether the code is one of a plane in metres; `target` becomes that. */
static int is_plane(OGRSpatialReferenceH target, int epsg)
{
    CPLErrorReset();
    return OSRImportFromEPSG(target, epsg) == OGRERR_NONE && OSRIsProjected(target) &&
           fabs(OSRGetLinearUnits(target, NULL) - 1) < 1e-9 && !runs_west(target);
}

int bake_target_suits(int epsg)
{
    OGRSpatialReferenceH target = OSRNewSpatialReference(NULL);
    int suits = is_plane(target, epsg);
    OSRDestroySpatialReference(target);
    return suits;
}

static int set_epsg(OGRSpatialReferenceH target, int epsg)
{
    if (is_plane(target, epsg)) return 0;
    return bake_fail("EPSG:%d is no projection in metres whose axes point east and north", epsg);
}

/* Makes `target` the local projection of the ground. */
static int set_local(const bake_ground *ground, OGRSpatialReferenceH target)
{
    double longitude, latitude;
    int on_earth = is_of_earth(ground->srs);
    OGRSpatialReferenceH degrees = on_earth ? OSRNewSpatialReference(NULL)
                                            : OSRCloneGeogCS(ground->srs);
    if (on_earth) OSRImportFromEPSG(degrees, 4326);
    OSRSetAxisMappingStrategy(degrees, OAMS_TRADITIONAL_GIS_ORDER);
    int rc = middle_of(ground, degrees, &longitude, &latitude);
    if (!rc && on_earth) {
        rc = set_epsg(target, local_zone(longitude, latitude));
    } else if (!rc) {
        OSRSetProjCS(target, "local transverse Mercator");
        OSRCopyGeogCSFrom(target, degrees);
        OSRSetTM(target, latitude, longitude, 1, 0, 0);
        OSRSetLinearUnits(target, "metre", 1);
    }
    OSRDestroySpatialReference(degrees);
    return rc;
}

/* Makes `target` what is asked for, or the local projection. */
static int set_target(const bake_options *o, const bake_ground *ground, OGRSpatialReferenceH target)
{
    bake_area area = bake_area_of(ground->geotransform, ground->grid.width, ground->grid.height);
    double wide = (area.east - area.west) * 57.29577951308232;
    if (o->target_epsg) return set_epsg(target, o->target_epsg);
    if (ground->is_geographic) wide *= OSRGetAngularUnits(ground->srs, NULL);
    if (ground->is_geographic && wide > LONGITUDES_MAX)
        return bake_fail("%.0f degrees of longitude are too wide for a UTM zone: name a projection "
                         "with --t-srs, or cut a part with gdal_translate -projwin",
                         wide);
    return set_local(ground, target);
}

static const char *name_of(OGRSpatialReferenceH srs)
{
    const char *name = OSRGetName(srs);
    return name ? name : "without a name";
}

static void note_scale(OGRSpatialReferenceH srs, const bake_scale *scale, const char *what)
{
    bake_note("projection %s shows a metre of this ground as %.3f to %.3f m: %s", name_of(srs),
              scale->least, scale->most, what);
}

/* Projects ground whose plane has an axis that points west, unless it is told to stay. */
static int turn_east(const bake_options *o, const bake_ground *ground, OGRSpatialReferenceH target)
{
    int better = !o->no_project && !set_local(ground, target);
    if (better)
        bake_note("an axis of %s points west: projected to %s", name_of(ground->srs),
                  name_of(target));
    else
        bake_note("an axis of %s points west, and so the pack's north is another: kept; --t-srs "
                  "names another",
                  name_of(ground->srs));
    return better;
}

/* Whether the ground is better projected to the local projection, which `target` becomes, than kept
 * in its plane of metres: that is far from true to scale, and the local one much nearer. */
static int is_better(const bake_options *o, const bake_ground *ground, OGRSpatialReferenceH target)
{
    bake_scale now, then;
    if (runs_west(ground->srs)) return turn_east(o, ground, target);
    if (bake_true_scale(ground, ground->srs, &now) || bake_scale_error(&now) <= ERROR_NOTED)
        return 0;
    int better = !o->no_project && bake_scale_error(&now) > ERROR_MAX &&
                 !set_local(ground, target) && !bake_true_scale(ground, target, &then) &&
                 bake_scale_error(&then) < bake_scale_error(&now) / 2;
    char what[200];
    if (better)
        snprintf(what, sizeof what, "projected to %s", name_of(target));
    else
        snprintf(what, sizeof what, "kept; --t-srs names another");
    note_scale(ground->srs, &now, what);
    return better;
}

static int is_in_metres(const bake_ground *ground)
{
    return !ground->is_geographic && fabs(OSRGetLinearUnits(ground->srs, NULL) - 1) < 1e-9;
}

int bake_target_choose(const bake_options *o, const bake_ground *ground,
                       OGRSpatialReferenceH *chosen)
{
    *chosen = NULL;
    int in_metres = ground->srs && is_in_metres(ground);
    if (!ground->srs || (o->no_project && (!in_metres || o->spacing_m > 0))) return 0;
    OGRSpatialReferenceH target = OSRNewSpatialReference(NULL);
    OSRSetAxisMappingStrategy(target, OAMS_TRADITIONAL_GIS_ORDER);
    int is_plain = in_metres && !o->target_epsg, rc = is_plain ? 0 : set_target(o, ground, target);
    int stays = is_plain ? !is_better(o, ground, target) : rc || OSRIsSame(target, ground->srs);
    if (stays)
        OSRDestroySpatialReference(target);
    else
        *chosen = target;
    return rc;
}

void bake_target_note(const bake_ground *ground, OGRSpatialReferenceH target)
{
    bake_scale scale;
    if (!bake_true_scale(ground, target, &scale) && bake_scale_error(&scale) > ERROR_MAX)
        note_scale(target, &scale, "distances in the pack are not true");
}
