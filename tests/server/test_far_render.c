/* Sectors of far sets: outlines stand where rays find them, nothing that nobody sees travels, paint
 * lies where the ground is, the same bytes every time. */
#include "../rig/far_rays.h"
#include "../rig/pack_fixture.h"
#include "../../protocol/shape/ff_shape.h"
#include "../../server/far/ff_far_fill.h"
#include "../../server/far/ff_far_render.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define METRE   FF_WU_PER_METRE
#define CELL_M  128 /* 257 samples a side: 32768 m */
#define FOCAL   200
#define FRONT_M 4000

static uint8_t bytes_of_message[FF_MESSAGE_BODY_MAX + FF_MESSAGE_HEADER_MAX];

/* ---- grounds ---- */

/* Rises to `top` on a line from west to east at sample `middle`, falls to both sides. */
static double ridge(uint32_t y, double middle, double half, double top)
{
    double away = fabs(y - middle) / half;
    return away < 1 ? top * (1 - away) : 0;
}

/* Two ridges that go up and down: 8 km and 16 km north of sample 80. */
static uint16_t ridges_height(void *context, uint32_t x, uint32_t y)
{
    (void)context;
    double near = ridge(y, 142, 10, 500 + 200 * sin(x / 4.0)),
           far = ridge(y, 205, 16, 1300 + 300 * sin(x / 3.0 + 1));
    return (uint16_t)(100 + (near > far ? near : far));
}

/* Plain ground, a wall 8 km north of sample 80, and plain ground beyond. */
static uint16_t wall_height(void *context, uint32_t x, uint32_t y)
{
    (void)context;
    (void)x;
    return y >= 142 && y <= 144 ? 700 : 100;
}

static uint16_t plain_height(void *context, uint32_t x, uint32_t y)
{
    (void)context;
    (void)x;
    (void)y;
    return 100;
}

/* West red, east green; blue north of 16 km. */
static void quarters_colour(void *context, int64_t x_wu, int64_t y_wu, uint8_t rgb[3])
{
    (void)context;
    int west = x_wu < (int64_t)16384 * METRE;
    rgb[0] = west ? 220 : 20;
    rgb[1] = west ? 20 : 200;
    rgb[2] = y_wu < (int64_t)16384 * METRE ? 20 : 210;
}

typedef struct far_rig {
    uint8_t *bytes;
    ff_pack pack;
    ff_far_renderer *renderer;
    ff_message message;
    int message_bytes;
    ff_fin_vertex vertex[FF_FAR_VERTICES_MAX];
    int vertices;
    ff_far_render_stats stats; /* of the last sector alone: texels */
} far_rig;

static far_rig rig;

static void open_rig(far_height *height, int coloured, uint32_t curve_q60)
{
    size_t size;
    pack_fixture_desc desc = { .info = pack_fixture_info(7, 2, 2), .height = height };
    desc.info.spacing_wu = CELL_M * METRE;
    desc.info.curve_q60 = curve_q60;
    if (coloured) {
        desc.colour = quarters_colour;
        desc.info.texture_log2 = 5;
        desc.info.texture_levels = 3;
    }
    memset(&rig, 0, sizeof rig);
    rig.bytes = pack_fixture_make(&desc, &size);
    assert_non_null(rig.bytes);
    assert_int_equal(ff_pack_open(&rig.pack, rig.bytes, size), FF_OK);
    assert_int_equal(ff_far_renderer_open(&rig.pack, &rig.renderer), FF_OK);
}

static void close_rig(void)
{
    ff_far_renderer_close(rig.renderer);
    free(rig.bytes);
}

/* In the middle, 10240 m north of the southern edge. The region is a narrow one about O. */
static ff_get_far request_at(int32_t z_m)
{
    return (ff_get_far){ .id = 7,
                         .position_wu = { 16384 * METRE, 10240 * METRE, z_m * METRE },
                         .front_wu = FRONT_M * METRE,
                         .behind_m = 50,
                         .ahead_m = 50,
                         .aside_m = 50,
                         .focal = FOCAL,
                         .down = FOCAL,
                         .quality = 90,
                         .tolerance_q2 = 4,
                         .sector_count = 1 };
}

