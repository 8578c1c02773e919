/* What is said of a set of map tiles. */
#include "../../protocol/ff_assert.h"
#include "../bake/bake_say.h"
#include "export_store_local.h"

#include <stdlib.h>
#include <string.h>

#define VALUE_BYTES 128
#define JSON_BYTES  (1 << 14) /* more than all that is said takes */
#define HTML_BYTES  (5 * EXPORT_TEXT_BYTES)
#define MESH_FORMAT "quantized-mesh-1.0"

export_told_place export_facts_place(const export_tiles_about *tiles)
{
    export_bounds b = tiles->bounds;
    export_told_place told = { b, (b.west + b.east) / 2, (b.south + b.north) / 2 };
    if (b.east <= 180) return told;
    if (told.middle_x > 180) told.middle_x -= 360;
    told.bounds.west = -180;
    told.bounds.east = 180;
    return told;
}

/* Attributions of map tiles are HTML, and readers put them into their pages: a pack's is text. */
static void to_html(const char *text, char html[HTML_BYTES])
{
    for (; *text; text++) {
        const char *mark = *text == '&'   ? "&amp;"
                           : *text == '<' ? "&lt;"
                           : *text == '>' ? "&gt;"
                                          : NULL;
        html += sprintf(html, mark ? "%s" : "%.1s", mark ? mark : text);
    }
    *html = 0;
}

int export_facts(const export_tiles_about *t, export_fact_fn put, void *context)
{
    char text[VALUE_BYTES], html[HTML_BYTES];
    const export_told_place place = export_facts_place(t);
    const export_bounds *b = &place.bounds;
    int rc = put(context, "name", t->about.name, 1) || put(context, "type", "baselayer", 1) ||
             put(context, "format", t->layer ? MESH_FORMAT : t->format, 1);
    to_html(t->about.attribution, html);
    if (!rc && *html) rc = put(context, "attribution", html, 1);
    if (!rc && *t->about.licence) rc = put(context, "licence", t->about.licence, 1);
    if (!rc && *t->about.date) rc = put(context, "date", t->about.date, 1);
    if (!rc && *t->about.vertical_datum)
        rc = put(context, "vertical_datum", t->about.vertical_datum, 1);
    if (!rc && t->encoding) rc = put(context, "encoding", t->encoding, 1);
    if (!rc && *t->about.error) {
        snprintf(text, sizeof text, "%.6g", t->about.error_m);
        rc = put(context, "description", t->about.error, 1) || put(context, "error_m", text, 0);
    }
    snprintf(text, sizeof text, "%u", t->side);
    if (!rc && t->side) rc = put(context, "tileSize", text, 0);
    snprintf(text, sizeof text, "%u", t->zoom_min);
    if (!rc) rc = put(context, "minzoom", text, 0);
    snprintf(text, sizeof text, "%u", t->zoom_max);
    if (!rc) rc = put(context, "maxzoom", text, 0);
    snprintf(text, sizeof text, "%.7f,%.7f,%.7f,%.7f", b->west, b->south, b->east, b->north);
    if (!rc) rc = put(context, "bounds", text, 0);
    snprintf(text, sizeof text, "%.7f,%.7f,%u", place.middle_x, place.middle_y, t->zoom_min);
    if (!rc) rc = put(context, "center", text, 0);
    return rc;
}

/* ---- JSON ---- */

typedef struct json_text {
    char *text;
    size_t used;
} json_text;

static void add(json_text *json, const char *bytes)
{
    size_t count = strlen(bytes);
    FF_ASSERT(json->used + count < JSON_BYTES);
    memcpy(json->text + json->used, bytes, count + 1);
    json->used += count;
}

static void add_quoted(json_text *json, const char *text)
{
    char one[8];
    add(json, "\"");
    for (; *text; text++) {
        unsigned char c = (unsigned char)*text;
        if (c == '"' || c == '\\')
            snprintf(one, sizeof one, "\\%c", c);
        else if (c < ' ')
            snprintf(one, sizeof one, "\\u%04x", c);
        else
            snprintf(one, sizeof one, "%c", c);
        add(json, one);
    }
    add(json, "\"");
}

static int add_fact(void *context, const char *name, const char *value, int is_text)
{
    json_text *json = context;
    int is_list = strchr(value, ',') && !is_text;
    if (json->used > 1) add(json, ", ");
    add_quoted(json, name);
    add(json, is_list ? ": [" : ": ");
    if (is_text)
        add_quoted(json, value);
    else
        add(json, value);
    if (is_list) add(json, "]");
    return 0;
}

char *export_facts_json(const export_tiles_about *tiles, const char *pattern)
{
    json_text json = { malloc(JSON_BYTES), 0 };
    if (!json.text) {
        bake_fail("out of memory");
        return NULL;
    }
    add(&json, "{");
    if (pattern) {
        add_fact(&json, "tilejson", tiles->layer ? "2.1.0" : "3.0.0", 1);
        add(&json, ", \"tiles\": [");
        add_quoted(&json, pattern);
        add(&json, "]");
    }
    export_facts(tiles, add_fact, &json);
    if (tiles->layer) {
        add(&json, ", ");
        add(&json, tiles->layer);
    }
    add(&json, "}\n");
    return json.text;
}
