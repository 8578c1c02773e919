#include "ff_pack_source.h"
#include "../../protocol/ff_assert.h"

int ff_pack_source_serve(const ff_pack *pack, ff_decoder *decoder, int32_t *values, ff_tree *tree,
                         enum ff_kind kind, ff_key key)
{
    const uint8_t *payload;
    const ff_terrain_info *info = ff_tree_ground(tree, key);
    ff_residuals residuals = { .cells = ff_shape_cells(info, key, kind == FF_KIND_REFINEMENT),
                               .value = values };
    FF_ASSERT(kind == FF_KIND_REFINEMENT || (kind == FF_KIND_ROOT && ff_key_level(key) == 0));
    int bytes = ff_pack_record(pack, (enum ff_section_kind)ff_kind[kind].section,
                               ff_terrain_own_key(info, key), &payload);
    if (bytes < 0) return bytes;
    if (kind == FF_KIND_ROOT) {
        int rc = ff_decode_root(decoder, payload, (size_t)bytes, &residuals);
        return rc < 0 ? rc : ff_tree_deliver_root(tree, ff_key_tile(key), 0, &residuals);
    }
    int rc = ff_decode_refinement(decoder, payload, (size_t)bytes, &residuals);
    FF_ASSERT(rc < 0 || residuals.count <= FF_REFINED_HEIGHTS_MAX);
    return rc < 0 ? rc : ff_tree_deliver_children(tree, key, 0, &residuals);
}
