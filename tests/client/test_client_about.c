/* What a pack says of itself, at the client: asked for by those who show it, once, and not in the
 * way of ground; and a server of another version. */
#include "../rig/client_fixture.h"
#include "../../client/ff_client_local.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define MB    ((size_t)1 << 20)
#define SHOWN (FF_ABOUT_BIT(FF_ABOUT_NAME) | FF_ABOUT_BIT(FF_ABOUT_ATTRIBUTION))

static const uint8_t said[] = "\1\5Hills\2\6nobody\3\2CC\x63\3xyz";
static const ff_list about = { said, sizeof said - 1 };

static void assert_says(client_rig *rig, enum ff_about_entry entry, const char *text)
{
    char value[64];
    int bytes = ff_client_about(rig->client, entry, value, sizeof value);
    if (!text) {
        assert_int_equal(bytes, FF_ERR_NOT_FOUND);
        return;
    }
    assert_int_equal(bytes, strlen(text));
    assert_memory_equal(value, text, strlen(text));
}

static ff_pool_use pool(const client_rig *rig, const char *name)
{
    ff_pool_use list[FF_POOLS_MAX];
    unsigned count = ff_client_pools(rig->client, list);
    for (unsigned i = 0; i < count; i++)
        if (!strcmp(list[i].name, name)) return list[i];
    fail();
    return list[0];
}

static void who_does_not_show_it_pays_nothing(void **state)
{
    client_rig plain, rig;

    (void)state;
    rig_open(&plain, 0);
    rig_client(&plain, 2 * MB);
    assert_true(rig_settle(&plain, 400));
    rig_open(&rig, 0);
    rig_use_about(&rig, about);
    rig_client(&rig, 2 * MB);
    assert_true(rig_settle(&rig, 400));
    assert_int_equal(rig.asked_about, 0);
    assert_int_equal(rig.bytes_down, plain.bytes_down);
    assert_int_equal(rig_stats(&rig).bytes_up, rig_stats(&plain).bytes_up);
    assert_int_equal(pool(&rig, "about").bytes, 0);
    assert_says(&rig, FF_ABOUT_NAME, NULL);
    rig_close(&rig);
    rig_close(&plain);
}

static void who_shows_it_asks_once_and_gets_what_was_asked_for(void **state)
{
    client_rig rig;
    char value[4];

    (void)state;
    rig_open(&rig, 0);
    rig_use_about(&rig, about);
    rig.desc.about = SHOWN;
    rig_client(&rig, 2 * MB);
    assert_true(rig_settle(&rig, 400));
    assert_int_equal(rig.asked_about, 1);
    assert_says(&rig, FF_ABOUT_NAME, "Hills");
    assert_says(&rig, FF_ABOUT_ATTRIBUTION, "nobody");
    assert_says(&rig, FF_ABOUT_LICENCE, NULL);       /* not wanted */
    assert_says(&rig, (enum ff_about_entry)0, NULL); /* none */
    assert_says(&rig, (enum ff_about_entry)33, NULL);
    assert_int_equal(ff_client_about(rig.client, FF_ABOUT_NAME, value, sizeof value), FF_ERR_FULL);
    assert_int_equal(pool(&rig, "about").bytes, ff_about_bytes_max(SHOWN));
    assert_int_equal(pool(&rig, "about").held, 15);
    /* the same terrain again: it is kept */
    rig.cut_at = rig.bytes_down;
    for (int i = 0; i < 60; i++) rig_step(&rig, 100000);
    assert_true(rig_settle(&rig, 400));
    assert_int_equal(rig.connections, 2);
    assert_int_equal(rig.asked_about, 1);
    assert_says(&rig, FF_ABOUT_NAME, "Hills");
    /* another one: it is not */
    rig.about = (ff_list){ (const uint8_t *)"\1\1B", 3 };
    rig_change_terrain(&rig);
    for (int i = 0; i < 60; i++) rig_step(&rig, 100000);
    assert_true(rig_settle(&rig, 400));
    assert_int_equal(rig.asked_about, 2);
    assert_says(&rig, FF_ABOUT_NAME, "B");
    assert_says(&rig, FF_ABOUT_ATTRIBUTION, NULL);
    rig_close(&rig);
}

/* The picture comes as if nobody had asked, and a connection cut anywhere loses nothing. */
static void ground_goes_first(void **state)
{
    client_rig plain, rig;

    (void)state;
    rig_open(&plain, 0);
    rig_client(&plain, 2 * MB);
    assert_true(rig_settle(&plain, 400));
    rig_open(&rig, 0);
    rig.desc.about = SHOWN;
    rig_client(&rig, 2 * MB);
    assert_true(rig_settle(&rig, 400));
    assert_true(rig.about_at > 2 * FF_TERRAIN_BYTES); /* WELCOME, and ground */
    uint64_t asked_at = rig.about_at;
    rig_close(&rig);
    for (uint64_t at = asked_at - 20; at < asked_at + 60; at += 4) {
        rig_open(&rig, 0);
        rig_use_about(&rig, about);
        rig.desc.about = SHOWN;
        rig.cut_at = at;
        rig_client(&rig, 2 * MB);
        for (int i = 0; i < 200; i++) rig_step(&rig, 100000);
        assert_true(rig_settle(&rig, 400));
        assert_true(rig_same_picture(&rig, &plain));
        assert_says(&rig, FF_ABOUT_NAME, "Hills");
        rig_close(&rig);
    }
    rig_close(&plain);
}

