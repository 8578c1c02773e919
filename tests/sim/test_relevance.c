/* Relevance for known messages on the wire and frames of known contents: data drawn in time, too
 * late, or never; ancestors of what is drawn, images behind finer ones, faces beside the window;
 * bytes that come in pieces or not at all. */
#include "../../sim/judge/sim_relevance.h"
#include "../../protocol/message/ff_message.h"
#include "../rig/pack_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct wire {
    uint8_t bytes[65536]; /* recv writes here */
    size_t count, at;
    int64_t now_us;
    sys_stream stream;
    sim_relevance *relevance;
    sim_relevance_view view;
    ff_drawn drawn[8];
    uint16_t id;
} wire;

static int wire_send(void *state, const uint8_t *bytes, size_t count)
{
    (void)state;
    (void)bytes;
    return (int)count;
}

static int wire_recv(void *state, uint8_t *bytes, size_t capacity)
{
    wire *w = state;
    size_t count = w->count - w->at < capacity ? w->count - w->at : capacity;
    memcpy(bytes, w->bytes + w->at, count);
    w->at += count;
    return (int)count;
}

static int wire_reconnect(void *state)
{
    (void)state;
    return 0;
}

/* The one image that frames draw. */
static ff_key shown;

static int wears(const void *client, ff_key image)
{
    (void)client;
    return image == shown;
}

static void start(wire *w)
{
    memset(w, 0, sizeof *w);
    ff_terrain_info info = pack_fixture_info(6, 2, 2);
    info.texture_log2 = 4;
    info.texture_levels = 3;
    info.spacing_wu = 256 * FF_WU_PER_METRE; /* ground of 32 km */
    w->stream = (sys_stream){
        .state = w, .send = wire_send, .recv = wire_recv, .reconnect = wire_reconnect
    };
    w->relevance = sim_relevance_create(&w->stream, &info, &w->now_us);
    assert_non_null(w->relevance);
    /* level, looking north: a window of the north face alone */
    w->view.camera =
        (c3d_camera){ .width = 240, .height = 320, .focal_q8 = c3d_focal_q8(65536 / 6, 240) };
    w->view.drawn = w->drawn;
    w->view.wears = wears;
    shown = FF_KEY_NONE;
}

static void ask(wire *w, const ff_message *message)
{
    uint8_t bytes[FF_REQUEST_BYTES_MAX];
    int count = ff_message_encode(message, bytes, sizeof bytes);
    assert_true(count > 0);
    for (int i = 0; i < count; i++) /* in pieces of one byte */
        assert_int_equal(w->stream.send(w->stream.state, bytes + i, 1), 1);
}

/* Puts an answer on the wire; returns its size. */
static size_t put(wire *w, const ff_message *message)
{
    int count = ff_message_encode(message, w->bytes + w->count, sizeof w->bytes - w->count);
    assert_true(count > 0);
    w->count += (size_t)count;
    return (size_t)count;
}

/* Receives all there is, `piece` bytes at a time. */
static void receive(wire *w, size_t piece)
{
    uint8_t bytes[1024];
    while (w->stream.recv(w->stream.state, bytes, piece) > 0) continue;
}

static size_t node(wire *w, ff_key key, enum ff_kind kind)
{
    static const uint8_t payload[40];
    ff_message get = { .type = FF_MSG_GET, .kind = kind, .u.get = { key } };
    ff_message data = { .type = FF_MSG_ANSWER,
                        .kind = kind,
                        .u.data = { payload, kind == FF_KIND_ROOT ? 20 : 40 } };
    ask(w, &get);
    return put(w, &data);
}

static size_t image(wire *w, ff_key key)
{
    static const uint8_t jpeg[100];
    ff_message get = { .type = FF_MSG_GET, .kind = FF_KIND_TEXTURE, .u.get = { key } };
    ff_message data = { .type = FF_MSG_ANSWER,
                        .kind = FF_KIND_TEXTURE,
                        .u.data = { jpeg, sizeof jpeg } };
    ask(w, &get);
    return put(w, &data);
}

