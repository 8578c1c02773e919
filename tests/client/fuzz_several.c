/* A client with a pack and two servers that tell and answer anything: grounds at the ends of what
 * numbers hold, others at each connection, parts of each other or not, answers that belong to other
 * requests. Input: the client's settings in a byte, then steps of a byte each: what in the three
 * lowest bits, who in the next, an amount n in the rest; some take more bytes.
 *   0 a WELCOME of n & 3 + 1 grounds, 4 bytes each; 1 time passes; 2 the camera goes n * 2^k
 *   metres; 3 what is asked is answered with what the pack has, or 4 with another record, refused,
 *   or not at all; 5 a part of a view, of any key; 6 the connection ends; 7 the next n bytes as
 * they are. */
#include "../rig/pack_fixture.h"
#include "../../client/farfield.h"
#include "../../protocol/message/ff_message.h"
#include "../../protocol/shape/ff_shape.h"

#include <stdlib.h>
#include <string.h>

#define MEMORY_BYTES (2u << 20)
#define WAITING_MAX  16

typedef struct server {
    sys_stream stream;
    uint8_t out[1 << 16]; /* to the client */
    size_t out_count;
    int on;
    struct {
        uint16_t id;
        uint8_t kind;
        ff_key key;
    } waiting[WAITING_MAX];
    unsigned waiting_count;
} server;

typedef struct input {
    const uint8_t *at, *end;
} input;

static unsigned next(input *in) { return in->at < in->end ? *in->at++ : 0; }

static const ff_pack *the_pack(void)
{
    static ff_pack pack;
    static uint8_t *bytes;
    static const uint8_t about[] = { FF_ABOUT_WHOLE, 4, 1, 0, 0, 0 };
    if (!bytes) {
        pack_fixture_desc desc = { .info = pack_fixture_info(5, 2, 2),
                                   .height = pack_fixture_hills,
                                   .stub_level = 1,
                                   .about = { about, sizeof about } };
        size_t size;
        desc.info.epsg = 32632;
        bytes = pack_fixture_make(&desc, &size);
        if (!bytes || ff_pack_open(&pack, bytes, size) != FF_OK) abort();
    }
    return &pack;
}

/* ---- the servers' end ---- */

static void say(server *s, const ff_message *message)
{
    int count = ff_message_encode(message, s->out + s->out_count, sizeof s->out - s->out_count);
    if (count > 0) s->out_count += (size_t)count;
}

static void note(server *s, const ff_message *message)
{
    if (message->type != FF_MSG_GET || s->waiting_count == WAITING_MAX) return;
    s->waiting[s->waiting_count].id = ff_message_id(message);
    s->waiting[s->waiting_count].kind = (uint8_t)message->kind;
    s->waiting[s->waiting_count++].key = ff_kind[message->kind].asks == FF_ASKS_NODE
                                             ? message->u.get.key
                                         : ff_kind[message->kind].asks == FF_ASKS_VIEW
                                             ? message->u.view.below[0]
                                             : 0;
}

static int send_to(void *state, const uint8_t *bytes, size_t count)
{
    server *s = state;
    ff_message message;
    if (!s->on) return FF_ERR_CLOSED;
    for (size_t at = 0; at < count;) {
        int used = ff_message_decode(bytes + at, count - at, &message);
        if (used <= 0) abort(); /* the client says whole and true messages only */
        note(s, &message);
        at += (size_t)used;
    }
    return (int)count;
}

static int receive_from(void *state, uint8_t *bytes, size_t capacity)
{
    server *s = state;
    if (!s->on) return FF_ERR_CLOSED;
    size_t count = s->out_count < capacity ? s->out_count : capacity;
    memcpy(bytes, s->out, count);
    s->out_count -= count;
    memmove(s->out, s->out + count, s->out_count);
    return (int)count;
}

static void end(void *state)
{
    server *s = state;
    s->on = 0;
    s->out_count = s->waiting_count = 0;
}

static int begin(void *state)
{
    server *s = state;
    s->on = 1;
    return FF_OK;
}

