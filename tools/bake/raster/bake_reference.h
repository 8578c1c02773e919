/* Which EPSG code a reference system has, and which one a pack has. */
#ifndef BAKE_REFERENCE_H
#define BAKE_REFERENCE_H

#include "../../../protocol/ff_pack.h"
#include "bake_gdal.h"

/* Its own code, or that of the system whose parameters are the same (.prj files name none); 0:
 * none.
 */
int bake_reference_epsg(OGRSpatialReferenceH srs);
/* The reference system of a pack's origin: by its EPSG code, else by its text. To be destroyed;
 * NULL: the pack names none that is known here. */
OGRSpatialReferenceH bake_reference_of(const ff_pack *pack);

#endif
