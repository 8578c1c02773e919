#include "bake_shift.h"

#include "../bake_say.h"
#include "bake_datum.h"

#include <math.h>
#include <proj.h>
#include <stdio.h>
#include <string.h>

#define NOTED_PART 0.5 /* of a cell */

/* What is looked for. */
typedef struct search {
    PJ_CONTEXT *context;
    PJ *from, *to;
    const bake_area *area;
    double x[5], y[5]; /* middle and corners of the area, in `from`; infinite where it has none */
} search;

static void copy_text(char *text, size_t size, const char *from)
{
    snprintf(text, size, "%s", from ? from : "");
}

static void add_text(char *text, size_t size, const char *between, const char *more)
{
    size_t used = strlen(text);
    snprintf(text + used, size - used, "%s%s", used ? between : "", more);
}

/* ---- PROJ's list ---- */

/* All operations that touch the area, best first. */
static PJ_OBJ_LIST *list_operations(const search *s, PROJ_GRID_AVAILABILITY_USE use)
{
    const bake_area *a = s->area;
    PJ_OPERATION_FACTORY_CONTEXT *factory = proj_create_operation_factory_context(s->context, NULL);
    if (!factory) return NULL;
    proj_operation_factory_context_set_area_of_interest(s->context, factory, a->west, a->south,
                                                        a->east, a->north);
    proj_operation_factory_context_set_spatial_criterion(
        s->context, factory, PROJ_SPATIAL_CRITERION_PARTIAL_INTERSECTION);
    proj_operation_factory_context_set_grid_availability_use(s->context, factory, use);
    PJ_OBJ_LIST *list = proj_create_operations(s->context, s->from, s->to, factory);
    proj_operation_factory_context_destroy(factory);
    return list;
}

/* Whether the operation can be handed on, and has an image of the whole area: a grid may end before
 * its area of use. */
static int reaches(const search *s, PJ *operation)
{
    const char *words = proj_as_proj_string(s->context, operation, PJ_PROJ_5, NULL);
    if (!words || strlen(words) >= BAKE_OPERATION_MAX) return 0;
    PJ *plain = proj_normalize_for_visualization(s->context, operation);
    int ok = plain != NULL;
    for (int i = 0; ok && i < 5; i++) {
        if (!isfinite(s->x[i]) || !isfinite(s->y[i])) continue;
        PJ_COORD c = proj_trans(plain, PJ_FWD, proj_coord(s->x[i], s->y[i], 0, HUGE_VAL));
        ok = isfinite(c.xy.x) && isfinite(c.xy.y);
    }
    if (plain) proj_destroy(plain);
    return ok;
}

/* The best operation that can be done here and reaches all of the area; else the best one. Owned by
 * the caller; NULL: none. */
static PJ *choose(const search *s)
{
    PJ_OBJ_LIST *list = list_operations(
        s, proj_context_is_network_enabled(s->context)
               ? PROJ_GRID_AVAILABILITY_KNOWN_AVAILABLE
               : PROJ_GRID_AVAILABILITY_DISCARD_OPERATION_IF_MISSING_GRID);
    int count = list ? proj_list_get_count(list) : 0;
    PJ *chosen = NULL;
    for (int i = 0; i < count && !chosen; i++) {
        chosen = proj_list_get(s->context, list, i);
        if (chosen && !reaches(s, chosen)) {
            proj_destroy(chosen);
            chosen = NULL;
        }
    }
    if (!chosen && count) chosen = proj_list_get(s->context, list, 0);
    if (list) proj_list_destroy(list);
    return chosen;
}

/* ---- a better one ---- */

/* Whether the operation is meant for all of the area; *size is how large a place it is for. */
static int is_meant_for(const search *s, PJ *operation, double *size)
{
    const bake_area *a = s->area;
    double west, south, east, north;
    if (!proj_get_area_of_use(s->context, operation, &west, &south, &east, &north, NULL)) return 0;
    if (east < west) east += 360;
    double wide = a->east < a->west ? a->east + 360 - a->west : a->east - a->west;
    double from = a->west < west ? a->west + 360 : a->west;
    *size = (east - west) * (north - south);
    return from + wide <= east && a->south >= south && a->north <= north;
}

static void name_grids(const search *s, PJ *operation, bake_shift *shift)
{
    *shift->grids = 0;
    int count = proj_coordoperation_get_grid_used_count(s->context, operation);
    for (int i = 0; i < count; i++) {
        const char *name = NULL;
        int is_here = 1;
        proj_coordoperation_get_grid_used(s->context, operation, i, &name, NULL, NULL, NULL, NULL,
                                          NULL, &is_here);
        if (name && !is_here) add_text(shift->grids, sizeof shift->grids, " and ", name);
    }
}

/* Finds the operation made for the smallest place round the area that is better than the chosen
 * one, and lacks its grids. States' areas of use are boxes that reach over one another: the
 * smallest is the likeliest to have the area in it. */