static ff_terrain_info any_terrain(input *in)
{
    static const int64_t place_mm[] = { 0,          1000,      -4096000,   992000,
                                        INT64_MIN,  INT64_MAX, 7999999999, -8000000000,
                                        2048000000, 500,       1,          -1 };
    const size_t places = sizeof place_mm / sizeof *place_mm;
    ff_terrain_info info = the_pack()->header.info;
    unsigned shape = next(in), east = next(in), north = next(in), other = next(in);
    info.origin_x_mm = place_mm[east % places];
    info.origin_y_mm = place_mm[north % places];
    info.checksum = other & 1 ? info.checksum : other;
    if (shape & 1) info.spacing_wu >>= shape >> 4 & 7;
    if (shape & 2) info.tile_log2 = (uint8_t)(3 + (shape >> 4));
    if (shape & 4) info.tiles_x = 1u << (shape >> 4) * 2;
    if (shape & 8) info.spacing_wu = 1 + (shape >> 4);
    info.samples_x = (info.tiles_x << info.tile_log2) + (other & 2 ? 1 : 0);
    info.samples_y = (info.tiles_y << info.tile_log2) + 1;
    if (other & 4) info.epsg = other & 8 ? 0 : 32633;
    if (other & 16) info.max_error = 3;
    if (other & 32) info.hoffset_wu = other & 64 ? 1000000 : -1000;
    if (other & 128) {
        info.texture_log2 = 4;
        info.texture_levels = 2;
    }
    return info;
}

static void welcome(server *s, input *in, unsigned grounds)
{
    uint8_t list[FF_CAPS_BYTES_MAX], whole[4 * FF_WELCOME_GROUNDS] = { 0 },
                                               terrains[FF_TERRAIN_BYTES * FF_WELCOME_GROUNDS];
    ff_writer out = { list, list + sizeof list, FF_OK },
              row = { terrains, terrains + sizeof terrains, FF_OK };
    ff_message message = { .type = FF_MSG_WELCOME };
    message.u.welcome.version = FF_PROTOCOL_VERSION;
    message.u.welcome.info = any_terrain(in);
    for (unsigned i = 1; i < grounds; i++) {
        ff_terrain_info info = any_terrain(in);
        ff_write_terrain(&row, &info);
    }
    for (unsigned i = 0; i < grounds; i++) whole[4 * i] = (uint8_t)(next(in) & 3);
    ff_list_write(&out, FF_WELCOME_WHOLE, whole, 4 * grounds);
    if (grounds > 1)
        ff_list_write(&out, FF_WELCOME_TERRAINS, terrains, (uint32_t)(row.at - terrains));
    message.u.welcome.more = (ff_list){ list, (uint32_t)(out.at - list) };
    say(s, &message);
}

static void say_payload(server *s, ff_key key, enum ff_kind kind, ff_message *message)
{
    enum ff_section_kind section = (enum ff_section_kind)ff_kind[kind].section;
    const ff_terrain_info *info = &the_pack()->header.info;
    key = ff_key_make(ff_key_tile(key) % ff_shape_tiles(info), ff_key_level(key), ff_key_code(key));
    const uint8_t *bytes = (const uint8_t *)"\3";
    int count = section && ff_key_level(key) < 4 ? ff_pack_record(the_pack(), section, key, &bytes)
                                                 : 1;
    if (count < 1) count = 1, bytes = (const uint8_t *)"\3";
    if (message->kind == FF_KIND_VIEW) {
        message->u.part.bytes = bytes;
        message->u.part.byte_count = (uint32_t)count;
    } else {
        message->u.data.bytes = bytes;
        message->u.data.byte_count = (uint32_t)count;
    }
    say(s, message);
}

static void answer(server *s, unsigned amount, int rightly)
{
    if (!s->waiting_count) return;
    unsigned i = amount % s->waiting_count;
    if (rightly && ff_kind[s->waiting[i].kind].asks == FF_ASKS_NODE) /* in their order */
        for (i = 0; ff_kind[s->waiting[i].kind].asks != FF_ASKS_NODE;) i++;
    enum ff_kind kind = (enum ff_kind)s->waiting[i].kind;
    ff_key key = s->waiting[i].key;
    ff_message message = { .type = FF_MSG_FAILED };
    message.u.failed = (ff_failed){ s->waiting[i].id,
                                    amount & 8 ? FF_ERR_NOT_FOUND : FF_ERR_SYSTEM };
    memmove(&s->waiting[i], &s->waiting[i + 1], (--s->waiting_count - i) * sizeof s->waiting[i]);
    if (!rightly && amount & 4) {
        say(s, &message);
        return;
    }
    uint16_t id = message.u.failed.id;
    message.type = FF_MSG_ANSWER;
    message.kind = kind;
    if (ff_kind[kind].brings == FF_BRINGS_PARTS) {
        message.u.part = (ff_part){ .later = (uint8_t)(rightly ? 0 : amount) };
        say(s, &message);
    } else if (ff_kind[kind].brings == FF_BRINGS_FACE) {
        message.u.face = (ff_face){ .id = id,
                                    .face_size = 256,
                                    .face = (uint8_t)(amount % FF_FACE_COUNT),
                                    .flags = FF_FACE_EMPTY | (amount & 1 ? FF_FACE_LAST : 0) };
        say(s, &message);
    } else {
        say_payload(s, rightly ? key : key + amount, kind, &message);
    }
}