/* A frame that draws the first nodes and has the others hidden in view. */
static void draw_and_hide(wire *w, int64_t now_us, uint32_t drawn, uint32_t count,
                          const ff_key *key)
{
    w->now_us = now_us;
    w->view.drawn_count = drawn;
    w->view.in_view_count = count;
    for (uint32_t i = 0; i < count; i++) w->drawn[i].key = key[i];
    sim_relevance_frame(w->relevance, &w->view);
}

static void draw(wire *w, int64_t now_us, uint32_t count, const ff_key *key)
{
    draw_and_hide(w, now_us, count, count, key);
}

static sim_relevance_figures figures(wire *w, int64_t now_us)
{
    sim_relevance_figures f;
    w->now_us = now_us;
    assert_int_equal(sim_relevance_get(w->relevance, &f), FF_OK);
    return f;
}

/* A node two levels down draws its root, and both refinements above it; the root's neighbour is
 * never drawn. */
static void a_node_draws_its_ancestors(void **state)
{
    (void)state;
    static wire w;
    start(&w);
    ff_key root = ff_key_make(1, 0, 0), child = ff_key_child(root, 2),
           leaf = ff_key_child(child, 3);
    size_t used = node(&w, root, FF_KIND_ROOT) + node(&w, root, FF_KIND_REFINEMENT) +
                  node(&w, child, FF_KIND_REFINEMENT);
    size_t unused = node(&w, ff_key_child(root, 1), FF_KIND_REFINEMENT) +
                    node(&w, ff_key_make(2, 0, 0), FF_KIND_ROOT);
    receive(&w, 7);
    assert_true(isnan(figures(&w, SIM_RELEVANCE_US).percent)); /* too early to know */
    draw(&w, SIM_RELEVANCE_US, 1, &leaf);
    sim_relevance_figures f = figures(&w, SIM_RELEVANCE_US + 1);
    assert_int_equal(f.came[FF_DATA_HEIGHTS], used + unused);
    assert_int_equal(f.judged[FF_DATA_HEIGHTS], used + unused);
    assert_int_equal(f.unused[FF_DATA_HEIGHTS], unused);
    assert_true(fabs(f.percent - 100.0 * (double)used / (double)(used + unused)) < 1e-9);
    sim_relevance_destroy(w.relevance);
}

static int is_second(void *context, enum ff_kind kind, uint16_t id, ff_key key)
{
    assert_int_equal(id, 0); /* those for one node have none */
    assert_true(ff_kind[kind].asks == FF_ASKS_NODE && key != FF_KEY_NONE);
    return ++*(unsigned *)context == 2;
}

/* What was asked for the reserve is told apart, and both shares are given. */
static void the_reserve_is_told_apart(void **state)
{
    (void)state;
    static wire w;
    unsigned asked = 0;
    start(&w);
    sim_relevance_ask(w.relevance, is_second, &asked);
    ff_key drawn = ff_key_make(1, 0, 0);
    size_t used = node(&w, drawn, FF_KIND_ROOT);
    size_t reserve = node(&w, ff_key_make(2, 0, 0), FF_KIND_ROOT),
           unused = node(&w, ff_key_make(0, 0, 0), FF_KIND_ROOT);
    receive(&w, 7);
    assert_int_equal(asked, 3);
    draw(&w, SIM_RELEVANCE_US, 1, &drawn);
    sim_relevance_figures f = figures(&w, SIM_RELEVANCE_US + 1);
    assert_int_equal(f.reserve_came, reserve);
    assert_int_equal(f.reserve_judged, reserve);
    assert_int_equal(f.reserve_unused, reserve);
    assert_int_equal(f.unused[FF_DATA_HEIGHTS], unused + reserve);
    assert_true(fabs(f.percent - 100.0 * (double)used / (double)(used + unused + reserve)) < 1e-9);
    assert_true(fabs(f.no_reserve_percent - 100.0 * (double)used / (double)(used + unused)) < 1e-9);
    sim_relevance_destroy(w.relevance);
}

