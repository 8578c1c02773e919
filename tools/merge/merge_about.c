#include "merge_about.h"

#include "../bake/bake_say.h"
#include "../bake/raster/bake_reference.h"

#include <string.h>

#define BETWEEN    "; "
#define TEXT_ROOM  8192 /* more is too long for any entry */
#define TEXT_COUNT 5    /* the entries from FF_ABOUT_NAME to FF_ABOUT_VERTICAL */

FF_STATIC_ASSERT(FF_ABOUT_NAME == 1 && FF_ABOUT_VERTICAL == TEXT_COUNT);
FF_STATIC_ASSERT(TEXT_ROOM >= 2 * FF_ABOUT_BYTES_MAX);

static const struct {
    const char *option;
    uint32_t most;
} entry_of[] = {
#define X(entry, name, type, form, most) [type] = { #name, most },
    FF_ABOUT_LIST(X)
#undef X
};

static const char *told(const merge_options *o, unsigned entry)
{
    const char *const text[] = { NULL,       o->name, o->attribution,
                                 o->licence, o->date, o->vertical_datum };
    return text[entry];
}

/* Whether a text that is joined already has this word. */
static int has_word(const char *text, const char *word, size_t length)
{
    for (const char *at = text; at && *at; at = strstr(at, BETWEEN)) {
        if (at != text) at += strlen(BETWEEN);
        const char *end = strstr(at, BETWEEN);
        size_t have = end ? (size_t)(end - at) : strlen(at);
        if (have == length && !memcmp(at, word, length)) return 1;
    }
    return 0;
}

/* Adds those words of a text that are not there yet, as long as there is room. */
static void add_words(const char *from, char *text)
{
    while (*from) {
        const char *end = strstr(from, BETWEEN);
        size_t length = end ? (size_t)(end - from) : strlen(from), used = strlen(text);
        if (!has_word(text, from, length) && used + strlen(BETWEEN) + length < TEXT_ROOM) {
            if (used) strcat(text, BETWEEN);
            strncat(text, from, length);
        }
        from = end ? end + strlen(BETWEEN) : from + length;
    }
}

static int read_about(const bake_unpack *unpack, ff_list *about)
{
    int rc = ff_pack_about(&unpack->pack, about);
    if (rc == FF_OK) return 0;
    *about = (ff_list){ 0 };
    return rc == FF_ERR_NOT_FOUND
               ? 0
               : bake_fail("%s: what it says of itself: %s", unpack->path, ff_error_text(rc));
}

static void take_text(ff_list about, unsigned entry, char *text)
{
    char own[FF_ABOUT_BYTES_MAX + 1];
    const uint8_t *value;
    int bytes = ff_list_find(about, entry, &value);
    if (bytes <= 0) return;
    memcpy(own, value, (size_t)bytes);
    own[bytes] = 0;
    add_words(own, text);
}

/* Adds a text of all packs to the list. */
static int put_text(const merge_options *o, const ff_list about[], uint32_t count, unsigned entry,
                    ff_writer *out)
{
    char text[TEXT_ROOM] = "", option[32];
    const char *own = told(o, entry), *name = entry_of[entry].option;
    size_t i = 0;
    for (; name[i] && i + 1 < sizeof option; i++) option[i] = name[i] == '_' ? '-' : name[i];
    option[i] = 0;
    for (uint32_t p = 0; p < count && !own; p++) take_text(about[p], entry, text);
    if (!own && strlen(text) > entry_of[entry].most)
        return bake_fail("the packs' texts for --%s have %zu bytes together, at most %u are kept: "
                         "give one with --%s",
                         option, strlen(text), entry_of[entry].most, option);
    if (!own && entry == FF_ABOUT_VERTICAL && strstr(text, BETWEEN))
        bake_note("heights are above %s: joined as they are", text);
    if (own) strncat(text, own, TEXT_ROOM - 1);
    if (*text) ff_list_write(out, entry, (const uint8_t *)text, (uint32_t)strlen(text));
    return 0;
}

int merge_about_make(const merge_options *o, const bake_unpack unpack[], uint32_t count,
                     uint8_t list[FF_ABOUT_BYTES_MAX], ff_list *joint)
{
    ff_writer out = { list, list + FF_ABOUT_BYTES_MAX, FF_OK };
    ff_list about[MERGE_PACKS_MAX];
    for (uint32_t p = 0; p < count; p++)
        if (read_about(&unpack[p], &about[p])) return -1;
    for (unsigned entry = FF_ABOUT_NAME; entry <= FF_ABOUT_VERTICAL; entry++)
        if (put_text(o, about, count, entry, &out)) return -1;
    for (unsigned entry = FF_ABOUT_WKT; entry <= FF_ABOUT_PROJECTION; entry++) {
        const uint8_t *value = NULL;
        int bytes = -1;
        for (uint32_t p = 0; p < count && bytes < 0; p++)
            bytes = ff_list_find(about[p], entry, &value);
        if (bytes >= 0) ff_list_write(&out, entry, value, (uint32_t)bytes);
    }
    FF_ASSERT(out.error == FF_OK);
    *joint = (ff_list){ list, (uint32_t)(out.at - list) };
    return 0;
}

int merge_about_same_system(const ff_pack *a, const ff_pack *b)
{
    if (a->header.info.epsg || b->header.info.epsg)
        return a->header.info.epsg == b->header.info.epsg;
    OGRSpatialReferenceH first = bake_reference_of(a), second = bake_reference_of(b);
    int same = first && second ? OSRIsSame(first, second) : !first && !second;
    if (first) OSRDestroySpatialReference(first);
    if (second) OSRDestroySpatialReference(second);
    return same;
}
