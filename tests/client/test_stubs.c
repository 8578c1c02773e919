/* Of stubs nothing finer is stored, nor of images that say so: a client asks for none of it, draws
 * what there is, and is refused nothing, whether it moves or stands still. */
#include "../rig/client_fixture.h"
#include "../../client/ff_client_local.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#define TEXTURE_LOG2 5

static void open(client_rig *rig, int stubs)
{
    rig_open(rig, TEXTURE_LOG2);
    if (stubs) rig_use_stubs(rig, TEXTURE_LOG2);
    rig->desc.no_prefetch = 0;
    rig->desc.quality.measure = FF_MEASURE_DISTANCE;
    rig->desc.quality.c_q8 = 20 * 256;
    rig->desc.panorama.enabled = FF_PANORAMA_OFF;
}

/* The finest levels of ground drawn and of images held. */
static void finest(const client_rig *rig, uint32_t *ground, uint32_t *image)
{
    const ff_drawn *list;
    const ff_textures *textures = &rig->client->textures;
    uint32_t count = ff_tree_drawn(rig->client->tree, &list);
    *ground = *image = 0;
    for (uint32_t i = 0; i < count; i++)
        if (ff_key_level(list[i].key) > *ground) *ground = ff_key_level(list[i].key);
    for (unsigned i = 0; i < textures->slot_count; i++)
        if (textures->slot[i].tag && ff_key_level(textures->slot[i].key) > *image)
            *image = ff_key_level(textures->slot[i].key);
}

static void a_still_client_settles_on_what_there_is(void **state)
{
    (void)state;
    for (int stubs = 0; stubs < 2; stubs++)
        for (int local = 0; local < 2; local++) {
            client_rig rig;
            uint32_t ground, image;
            open(&rig, stubs);
            assert_int_equal(ff_pack_images_whole(&rig.pack), stubs ? 2 : 3);
            if (local)
                rig_local_client(&rig, 8 << 20);
            else
                rig_client(&rig, 8 << 20);
            assert_true(rig_settle(&rig, 400));
            finest(&rig, &ground, &image);
            assert_int_equal(ground, stubs ? 1 : ff_terrain_levels(&rig.pack.header.info) - 1);
            assert_int_equal(image, stubs ? 1 : 2);
            assert_int_equal(rig_stats(&rig).requests_failed, 0);
            assert_true(!stubs == !rig_stats(&rig).tree.stubs);
            rig_close(&rig);
        }
}

static void a_client_in_flight_asks_for_nothing_that_is_not_there(void **state)
{
    (void)state;
    client_rig rig;
    uint32_t ground, image;
    open(&rig, 1);
    rig.desc.quality.c_q8 = 3 * 256;
    rig.camera.pos_wu[0] = 300 * FF_WU_PER_METRE;
    rig.camera.yaw = 8192;
    rig_client(&rig, 8 << 20);
    rig_fly(&rig, 400);
    finest(&rig, &ground, &image);
    assert_int_equal(ground, 1);
    assert_int_equal(image, 1);
    assert_in_range(rig_heights(&rig), 5, 8); /* roots, and their own */
    assert_in_range(rig.asked[FF_KIND_TEXTURE], 1, 4 + 16);
    assert_int_equal(rig_stats(&rig).requests_failed, 0);
    rig_close(&rig);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_still_client_settles_on_what_there_is),
        cmocka_unit_test(a_client_in_flight_asks_for_nothing_that_is_not_there)
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
