/* Messages: there and back at the limits of every field, cut everywhere, flipped everywhere. */
#include "../../protocol/message/ff_message.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define STREAM_MAX (1 << 16)
#define LIST(text)                                \
    {                                             \
        (const uint8_t *)(text), sizeof(text) - 1 \
    }

static const uint8_t payload[8200] = { 0xff, 0xd8, 1, 2, 3 };

static ff_terrain_info terrain(void)
{
    return (ff_terrain_info){ .node_log2 = 5,
                              .tile_log2 = 15,
                              .codec = FF_CODEC_DEFLATE,
                              .flags = 3,
                              .texture_log2 = 8,
                              .texture_levels = 16,
                              .height_min = 1,
                              .height_max = 65535,
                              .max_error = 32767,
                              .tiles_x = 3,
                              .tiles_y = 2,
                              .samples_x = 98305,
                              .samples_y = 32770, /* the least of two tiles */
                              .spacing_wu = 21845,
                              .hscale_q24 = INT32_MAX,
                              .hoffset_wu = INT32_MIN,
                              .epsg = -1,
                              .origin_x_mm = INT64_MIN,
                              .origin_y_mm = INT64_MAX,
                              .curve_q60 = FF_CURVE_MAX,
                              .checksum = UINT32_MAX };
}

static ff_message get(enum ff_kind kind, ff_key key)
{
    return (ff_message){ .type = FF_MSG_GET, .kind = kind, .u.get = { .key = key } };
}

/* Every type, with fields at their ends. */
static size_t samples(ff_message *list)
{
    static uint8_t columns[4 * 64 + 8];
    static uint16_t top[64], bottom[64];
    static const uint32_t node_bytes[] = { 0, 1, 255, 256, 8191, 8192 };
    size_t n = 0;

    for (unsigned c = 0; c < 64; c++) bottom[c] = (uint16_t)(c % 50);
    uint32_t columns_bytes = (uint32_t)ff_face_columns_encode(top, bottom, 64, columns,
                                                              sizeof(columns));
    list[n++] = (ff_message){ .type = FF_MSG_HELLO, .u.hello = { UINT32_MAX, 0x01020304 } };
    list[n++] = get(FF_KIND_ROOT, ff_key_make(0, 0, 0));
    list[n++] = get(FF_KIND_REFINEMENT, ff_key_make(FF_KEY_TILES_MAX - 1, 14, 0xfffffff));
    list[n - 1].u.get.sides = 15;
    list[n++] = get(FF_KIND_TEXTURE, ff_key_make(FF_KEY_TILES_MAX - 1, 15, 0x3fffffff));
    list[n++] = get(FF_KIND_TEXTURE, ff_key_make(127, 3, 63));
    list[n++] = (ff_message){ .type = FF_MSG_GET,
                              .kind = FF_KIND_FACE,
                              .u.panorama = { 1,
                                              { INT32_MIN, INT32_MAX, -1 },
                                              0,
                                              INT32_MAX,
                                              FF_FACE_SIZE_MAX,
                                              100,
                                              6,
                                              { 5, 4, 3, 2, 1, 0 },
                                              0 } };
    list[n++] = (ff_message){ .type = FF_MSG_GET,
                              .kind = FF_KIND_FACE,
                              .u.panorama = { 2, { 0, 0, 0 }, 1, 2, 16, 1, 1, { 3 }, 0 } };
    list[n++] = (ff_message){ .type = FF_MSG_LAYER, .u.layer = { FF_LAYER_NONE } };
    list[n++] = (ff_message){ .type = FF_MSG_CANCEL, .u.cancel = { 65535 } };
    list[n++] = (ff_message){ .type = FF_MSG_PING, .u.ping = { UINT32_MAX } };
    list[n++] = (ff_message){ .type = FF_MSG_WELCOME,
                              .u.welcome = { FF_PROTOCOL_VERSION, terrain(), { NULL, 0 } } };
    list[n++] = (ff_message){ .type = FF_MSG_WELCOME,
                              .u.welcome = { FF_PROTOCOL_VERSION, terrain(),
                                             LIST("\3\2\x20\0\4\4\0\1\0\0\xff\1?") } };
    list[n++] =
        (ff_message){ .type = FF_MSG_WELCOME,
                      .u.welcome = { FF_PROTOCOL_VERSION, terrain(), LIST("\x08\4\6\0\0\0") } };
    list[n++] = (ff_message){ .type = FF_MSG_CAPS };
    list[n++] = (ff_message){ .type = FF_MSG_CAPS,
                              .u.list = LIST("\1\3\0\1\2\2\1#\3\2##\4\4\xf0\0\x40\1"
                                             "\5\x08\0\0\0\0\0\0\x10\0\6\4\3\0\0\0\xc8\0") };
    list[n++] = (ff_message){ .type = FF_MSG_GET_ABOUT, .u.get_about = { UINT32_MAX } };
    list[n++] = (ff_message){ .type = FF_MSG_GET_ABOUT, .u.get_about = { 3 } };
    list[n++] = (ff_message){ .type = FF_MSG_ABOUT };
    list[n++] = (ff_message){ .type = FF_MSG_ABOUT, .u.list = LIST("\1\5Hills\2\6nobody") };
    for (unsigned i = 0; i < sizeof node_bytes / sizeof *node_bytes; i++)
        list[n++] = (ff_message){ .type = FF_MSG_ANSWER,
                                  .kind = FF_KIND_ROOT,
                                  .u.data = { payload, node_bytes[i] } };
    list[n++] = (ff_message){ .type = FF_MSG_ANSWER,
                              .kind = FF_KIND_FACE,
                              .u.face = { 9, FF_FACE_DOWN, FF_FACE_LAST, 64, 15, 49, columns,
                                          columns_bytes, payload, 299 } };
    list[n++] =
        (ff_message){ .type = FF_MSG_ANSWER,
                      .kind = FF_KIND_FACE,
                      .u.face = { 9, FF_FACE_NORTH, FF_FACE_EMPTY, 1024, 0, 0, NULL, 0, NULL, 0 } };
    list[n++] = (ff_message){ .type = FF_MSG_FAILED, .u.failed = { 65535, -128 } };
    list[n++] = (ff_message){ .type = FF_MSG_CANCELLED, .u.cancel = { 1 } };
    list[n++] = (ff_message){ .type = FF_MSG_PONG, .u.ping = { 0 } };
    list[n++] = (ff_message){ .type = FF_MSG_GOODBYE, .u.failed = { 0, FF_ERR_FULL } };
    return n;
}