static void render_last(const ff_get_far *request, uint8_t sector, int last)
{
    ff_far_render_stats before;
    ff_far_renderer_get_stats(rig.renderer, &before);
    rig.message_bytes = ff_far_render_sector(rig.renderer, request, sector, last, bytes_of_message,
                                             sizeof bytes_of_message);
    assert_true(rig.message_bytes > 0);
    ff_far_renderer_get_stats(rig.renderer, &rig.stats);
    rig.stats.texels -= before.texels;
    rig.stats.texels_seen -= before.texels_seen;
    assert_int_equal(ff_message_decode(bytes_of_message, (size_t)rig.message_bytes, &rig.message),
                     rig.message_bytes);
    assert_int_equal(rig.message.type, FF_MSG_ANSWER);
    assert_int_equal(rig.message.kind, FF_KIND_FAR);
    const ff_far *far = &rig.message.u.far;
    assert_int_equal(far->sector, sector);
    assert_int_equal((far->flags & FF_FACE_LAST) != 0, last);
    rig.vertices = far->fins_bytes
                       ? ff_fins_decode(far->fins, far->fins_bytes, rig.vertex, FF_FAR_VERTICES_MAX)
                       : 0;
    assert_true(rig.vertices >= 0);
}

static void render(const ff_get_far *request, uint8_t sector) { render_last(request, sector, 0); }

static int is_empty(void) { return (rig.message.u.far.flags & FF_FACE_EMPTY) != 0; }

/* ---- outlines ---- */

/* A fin's height in a column, 1; or 0 where it is not. */
static int fin_at(int segment, int column, double *up, double *distance_m)
{
    const ff_fin_vertex *a = &rig.vertex[segment - 1], *b = &rig.vertex[segment];
    if (b->begins || column < a->column || column > b->column) return 0;
    double part = (double)(column - a->column) / (b->column - a->column),
           near_a = 1.0 / ff_far_distance_wu(a->distance),
           near_b = 1.0 / ff_far_distance_wu(b->distance);
    *up = (a->up_q2 + (b->up_q2 - a->up_q2) * part) / 4;
    *distance_m = 1 / (near_a + (near_b - near_a) * part) / METRE;
    return 1;
}

/* Every place of a fin lies on an outline, and the whole skyline is a fin: within `texels`. */
static void assert_fins_are_true(far_height *height, const ff_get_far *request, unsigned sector,
                                 double texels)
{
    int half = ff_far_half(FOCAL) - 2, covered = 0;
    for (int column = -half; column <= half; column++) {
        far_true_outline outline[FAR_TRUE_OUTLINES];
        unsigned count = far_march(&rig.pack.header.info, height, request, sector, column, outline);
        int skyline = 0;
        assert_true(count > 0);
        for (int i = 1; i < rig.vertices; i++) {
            double up, distance_m;
            if (!fin_at(i, column, &up, &distance_m)) continue;
            assert_true(far_off_outline(outline, count, up, distance_m) <= texels);
            skyline |= far_off_outline(&outline[count - 1], 1, up, distance_m) <= texels;
        }
        covered += skyline;
    }
    assert_true(covered >= 2 * half - 2);
}

static void fins_lie_on_the_outlines_that_rays_find(void **state)
{
    (void)state;
    static const uint8_t tolerances[] = { 2, 4 };
    open_rig(ridges_height, 0, 0);
    for (int i = 0; i < 2; i++) {
        ff_get_far request = request_at(900);
        request.tolerance_q2 = tolerances[i];
        for (uint8_t sector = 15; sector < 18; sector++) {
            render(&request, sector % FF_FAR_SECTORS);
            assert_true(rig.vertices > 10);
            assert_fins_are_true(ridges_height, &request, sector % FF_FAR_SECTORS,
                                 tolerances[i] / 4.0 + 0.9);
        }
    }
    close_rig();
}

