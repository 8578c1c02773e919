#include "ff_packs.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

static int fail(ff_packs *packs, const char *path, const char *why, int rc)
{
    snprintf(packs->why, sizeof packs->why, "%s: %s", path, why);
    return rc;
}

int ff_packs_add(ff_packs *packs, const char *path)
{
    unsigned at = packs->count;
    if (at == FF_PACKS_MAX) {
        snprintf(packs->why, sizeof packs->why, "%s: more than %d packs", path, FF_PACKS_MAX);
        return FF_ERR_FULL;
    }
    errno = 0;
    packs->pack[at].refusal[0] = 0;
    int rc = sys_map_file(path, &packs->mapping[at]);
    if (rc == FF_OK)
        rc = ff_pack_open(&packs->pack[at], packs->mapping[at].bytes, packs->mapping[at].size);
    if (rc != FF_OK) {
        const char *why = rc == FF_ERR_SYSTEM && errno ? strerror(errno)
                                                       : ff_pack_error_text(&packs->pack[at], rc);
        if (packs->mapping[at].bytes) sys_unmap_file(&packs->mapping[at]);
        return fail(packs, path, why, rc);
    }
    packs->count++;
    return FF_OK;
}

const char *ff_packs_why_apart(int rc)
{
    switch (rc) {
        case FF_ERR_ARGUMENT: return "it is ground of another pack here: farfield-merge joins them";
        case FF_ERR_UNSUPPORTED:
            return "it has no reference system in common with the first pack, or other nodes: bake "
                   "it with the same --t-srs and --node-log2";
        case FF_ERR_RANGE: return "it lies too far from the first pack";
        case FF_ERR_FORMAT:
            return "its layers of images have other names than the first pack's, or another order";
        default: return ff_error_text(rc);
    }
}

int ff_packs_open(ff_packs *packs, const char *const *path, size_t count)
{
    packs->count = 0;
    for (size_t i = 0; i < count; i++) {
        int rc = ff_packs_add(packs, path[i]);
        if (rc != FF_OK) return rc;
        if (i == 0) continue;
        rc = ff_pack_join(&packs->pack[0], &packs->pack[i]);
        if (rc != FF_OK) return fail(packs, path[i], ff_packs_why_apart(rc), rc);
    }
    return FF_OK;
}

void ff_packs_close(ff_packs *packs)
{
    while (packs->count > 0) sys_unmap_file(&packs->mapping[--packs->count]);
}
