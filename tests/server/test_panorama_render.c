/* Panorama faces show ground where ground must be and nothing where there is none, the same on both
 * kinds of GL. */
#include "../rig/pack_fixture.h"
#include "../../protocol/picture/ff_paint.h"
#include "../../platform/sys.h"
#include "../../server/ground/ff_pack_ground.h"
#include "../../server/panorama/ff_face_image.h"
#include "../../server/panorama/ff_face_view.h"
#include "../../server/panorama/ff_panorama_render.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SIZE  128
#define METRE FF_WU_PER_METRE

static uint8_t *hills_bytes, *wall_bytes, *images_bytes;
static ff_pack hills, wall, images;
static ff_panorama_renderer *renderer; /* draws hills */
static uint8_t message_bytes[FF_MESSAGE_BODY_MAX + FF_MESSAGE_HEADER_MAX];

/* Flat ground with a wall of 1000 steps along the northern rim of 2 by 2 tiles of 64 cells. */
static uint16_t wall_height(void *context, uint32_t x, uint32_t y)
{
    (void)context;
    (void)x;
    return y >= 88 ? 1000 : 100;
}

/* West half red, east half green; blue in the north. */
static void quarters_colour(void *context, int64_t x_wu, int64_t y_wu, uint8_t rgb[3])
{
    (void)context;
    int west = x_wu < (int64_t)64 * 32 * METRE;
    rgb[0] = west ? 220 : 20;
    rgb[1] = west ? 20 : 200;
    rgb[2] = y_wu < (int64_t)64 * 32 * METRE ? 20 : 210;
}

static uint8_t *make_pack(ff_pack *pack, pack_fixture_desc desc)
{
    size_t size;
    uint8_t *bytes = pack_fixture_make(&desc, &size);
    return bytes && ff_pack_open(pack, bytes, size) == FF_OK ? bytes : NULL;
}

static int setup(void **state)
{
    (void)state;
    pack_fixture_desc images_desc = { .info = pack_fixture_info(6, 2, 2),
                                      .height = wall_height,
                                      .colour = quarters_colour };
    images_desc.info.texture_log2 = 5;
    images_desc.info.texture_levels = 3;
    hills_bytes = make_pack(&hills, (pack_fixture_desc){ .info = pack_fixture_info(6, 2, 2),
                                                         .height = pack_fixture_hills });
    wall_bytes = make_pack(
        &wall, (pack_fixture_desc){ .info = pack_fixture_info(6, 2, 2), .height = wall_height });
    images_bytes = make_pack(&images, images_desc);
    return !hills_bytes || !wall_bytes || !images_bytes ||
           ff_panorama_renderer_open(&hills, sys_surface_osmesa(), c3d_backend_gl(), &renderer) !=
               FF_OK;
}

static int teardown(void **state)
{
    (void)state;
    ff_panorama_renderer_close(renderer);
    free(hills_bytes);
    free(wall_bytes);
    free(images_bytes);
    return 0;
}

/* In the middle of the terrain, 2048 m east and north of its corner. */
static ff_get_panorama request_at(int32_t z_m, int32_t front_m, int32_t back_m)
{
    return (ff_get_panorama){ .id = 9,
                              .position_wu = { 2048 * METRE, 2048 * METRE, z_m * METRE },
                              .front_wu = front_m * METRE,
                              .back_wu = back_m * METRE,
                              .face_size = SIZE,
                              .quality = 90,
                              .face_count = 6,
                              .face = { 0, 1, 2, 3, 4, 5 } };
}

typedef struct face_picture {
    ff_face face;
    uint16_t top[SIZE], bottom[SIZE];
    uint8_t rgb[SIZE * SIZE * 3]; /* rows of the face's image */
    uint8_t laid[SIZE * SIZE];    /* whether they have come */
    int bytes;
} face_picture;

static void keep_block(void *context, unsigned column, unsigned row, uint8_t rgb[64][3])
{
    face_picture *to = context;
    for (unsigned i = 0; i < 64; i++) {
        unsigned x = column * 8 + i % 8, y = row * 8 + i / 8;
        if (y >= to->face.row_count) continue;
        memcpy(to->rgb + 3 * (SIZE * y + x), rgb[i], 3);
        to->laid[SIZE * y + x] = 1;
    }
}