static void coarse_fins_have_fewer_vertices(void **state)
{
    (void)state;
    ff_get_far request = request_at(900);
    open_rig(ridges_height, 0, 0);
    request.tolerance_q2 = 1;
    render(&request, 0);
    int fine = rig.vertices;
    request.tolerance_q2 = 12;
    render(&request, 0);
    assert_true(rig.vertices > 2 && rig.vertices < fine * 2 / 3);
    request.tolerance_q2 = 0;
    render(&request, 0);
    assert_int_equal(rig.vertices, 0);
    assert_true(rig.message.u.far.blocks_x > 0);
    close_rig();
}

/* From low above ground the near ridge has parts of the skyline, and longer fins. */
static void far_fins_come_first(void **state)
{
    (void)state;
    ff_get_far request = request_at(300);
    int last = INT32_MAX, fins = 0;
    open_rig(ridges_height, 0, 0);
    render(&request, 0);
    for (int i = 0; i < rig.vertices; fins++) {
        int nearest = INT32_MAX;
        do nearest = rig.vertex[i].distance < nearest ? rig.vertex[i].distance : nearest;
        while (++i < rig.vertices && !rig.vertex[i].begins);
        assert_true(nearest <= last);
        last = nearest;
    }
    assert_true(fins > 2);
    close_rig();
}

/* ---- the curved Earth ---- */

static void curved_ground_falls_away(void **state)
{
    (void)state;
    ff_get_far request = request_at(900);
    open_rig(ridges_height, 0, FF_CURVE_MAX);
    render(&request, 0);
    assert_fins_are_true(ridges_height, &request, 0, 1.9);
    close_rig();
}

/* A wall 2 km north of O, nearer than the front: who stands before it sees nothing. Seen from 6 km
 * ahead curved ground is tilted, which hides nothing of a plain. */
static uint16_t near_wall_height(void *context, uint32_t x, uint32_t y)
{
    (void)context;
    (void)x;
    return y == 95 ? 900 : 100;
}

static void nothing_of_a_curved_plain_is_hidden(void **state)
{
    (void)state;
    ff_get_far request = request_at(250);
    open_rig(near_wall_height, 0, FF_CURVE_MAX);
    request.low_m = request.high_m = -30;
    request.focal = 600;
    render(&request, 0);
    assert_true(rig.stats.texels > 4000);
    assert_true(rig.stats.texels_seen < rig.stats.texels / 4);
    request.ahead_m = 6000;
    render(&request, 0);
    assert_int_equal(rig.stats.texels_seen, rig.stats.texels);
    close_rig();
}

/* ---- what somebody sees ---- */

/* The first row of texels that shows this ground, counted from the horizon down. */
static int row_of(const ff_get_far *request, double z_m, double distance_m)
{
    return (int)floor(FOCAL * ((double)request->position_wu[2] / METRE - z_m) / distance_m);
}

/* O looks over the wall, the region lies in front of it and below its top: of what lies beyond
 * nothing travels, until the region's top rises. */
static void what_a_wall_hides_does_not_travel(void **state)
{
    (void)state;
    ff_get_far request = request_at(1500);
    int wall = row_of(&request, 700, 7936), width = 2 * ff_far_half(FOCAL) - 4;
    open_rig(wall_height, 0, 0);
    request.low_m = request.high_m = -1300;
    render(&request, 0);
    assert_true(rig.stats.texels >= (uint64_t)(width * (FOCAL / 4)));
    int rows = (int)(rig.stats.texels_seen / (uint64_t)width),
        all = (int)(rig.stats.texels / (uint64_t)width);
    int beyond = wall - row_of(&request, 100, 22400);
    assert_true(beyond >= 5);
    assert_true(rows <= all - beyond + 2); /* the wall's own row, and one of doubt */
    assert_true(rows >= all - beyond - 3);
    for (int i = 0; i < rig.vertices; i++)
        assert_true(ff_far_distance_wu(rig.vertex[i].distance) < 9000 * METRE);
    uint64_t low = rig.stats.texels_seen;
    request.high_m = -100;
    render(&request, 0);
    assert_true(rig.stats.texels_seen >= low + (uint64_t)(width * (beyond - 3)));
    close_rig();
}

