/* The reserve: of the wishes out of view those without which a turn would show empty or very coarse
 * ground. It is asked for while the link is idle, so that looking elsewhere needs no link. */
#include "ff_tree_local.h"

/* An error that must not be met on a turn. After a turn the error's 95th percentile is about 0.4 of
 * it, at 240x320 and at 640x480, so that 8 px hold. */
#define COARSE_PX_Q8 (20 * 256)
#define ROOTS_SHARE  4 /* of the pool: the rest is for refinements */

/* Pixels Q8 of error that splitting a node would remove, were it looked at. A node that is only
 * wanted because a neighbour may not be two levels finer counts like that neighbour. */
static uint32_t error_px_q8(const ff_tree *tree, const ff_wish *wish, const ff_node *node)
{
    if (tree->quality.measure == FF_MEASURE_PIXELS) return wish->priority;
    ff_box box;
    ff_node_box(tree, node, &box);
    return ff_projected_error_q8(tree, node, (uint64_t)ff_box_distance(&box));
}

static uint32_t roots_held(const ff_tree *tree)
{
    uint32_t count = 0;
    for (uint32_t slot = tree->root_head; slot != FF_SLOT_NONE; slot = tree->node[slot].list_next)
        count++;
    FF_ASSERT(count <= tree->node_count - tree->free_count);
    return count;
}

/* 1 when the wish is for the reserve, with its pixels as priority: error that must not be met, or
 * what lets a new tile join the cut. */
static int is_wanted(const ff_tree *tree, ff_wish *wish)
{
    if (wish->in_view || wish->kind == FF_KIND_ROOT) return !wish->in_view;
    const ff_node *node = &tree->node[ff_tree_find(tree, wish->key)];
    wish->priority = error_px_q8(tree, wish, node);
    return node->flags & FF_NODE_NEEDED || wish->priority > COARSE_PX_Q8;
}

uint32_t ff_tree_reserve(const ff_tree *tree, ff_wish *list, uint32_t capacity)
{
    uint32_t count = 0, roots = roots_held(tree);
    ff_room room = ff_room_make(tree, tree->sort, 0, 4 * (uint64_t)capacity);
    FF_ASSERT(tree->wish_count <= tree->wish_capacity);
    for (uint32_t i = 0; i < tree->wish_count && count < capacity; i++) {
        ff_wish wish = tree->wish[i];
        if (!is_wanted(tree, &wish)) continue;
        int fits = wish.kind == FF_KIND_ROOT
                       ? roots++ < tree->node_count / ROOTS_SHARE &&
                             ff_room_take_slots(tree, &room, 1, FF_VALUE_ONE)
                       : ff_room_take(tree, &room, &tree->node[ff_tree_find(tree, wish.key)]);
        if (fits) list[count++] = wish;
    }
    return count;
}
