/* Pictures as a client holds them: each is decoded by its parent's, over a stream, from a pack, and
 * below levels that are left out; damaged ones, and those whose parent's is not held. */
#include "../../client/ff_client_local.h"
#include "../../client/images/ff_texture_map.h"
#include "../../common3d/soft/c3d_soft.h"
#include "../../protocol/ff_entry.h"
#include "../../protocol/picture/ff_picture_path.h"
#include "../rig/client_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define MB    ((size_t)1 << 20)
#define LOG2  5
#define BYTES (3 << 2 * LOG2)

static void open_rig(client_rig *rig)
{
    rig_open(rig, 0);
    rig_use_pictures(rig, LOG2);
    rig->desc.backend = c3d_backend_soft();
    rig->desc.surface_api = sys_surface_memory();
}

/* What is held of every picture is what the pack has there. How many are held. */
static unsigned check_held(const client_rig *rig)
{
    ff_textures *textures = &rig->client->textures;
    static ff_picture_path path;
    unsigned held = 0;
    path = (ff_picture_path){ .rgb = malloc(ff_picture_path_bytes(&rig->pack)) };
    assert_non_null(textures->pictures.rgb);
    for (unsigned i = 0; i < textures->slot_count; i++) {
        const uint8_t *expected;
        ff_key key = textures->slot[i].key;
        if (!textures->slot[i].tag) continue;
        if (textures->info.entered)
            key = ff_entry_key(&rig->pack.header.info, &textures->info, key);
        assert_int_equal(ff_picture_path_get(&path, &rig->pack, key, &expected), FF_OK);
        int error;
        const uint8_t *rgb = ff_textures_picture(textures, &textures->info, textures->slot[i].key,
                                                 &error);
        assert_non_null(rgb);
        assert_memory_equal(rgb, expected, BYTES);
        held++;
    }
    free(path.rgb);
    return held;
}

static void pictures_are_held_as_the_pack_has_them(void **state)
{
    (void)state;
    for (int local = 0; local < 2; local++) {
        client_rig rig;
        open_rig(&rig);
        if (local)
            rig_local_client(&rig, 4 * MB);
        else
            rig_client(&rig, 4 * MB);
        assert_true(rig_settle(&rig, 600));
        assert_true(check_held(&rig) > 5);
        const ff_drawn *drawn;
        uint32_t count = ff_tree_drawn(ff_client_tree(rig.client), &drawn);
        const ff_textures *textures = &rig.client->textures;
        const ff_view *view = &rig.client->last_view;
        const ff_texel_look look = ff_textures_look(textures, &view->frame, &view->camera);
        for (uint32_t i = 0; i < count; i++) {
            c3d_draw call = { 0 };
            ff_wear worn[FF_WEAR_MAX];
            unsigned parts = ff_textures_worn(textures, ff_client_tree(rig.client), &drawn[i],
                                              &look, worn);
            assert_true(parts >= 1);
            for (unsigned part = 0; part < parts; part++) {
                ff_textures_lay(textures, drawn[i].key, worn[part].image, &call);
                assert_int_equal(call.flags, C3D_DRAW_TEXTURED);
            }
        }
        assert_int_equal(rig.client->textures.apart, 0);
        assert_int_equal(rig_stats(&rig).requests_failed, 0);
        rig_close(&rig);
    }
}

static void roots_below_levels_left_out_bring_what_is_above_them(void **state)
{
    (void)state;
    for (int entered = 1; entered <= 2; entered++) {
        client_rig rig;
        open_rig(&rig);
        rig.desc.quality = (ff_quality){ .c_q8 = 100 * 256,
                                         .view_wu = 800 / (1 << entered) * FF_WU_PER_METRE };
        rig.camera.pos_wu[2] = 1000 * FF_WU_PER_METRE;
        rig.camera.pitch = -8000;
        rig.desc.place_known = 1;
        rig_client(&rig, 8 * MB);
        assert_true(rig_settle(&rig, 600));
        const ff_terrain_info *info = ff_client_terrain(rig.client);
        assert_int_equal(info->entered, entered);
        assert_int_equal(info->images_whole, rig.pack.header.info.texture_levels - entered);
        assert_true(check_held(&rig) >= 1);
        assert_int_equal(rig_stats(&rig).requests_failed, 0);
        rig_close(&rig);
    }
}

/* What a client wishes for that draws these nodes and holds no image. */
static uint32_t wishes_of_none(const client_rig *rig, ff_textures *none, ff_texture_wish *list,
                               uint32_t capacity)
{
    const ff_client *client = rig->client;
    const ff_drawn *drawn;
    uint32_t drawn_count = ff_tree_drawn(client->tree, &drawn);
    int changed = 0;
    none->info = client->textures.info;
    none->across = client->textures.across;
    none->slot_count = none->texture_count = (uint16_t)capacity;
    uint32_t count = ff_textures_wishes(none, client->tree, drawn, drawn_count, &client->last_view,
                                        &client->desc.quality, list, capacity, &changed);
    assert_int_equal(none->lacking, drawn_count);
    return count;
}

