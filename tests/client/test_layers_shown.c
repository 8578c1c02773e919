/* Layers of images as a client has them: which is shown, what is held of others, what is asked for.
 */
#include "../rig/client_fixture.h"
#include "../../client/ff_client_local.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

/* ---- what is held ---- */

static ff_textures textures;
static ff_texture_slot slot[4];
static uint8_t room[1 << 16];
static const ff_image_marks no_marks;

static void open_textures(void)
{
    memset(&textures, 0, sizeof textures);
    memset(slot, 0, sizeof slot);
    textures.info.texture_log2 = 4;
    textures.slot = slot;
    textures.slot_count = textures.texture_count = 4;
    ff_held_pictures_init(&textures.pictures, 4, FF_DECODED_MIN, 4096, room);
}

static void images_of_one_layer_are_not_those_of_another(void **state)
{
    const ff_key key = ff_key_make(3, 2, 5);
    (void)state;
    open_textures();
    assert_int_equal(ff_textures_put(&textures, key, no_marks, NULL), 1);
    assert_int_equal(ff_textures_touch(&textures, key), 1);
    ff_textures_set_layer(&textures, 1);
    assert_int_equal(ff_textures_touch(&textures, key), 0);
    assert_int_equal(ff_textures_put(&textures, key, no_marks, NULL), 1);
    assert_int_equal(textures.held, 2);
    ff_textures_set_layer(&textures, 0);
    assert_int_equal(ff_textures_touch(&textures, key), 1);
}

static void those_of_another_layer_make_room_first(void **state)
{
    (void)state;
    open_textures();
    for (uint32_t i = 0; i < 4; i++)
        (void)ff_textures_put(&textures, ff_key_make(i, 0, 0), no_marks, NULL);
    ff_textures_set_layer(&textures, 1);
    for (uint32_t i = 0; i < 4; i++) {
        textures.stamp++;
        assert_int_equal(ff_textures_put(&textures, ff_key_make(i, 0, 0), no_marks, NULL), 1);
        for (uint32_t before = 0; before <= i; before++)
            assert_int_equal(ff_textures_touch(&textures, ff_key_make(before, 0, 0)), 1);
    }
    ff_textures_set_layer(&textures, 0);
    for (uint32_t i = 0; i < 4; i++)
        assert_int_equal(ff_textures_touch(&textures, ff_key_make(i, 0, 0)), 0);
}

/* ---- what is asked for ---- */

static void a_request_is_of_the_layer_that_was_shown_when_it_was_made(void **state)
{
    static uint8_t memory[1 << 16];
    static ff_requests requests;
    const ff_key key = ff_key_make(0, 1, 2);
    ff_request first, second;
    (void)state;
    assert_in_range(ff_requests_bytes(4), 1, sizeof memory);
    ff_requests_init(&requests, 4, memory);
    assert_int_equal(
        ff_requests_want(&requests, FF_KIND_TEXTURE, key, FF_CLASS_IN_VIEW, 1, 0, NULL), 1);
    assert_int_equal(ff_requests_next(&requests, 0, 4, 1 << 20, 1, &first), 1);
    assert_int_equal(first.layer, 0);
    ff_requests_set_layer(&requests, 2);
    assert_int_equal(ff_requests_out(&requests, FF_KIND_TEXTURE, key), 0);
    assert_int_equal(
        ff_requests_want(&requests, FF_KIND_TEXTURE, key, FF_CLASS_IN_VIEW, 1, 0, NULL), 1);
    assert_int_equal(
        ff_requests_want(&requests, FF_KIND_ROOT, ff_key_make(0, 0, 0), FF_CLASS_FIRST, 1, 0, NULL),
        1);
    assert_int_equal(ff_requests_next(&requests, 0, 4, 1 << 20, 1, &second), 1);
    assert_int_equal(second.kind, FF_KIND_ROOT);
    assert_int_equal(second.layer, 0); /* heights have no layers */
    assert_int_equal(ff_requests_next(&requests, 0, 4, 1 << 20, 1, &second), 1);
    assert_int_equal(second.layer, 2);
    assert_true(second.id != first.id);
    sys_mutex_destroy(&requests.mutex);
}

/* ---- the client ---- */

static void names_are_refused_or_shown(void **state)
{
    client_rig rig;
    (void)state;
    rig_open(&rig, 5);
    rig_local_client(&rig, 2 << 20);
    assert_int_equal(ff_client_layer(rig.client), 0);
    assert_string_equal(ff_client_layer_name(rig.client, 0), "");
    assert_null(ff_client_layer_name(rig.client, 1));
    assert_int_equal(ff_client_set_layer(rig.client, "winter"), FF_ERR_NOT_FOUND);
    assert_int_equal(ff_client_layer(rig.client), 0);
    assert_int_equal(ff_client_set_layer(rig.client, "a name of more than 31 bytes is too long"),
                     FF_ERR_ARGUMENT);
    assert_int_equal(ff_client_set_layer(rig.client, NULL), FF_OK);
    assert_int_equal(ff_client_layer(rig.client), FF_ERR_NOT_FOUND);
    assert_int_equal(ff_client_terrain(rig.client)->texture_levels, 0);
    assert_int_equal(ff_client_set_layer(rig.client, ""), FF_OK);
    assert_int_equal(ff_client_layer(rig.client), 0);
    assert_true(ff_client_terrain(rig.client)->texture_levels > 0);
    rig_close(&rig);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(images_of_one_layer_are_not_those_of_another),
        cmocka_unit_test(those_of_another_layer_make_room_first),
        cmocka_unit_test(a_request_is_of_the_layer_that_was_shown_when_it_was_made),
        cmocka_unit_test(names_are_refused_or_shown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