static void eyes_under_ground_hide_nothing(void **state)
{
    (void)state;
    ff_get_far request = request_at(1500);
    open_rig(wall_height, 0, 0);
    request.low_m = request.high_m = -1450; /* 50 m above sea, under the plain */
    render(&request, 0);
    assert_true(rig.stats.texels > 0);
    assert_int_equal(rig.stats.texels_seen, rig.stats.texels);
    close_rig();
}

static void rows_that_nobody_looks_at_do_not_travel(void **state)
{
    (void)state;
    ff_get_far request = request_at(1500);
    open_rig(plain_height, 0, 0);
    request.down = 40;
    render(&request, 0);
    const ff_far *far = &rig.message.u.far;
    int bottom = far->blocks_y * FF_FAR_BLOCK - far->top;
    assert_true(bottom >= 40 && bottom < 41 + FF_FAR_BLOCK);
    close_rig();
}

static void a_sector_without_far_ground_is_empty(void **state)
{
    (void)state;
    ff_get_far request = request_at(900);
    open_rig(plain_height, 0, 0);
    request.position_wu[1] = 30000 * METRE; /* the ground ends 2768 m north of here */
    for (int last = 0; last < 2; last++) {
        render_last(&request, 0, last);
        assert_true(is_empty());
        assert_true(rig.message_bytes < 8);
    }
    render(&request, FF_FAR_SECTORS / 2);
    assert_false(is_empty());
    request.front_wu = 100000 * METRE; /* all ground is near */
    render(&request, FF_FAR_SECTORS / 2);
    assert_true(is_empty());
    close_rig();
}

/* In sectors between the axes the near plane alone would leave ground that is too near. */
static void ground_before_the_front_is_left_out(void **state)
{
    (void)state;
    ff_get_far request = request_at(1500);
    request.down = 2 * FOCAL;
    open_rig(plain_height, 0, 0);
    for (uint8_t sector = 0; sector < FF_FAR_SECTORS; sector++) {
        render(&request, sector);
        const ff_far *far = &rig.message.u.far;
        /* the hole's edge is as far along the axis at its nearest in all, farther in these */
        int end = row_of(&request, 100, FRONT_M * 0.875);
        if (sector % 4 != 2) assert_true(far->blocks_y * FF_FAR_BLOCK - far->top >= end);
        assert_true(far->blocks_y * FF_FAR_BLOCK - far->top <= end + FF_FAR_BLOCK);
        uint64_t rows = rig.stats.texels / (uint64_t)(2 * ff_far_half(FOCAL));
        assert_true(rows <= (uint64_t)end);
        uint64_t all = (uint64_t)(end - row_of(&request, 100, 22500));
        if (sector == 0) assert_in_range(rows, all - 2, all + 2);
        if (sector == 2) assert_true(rows < all - 8);
    }
    close_rig();
}

/* ---- paint ---- */

typedef struct looked_for {
    unsigned x, y, found;
    uint8_t *rgb;
} looked_for;

static void look_for(void *context, unsigned column, unsigned row, uint8_t rgb[64][3])
{
    looked_for *l = context;
    if (l->x / FF_FAR_BLOCK != column || l->y / FF_FAR_BLOCK != row) return;
    memcpy(l->rgb, rgb[l->y % FF_FAR_BLOCK * FF_FAR_BLOCK + l->x % FF_FAR_BLOCK], 3);
    l->found = 1;
}

/* The texel in a column and row of texels from the sector's middle and the horizon (down); 0 when
 * its block is not there. */
static int texel_at(int column, int row, uint8_t out[3])
{
    static uint64_t room[8192];
    const ff_far *far = &rig.message.u.far;
    int x = column + far->blocks_x * FF_FAR_BLOCK / 2, y = row + far->top;
    looked_for l = { (unsigned)x, (unsigned)y, 0, out };
    const ff_paint_sink sink = { &l, look_for };
    assert_in_range(x, 0, far->blocks_x * FF_FAR_BLOCK - 1);
    assert_in_range(y, 0, far->blocks_y * FF_FAR_BLOCK - 1);
    assert_true(ff_paint_decode(far->paint, far->paint_bytes, far->blocks_x, far->blocks_y,
                                (ff_paint_room *)(void *)room, &sink) > 0);
    return (int)l.found;
}

