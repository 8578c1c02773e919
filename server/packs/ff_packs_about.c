/* What several packs say of themselves, together. */
#include "ff_packs.h"

#include <string.h>

enum { TEXT, NUMBERS, CHECKSUM, NAMES };

/* An entry of a pack: its bytes, not above 0 where it has none. */
static int find(const ff_pack *pack, unsigned type, const uint8_t **value)
{
    ff_list about;
    return ff_pack_about(pack, &about) == FF_OK ? ff_list_find(about, type, value) : 0;
}

static void put_texts(const ff_pack *pack, unsigned type, uint32_t most, ff_writer *out)
{
    static uint8_t text[FF_ABOUT_BYTES_MAX]; /* a process serves one request at a time */
    uint32_t bytes = 0;
    for (; pack; pack = pack->next) {
        const uint8_t *value;
        int own = find(pack, type, &value);
        if (own > 0) bytes = ff_about_add_words(text, bytes, most, value, (uint32_t)own);
    }
    if (bytes) ff_list_write(out, type, text, bytes);
}

static void put_first(const ff_pack *pack, unsigned type, ff_writer *out)
{
    const uint8_t *value;
    int bytes = 0;
    for (; pack && bytes <= 0; pack = pack->next) bytes = find(pack, type, &value);
    if (bytes > 0) ff_list_write(out, type, value, (uint32_t)bytes);
}

ff_list ff_packs_about(const ff_pack *pack, uint8_t bytes[FF_ABOUT_BYTES_MAX])
{
    ff_writer out = { bytes, bytes + FF_ABOUT_BYTES_MAX, FF_OK };
    ff_list alone;
    static const struct {
        uint8_t type, form;
        uint16_t most;
    } row[] = {
#define X(entry, name, type, form, most) { type, form, most },
        FF_ABOUT_LIST(X)
#undef X
    };
    if (!pack->next) {
        if (ff_pack_about(pack, &alone) != FF_OK) return (ff_list){ bytes, 0 };
        memcpy(bytes, alone.bytes, alone.byte_count);
        return (ff_list){ bytes, alone.byte_count };
    }
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        if (row[i].form == CHECKSUM) continue; /* of one alone it would be wrong */
        if (row[i].form == TEXT && row[i].type != FF_ABOUT_WKT)
            put_texts(pack, row[i].type, row[i].most, &out);
        else
            put_first(pack, row[i].type, &out);
    }
    return (ff_list){ bytes, out.error == FF_OK ? (uint32_t)(out.at - bytes) : 0 };
}
