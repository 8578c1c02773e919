/* Which EPSG code a reference system has. */
#ifndef BAKE_REFERENCE_H
#define BAKE_REFERENCE_H

#include "bake_gdal.h"

/* Its own code, or that of the system whose parameters are the same (.prj files name none); 0:
 * none.
 */
int bake_reference_epsg(OGRSpatialReferenceH srs);

#endif
