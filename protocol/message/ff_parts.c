#include "ff_parts.h"
#include "ff_message_local.h"

#include <string.h>

FF_STATIC_ASSERT(FF_VIEW_KEYS_MAX + FF_VIEW_EDGE_MAX <= FF_PARTS_MAX && FF_PARTS_MAX < UINT16_MAX);

enum { REFINEMENT = 0, ROOT = 1, NAMED = 2 };

static void append(ff_parts *parts, ff_key key, uint8_t what)
{
    unsigned at = (parts->first + parts->count++) % FF_PARTS_MAX;
    FF_ASSERT(parts->count <= FF_PARTS_MAX);
    parts->key[at] = key;
    parts->what[at] = what;
}

static int announce(ff_parts *parts, ff_key key, uint8_t what)
{
    if (parts->announced == FF_PARTS_MAX) return FF_ERR_FORMAT;
    parts->announced++;
    append(parts, key, what);
    return FF_OK;
}

void ff_parts_begin(ff_parts *parts, const ff_get_view *view)
{
    FF_ASSERT(view->count <= FF_VIEW_KEYS_MAX);
    parts->first = parts->count = parts->announced = 0;
    parts->awaits_roots = view->count == 0;
    for (unsigned i = 0; i < view->count; i++)
        (void)announce(parts, view->below[i], NAMED | (view->roots >> i & 1u ? ROOT : REFINEMENT));
    parts->awaits_edge = view->edge_count > 0;
    parts->edge_count = view->edge_count;
    memcpy(parts->edge, view->edge, view->edge_count * sizeof *view->edge);
}

int ff_parts_roots(ff_parts *parts, const ff_roots *roots)
{
    ff_reader in = { roots->bytes, roots->bytes + roots->byte_count, FF_OK };
    int rc = parts->awaits_roots ? FF_OK : FF_ERR_FORMAT;
    while (rc == FF_OK && in.at < in.end)
        rc = announce(parts, ff_key_make(ff_read_varint(&in), 0, 0), ROOT);
    parts->awaits_roots = 0;
    return rc;
}

int ff_parts_edge(ff_parts *parts, uint32_t needed)
{
    if (!parts->awaits_edge || needed >> parts->edge_count != 0) return FF_ERR_FORMAT;
    parts->awaits_edge = 0;
    for (unsigned i = 0; i < parts->edge_count; i++)
        if (needed >> i & 1u) (void)announce(parts, parts->edge[i], REFINEMENT);
    return FF_OK;
}

static int awaits_more(const ff_parts *parts) { return parts->awaits_roots || parts->awaits_edge; }

int ff_parts_done(const ff_parts *parts) { return !awaits_more(parts) && parts->count == 0; }

int ff_parts_next(const ff_parts *parts, enum ff_kind *kind, ff_key *key, int *named)
{
    if (awaits_more(parts) || parts->count == 0) return 0;
    *kind = parts->what[parts->first] & ROOT ? FF_KIND_ROOT : FF_KIND_REFINEMENT;
    *key = parts->key[parts->first];
    *named = (parts->what[parts->first] & NAMED) != 0;
    return 1;
}

static void take_front(ff_parts *parts)
{
    parts->first = (uint16_t)((parts->first + 1u) % FF_PARTS_MAX);
    parts->count--;
}

static int put_off(ff_parts *parts, unsigned later)
{
    if (later >= parts->count) return FF_ERR_FORMAT; /* nothing would come before them */
    for (; later; later--) {
        ff_key key = parts->key[parts->first];
        uint8_t what = parts->what[parts->first];
        take_front(parts);
        append(parts, key, what);
    }
    return FF_OK;
}

int ff_parts_take(ff_parts *parts, const ff_part *part)
{
    enum ff_kind kind;
    ff_key key;
    int named, rc = FF_OK;
    if (!ff_parts_next(parts, &kind, &key, &named)) return FF_ERR_FORMAT;
    if (part->later) return put_off(parts, part->later);
    int root = kind == FF_KIND_ROOT;
    if (part->below && (root ? part->below > 1 : ff_key_level(key) == FF_KEY_LEVEL_MAX))
        return FF_ERR_FORMAT;
    take_front(parts);
    for (unsigned q = 0; rc == FF_OK && q < 4; q++)
        if (part->below >> q & 1u)
            rc = announce(parts, root ? key : ff_key_child(key, q), REFINEMENT);
    return rc;
}