static uint64_t room[4096];

static void render_with(ff_panorama_renderer *with, const ff_get_panorama *request,
                        enum ff_face_name name, face_picture *out)
{
    ff_message message;
    memset(out, 0, sizeof *out);
    out->bytes = ff_panorama_render_face(with, request, (uint8_t)name, name == FF_FACE_DOWN,
                                         message_bytes, sizeof message_bytes);
    assert_true(out->bytes > 0);
    assert_int_equal(ff_message_decode(message_bytes, (size_t)out->bytes, &message), out->bytes);
    assert_int_equal(message.type, FF_MSG_ANSWER);
    assert_int_equal(message.kind, FF_KIND_FACE);
    out->face = message.u.face;
    assert_int_equal(out->face.id, 9);
    assert_int_equal(out->face.face, name);
    assert_int_equal((out->face.flags & FF_FACE_LAST) != 0, name == FF_FACE_DOWN);
    if (out->face.flags & FF_FACE_EMPTY) return;
    assert_int_equal(ff_face_columns_decode(out->face.columns, out->face.columns_bytes, SIZE,
                                            out->face.row_count, out->top, out->bottom),
                     FF_OK);
    const ff_paint_sink sink = { out, keep_block };
    assert_true(ff_paint_decode(out->face.image, out->face.image_bytes, SIZE / 8,
                                ff_face_blocks(out->face.row_count), (ff_paint_room *)(void *)room,
                                &sink) > 0);
    for (unsigned i = 0; i < SIZE * out->face.row_count; i++)
        if (i / SIZE >= out->top[i % SIZE] && i / SIZE < out->bottom[i % SIZE])
            assert_true(out->laid[i]);
}

static int is_empty(const face_picture *picture)
{
    return (picture->face.flags & FF_FACE_EMPTY) != 0;
}

/* Row in the whole face where ground of height z_m above sea begins at `depth_m`. */
static int row_of(const ff_get_panorama *request, int32_t z_m, int32_t depth_m)
{
    return SIZE / 2 - (z_m - request->position_wu[2] / METRE) * (SIZE / 2) / depth_m;
}

static face_picture picture, other;

static void wall_stands_where_geometry_says(void **state)
{
    (void)state;
    ff_panorama_renderer *with;
    ff_get_panorama request = request_at(400, 400, 100000);
    assert_int_equal(
        ff_panorama_renderer_open(&wall, sys_surface_osmesa(), c3d_backend_gl(), &with), FF_OK);
    render_with(with, &request, FF_FACE_NORTH, &picture);
    assert_false(is_empty(&picture));
    /* The wall's foot is 87 cells north of the rim: 23 cells of 32 m ahead, its upper edge one cell
     * further. */
    int top = row_of(&request, 1000, (88 - 64) * 32);
    for (int c = 8; c < SIZE - 8; c++)
        assert_in_range(picture.face.top_row + picture.top[c], top - 1, top + 1);
    /* Ground continues down to the near plane, 350 m away and 300 m below. */
    int bottom = row_of(&request, 100, 350);
    for (int c = 8; c < SIZE - 8; c++)
        assert_in_range(picture.face.top_row + picture.bottom[c], bottom - 1, bottom + 2);
    /* The other sides are flat: nothing above the horizon, rows only below it. */
    render_with(with, &request, FF_FACE_SOUTH, &picture);
    assert_false(is_empty(&picture));
    assert_in_range(picture.face.top_row, row_of(&request, 100, 2048) - 1,
                    row_of(&request, 100, 2048) + 1);
    ff_panorama_renderer_close(with);
}

