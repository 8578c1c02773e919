/* Images over nodes: where their texels fall, which way is up. */
#include "../../client/images/ff_texture_map.h"
#include "../rig/pack_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define TEXELS         64
#define HALF_TEXEL_Q16 (32768 / TEXELS)

static ff_terrain_info textured(void)
{
    ff_terrain_info info = pack_fixture_info(10, 3, 2);
    info.texture_log2 = 6;
    info.texture_levels = 3;
    return info;
}

/* The ends of a node's edge fall on the right texels, and the neighbour's image continues there
 * without a step. */
static void edges_meet_rim_texels(void **state)
{
    (void)state;
    ff_terrain_info info = textured();
    ff_key texture = ff_key_make(1, 1, 2);
    for (uint32_t depth = 0; depth <= 6; depth++) {
        int32_t scale[2], offset[2], end_before = HALF_TEXEL_Q16;
        int32_t cells = 1 << info.node_log2, nodes = 1 << depth;
        for (int32_t place = 0; place < nodes; place++) {
            uint32_t code = 2u << (2 * depth) |
                            ff_morton_encode((uint32_t)place, (uint32_t)(nodes - 1 - place));
            ff_texture_map(&info, ff_key_make(1, 1 + depth, code), texture, scale, offset);
            /* within 8/65536 of the image: a hundredth of a texel */
            assert_in_range(offset[0] - end_before + 8, 0, 16);
            end_before = offset[0] + cells * scale[0];
            assert_in_range(scale[0] * cells * nodes - (65536 - 2 * HALF_TEXEL_Q16) + 4 * nodes, 0,
                            8 * nodes);
            assert_int_equal(scale[1], scale[0]);
            /* y runs the other way here: north places are late in the image's t, which grows to the
             * north. */
            int32_t expected = HALF_TEXEL_Q16 +
                               (65536 - 2 * HALF_TEXEL_Q16) / nodes * (nodes - 1 - place);
            assert_in_range(offset[1] - expected + nodes + 1, 0, 2 * nodes + 2);
        }
        assert_in_range(end_before - (65536 - HALF_TEXEL_Q16) + 8 + 4 * nodes, 0, 16 + 8 * nodes);
    }
}

/* An image below a node lies on its own cells, from its first texel to its last. */
static void images_below_a_node_lie_on_their_cells(void **state)
{
    (void)state;
    ff_terrain_info info = textured();
    for (info.node_log2 = 2; info.node_log2 <= FF_NODE_LOG2_MAX; info.node_log2++)
        for (uint32_t depth = 1; depth <= ff_image_depth(info.node_log2); depth++)
            for (uint32_t i = 0; i < 1u << 2 * depth; i++) {
                ff_key node = ff_key_make(1, 2, 6),
                       image = ff_key_make(1, 2 + depth, 6u << 2 * depth | i);
                int32_t scale[2], offset[2], cells = 1 << (info.node_log2 - depth);
                const int32_t at[2] = { (int32_t)ff_morton_x(i), (int32_t)ff_morton_y(i) };
                ff_texture_map(&info, node, image, scale, offset);
                for (int axis = 0; axis < 2; axis++) {
                    int32_t first = offset[axis] + scale[axis] * at[axis] * cells,
                            last = first + scale[axis] * cells;
                    assert_in_range(first - HALF_TEXEL_Q16 + 8, 0, 16);
                    assert_in_range(last - (65536 - HALF_TEXEL_Q16) + 8, 0, 16);
                }
            }
}

static void first_row_of_a_jpeg_is_north(void **state)
{
    (void)state;
    ff_terrain_info info = textured();
    static uint8_t rgb[TEXELS * TEXELS * 3];
    static uint16_t texels[TEXELS * TEXELS];
    memset(rgb, 0, sizeof rgb);
    rgb[0] = 255;                               /* north-west: red */
    rgb[3 * (TEXELS - 1) + 1] = 255;            /* north-east: green */
    rgb[3 * ((TEXELS - 1) * TEXELS) + 2] = 255; /* south-west: blue */
    ff_texture_texels(&info, rgb, texels);
    assert_int_equal(texels[(TEXELS - 1) * TEXELS], 0xF800);
    assert_int_equal(texels[TEXELS * TEXELS - 1], 0x07E0);
    assert_int_equal(texels[0], 0x001F);
    assert_int_equal(texels[TEXELS - 1], 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(edges_meet_rim_texels),
        cmocka_unit_test(images_below_a_node_lie_on_their_cells),
        cmocka_unit_test(first_row_of_a_jpeg_is_north),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
