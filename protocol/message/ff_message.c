/* Messages: one field list a type, each with its range; see SPEC.md, "Messages". */
#include "ff_message_local.h"

#include <string.h>

static const uint8_t hello_magic[4] = { 'F', 'F', 'L', 'D' };

/* GET_PANORAMA: id, position, front and back, size, quality, count. */
#define PANORAMA_BYTES (2 + 3 * 4 + 2 * 4 + 2 + 1 + 1)
FF_STATIC_ASSERT(FF_MESSAGE_HEADER_MAX + PANORAMA_BYTES + FF_FACE_COUNT <= FF_SHORT_BYTES_MAX);
FF_STATIC_ASSERT(FF_ERR_LAST >= INT8_MIN); /* as FAILED has it */

/* ---- lists ---- */

#define X(entry, type, least, most) { type, least, most },
static const ff_list_rule caps_rule[] = { FF_CAPS_LIST(X) };
static const ff_list_rule welcome_rule[] = { FF_WELCOME_LIST(X) };
#undef X

static int check_list(ff_list list, uint32_t most, const ff_list_rule *rule, size_t rules)
{
    return list.byte_count > most ? FF_ERR_RANGE : ff_list_check(list, rule, (unsigned)rules);
}

static int check_caps(ff_list list)
{
    return check_list(list, FF_CAPS_BYTES_MAX, caps_rule, sizeof caps_rule / sizeof *caps_rule);
}

static void write_list(ff_writer *out, ff_list list, int check)
{
    ff_message_require(&out->error, check == FF_OK);
    ff_write_span(out, list.bytes, list.byte_count);
}

/* ---- what forms share ---- */

int ff_message_get_ok(const ff_get *get, enum ff_kind kind)
{
    uint32_t level = ff_key_level(get->key);

    FF_ASSERT(ff_kind[kind].asks == FF_ASKS_NODE);
    if (kind != FF_KIND_REFINEMENT && get->sides) return 0;
    return (uint64_t)ff_key_code(get->key) >> (2 * level) == 0 &&
           (kind != FF_KIND_ROOT || level == 0) && get->sides >> FF_SIDE_COUNT == 0 &&
           (kind != FF_KIND_REFINEMENT || level < FF_KEY_LEVEL_MAX);
}

void ff_message_write_key(ff_writer *out, uint32_t what, ff_key key)
{
    ff_write_bytes(out, what | ff_key_level(key) << 4, 1);
    ff_write_varint(out, ff_key_tile(key));
    ff_write_varint(out, ff_key_code(key));
}

/* Behind the byte of what it is of and its level. */
ff_key ff_message_read_key(ff_reader *in, uint32_t form)
{
    uint32_t tile = ff_read_varint(in), code = ff_read_varint(in);

    ff_message_require(&in->error, tile < FF_KEY_TILES_MAX);
    return ff_key_make(tile, form >> 4, code);
}

void ff_message_read_rest(ff_reader *in, const uint8_t **bytes, uint32_t *count)
{
    FF_ASSERT(in->end - in->at <= FF_MESSAGE_BODY_MAX);
    *count = (uint32_t)(in->end - in->at);
    *bytes = ff_read_span(in, *count);
}

/* ---- ranges, the same for both directions ---- */

static int panorama_ok(const ff_get_panorama *panorama)
{
    unsigned seen = 0;

    if (panorama->front_wu < 0 || panorama->back_wu <= panorama->front_wu ||
        panorama->face_size < 16 || panorama->face_size > FF_FACE_SIZE_MAX ||
        panorama->quality < 1 || panorama->quality > 100 || panorama->face_count < 1 ||
        panorama->face_count > FF_FACE_COUNT)
        return 0;
    for (unsigned i = 0; i < panorama->face_count; i++) {
        if (panorama->face[i] >= FF_FACE_COUNT || (seen >> panorama->face[i] & 1u)) return 0;
        seen |= 1u << panorama->face[i];
    }
    return 1;
}

static int face_ok(const ff_face *face)
{
    int empty = (face->flags & FF_FACE_EMPTY) != 0;

    if (face->face >= FF_FACE_COUNT || (face->flags & ~(FF_FACE_EMPTY | FF_FACE_LAST)) != 0 ||
        face->face_size < 16 || face->face_size > FF_FACE_SIZE_MAX ||
        (uint32_t)face->top_row + face->row_count > face->face_size)
        return 0;
    return empty ? face->top_row == 0 && face->row_count == 0 && face->columns_bytes == 0 &&
                       face->image_bytes == 0
                 : face->row_count > 0 && face->columns_bytes > 0 && face->image_bytes > 0;
}