static void side_faces_show_the_wall_where_it_is_north(void **state)
{
    (void)state;
    ff_panorama_renderer *with;
    ff_get_panorama request = request_at(200, 400, 100000);
    assert_int_equal(
        ff_panorama_renderer_open(&wall, sys_surface_osmesa(), c3d_backend_gl(), &with), FF_OK);
    /* Looking east, north is to the left; looking west, to the right. */
    render_with(with, &request, FF_FACE_EAST, &picture);
    assert_true(picture.face.top_row + picture.top[2] < SIZE / 2);
    assert_true(picture.face.top_row + picture.top[SIZE - 3] > SIZE / 2);
    render_with(with, &request, FF_FACE_WEST, &picture);
    assert_true(picture.face.top_row + picture.top[2] > SIZE / 2);
    assert_true(picture.face.top_row + picture.top[SIZE - 3] < SIZE / 2);
    ff_panorama_renderer_close(with);
}

static void down_face_has_north_at_its_top(void **state)
{
    (void)state;
    ff_panorama_renderer *with;
    ff_get_panorama request = request_at(6000, 400, 100000);
    assert_int_equal(
        ff_panorama_renderer_open(&images, sys_surface_osmesa(), c3d_backend_gl(), &with), FF_OK);
    render_with(with, &request, FF_FACE_DOWN, &picture);
    assert_false(is_empty(&picture));
    /* The terrain's 4 km square is seen from 5.9 km above, the wall in the north from 5 km: being
     * closer, it reaches further out in the picture. */
    int top = SIZE / 2 - 2048 * (SIZE / 2) / 5000, bottom = SIZE / 2 + 2048 * (SIZE / 2) / 5900;
    assert_in_range(picture.face.top_row, top - 1, top + 1);
    assert_in_range(picture.face.top_row + picture.face.row_count, bottom - 1, bottom + 1);
    /* West is left, and red; east green; north is up, and blue. */
    for (int quarter = 0; quarter < 4; quarter++) {
        int west = quarter & 1, north = quarter >> 1;
        int row = SIZE / 2 + (north ? -7 : 7) - picture.face.top_row,
            column = SIZE / 2 + (west ? -9 : 9);
        const uint8_t *pixel = picture.rgb + 3 * (SIZE * row + column);
        assert_true(west ? pixel[0] > 150 && pixel[1] < 90 : pixel[0] < 90 && pixel[1] > 130);
        assert_true(north ? pixel[2] > 150 : pixel[2] < 90);
    }
    ff_panorama_renderer_close(with);
}

static void faces_without_far_ground_are_empty(void **state)
{
    (void)state;
    ff_panorama_render_stats before, after;
    ff_get_panorama request = request_at(2000, 400, 100000);
    ff_panorama_renderer_get_stats(renderer, &before);
    render_with(renderer, &request, FF_FACE_UP, &picture);
    assert_true(is_empty(&picture));
    assert_true(picture.bytes < 16);
    request.position_wu[1] = 4096 * METRE - 10; /* nothing north of here */
    render_with(renderer, &request, FF_FACE_NORTH, &picture);
    assert_true(is_empty(&picture));
    request.front_wu = 90000 * METRE; /* all ground is near */
    render_with(renderer, &request, FF_FACE_SOUTH, &picture);
    assert_true(is_empty(&picture));
    ff_panorama_renderer_get_stats(renderer, &after);
    assert_int_equal(after.empty_by_bounds - before.empty_by_bounds, 3);
    assert_int_equal(after.empty_drawn, before.empty_drawn);
    assert_int_equal(after.ground.nodes_drawn, before.ground.nodes_drawn);
}

static void the_back_plane_cuts(void **state)
{
    (void)state;
    ff_get_panorama near_back = request_at(1800, 400, 1200),
                    far_back = request_at(1800, 400, 100000);
    render_with(renderer, &near_back, FF_FACE_EAST, &picture);
    render_with(renderer, &far_back, FF_FACE_EAST, &other);
    assert_true(is_empty(&picture) || picture.face.top_row > other.face.top_row);
}