/* What brings a leaf below a root. */
static ff_key leaf_of(wire *w, ff_key root)
{
    ff_key child = ff_key_child(root, 1);
    (void)node(w, root, FF_KIND_ROOT);
    (void)node(w, root, FF_KIND_REFINEMENT);
    (void)node(w, child, FF_KIND_REFINEMENT);
    return ff_key_child(child, 0);
}

/* Of what has come apart from a drawn leaf, `beside` bytes support it and `away` do not. */
static void expect_supporting(wire *w, ff_key leaf, size_t beside, size_t away)
{
    receive(w, 1024);
    draw(w, 1, 1, &leaf);
    sim_relevance_figures f = figures(w, SIM_RELEVANCE_US + 1);
    assert_int_equal(f.unused[FF_DATA_HEIGHTS], beside + away);
    assert_int_equal(f.supporting, beside);
    sim_relevance_destroy(w->relevance);
}

/* A node beside a drawn one, which lets it be so fine, does not count as drawn, but is counted
 * apart. */
static void a_supporting_node_is_counted_apart(void **state)
{
    (void)state;
    static wire w;
    start(&w);
    ff_key leaf = leaf_of(&w, ff_key_make(0, 0, 0));
    size_t beside = node(&w, ff_key_make(1, 0, 0), FF_KIND_REFINEMENT),
           away = node(&w, ff_key_make(3, 0, 0), FF_KIND_REFINEMENT);
    /* its parent's eastern neighbour is a child of the next tile's root */
    expect_supporting(&w, leaf, beside, away);
}

/* Nodes of a second ground have neighbours in it alone: here it is one tile, the fifth of all. */
static void nodes_of_a_second_ground_are_drawn_and_supported(void **state)
{
    (void)state;
    static wire w;
    ff_terrain_info ground[2] = { pack_fixture_info(6, 2, 2), pack_fixture_info(5, 1, 1) };
    start(&w);
    ground[1].first_tile = 4;
    ground[1].west_wu = -1000;
    w.view.grounds = (sim_drawn_grounds){ .info = ground, .count = 2 };
    ff_key root = ff_key_make(4, 0, 0), leaf = leaf_of(&w, root);
    size_t beside = node(&w, ff_key_child(root, 0), FF_KIND_REFINEMENT),
           away = node(&w, ff_key_make(3, 0, 0), FF_KIND_REFINEMENT);
    expect_supporting(&w, leaf, beside, away);
}

/* What brought a node that is in view and hidden is counted apart, unless it is drawn, or a drawn
 * node needs it, or it was asked for the reserve, or it was hidden only after its time. */
static void a_hidden_node_is_counted_apart(void **state)
{
    (void)state;
    static wire w;
    start(&w);
    unsigned asked = 0;
    sim_relevance_ask(w.relevance, is_second, &asked);
    ff_key drawn = ff_key_make(0, 0, 0), far = ff_key_make(2, 0, 0),
           keys[5] = { ff_key_child(drawn, 1), ff_key_child(drawn, 0),
                       ff_key_child(ff_key_make(1, 0, 0), 0), ff_key_child(far, 0),
                       ff_key_make(3, 0, 0) };
    (void)node(&w, drawn, FF_KIND_REFINEMENT);
    size_t reserve = node(&w, keys[4], FF_KIND_ROOT),
           supporting = node(&w, ff_key_make(1, 0, 0), FF_KIND_REFINEMENT),
           hidden = node(&w, far, FF_KIND_ROOT) + node(&w, far, FF_KIND_REFINEMENT),
           late = node(&w, ff_key_make(4, 0, 0), FF_KIND_ROOT);
    receive(&w, 1024);
    draw_and_hide(&w, SIM_RELEVANCE_US, 1, 5, keys);
    keys[4] = ff_key_make(4, 0, 0);
    draw_and_hide(&w, SIM_RELEVANCE_US + 1, 1, 5, keys);
    sim_relevance_figures f = figures(&w, SIM_RELEVANCE_US + 1);
    assert_int_equal(f.unused[FF_DATA_HEIGHTS], reserve + supporting + hidden + late);
    assert_int_equal(f.reserve_unused, reserve);
    assert_int_equal(f.supporting, supporting);
    assert_int_equal(f.hidden, hidden);
    sim_relevance_destroy(w.relevance);
}