static void assert_bytes(const uint8_t *a, const uint8_t *b, uint32_t count)
{
    if (count > 0) assert_memory_equal(a, b, count);
}

static void assert_same_terrain(const ff_terrain_info *a, const ff_terrain_info *b)
{
    assert_int_equal(a->node_log2 << 24 | a->tile_log2 << 16 | a->codec << 8 | a->flags,
                     b->node_log2 << 24 | b->tile_log2 << 16 | b->codec << 8 | b->flags);
    assert_int_equal(a->texture_log2 << 8 | a->texture_levels,
                     b->texture_log2 << 8 | b->texture_levels);
    assert_int_equal(a->height_min, b->height_min);
    assert_int_equal(a->height_max, b->height_max);
    assert_int_equal(a->max_error, b->max_error);
    assert_int_equal(a->tiles_x, b->tiles_x);
    assert_int_equal(a->tiles_y, b->tiles_y);
    assert_int_equal(a->samples_x, b->samples_x);
    assert_int_equal(a->samples_y, b->samples_y);
    assert_int_equal(a->spacing_wu, b->spacing_wu);
    assert_int_equal(a->hscale_q24, b->hscale_q24);
    assert_int_equal(a->curve_q60, b->curve_q60);
    assert_int_equal(a->hoffset_wu, b->hoffset_wu);
    assert_int_equal(a->epsg, b->epsg);
    assert_true(a->origin_x_mm == b->origin_x_mm && a->origin_y_mm == b->origin_y_mm);
    assert_int_equal(a->checksum, b->checksum);
}

static void assert_same_list(const ff_list *a, const ff_list *b)
{
    assert_int_equal(a->byte_count, b->byte_count);
    assert_bytes(a->bytes, b->bytes, a->byte_count);
}

static void assert_same_face(const ff_face *a, const ff_face *b)
{
    assert_int_equal(a->id, b->id);
    assert_int_equal(a->face << 8 | a->flags, b->face << 8 | b->flags);
    assert_int_equal(a->face_size, b->face_size);
    assert_int_equal(a->top_row, b->top_row);
    assert_int_equal(a->row_count, b->row_count);
    assert_int_equal(a->columns_bytes, b->columns_bytes);
    assert_int_equal(a->image_bytes, b->image_bytes);
    assert_bytes(a->columns, b->columns, a->columns_bytes);
    assert_bytes(a->image, b->image, a->image_bytes);
}

