/* Sectors of far sets as the worker takes them in: fins and a picture ready for the device. */
#include "../rig/client_fixture.h"
#include "../../client/ask/ff_intake_local.h"
#include "../../protocol/picture/ff_paint.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { SQUARES_X = 4, SIDE = 128, RGB_BYTES = SIDE * SIDE * 3, MESSAGE_BYTES = 20000 };

typedef struct rig {
    ff_intake intake;
    ff_new_data news;
    uint64_t items[512];
    uint64_t rgb[RGB_BYTES / 8];
    uint8_t paint[MESSAGE_BYTES], fins[FF_FAR_FINS_BYTES];
    uint8_t *images;
    ff_message answer;
    ff_new_item *item;
} rig;

/* With room for pictures of SIDE x rows. */
static void open_rig(rig *r, unsigned rows)
{
    memset(r, 0, sizeof *r);
    size_t bytes = FF_NEW_FINS_BYTES + (size_t)SIDE * rows * sizeof(uint16_t);
    r->images = malloc(bytes);
    assert_true(ff_new_data_item_bytes(2, 1) <= sizeof r->items);
    ff_new_data_init(&r->news, 2, 1, r->items, 1, bytes, r->images);
    r->intake =
        (ff_intake){ .news = &r->news, .rgb = (uint8_t *)r->rgb, .rgb_bytes = sizeof r->rgb };
    r->answer = (ff_message){ .type = FF_MSG_ANSWER, .kind = FF_KIND_FAR };
    r->item = ff_new_data_begin(&r->news);
}

static void close_rig(rig *r) { free(r->images); }

static void look_away(void *context, unsigned column, unsigned row, uint8_t texel[64][3])
{
    (void)context, (void)column, (void)row, (void)texel;
}

/* Paint of which some squares of two by two blocks are there, the first green, all others red. */
static void paint(rig *r, const uint8_t *there, unsigned rows)
{
    static uint8_t rgb[RGB_BYTES], blocks[RGB_BYTES / 3 / 64];
    static uint64_t room[4096];
    static const ff_paint_sink nobody = { .block = look_away };
    ff_far *far = &r->answer.u.far;
    unsigned first = 0, width = SQUARES_X * 16;
    while (!there[first]) first++;
    for (unsigned i = 0; i < width * rows * 16; i++) {
        unsigned square = i / width / 16 * SQUARES_X + i % width / 16;
        blocks[i / width / 8 * SQUARES_X * 2 + i % width / 8] = there[square];
        rgb[3 * i] = square == first ? 0 : 255;
        rgb[3 * i + 1] = square == first ? 255 : 0;
        rgb[3 * i + 2] = 0;
    }
    const ff_paint_source source = { 2 * SQUARES_X, 2 * rows, blocks, rgb };
    int bytes = ff_paint_encode(&source, 95, (ff_paint_room *)(void *)room, &nobody, r->paint,
                                sizeof r->paint);
    assert_true(bytes > 0);
    far->blocks_x = 2 * SQUARES_X;
    far->blocks_y = (uint8_t)(2 * rows);
    far->top = 5;
    far->paint = r->paint;
    far->paint_bytes = (uint32_t)bytes;
}

/* g: more green, r: more red, .: neither; in capitals opaque. */
static char texel_at(const rig *r, unsigned x, unsigned y)
{
    const uint16_t *texels = (const uint16_t *)(const void *)((const uint8_t *)r->item->pixels +
                                                              FF_NEW_FINS_BYTES);
    uint16_t texel = texels[y * r->item->width + x];
    int red = texel >> 11, green = texel >> 6 & 31, opaque = texel & 1;
    char c = red > green ? 'r' : green > red ? 'g' : '.';
    return (char)(opaque && c != '.' ? c - 'a' + 'A' : c);
}

/* Filtering mixes texels with those beside them: transparent ones beside opaque ones have their
 * colour, all further ones are black. */
static void paint_has_a_rim_of_its_colour(void **state)
{
    (void)state;
    static rig r;
    static const uint8_t there[2 * SQUARES_X] = { 0, 1, 1, 0, 0, 0, 1, 0 };
    open_rig(&r, SIDE);
    paint(&r, there, 2);
    assert_int_equal(ff_intake_far(&r.intake, &r.answer, r.item), FF_OK);
    assert_int_equal(r.item->width, 128);
    assert_int_equal(r.item->height, 64);
    assert_int_equal(r.item->u.far.middle, 33);
    assert_int_equal(r.item->u.far.top, 6);
    for (unsigned y = 0; y < r.item->height; y++)
        for (unsigned x = 0; x < r.item->width; x++) {
            int green = x >= 17 && x < 33 && y >= 1 && y < 17,
                red = x >= 33 && x < 49 && y >= 1 && y < 33;
            int by_green = (x == 16 && y >= 1 && y < 17) ||
                           (x >= 17 && x < 32 && (y == 0 || y == 17)),
                by_red = (x == 49 && y >= 1 && y < 33) ||
                         (x >= 33 && x < 49 && (y == 0 || y == 33)) ||
                         (x == 32 && y > 17 && y < 33);
            char expected = green ? 'G' : red ? 'R' : by_green ? 'g' : by_red ? 'r' : '.';
            if (x == 32 && (y == 0 || y == 17)) continue; /* beside both */
            assert_int_equal(texel_at(&r, x, y), expected);
        }
    close_rig(&r);
}