static void what_is_drawn_too_late_is_not_relevant(void **state)
{
    (void)state;
    static wire w;
    start(&w);
    ff_key root = ff_key_make(0, 0, 0);
    size_t bytes = node(&w, root, FF_KIND_ROOT);
    receive(&w, 1024);
    draw(&w, SIM_RELEVANCE_US + 1, 1, &root);
    assert_int_equal(figures(&w, SIM_RELEVANCE_US + 1).unused[FF_DATA_HEIGHTS], bytes);
    bytes += node(&w, root, FF_KIND_ROOT); /* sent once more: the new one is drawn */
    receive(&w, 1024);
    draw(&w, SIM_RELEVANCE_US + 2, 1, &root);
    sim_relevance_figures f = figures(&w, 3 * SIM_RELEVANCE_US);
    assert_int_equal(f.judged[FF_DATA_HEIGHTS], bytes);
    assert_int_equal(f.unused[FF_DATA_HEIGHTS], bytes / 2);
    sim_relevance_destroy(w.relevance);
}

/* An image is of use in frames that show it somewhere. */
static void images_are_of_use_where_they_are_drawn(void **state)
{
    (void)state;
    static wire w;
    start(&w);
    ff_key root = ff_key_make(3, 0, 0), child = ff_key_child(root, 0);
    size_t coarse = image(&w, root), fine = image(&w, child);
    receive(&w, 1024);
    shown = child;
    draw(&w, 1, 1, &root);
    assert_int_equal(figures(&w, SIM_RELEVANCE_US + 1).unused[FF_DATA_IMAGES], coarse);
    (void)image(&w, child);
    receive(&w, 1024);
    shown = root;
    draw(&w, SIM_RELEVANCE_US + 2, 1, &root);
    sim_relevance_figures f = figures(&w, 3 * SIM_RELEVANCE_US);
    assert_int_equal(f.judged[FF_DATA_IMAGES], coarse + 2 * fine);
    assert_int_equal(f.unused[FF_DATA_IMAGES], coarse + fine);
    sim_relevance_destroy(w.relevance);
}

enum { FACE_SIZE = 256 };

typedef struct face_case {
    enum ff_face_name name;
    unsigned top, rows; /* rows 0: an empty face */
    /* columns from..to - 1 show ground in all rows, others in none */
    unsigned from, to;
} face_case;

