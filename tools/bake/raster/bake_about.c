#include "bake_about.h"

#include "../../../protocol/ff_error.h"
#include "../../../protocol/geo/ff_geo.h"
#include "bake_projection.h"
#include "../bake_say.h"

#include <stdio.h>
#include <string.h>

#define KEYS_MAX 4

FF_STATIC_ASSERT(FF_ABOUT_VERTICAL == BAKE_ABOUT_TEXTS);

/* Where sources have it, first of those found: our own exports, map tiles, netCDF, TIFF, PNG, DTED.
 */
static const char *const key[BAKE_ABOUT_TEXTS][KEYS_MAX] = {
    { "name", "NC_GLOBAL#title", "TIFFTAG_IMAGEDESCRIPTION", "Title" },
    { "attribution", "TIFFTAG_COPYRIGHT", "NC_GLOBAL#institution", "Copyright" },
    { "licence", "license", "NC_GLOBAL#license" },
    { "date", "TIFFTAG_DATETIME", "NC_GLOBAL#date_created" },
    { "vertical_datum", "DTED_VerticalDatum" },
};
static const char *const option_name[BAKE_ABOUT_TEXTS] = { "name", "attribution", "licence", "date",
                                                           "vertical-datum" };

uint32_t bake_about_most(enum ff_about_entry entry)
{
    switch (entry) {
#define X(entry, name, type, form, most) \
    case FF_ABOUT_##entry: return most;
        FF_ABOUT_LIST(X)
#undef X
    }
    return 0;
}

const char *bake_about_option(enum ff_about_entry entry) { return option_name[entry - 1]; }

/* ---- texts of sources ---- */

/* A mark that stands for a character in HTML, which attributions of map tiles are: 1, and *at
 * behind it. */
static int take_entity(const char **at, const char **meaning)
{
    static const char *const entity[][2] = { { "&amp;", "&" },  { "&lt;", "<" },
                                             { "&gt;", ">" },   { "&quot;", "\"" },
                                             { "&nbsp;", " " }, { "&copy;", "\xc2\xa9" },
                                             { "&#39;", "'" },  { "&#169;", "\xc2\xa9" } };
    for (size_t i = 0; i < sizeof entity / sizeof *entity; i++) {
        size_t length = strlen(entity[i][0]);
        if (strncmp(*at, entity[i][0], length)) continue;
        *at += length;
        *meaning = entity[i][1];
        return 1;
    }
    return 0;
}

/* Leaves out tags and ends of lines. */
static void plain(const char *from, char *to, size_t room)
{
    size_t count = 0;
    while (*from && count + 4 < room) {
        const char *piece = " ", *tag = *from == '<' ? strchr(from, '>') : NULL;
        if (tag && (from[1] == '/' || (unsigned)(from[1] | 32) - 'a' < 26)) {
            from = tag + 1;
            continue;
        }
        if (!take_entity(&from, &piece)) {
            unsigned char c = (unsigned char)*from++;
            if (c > ' ' && c != 0x7f) {
                to[count++] = (char)c;
                continue;
            }
        }
        if (*piece == ' ' && (!count || to[count - 1] == ' ')) continue;
        count += (size_t)sprintf(to + count, "%s", piece);
    }
    while (count && to[count - 1] == ' ') count--;
    to[count] = 0;
}

/* Not longer than allowed, and not cut within a character. */
static void cut(char *text, unsigned entry)
{
    size_t most = bake_about_most(entry);
    if (strlen(text) <= most) return;
    bake_note("the source's %s is longer than %zu bytes: cut; --%s gives another",
              option_name[entry - 1], most, option_name[entry - 1]);
    while (most && ((unsigned char)text[most] & 0xc0) == 0x80) most--;
    text[most] = 0;
}

/* TIFF writes 2008:05:20 11:22:33. */
static void make_date(char *text)
{
    int year, month, day;
    if (sscanf(text, "%4d:%2d:%2d", &year, &month, &day) == 3)
        sprintf(text, "%04d-%02d-%02d", year % 10000, month % 100, day % 100);
}

static void take(const char *found, unsigned entry, char *text)
{
    char *latin = NULL;
    if (entry == FF_ABOUT_VERTICAL && !strcmp(found, "E96"))
        found = "EGM96 height"; /* as in DTED */
    if (entry == FF_ABOUT_VERTICAL && !strcmp(found, "MSL")) found = "mean sea level";
    if (!CPLIsUTF8(found, -1)) found = latin = CPLRecode(found, CPL_ENC_ISO8859_1, CPL_ENC_UTF8);
    plain(found, text, BAKE_ABOUT_TEXT_ROOM);
    CPLFree(latin);
    if (entry == FF_ABOUT_DATE) make_date(text);
    cut(text, entry);
    if (!ff_about_is_text((const uint8_t *)text, (uint32_t)strlen(text))) *text = 0;
}

