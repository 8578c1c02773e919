#include "ff_refusals.h"
#include "../../protocol/ff_assert.h"

FF_STATIC_ASSERT(FF_REFUSALS_KEPT <= UINT8_MAX && FF_REFUSALS_TRIES <= UINT8_MAX);

static int find(const ff_refusals *refusals, unsigned kind, ff_key key)
{
    for (unsigned i = 0; i < FF_REFUSALS_KEPT; i++)
        if (refusals->entry[i].tries && refusals->entry[i].kind == kind &&
            refusals->entry[i].key == key)
            return (int)i;
    return -1;
}

void ff_refusals_note(ff_refusals *refusals, unsigned kind, ff_key key, int final)
{
    FF_ASSERT(ff_kind[kind].asks == FF_ASKS_NODE); /* of such a kind a key comes up again */
    int at = find(refusals, kind, key);
    if (at < 0) {
        at = refusals->next;
        FF_ASSERT(at < (int)FF_REFUSALS_KEPT);
        refusals->next = (uint8_t)((refusals->next + 1) % FF_REFUSALS_KEPT);
        refusals->entry[at] = (ff_refusal){ .key = key, .kind = (uint8_t)kind };
    }
    if (final)
        refusals->entry[at].tries = FF_REFUSALS_TRIES;
    else if (refusals->entry[at].tries < FF_REFUSALS_TRIES)
        refusals->entry[at].tries++;
}

static int is_at_or_above(ff_key above, ff_key key)
{
    uint32_t levels = ff_key_level(key) - ff_key_level(above);
    return ff_key_tile(above) == ff_key_tile(key) && ff_key_level(above) <= ff_key_level(key) &&
           ff_key_code(above) == (uint32_t)((uint64_t)ff_key_code(key) >> 2 * levels);
}

int ff_refusals_final(const ff_refusals *refusals, unsigned kind, ff_key key)
{
    FF_ASSERT(kind < FF_KIND_COUNT);
    for (unsigned i = 0; i < FF_REFUSALS_KEPT; i++) {
        const ff_refusal *entry = &refusals->entry[i];
        FF_ASSERT(entry->tries <= FF_REFUSALS_TRIES);
        if (entry->tries < FF_REFUSALS_TRIES || entry->kind != kind) continue;
        if (entry->key == key || (ff_kind[kind].has_image && is_at_or_above(entry->key, key)))
            return 1;
    }
    return 0;
}
