/* Maps: cameras from above and what leads from them to a flight; contours that lie where the ground
 * drawn has their height. */
#include "../rig/client_fixture.h"
#include "../../client/map/ff_contours.h"
#include "../../client/map/ff_map.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define MB     (1 << 20)
#define METRE  FF_WU_PER_METRE
#define WIDTH  240
#define HEIGHT 320

static const c3d_camera lens = { .focal_q8 = 208 << 8, .width = WIDTH, .height = HEIGHT };

static void a_map_looks_straight_down(void **state)
{
    (void)state;
    const int32_t place[3] = { 5000 * METRE, -3000 * METRE, 800 * METRE };
    c3d_camera camera = lens;
    ff_map map = ff_map_make(place, 8192, 20 * METRE << 8, &lens);
    ff_map_camera(&map, &camera);
    assert_int_equal(camera.pitch, -16384);
    assert_int_equal(camera.yaw, 8192);
    assert_int_equal(camera.focal_q8, FF_MAP_LENS * lens.focal_q8);
    for (int axis = 0; axis < 2; axis++)
        assert_in_range(camera.pos_wu[axis] - place[axis] + 1, 0, 2);
    assert_in_range(camera.pos_wu[2] - place[2], (20 * 208 * FF_MAP_LENS - 2) * METRE,
                    (20 * 208 * FF_MAP_LENS + 2) * METRE);
    assert_in_range(ff_map_px_wu_q8(&map), (20 * METRE << 8) - 64, (20 * METRE << 8) + 64);
}

static void assert_near(int64_t a, int64_t b, int64_t within)
{
    assert_in_range(a - b + within, 0, 2 * within);
}

static void a_flight_is_a_view_of_what_it_looks_at(void **state)
{
    (void)state;
    srand(1);
    for (int i = 0; i < 1000; i++) {
        c3d_camera flight = lens, back = lens;
        for (int axis = 0; axis < 3; axis++) flight.pos_wu[axis] = rand() % (1 << 26);
        flight.yaw = rand() & 65535;
        flight.pitch = rand() % 32768 - 16384;
        ff_map map = ff_map_of_camera(&flight, 1 + rand() % (1 << 24));
        ff_map_camera(&map, &back);
        assert_int_equal(back.yaw, flight.yaw);
        assert_int_equal(back.pitch, flight.pitch);
        assert_int_equal(back.focal_q8, flight.focal_q8);
        for (int axis = 0; axis < 3; axis++) assert_near(back.pos_wu[axis], flight.pos_wu[axis], 2);
    }
}

/* No frame of the way moves by more than its share, and both ends are met. */
static void the_way_to_a_flight_has_no_jump(void **state)
{
    (void)state;
    const int32_t place[3] = { 0, 0, 500 * METRE };
    c3d_camera flight = lens;
    flight.yaw = 60000;
    flight.pitch = -1500;
    flight.pos_wu[2] = 900 * METRE;
    const ff_map map = ff_map_make(place, 2000, 100 * METRE << 8, &lens),
                 to = ff_map_of_camera(&flight, 4000 * METRE);
    ff_map last = ff_map_between(&map, &to, 0);
    assert_memory_equal(last.place_wu, map.place_wu, sizeof map.place_wu);
    assert_near(last.away_wu, map.away_wu, map.away_wu / 4096);
    for (uint32_t part = 1024; part <= 65536; part += 1024) {
        ff_map now = ff_map_between(&map, &to, part);
        int64_t px = ff_map_px_wu_q8(&now), px_last = ff_map_px_wu_q8(&last);
        assert_in_range((int16_t)(last.yaw - now.yaw), 100, 130); /* 7536 the shorter way */
        assert_in_range(now.tilt - last.tilt, 200, 260);
        assert_in_range(px_last * 1000 / px, 1010, 1100); /* a 64th of the octaves */
        last = now;
    }
    assert_memory_equal(&last, &to, sizeof last);
}

static void contours_and_bars_are_round(void **state)
{
    (void)state;
    static const struct {
        int64_t px_mm;
        int contour_m;
        uint32_t bar_m, bar_px;
    } rows[] = { { 125, 1, 10, 80 },    { 1000, 2, 100, 100 },    { 1001, 5, 100, 99 },
                 { 7000, 20, 500, 71 }, { 30000, 100, 2000, 66 }, { 250000, 500, 20000, 80 },
                 { 5, 1, 0, 0 } };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        uint32_t metres;
        int64_t px_wu_q8 = (rows[i].px_mm * METRE << 8) / 1000;
        assert_int_equal(ff_map_contour_wu(px_wu_q8), rows[i].contour_m * METRE);
        assert_int_equal(ff_map_bar(px_wu_q8, 100, &metres), rows[i].bar_px);
        assert_int_equal(metres, rows[i].bar_m);
    }
    assert_true(ff_map_contour_wu(INT64_MAX) > 0);
}

/* ---- contours ---- */

