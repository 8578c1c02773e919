/* Stands in for ff_grounds.c, ff_cover.c and ff_seam*.c in builds for one ground and one source. */
#include "ff_tree_local.h"

const uint8_t ff_grounds_built = 0;

uint32_t ff_ground_search(const ff_tree *tree, uint32_t tile) { return (void)tree, (void)tile, 0; }
int ff_tree_add_ground(ff_tree *tree, const ff_terrain_info *info)
{
    return (void)tree, (void)info, FF_ERR_FULL;
}
void ff_grounds_ramp(const ff_tree *tree, const ff_terrain_info *info, int32_t ramp[2])
{
    (void)tree, (void)info, (void)ramp;
}
void ff_cover_rank(ff_tree *tree) { (void)tree; }
int ff_cover_is_small(const ff_tree *tree, uint32_t ground) { return (void)tree, (void)ground, 0; }
void ff_cover_stand(ff_tree *tree) { (void)tree; }
int ff_cover_hides(const ff_tree *tree, ff_key key) { return (void)tree, (void)key, 0; }
void ff_cover_rims(ff_tree *tree, uint32_t ground) { (void)tree, (void)ground; }
void ff_cover_roots(ff_tree *tree, uint32_t ground) { (void)tree, (void)ground; }
int ff_cover_fills(const ff_tree *tree, uint32_t tile) { return (void)tree, (void)tile, 0; }
int ff_seam_touches(const ff_tree *tree, const ff_node *node) { return (void)tree, (void)node, 0; }
int64_t ff_seam_lowest_wu(const ff_tree *tree) { return (void)tree, 0; }
void ff_seam_make(ff_tree *tree) { (void)tree; }
const uint16_t *ff_seam_drop(const ff_tree *tree, uint32_t slot, enum ff_lowered how)
{
    return (void)tree, (void)slot, (void)how, NULL;
}
void ff_node_lacks(ff_tree *tree, uint32_t slot, unsigned source)
{
    (void)tree, (void)slot, (void)source;
}
void ff_node_settle(ff_tree *tree, uint32_t slot) { (void)tree, (void)slot; }
void ff_tree_lacks(ff_tree *tree, ff_key key, unsigned source)
{
    (void)tree, (void)key, (void)source;
}
void ff_tree_set_sources(ff_tree *tree, uint32_t ground, uint8_t mask)
{
    (void)tree, (void)ground, (void)mask;
}
