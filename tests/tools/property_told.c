#include "property_told.h"

#include <math.h>
#include <proj.h>
#include <stdio.h>
#include <string.h>

#define AREA_DEGREES 0.01

static PJ *system_of(PJ_CONTEXT *context, OGRSpatialReferenceH srs)
{
    char *wkt = NULL;
    static const char *const form[] = { "FORMAT=WKT2_2019", NULL };
    OSRExportToWktEx(srs, &wkt, form);
    PJ *system = proj_create(context, wkt);
    CPLFree(wkt);
    return system;
}

/* Whether the name, steps with " + " between them, tells steps of the operation. */
static int is_named(PJ_CONTEXT *context, const PJ *way, const char *name)
{
    char whole[1000] = "";
    int steps = proj_concatoperation_get_step_count(context, way);
    for (int i = 0; i < steps; i++) {
        PJ *step = proj_concatoperation_get_step(context, way, i);
        if (proj_get_type(step) != PJ_TYPE_CONVERSION &&
            proj_coordoperation_get_accuracy(context, step) != 0)
            snprintf(whole + strlen(whole), sizeof whole - strlen(whole), "%s%s",
                     *whole ? " + " : "", proj_get_name(step));
        proj_destroy(step);
    }
    return !strcmp(steps > 0 ? whole : proj_get_name(way), name);
}

/* PROJ's words for the operation of that name and accuracy; empty: there is none. */
static void find_operation(const property_draw *d, OGRSpatialReferenceH pack, const char *name,
                           double accuracy_m, char *words, size_t size)
{
    PJ_CONTEXT *context = proj_context_create();
    OGRSpatialReferenceH srs = property_reference(d->place->srs);
    PJ *from = system_of(context, srs), *to = system_of(context, pack);
    PJ_OPERATION_FACTORY_CONTEXT *factory = proj_create_operation_factory_context(context, NULL);
    double west = remainder(d->longitude - AREA_DEGREES, 360),
           east = remainder(d->longitude + AREA_DEGREES, 360);
    proj_operation_factory_context_set_area_of_interest(
        context, factory, west, d->latitude - AREA_DEGREES, east, d->latitude + AREA_DEGREES);
    proj_operation_factory_context_set_spatial_criterion(
        context, factory, PROJ_SPATIAL_CRITERION_PARTIAL_INTERSECTION);
    PJ_OBJ_LIST *list = proj_create_operations(context, from, to, factory);
    *words = 0;
    for (int i = 0; i < proj_list_get_count(list) && !*words; i++) {
        PJ *way = proj_list_get(context, list, i);
        double accuracy = proj_coordoperation_get_accuracy(context, way);
        if (accuracy < 0) accuracy = INFINITY;
        if (is_named(context, way, name) &&
            (accuracy == accuracy_m || fabs(accuracy / accuracy_m - 1) < 0.01))
            snprintf(words, size, "%s", proj_as_proj_string(context, way, PJ_PROJ_5, NULL));
        proj_destroy(way);
    }
    proj_list_destroy(list);
    proj_operation_factory_context_destroy(factory);
    proj_destroy(from);
    proj_destroy(to);
    proj_context_destroy(context);
    OSRDestroySpatialReference(srs);
}

/* Reads name and accuracy from the summary; 0: there is a shift. */
static int read_summary(const char *json, char name[300], double *accuracy_m)
{
    const char *at = strstr(json, "\"datum_shift\": \"");
    int got = at ? sscanf(at, "\"datum_shift\": \"%299[^\"]\", \"datum_shift_m\": %lf", name,
                          accuracy_m)
                 : 0;
    if (got == 1) *accuracy_m = INFINITY;
    return got > 0 ? 0 : -1;
}

int property_told_read(const property_draw *d, const char *json, const char *said,
                       OGRSpatialReferenceH pack, double cell_m, property_told *told)
{
    char name[300], words[2000];
    *told = (property_told){ 0 };
    if (read_summary(json, name, &told->accuracy_m)) return 0;
    int is_noted = strstr(said, ": shifted from ") ||
                   strstr(said, "names no datum that PROJ knows");
    if (!is_noted && told->accuracy_m > cell_m / 2) return -1;
    find_operation(d, pack, name, told->accuracy_m, words, sizeof words);
    if (!*words) return -1;
    OGRSpatialReferenceH srs = property_reference(d->place->srs);
    OGRCoordinateTransformationOptionsH options = OCTNewCoordinateTransformationOptions();
    OCTCoordinateTransformationOptionsSetOperation(options, words, TRUE);
    told->to_source = OCTNewCoordinateTransformationEx(pack, srs, options);
    OCTDestroyCoordinateTransformationOptions(options);
    OSRDestroySpatialReference(srs);
    if (strstr(said, "not all of this lies there")) told->accuracy_m = INFINITY;
    return told->to_source ? 0 : -1;
}

void property_told_free(property_told *told)
{
    if (told->to_source) OCTDestroyCoordinateTransformation(told->to_source);
    *told = (property_told){ 0 };
}

double property_told_offset(const property_draw *d, const property_told *told,
                            OGRSpatialReferenceH pack, double x, double y)
{
    double u = x, v = y;
    OGRSpatialReferenceH srs = property_reference(d->place->srs);
    OGRCoordinateTransformationH best = property_transformation(d, srs, pack);
    int ok = OCTTransform(told->to_source, 1, &u, &v, NULL) && best &&
             OCTTransform(best, 1, &u, &v, NULL);
    if (best) OCTDestroyCoordinateTransformation(best);
    OSRDestroySpatialReference(srs);
    return ok ? hypot(u - x, v - y) : INFINITY;
}