static void assert_same_panorama(const ff_get_panorama *a, const ff_get_panorama *b)
{
    assert_int_equal(a->id, b->id);
    assert_memory_equal(a->position_wu, b->position_wu, sizeof(a->position_wu));
    assert_int_equal(a->front_wu, b->front_wu);
    assert_int_equal(a->back_wu, b->back_wu);
    assert_int_equal(a->face_size, b->face_size);
    assert_int_equal(a->quality, b->quality);
    assert_int_equal(a->face_count, b->face_count);
    assert_memory_equal(a->face, b->face, sizeof(a->face));
}

static void assert_same_get(const ff_message *a, const ff_message *b)
{
    assert_int_equal(a->kind, b->kind);
    if (ff_kind[a->kind].asks == FF_ASKS_PANORAMA) {
        assert_same_panorama(&a->u.panorama, &b->u.panorama);
    } else {
        assert_true(a->u.get.key == b->u.get.key);
        assert_int_equal(a->u.get.sides, b->u.get.sides);
    }
}

static void assert_same_answer(const ff_message *a, const ff_message *b)
{
    assert_int_equal(ff_kind[a->kind].answered_by, ff_kind[b->kind].answered_by);
    if (ff_kind[a->kind].brings == FF_BRINGS_FACE) {
        assert_same_face(&a->u.face, &b->u.face);
    } else {
        assert_int_equal(a->u.data.byte_count, b->u.data.byte_count);
        assert_bytes(a->u.data.bytes, b->u.data.bytes, a->u.data.byte_count);
    }
}

static void assert_same(const ff_message *a, const ff_message *b)
{
    assert_int_equal(a->type, b->type);
    switch (a->type) {
        case FF_MSG_HELLO:
            assert_int_equal(a->u.hello.version, b->u.hello.version);
            assert_int_equal(a->u.hello.known_checksum, b->u.hello.known_checksum);
            break;
        case FF_MSG_GET: assert_same_get(a, b); break;
        case FF_MSG_ANSWER: assert_same_answer(a, b); break;
        case FF_MSG_CANCEL:
        case FF_MSG_CANCELLED: assert_int_equal(a->u.cancel.id, b->u.cancel.id); break;
        case FF_MSG_PING:
        case FF_MSG_PONG: assert_int_equal(a->u.ping.stamp, b->u.ping.stamp); break;
        case FF_MSG_WELCOME:
            assert_int_equal(a->u.welcome.version, b->u.welcome.version);
            assert_same_terrain(&a->u.welcome.info, &b->u.welcome.info);
            assert_same_list(&a->u.welcome.more, &b->u.welcome.more);
            break;
        case FF_MSG_CAPS:
        case FF_MSG_ABOUT: assert_same_list(&a->u.list, &b->u.list); break;
        case FF_MSG_GET_ABOUT:
            assert_int_equal(a->u.get_about.entries, b->u.get_about.entries);
            break;
        default:
            assert_int_equal(a->u.failed.id, b->u.failed.id);
            assert_int_equal(a->u.failed.error, b->u.failed.error);
    }
}

/* A row of the list is told apart from all others by its bytes alone. */
static void every_kind_has_its_own_bytes(void **state)
{
    enum ff_kind kind;
    (void)state;
    for (unsigned a = 0; a < FF_KIND_COUNT; a++) {
        assert_true(ff_message_from_client(ff_kind[a].asked_by));
        assert_false(ff_message_from_client(ff_kind[a].answered_by));
        assert_int_equal(ff_message_type_of(ff_kind[a].asked_by, &kind), FF_MSG_GET);
        assert_int_equal(ff_message_type_of(ff_kind[a].answered_by, &kind), FF_MSG_ANSWER);
        for (unsigned b = 0; b < a; b++) {
            assert_true(ff_kind[a].asked_by != ff_kind[b].asked_by ||
                        ff_kind[a].what != ff_kind[b].what);
            assert_true(!ff_kind[a].section || ff_kind[a].section != ff_kind[b].section);
            if (ff_kind[a].asked_by == ff_kind[b].asked_by)
                assert_int_equal(ff_kind[a].asks, ff_kind[b].asks);
            if (ff_kind[a].answered_by == ff_kind[b].answered_by)
                assert_int_equal(ff_kind[a].brings, ff_kind[b].brings);
        }
    }
}

