#include "bake_reference.h"

#include "bake_about.h"

#include <stdlib.h>

#define TEXT_ROOM 4096
#define SURE      90 /* of 100: all parameters are the same, names may differ */

static int epsg_of(OGRSpatialReferenceH srs)
{
    const char *code = OSRGetAuthorityCode(srs, NULL), *name = OSRGetAuthorityName(srs, NULL);
    return code && name && EQUAL(name, "EPSG") ? atoi(code) : 0;
}

/* The code of the only system in the table of EPSG that is equal to this one; 0: none. */
static int find_match(OGRSpatialReferenceH srs)
{
    int count = 0, *sureness = NULL, epsg = 0;
    OGRSpatialReferenceH *match = OSRFindMatches(srs, NULL, &count, &sureness);
    for (int i = 0; i < count && sureness[i] >= SURE && !epsg; i++) epsg = epsg_of(match[i]);
    OSRFreeSRSArray(match);
    CPLFree(sureness);
    return epsg;
}

int bake_reference_epsg(OGRSpatialReferenceH srs)
{
    OGRSpatialReferenceH plane = OSRClone(srs);
    int epsg = epsg_of(plane);
    if (!epsg && OSRAutoIdentifyEPSG(plane) == OGRERR_NONE) epsg = epsg_of(plane);
    if (!epsg) epsg = find_match(plane);
    OSRDestroySpatialReference(plane);
    return epsg;
}

FF_STATIC_ASSERT(TEXT_ROOM >= FF_ABOUT_BYTES_MAX);

OGRSpatialReferenceH bake_reference_of(const ff_pack *pack)
{
    OGRSpatialReferenceH srs = OSRNewSpatialReference(NULL);
    char text[TEXT_ROOM] = "", *at = text;
    ff_list about;
    int epsg = pack->header.info.epsg;
    OSRSetAxisMappingStrategy(srs, OAMS_TRADITIONAL_GIS_ORDER);
    if (epsg && OSRImportFromEPSG(srs, epsg) == OGRERR_NONE) return srs;
    if (ff_pack_about(pack, &about) == FF_OK)
        bake_about_text(about, FF_ABOUT_WKT, text, sizeof text);
    if (*text && OSRImportFromWkt(srs, &at) == OGRERR_NONE) return srs;
    OSRDestroySpatialReference(srs);
    return NULL;
}