/* ---- encode ---- */

static void write_panorama(ff_writer *out, const ff_get_panorama *panorama)
{
    ff_message_require(&out->error, panorama_ok(panorama));
    ff_write_bytes(out, panorama->id, 2);
    for (int axis = 0; axis < 3; axis++)
        ff_write_bytes(out, (uint32_t)panorama->position_wu[axis], 4);
    ff_write_bytes(out, (uint32_t)panorama->front_wu, 4);
    ff_write_bytes(out, (uint32_t)panorama->back_wu, 4);
    ff_write_bytes(out, panorama->face_size, 2);
    ff_write_bytes(out, panorama->quality, 1);
    ff_write_bytes(out, panorama->face_count, 1);
    if (out->error == FF_OK) ff_write_span(out, panorama->face, panorama->face_count);
}

static void write_face(ff_writer *out, const ff_face *face)
{
    ff_message_require(&out->error, face_ok(face));
    ff_write_bytes(out, face->id, 2);
    ff_write_bytes(out, face->face | (uint32_t)face->flags << 4, 1);
    ff_write_bytes(out, face->face_size, 2);
    if (face->flags & FF_FACE_EMPTY) return;
    ff_write_bytes(out, face->top_row, 2);
    ff_write_bytes(out, face->row_count, 2);
    ff_write_varint(out, face->columns_bytes);
    ff_write_span(out, face->columns, face->columns_bytes);
    ff_write_span(out, face->image, face->image_bytes);
}

static void write_failed(ff_writer *out, const ff_failed *failed, enum ff_message_type type)
{
    ff_message_require(&out->error,
                       failed->error < 0 && (type == FF_MSG_FAILED || failed->id == 0));
    ff_write_bytes(out, failed->id, 2);
    ff_write_bytes(out, (uint8_t)failed->error, 1);
}

static void write_welcome(ff_writer *out, const ff_welcome *welcome)
{
    ff_message_require(&out->error, welcome->version == FF_PROTOCOL_VERSION &&
                                        ff_terrain_check(&welcome->info) == FF_OK);
    ff_write_varint(out, welcome->version);
    ff_message_write_terrain(out, &welcome->info);
    ff_write_span(out, welcome->more.bytes, welcome->more.byte_count);
}

/* A varint each, of tiles. */
static int roots_ok(const ff_roots *roots)
{
    ff_reader in = { roots->bytes, roots->bytes + roots->byte_count, FF_OK };
    unsigned count = 0;

    while (in.error == FF_OK && in.at < in.end) {
        ff_message_require(&in.error, ff_read_varint(&in) < FF_KEY_TILES_MAX);
        count++;
    }
    return in.error == FF_OK && count <= FF_PARTS_MAX;
}

static void write_roots(ff_writer *out, const ff_roots *roots)
{
    ff_message_require(&out->error, roots_ok(roots));
    ff_write_span(out, roots->bytes, roots->byte_count);
}

/* Kinds without a short form. */
static void write_get(ff_writer *out, const ff_get *get, enum ff_kind kind)
{
    ff_message_require(&out->error, ff_message_get_ok(get, kind));
    ff_message_write_key(out, 0, get->key);
}

static void write_request(ff_writer *out, const ff_message *message)
{
    FF_ASSERT((unsigned)message->kind < FF_KIND_COUNT);
    switch ((enum ff_kind_asks)ff_kind[message->kind].asks) {
        case FF_ASKS_NODE: write_get(out, &message->u.get, message->kind); break;
        case FF_ASKS_VIEW: ff_message_write_view(out, &message->u.view); break;
        case FF_ASKS_PANORAMA: write_panorama(out, &message->u.panorama); break;
        case FF_ASKS_FAR: ff_message_write_get_far(out, &message->u.get_far); break;
    }
}

