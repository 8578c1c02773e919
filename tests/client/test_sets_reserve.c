/* The reserve of far sets: what is asked for on an idle link of what lies out of view, and how it
 * gives way to what is in view. */
#include "../rig/flat_ground.h"
#include "../rig/picture.h"
#include "../../client/far/ff_sets.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>

#define M FF_WU_PER_METRE

enum { WIDE = 240, HIGH = 320, FOCAL = 208, SIDE = 64, ALL = 65535, SECTOR_BYTES = 250 };

typedef struct stage {
    picture_kit kit;
    ff_sets sets;
    ff_set *set; /* the drawn one: its sectors in view are here */
    ff_terrain_info info;
    c3d_vertex scratch[81];
    uint16_t indices[2 * 81];
    ff_requests requests;
    uint64_t requests_memory[4096];
    ff_motion motion;
    ff_view view;
} stage;

/* Sectors in view: 15, 0 and 1. */
static void open_stage(stage *s, int device)
{
    const ff_far_desc desc = {
        .enabled = FF_FAR_PAINT, .front_wu = 1000 * M, .quality = 80, .tolerance_q2 = 2
    };
    memset(s, 0, sizeof *s);
    assert_int_equal(picture_open(&s->kit, PICTURE_SOFT, WIDE, HIGH, 0), FF_OK);
    s->info = flat_ground();
    s->view.camera = flat_ground_camera(WIDE, HIGH, FOCAL);
    assert_true(ff_requests_bytes(8) <= sizeof s->requests_memory);
    ff_requests_init(&s->requests, 8, s->requests_memory);
    ff_motion_reset(&s->motion);
    ff_sets_init(&s->sets, device ? s->kit.device : NULL, &desc, &s->info, 256);
    ff_sets_scratch(&s->sets, s->scratch, s->indices, 81);
    s->set = &s->sets.set[0];
    *s->set = (ff_set){ .key = 7,
                        .front_wu = desc.front_wu,
                        .focal = FOCAL,
                        .painted = 1,
                        .region = { .behind_wu = 1000 * M,
                                    .ahead_wu = 3000 * M,
                                    .aside_wu = 500 * M,
                                    .low_wu = -M,
                                    .high_wu = M } };
    memcpy(s->set->position_wu, s->view.camera.pos_wu, sizeof s->set->position_wu);
    s->sets.active = 0;
    s->sets.seen = (uint16_t)ff_sets_in_view(&s->view.camera);
    assert_int_equal(s->sets.seen, 0x8003);
    s->set->held = s->sets.seen;
    s->set->whole = 3;
    s->set->whole_bytes = 3 * SECTOR_BYTES;
}

/* Flies north at so many metres a second, and is at O now. */
static void fly(stage *s, int m_s)
{
    int32_t pos_wu[3];
    ff_motion_reset(&s->motion);
    for (int i = 0; i < 60; i++) {
        memcpy(pos_wu, s->set->position_wu, sizeof pos_wu);
        pos_wu[1] += m_s * M * (i - 59) / 10;
        ff_motion_feed(&s->motion, (int64_t)i * 100000, pos_wu);
    }
}

/* What a ranking asks for: the request that would leave now, and what it asks. 0: nothing. */
static int asked(stage *s, ff_request *request, ff_get_far *ask)
{
    ff_requests_rank_begin(&s->requests);
    ff_sets_want(&s->sets, &s->requests, &s->view, 0, 0);
    ff_sets_want_reserve(&s->sets, &s->requests, &s->view, &s->motion, 0);
    ff_requests_rank_end(&s->requests);
    if (!ff_requests_next(&s->requests, 0, 8, 100000, 1, request)) return 0;
    *ask = ff_requests_ask_of(&s->requests, request)->far;
    ff_requests_arrived(&s->requests, request->id, 0);
    ff_requests_finish(&s->requests, request->id, FF_REQUEST_DONE);
    return 1;
}

static unsigned sectors_of(const ff_get_far *ask)
{
    unsigned sectors = 0;
    for (unsigned i = 0; i < ask->sector_count; i++) sectors |= 1u << ask->sector[i];
    return sectors;
}

/* The answer to a request: a sector with a fin, and with paint if that was asked for. */
static int answer(stage *s, ff_key key, unsigned sector, int paint)
{
    static uint8_t slot[FF_NEW_FINS_BYTES + SIDE * SIDE * 2];
    ff_fin_vertex *fin = (ff_fin_vertex *)(void *)slot;
    for (int i = 0; i < 4; i++)
        fin[i] = (ff_fin_vertex){ .column = (int16_t)(8 * i),
                                  .up_q2 = 40,
                                  .distance = (uint16_t)ff_far_distance_step(10000 * M),
                                  .begins = i == 0 };
    ff_new_item item = {
        .key = key, .kind = FF_KIND_FAR, .bytes = SECTOR_BYTES, .pixels = (uint16_t *)(void *)slot
    };
    item.u.far.sector = (uint8_t)sector;
    item.u.far.fins = 4;
    item.width = item.height = paint ? SIDE : 0;
    return ff_sets_take(&s->sets, &item, 0);
}