static int is_wished_for(const ff_texture_wish *list, uint32_t count, ff_key key)
{
    uint32_t i = 0;
    while (i < count && list[i].key != key) i++;
    return i < count;
}

/* The wanted images of drawn nodes, as far down as all of a level are there and the node's own
 * level, and no others but those above them. */
static void check_wishes(const client_rig *rig, unsigned whole)
{
    ff_wear wear[FF_WEAR_MAX];
    ff_textures none = { .wear = wear };
    ff_texture_wish list[256];
    const ff_drawn *drawn;
    uint32_t count = wishes_of_none(rig, &none, list, 256), finest = 0,
             drawn_count = ff_tree_drawn(ff_client_tree(rig->client), &drawn);
    const ff_texel_look look = ff_textures_look(&none, &rig->client->last_view.frame,
                                                &rig->client->last_view.camera);
    for (uint32_t i = 0; i < drawn_count; i++) {
        unsigned parts = ff_textures_wanted(&none, ff_client_tree(rig->client), &drawn[i], &look,
                                            wear);
        for (unsigned part = 0; part < parts; part++) {
            ff_key image = wear[part].image;
            while (ff_key_level(image) > 0 && (ff_key_level(image) >= whole ||
                                               ff_key_level(image) > ff_key_level(drawn[i].key)))
                image = ff_key_parent(image);
            assert_true(is_wished_for(list, count, image));
            if (ff_key_level(image) > finest) finest = ff_key_level(image);
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        assert_true(ff_key_level(list[i].key) <= finest);
        assert_false(is_wished_for(list, i, list[i].key));
        if (ff_key_level(list[i].key))
            assert_true(is_wished_for(list, i, ff_key_parent(list[i].key)));
    }
}

/* So one round trip brings them, and nothing is asked for that there is not: of ground in all its
 * detail, and where nodes are as coarse as their images are not. */
static void images_that_are_all_there_are_wished_for_at_once(void **state)
{
    (void)state;
    for (int depth = 0; depth < 3; depth++) {
        client_rig rig;
        open_rig(&rig);
        rig.desc.quality.depth_max = (uint8_t)depth;
        rig_client(&rig, 4 * MB);
        assert_true(rig_settle(&rig, 600));
        uint32_t count;
        const ff_terrain_info *ground = ff_tree_grounds(rig.client->tree, &count);
        assert_int_equal(ground->images_whole, ground->texture_levels);
        assert_int_equal(ground->texture_levels, 3);
        for (unsigned whole = 0; whole <= 3; whole++) {
            ((ff_terrain_info *)ground)->images_whole = (uint8_t)whole;
            check_wishes(&rig, whole);
        }
        rig_close(&rig);
    }
}

/* Below an image that does not come nothing could be decoded. */
static void below_a_damaged_image_nothing_is_asked_for(void **state)
{
    (void)state;
    for (int damaged = 0; damaged < 2; damaged++) {
        client_rig rig;
        const uint8_t *payload;
        open_rig(&rig);
        for (uint32_t tile = 0; tile < rig.pack.tiles; tile++) {
            ff_key root = ff_key_make(tile, 0, 0);
            assert_true(ff_pack_record(&rig.pack, FF_SECTION_TEXTURE, root, &payload) > 0);
            rig.pack_bytes[payload - rig.pack_bytes] ^= (uint8_t)damaged;
        }
        rig_client(&rig, 4 * MB);
        (void)rig_settle(&rig, 600);
        const uint32_t asked = rig.asked[FF_KIND_TEXTURE];
        rig_fly(&rig, 200);
        assert_true(damaged ? rig.asked[FF_KIND_TEXTURE] == asked
                            : rig.client->textures.held >= 10);
        if (damaged) assert_int_equal(rig.client->textures.held, 0);
        rig_close(&rig);
    }
}

static ff_new_item item_of(const client_rig *rig, ff_key key)
{
    static uint8_t bytes[4096];
    const uint8_t *payload;
    int count = ff_pack_record(&rig->pack, FF_SECTION_TEXTURE, key, &payload);
    assert_in_range(count, 1, sizeof bytes);
    memcpy(bytes, payload, (size_t)count);
    ff_new_item item = { .key = key,
                         .kind = FF_KIND_TEXTURE,
                         .pixels = (uint16_t *)(void *)bytes,
                         .width = 1 << LOG2,
                         .height = 1 << LOG2 };
    item.u.texture.coded_bytes = (uint32_t)count;
    return item;
}

static void one_whose_parents_is_not_held_is_not_taken(void **state)
{
    (void)state;
    client_rig rig;
    open_rig(&rig);
    rig_local_client(&rig, 4 * MB);
    ff_textures *textures = &rig.client->textures;
    const ff_terrain_info *info = &rig.pack.header.info;
    ff_key root = ff_key_make(0, 0, 0), child = ff_key_child(root, 2);
    ff_new_item item = item_of(&rig, child);
    assert_int_equal(ff_textures_take(textures, info, &item), 0);
    assert_int_equal(item.error, FF_OK);
    assert_int_equal(textures->apart, 1);
    item = item_of(&rig, root);
    assert_int_equal(ff_textures_take(textures, info, &item), 1);
    item = item_of(&rig, child);
    assert_int_equal(ff_textures_take(textures, info, &item), 1);
    assert_int_equal(check_held(&rig), 2);
    item = item_of(&rig, ff_key_child(root, 1));
    ((uint8_t *)item.pixels)[0] = 0;
    assert_int_equal(ff_textures_take(textures, info, &item), 0);
    assert_int_equal(item.error, FF_ERR_FORMAT);
    assert_int_equal(textures->held, 2);
    rig_close(&rig);
}

static uint32_t images_asked(const client_rig *rig) { return rig->asked[FF_KIND_TEXTURE]; }

/* What the device has no room for any more is held as it came, and drawn again from that. */
static void pictures_seen_before_come_back_without_a_request(void **state)
{
    (void)state;
    client_rig rig;
    open_rig(&rig);
    rig.desc.no_prefetch = rig.desc.no_reserve = 1;
    rig.desc.width = rig.camera.width = 64;
    rig.desc.height = rig.camera.height = 64;
    rig.camera.focal_q8 = 100 * 256;
    rig_client(&rig, 4 * MB);
    ff_textures *textures = &rig.client->textures;
    assert_true(rig_settle(&rig, 600));
    textures->texture_count = textures->made; /* no room for more */
    for (int i = 0; i < 8; i++) {
        rig.camera.yaw += 8192;
        assert_true(rig_settle(&rig, 600));
        assert_true(textures->made <= textures->texture_count);
    }
    assert_true(textures->held > textures->made);
    uint32_t asked = images_asked(&rig);
    for (int i = 0; i < 8; i++) {
        rig.camera.yaw += 8192;
        assert_true(rig_settle(&rig, 600));
        for (int frame = 0; frame < 40; frame++) rig_step(&rig, 50000);
        const ff_view *view = &rig.client->last_view;
        const ff_texel_look look = ff_textures_look(textures, &view->frame, &view->camera);
        const ff_drawn *drawn;
        uint32_t count = ff_tree_drawn(ff_client_tree(rig.client), &drawn);
        for (uint32_t j = 0; j < count; j++) {
            ff_wear wear[FF_WEAR_MAX];
            unsigned parts = ff_textures_wanted(textures, ff_client_tree(rig.client), &drawn[j],
                                                &look, wear);
            for (unsigned part = 0; part < parts; part++)
                assert_true(ff_client_wears(rig.client, wear[part].image));
        }
    }
    assert_int_equal(images_asked(&rig), asked);
    assert_int_equal(textures->apart, 0);
    assert_true(check_held(&rig) > 5);
    rig_close(&rig);
}

/* However little is kept of what came: nothing is held without what it is a difference to. */
static void pictures_go_before_those_above_them(void **state)
{
    (void)state;
    client_rig rig;
    open_rig(&rig);
    rig.desc.no_prefetch = rig.desc.no_reserve = 1;
    rig_client(&rig, 4 * MB);
    ff_textures *textures = &rig.client->textures;
    assert_true(rig_settle(&rig, 600));
    textures->pictures.coded_size = textures->pictures.coded_used + 300;
    textures->slot_count = (uint16_t)(textures->held + 2);
    for (int i = 0; i < 40; i++) {
        rig.camera.yaw += 5000;
        rig.camera.pos_wu[0] += i % 8 < 4 ? 200 * FF_WU_PER_METRE : -200 * FF_WU_PER_METRE;
        for (int frame = 0; frame < 20; frame++) rig_step(&rig, 50000);
        assert_true(textures->pictures.coded_used <= textures->pictures.coded_size);
        (void)check_held(&rig);
    }
    assert_int_equal(rig_stats(&rig).requests_failed, 0);
    rig_close(&rig);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_are_held_as_the_pack_has_them),
        cmocka_unit_test(images_that_are_all_there_are_wished_for_at_once),
        cmocka_unit_test(below_a_damaged_image_nothing_is_asked_for),
        cmocka_unit_test(pictures_seen_before_come_back_without_a_request),
        cmocka_unit_test(pictures_go_before_those_above_them),
        cmocka_unit_test(roots_below_levels_left_out_bring_what_is_above_them),
        cmocka_unit_test(one_whose_parents_is_not_held_is_not_taken),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
