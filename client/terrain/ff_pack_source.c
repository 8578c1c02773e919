#include "ff_pack_source.h"
#include "../../protocol/ff_assert.h"

uint32_t ff_pack_source_grounds(const ff_pack *pack)
{
    uint32_t count = 0;
    for (; pack; pack = pack->next) count++;
    return count;
}

int ff_pack_source_add(const ff_pack *pack, ff_tree *tree)
{
    while ((pack = pack->next)) {
        int rc = ff_tree_add_ground(tree, &pack->header.info);
        if (rc < 0) return rc;
    }
    return FF_OK;
}

size_t ff_pack_source_decoder_bytes(const ff_pack *pack)
{
    return pack->next ? ff_decoder_bytes_any(&pack->header.info)
                      : ff_decoder_bytes(&pack->header.info);
}

int ff_pack_source_serve(const ff_pack *pack, ff_decoder *decoder, int32_t *values, ff_tree *tree,
                         enum ff_kind kind, ff_key key)
{
    const uint8_t *payload;
    pack = ff_pack_of(pack, key);
    if (!pack) return FF_ERR_NOT_FOUND;
    ff_residuals residuals = { .cells = ff_shape_cells(&pack->header.info, key,
                                                       kind == FF_KIND_REFINEMENT),
                               .value = values };
    FF_ASSERT(kind == FF_KIND_REFINEMENT || (kind == FF_KIND_ROOT && ff_key_level(key) == 0));
    int bytes = ff_pack_record(pack, (enum ff_section_kind)ff_kind[kind].section, key, &payload);
    if (bytes < 0) return bytes;
    int rc = ff_decoder_turn(decoder, &pack->header.info);
    if (rc < 0) return rc;
    if (kind == FF_KIND_ROOT) {
        rc = ff_decode_root(decoder, payload, (size_t)bytes, &residuals);
        return rc < 0 ? rc : ff_tree_deliver_root(tree, ff_key_tile(key), 0, &residuals);
    }
    rc = ff_decode_refinement(decoder, payload, (size_t)bytes, &residuals);
    FF_ASSERT(rc < 0 || residuals.count <= FF_REFINED_HEIGHTS_MAX);
    return rc < 0 ? rc : ff_tree_deliver_children(tree, key, 0, &residuals);
}