static void absurd_requests_are_refused(void **state)
{
    (void)state;
    ff_get_panorama request = request_at(100, 400, 1000);
    assert_int_equal(ff_panorama_render_face(renderer, &request, FF_FACE_COUNT, 0, message_bytes,
                                             sizeof message_bytes),
                     FF_ERR_RANGE);
    request.face_size = FF_FACE_SIZE_MAX + 1;
    assert_int_equal(
        ff_panorama_render_face(renderer, &request, 0, 0, message_bytes, sizeof message_bytes),
        FF_ERR_RANGE);
    request = request_at(100, 1000, 1000);
    assert_int_equal(
        ff_panorama_render_face(renderer, &request, 0, 0, message_bytes, sizeof message_bytes),
        FF_ERR_RANGE);
    request = request_at(100, 400, 100000);
    assert_int_equal(ff_panorama_render_face(renderer, &request, 0, 0, message_bytes, 40),
                     FF_ERR_FULL);
    int32_t extremes[] = { INT32_MIN, INT32_MAX };
    for (int i = 0; i < 8; i++) {
        for (int axis = 0; axis < 3; axis++) request.position_wu[axis] = extremes[i >> axis & 1];
        request.front_wu = i & 1 ? 8 : INT32_MAX - 1;
        request.back_wu = INT32_MAX;
        for (uint8_t face = 0; face < FF_FACE_COUNT; face++)
            assert_true(ff_panorama_render_face(renderer, &request, face, 0, message_bytes,
                                                sizeof message_bytes) > 0);
    }
}

/* A face shows the same ground whatever was drawn before; colours may differ a little where a
 * node's neighbour is held now and was not held then. */
static void same_ground_whatever_was_drawn_before(void **state)
{
    (void)state;
    ff_get_panorama request = request_at(1800, 400, 100000), elsewhere = request;
    uint32_t off = 0;
    render_with(renderer, &request, FF_FACE_WEST, &picture);
    elsewhere.position_wu[0] /= 2;
    elsewhere.front_wu /= 4;
    render_with(renderer, &elsewhere, FF_FACE_WEST, &other);
    elsewhere.face_size = 512; /* another surface; all nodes are read again, in another order */
    assert_true(ff_panorama_render_face(renderer, &elsewhere, FF_FACE_EAST, 0, message_bytes,
                                        sizeof message_bytes) > 0);
    render_with(renderer, &request, FF_FACE_WEST, &other);
    assert_int_equal(picture.face.top_row, other.face.top_row);
    assert_int_equal(picture.face.row_count, other.face.row_count);
    assert_memory_equal(picture.top, other.top, sizeof picture.top);
    assert_memory_equal(picture.bottom, other.bottom, sizeof picture.bottom);
    for (size_t i = 0; i < (size_t)3 * SIZE * picture.face.row_count; i++)
        off += abs(picture.rgb[i] - other.rgb[i]) > 48;
    assert_true(off < SIZE);
}

/* The same requests in the same order give the same bytes: the simulator relies on it. */
static void same_requests_same_bytes(void **state)
{
    (void)state;
    static uint8_t first[2][sizeof message_bytes];
    int bytes[2][2];
    for (int round = 0; round < 2; round++) {
        ff_panorama_renderer *with;
        ff_get_panorama request = request_at(1800, 400, 100000);
        assert_int_equal(
            ff_panorama_renderer_open(&hills, sys_surface_osmesa(), c3d_backend_gl(), &with),
            FF_OK);
        for (int i = 0; i < 2; i++) {
            bytes[round][i] = ff_panorama_render_face(with, &request, FF_FACE_WEST, 0,
                                                      message_bytes, sizeof message_bytes);
            assert_true(bytes[round][i] > 0);
            if (round == 0) memcpy(first[i], message_bytes, (size_t)bytes[0][i]);
            assert_int_equal(bytes[round][i], bytes[0][i]);
            assert_memory_equal(message_bytes, first[i], (size_t)bytes[0][i]);
            request.position_wu[0] /= 2;
        }
        ff_panorama_renderer_close(with);
    }
}

/* All nodes of a panorama's faces are drawn in one frame of coordinates. The panorama's own
 * position chooses it, not that of a panorama drawn close by before. */