static void first_bytes_are_those_of_the_specification(void **state)
{
    static const struct {
        uint8_t first, last;
    } client[] = { { 1, 1 }, { 4, 11 }, { 128, 223 } },
      server[] = { { 65, 65 }, { 68, 76 }, { 80, 127 }, { 224, 255 } };
    (void)state;
    for (unsigned byte = 0; byte < 256; byte++) {
        enum ff_kind kind;
        int from_server = 0, from_client = byte == ff_kind[FF_KIND_COUNT - 1].asked_by; /* new? */
        for (unsigned i = 0; i < 3; i++)
            from_client |= byte >= client[i].first && byte <= client[i].last;
        for (unsigned i = 0; i < 4; i++)
            from_server |= byte >= server[i].first && byte <= server[i].last;
        assert_int_equal(ff_message_from_client((uint8_t)byte), from_client);
        assert_int_equal(ff_message_type_of((uint8_t)byte, &kind) != 0, from_client || from_server);
    }
}

static void there_and_back_in_exact_room(void **state)
{
    ff_message list[32], again;
    size_t count = samples(list);

    (void)state;
    for (size_t i = 0; i < count; i++) {
        uint8_t bytes[8256];
        int used = ff_message_encode(&list[i], bytes, sizeof(bytes));
        assert_in_range(used, 2, ff_message_bytes_max(&list[i]));
        if (ff_message_from_client(bytes[0]) && list[i].type != FF_MSG_CAPS)
            assert_in_range(used, 2, FF_REQUEST_BYTES_MAX);
        assert_int_equal(ff_message_decode(bytes, (size_t)used, &again), used);
        assert_same(&list[i], &again);
        for (int room = 0; room <= used; room++) {
            uint8_t *exact = malloc(room > 0 ? (size_t)room : 1);
            assert_int_equal(ff_message_encode(&list[i], exact, (size_t)room),
                             room < used ? FF_ERR_FULL : used);
            free(exact);
        }
    }
}

/* What is said most often: a node and its tile, and what is before a payload. */
static void what_is_said_most_often_is_short(void **state)
{
    static const struct {
        ff_message message;
        int bytes;
    } list[] = {
        { { .type = FF_MSG_GET, .kind = FF_KIND_REFINEMENT, .u.get = { 5ull << 32 | 1023, 15 } },
          3 },
        { { .type = FF_MSG_GET, .kind = FF_KIND_TEXTURE, .u.get = { 5ull << 36 | 3ull << 32, 0 } },
          3 },
        { { .type = FF_MSG_ANSWER, .kind = FF_KIND_ROOT, .u.data = { payload, 8191 } }, 8193 },
        { { .type = FF_MSG_ANSWER, .kind = FF_KIND_VIEW, .u.part = { 15, payload, 127, 0 } }, 129 },
        { { .type = FF_MSG_ANSWER, .kind = FF_KIND_VIEW, .u.part = { 0, payload, 128, 0 } }, 131 },
        { { .type = FF_MSG_ANSWER, .kind = FF_KIND_VIEW, .u.part = { 0, NULL, 0, 16 } }, 1 },
    };
    uint8_t bytes[8256];
    (void)state;
    for (unsigned i = 0; i < sizeof list / sizeof *list; i++)
        assert_int_equal(ff_message_encode(&list[i].message, bytes, sizeof bytes), list[i].bytes);
}

static size_t stream_of_samples(uint8_t *stream, ff_message *list, size_t *message_count)
{
    size_t bytes = 0;

    *message_count = samples(list);
    for (size_t i = 0; i < *message_count; i++)
        bytes += (size_t)ff_message_encode(&list[i], stream + bytes, STREAM_MAX - bytes);
    return bytes;
}

/* However the stream is cut into pieces, the same messages come out. */
static void splitting_changes_nothing(void **state)
{
    static uint8_t stream[STREAM_MAX];
    ff_message list[32], out;
    size_t count, bytes = stream_of_samples(stream, list, &count);

    (void)state;
    for (size_t first = 0; first <= bytes; first++) {
        size_t at = 0, seen = 0, here = first;
        while (at < bytes) {
            int used = ff_message_decode(stream + at, here - at, &out);
            assert_true(used >= 0);
            if (used == 0) {
                assert_true(here < bytes);
                here = bytes;
                continue;
            }
            assert_same(&list[seen++], &out);
            at += (size_t)used;
        }
        assert_int_equal(seen, count);
    }
}

