#include "bake_info_about.h"

#include "../../protocol/geo/ff_geo.h"
#include "../../protocol/shape/ff_shape.h"

#include <inttypes.h>
#include <stdio.h>

#define NANO 1e9

/* EPSG's codes of parameters that are factors; the others are angles or lengths. */
static int is_factor(uint16_t code) { return code == 8805 || code == 8815 || code == 8819; }
static int is_length(uint16_t code)
{
    return code == 8806 || code == 8807 || code == 8816 || code == 8817 || code == 8826 ||
           code == 8827;
}

static void print_projection(const ff_about_projection *projection)
{
    printf("projection      method EPSG:%u, ellipsoid of %.3f m and 1/%.12g", projection->method,
           (double)projection->semi_major_um / 1e6, (double)projection->inverse_flattening / NANO);
    for (uint32_t i = 0; i < projection->parameter_count; i++) {
        int64_t value;
        uint16_t code = ff_about_parameter(projection, i, &value);
        double unit = is_factor(code) ? 1e12 : is_length(code) ? 1e6 : NANO;
        printf("%s EPSG:%u %.12g%s", i ? "," : "; parameters", code, (double)value / unit,
               is_factor(code)   ? ""
               : is_length(code) ? " m"
                                 : " degrees");
    }
    putchar('\n');
}

#define CORNERS 4
static const char *const corner_name[CORNERS] = { "south-west", "south-east", "north-west",
                                                  "north-east" };

/* The corners of the ground on Earth. FF_OK, or why they cannot be told. */
static int find_corners(const ff_pack *pack, ff_geo_place corner[CORNERS])
{
    int64_t size_wu[2];
    ff_geo geo;
    int rc = ff_geo_pack(&geo, pack);
    ff_shape_size_wu(&pack->header.info, size_wu);
    for (int i = 0; rc == FF_OK && i < CORNERS; i++) {
        const int32_t at_wu[3] = { i & 1 ? (int32_t)size_wu[0] : 0, i & 2 ? (int32_t)size_wu[1] : 0,
                                   0 };
        rc = ff_geo_of(&geo, at_wu, &corner[i]);
    }
    return rc;
}

static void print_corners(const ff_pack *pack)
{
    ff_geo_place corner[CORNERS];
    int rc = find_corners(pack, corner);
    printf("corners        ");
    if (rc != FF_OK)
        printf(" not told in degrees: the projection is %s",
               rc == FF_ERR_UNSUPPORTED ? "of a method that clients do not know" : "out of range");
    for (int i = 0; rc == FF_OK && i < CORNERS; i++)
        printf("%s %s %.6f,%.6f", i ? "," : "", corner_name[i],
               (double)corner[i].latitude_e9 / NANO, (double)corner[i].longitude_e9 / NANO);
    putchar('\n');
}

void bake_info_about(const ff_pack *pack)
{
    static const char *const label[] = { "",        "name", "attribution",
                                         "licence", "date", "heights above" };
    ff_about_projection projection;
    const uint8_t *whole;
    ff_list_entry entry;
    ff_list about, rest;
    int rc = ff_pack_about(pack, &about);
    if (rc == FF_ERR_NOT_FOUND) return;
    if (rc != FF_OK) {
        printf("about           %s\n", ff_error_text(rc));
        return;
    }
    for (rest = about; ff_list_next(&rest, &entry) > 0;)
        if (entry.type <= FF_ABOUT_VERTICAL)
            printf("%-15s %.*s\n", label[entry.type], (int)entry.byte_count,
                   (const char *)entry.value);
    if (ff_list_find(about, FF_ABOUT_WHOLE, &whole) > 0)
        printf("part of         the pack with checksum %08" PRIx32 "\n", ff_about_whole(about, 0));
    if (ff_about_get_projection(about, &projection) != FF_OK) return;
    print_projection(&projection);
    print_corners(pack);
}

/* Texts have no control characters: only these two are to be marked. */
void bake_info_print_text(const uint8_t *text, uint32_t byte_count)
{
    putchar('"');
    for (uint32_t i = 0; i < byte_count; i++) {
        if (text[i] == '"' || text[i] == '\\') putchar('\\');
        putchar(text[i]);
    }
    putchar('"');
}

static void print_numbers(ff_list about)
{
    ff_about_projection projection;
    if (ff_about_get_projection(about, &projection) != FF_OK) return;
    printf("{\"method\": %u, \"semi_major_um\": %" PRId64 ", \"inverse_flattening_e9\": %" PRId64
           ", \"prime_meridian_e9\": %" PRId64 ", \"parameters\": {",
           projection.method, projection.semi_major_um, projection.inverse_flattening,
           projection.prime_meridian);
    for (uint32_t i = 0; i < projection.parameter_count; i++) {
        int64_t value;
        uint16_t code = ff_about_parameter(&projection, i, &value);
        printf("%s\"%u\": %" PRId64, i ? ", " : "", code, value);
    }
    printf("}}");
}

/* "corners": each [latitude, longitude] in degrees, or null. */
static void print_corners_json(const ff_pack *pack)
{
    ff_geo_place corner[CORNERS];
    int rc = find_corners(pack, corner);
    printf("\"corners\": %s", rc == FF_OK ? "{" : "null, ");
    for (int i = 0; rc == FF_OK && i < CORNERS; i++)
        printf("\"%s\": [%.9f, %.9f]%s", corner_name[i], (double)corner[i].latitude_e9 / NANO,
               (double)corner[i].longitude_e9 / NANO, i + 1 < CORNERS ? ", " : "}, ");
}

void bake_info_about_json(const ff_pack *pack)
{
    static const char *const name[] = { "",
#define X(entry, name, type, form, most) [type] = #name,
                                        FF_ABOUT_LIST(X)
#undef X
    };
    ff_list_entry entry;
    ff_list about, rest;
    int first = 1;
    printf("\"about\": {");
    if (ff_pack_about(pack, &about) == FF_OK)
        for (rest = about; ff_list_next(&rest, &entry) > 0;) {
            if (entry.type >= sizeof name / sizeof *name || entry.type == FF_ABOUT_LAYERS) continue;
            printf("%s\"%s\": ", first ? "" : ", ", name[entry.type]);
            first = 0;
            if (entry.type == FF_ABOUT_PROJECTION)
                print_numbers(about);
            else if (entry.type == FF_ABOUT_WHOLE)
                printf("\"%08" PRIx32 "\"", ff_about_whole(about, 0));
            else
                bake_info_print_text(entry.value, entry.byte_count);
        }
    printf("}, ");
    print_corners_json(pack);
}