static void frame_is_the_position_s(void **state)
{
    (void)state;
    static ff_pack_ground ground;
    ff_pack_ground_stats stats = { .nodes_read = 0 };
    sys_surface *surface;
    sys_surface_desc surface_desc = { "test", SIZE, SIZE, SYS_GL_DESKTOP };
    c3d_desc device_desc;
    c3d_device *device;
    assert_int_equal(sys_surface_osmesa()->open(&surface_desc, &surface), FF_OK);
    ff_pack_ground_desc(&hills, sys_surface_osmesa(), &device_desc);
    size_t bytes = c3d_bytes(c3d_backend_gl(), &device_desc);
    void *memory = malloc(bytes);
    assert_int_equal(c3d_open(c3d_backend_gl(), &device_desc, memory, bytes, &device), FF_OK);
    assert_int_equal(ff_pack_ground_open(&ground, &hills, device, &stats), FF_OK);
    ff_get_panorama request = request_at(1800, 400, 100000);
    for (int i = 0; i < 5; i++) {
        for (enum ff_face_name face = FF_FACE_NORTH; face <= FF_FACE_WEST; face++) {
            ff_ground_look look = { .frame = ff_shape_frame(&hills.header.info,
                                                            request.position_wu),
                                    .view_wu = request.back_wu,
                                    .error_px_q8 = 256 };
            ff_face_camera(&request, face, &look.camera);
            ff_pack_ground_load(&ground, &look);
            ff_pack_ground_draw(&ground, &look);
        }
        for (int axis = 0; axis < 2; axis++) {
            int32_t away_wu = request.position_wu[axis] - ground.view.frame.origin_wu[axis];
            assert_in_range(away_wu, 0, hills.header.info.spacing_wu - 1);
            request.position_wu[axis] += 77 * METRE;
        }
    }
    assert_true(stats.nodes_drawn > 0);
    ff_pack_ground_close(&ground);
    c3d_close(device);
    sys_surface_osmesa()->close(surface);
    free(memory);
}

static void largest_face_at_best_quality_fits_a_message(void **state)
{
    (void)state;
    ff_get_panorama request = request_at(1200, 300, 100000);
    request.face_size = FF_FACE_SIZE_MAX;
    request.quality = 100;
    int bytes = ff_panorama_render_face(renderer, &request, FF_FACE_EAST, 0, message_bytes,
                                        sizeof message_bytes);
    assert_true(bytes > 10000);
}

static void compare_kinds(const struct c3d_backend *backend)
{
    ff_panorama_renderer *egl;
    ff_get_panorama request = request_at(1800, 400, 100000);
    int rc = ff_panorama_renderer_open(&hills, sys_surface_egl(), backend, &egl);
    if (rc < 0) {
        print_message("# skip: EGL: %s\n", ff_error_text(rc));
        skip();
    }
    for (int name = 0; name < FF_FACE_COUNT; name++) {
        render_with(renderer, &request, (enum ff_face_name)name, &picture);
        render_with(egl, &request, (enum ff_face_name)name, &other);
        assert_int_equal(is_empty(&picture), is_empty(&other));
        uint32_t off = 0;
        for (int c = 0; c < SIZE; c++)
            off += (uint32_t)abs((picture.face.top_row + picture.top[c]) -
                                 (other.face.top_row + other.top[c]));
        assert_true(off <= SIZE / 16); /* edges fall on the same pixels, with few exceptions */
    }
    ff_panorama_renderer_close(egl);
}

static void egl_agrees_with_osmesa(void **state)
{
    (void)state;
    compare_kinds(c3d_backend_gl());
}

static void gles1_agrees_with_osmesa(void **state)
{
    (void)state;
    compare_kinds(c3d_backend_gles1());
}

/* ---- pictures as pixels ---- */