static void a_pack_that_says_nothing_is_an_empty_list(void **state)
{
    client_rig rig;

    (void)state;
    rig_open(&rig, 0);
    rig.desc.about = FF_ABOUT_KNOWN;
    rig_client(&rig, 2 * MB);
    assert_true(rig_settle(&rig, 400));
    for (int i = 0; i < 50; i++) rig_step(&rig, 100000);
    assert_int_equal(rig.asked_about, 1);
    assert_says(&rig, FF_ABOUT_NAME, NULL);
    assert_int_equal(rig_stats(&rig).protocol_errors, 0);
    rig_close(&rig);
}

static void a_pack_on_the_device_is_read_at_once(void **state)
{
    client_rig rig;

    (void)state;
    rig_open(&rig, 0);
    rig_use_about(&rig, about);
    rig.desc.about = SHOWN;
    rig_local_client(&rig, 2 * MB);
    assert_says(&rig, FF_ABOUT_ATTRIBUTION, "nobody");
    assert_says(&rig, FF_ABOUT_LICENCE, NULL);
    assert_int_equal(pool(&rig, "about").bytes, 0);
    rig_close(&rig);
}

/* Transverse Mercator of WGS84, meridian 9 E, as a pack says it. */
static ff_list utm_32(uint8_t bytes[256])
{
    static const int64_t parameter[][2] = { { 8802, INT64_C(9000000000) },
                                            { 8805, INT64_C(999600000000) },
                                            { 8806, INT64_C(500000000000) } };
    uint8_t value[128];
    ff_writer out = { value, value + sizeof value, FF_OK }, list = { bytes, bytes + 256, FF_OK };
    ff_write_bytes(&out, 9807, 2);
    ff_write_bytes(&out, UINT64_C(6378137000000), 8);
    ff_write_bytes(&out, UINT64_C(298257223563), 8);
    ff_write_bytes(&out, 0, 8);
    for (int i = 0; i < 3; i++) {
        ff_write_bytes(&out, (uint64_t)parameter[i][0], 2);
        ff_write_bytes(&out, (uint64_t)parameter[i][1], 8);
    }
    ff_list_write(&list, FF_ABOUT_PROJECTION, value, (uint32_t)(out.at - value));
    return (ff_list){ bytes, (uint32_t)(list.at - bytes) };
}

static void assert_knows_where(client_rig *rig)
{
    ff_geo geo;
    ff_geo_place place;
    const int32_t corner_wu[3] = { 0, 0, 512 };
    assert_int_equal(ff_client_geo(rig->client, &geo), FF_OK);
    assert_int_equal(ff_geo_of(&geo, corner_wu, &place), FF_OK);
    const ff_terrain_info *info = ff_client_terrain(rig->client);
    ff_geo same = geo;
    same.east_um = 0; /* the corner of the ground, from that of the plane */
    same.north_um = 0;
    const int32_t origin_wu[3] = { (int32_t)((info->origin_x_mm - 500000000) * 256 / 1000),
                                   (int32_t)(info->origin_y_mm * 256 / 1000), 512 };
    ff_geo_place again;
    assert_int_equal(ff_geo_of(&same, origin_wu, &again), FF_OK);
    assert_true(llabs(place.latitude_e9 - again.latitude_e9) < 40);
    assert_true(llabs(place.longitude_e9 - again.longitude_e9) < 60);
    assert_int_equal(place.height_mm, 2000);
}

static void where_on_earth_comes_with_what_the_pack_says(void **state)
{
    client_rig rig;
    uint8_t bytes[256];
    ff_geo geo;

    (void)state;
    for (int wanted = 0; wanted < 2; wanted++) {
        rig_open(&rig, 0);
        rig_use_about(&rig, utm_32(bytes));
        if (wanted) rig.desc.about = FF_ABOUT_BIT(FF_ABOUT_PROJECTION);
        rig_client(&rig, 2 * MB);
        assert_int_equal(ff_client_geo(rig.client, &geo), FF_ERR_AGAIN);
        assert_true(rig_settle(&rig, 400));
        for (int i = 0; i < 50; i++) rig_step(&rig, 100000);
        if (wanted)
            assert_knows_where(&rig);
        else
            assert_int_equal(ff_client_geo(rig.client, &geo), FF_ERR_NOT_FOUND);
        rig_close(&rig);
    }
    rig_open(&rig, 0);
    rig_use_about(&rig, utm_32(bytes));
    rig.desc.about = FF_ABOUT_BIT(FF_ABOUT_PROJECTION);
    rig_local_client(&rig, 2 * MB);
    assert_knows_where(&rig);
    rig_close(&rig);
    rig_open(&rig, 0);
    rig_use_about(&rig, about); /* says other things */
    rig.desc.about = FF_ABOUT_KNOWN;
    rig_local_client(&rig, 2 * MB);
    assert_int_equal(ff_client_geo(rig.client, &geo), FF_ERR_NOT_FOUND);
    rig_close(&rig);
}