static void cut_messages_wait(void **state)
{
    ff_message list[32], out;
    size_t count = samples(list);

    (void)state;
    for (size_t i = 0; i < count; i++) {
        uint8_t bytes[8256];
        int used = ff_message_encode(&list[i], bytes, sizeof(bytes));
        for (int cut = 0; cut < used; cut++) {
            uint8_t *exact = malloc(cut > 0 ? (size_t)cut : 1);
            memcpy(exact, bytes, (size_t)cut);
            assert_int_equal(ff_message_decode(exact, (size_t)cut, &out), 0);
            free(exact);
        }
    }
}

/* A body shorter or longer than its fields is an error, not a wait. */
static void bodies_of_wrong_length_are_errors(void **state)
{
    ff_message list[32], out;
    size_t count = samples(list);

    (void)state;
    for (size_t i = 0; i < count; i++) {
        uint8_t bytes[8256] = { 0 }, shorter[8256] = { 0 };
        int used = ff_message_encode(&list[i], bytes, sizeof(bytes) - 1);
        int header = bytes[1] < 128 ? 2 : 3;
        int open_ended = list[i].type == FF_MSG_ANSWER || list[i].type == FF_MSG_CAPS ||
                         list[i].type == FF_MSG_ABOUT ||
                         bytes[0] >= 80 || /* of a form of its own */
                         (list[i].type == FF_MSG_WELCOME && list[i].u.welcome.more.byte_count);
        if (bytes[1] >= 127 || bytes[1] == 0 || open_ended) continue;
        bytes[1]++;
        assert_true(ff_message_decode(bytes, (size_t)used + 1, &out) < 0);
        for (int body = used - header - 1; body >= 0; body--) {
            memcpy(shorter, bytes, (size_t)used);
            shorter[1] = (uint8_t)body;
            assert_true(ff_message_decode(shorter, (size_t)(header + body), &out) < 0);
        }
    }
}

static void flipped_bits_do_no_harm(void **state)
{
    static uint8_t stream[STREAM_MAX], again[STREAM_MAX];
    static uint16_t top[FF_FACE_SIZE_MAX], bottom[FF_FACE_SIZE_MAX];
    ff_message list[32], out;
    size_t count, bytes = stream_of_samples(stream, list, &count);

    (void)state;
    for (size_t bit = 0; bit < 8 * bytes; bit++) {
        int used = 1;
        stream[bit / 8] ^= (uint8_t)(1u << bit % 8);
        for (size_t at = 0; at < bytes && used > 0; at += (size_t)used) {
            used = ff_message_decode(stream + at, bytes - at, &out);
            if (used <= 0) break;
            assert_int_equal(ff_message_encode(&out, again, sizeof(again)), used);
            assert_memory_equal(again, stream + at, (size_t)used);
            if (out.type == FF_MSG_ANSWER && out.kind == FF_KIND_FACE &&
                out.u.face.columns_bytes > 0)
                ff_face_columns_decode(out.u.face.columns, out.u.face.columns_bytes,
                                       out.u.face.face_size, out.u.face.row_count, top, bottom);
        }
        stream[bit / 8] ^= (uint8_t)(1u << bit % 8);
    }
}

static void assert_decode(const char *bytes, size_t count, int expected)
{
    ff_message out;

    assert_int_equal(ff_message_decode((const uint8_t *)bytes, count, &out), expected);
}

static void lengths_and_headers(void **state)
{
    (void)state;
    assert_decode("", 0, 0);
    assert_decode("\x00\x00", 2, FF_ERR_FORMAT);
    assert_decode("\x40", 1, FF_ERR_FORMAT);
    assert_decode("\x4f", 1, FF_ERR_FORMAT);
    assert_decode("\x02", 1, FF_ERR_FORMAT);                /* version 7's */
    assert_decode("\x49\x81\x80\x10", 4, FF_ERR_RANGE);     /* 2^18 + 1 bytes */
    assert_decode("\x49\x80\x80\x10", 4, 0);                /* 2^18 bytes may come */
    assert_decode("\x49\xff\xff\xff", 4, FF_ERR_RANGE);     /* a fourth length byte */
    assert_decode("\x05\x82\x00\x01\x02", 5, FF_ERR_RANGE); /* overlong */
    assert_decode("\x01\x0c"
                  "HTTP12345678",
                  14, FF_ERR_FORMAT);
    assert_decode("\xc0\x80\x80\x80\x80\x01\x00", 7, FF_ERR_RANGE); /* tile 2^28 */
    assert_decode("\xc0\x00\x00", 3, FF_ERR_RANGE);                 /* tile 0 is not said */
    assert_decode("\x81\x00", 2, FF_ERR_RANGE);                     /* a root of level 1 */
    assert_decode("\x92\x80\x02", 3, FF_ERR_RANGE);                 /* no such code at level 2 */
    assert_decode("\x50\xff\x1f", 3, FF_ERR_RANGE);                 /* has a shorter form */
    assert_decode("\x54\x01\x00", 3, FF_ERR_RANGE);                 /* 2^18 + 1 bytes */
    assert_decode("\xe1\x00", 2, FF_ERR_RANGE);                     /* nothing, and more below it */
    assert_decode("\x41\x04\x03\x00\x00\x00", 6, FF_ERR_VERSION);   /* older */
    assert_decode("\x9f\x00", 2, FF_ERR_RANGE);                     /* below the last level */
    assert_decode("\x41\x01\x0c", 3, FF_ERR_VERSION);               /* newer */
    uint8_t old[76] = { 0x41, 74, 8 }; /* a whole WELCOME of version 8 */
    assert_decode((const char *)old, sizeof old, FF_ERR_VERSION);
}