static void write_answer(ff_writer *out, const ff_message *message)
{
    FF_ASSERT((unsigned)message->kind < FF_KIND_COUNT);
    switch ((enum ff_kind_brings)ff_kind[message->kind].brings) {
        case FF_BRINGS_PAYLOAD:
        case FF_BRINGS_PARTS: ff_message_require(&out->error, 0); break; /* they have short forms */
        case FF_BRINGS_FACE: write_face(out, &message->u.face); break;
        case FF_BRINGS_FAR: ff_message_write_far(out, &message->u.far); break;
    }
}

static void write_body(ff_writer *out, const ff_message *message)
{
    switch (message->type) {
        case FF_MSG_HELLO:
            ff_write_span(out, hello_magic, sizeof(hello_magic));
            ff_write_bytes(out, message->u.hello.version, 4);
            ff_write_bytes(out, message->u.hello.known_checksum, 4);
            break;
        case FF_MSG_GET: write_request(out, message); break;
        case FF_MSG_ANSWER: write_answer(out, message); break;
        case FF_MSG_CANCEL:
        case FF_MSG_CANCELLED: ff_write_bytes(out, message->u.cancel.id, 2); break;
        case FF_MSG_PING:
        case FF_MSG_PONG: ff_write_bytes(out, message->u.ping.stamp, 4); break;
        case FF_MSG_CAPS: write_list(out, message->u.list, check_caps(message->u.list)); break;
        case FF_MSG_ABOUT: write_list(out, message->u.list, ff_about_check(message->u.list)); break;
        case FF_MSG_LAYER:
            ff_message_require(&out->error, message->u.layer.layer <= FF_LAYER_NONE);
            ff_write_bytes(out, message->u.layer.layer, 1);
            break;
        case FF_MSG_GET_ABOUT: ff_write_varint(out, message->u.get_about.entries); break;
        case FF_MSG_ROOTS: write_roots(out, &message->u.roots); break;
        case FF_MSG_EDGE:
            ff_message_require(&out->error, message->u.edge.needed >> FF_VIEW_EDGE_MAX == 0);
            ff_write_varint(out, message->u.edge.needed);
            break;
        case FF_MSG_WELCOME: write_welcome(out, &message->u.welcome); break;
        case FF_MSG_FAILED:
        case FF_MSG_GOODBYE: write_failed(out, &message->u.failed, message->type); break;
        default: ff_message_require(&out->error, 0);
    }
}

static uint32_t type_byte(const ff_message *message)
{
    return message->type == FF_MSG_GET      ? ff_kind[message->kind].asked_by
           : message->type == FF_MSG_ANSWER ? ff_kind[message->kind].answered_by
                                            : (uint32_t)message->type;
}

static size_t answer_bytes_max(const ff_message *message)
{
    switch ((enum ff_kind_brings)ff_kind[message->kind].brings) {
        case FF_BRINGS_PAYLOAD: return FF_MESSAGE_HEADER_MAX + (size_t)message->u.data.byte_count;
        case FF_BRINGS_PARTS: return FF_MESSAGE_HEADER_MAX + (size_t)message->u.part.byte_count;
        case FF_BRINGS_FAR:
            return FF_MESSAGE_HEADER_MAX + 15 + (size_t)message->u.far.fins_bytes +
                   message->u.far.paint_bytes;
        case FF_BRINGS_FACE: break;
    }
    return FF_MESSAGE_HEADER_MAX + 14 + (size_t)message->u.face.columns_bytes +
           message->u.face.image_bytes;
}

size_t ff_message_bytes_max(const ff_message *message)
{
    switch (message->type) {
        case FF_MSG_WELCOME:
            return FF_MESSAGE_HEADER_MAX + 1 + 2 + FF_TERRAIN_SET + FF_TERRAIN_BYTES +
                   (size_t)message->u.welcome.more.byte_count;
        case FF_MSG_CAPS:
        case FF_MSG_ABOUT: return FF_MESSAGE_HEADER_MAX + (size_t)message->u.list.byte_count;
        case FF_MSG_ROOTS: return FF_MESSAGE_HEADER_MAX + (size_t)message->u.roots.byte_count;
        case FF_MSG_ANSWER: return answer_bytes_max(message);
        case FF_MSG_GET:
            if (ff_kind[message->kind].asks == FF_ASKS_VIEW) return FF_REQUEST_BYTES_MAX;
            break;
        default: break;
    }
    return FF_SHORT_BYTES_MAX;
}

