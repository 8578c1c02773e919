#include "export_part.h"

#include "../../protocol/shape/ff_shape.h"

/* The parents of a rectangle of nodes and of those round it. Beyond the ground there are none. */
static export_rectangle parents_round(const export_rectangle *of)
{
    return (export_rectangle){ of->left ? (of->left - 1) / 2 : 0,
                               of->bottom ? (of->bottom - 1) / 2 : 0, (of->right + 1) / 2,
                               (of->top + 1) / 2 };
}

void export_part_make(const ff_terrain_info *info, const export_window *window, uint32_t level,
                      export_part *part)
{
    *part = (export_part){ .info = info, .level = level };
    for (uint32_t l = 0; l <= FF_KEY_LEVEL_MAX && l <= info->tile_log2; l++) {
        uint32_t log2 = info->tile_log2 - l;
        part->shown[l] = (export_rectangle){ window->left >> log2, window->bottom >> log2,
                                             (window->left + window->width - 2) >> log2,
                                             (window->bottom + window->height - 2) >> log2 };
    }
    for (uint32_t l = level; l-- > 0;)
        part->split[l] = l + 1 == level ? part->shown[l] : parents_round(&part->split[l + 1]);
}

static int is_inside(const export_part *part, const export_rectangle *rectangle, ff_key key)
{
    ff_sheet tile = ff_shape_sheet(part->info, ff_key_tile(key));
    uint32_t level = ff_key_level(key), code = ff_key_code(key),
             x = (tile.x << level) + ff_morton_x(code), y = (tile.y << level) + ff_morton_y(code);
    return x >= rectangle->left && x <= rectangle->right && y >= rectangle->bottom &&
           y <= rectangle->top;
}

int export_part_splits(const export_part *part, ff_key key)
{
    uint32_t level = ff_key_level(key);
    return level < part->level && is_inside(part, &part->split[level], key);
}

int export_part_pictures(const export_part *part, ff_key key)
{
    int finest = part->level + 1 == ff_terrain_levels(part->info);
    if (ff_key_level(key) > part->level && !finest) return 0;
    while (ff_key_level(key) > part->info->tile_log2) key = ff_key_parent(key);
    return ff_key_level(key) == 0 || is_inside(part, &part->shown[ff_key_level(key)], key);
}