static size_t face(wire *w, const face_case *of)
{
    static const uint8_t image_bytes[50];
    static uint16_t first[FACE_SIZE], end[FACE_SIZE];
    static uint8_t columns[4 * FACE_SIZE + 8];
    for (unsigned i = 0; i < FACE_SIZE; i++) {
        first[i] = 0;
        end[i] = (uint16_t)(i >= of->from && i < of->to ? of->rows : 0);
    }
    int bytes = ff_face_columns_encode(first, end, FACE_SIZE, columns, sizeof columns);
    assert_true(bytes > 0);
    ff_message get = { .type = FF_MSG_GET,
                       .kind = FF_KIND_FACE,
                       .u.panorama = { .id = 9,
                                       .position_wu = { 500, 0, 0 },
                                       .front_wu = 1,
                                       .back_wu = 2,
                                       .face_size = FACE_SIZE,
                                       .quality = 70,
                                       .face_count = 1,
                                       .face = { (uint8_t)of->name } } };
    ff_message answer = {
        .type = FF_MSG_ANSWER,
        .kind = FF_KIND_FACE,
        .u.face = { .id = 9,
                    .face = (uint8_t)of->name,
                    .face_size = FACE_SIZE,
                    .top_row = (uint16_t)of->top,
                    .row_count = (uint16_t)of->rows,
                    .columns = columns,
                    .columns_bytes = of->rows ? (uint32_t)bytes : 0,
                    .image = image_bytes,
                    .image_bytes = of->rows ? sizeof image_bytes : 0,
                    .flags = (uint8_t)(of->rows ? FF_FACE_LAST : FF_FACE_LAST | FF_FACE_EMPTY) }
    };
    ask(w, &get);
    return put(w, &answer);
}

/* Draws level ground 32 km wide, 100 m below the viewer: all that lies below the horizon. */
static void draw_level_ground(wire *w)
{
    static const uint16_t heights[81];
    w->view.camera.pos_wu[2] = 100 * FF_WU_PER_METRE;
    w->drawn[0] = (ff_drawn){ .key = ff_key_make(0, 0, 0),
                              .heights = heights,
                              .cell_wu = 4096 * FF_WU_PER_METRE,
                              .origin_wu = { -16384 * FF_WU_PER_METRE, -16384 * FF_WU_PER_METRE } };
    w->view.drawn_count = 1;
}

/* The share of a face's bytes that counts as drawn. `ground`: level ground is drawn, too;
 * taken_wu: where the set in use was taken; yaw: where the viewer looks. */
static double share_of_face(const face_case *of, int ground, int32_t taken_wu, int32_t yaw)
{
    static wire w;
    start(&w);
    size_t bytes = face(&w, of);
    receive(&w, 1024);
    w.view.panorama = 1;
    w.view.panorama_pos_wu[0] = taken_wu;
    w.view.camera.yaw = yaw;
    w.now_us = 1;
    if (ground) draw_level_ground(&w);
    sim_relevance_frame(w.relevance, &w.view);
    sim_relevance_figures f = figures(&w, SIM_RELEVANCE_US + 1);
    assert_true(f.judged[FF_DATA_FACES] == (double)bytes);
    sim_relevance_destroy(w.relevance);
    return 1 - f.unused[FF_DATA_FACES] / (double)bytes;
}

/* 60 degrees across 240 pixels, 75 degrees across 320: rows 128 - 128 * 160 / 207.8 = 29.4 to 226.6
 * of the north face are in the window, and its columns 54 to 202. */
static void faces_in_the_window_are_drawn(void **state)
{
    (void)state;
    static const struct {
        face_case of;
        int32_t taken_wu;
        int drawn;
    } row[] = {
        { { FF_FACE_NORTH, 100, 40, 0, 256 }, 500, 1 },
        { { FF_FACE_NORTH, 0, 40, 0, 256 }, 500, 1 },
        { { FF_FACE_NORTH, 0, 29, 0, 256 }, 500, 0 },
        { { FF_FACE_NORTH, 228, 28, 0, 256 }, 500, 0 },
        { { FF_FACE_NORTH, 100, 40, 0, 256 }, 501, 0 }, /* a face of another set */
        { { FF_FACE_NORTH, 100, 40, 0, 53 }, 500, 0 },
        { { FF_FACE_NORTH, 100, 40, 60, 61 }, 500, 1 },
        { { FF_FACE_NORTH, 100, 40, 204, 256 }, 500, 0 },
        /* an empty face in the window counts as drawn: it shows that there is no ground */
        { { FF_FACE_NORTH, 0, 0, 0, 0 }, 500, 1 },
        { { FF_FACE_EAST, 100, 40, 0, 256 }, 500, 0 },
        { { FF_FACE_UP, 0, 0, 0, 0 }, 500, 0 },
    };
    for (size_t i = 0; i < sizeof row / sizeof *row; i++)
        if (share_of_face(&row[i].of, 0, row[i].taken_wu, 0) != row[i].drawn)
            fail_msg("case %zu is drawn by %g", i,
                     share_of_face(&row[i].of, 0, row[i].taken_wu, 0));
    /* looking 30 degrees to the east, the window begins in the middle of the north face */
    const face_case west = { FF_FACE_NORTH, 100, 40, 0, 127 },
                    east = { FF_FACE_NORTH, 100, 40, 129, 256 };
    assert_true(share_of_face(&west, 0, 500, 65536 / 12) == 0);
    assert_true(share_of_face(&east, 0, 500, 65536 / 12) == 1);
}