static c3d_stats stats_of(const stage *s)
{
    c3d_stats stats;
    c3d_get_stats(s->kit.device, &stats);
    return stats;
}

/* Four at a time, the nearest to the view first, until all are here. */
static void who_stays_gets_the_rest_with_paint(void **state)
{
    (void)state;
    static stage s;
    ff_request request;
    ff_get_far ask;
    open_stage(&s, 0);
    assert_true(asked(&s, &request, &ask));
    assert_int_equal(request.rank, FF_CLASS_RESERVE);
    assert_int_equal(ask.quality, 80);
    assert_int_equal(sectors_of(&ask), 1 << 2 | 1 << 3 | 1 << 13 | 1 << 14);
    for (int i = 0; i < 3; i++) {
        assert_true(i == 0 || asked(&s, &request, &ask));
        assert_int_equal(sectors_of(&ask) & s.set->held, 0);
        for (unsigned k = 0; k < ask.sector_count; k++)
            assert_int_equal(answer(&s, request.key, ask.sector[k], 1), 1);
    }
    assert_int_equal(s.set->held, ALL - (1 << 8));
    assert_int_equal(s.set->bare, 0);
    assert_true(asked(&s, &request, &ask)); /* the last one */
    assert_int_equal(sectors_of(&ask), 1 << 8);
    assert_int_equal(answer(&s, request.key, 8, 1), 1);
    assert_false(asked(&s, &request, &ask));
    picture_close(&s.kit);
}

/* By how long the set will be good: not at all, as fins alone, with paint. */
static void who_passes_gets_what_is_worth_its_bytes(void **state)
{
    (void)state;
    /* it is good for 3000 m more; 13 sectors of 250 bytes are worth it where that is 325 s */
    static const struct {
        int m_s, quality; /* -1: nothing */
    } at[] = { { 0, 80 }, { 2, 80 }, { 9, 80 }, { 10, 0 }, { 140, 0 }, { 160, -1 }, { 900, -1 } };
    for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
        static stage s;
        ff_request request;
        ff_get_far ask;
        open_stage(&s, 0);
        fly(&s, at[i].m_s);
        assert_int_equal(asked(&s, &request, &ask), at[i].quality >= 0);
        if (at[i].quality >= 0) {
            assert_int_equal(request.rank, FF_CLASS_RESERVE);
            assert_int_equal(ask.quality, at[i].quality);
            assert_int_equal(ask.sector_count, at[i].quality ? 4 : 13);
            assert_int_equal(sectors_of(&ask) & s.set->held, 0);
        }
        picture_close(&s.kit);
    }
}

/* 13 sectors of 769 bytes are 9997 together, of 770 they are 10 010: those come as fins alone,
 * however long the viewer stays. */
static void paint_all_round_is_ten_kilobytes_at_most(void **state)
{
    (void)state;
    for (uint32_t bytes = 769; bytes <= 770; bytes++) {
        static stage s;
        ff_request request;
        ff_get_far ask;
        open_stage(&s, 0);
        s.set->whole_bytes = 3 * bytes;
        assert_true(asked(&s, &request, &ask));
        assert_int_equal(ask.quality, bytes == 769 ? 80 : 0);
        picture_close(&s.kit);
    }
}

static void the_reserve_is_for_a_drawn_set_that_is_good_and_whole_in_view(void **state)
{
    (void)state;
    static stage s;
    ff_request request;
    ff_get_far ask;
    open_stage(&s, 0);
    s.sets.next = 1; /* another one is coming */
    s.sets.set[1] = *s.set;
    assert_false(asked(&s, &request, &ask));
    s.sets.next = -1;
    s.sets.active = -1;
    assert_false(asked(&s, &request, &ask));
    s.sets.active = 0;
    s.sets.off = 1;
    assert_false(asked(&s, &request, &ask));
    s.sets.off = 0;
    s.sets.through = 1; /* another one is still there, below it */
    assert_false(asked(&s, &request, &ask));
    s.sets.through = 0;
    s.view.camera.pos_wu[0] += 600 * M; /* he is beside the region */
    assert_false(asked(&s, &request, &ask));
    s.view.camera.pos_wu[0] -= 600 * M;
    s.set->held &= 0x7FFF; /* a sector in view is missing: that is all that is asked for */
    assert_true(asked(&s, &request, &ask));
    assert_int_equal(request.rank, FF_CLASS_FIRST);
    assert_int_equal(sectors_of(&ask), 0x8000);
    /* and while it is on its way */
    ff_requests_rank_begin(&s.requests);
    ff_sets_want_reserve(&s.sets, &s.requests, &s.view, &s.motion, 0);
    assert_false(ff_requests_waiting(&s.requests, FF_CLASS_RESERVE));
    ff_requests_rank_end(&s.requests);
    picture_close(&s.kit);
}