static void find_better(const search *s, bake_shift *shift)
{
    PJ_OBJ_LIST *list = list_operations(s, PROJ_GRID_AVAILABILITY_IGNORED);
    int count = list ? proj_list_get_count(list) : 0;
    double smallest = INFINITY, size;
    for (int i = 0; i < count; i++) {
        PJ *operation = proj_list_get(s->context, list, i);
        double accuracy_m = operation ? proj_coordoperation_get_accuracy(s->context, operation)
                                      : -1;
        if (accuracy_m >= 0 && (shift->accuracy_m < 0 || accuracy_m < shift->accuracy_m) &&
            !proj_coordoperation_is_instantiable(s->context, operation) &&
            is_meant_for(s, operation, &size) && size < smallest) {
            smallest = size;
            shift->grids_m = accuracy_m;
            name_grids(s, operation, shift);
        }
        if (operation) proj_destroy(operation);
    }
    if (list) proj_list_destroy(list);
}

/* ---- the area ---- */

/* The box of all places that are known, their longitudes taken round that of the first of them. 0,
 * or -1: none is. */
static int bound(const double *x, const double *y, int count, bake_area *area)
{
    double first = NAN;
    *area = (bake_area){ 0, INFINITY, 0, -INFINITY };
    for (int i = 0; i < count; i++) {
        if (!isfinite(x[i]) || !isfinite(y[i])) continue;
        if (isnan(first)) first = x[i];
        double beside = remainder(x[i] - first, 360);
        area->west = fmin(area->west, beside);
        area->east = fmax(area->east, beside);
        area->south = fmin(area->south, y[i]);
        area->north = fmax(area->north, y[i]);
    }
    int is_round = area->east - area->west > 180;
    area->west = is_round ? -180 : remainder(first + area->west, 360);
    area->east = is_round ? 180 : remainder(first + area->east, 360);
    return isnan(first) ? -1 : 0;
}

static OGRSpatialReferenceH wgs84(void)
{
    OGRSpatialReferenceH degrees = OSRNewSpatialReference(NULL);
    OSRImportFromEPSG(degrees, 4326);
    OSRSetAxisMappingStrategy(degrees, OAMS_TRADITIONAL_GIS_ORDER);
    return degrees;
}

int bake_shift_area(OGRSpatialReferenceH srs, const double *gt, uint32_t width, uint32_t height,
                    bake_area *area)
{
    double x[9], y[9];
    for (int i = 0; i < 9; i++) { /* the middle first */
        double column = (i + 4) % 9 % 3 * 0.5 * width, row = (i + 4) % 9 / 3 * 0.5 * height;
        x[i] = gt[0] + gt[1] * column + gt[2] * row;
        y[i] = gt[3] + gt[4] * column + gt[5] * row;
    }
    OGRSpatialReferenceH degrees = wgs84();
    OGRCoordinateTransformationH to = OCTNewCoordinateTransformation(srs, degrees);
    if (to) OCTTransform(to, 9, x, y, NULL);
    OSRDestroySpatialReference(degrees);
    if (!to) return -1;
    OCTDestroyCoordinateTransformation(to);
    return bound(x, y, 9, area);
}

/* ---- the search ---- */

/* Names what moves the ground: of its steps those that do not only project, or count from another
 * meridian. */
static void name_shift(const search *s, PJ *operation, bake_shift *shift)
{
    int steps = proj_get_type(operation) == PJ_TYPE_CONCATENATED_OPERATION
                    ? proj_concatoperation_get_step_count(s->context, operation)
                    : 0;
    for (int i = 0; i < steps; i++) {
        PJ *step = proj_concatoperation_get_step(s->context, operation, i);
        if (!step) continue;
        if (proj_get_type(step) != PJ_TYPE_CONVERSION &&
            proj_coordoperation_get_accuracy(s->context, step) != 0)
            add_text(shift->name, sizeof shift->name, " + ", proj_get_name(step));
        proj_destroy(step);
    }
    if (!*shift->name) copy_text(shift->name, sizeof shift->name, proj_get_name(operation));
    for (char *c = shift->name; *c; c++)
        if (*c == '"' || *c == '\\') *c = ' ';
}

static void name_degrees(const search *s, const PJ *system, char *name, size_t size)
{
    PJ *degrees = proj_crs_get_geodetic_crs(s->context, system);
    copy_text(name, size, degrees ? proj_get_name(degrees) : "its datum");
    if (degrees) proj_destroy(degrees);
}

static void describe(const search *s, PJ *operation, bake_shift *shift)
{
    shift->accuracy_m = proj_coordoperation_get_accuracy(s->context, operation);
    shift->is_ballpark = proj_coordoperation_has_ballpark_transformation(s->context, operation);
    if (shift->accuracy_m == 0 && !shift->is_ballpark) return;
    const char *text = proj_as_proj_string(s->context, operation, PJ_PROJ_5, NULL);
    if (!text || strlen(text) >= sizeof shift->operation) return;
    copy_text(shift->operation, sizeof shift->operation, text);
    double size;
    shift->is_beyond = !is_meant_for(s, operation, &size);
    name_shift(s, operation, shift);
    name_degrees(s, s->from, shift->from, sizeof shift->from);
    name_degrees(s, s->to, shift->to, sizeof shift->to);
    find_better(s, shift);
}