/* Of a compound system the vertical one: heights are above it. */
static void take_vertical(GDALDatasetH set, char *text)
{
    OGRSpatialReferenceH srs = GDALGetSpatialRef(set);
    const char *name = srs && OSRIsCompound(srs) ? OSRGetAttrValue(srs, "COMPD_CS|VERT_CS", 0)
                                                 : NULL;
    if (name) take(name, FF_ABOUT_VERTICAL, text);
}

int bake_about_check(const bake_texts *told)
{
    for (unsigned entry = 1; entry <= BAKE_ABOUT_TEXTS; entry++) {
        const char *text = told->text[entry - 1], *name = option_name[entry - 1];
        size_t length = text ? strlen(text) : 0;
        if (length > bake_about_most(entry))
            return bake_fail("--%s: %zu bytes; at most %u are kept", name, length,
                             bake_about_most(entry));
        if (text && !ff_about_is_text((const uint8_t *)text, (uint32_t)length))
            return bake_fail("--%s: not one line of UTF-8", name);
    }
    return 0;
}

void bake_about_read(const bake_texts *told, GDALDatasetH set, bake_about *about)
{
    *about = (bake_about){ 0 };
    for (unsigned i = 0; i < BAKE_ABOUT_TEXTS; i++) {
        const char *text = told->text[i];
        if (text) snprintf(about->text[i], BAKE_ABOUT_TEXT_ROOM, "%s", text);
        for (unsigned k = 0; k < KEYS_MAX && key[i][k] && !text && !*about->text[i]; k++) {
            const char *found = GDALGetMetadataItem(set, key[i][k], NULL);
            if (found) take(found, i + 1, about->text[i]);
        }
    }
    char *vertical = about->text[FF_ABOUT_VERTICAL - 1];
    if (!*vertical && !told->text[FF_ABOUT_VERTICAL - 1]) take_vertical(set, vertical);
}

/* ---- the list ---- */

/* Tells where a client cannot say latitudes and longitudes, though the ground has a place. */
static void note_unknown(const uint8_t *numbers, uint32_t count)
{
    const ff_terrain_info anywhere = { 0 };
    ff_about_projection projection;
    ff_geo geo;
    if (ff_about_read_projection(numbers, (int)count, &projection) != FF_OK)
        bake_note("the projection has no numbers: clients cannot tell latitudes and longitudes");
    else if (ff_geo_make(&geo, &projection, &anywhere) == FF_ERR_UNSUPPORTED)
        bake_note("clients do not know projections by EPSG's method %u: they cannot tell latitudes "
                  "and longitudes",
                  projection.method);
}

uint32_t bake_about_list(const bake_about *about, OGRSpatialReferenceH srs,
                         uint8_t list[FF_ABOUT_BYTES_MAX])
{
    ff_writer out = { list, list + FF_ABOUT_BYTES_MAX, FF_OK };
    uint8_t numbers[BAKE_PROJECTION_BYTES_MAX];
    for (unsigned i = 0; i < BAKE_ABOUT_TEXTS; i++)
        if (*about->text[i])
            ff_list_write(&out, i + 1, (const uint8_t *)about->text[i],
                          (uint32_t)strlen(about->text[i]));
    char *wkt = srs ? bake_projection_wkt(srs) : NULL;
    uint32_t count = wkt ? bake_projection_numbers(srs, wkt, numbers) : 0;
    if (srs) note_unknown(numbers, count);
    if (wkt) bake_projection_shorten(srs, wkt);
    size_t wkt_bytes = wkt ? strlen(wkt) : 0;
    if (wkt_bytes && wkt_bytes <= bake_about_most(FF_ABOUT_WKT) &&
        ff_about_is_text((const uint8_t *)wkt, (uint32_t)wkt_bytes))
        ff_list_write(&out, FF_ABOUT_WKT, (const uint8_t *)wkt, (uint32_t)wkt_bytes);
    if (count) ff_list_write(&out, FF_ABOUT_PROJECTION, numbers, count);
    CPLFree(wkt);
    FF_ASSERT(out.error == FF_OK);
    return (uint32_t)(out.at - list);
}

void bake_about_text(ff_list list, enum ff_about_entry entry, char *text, size_t room)
{
    const uint8_t *value;
    int bytes = ff_list_find(list, entry, &value);
    snprintf(text, room, "%.*s", bytes > 0 ? bytes : 0, bytes > 0 ? (const char *)value : "");
}