/* What comes as fins alone is drawn, and asked for again when it comes into view; what then comes
 * takes the place of the fins. */
static void fins_alone_give_way_to_fins_with_paint(void **state)
{
    (void)state;
    static stage s;
    ff_request request, again;
    ff_get_far ask;
    open_stage(&s, 1);
    fly(&s, 100);
    assert_true(asked(&s, &request, &ask));
    assert_int_equal(ask.quality, 0);
    assert_int_equal(answer(&s, request.key, 2, 0), 1);
    assert_int_equal(answer(&s, request.key, 2, 0), 0); /* once */
    assert_int_equal(s.set->bare, 1 << 2);
    assert_int_equal(s.set->sector[2].chunks, 1);
    uint32_t meshes = stats_of(&s).mesh_held;
    s.sets.seen = 1 << 1 | 1 << 2;
    assert_true(asked(&s, &again, &ask));
    assert_int_equal(again.rank, FF_CLASS_FIRST);
    assert_int_not_equal(again.key, request.key); /* a server lets go of the reserve for it */
    assert_int_equal(ask.quality, 80);
    assert_int_equal(sectors_of(&ask), 1 << 2);
    assert_int_equal(answer(&s, again.key, 2, 1), 1);
    assert_int_equal(s.set->bare, 0);
    assert_true(s.set->sector[2].paint.id);
    assert_int_equal(stats_of(&s).mesh_held, meshes);
    assert_int_equal(stats_of(&s).strip_held, 2);       /* and the kit's */
    assert_int_equal(answer(&s, request.key, 2, 0), 0); /* too late */
    assert_true(s.set->sector[2].paint.id);
    assert_int_equal(answer(&s, again.key, 2, 1), 0);
    picture_close(&s.kit);
}

static void who_has_fins_and_stays_gets_the_paint(void **state)
{
    (void)state;
    static stage s;
    ff_request request;
    ff_get_far ask;
    open_stage(&s, 1);
    s.set->held = FF_SETS_ALL;
    s.set->bare = 1 << 7;
    fly(&s, 200);
    assert_false(asked(&s, &request, &ask));
    fly(&s, 0);
    assert_true(asked(&s, &request, &ask));
    assert_int_equal(ask.quality, 80);
    assert_int_equal(sectors_of(&ask), 1 << 7);
    picture_close(&s.kit);
}

/* A sector without fins may have paint; one whose paint cannot be read keeps its fins. */
static void no_fins_and_no_paint_are_told_apart(void **state)
{
    (void)state;
    static stage s;
    ff_request request;
    ff_get_far ask;
    open_stage(&s, 1);
    fly(&s, 100);
    assert_true(asked(&s, &request, &ask));
    ff_new_item empty = { .key = request.key, .kind = FF_KIND_FAR };
    empty.u.far.sector = 2;
    empty.u.far.empty = 1;
    assert_int_equal(ff_sets_take(&s.sets, &empty, 0), 1);
    assert_int_equal(answer(&s, request.key, 3, 0), 1);
    assert_int_equal(s.set->bare, 1 << 2 | 1 << 3);
    s.sets.seen = 1 << 2 | 1 << 3;
    assert_true(asked(&s, &request, &ask));
    assert_int_equal(sectors_of(&ask), 1 << 2 | 1 << 3);
    empty.key = request.key;
    assert_int_equal(ff_sets_take(&s.sets, &empty, 0), 1);
    assert_int_equal(s.set->empty, 1 << 2);
    ff_new_item bad = { .key = request.key, .kind = FF_KIND_FAR, .error = FF_ERR_FORMAT };
    bad.u.far.sector = 3;
    assert_int_equal(ff_sets_take(&s.sets, &bad, 0), 1);
    assert_int_equal(s.set->sector[3].chunks, 1);
    assert_int_equal(s.set->bare | s.set->failed, 0);
    assert_int_equal(s.sets.sectors_failed, 1);
    assert_true(s.set->held >> 3 & 1);
    picture_close(&s.kit);
}