static PJ *take_system(PJ_CONTEXT *context, OGRSpatialReferenceH srs)
{
    static const char *const form[] = { "FORMAT=WKT2_2019", NULL };
    char *wkt = NULL;
    PJ *system = OSRExportToWktEx(srs, &wkt, form) == OGRERR_NONE ? proj_create(context, wkt)
                                                                  : NULL;
    CPLFree(wkt);
    return system;
}

/* Takes middle and corners of the area to `from`. */
static void take_places(search *s, OGRSpatialReferenceH from)
{
    const bake_area *a = s->area;
    double east = a->east < a->west ? a->east + 360 : a->east;
    OGRSpatialReferenceH degrees = wgs84();
    OGRCoordinateTransformationH to = OCTNewCoordinateTransformation(degrees, from);
    for (int i = 0; i < 5; i++) {
        s->x[i] = !to ? INFINITY : i == 4 ? (a->west + east) / 2 : i & 1 ? east : a->west;
        s->y[i] = i == 4 ? (a->south + a->north) / 2 : i & 2 ? a->north : a->south;
    }
    if (to) OCTTransform(to, 5, s->x, s->y, NULL);
    if (to) OCTDestroyCoordinateTransformation(to);
    OSRDestroySpatialReference(degrees);
}

/* Refuses to take degrees of one known datum for those of another, with what to do. */
static int refuse(const char *path, const bake_shift *shift, const char *otherwise)
{
    char advice[500] = "";
    if (*shift->grids)
        snprintf(advice, sizeof advice, "install %s for it (accurate to %.3g m)", shift->grids,
                 shift->grids_m);
    if (shift->stay_epsg) {
        char stay[80];
        snprintf(stay, sizeof stay, "keep its datum with --t-srs EPSG:%d", shift->stay_epsg);
        add_text(advice, sizeof advice, ", or ", stay);
    }
    if (otherwise) add_text(advice, sizeof advice, ", or ", otherwise);
    if (!*advice)
        copy_text(advice, sizeof advice, "name another system with gdal_translate -a_srs");
    return bake_fail("%s: PROJ knows no shift from %s to %s at this place: %s", path, shift->from,
                     shift->to, advice);
}

int bake_shift_find(const char *path, OGRSpatialReferenceH from, OGRSpatialReferenceH to,
                    const bake_area *degrees, const char *otherwise, bake_shift *shift)
{
    *shift = (bake_shift){ 0 };
    if (!from || !to) return 0;
    search s = { .context = proj_context_create(), .area = degrees };
    proj_log_level(s.context, PJ_LOG_NONE);
    s.from = take_system(s.context, from);
    s.to = take_system(s.context, to);
    int is_moved = s.from && s.to && !bake_datum_is_same(s.context, s.from, s.to);
    if (is_moved) take_places(&s, from);
    PJ *operation = is_moved ? choose(&s) : NULL;
    if (operation) describe(&s, operation, shift);
    if (*shift->operation) {
        shift->is_known = bake_datum_is_known(s.context, s.from) &&
                          bake_datum_is_known(s.context, s.to);
        if (!otherwise) shift->stay_epsg = bake_datum_plane(s.context, s.from, degrees);
    }
    if (operation) proj_destroy(operation);
    if (s.from) proj_destroy(s.from);
    if (s.to) proj_destroy(s.to);
    proj_context_destroy(s.context);
    return shift->is_ballpark && shift->is_known ? refuse(path, shift, otherwise) : 0;
}

void bake_shift_note(const char *path, const bake_shift *shift, double cell_m)
{
    char accuracy[120] = "of unknown accuracy", grids[300] = "", stay[60] = "";
    int is_fine = !shift->is_beyond && shift->accuracy_m >= 0 &&
                  shift->accuracy_m <= NOTED_PART * cell_m;
    if (!*shift->operation || is_fine) return;
    if (shift->is_ballpark) {
        bake_note("%s names no datum that PROJ knows: its degrees are taken for those of %s; "
                  "gdal_translate -a_srs names it",
                  path, shift->to);
        return;
    }
    if (shift->accuracy_m >= 0)
        snprintf(accuracy, sizeof accuracy, "accurate to %.3g m%s", shift->accuracy_m,
                 shift->is_beyond ? " where it is meant for, but not all of this lies there" : "");
    if (*shift->grids)
        snprintf(grids, sizeof grids, " (%.3g m if PROJ had %s)", shift->grids_m, shift->grids);
    if (shift->stay_epsg)
        snprintf(stay, sizeof stay, "; --t-srs EPSG:%d keeps its datum", shift->stay_epsg);
    bake_note("%s: shifted from %s to %s by \"%s\", %s%s%s", path, shift->from, shift->to,
              shift->name, accuracy, grids, stay);
}
