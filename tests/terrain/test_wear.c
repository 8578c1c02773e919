/* Which images nodes wear: every square of a node one, texels as large as pixels, as a slow judge
 * in double precision finds. */
#include "../../client/images/ff_wear.h"
#include "../rig/client_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define MB ((size_t)1 << 20)

static void images_below_a_node_share_its_squares_out(void **state)
{
    (void)state;
    for (unsigned k = 1; k <= FF_NODE_LOG2_MAX; k++) {
        unsigned side = 1u << ff_squares_log2(k);
        ff_key node = ff_key_make(3, 2, 9);
        for (uint32_t depth = 0; depth <= ff_image_depth(k); depth++) {
            ff_squares all = 0;
            for (uint32_t i = 0; i < 1u << 2 * depth; i++) {
                ff_key image = ff_key_make(3, 2 + depth, 9u << 2 * depth | i);
                ff_squares some = ff_wear_squares(k, node, image);
                uint32_t x = ff_morton_x(i) * side >> depth, y = ff_morton_y(i) * side >> depth;
                assert_true(some && !(some & all));
                assert_true(some >> (y * FF_SQUARES_ROW + x) & 1u);
                all |= some;
            }
            for (unsigned j = 0; j < side; j++)
                assert_int_equal(all >> j * FF_SQUARES_ROW & 255u, (1u << side) - 1);
        }
    }
}

static double beside(int64_t lo, int64_t hi)
{
    return lo > 0 ? (double)lo : hi < 0 ? -(double)hi : 0;
}

/* Pixels along a texel of a level at the nearest place of an image's ground. */
static double texel_px(const ff_terrain_info *info, const ff_drawn *drawn, ff_key of,
                       uint32_t level, const ff_texel_look *look)
{
    int64_t height_wu[2];
    ff_tree_heights_wu(info, drawn->node, height_wu);
    ff_placed placed = ff_shape_put(info, &look->frame, of);
    ff_box box = ff_shape_box(info, of, &placed, height_wu, look->pos_wu);
    double aside = hypot(beside(box.lo[0], box.hi[0]), beside(box.lo[1], box.hi[1]));
    double distance = fmax(1, hypot(aside, beside(box.lo[2], box.hi[2])));
    double texel_wu = ldexp(info->spacing_wu, info->tile_log2 - (int)level - info->texture_log2);
    double across = texel_wu * look->focal_q8 / 256 / distance;
    double lean = (double)(box.hi[2] - box.lo[2]) / (double)(box.hi[0] - box.lo[0]);
    double up = fmax(0, fmax((double)box.hi[2], -(double)box.lo[2]));
    double shown = fmin(1, (up + lean * aside) / distance);
    return look->across ? across : across * sqrt(shown);
}

static void check_part(const ff_tree *tree, const ff_drawn *drawn, const ff_texel_look *look,
                       const ff_wear *part)
{
    const ff_terrain_info *info = ff_tree_ground(tree, drawn->key);
    uint32_t level = ff_key_level(part->image), own = ff_key_level(drawn->key),
             most = own + ff_image_depth(info->node_log2),
             last = info->texture_levels - 1u < most ? info->texture_levels - 1u : most;
    double limit = look->texel_px_q8 / 256.0;
    ff_key of = level > own ? part->image : drawn->key;
    assert_true(level <= last);
    if (level > 0) assert_true(texel_px(info, drawn, of, level - 1, look) > limit * 0.99 - 0.01);
    if (level < last && level < own)
        assert_true(texel_px(info, drawn, of, level, look) < limit * 1.01 + 0.01);
}