int ff_message_encode(const ff_message *message, uint8_t *out, size_t capacity)
{
    /* Most bodies are short: so the body is written where it belongs behind a length of one byte,
     * and moved up when its length takes more. */
    size_t room = capacity < 2 ? capacity : 2, body_bytes, header_bytes;
    ff_writer body = { out + room, out + capacity, FF_OK };
    ff_writer head = { out, out + capacity, FF_OK };

    if (ff_short_has(message)) return ff_short_encode(message, out, capacity);
    write_body(&body, message);
    if (body.error != FF_OK) return body.error;
    body_bytes = (size_t)(body.at - (out + room));
    if (body_bytes > FF_MESSAGE_BODY_MAX) return FF_ERR_RANGE;
    header_bytes = 1 + ff_varint_bytes((uint32_t)body_bytes);
    FF_ASSERT(header_bytes <= FF_MESSAGE_HEADER_MAX);
    FF_ASSERT(header_bytes + body_bytes <= ff_message_bytes_max(message));
    if (header_bytes + body_bytes > capacity) return FF_ERR_FULL;
    memmove(out + header_bytes, out + room, body_bytes);
    ff_write_bytes(&head, type_byte(message), 1);
    ff_write_varint(&head, (uint32_t)body_bytes);
    FF_ASSERT(head.error == FF_OK && head.at == out + header_bytes);
    return (int)(header_bytes + body_bytes);
}

/* ---- decode ---- */

static void read_hello(ff_reader *in, ff_hello *hello)
{
    const uint8_t *magic = ff_read_span(in, sizeof(hello_magic));

    if (magic && memcmp(magic, hello_magic, sizeof(hello_magic)) != 0) in->error = FF_ERR_FORMAT;
    hello->version = (uint32_t)ff_read_bytes(in, 4);
    hello->known_checksum = (uint32_t)ff_read_bytes(in, 4);
}

static void read_panorama(ff_reader *in, ff_get_panorama *panorama)
{
    const uint8_t *face;

    panorama->id = (uint16_t)ff_read_bytes(in, 2);
    for (int axis = 0; axis < 3; axis++)
        panorama->position_wu[axis] = (int32_t)ff_read_signed(in, 4);
    panorama->front_wu = (int32_t)ff_read_signed(in, 4);
    panorama->back_wu = (int32_t)ff_read_signed(in, 4);
    panorama->face_size = (uint16_t)ff_read_bytes(in, 2);
    panorama->quality = (uint8_t)ff_read_bytes(in, 1);
    panorama->face_count = (uint8_t)ff_read_bytes(in, 1);
    ff_message_require(&in->error, panorama->face_count <= FF_FACE_COUNT);
    face = ff_read_span(in, panorama->face_count);
    if (face) {
        FF_ASSERT(panorama->face_count <= FF_FACE_COUNT); /* else there was an error, and no span */
        memcpy(panorama->face, face, panorama->face_count);
    }
    ff_message_require(&in->error, face && panorama_ok(panorama));
}

static ff_list read_list(ff_reader *in)
{
    ff_list list = { 0 };
    ff_message_read_rest(in, &list.bytes, &list.byte_count);
    return list;
}

static void keep_error(ff_reader *in, int check)
{
    if (in->error == FF_OK) in->error = check;
}

/* The terrain's type is the least: it comes first. */
static void read_welcome(ff_reader *in, ff_welcome *welcome)
{
    ff_list_entry terrain;

    welcome->version = ff_read_varint(in);
    if (in->error == FF_OK && welcome->version != FF_PROTOCOL_VERSION) in->error = FF_ERR_VERSION;
    if (in->error != FF_OK) return;
    welcome->more = read_list(in);
    keep_error(in, check_list(welcome->more, FF_WELCOME_BYTES_MAX, welcome_rule,
                              sizeof welcome_rule / sizeof *welcome_rule));
    if (in->error != FF_OK) return;
    ff_message_require(&in->error, ff_list_next(&welcome->more, &terrain) == 1 &&
                                       terrain.type == FF_WELCOME_TERRAIN);
    if (in->error != FF_OK) return;
    in->error = ff_message_read_terrain(&terrain, &welcome->info);
    if (in->error == FF_OK && ff_welcome_count(welcome) < 1) in->error = FF_ERR_RANGE;
}