static void part(server *s, input *in, unsigned amount)
{
    for (unsigned i = 0; i < s->waiting_count; i++) {
        if (s->waiting[i].kind != FF_KIND_VIEW) continue;
        ff_message message = { .type = FF_MSG_ANSWER, .kind = FF_KIND_VIEW };
        unsigned tile = next(in), what = next(in), level = what >> 1 & 3, root = what & 1;
        if (root) level = 0;
        const uint8_t tiles[2] = { (uint8_t)(tile & 127), (uint8_t)(what & 127) };
        ff_key key = amount & 1 ? s->waiting[i].key
                                : ff_key_make(amount & 2 ? tile : tile << 20, level,
                                              (what >> 3) & ((1u << 2 * level) - 1));
        message.u.part.below = (uint8_t)(amount >> 2 & 3);
        if (what >> 7)
            say(s, &(ff_message){ .type = FF_MSG_ROOTS, .u.roots = { tiles, 1 + (amount & 1) } });
        else
            say_payload(s, key, root ? FF_KIND_ROOT : FF_KIND_REFINEMENT, &message);
        return;
    }
}

/* ---- the client's end ---- */

static void run(ff_client *client, server servers[2], input *in)
{
    int64_t now_us = 1000000;
    c3d_camera camera = { .pos_wu = { 100000, 100000, 300000 },
                          .pitch = -2500,
                          .width = 240,
                          .height = 320,
                          .focal_q8 = 208 * 256 };
    while (in->at < in->end) {
        unsigned step = next(in), amount = step >> 4;
        int32_t *axis_wu = &camera.pos_wu[step >> 3 & 1];
        server *s = &servers[step >> 3 & 1];
        switch (step & 7) {
            case 0: welcome(s, in, (amount & 3) + 1); break;
            case 1: now_us += (int64_t)amount * amount * 100000; break;
            case 2:
                /* after many such steps round to the other end */
                *axis_wu = (int32_t)((uint32_t)*axis_wu + ((next(in) - 128u) << (amount + 4)));
                camera.yaw += (int32_t)amount << 12;
                break;
            case 3: answer(s, amount, 1); break;
            case 4: answer(s, amount, 0); break;
            case 5: part(s, in, amount); break;
            case 6: end(s); break;
            default:
                for (unsigned i = 0; i < amount && s->out_count < sizeof s->out; i++)
                    s->out[s->out_count++] = (uint8_t)next(in);
        }
        ff_client_work(client, now_us += 10000);
        ff_client_update(client, now_us, &camera);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    static server servers[2];
    static uint8_t memory[MEMORY_BYTES];
    input in = { bytes, bytes + count };
    unsigned how = next(&in);
    ff_source_desc more[2];
    ff_client_desc desc = { .memory = memory, .memory_bytes = sizeof memory, .more = more };
    ff_client *client;
    for (int i = 0; i < 2; i++) {
        memset(&servers[i], 0, sizeof servers[i]);
        servers[i].on = 1;
        servers[i].stream = (sys_stream){ &servers[i], send_to, receive_from, end, begin };
    }
    more[0] = (ff_source_desc){ .stream = &servers[1].stream };
    more[1] = (ff_source_desc){ .pack = the_pack() };
    desc.more_count = how & 1 ? 2 : 1;
    desc.panorama.enabled = how & 2 ? FF_PANORAMA_ON : FF_PANORAMA_OFF;
    desc.no_views = how >> 2 & 1;
    desc.place_known = how >> 3 & 1;
    if (how & 16) {
        more[1] = (ff_source_desc){ .stream = &servers[0].stream };
        desc.pack = the_pack();
        desc.more_count = 2;
    } else {
        desc.stream = &servers[0].stream;
    }
    if (ff_client_create(&desc, &client) != FF_OK) abort();
    run(client, servers, &in);
    ff_client_destroy(client);
    return 0;
}
