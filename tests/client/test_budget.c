/* The budget: in blocks of every size all pools have their least and fit together, a client takes
 * just what the budget says, and each pool tells how much of it was used. */
#include "../rig/client_fixture.h"
#include "../../client/ff_client_local.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#define BLOCK_BYTES (4u << 20)

/* The three settings: heights only; with images; with images and panoramas. */
enum scene { HEIGHTS, IMAGES, PANORAMAS, SCENES };
static const char *const scene_name[] = { "heights only", "with images", "with panoramas" };

static ff_terrain_info terrain_of(enum scene scene, unsigned node_log2)
{
    ff_terrain_info info = pack_fixture_info(7, 2, 2);
    info.node_log2 = (uint8_t)node_log2;
    info.texture_log2 = scene >= IMAGES ? 6 : 0;
    info.texture_levels = scene >= IMAGES ? 3 : 0;
    return info;
}

static ff_client_desc desc_of(enum scene scene, int pictures)
{
    static sys_stream stream;
    ff_client_desc desc = { .stream = &stream,
                            .panorama = { .enabled = scene == PANORAMAS },
                            .use_plain_arrays = 1,
                            .backend = pictures ? c3d_backend_soft() : NULL,
                            .surface_api = pictures ? sys_surface_memory() : NULL };
    ff_client_default_desc(&desc);
    return desc;
}

/* Plans the budget as ff_client_carve does: 1, or 0 when the block is too small. */
static int make_budget(ff_budget *b, const ff_client_desc *desc, const ff_terrain_info *info)
{
    ff_budget_fixed(b, desc, desc->memory_bytes);
    for (unsigned economy = 0; economy < FF_ECONOMY_STEPS; economy++) {
        ff_budget_economise(b, info, economy);
        if (ff_budget_terrain(b, 0) == FF_OK) return 1;
    }
    return 0;
}

/* Every pool that is needed has its least and no more than its most, the device's parts lie within
 * it, and all together are within the block. */