static uint32_t *picture(client_rig *rig, int32_t contour_wu)
{
    enum c3d_texture_format format;
    const ff_map_show show = { .contour_wu = contour_wu };
    uint32_t *copy = malloc(WIDTH * HEIGHT * 4);
    assert_int_equal(ff_client_set_map(rig->client, &show), FF_OK);
    ff_client_draw(rig->client);
    const void *pixels = c3d_frame_pixels(ff_client_device(rig->client), &format);
    assert_int_equal(format, C3D_RGBA8888);
    memcpy(copy, pixels, WIDTH * HEIGHT * 4);
    return copy;
}

/* Of the pack the rig has, and of `more`. */
static void begin_map(client_rig *rig, const ff_source_desc *more)
{
    rig->desc.backend = c3d_backend_soft();
    rig->desc.surface_api = sys_surface_memory();
    rig->desc.frame_format = C3D_RGBA8888;
    rig->desc.use_map = 1;
    rig->desc.use_plain_arrays = 1;
    rig->desc.more = more;
    rig->desc.more_count = more != NULL;
    rig_local_client(rig, 4 * MB);
    const int32_t place[3] = { 2000 * METRE, 2000 * METRE, 0 };
    ff_map map = ff_map_make(place, 0, 10 * METRE << 8, &lens);
    ff_map_camera(&map, &rig->camera);
    assert_true(rig_settle(rig, 600));
}

static void open_map(client_rig *rig)
{
    rig_open(rig, 0);
    begin_map(rig, NULL);
}

/* The heights that pixels show; INT32_MAX: no ground. */
static int32_t *heights(client_rig *rig)
{
    int32_t *height_wu = malloc(WIDTH * HEIGHT * sizeof *height_wu);
    assert_int_equal(c3d_read_depth(ff_client_device(rig->client), height_wu), FF_OK);
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        if (height_wu[i] != INT32_MAX) height_wu[i] = rig->camera.pos_wu[2] - height_wu[i];
    return height_wu;
}

/* 1 where a line may be: a multiple of the interval lies between the heights round a pixel, or
 * little beyond. */
static int may_be(const int32_t *height_wu, int x, int y, int32_t interval_wu)
{
    int32_t low = INT32_MAX, high = -INT32_MAX;
    for (int dy = -1; dy <= 1; dy++)
        for (int dx = -1; dx <= 1; dx++) {
            int32_t h = height_wu[(y + dy) * WIDTH + x + dx];
            if (h == INT32_MAX) return 1;
            low = h < low ? h : low;
            high = h > high ? h : high;
        }
    int32_t beyond = (high - low) / 2; /* a ridge between the middles of two pixels */
    low -= beyond;
    high += beyond;
    return (low + 1000 * interval_wu) / interval_wu != (high + 1000 * interval_wu) / interval_wu;
}

static int is_crossed(const int32_t *height_wu, int at, int beside, int32_t interval_wu)
{
    int32_t a = height_wu[at], b = height_wu[beside];
    return a != INT32_MAX && b != INT32_MAX &&
           (a + 1000 * interval_wu) / interval_wu != (b + 1000 * interval_wu) / interval_wu;
}

static void contours_lie_where_the_ground_has_their_height(void **state)
{
    (void)state;
    client_rig rig;
    open_map(&rig);
    for (int32_t interval_wu = 20 * METRE; interval_wu <= 100 * METRE; interval_wu *= 5) {
        uint32_t *without = picture(&rig, 0);
        int32_t *height_wu = heights(&rig);
        uint32_t *with = picture(&rig, interval_wu);
        unsigned lines = 0, wrong = 0, crossed = 0, missing = 0;
        for (int y = 1; y < HEIGHT - 1; y++)
            for (int x = 1; x < WIDTH - 1; x++) {
                int at = y * WIDTH + x;
                int changed = with[at] != without[at];
                lines += changed;
                wrong += changed && !may_be(height_wu, x, y, interval_wu);
                if (!is_crossed(height_wu, at, at + 1, interval_wu)) continue;
                crossed++;
                missing += !changed && with[at + 1] == without[at + 1] &&
                           with[at + WIDTH] == without[at + WIDTH] &&
                           with[at - WIDTH] == without[at - WIDTH];
            }
        assert_true(crossed > 200 && lines > crossed);
        assert_int_equal(wrong, 0);
        assert_true(missing * 100 <= crossed);
        free(without);
        free(with);
        free(height_wu);
    }
    assert_int_equal(rig_stats(&rig).c3d.stale_handles, 0);
    rig_close(&rig);
}

/* Whatever a strip before, or a picture, had them lie apart. */
static void contours_are_those_of_their_interval(void **state)
{
    (void)state;
    client_rig rig;
    open_map(&rig);
    for (int32_t interval_wu = 30 * METRE; interval_wu < 300 * METRE; interval_wu += 7 * METRE) {
        uint32_t *first = picture(&rig, interval_wu);
        for (int32_t before_wu = 4 * METRE; before_wu <= 50 * METRE; before_wu *= 2) {
            free(picture(&rig, before_wu));
            uint32_t *again = picture(&rig, interval_wu);
            assert_memory_equal(again, first, WIDTH * HEIGHT * sizeof *first);
            free(again);
        }
        free(first);
    }
    rig_close(&rig);
}

