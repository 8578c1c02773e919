/* Between the ellipsoid and the planes of map projections: for ff_geo.c. The ellipsoid is taken to
 * a sphere that keeps its angles (conformal latitudes), and the sphere to a plane whose unit is
 * geo->radius_um. */
#ifndef FF_GEO_PROJECT_H
#define FF_GEO_PROJECT_H

#include "ff_geo.h"

/* A plane's own (0, 0): MERCATOR and TRANSVERSE: on the meridian, at the equator. CONE, of which a
 * polar stereographic plane is the flattest: at the pole, and y is -radius where t is 1. */
enum ff_geo_kind { FF_GEO_MERCATOR, FF_GEO_TRANSVERSE, FF_GEO_CONE };

/* Sets the series by n, the third flattening (Karney 2011, eq. 35 and 36; 2023, "On auxiliary
 * latitudes", appendix A): 0 is a sphere. */
void ff_geo_flatten(ff_geo *geo, int64_t n_q56);
/* Conformal latitude from a geographic one. */
int64_t ff_geo_conformal(const ff_geo *geo, int64_t latitude_q56);
/* The logarithm of t, the distance from the north pole in the stereographic plane: minus the
 * isometric latitude. Of -80 degrees on. */
int64_t ff_geo_log_t(int64_t conformal_q56);
/* Latitude, and longitude from the projection's meridian, to x and y in radii, and back. FF_OK or
 * FF_ERR_RANGE. */
int ff_geo_project(const ff_geo *geo, int64_t latitude_q56, int64_t longitude_q56,
                   int64_t xy_q56[2]);
int ff_geo_unproject(const ff_geo *geo, const int64_t xy_q56[2], int64_t *latitude_q56,
                     int64_t *longitude_q56);

#endif
