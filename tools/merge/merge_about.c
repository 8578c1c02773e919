#include "merge_about.h"
#include "merge_parts.h"

#include "../bake/bake_say.h"
#include "../bake/raster/bake_about.h"
#include "../bake/raster/bake_reference.h"

#include <string.h>

#define TEXT_ROOM 8192 /* more is too long for any entry */

FF_STATIC_ASSERT(TEXT_ROOM >= 2 * FF_ABOUT_BYTES_MAX);

static int read_about(const bake_unpack *unpack, ff_list *about)
{
    int rc = ff_pack_about(&unpack->pack, about);
    if (rc == FF_OK) return 0;
    *about = (ff_list){ 0 };
    return rc == FF_ERR_NOT_FOUND
               ? 0
               : bake_fail("%s: what it says of itself: %s", unpack->path, ff_error_text(rc));
}

/* Adds a text of all packs to the list. */
static int put_text(const ff_list about[], uint32_t count, enum ff_about_entry entry,
                    ff_writer *out)
{
    uint8_t text[TEXT_ROOM];
    uint32_t bytes = 0, most = bake_about_most(entry), unlike = 0;
    const char *option = bake_about_option(entry);
    for (uint32_t p = 0; p < count; p++) {
        const uint8_t *value;
        int own = ff_list_find(about[p], entry, &value);
        uint32_t before = bytes;
        if (own > 0) bytes = ff_about_add_words(text, bytes, TEXT_ROOM, value, (uint32_t)own);
        unlike += before && bytes > before;
    }
    if (bytes > most)
        return bake_fail("the packs' texts for --%s have %u bytes together, at most %u are kept: "
                         "give one with --%s",
                         option, bytes, most, option);
    if (entry == FF_ABOUT_VERTICAL && unlike)
        bake_note("heights are above %.*s: joined as they are", (int)bytes, (const char *)text);
    if (bytes) ff_list_write(out, entry, text, bytes);
    return 0;
}

int merge_about_make(const merge_options *o, const bake_unpack unpack[], uint32_t count,
                     uint8_t list[FF_ABOUT_BYTES_MAX], ff_list *joint)
{
    ff_writer out = { list, list + FF_ABOUT_BYTES_MAX, FF_OK };
    ff_list about[MERGE_PACKS_MAX];
    bake_texts told = BAKE_TEXTS(o);
    for (uint32_t p = 0; p < count; p++)
        if (read_about(&unpack[p], &about[p])) return -1;
    for (unsigned entry = FF_ABOUT_NAME; entry <= FF_ABOUT_VERTICAL; entry++) {
        const char *own = told.text[entry - 1];
        if (own && *own) ff_list_write(&out, entry, (const uint8_t *)own, (uint32_t)strlen(own));
        if (!own && put_text(about, count, entry, &out)) return -1;
    }
    for (unsigned entry = FF_ABOUT_WKT; entry <= FF_ABOUT_PROJECTION; entry++) {
        const uint8_t *value = NULL;
        int bytes = -1;
        for (uint32_t p = 0; p < count && bytes < 0; p++)
            bytes = ff_list_find(about[p], entry, &value);
        if (bytes >= 0) ff_list_write(&out, entry, value, (uint32_t)bytes);
    }
    const uint8_t *names = NULL;
    int bytes = merge_parts_are(unpack, count) ? ff_list_find(about[0], FF_ABOUT_LAYERS, &names)
                                               : 0;
    if (bytes > 0) ff_list_write(&out, FF_ABOUT_LAYERS, names, (uint32_t)bytes);
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
