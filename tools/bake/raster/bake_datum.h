/* What PROJ's table knows of the datum that a reference system is on. */
#ifndef BAKE_DATUM_H
#define BAKE_DATUM_H

#include "bake_area.h"

#include <proj.h>

/* Whether the table has the system of degrees behind `system`, and it stands for a datum: spheres
 * and "unknown, based on an ellipsoid" do not. */
int bake_datum_is_known(PJ_CONTEXT *context, const PJ *system);
/* Whether the degrees behind two systems are the same. */
int bake_datum_is_same(PJ_CONTEXT *context, const PJ *system, const PJ *other);
/* The EPSG code of a plane that ground on the datum of `system` can be projected to without a
 * shift, its own plane first, else the one made for the smallest place round `degrees`; 0: none. */
int bake_datum_plane(PJ_CONTEXT *context, const PJ *system, const bake_area *degrees);

#endif
