/* What a scene does not need is not asked for, not held and not computed; and the codec that needs
 * no zlib. */
#include "../rig/client_fixture.h"
#include "../../client/ff_client_local.h"
#include "../../protocol/codec/ff_codec.h"
#include "../../protocol/message/ff_message.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static uint16_t codec_room[FF_CODEC_ROOM_MAX / 2 + 1];

#define BLOCK_BYTES (2u << 20)

/* A terrain without images and panoramas takes nothing for them: no request, no memory, no decoding
 * scratch, no slot on the device. */
static void assert_heights_alone(client_rig *rig)
{
    ff_client_stats stats = rig_stats(rig);
    assert_true(stats.tree.nodes_drawn > 0);
    assert_int_equal(rig->asked[FF_KIND_TEXTURE], 0);
    assert_int_equal(rig->asked[FF_KIND_FACE], 0);
    assert_int_equal(stats.textures_held | stats.textures_high | stats.textures_full, 0);
    assert_int_equal(stats.panorama_requests | stats.panorama_faces | stats.panorama_bytes, 0);
    assert_null(rig->client->textures.slot);
    assert_int_equal(rig->client->textures.slot_count, 0);
    assert_null(rig->client->first.intake.rgb);
    assert_null(rig->client->first.intake.columns);
    assert_int_equal(rig->client->news.image_slots, 0);
    assert_int_equal(rig->client->panorama.face_size, 0);
}

static void a_terrain_without_images(void **state)
{
    (void)state;
    client_rig rig;
    rig_open(&rig, 0);
    rig.desc.panorama.enabled = 0;
    rig_client(&rig, BLOCK_BYTES);
    assert_true(rig_settle(&rig, 400));
    assert_heights_alone(&rig);
    rig_close(&rig);
}

static void images_that_are_not_wanted(void **state)
{
    (void)state;
    client_rig rig;
    rig_open(&rig, 5);
    rig.desc.panorama.enabled = 0;
    rig.desc.no_textures = 1;
    rig_client(&rig, BLOCK_BYTES);
    assert_true(rig_settle(&rig, 400));
    assert_heights_alone(&rig);
    rig_close(&rig);
}

/* Where nobody draws far sets or panoramas none is asked for, and ground is as without. */
static void what_a_server_says_it_lacks(void **state)
{
    (void)state;
    for (int far = 0; far < 2; far++) {
        client_rig plain, rig;
        for (int i = 0; i < 2; i++) {
            client_rig *r = i ? &rig : &plain;
            rig_open(r, 0);
            r->lacks = i ? FF_LACKS_FAR | FF_LACKS_PANORAMAS : 0;
            if (i && far)
                r->desc.far = (ff_far_desc){ .enabled = FF_FAR_PAINT,
                                             .front_wu = 300 * FF_WU_PER_METRE,
                                             .coarse = 16 };
            r->desc.panorama.enabled = (uint8_t)(i && !far);
            rig_client(r, BLOCK_BYTES);
            assert_true(rig_settle(r, 400));
        }
        assert_int_equal(rig.asked[FF_KIND_FAR] + rig.asked[FF_KIND_FACE], 0);
        assert_int_equal(rig_stats(&rig).requests_failed, 0);
        if (far) assert_true(rig_same_picture(&plain, &rig));
        rig_close(&plain);
        rig_close(&rig);
    }
}

/* The same memory holds more ground when images and panoramas are left out; a pack on the device
 * takes no buffers for a link. */
static void memory_goes_to_the_ground(void **state)
{
    (void)state;
    client_rig with, without;
    rig_open(&with, 5);
    with.desc.panorama.enabled = 1;
    rig_client(&with, BLOCK_BYTES);
    assert_true(rig_settle(&with, 400));
    rig_open(&without, 0);
    without.desc.panorama.enabled = 1; /* a pack has nobody to draw them */
    rig_local_client(&without, BLOCK_BYTES);
    assert_true(rig_settle(&without, 400));
    assert_heights_alone(&without);
    ff_client_stats more = rig_stats(&without), less = rig_stats(&with);
    assert_true(more.tree.nodes_capacity > less.tree.nodes_capacity);
    assert_true(less.textures_high > 0);
    assert_null(without.client->first.stream.recv);
    assert_int_equal(more.bytes_up + more.bytes_down, 0);
    rig_close(&with);
    rig_close(&without);
}

/* FF_CODEC_RICE: the decoder's memory has no inflate state, and the deflated form of a body is
 * refused. */
static void rice_needs_no_zlib(void **state)
{
    static uint16_t source[FF_NODE_HEIGHTS_MAX], decoded[FF_NODE_HEIGHTS_MAX];
    static uint8_t payload[FF_PAYLOAD_BYTES_MAX];
    static max_align_t memory[4096];
    static int32_t value[FF_REFINED_HEIGHTS_MAX];
    ff_residuals residuals = { .value = value };
    (void)state;
    for (unsigned i = 0; i < FF_NODE_HEIGHTS_MAX; i++) /* rare values: here deflate is best */
        source[i] = (uint16_t)(20000 + (i % 33 == 7) * 40);
    ff_terrain_info info = pack_fixture_info(7, 1, 1);
    info.node_log2 = 5;
    info.codec = FF_CODEC_DEFLATE;
    size_t with_zlib = ff_decoder_bytes(&info);
    int deflated = ff_encode_root(&info, source, 3, payload, decoded);
    assert_true(deflated > 0);
    assert_int_equal(payload[0] & 3, 2); /* body: deflate */
    info.codec = FF_CODEC_RICE;
    assert_true(ff_decoder_bytes(&info) < 1024 && with_zlib > 16384);
    ff_decoder *decoder = ff_decoder_create(&info, memory, sizeof memory);
    assert_non_null(decoder);
    assert_int_equal(ff_decode_root(decoder, payload, (size_t)deflated, &residuals), FF_ERR_FORMAT);
    int rice = ff_encode_root(&info, source, 3, payload, decoded);
    assert_true(rice > deflated);
    assert_int_not_equal(payload[0] & 3, 2);
    assert_int_equal(ff_decode_root(decoder, payload, (size_t)rice, &residuals), FF_OK);
    ff_reconstruct_root(&info, &residuals, decoded, codec_room);
    assert_memory_equal(decoded, source,
                        (size_t)ff_node_side(&info) * ff_node_side(&info) * sizeof *source);
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(a_terrain_without_images),
                                        cmocka_unit_test(images_that_are_not_wanted),
                                        cmocka_unit_test(what_a_server_says_it_lacks),
                                        cmocka_unit_test(memory_goes_to_the_ground),
                                        cmocka_unit_test(rice_needs_no_zlib) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