static void fill_continues_ground(void **state)
{
    (void)state;
    enum { S = 4 };
    static const uint8_t key[3] = { 255, 0, 255 }, ground[3] = { 10, 20, 30 },
                         low[3] = { 50, 60, 70 };
    uint8_t rgb[S * S * 3];
    ff_face_spans spans;
    for (int i = 0; i < S * S; i++) memcpy(rgb + 3 * i, key, 3);
    memcpy(rgb + 3 * (1 * S + 2), ground, 3); /* column 2: row 1, a hole, row 3 */
    memcpy(rgb + 3 * (3 * S + 2), low, 3);
    memcpy(rgb + 3 * (2 * S + 3), low, 3); /* column 3: row 2 */
    ff_face_find_spans(rgb, S, &spans);
    assert_int_equal(spans.top_row, 1);
    assert_int_equal(spans.row_count, 3);
    assert_int_equal(spans.top[2], 0);
    assert_int_equal(spans.bottom[2], 3);
    assert_int_equal(spans.top[3], 1);
    assert_int_equal(spans.bottom[3], 2);
    assert_int_equal(spans.bottom[0], 0);
    ff_face_fill(rgb, S, &spans);
    assert_memory_equal(rgb + 3 * (2 * S + 2), ground, 3);
    assert_memory_equal(rgb + 3 * (1 * S + 3), low, 3);
    assert_memory_equal(rgb + 3 * (3 * S + 3), low, 3);
    assert_memory_equal(rgb + 3 * (3 * S + 0), low, 3); /* turned sideways: as column 2 */
    assert_memory_equal(rgb, key, 3);                   /* above the rows nothing matters */
}

static void spans_are_lowered_by_a_pixel(void **state)
{
    (void)state;
    static ff_face_spans spans;
    spans = (ff_face_spans){
        .top_row = 3, .row_count = 4, .top = { 0, 1, 0, 0, 2 }, .bottom = { 4, 2, 0, 0, 3 }
    };
    ff_face_lower(&spans, 8);
    static const uint16_t lowered[] = { 5, 5, 0, 0, 4, 0 };
    assert_memory_equal(spans.bottom, lowered, sizeof lowered);
    assert_int_equal(spans.row_count, 5);
    spans = (ff_face_spans){ .top_row = 4, .row_count = 4, .top = { 0, 1 }, .bottom = { 4, 2 } };
    ff_face_lower(&spans, 8); /* the face ends there */
    assert_int_equal(spans.bottom[0], 4);
    assert_int_equal(spans.row_count, 4);
}

static void boxes_are_seen_by_their_faces(void **state)
{
    (void)state;
    ff_get_panorama request = { .front_wu = 800, .back_wu = 10000 }; /* near plane 700 */
    ff_box box = { { -50, 600, -50 }, { 50, 699, 50 } };
    assert_false(ff_face_sees_box(&request, FF_FACE_NORTH, &box));
    box.hi[1] = 700;
    assert_true(ff_face_sees_box(&request, FF_FACE_NORTH, &box));
    assert_false(ff_face_sees_box(&request, FF_FACE_SOUTH, &box));
    assert_false(ff_face_sees_box(&request, FF_FACE_EAST, &box));
    box.lo[0] = 5000; /* north-east, beside the diagonal */
    box.hi[0] = 6000;
    box.lo[1] = box.hi[1] = 4999;
    assert_false(ff_face_sees_box(&request, FF_FACE_NORTH, &box));
    assert_true(ff_face_sees_box(&request, FF_FACE_EAST, &box));
    box.hi[1] = 5000;
    assert_true(ff_face_sees_box(&request, FF_FACE_NORTH, &box));
    box.lo[1] = 10001; /* beyond the back plane */
    box.hi[1] = 20000;
    assert_false(ff_face_sees_box(&request, FF_FACE_NORTH, &box));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wall_stands_where_geometry_says),
        cmocka_unit_test(side_faces_show_the_wall_where_it_is_north),
        cmocka_unit_test(down_face_has_north_at_its_top),
        cmocka_unit_test(faces_without_far_ground_are_empty),
        cmocka_unit_test(the_back_plane_cuts),
        cmocka_unit_test(absurd_requests_are_refused),
        cmocka_unit_test(same_ground_whatever_was_drawn_before),
        cmocka_unit_test(same_requests_same_bytes),
        cmocka_unit_test(frame_is_the_position_s),
        cmocka_unit_test(largest_face_at_best_quality_fits_a_message),
        cmocka_unit_test(egl_agrees_with_osmesa),
        cmocka_unit_test(gles1_agrees_with_osmesa),
        cmocka_unit_test(fill_continues_ground),
        cmocka_unit_test(spans_are_lowered_by_a_pixel),
        cmocka_unit_test(boxes_are_seen_by_their_faces),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