/* A picture that is too high for its room lacks its lowest rows of blocks. */
static void a_picture_that_is_too_high_lacks_its_lowest_blocks(void **state)
{
    (void)state;
    static rig r;
    static const uint8_t there[3 * SQUARES_X] = { 0, 1, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0 };
    for (unsigned rows = 32; rows <= 128; rows *= 2) {
        open_rig(&r, rows);
        paint(&r, there, 3);
        assert_int_equal(ff_intake_far(&r.intake, &r.answer, r.item), FF_OK);
        assert_int_equal(r.item->height, rows == 32 ? 32 : 64);
        assert_int_equal(texel_at(&r, 20, 5), 'G');
        assert_int_equal(texel_at(&r, 5, 20), 'R');
        assert_int_equal(texel_at(&r, 5, 28), rows == 32 ? '.' : 'R');
        if (rows > 32) assert_int_equal(texel_at(&r, 20, 40), 'R');
        close_rig(&r);
    }
}

static void what_cannot_be_decoded_is_an_error(void **state)
{
    (void)state;
    static rig r;
    static const uint8_t there[SQUARES_X] = { 0, 1, 0, 0 };
    ff_fin_vertex fin[2] = { { .begins = 1 }, { .column = 1 } };
    open_rig(&r, SIDE);
    paint(&r, there, 1);
    int bytes = ff_fins_encode(fin, 2, r.fins, sizeof r.fins);
    assert_true(bytes > 0);
    r.answer.u.far.fins = r.fins;
    r.answer.u.far.fins_bytes = (uint32_t)bytes;
    assert_int_equal(ff_intake_far(&r.intake, &r.answer, r.item), FF_OK);
    assert_int_equal(r.item->u.far.fins, 2);
    close_rig(&r);
    for (int fault = 0; fault < 4; fault++) {
        open_rig(&r, fault == 3 ? 16 : SIDE);
        paint(&r, there, 1);
        r.answer.u.far.fins = r.fins;
        r.answer.u.far.fins_bytes = (uint32_t)(fault == 0 ? bytes - 1 : bytes);
        if (fault == 1) r.paint[0] = 0;
        if (fault == 2) r.answer.u.far.paint_bytes = 2;
        assert_true(ff_intake_far(&r.intake, &r.answer, r.item) < 0);
        close_rig(&r);
    }
}

/* One sector in view is nonsense: it is told of, not asked for again, and its set is shown. */
static void sectors_that_cannot_be_decoded_are_counted(void **state)
{
    (void)state;
    client_rig spoilt, whole;
    ff_far_in_use use;
    for (int i = 0; i < 2; i++) {
        client_rig *r = i ? &whole : &spoilt;
        rig_open(r, 0);
        r->desc.far = (ff_far_desc){ .enabled = FF_FAR_FINS, .front_wu = 300 * FF_WU_PER_METRE };
        r->spoilt = i ? 0 : 1; /* north */
        rig_client(r, 2 << 20);
        assert_true(rig_settle(r, 400));
    }
    assert_int_equal(rig_stats(&spoilt).far_sectors_failed, 1);
    assert_int_equal(rig_stats(&whole).far_sectors_failed, 0);
    assert_int_equal(rig_stats(&spoilt).far_sectors + 1, rig_stats(&whole).far_sectors);
    assert_int_equal(rig_stats(&spoilt).far_requests, rig_stats(&whole).far_requests);
    assert_int_equal(rig_stats(&spoilt).protocol_errors, 0);
    assert_true(ff_client_far(spoilt.client, &use));
    assert_int_equal(use.sectors & 1, 0);
    assert_true(ff_client_far(whole.client, &use));
    assert_int_equal(use.sectors & 1, 1);
    rig_close(&spoilt);
    rig_close(&whole);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(paint_has_a_rim_of_its_colour),
        cmocka_unit_test(a_picture_that_is_too_high_lacks_its_lowest_blocks),
        cmocka_unit_test(what_cannot_be_decoded_is_an_error),
        cmocka_unit_test(sectors_that_cannot_be_decoded_are_counted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