static void read_face(ff_reader *in, ff_face *face)
{
    uint8_t form;

    face->id = (uint16_t)ff_read_bytes(in, 2);
    form = (uint8_t)ff_read_bytes(in, 1);
    face->face = form & 15u;
    face->flags = form >> 4;
    face->face_size = (uint16_t)ff_read_bytes(in, 2);
    if (!(face->flags & FF_FACE_EMPTY)) {
        face->top_row = (uint16_t)ff_read_bytes(in, 2);
        face->row_count = (uint16_t)ff_read_bytes(in, 2);
        face->columns_bytes = ff_read_varint(in);
        face->columns = ff_read_span(in, face->columns_bytes);
        ff_message_read_rest(in, &face->image, &face->image_bytes);
    }
    ff_message_require(&in->error, face_ok(face));
    FF_ASSERT(in->error != FF_OK || face->columns_bytes + face->image_bytes <= FF_MESSAGE_BODY_MAX);
}

static void read_failed(ff_reader *in, ff_failed *failed, enum ff_message_type type)
{
    failed->id = (uint16_t)ff_read_bytes(in, 2);
    failed->error = (int8_t)ff_read_signed(in, 1);
    ff_message_require(&in->error, failed->error < 0 && (type == FF_MSG_FAILED || failed->id == 0));
}

static void read_roots(ff_reader *in, ff_roots *roots)
{
    ff_message_read_rest(in, &roots->bytes, &roots->byte_count);
    ff_message_require(&in->error, roots_ok(roots));
}

static void read_get(ff_reader *in, ff_get *get, enum ff_kind kind)
{
    uint32_t form = (uint32_t)ff_read_bytes(in, 1);

    *get = (ff_get){ .key = ff_message_read_key(in, form) };
    ff_message_require(&in->error, (form & 15u) == 0 && ff_message_get_ok(get, kind));
}

static void read_request(ff_reader *in, ff_message *out)
{
    switch ((enum ff_kind_asks)ff_kind[out->kind].asks) {
        case FF_ASKS_NODE: read_get(in, &out->u.get, out->kind); break;
        case FF_ASKS_VIEW: ff_message_read_view(in, &out->u.view); break;
        case FF_ASKS_PANORAMA: read_panorama(in, &out->u.panorama); break;
        case FF_ASKS_FAR: ff_message_read_get_far(in, &out->u.get_far); break;
    }
}

static void read_answer(ff_reader *in, ff_message *out)
{
    switch ((enum ff_kind_brings)ff_kind[out->kind].brings) {
        case FF_BRINGS_PAYLOAD:
        case FF_BRINGS_PARTS: break; /* they have short forms */
        case FF_BRINGS_FACE: read_face(in, &out->u.face); break;
        case FF_BRINGS_FAR: ff_message_read_far(in, &out->u.far); break;
    }
}

static void read_body(ff_reader *in, ff_message *out)
{
    switch (out->type) {
        case FF_MSG_HELLO: read_hello(in, &out->u.hello); break;
        case FF_MSG_GET: read_request(in, out); break;
        case FF_MSG_ANSWER: read_answer(in, out); break;
        case FF_MSG_CANCEL:
        case FF_MSG_CANCELLED: out->u.cancel.id = (uint16_t)ff_read_bytes(in, 2); break;
        case FF_MSG_PING:
        case FF_MSG_PONG: out->u.ping.stamp = (uint32_t)ff_read_bytes(in, 4); break;
        case FF_MSG_CAPS:
            out->u.list = read_list(in);
            keep_error(in, check_caps(out->u.list));
            break;
        case FF_MSG_ABOUT:
            out->u.list = read_list(in);
            keep_error(in, ff_about_check(out->u.list));
            break;
        case FF_MSG_LAYER:
            out->u.layer.layer = (uint8_t)ff_read_bytes(in, 1);
            ff_message_require(&in->error, out->u.layer.layer <= FF_LAYER_NONE);
            break;
        case FF_MSG_GET_ABOUT: out->u.get_about.entries = ff_read_varint(in); break;
        case FF_MSG_ROOTS: read_roots(in, &out->u.roots); break;
        case FF_MSG_EDGE:
            out->u.edge.needed = ff_read_varint(in);
            ff_message_require(&in->error, out->u.edge.needed >> FF_VIEW_EDGE_MAX == 0);
            break;
        case FF_MSG_WELCOME: read_welcome(in, &out->u.welcome); break;
        case FF_MSG_FAILED:
        case FF_MSG_GOODBYE: read_failed(in, &out->u.failed, out->type); break;
    }
}

