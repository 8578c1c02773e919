#include "bake_unit.h"

#include "../bake_say.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ABSURD_PLAIN_M 1e7 /* plain images may stand for anything */
#define SPELLING_BYTES 64
#define FOOT_M         0.3048
#define SURVEY_FOOT_M  (1200.0 / 3937)

/* ---- spellings ---- */

/* Letters and digits alone, in lower case: "US survey foot", "US_survey_foot" and "us-ft" lose what
 * differs between programs. Names as GDAL's drivers, PROJ, ESRI's tools and CF write them. */
static const struct {
    double metres;
    const char *spellings; /* each between two spaces */
} units[] = {
    { 1, " m metre metres meter meters mtr mt gpm masl mamsl mmsl metresabovesealevel "
         "metersabovesealevel metresabovemeansealevel metersabovemeansealevel " },
    { FOOT_M, " ft foot feet ftint ftintl ftinternational ift ifoot internationalfoot "
              "internationalfeet footinternational feetinternational intfoot intlfoot fti ftamsl "
              "ftmsl feetabovesealevel " },
    { SURVEY_FOOT_M,
      " ftus usft usfoot usfeet footus feetus ussurveyfoot ussurveyfeet ussurveyft "
      "ussft surveyfoot surveyfeet surveyft footussurvey feetussurvey ftussurvey sft "
      "footsurveyus usasurveyfoot " },
    { 1000, " km kilometre kilometres kilometer kilometers " },
    { 100, " hm hectometre hectometres hectometer hectometers " },
    { 10, " dam decametre decametres decameter decameters " },
    { 0.1, " dm decimetre decimetres decimeter decimeters " },
    { 0.01, " cm centimetre centimetres centimeter centimeters " },
    { 0.001, " mm millimetre millimetres millimeter millimeters " },
    { 6 * FOOT_M, " fathom fathoms fath fth ftm " },
    { 3 * FOOT_M, " yd yds yard yards internationalyard " },
    { 3 * SURVEY_FOOT_M, " usyd ydus usyard ussurveyyard " },
    { FOOT_M / 12, " in inch inches internationalinch " },
    { SURVEY_FOOT_M / 12, " usin inus usinch ussurveyinch " },
    { 0.3047972654, " clarkefoot clarkesfoot " },
    { 0.30479951024814694, " indft indianfoot " },
};

/* 0 when nothing is left, or too much. */
static int normalise(const char *spelling, char *plain)
{
    size_t count = 0;
    plain[count++] = ' ';
    for (; *spelling; spelling++) {
        if (!isalnum((unsigned char)*spelling)) continue;
        if (count + 2 >= SPELLING_BYTES) return 0;
        plain[count++] = (char)tolower((unsigned char)*spelling);
    }
    plain[count++] = ' ';
    plain[count] = 0;
    return count > 2;
}

double bake_unit_metres(const char *spelling)
{
    char plain[SPELLING_BYTES], *after;
    double count = strtod(spelling, &after); /* "0.1 m" */
    if (after == spelling) count = 1;
    if (!(count > 0) || !isfinite(count) || !normalise(after, plain)) return 0;
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (strstr(units[i].spellings, plain)) return count * units[i].metres;
    return 0;
}

/* ---- the raster's own ---- */

/* Metres a unit of the vertical part of a compound reference system, or 1. The ground keeps only
 * the horizontal part. */
static double vertical_metres(GDALDatasetH set)
{
    OGRSpatialReferenceH srs = GDALGetSpatialRef(set);
    if (!srs || !OSRIsCompound(srs)) return 1;
    double metres = OSRGetTargetLinearUnits(srs, "COMPD_CS|VERT_CS", NULL);
    return metres > 0 && isfinite(metres) ? metres : 1;
}

static double unit_metres(const bake_options *o, GDALDatasetH set)
{
    const char *spelling = GDALGetRasterUnitType(GDALGetRasterBand(set, 1));
    if (!spelling || !*spelling) return vertical_metres(set);
    double metres = bake_unit_metres(spelling);
    if (metres > 0) return metres;
    bake_note("%s: the unit of its heights, \"%.40s\", is not known: taken as metres; --scale says "
              "how many metres it has",
              o->heights_path, spelling);
    return 1;
}

/* ---- how far from 0 ---- */

/* By the mean radius of the ellipsoid: relief is higher where gravity is less. */
static double absurd_m(const bake_ground *ground)
{
    static const struct {
        double radius_m, absurd_m;
    } bodies[] = {
        { 6371008.8, 12000 }, /* Earth: -10.9 to 8.8 km */
        { 6051800, 20000 },   /* Venus: -3 to 11 km */
        { 3389500, 30000 },   /* Mars: -8.2 to 21.2 km */
        { 2439700, 20000 },   /* Mercury: -5.4 to 4.5 km */
        { 1737400, 20000 },   /* the Moon: -9.1 to 10.8 km */
    };
    if (!ground->srs) return ABSURD_PLAIN_M;
    OGRErr error = OGRERR_NONE;
    double radius_m = OSRGetSemiMajor(ground->srs, &error);
    if (error != OGRERR_NONE) return bodies[0].absurd_m;
    for (size_t i = 0; i < sizeof bodies / sizeof *bodies; i++)
        if (fabs(radius_m / bodies[i].radius_m - 1) < 0.01) return bodies[i].absurd_m;
    return radius_m / 2; /* of a small body relief is a large part */
}

bake_unit bake_unit_read(const bake_options *o, GDALDatasetH set, const bake_rgb *rgb,
                         const bake_ground *ground)
{
    GDALRasterBandH band = GDALGetRasterBand(set, 1);
    GDALDataType type = GDALGetRasterDataType(band);
    int is_plain = !ground->has_place && (type == GDT_Byte || type == GDT_UInt16 || o->raw.width);
    bake_unit unit = { .scale = 1, .absurd_m = absurd_m(ground) };
    if (rgb->scale > 0) {
        double metres = o->scale > 0 ? o->scale : 1;
        unit.is_rgb = 1;
        unit.scale = rgb->scale * metres;
        unit.offset = rgb->offset * metres;
    } else if (o->scale > 0) {
        unit.scale = o->scale;
    } else if (is_plain && o->hscale_m > 0) {
        unit.scale = o->hscale_m;
    } else {
        double metres = unit_metres(o, set);
        unit.scale = GDALGetRasterScale(band, NULL) * metres;
        unit.offset = GDALGetRasterOffset(band, NULL) * metres;
    }
    return unit;
}
