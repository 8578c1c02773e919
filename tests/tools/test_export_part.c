/* Parts of packs can be drawn: all that shows the window is reached from the roots by nodes that
 * are split beside neighbours of their own level, and nothing much is split besides. */
#include "../../platform/sys.h"
#include "../../protocol/shape/ff_shape.h"
#include "../../tools/export/export_part.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

static export_window window;

/* 1 when the node's ground, not its rim alone, is in the window. */
static int shows(const ff_terrain_info *info, ff_key key)
{
    ff_sheet tile = ff_shape_sheet(info, ff_key_tile(key));
    uint32_t level = ff_key_level(key), edge = 1u << (info->tile_log2 - level),
             west = (tile.x << info->tile_log2) + ff_morton_x(ff_key_code(key)) * edge,
             south = (tile.y << info->tile_log2) + ff_morton_y(ff_key_code(key)) * edge;
    return west < window.left + window.width - 1 && west + edge > window.left &&
           south < window.bottom + window.height - 1 && south + edge > window.bottom;
}

/* Is a node there to be drawn: are all above it split? */
static int is_there(const export_part *part, ff_key key)
{
    for (; ff_key_level(key) > 0; key = ff_key_parent(key))
        if (!export_part_splits(part, ff_key_parent(key))) return 0;
    return 1;
}

static uint32_t check_node(const export_part *part, ff_key key)
{
    const ff_terrain_info *info = part->info;
    uint32_t level = ff_key_level(key);
    if (level <= part->level && shows(info, key)) {
        assert_true(is_there(part, key));
        assert_true(export_part_pictures(part, key));
    } else if (level > 0) {
        assert_false(export_part_pictures(part, key));
    }
    if (!export_part_splits(part, key)) return 0;
    assert_true(is_there(part, key));
    for (unsigned side = 0; side < FF_SIDE_COUNT; side++) {
        ff_key beside = ff_shape_neighbour(info, key, (enum ff_side)side).key;
        if (beside != FF_KEY_NONE && ff_shape_has_ground(info, beside))
            assert_true(is_there(part, beside));
    }
    return 1;
}

/* Images deeper than heights go along with the finest part, and with no other. */
static void check_deeper(const export_part *part)
{
    const ff_terrain_info *info = part->info;
    int finest = part->level + 1 == ff_terrain_levels(info);
    for (uint32_t l = ff_terrain_levels(info); l < ff_image_levels(info); l++)
        for (uint32_t tile = 0; tile < ff_shape_tiles(info); tile++)
            for (uint32_t code = 0; code >> 2 * l == 0; code++) {
                ff_key key = ff_key_make(tile, l, code);
                assert_int_equal(export_part_pictures(part, key), finest && shows(info, key));
            }
}

static void check_part(const ff_terrain_info *info, uint32_t level)
{
    export_part part;
    export_part_make(info, &window, level, &part);
    for (uint32_t l = 0; l < ff_terrain_levels(info); l++) {
        uint32_t split = 0, edge = 1u << (info->tile_log2 - l);
        uint32_t most = ((window.width - 2) / edge + 6) * ((window.height - 2) / edge + 6);
        for (uint32_t tile = 0; tile < ff_shape_tiles(info); tile++)
            for (uint32_t code = 0; code >> 2 * l == 0; code++)
                split += check_node(&part, ff_key_make(tile, l, code));
        assert_true(split <= most);
        assert_true(split == 0 || l < level);
    }
    check_deeper(&part);
}

static void all_that_is_stored_can_be_drawn(void **state)
{
    (void)state;
    sys_random random;
    sys_random_seed(&random, 11, 0);
    for (int round = 0; round < 120; round++) {
        ff_terrain_info info = { .node_log2 = 2,
                                 .tile_log2 = (uint8_t)(4 + round % 4),
                                 .tiles_x = 1 + round % 3,
                                 .tiles_y = 1 + round % 2,
                                 .spacing_wu = 256,
                                 .hscale_q24 = 1u << 24 };
        uint32_t tile = 1u << info.tile_log2;
        info.samples_x = info.tiles_x * tile + 1 - sys_random_below(&random, tile - 1);
        info.samples_y = info.tiles_y * tile + 1 - sys_random_below(&random, tile - 1);
        assert_int_equal(ff_terrain_check(&info), FF_OK);
        window.left = sys_random_below(&random, info.samples_x - 1);
        window.bottom = sys_random_below(&random, info.samples_y - 1);
        window.width = 2 + sys_random_below(&random, info.samples_x - 1 - window.left);
        window.height = 2 + sys_random_below(&random, info.samples_y - 1 - window.bottom);
        for (uint32_t level = 0; level < ff_terrain_levels(&info); level++)
            check_part(&info, level);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(all_that_is_stored_can_be_drawn) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