/* The hills by every eighth sample: ground that reaches 2 km further to all sides. */
static uint16_t coarse_hills(void *context, uint32_t x, uint32_t y)
{
    return pack_fixture_hills(context, 8 * x, 8 * y);
}

static uint8_t *open_coarse(ff_pack *pack)
{
    pack_fixture_desc desc = { .info = pack_fixture_info(5, 1, 1), .height = coarse_hills };
    size_t bytes;
    desc.info.spacing_wu *= 8;
    desc.info.epsg = 32632;
    desc.info.origin_x_mm = 498000 * 1000;
    desc.info.origin_y_mm = 4998000 * INT64_C(1000);
    uint8_t *made = pack_fixture_make(&desc, &bytes);
    assert_int_equal(ff_pack_open(pack, made, bytes), FF_OK);
    return made;
}

static void ground_under_another_has_no_contours(void **state)
{
    (void)state;
    client_rig rig;
    ff_pack coarse;
    uint8_t *bytes = open_coarse(&coarse);
    const ff_source_desc more = { .pack = &coarse };
    unsigned wrong = 0, lines = 0;
    rig_open(&rig, 0);
    rig_use_place(&rig, 32632, 500000, 5000000);
    begin_map(&rig, &more);
    assert_int_equal(ff_client_source_state(rig.client, 1), FF_OK);
    uint32_t *without = picture(&rig, 0);
    int32_t *height_wu = heights(&rig);
    uint32_t *with = picture(&rig, 50 * METRE);
    for (int y = 1; y < HEIGHT - 1; y++)
        for (int x = 1; x < WIDTH - 1; x++) {
            int changed = with[y * WIDTH + x] != without[y * WIDTH + x];
            lines += changed;
            wrong += changed && !may_be(height_wu, x, y, 50 * METRE);
        }
    assert_true(lines > 1000);
    assert_true(wrong * 100 <= lines);
    free(without);
    free(with);
    free(height_wu);
    rig_close(&rig);
    free(bytes);
}

static void the_viewer_is_a_point(void **state)
{
    (void)state;
    client_rig rig;
    open_map(&rig);
    ff_map_show show = { .has_place = 1, .place_wu = { 2100 * METRE, 2050 * METRE, 0 } };
    enum c3d_texture_format format;
    assert_true(
        ff_client_ground(rig.client, show.place_wu[0], show.place_wu[1], &show.place_wu[2]));
    assert_int_equal(ff_client_set_map(rig.client, &show), FF_OK);
    ff_client_draw(rig.client);
    const uint32_t *pixels = c3d_frame_pixels(ff_client_device(rig.client), &format);
    assert_int_equal(pixels[(HEIGHT / 2 - 5) * WIDTH + WIDTH / 2 + 10], 0xFF2020F0u);
    rig_close(&rig);
}

static void who_has_no_map_pays_nothing(void **state)
{
    (void)state;
    client_rig rig;
    const ff_map_show show = { .contour_wu = 10 * METRE };
    ff_map_show fine = { .contour_wu = FF_CONTOUR_WU_MIN - 1 };
    open_map(&rig);
    assert_int_equal(ff_client_set_map(rig.client, &fine), FF_ERR_ARGUMENT);
    rig_close(&rig);
    ff_pool_use with[FF_POOLS_MAX], without[FF_POOLS_MAX];
    rig_open(&rig, 0);
    rig.desc.backend = c3d_backend_soft();
    rig.desc.surface_api = sys_surface_memory();
    rig_local_client(&rig, 4 * MB);
    assert_int_equal(ff_client_set_map(rig.client, &show), FF_ERR_UNSUPPORTED);
    ff_client_desc desc = rig.desc;
    desc.memory_bytes = 4 * MB;
    int pools = ff_client_plan(&desc, ff_client_terrain(rig.client), without);
    desc.use_map = 1;
    assert_int_equal(ff_client_plan(&desc, ff_client_terrain(rig.client), with), pools);
    for (int i = 0; i < pools; i++)
        if (!strcmp(with[i].name, "contours")) {
            assert_int_equal(without[i].bytes, 0);
            assert_int_equal(with[i].bytes, FF_CONTOUR_INDICES * sizeof(c3d_vertex));
        }
    rig_close(&rig);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_map_looks_straight_down),
        cmocka_unit_test(a_flight_is_a_view_of_what_it_looks_at),
        cmocka_unit_test(the_way_to_a_flight_has_no_jump),
        cmocka_unit_test(contours_and_bars_are_round),
        cmocka_unit_test(contours_lie_where_the_ground_has_their_height),
        cmocka_unit_test(contours_are_those_of_their_interval),
        cmocka_unit_test(ground_under_another_has_no_contours),
        cmocka_unit_test(the_viewer_is_a_point),
        cmocka_unit_test(who_has_no_map_pays_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
