#include "bake_datum.h"

#include "bake_target.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SURE 70 /* of 100: the names differ, but not what they stand for */

/* ---- known datums ---- */

static int is_sphere(PJ_CONTEXT *context, const PJ *degrees)
{
    PJ *ellipsoid = proj_get_ellipsoid(context, degrees);
    double inverse = 0;
    if (ellipsoid) proj_ellipsoid_get_parameters(context, ellipsoid, NULL, NULL, NULL, &inverse);
    if (ellipsoid) proj_destroy(ellipsoid);
    return inverse == 0;
}

static int is_in_table(PJ_CONTEXT *context, const PJ *degrees)
{
    if (proj_get_id_code(degrees, 0)) return 1;
    int *sureness = NULL;
    PJ_OBJ_LIST *list = proj_identify(context, degrees, "EPSG", NULL, &sureness);
    int found = list && proj_list_get_count(list) > 0 && sureness[0] >= SURE;
    if (list) proj_list_destroy(list);
    proj_int_list_destroy(sureness);
    return found;
}

int bake_datum_is_known(PJ_CONTEXT *context, const PJ *system)
{
    PJ *degrees = proj_crs_get_geodetic_crs(context, system),
       *datum = degrees ? proj_crs_get_datum_forced(context, degrees) : NULL;
    const char *name = datum ? proj_get_name(datum) : "unknown";
    int known = strncasecmp(name, "unknown", 7) && strncasecmp(name, "not specified", 13) &&
                !is_sphere(context, degrees) && is_in_table(context, degrees);
    if (datum) proj_destroy(datum);
    if (degrees) proj_destroy(degrees);
    return known;
}

int bake_datum_is_same(PJ_CONTEXT *context, const PJ *system, const PJ *other)
{
    PJ *a = proj_crs_get_geodetic_crs(context, system),
       *b = proj_crs_get_geodetic_crs(context, other);
    int same = a && b &&
               proj_is_equivalent_to_with_ctx(context, a, b,
                                              PJ_COMP_EQUIVALENT_EXCEPT_AXIS_ORDER_GEOGCRS);
    if (a) proj_destroy(a);
    if (b) proj_destroy(b);
    return same;
}

/* ---- planes on a datum ---- */

/* Whether ground on the datum can be projected to the plane of that code. */
static int suits(PJ_CONTEXT *context, const PJ *system, const char *code)
{
    PJ *plane = proj_create_from_database(context, "EPSG", code, PJ_CATEGORY_CRS, 0, NULL);
    int same = plane && bake_datum_is_same(context, system, plane);
    if (plane) proj_destroy(plane);
    return same && bake_target_suits(atoi(code));
}

static double size_of(const PROJ_CRS_INFO *info)
{
    double wide = info->east_lon_degree - info->west_lon_degree;
    return (wide < 0 ? wide + 360 : wide) * (info->north_lat_degree - info->south_lat_degree);
}

/* All planes of the table that are made for places round the area. */
static PROJ_CRS_INFO **list_planes(PJ_CONTEXT *context, const bake_area *area, int *count)
{
    static const PJ_TYPE kinds[] = { PJ_TYPE_PROJECTED_CRS };
    PROJ_CRS_LIST_PARAMETERS *wanted = proj_get_crs_list_parameters_create();
    wanted->types = kinds;
    wanted->typesCount = 1;
    wanted->crs_area_of_use_contains_bbox = 1;
    wanted->bbox_valid = 1;
    wanted->west_lon_degree = area->west;
    wanted->south_lat_degree = area->south;
    wanted->east_lon_degree = area->east;
    wanted->north_lat_degree = area->north;
    PROJ_CRS_INFO **list = proj_get_crs_info_list_from_database(context, "EPSG", wanted, count);
    proj_get_crs_list_parameters_destroy(wanted);
    return list;
}

int bake_datum_plane(PJ_CONTEXT *context, const PJ *system, const bake_area *area)
{
    const char *table = proj_get_id_auth_name(system, 0), *own = proj_get_id_code(system, 0);
    int is_plane = proj_get_type(system) == PJ_TYPE_PROJECTED_CRS && table && own &&
                   !strcmp(table, "EPSG");
    if (is_plane && suits(context, system, own)) return atoi(own);
    int count = 0, epsg = 0;
    PROJ_CRS_INFO **list = list_planes(context, area, &count);
    double smallest = INFINITY;
    for (int i = 0; list && i < count; i++) {
        if (size_of(list[i]) >= smallest || !suits(context, system, list[i]->code)) continue;
        smallest = size_of(list[i]);
        epsg = atoi(list[i]->code);
    }
    proj_crs_info_list_destroy(list);
    return epsg;
}