static void ranges_hold_both_ways(void **state)
{
    static const ff_get_panorama good = { 1, { 0, 0, 0 }, 100, 200, 256, 70, 2, { 0, 1 }, 0 };
    ff_message m = { .type = FF_MSG_GET, .kind = FF_KIND_FACE };
    uint8_t bytes[512];

    (void)state;
#define BAD(member, assignment) \
    m.u.member = good_##member; \
    m.u.member.assignment;      \
    assert_int_equal(ff_message_encode(&m, bytes, sizeof(bytes)), FF_ERR_RANGE)
#define good_panorama good
    BAD(panorama, front_wu = -1);
    BAD(panorama, front_wu = 200);
    BAD(panorama, face_size = 15);
    BAD(panorama, face_size = 1025);
    BAD(panorama, quality = 0);
    BAD(panorama, quality = 101);
    BAD(panorama, face_count = 0);
    BAD(panorama, face_count = 7);
    BAD(panorama, face[1] = 0);
    BAD(panorama, face[1] = 6);
    static const ff_face good_face = { 1, 0, 0, 64, 10, 54, payload, 5, payload, 5 };
    m.type = FF_MSG_ANSWER;
    BAD(face, face = 6);
    BAD(face, flags = 4);
    BAD(face, flags = FF_FACE_EMPTY);
    BAD(face, top_row = 11);
    BAD(face, row_count = 0);
    BAD(face, columns_bytes = 0);
    BAD(face, image_bytes = 0);
    BAD(face, face_size = 2000);
    static const ff_get good_get = { 0 };
    m.type = FF_MSG_GET;
    m.kind = FF_KIND_REFINEMENT;
    BAD(get, key = ff_key_make(0, 2, 16));
    BAD(get, key = ff_key_make(0, 15, 0));
    BAD(get, sides = 16);
    m.kind = FF_KIND_ROOT;
    BAD(get, key = ff_key_make(0, 1, 0));
    BAD(get, sides = 1);
    static const ff_failed good_failed = { 0, -1 };
    m.type = FF_MSG_GOODBYE;
    BAD(failed, id = 1);
    BAD(failed, error = 0);
    static const ff_data good_data = { payload, 1 };
    static uint8_t room[FF_MESSAGE_BODY_MAX + 16];
    m.type = FF_MSG_ANSWER;
    m.kind = FF_KIND_REFINEMENT;
    m.u.data = good_data;
    m.u.data.bytes = calloc(1, FF_MESSAGE_BODY_MAX + 1);
    m.u.data.byte_count = FF_MESSAGE_BODY_MAX;
    assert_int_equal(ff_message_encode(&m, room, sizeof(room)), FF_MESSAGE_BODY_MAX + 3);
    m.u.data.byte_count++;
    assert_int_equal(ff_message_encode(&m, room, sizeof(room)), FF_ERR_RANGE);
    free((void *)(uintptr_t)m.u.data.bytes);
#undef BAD
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(there_and_back_in_exact_room),
        cmocka_unit_test(every_kind_has_its_own_bytes),
        cmocka_unit_test(first_bytes_are_those_of_the_specification),
        cmocka_unit_test(what_is_said_most_often_is_short),
        cmocka_unit_test(splitting_changes_nothing),
        cmocka_unit_test(cut_messages_wait),
        cmocka_unit_test(bodies_of_wrong_length_are_errors),
        cmocka_unit_test(flipped_bits_do_no_harm),
        cmocka_unit_test(lengths_and_headers),
        cmocka_unit_test(ranges_hold_both_ways),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