static void assert_colour(int column, int row, int red, int green, int blue)
{
    uint8_t rgb[3] = { 0, 0, 0 };
    assert_int_equal(texel_at(column, row, rgb), 1);
    assert_true(abs(rgb[0] - red) < 90 && abs(rgb[1] - green) < 90 && abs(rgb[2] - blue) < 90);
}

/* The first column from -20 on in which green is more than red. */
static int green_from(int row)
{
    uint8_t rgb[3] = { 0, 0, 0 };
    int column = -20;
    while (column < 20 && texel_at(column, row, rgb) && rgb[0] > rgb[1]) column++;
    return column;
}

/* The first row from `row` on that is no more blue than not. */
static int blue_until(int column, int row)
{
    uint8_t rgb[3] = { 0, 0, 0 };
    while (texel_at(column, row, rgb) && rgb[2] > 115) row++;
    return row;
}

/* The ground turns blue 6144 m north of O, which 1500 m above the plain is in row 48. */
static void paint_lies_where_the_ground_is(void **state)
{
    (void)state;
    open_rig(plain_height, 1, 0);
    for (uint8_t shift = 0; shift < 2; shift++) {
        ff_get_far request = request_at(1600);
        request.paint_shift = shift;
        render(&request, 0);
        int edge = row_of(&request, 100, 6144) >> shift, side = shift ? 17 : 30;
        assert_colour(-side, edge - 9, 220, 20, 210);
        assert_colour(side, edge - 9, 20, 200, 210);
        assert_colour(-side, edge + 9, 220, 20, 20);
        assert_colour(side, edge + 9, 20, 200, 20);
        assert_in_range(green_from(edge + 9) + 1, 0, 2);
        assert_in_range(blue_until(side, edge - 9), edge - 1, edge + 2);
        assert_int_equal(rig.message.u.far.blocks_x, ff_far_blocks_x(FOCAL >> shift));
    }
    close_rig();
}

/* In front of the skyline's lower parts blocks show sky: it has the ridge's colour. */
static void the_sky_is_painted_like_the_ridge(void **state)
{
    (void)state;
    ff_get_far request = request_at(900);
    int checked = 0;
    open_rig(ridges_height, 1, 0);
    render(&request, 0);
    int top = rig.message.u.far.top;
    for (int column = -36; column <= 36; column += 2) {
        far_true_outline outline[FAR_TRUE_OUTLINES];
        unsigned count = far_march(&rig.pack.header.info, ridges_height, &request, 0, column,
                                   outline);
        int above = top - (int)outline[count - 1].up;
        if (above < 4 || abs(column) < 10) continue;
        assert_colour(column, -top + above / 2, column < 0 ? 220 : 20, column < 0 ? 20 : 200, 210);
        checked++;
    }
    assert_true(checked > 5);
    close_rig();
}

static void without_quality_there_is_no_paint(void **state)
{
    (void)state;
    ff_get_far request = request_at(900);
    open_rig(ridges_height, 0, 0);
    request.quality = 0;
    render(&request, 0);
    assert_int_equal(rig.message.u.far.blocks_x, 0);
    assert_true(rig.vertices > 10);
    close_rig();
}

/* ---- fills ---- */

static void gaps_are_filled_with_what_is_round_them(void **state)
{
    (void)state;
    enum { WIDTH = 21, HEIGHT = 13 };
    ff_far_texel *texel = calloc(ff_far_fill_texels(WIDTH, HEIGHT), sizeof *texel);
    assert_non_null(texel);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            if (x < 4 || x >= 16)
                texel[y * WIDTH + x] =
                    (ff_far_texel){ { x < 4 ? 1000 : 9000, 50, (uint16_t)(y * 100) }, 256 };
    ff_far_fill(texel, WIDTH, HEIGHT);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            const ff_far_texel *at = &texel[y * WIDTH + x];
            assert_int_equal(at->rgb_q8[1], 50);
            assert_true(at->rgb_q8[0] >= 1000 && at->rgb_q8[0] <= 9000);
            if (x == 4) assert_true(at->rgb_q8[0] < 5000);
            if (x == 15) assert_true(at->rgb_q8[0] > 5000);
            if (x < 4 || x >= 16) assert_int_equal(at->rgb_q8[2], y * 100);
        }
    free(texel);
}