static void the_reserve_pushes_no_paint_out(void **state)
{
    (void)state;
    static stage s;
    ff_request request;
    ff_get_far ask;
    uint16_t texels[SIDE * SIDE] = { 0 };
    open_stage(&s, 1);
    assert_true(asked(&s, &request, &ask));
    assert_int_equal(answer(&s, request.key, 2, 1), 1);
    while (c3d_texture_make(s.kit.device, C3D_RGBA5551, SIDE, SIDE, texels).id) {
    }
    assert_int_equal(answer(&s, request.key, 3, 1), 1);
    assert_true(s.set->sector[2].paint.id);
    assert_int_equal(s.set->bare, 1 << 3); /* its fins it has */
    assert_int_equal(s.set->sector[3].chunks, 1);
    assert_false(asked(&s, &request, &ask)); /* there is no room for more */
    s.sets.seen = 1 << 3;
    assert_true(asked(&s, &request, &ask));
    assert_int_equal(answer(&s, request.key, 3, 1), 1);
    assert_true(s.set->sector[3].paint.id);
    assert_int_equal(s.set->held, 0x8003 | 1 << 3); /* for this the other one gave way */
    assert_int_equal(s.set->bare, 0);
    picture_close(&s.kit);
}

/* Of the device's texels paint has its share, whatever else lies free. */
static void the_reserve_keeps_to_the_share_of_paint(void **state)
{
    (void)state;
    static stage s;
    ff_request request;
    ff_get_far ask;
    open_stage(&s, 1);
    s.sets.paint_bytes = 2 * 2 * (SIDE + 2) * (SIDE + 2); /* for two sectors */
    assert_true(asked(&s, &request, &ask));
    assert_int_equal(answer(&s, request.key, 3, 1), 1);
    assert_int_equal(answer(&s, request.key, 6, 1), 1);
    assert_int_equal(answer(&s, request.key, 4, 1), 1);
    assert_int_equal(s.set->bare, 1 << 4);
    assert_int_equal(stats_of(&s).texture_held, 2);
    assert_false(asked(&s, &request, &ask));
    s.sets.seen = 1 << 4; /* the one that lies farthest from it gives way */
    assert_int_equal(answer(&s, s.set->key, 4, 1), 1);
    assert_int_equal(s.set->held, 0x8003 | 1 << 3 | 1 << 4);
    assert_true(s.set->sector[4].paint.id);
    assert_int_equal(stats_of(&s).texture_held, 2);
    s.sets.seen = 1 << 3 | 1 << 4 | 1 << 5; /* all in view may have more, if there is any */
    assert_int_equal(answer(&s, s.set->key, 5, 1), 1);
    assert_true(s.set->sector[5].paint.id);
    assert_int_equal(stats_of(&s).texture_held, 3);
    picture_close(&s.kit);
}

static void the_reserve_pushes_no_fins_out(void **state)
{
    (void)state;
    static stage s;
    ff_request request;
    ff_get_far ask;
    static const uint16_t indices[3] = { 0, 1, 2 };
    open_stage(&s, 1);
    fly(&s, 100);
    assert_true(asked(&s, &request, &ask));
    assert_int_equal(answer(&s, request.key, 2, 0), 1);
    while (c3d_strip_make(s.kit.device, indices, 3).id) {
    }
    assert_int_equal(answer(&s, request.key, 3, 0), 1);
    assert_int_equal(s.set->held, 0x8003 | 1 << 2); /* there was no room for it */
    assert_int_equal(s.set->sector[2].chunks, 1);
    assert_false(asked(&s, &request, &ask));
    s.sets.seen = 1 << 3;
    assert_true(asked(&s, &request, &ask));
    assert_int_equal(answer(&s, request.key, 3, 1), 1);
    assert_int_equal(s.set->sector[3].chunks, 1);
    assert_int_equal(s.set->held, 0x8003 | 1 << 3);
    assert_int_equal(stats_of(&s).stale_handles, 0);
    picture_close(&s.kit);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(who_stays_gets_the_rest_with_paint),
        cmocka_unit_test(who_passes_gets_what_is_worth_its_bytes),
        cmocka_unit_test(paint_all_round_is_ten_kilobytes_at_most),
        cmocka_unit_test(the_reserve_is_for_a_drawn_set_that_is_good_and_whole_in_view),
        cmocka_unit_test(fins_alone_give_way_to_fins_with_paint),
        cmocka_unit_test(who_has_fins_and_stays_gets_the_paint),
        cmocka_unit_test(no_fins_and_no_paint_are_told_apart),
        cmocka_unit_test(the_reserve_pushes_no_paint_out),
        cmocka_unit_test(the_reserve_keeps_to_the_share_of_paint),
        cmocka_unit_test(the_reserve_pushes_no_fins_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