/* Drawn ground hides what is below the horizon: row 128 of a level face, a little above in truth.
 */
static void hidden_faces_are_not_drawn(void **state)
{
    (void)state;
    const face_case above = { FF_FACE_NORTH, 100, 20, 0, 256 },
                    below = { FF_FACE_NORTH, 132, 20, 0, 256 },
                    half = { FF_FACE_NORTH, 108, 40, 0, 256 }, none = { FF_FACE_DOWN, 0, 0, 0, 0 };
    assert_true(share_of_face(&above, 1, 500, 0) == 1);
    assert_true(share_of_face(&below, 0, 500, 0) == 1);
    assert_true(share_of_face(&below, 1, 500, 0) == 0);
    assert_true(fabs(share_of_face(&half, 1, 500, 0) - 0.5) < 0.06);
    assert_true(share_of_face(&none, 1, 500, 0) == 0);
}

/* Level ground hides 12 of 40 rows, ground that rises to 3000 m most of them: the face counts by
 * the frame that shows more of it, whichever comes first. */
static void a_face_counts_by_its_best_frame(void **state)
{
    (void)state;
    static uint16_t rising[81];
    for (int i = 72; i < 81; i++) rising[i] = 3000;
    const face_case most = { FF_FACE_NORTH, 100, 40, 0, 256 };
    for (int first = 0; first < 2; first++) {
        static wire w;
        start(&w);
        double bytes = (double)face(&w, &most);
        receive(&w, 1024);
        w.view.panorama = 1;
        w.view.panorama_pos_wu[0] = 500;
        for (int t = 0; t < 2; t++) {
            w.now_us = t * 1000000;
            draw_level_ground(&w);
            if (t != first) w.drawn[0].heights = rising;
            sim_relevance_frame(w.relevance, &w.view);
        }
        double unused = figures(&w, SIM_RELEVANCE_US + 1).unused[FF_DATA_FACES];
        assert_true(fabs(unused / bytes - 12.0 / 40) < 0.05);
        sim_relevance_destroy(w.relevance);
    }
}

static size_t sector(wire *w, unsigned number, int32_t taken_wu, uint32_t fins, int empty)
{
    static const uint8_t bytes[64];
    ff_message get = { .type = FF_MSG_GET,
                       .kind = FF_KIND_FAR,
                       .u.get_far = { .id = ++w->id,
                                      .position_wu = { taken_wu, 0, 0 },
                                      .front_wu = 1,
                                      .focal = 200,
                                      .down = 100,
                                      .tolerance_q2 = 2,
                                      .sector_count = 1,
                                      .sector = { (uint8_t)number } } };
    ff_message answer = { .type = FF_MSG_ANSWER,
                          .kind = FF_KIND_FAR,
                          .u.far = { .sector = (uint8_t)number,
                                     .flags = (uint8_t)(empty ? FF_FACE_LAST | FF_FACE_EMPTY
                                                              : FF_FACE_LAST),
                                     .fins = bytes,
                                     .fins_bytes = empty ? 0 : fins } };
    ask(w, &get);
    return put(w, &answer);
}