/* Requests, and whatever else clients send, have types below the servers', but for short forms. */
/* clang-format off */
enum { SERVER, CLIENT };
#define X(name, type, sender) && type < 80 && (sender == CLIENT ? type <= 64 : type > 64)
FF_STATIC_ASSERT(1 FF_MESSAGE_LIST(X));
#undef X
#define X(kind, name, asked_by, what, asks, answered_by, ...) \
    && (asked_by >= 80 || asked_by <= 64) && answered_by > 64
FF_STATIC_ASSERT(1 FF_KIND_LIST(X));
#undef X
/* clang-format on */

int ff_message_type_of(uint8_t byte, enum ff_kind *kind)
{
    if (ff_short_type(byte, kind)) return ff_short_type(byte, kind);
    for (unsigned i = 0; i < FF_KIND_COUNT; i++) {
        int asked = ff_kind[i].asked_by == byte;
        if (!asked && ff_kind[i].answered_by != byte) continue;
        *kind = (enum ff_kind)i;
        return asked ? FF_MSG_GET : FF_MSG_ANSWER;
    }
    switch (byte) {
#define X(name, type, sender) case FF_MSG_##name:
        FF_MESSAGE_LIST(X)
#undef X
        return byte;
        default: return 0;
    }
}

int ff_message_from_client(uint8_t byte)
{
    enum ff_kind kind;

    switch (ff_message_type_of(byte, &kind)) {
#define X(name, type, sender) \
    case FF_MSG_##name: return sender == CLIENT;
        FF_MESSAGE_LIST(X)
#undef X
        case FF_MSG_GET: return 1;
        default: return 0;
    }
}

uint16_t ff_message_id(const ff_message *message)
{
    const ff_kind_row *kind = &ff_kind[message->kind];

    FF_ASSERT(message->type == FF_MSG_GET || message->type == FF_MSG_ANSWER);
    if (message->type == FF_MSG_GET)
        return kind->asks == FF_ASKS_NODE   ? 0
               : kind->asks == FF_ASKS_VIEW ? message->u.view.id
               : kind->asks == FF_ASKS_FAR  ? message->u.get_far.id
                                            : message->u.panorama.id;
    return kind->brings == FF_BRINGS_FACE ? message->u.face.id : 0;
}

int ff_message_measure(const uint8_t *bytes, size_t byte_count, uint32_t *header, uint32_t *body)
{
    ff_reader in = { bytes, bytes + byte_count, FF_OK };
    uint8_t first = (uint8_t)ff_read_bytes(&in, 1);
    enum ff_kind kind;

    if (in.error != FF_OK) return 0;
    if (ff_short_type(first, &kind) == FF_MSG_GET) return FF_ERR_FORMAT;
    if (ff_short_type(first, &kind)) return ff_short_measure(bytes, byte_count, header, body);
    *body = ff_read_varint(&in);
    if (in.error == FF_ERR_TRUNCATED) return byte_count < FF_MESSAGE_HEADER_MAX ? 0 : FF_ERR_RANGE;
    if (in.error != FF_OK || *body > FF_MESSAGE_BODY_MAX) return FF_ERR_RANGE;
    *header = (uint32_t)(in.at - bytes);
    FF_ASSERT(*header == 1 + ff_varint_bytes(*body));
    return 1;
}

int ff_message_decode(const uint8_t *bytes, size_t byte_count, ff_message *out)
{
    uint32_t header, body_bytes;
    int type, rc;

    if (byte_count < 1) return 0;
    memset(out, 0, sizeof(*out));
    if (ff_short_type(bytes[0], &out->kind)) return ff_short_decode(bytes, byte_count, out);
    type = ff_message_type_of(bytes[0], &out->kind);
    if (!type) return FF_ERR_FORMAT;
    out->type = (enum ff_message_type)type;
    rc = ff_message_measure(bytes, byte_count, &header, &body_bytes);
    if (rc <= 0) return rc;
    if (byte_count - header < body_bytes) return 0;
    ff_reader body = { bytes + header, bytes + header + body_bytes, FF_OK };
    read_body(&body, out);
    if (body.error == FF_OK && body.at != body.end) body.error = FF_ERR_FORMAT;
    return body.error != FF_OK ? body.error : (int)(body.end - bytes);
}