static void check_rows(const ff_budget *b)
{
    size_t sum = 0, parts = 0;
#define X(name, when, wanted, least, most, bytes_of_n, held, high, why)  \
    if (when) {                                                          \
        assert_in_range(b->pool[FF_POOL_##name].count, (least), (most)); \
        assert_true(b->pool[FF_POOL_##name].bytes > 0);                  \
    } else {                                                             \
        assert_int_equal(b->pool[FF_POOL_##name].count, 0);              \
        assert_int_equal(b->pool[FF_POOL_##name].bytes, 0);              \
    }                                                                    \
    sum += ff_arena_cost(b->pool[FF_POOL_##name].bytes);
#define PART(name, n, bytes_of_n, held, high, why) parts += b->pool[FF_POOL_##name].bytes;
    FF_POOL_LIST(X, PART)
#undef X
#undef PART
    assert_int_equal(sum, b->used);
    assert_true(sum <= b->block);
    if (!b->desc->backend) return;
    c3d_desc bare = b->device;
    bare.mesh_count = bare.strip_count = bare.texture_count = 0;
    bare.strip_indices_max = bare.texture_bytes = 0;
    assert_int_equal(c3d_bytes(b->desc->backend, &bare) + parts, b->pool[FF_POOL_device].bytes);
}

static void pools_fit_into_every_block(void **state)
{
    unsigned fitted[SCENES] = { 0 };
    (void)state;
    for (int pictures = 0; pictures < 2; pictures++)
        for (unsigned scene = 0; scene < SCENES; scene++)
            for (unsigned node_log2 = 1; node_log2 <= FF_NODE_LOG2_MAX; node_log2++)
                for (size_t bytes = 256 << 10; bytes <= 16 << 20; bytes += (bytes >> 5) + 13) {
                    ff_client_desc desc = desc_of(scene, pictures);
                    ff_terrain_info info = terrain_of(scene, node_log2);
                    ff_budget budget;
                    desc.memory_bytes = bytes;
                    if (!make_budget(&budget, &desc, &info)) {
                        assert_true(bytes < 1600 << 10); /* nodes of 33 x 33 with pictures */
                        continue;
                    }
                    check_rows(&budget);
                    fitted[scene]++;
                }
    for (unsigned scene = 0; scene < SCENES; scene++) assert_true(fitted[scene] > 500);
}

/* What a handheld holds in blocks of 1, 2, 4 and 8 MB, as a table; and what has to hold there. */
static void the_usual_blocks(void **state)
{
    (void)state;
    for (unsigned scene = 0; scene < SCENES; scene++)
        for (unsigned mb = 1; mb <= 8; mb *= 2) {
            ff_client_desc desc = desc_of(scene, 1);
            ff_terrain_info info = terrain_of(scene, 3);
            ff_budget b;
            desc.memory_bytes = (size_t)mb << 20;
            assert_true(make_budget(&b, &desc, &info));
            print_message(
                "# %u MB, %s: %u texels a side of faces, %u images, %u meshes, %u nodes\n", mb,
                scene_name[scene], b.face_size, b.pool[FF_POOL_textures].count,
                b.pool[FF_POOL_meshes].count, b.pool[FF_POOL_nodes].count);
            assert_int_equal(b.has_textures, scene >= IMAGES && mb >= 2);
            assert_int_equal(b.face_size, scene == PANORAMAS && mb >= 4 ? 256 : 0);
            assert_int_equal(b.pool[FF_POOL_items].count, 24);
            assert_int_equal(b.pool[FF_POOL_textures].count, b.has_textures ? 20 * mb : 0);
            assert_true(b.pool[FF_POOL_nodes].count > 500);
        }
}

/* With an entered root's picture come those above it, in one answer. */
static void rows_of_entered_pictures_find_room(void **state)
{
    (void)state;
    for (unsigned log2 = 5; log2 <= 6; log2++)
        for (unsigned entered = 0; entered <= 12; entered++) {
            ff_client_desc desc = desc_of(IMAGES, 1);
            ff_terrain_info info = terrain_of(IMAGES, 3);
            ff_budget b;
            desc.memory_bytes = BLOCK_BYTES;
            info.texture_log2 = (uint8_t)log2;
            info.flags |= FF_TERRAIN_PICTURES;
            info.entered = (uint8_t)entered;
            assert_true(make_budget(&b, &desc, &info) && b.has_textures);
            assert_true(b.image_bytes >= (size_t)(entered ? entered + 1 : 2) << 2 * log2);
            assert_true(b.pool[FF_POOL_textures].count >= 64);
        }
}

/* A picture so large that there is no room for all: fewer images, not none. */
static void large_pictures_leave_room_for_some_images(void **state)
{
    (void)state;
    ff_client_desc desc = desc_of(IMAGES, 1);
    ff_terrain_info info = terrain_of(IMAGES, 3);
    ff_budget b;
    desc.memory_bytes = BLOCK_BYTES;
    desc.width = 640;
    desc.height = 480;
    desc.frame_format = C3D_RGBA8888;
    assert_true(make_budget(&b, &desc, &info) && b.has_textures);
    assert_in_range(b.pool[FF_POOL_textures].count, 16, 40);
    assert_true(b.pool[FF_POOL_nodes].count >= 1024);
}

/* The pools that a client has are those that were planned for it. */
static void a_client_is_carved_as_planned(void **state)
{
    static _Alignas(64) uint8_t block[BLOCK_BYTES];
    ff_pool_use planned[FF_POOLS_MAX], carved[FF_POOLS_MAX];
    client_rig rig;
    ff_client *client;
    size_t sum = 0;
    (void)state;
    rig_open(&rig, 6);
    rig.desc.pack = &rig.pack;
    rig.desc.memory = block;
    rig.desc.memory_bytes = sizeof block;
    rig.desc.backend = c3d_backend_soft();
    rig.desc.surface_api = sys_surface_memory();
    assert_int_equal(ff_client_create(&rig.desc, &client), FF_OK);
    ff_client_stats stats;
    ff_client_get_stats(client, &stats);
    unsigned pools = ff_client_pools(client, carved);
    assert_int_equal(ff_client_plan(&rig.desc, &rig.pack.header.info, planned), pools);
    for (unsigned i = 0; i < pools; i++) {
        assert_string_equal(carved[i].name, planned[i].name);
        assert_int_equal(carved[i].count, planned[i].count);
        assert_int_equal(carved[i].bytes, planned[i].bytes);
        if (!carved[i].inside) sum += ff_arena_cost(carved[i].bytes);
    }
    assert_int_equal(sum, client->arena.used);
    assert_int_equal(carved[FF_POOL_nodes].count, stats.tree.nodes_capacity);
    assert_int_equal(carved[FF_POOL_entries].count, client->view.entry_count);
    assert_int_equal(carved[FF_POOL_textures].count, client->textures.texture_count);
    assert_int_equal(carved[FF_POOL_items].count, client->news.item_slots);
    assert_int_equal(carved[FF_POOL_images].count, client->news.image_slots);
    assert_int_equal(carved[FF_POOL_requests].count, client->first.requests.slot_count);
    ff_client_destroy(client);
    free(rig.pack_bytes);
}

static const ff_pool_use *pool_of(const client_rig *rig, enum ff_pool_id pool)
{
    static ff_pool_use list[FF_POOLS_MAX];
    unsigned pools = ff_client_pools(rig->client, list);
    assert_int_equal(pools, FF_POOL_COUNT);
    for (unsigned i = 0; i < pools; i++) {
        assert_true(list[i].held <= list[i].high);
        assert_true(list[i].high <= list[i].count);
    }
    return &list[pool];
}

/* Each pool's own counters, over a link, with pictures, equal the client's figures. */
static void pools_tell_what_they_hold(void **state)
{
    client_rig rig;
    (void)state;
    rig_open(&rig, 6);
    rig.desc.panorama.enabled = 1;
    rig.desc.backend = c3d_backend_soft();
    rig.desc.surface_api = sys_surface_memory();
    rig_client(&rig, BLOCK_BYTES);
    assert_int_equal(pool_of(&rig, FF_POOL_nodes)->count, 0); /* no terrain yet */
    assert_int_equal(pool_of(&rig, FF_POOL_requests)->high, 0);
    for (unsigned frame = 0; frame < 200; frame++) {
        rig_step(&rig, 50000);
        ff_client_draw(rig.client);
        (void)pool_of(&rig, FF_POOL_client);
    }
    ff_client_stats stats = rig_stats(&rig);
    assert_int_equal(pool_of(&rig, FF_POOL_nodes)->held, stats.tree.nodes_held);
    assert_int_equal(pool_of(&rig, FF_POOL_nodes)->high, stats.tree.nodes_high);
    assert_int_equal(pool_of(&rig, FF_POOL_textures)->high, stats.textures_high);
    assert_int_equal(pool_of(&rig, FF_POOL_meshes)->high, stats.c3d.mesh_high);
    assert_true(stats.textures_high > 0 && stats.panorama_faces > 0);
    assert_true(pool_of(&rig, FF_POOL_device_textures)->high > stats.textures_high);
    assert_true(pool_of(&rig, FF_POOL_entries)->high >= stats.tree.nodes_drawn);
    assert_int_equal(pool_of(&rig, FF_POOL_requests)->held, stats.queued + stats.in_flight);
    assert_true(pool_of(&rig, FF_POOL_requests)->high >= stats.queued_high);
    assert_true(pool_of(&rig, FF_POOL_received)->high > 0);
    assert_true(pool_of(&rig, FF_POOL_items)->high > 1);
    assert_true(pool_of(&rig, FF_POOL_images)->high > 0);
    assert_int_equal(pool_of(&rig, FF_POOL_items)->held, 0);
    rig_close(&rig);
}

static void wide_pictures_have_finer_paint(void **state)
{
    (void)state;
    for (uint16_t width = 240; width <= 640; width += 80) {
        ff_client_desc desc = { .width = width }, asked = { .width = width, .far.quality = 40 };
        ff_client_default_desc(&desc);
        ff_client_default_desc(&asked);
        assert_int_equal(desc.far.quality, width > 320 ? 84 : 80);
        assert_int_equal(asked.far.quality, 40);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(pools_fit_into_every_block),
                                        cmocka_unit_test(the_usual_blocks),
                                        cmocka_unit_test(rows_of_entered_pictures_find_room),
                                        cmocka_unit_test(large_pictures_leave_room_for_some_images),
                                        cmocka_unit_test(a_client_is_carved_as_planned),
                                        cmocka_unit_test(pools_tell_what_they_hold),
                                        cmocka_unit_test(wide_pictures_have_finer_paint) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