/* Sectors that may be seen, empty ones too, of the set in use, and no others; and not too late. */
static void sectors_in_view_of_the_set_in_use_are_drawn(void **state)
{
    (void)state;
    static wire w;
    start(&w);
    size_t used = sector(&w, 0, 500, 40, 0) + sector(&w, 7, 500, 0, 1);
    size_t unused = sector(&w, 1, 500, 20, 0) + sector(&w, 0, 501, 30, 0);
    receive(&w, 7);
    w.view.far_sectors = 1u << 0 | 1u << 7 | 1u << 6;
    w.view.far_pos_wu[0] = 500;
    draw(&w, SIM_RELEVANCE_US, 0, NULL);
    w.view.far_sectors = 255;
    draw(&w, SIM_RELEVANCE_US + 1, 0, NULL);
    w.view.far_sectors = 0; /* there is none */
    size_t later = sector(&w, 0, 500, 10, 0);
    receive(&w, 7);
    draw(&w, SIM_RELEVANCE_US + 2, 0, NULL);
    sim_relevance_figures f = figures(&w, 3 * SIM_RELEVANCE_US);
    assert_int_equal(f.came[FF_DATA_FAR], used + unused + later);
    assert_int_equal(f.fins_came, 40 + 20 + 30 + 10);
    assert_int_equal(f.judged[FF_DATA_FAR], used + unused + later);
    assert_int_equal(f.unused[FF_DATA_FAR], unused + later);
    sim_relevance_destroy(w.relevance);
}

/* Messages that bring no picture, and those that a cut leaves in pieces. */
static void messages_without_picture_are_overhead(void **state)
{
    (void)state;
    static wire w;
    start(&w);
    ff_message pong = { .type = FF_MSG_PONG, .u.ping = { 7 } };
    ff_message failed = { .type = FF_MSG_FAILED, .u.failed = { 1, FF_ERR_NOT_FOUND } };
    ff_key root = ff_key_make(0, 0, 0);
    size_t overhead = put(&w, &pong) + put(&w, &failed), used = node(&w, root, FF_KIND_ROOT);
    receive(&w, 1024);
    draw(&w, 1, 1, &root);
    (void)node(&w, root, FF_KIND_REFINEMENT);
    w.count -= 11; /* the rest never comes */
    overhead += w.count - w.at;
    receive(&w, 1024);
    assert_int_equal(w.stream.reconnect(w.stream.state), 0);
    size_t again = node(&w, root, FF_KIND_REFINEMENT);
    receive(&w, 1024);
    sim_relevance_figures f = figures(&w, SIM_RELEVANCE_US + 2);
    assert_int_equal(f.came[FF_DATA_OVERHEAD], overhead);
    assert_int_equal(f.came[FF_DATA_HEIGHTS], used + again);
    assert_int_equal(f.unused[FF_DATA_HEIGHTS], again);
    assert_true(fabs(f.percent - 100.0 * (double)used / (double)(used + again + overhead)) < 1e-9);
    sim_relevance_destroy(w.relevance);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_node_draws_its_ancestors),
        cmocka_unit_test(the_reserve_is_told_apart),
        cmocka_unit_test(a_hidden_node_is_counted_apart),
        cmocka_unit_test(what_is_drawn_too_late_is_not_relevant),
        cmocka_unit_test(images_are_of_use_where_they_are_drawn),
        cmocka_unit_test(faces_in_the_window_are_drawn),
        cmocka_unit_test(hidden_faces_are_not_drawn),
        cmocka_unit_test(a_face_counts_by_its_best_frame),
        cmocka_unit_test(sectors_in_view_of_the_set_in_use_are_drawn),
        cmocka_unit_test(messages_without_picture_are_overhead),
        cmocka_unit_test(a_supporting_node_is_counted_apart),
        cmocka_unit_test(nodes_of_a_second_ground_are_drawn_and_supported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