/* ---- the same bytes ---- */

static void bytes_do_not_depend_on_what_was_drawn_before(void **state)
{
    (void)state;
    static uint8_t first[sizeof bytes_of_message];
    ff_get_far request = request_at(900), other = request_at(1700);
    request.aside_m = request.ahead_m = 900;
    request.low_m = -300;
    open_rig(ridges_height, 0, 0);
    render(&request, 1);
    int bytes = rig.message_bytes;
    memcpy(first, bytes_of_message, (size_t)bytes);
    other.position_wu[0] -= 3000 * METRE;
    other.focal = 333;
    for (uint8_t sector = 0; sector < FF_FAR_SECTORS; sector++) render(&other, sector);
    for (uint8_t sector = 0; sector < FF_FAR_SECTORS; sector++) render(&request, sector);
    render(&request, 1);
    assert_int_equal(rig.message_bytes, bytes);
    assert_memory_equal(bytes_of_message, first, (size_t)bytes);
    close_rig();
}

/* ---- limits ---- */

static void the_largest_and_the_least_are_drawn(void **state)
{
    (void)state;
    open_rig(ridges_height, 0, 0);
    for (int i = 0; i < 4; i++) {
        ff_get_far request = request_at(2500);
        request.focal = i & 1 ? FF_FAR_FOCAL_MAX : FF_FAR_FOCAL_MIN;
        request.down = i & 1 ? 2 * FF_FAR_FOCAL_MAX : 1;
        request.quality = 100;
        request.tolerance_q2 = 1;
        request.paint_shift = i & 2 ? 3 : 0;
        request.aside_m = request.ahead_m = request.behind_m = 0;
        render(&request, 0);
        assert_false(is_empty());
    }
    close_rig();
}

static void nonsense_is_refused(void **state)
{
    (void)state;
    open_rig(plain_height, 0, 0);
    ff_get_far good = request_at(900), bad[5] = { good, good, good, good, good };
    bad[0].focal = FF_FAR_FOCAL_MIN - 1;
    bad[1].focal = FF_FAR_FOCAL_MAX + 1;
    bad[2].down = 0;
    bad[3].low_m = 5, bad[3].high_m = 4;
    bad[4].front_wu = 0;
    for (int i = 0; i < 5; i++)
        assert_int_equal(ff_far_render_sector(rig.renderer, &bad[i], 0, 0, bytes_of_message,
                                              sizeof bytes_of_message),
                         FF_ERR_RANGE);
    assert_int_equal(ff_far_render_sector(rig.renderer, &good, FF_FAR_SECTORS, 0, bytes_of_message,
                                          sizeof bytes_of_message),
                     FF_ERR_RANGE);
    assert_int_equal(ff_far_render_sector(rig.renderer, &good, 0, 0, bytes_of_message, 20),
                     FF_ERR_FULL);
    close_rig();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fins_lie_on_the_outlines_that_rays_find),
        cmocka_unit_test(coarse_fins_have_fewer_vertices),
        cmocka_unit_test(far_fins_come_first),
        cmocka_unit_test(curved_ground_falls_away),
        cmocka_unit_test(nothing_of_a_curved_plain_is_hidden),
        cmocka_unit_test(what_a_wall_hides_does_not_travel),
        cmocka_unit_test(eyes_under_ground_hide_nothing),
        cmocka_unit_test(rows_that_nobody_looks_at_do_not_travel),
        cmocka_unit_test(a_sector_without_far_ground_is_empty),
        cmocka_unit_test(ground_before_the_front_is_left_out),
        cmocka_unit_test(paint_lies_where_the_ground_is),
        cmocka_unit_test(the_sky_is_painted_like_the_ridge),
        cmocka_unit_test(without_quality_there_is_no_paint),
        cmocka_unit_test(gaps_are_filled_with_what_is_round_them),
        cmocka_unit_test(bytes_do_not_depend_on_what_was_drawn_before),
        cmocka_unit_test(the_largest_and_the_least_are_drawn),
        cmocka_unit_test(nonsense_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
