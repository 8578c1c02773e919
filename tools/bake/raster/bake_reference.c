#include "bake_reference.h"

#include <stdlib.h>

#define SURE 90 /* of 100: all parameters are the same, names may differ */

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
