/* Packs of several grounds that go together. */
#include "ff_pack.h"

uint32_t ff_pack_whole(const ff_pack *pack)
{
    uint32_t checksum = pack->header.info.checksum;
    ff_list about;

    return ff_pack_about(pack, &about) == FF_OK ? ff_about_whole(about, checksum) : checksum;
}

int ff_pack_join(ff_pack *pack, ff_pack *other)
{
    ff_pack *last = pack;
    uint32_t whole = ff_pack_whole(other), count = 1;
    int rc;

    for (ff_pack *at = pack; at; at = at->next, count++) {
        if (ff_terrain_same_ground(&at->header.info, ff_pack_whole(at), &other->header.info, whole))
            return FF_ERR_ARGUMENT;
        last = at;
    }
    if (count > FF_PACKS_JOINED_MAX) return FF_ERR_FULL;
    rc = ff_terrain_join(&other->header.info, &pack->header.info, &last->header.info);
    if (rc == FF_OK) last->next = other;
    return rc;
}