/* Below an image that is worn as a whole nobody wants a finer one. */
static void check_below(const ff_tree *tree, const ff_drawn *drawn, const ff_texel_look *look,
                        const ff_wear *part)
{
    const ff_terrain_info *info = ff_tree_ground(tree, drawn->key);
    uint32_t level = ff_key_level(part->image), own = ff_key_level(drawn->key);
    if (level < own || level + 1 >= info->texture_levels ||
        level - own >= ff_image_depth(info->node_log2))
        return;
    for (uint32_t q = 0; q < 4; q++) {
        ff_key child = ff_key_child(part->image, q);
        if (!(ff_wear_squares(info->node_log2, drawn->key, child) & part->squares)) continue;
        if (ff_shape_has_ground(info, child))
            assert_true(texel_px(info, drawn, child, level, look) <
                        look->texel_px_q8 / 256.0 * 1.01 + 0.01);
    }
}

static unsigned check_node(const ff_tree *tree, const ff_drawn *drawn, const ff_texel_look *look)
{
    ff_wear list[FF_WEAR_MAX];
    unsigned count = ff_wear_list(tree, drawn, look, list);
    const ff_terrain_info *info = ff_tree_ground(tree, drawn->key);
    ff_squares all = 0, whole = ff_wear_squares(info->node_log2, drawn->key, drawn->key);
    assert_true(count >= 1);
    for (unsigned i = 0; i < count; i++) {
        assert_true(!(all & list[i].squares));
        all |= list[i].squares;
        check_part(tree, drawn, look, &list[i]);
        check_below(tree, drawn, look, &list[i]);
    }
    assert_true((all & whole) == whole);
    return count;
}

static void texels_are_as_large_as_pixels(void **state)
{
    (void)state;
    unsigned parts = 0, nodes = 0;
    for (unsigned k = 1; k <= FF_NODE_LOG2_MAX; k++) {
        client_rig rig;
        rig_open(&rig, 5);
        rig_use_node_log2(&rig, k, 5);
        rig_local_client(&rig, 8 * MB);
        assert_true(rig_settle(&rig, 600));
        const ff_tree *tree = ff_client_tree(rig.client);
        const ff_drawn *drawn;
        uint32_t count = ff_tree_drawn(tree, &drawn);
        for (int32_t texel_px_q8 = 16; texel_px_q8 < 1 << 14; texel_px_q8 *= 2)
            for (uint8_t across = 0; across < 2; across++) {
                ff_texel_look look = { .focal_q8 = rig.camera.focal_q8,
                                       .texel_px_q8 = texel_px_q8,
                                       .across = across };
                memcpy(look.pos_wu, rig.camera.pos_wu, sizeof look.pos_wu);
                for (uint32_t i = 0; i < count; i++, nodes++)
                    parts += check_node(tree, &drawn[i], &look);
            }
        rig_close(&rig);
    }
    assert_true(parts > nodes + 100);
}

static void a_node_wears_as_many_images_as_it_has_room_for(void **state)
{
    (void)state;
    client_rig rig;
    rig_open(&rig, 5);
    rig_use_node_log2(&rig, FF_NODE_LOG2_MAX, 5);
    rig_local_client(&rig, 8 * MB);
    assert_true(rig_settle(&rig, 600));
    const ff_tree *tree = ff_client_tree(rig.client);
    const ff_drawn *drawn;
    assert_true(ff_tree_drawn(tree, &drawn) > 0);
    /* the rig's pack has no images so fine */
    ff_terrain_info *info = (ff_terrain_info *)(uintptr_t)ff_tree_ground(tree, drawn->key);
    info->texture_levels = (uint8_t)(ff_key_level(drawn->key) + FF_IMAGE_DEPTH_MAX + 1);
    ff_texel_look look = { .focal_q8 = rig.camera.focal_q8, .texel_px_q8 = 1, .across = 1 };
    memcpy(look.pos_wu, rig.camera.pos_wu, sizeof look.pos_wu);
    assert_int_equal(check_node(tree, drawn, &look), FF_WEAR_MAX);
    rig_close(&rig);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(images_below_a_node_share_its_squares_out),
        cmocka_unit_test(texels_are_as_large_as_pixels),
        cmocka_unit_test(a_node_wears_as_many_images_as_it_has_room_for),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
