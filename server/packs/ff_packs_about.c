/* What several packs say of themselves, together. */
#include "ff_packs.h"

#include <string.h>

#define BETWEEN "; "

typedef struct text {
    uint8_t bytes[FF_ABOUT_BYTES_MAX];
    uint32_t count, most;
} text;

/* 1 when the text has these bytes already, between two marks or its ends. */
static int has(const text *t, const uint8_t *value, uint32_t count)
{
    const uint32_t mark = sizeof BETWEEN - 1;
    for (uint32_t at = 0; at + count <= t->count; at++) {
        int begins = at == 0 || (at >= mark && !memcmp(t->bytes + at - mark, BETWEEN, mark)),
            end = at + count == t->count ||
                  (t->count - at - count >= mark && !memcmp(t->bytes + at + count, BETWEEN, mark));
        if (begins && end && !memcmp(t->bytes + at, value, count)) return 1;
    }
    return 0;
}

/* What has no room is left out whole. */
static void add(text *t, const uint8_t *value, uint32_t count)
{
    uint32_t mark = t->count ? sizeof BETWEEN - 1 : 0;
    if (has(t, value, count) || t->count + mark + count > t->most) return;
    memcpy(t->bytes + t->count, BETWEEN, mark);
    memcpy(t->bytes + t->count + mark, value, count);
    t->count += mark + count;
}

/* An entry of all packs: texts one after the other, else the first one's. */
static void collect(const ff_pack *pack, unsigned type, int is_text, text *t)
{
    for (; pack && (is_text || !t->count); pack = pack->next) {
        const uint8_t *value;
        ff_list about;
        if (ff_pack_about(pack, &about) != FF_OK) continue;
        int count = ff_list_find(about, type, &value);
        if (count > 0) add(t, value, (uint32_t)count);
    }
}

ff_list ff_packs_about(const ff_pack *pack, uint8_t bytes[FF_ABOUT_BYTES_MAX])
{
    ff_writer out = { bytes, bytes + FF_ABOUT_BYTES_MAX, FF_OK };
    ff_list alone;
    enum { TEXT, NUMBERS, CHECKSUM };
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
        static text t; /* a process serves one request at a time */
        t.count = 0;
        t.most = row[i].most;
        if (row[i].form == CHECKSUM && pack->next) continue; /* of one alone it would be wrong */
        collect(pack, row[i].type, row[i].form == TEXT && row[i].type != FF_ABOUT_WKT, &t);
        if (t.count) ff_list_write(&out, row[i].type, t.bytes, t.count);
    }
    return (ff_list){ bytes, out.error == FF_OK ? (uint32_t)(out.at - bytes) : 0 };
}