typedef struct source {
    const uint8_t *bytes;
    atomic_int inside, met;
} source;

/* Slow enough for another thread to come in, and tells when one does. */
static int read_slowly(void *context, uint64_t offset, void *out, size_t count)
{
    source *from = context;
    if (atomic_fetch_add(&from->inside, 1)) atomic_store(&from->met, 1);
    memcpy(out, from->bytes + offset, count);
    sys_sleep_us(100);
    atomic_fetch_sub(&from->inside, 1);
    return FF_OK;
}

/* A view that reads has room for one: the worker reads ground there while the program asks. */
static void a_pack_that_is_read_is_read_by_one_at_a_time(void **state)
{
    static uint8_t room[32768];
    client_rig rig;

    (void)state;
    rig_open(&rig, 0);
    rig_use_about(&rig, about);
    source from = { .bytes = rig.pack.bytes };
    assert_int_equal(
        ff_pack_open_reader(&rig.pack, read_slowly, &from, rig.pack.size, room, sizeof room),
        FF_OK);
    rig.desc.about = SHOWN;
    rig.desc.use_thread = 1;
    rig_local_client(&rig, 2 * MB);
    for (unsigned asked = 0; asked < 100 || rig_stats(&rig).tree.nodes_held <= 20; asked++) {
        rig_step(&rig, 100000);
        assert_says(&rig, FF_ABOUT_ATTRIBUTION, "nobody");
        sys_sleep_us(300); /* the worker comes to its turn */
        assert_true(asked < 30000);
    }
    assert_int_equal(rig_stats(&rig).requests_failed, 0);
    assert_int_equal(atomic_load(&from.met), 0);
    rig_close(&rig);
}

/* A server that sends more than was asked for, or unasked, talks nonsense. */
static void answers_that_nobody_asked_for_are_nonsense(void **state)
{
    client_rig rig;

    (void)state;
    rig_open(&rig, 0);
    rig_use_about(&rig, about);
    rig_client(&rig, 2 * MB);
    assert_true(rig_settle(&rig, 400));
    uint8_t ask[] = { FF_MSG_GET_ABOUT, 1, 1 };
    ff_session_receive(rig.session, ask, sizeof ask, rig.now_us);
    rig_step(&rig, 100000);
    assert_int_equal(rig_stats(&rig).protocol_errors, 1);
    rig_close(&rig);
    rig_open(&rig, 0);
    rig_use_about(&rig, about);
    rig.desc.about = FF_ABOUT_BIT(FF_ABOUT_NAME);
    rig.about_set = SHOWN; /* the attribution comes, too */
    rig_client(&rig, 2 * MB);
    for (int i = 0; i < 200 && !rig_stats(&rig).protocol_errors; i++) rig_step(&rig, 100000);
    assert_int_equal(rig_stats(&rig).protocol_errors, 1);
    char value[8];
    assert_int_equal(ff_client_about(rig.client, FF_ABOUT_NAME, value, sizeof value), FF_ERR_AGAIN);
    rig_close(&rig);
}

static void a_server_of_another_version_is_told(void **state)
{
    client_rig rig;

    (void)state;
    rig_open(&rig, 0);
    rig.version = 4;
    rig_client(&rig, 2 * MB);
    for (int i = 0; i < 20; i++) rig_step(&rig, 100000);
    assert_int_equal(rig_stats(&rig).refusal, FF_ERR_VERSION);
    assert_false(rig_stats(&rig).have_terrain);
    rig.version = 0;
    assert_true(rig_settle(&rig, 4000));
    assert_int_equal(rig_stats(&rig).refusal, FF_OK);
    /* and once more with the terrain held, which the next server has, too */
    rig.version = 4;
    rig.cut_at = rig.bytes_down;
    for (int i = 0; i < 20; i++) rig_step(&rig, 100000);
    assert_int_equal(rig_stats(&rig).refusal, FF_ERR_VERSION);
    rig.version = 0;
    for (int i = 0; i < 200; i++) rig_step(&rig, 100000);
    assert_int_equal(rig_stats(&rig).link, FF_LINK_UP);
    assert_int_equal(rig_stats(&rig).refusal, FF_OK);
    rig_close(&rig);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(who_does_not_show_it_pays_nothing),
        cmocka_unit_test(who_shows_it_asks_once_and_gets_what_was_asked_for),
        cmocka_unit_test(ground_goes_first),
        cmocka_unit_test(a_pack_that_says_nothing_is_an_empty_list),
        cmocka_unit_test(a_pack_on_the_device_is_read_at_once),
        cmocka_unit_test(where_on_earth_comes_with_what_the_pack_says),
        cmocka_unit_test(a_pack_that_is_read_is_read_by_one_at_a_time),
        cmocka_unit_test(answers_that_nobody_asked_for_are_nonsense),
        cmocka_unit_test(a_server_of_another_version_is_told),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
