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

int ff_refusals_final(const ff_refusals *refusals, unsigned kind, ff_key key)
{
    int at = find(refusals, kind, key);
    FF_ASSERT(at < 0 || refusals->entry[at].tries <= FF_REFUSALS_TRIES);
    return at >= 0 && refusals->entry[at].tries >= FF_REFUSALS_TRIES;
}
