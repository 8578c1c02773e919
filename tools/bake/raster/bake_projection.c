#include "bake_projection.h"

#include "../../../protocol/ff_about.h"
#include "../../../protocol/ff_error.h"
#include "bake_reference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MICRO   1e6
#define NANO    1e9
#define PICO    1e12
#define DEGREES (180 / M_PI)

char *bake_projection_wkt(OGRSpatialReferenceH srs)
{
    static const char *const form[] = { "FORMAT=WKT2_2015", "MULTILINE=NO", NULL };
    OGRSpatialReferenceH named = OSRNewSpatialReference(NULL);
    int epsg = bake_reference_epsg(srs);
    if (epsg && OSRImportFromEPSG(named, epsg) == OGRERR_NONE) srs = named;
    char *wkt = NULL;
    OGRErr rc = OSRExportToWktEx(srs, &wkt, form);
    OSRDestroySpatialReference(named);
    if (rc == OGRERR_NONE && wkt && *wkt) return wkt;
    CPLFree(wkt);
    return NULL;
}

/* ---- the text's parts ---- */

/* The end of the bracket that opens at or behind `at`, or NULL. */
static const char *closing(const char *at)
{
    int depth = 0, quoted = 0;
    for (; *at; at++) {
        if (*at == '"') quoted = !quoted;
        if (quoted) continue;
        depth += *at == '[';
        if (*at == ']' && --depth == 0) return at;
    }
    return NULL;
}

static void leave_out(char *wkt, const char *part)
{
    for (char *at = wkt; (at = strstr(at, part));) {
        const char *end = closing(at);
        if (!end) return;
        memmove(at, end + 1, strlen(end + 1) + 1);
    }
}

void bake_projection_shorten(OGRSpatialReferenceH srs, char *wkt)
{
    char *shorter = CPLStrdup(wkt), *at = shorter;
    OGRSpatialReferenceH again = OSRNewSpatialReference(NULL);
    OSRSetAxisMappingStrategy(again, OSRGetAxisMappingStrategy(srs));
    leave_out(shorter, ",SCOPE[");
    leave_out(shorter, ",AREA[");
    leave_out(shorter, ",BBOX[");
    leave_out(shorter, ",ID[");
    if (OSRImportFromWkt(again, &at) == OGRERR_NONE && OSRIsSame(srs, again)) strcpy(wkt, shorter);
    OSRDestroySpatialReference(again);
    CPLFree(shorter);
}

/* The code in ID["EPSG",code], of what begins at `at` and ends before `end`; 0: it has none. */
static int code_of(const char *at, const char *end)
{
    static const char id[] = "ID[\"EPSG\",";
    const char *found = strstr(at, id);
    return found && found < end ? atoi(found + sizeof id - 1) : 0;
}

/* A parameter's value as a whole number: PARAMETER["name",value,SOMEUNIT["name",size],...]. */
static int fixed_value(const char *at, const char *end, int64_t *value)
{
    const char *number = strstr(at, "\",");
    const char *unit = number ? strstr(number, "UNIT[") : NULL;
    const char *size = unit ? strstr(unit, "\",") : NULL;
    if (!size || size >= end) return 0;
    double in_unit = strtod(number + 2, NULL), unit_size = strtod(size + 2, NULL), whole;
    if (!strncmp(unit - 5, "ANGLE", 5))
        whole = in_unit * unit_size * DEGREES * NANO;
    else if (!strncmp(unit - 6, "LENGTH", 6))
        whole = in_unit * unit_size * MICRO;
    else
        whole = in_unit * unit_size * PICO;
    if (!(fabs(whole) < 9e18)) return 0;
    *value = (int64_t)nearbyint(whole);
    return 1;
}

static int write_parameters(ff_writer *out, const char *at, const char *end)
{
    while ((at = strstr(at, "PARAMETER[")) && at < end) {
        const char *close = closing(at);
        int64_t value;
        int code = close ? code_of(at, close) : 0;
        if (!code || code > UINT16_MAX || !fixed_value(at, close, &value)) return 0;
        ff_write_bytes(out, (uint64_t)code, 2);
        ff_write_bytes(out, (uint64_t)value, 8);
        at = close;
    }
    return 1;
}

uint32_t bake_projection_numbers(OGRSpatialReferenceH srs, const char *wkt,
                                 uint8_t numbers[BAKE_PROJECTION_BYTES_MAX])
{
    ff_writer out = { numbers, numbers + BAKE_PROJECTION_BYTES_MAX, FF_OK };
    const char *conversion = strstr(wkt, "CONVERSION["),
               *end = conversion ? closing(conversion) : NULL,
               *method = conversion ? strstr(conversion, "METHOD[") : NULL,
               *method_end = method ? closing(method) : NULL;
    int code = method_end ? code_of(method, method_end) : 0;
    OGRErr error = OGRERR_NONE;
    double semi_major = OSRGetSemiMajor(srs, &error),
           inverse = error ? 0 : OSRGetInvFlattening(srs, &error);
    if (!end || !code || code > UINT16_MAX || error) return 0;
    ff_write_bytes(&out, (uint64_t)code, 2);
    ff_write_bytes(&out, (uint64_t)nearbyint(semi_major * MICRO), 8);
    ff_write_bytes(&out, isfinite(inverse) ? (uint64_t)nearbyint(inverse * NANO) : 0, 8);
    double meridian = OSRGetPrimeMeridian(srs, NULL);
    ff_write_bytes(&out, (uint64_t)(int64_t)nearbyint(meridian * NANO), 8);
    if (!write_parameters(&out, conversion, end) || out.error != FF_OK) return 0;
    return (uint32_t)(out.at - numbers);
}
