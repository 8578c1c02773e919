/* The messages that come most often, without a number and without a length of their own: requests
 * for what belongs to one node, their answers, and the parts of a view's answer; see SPEC.md,
 * "Messages". */
#include "ff_message_local.h"

/* first bytes */
#define NODE_LONG  80u  /* + the highest bits of the length, then 16 more */
#define NODE       96u  /* + the highest bits of the length, then 8 more */
#define GET        128u /* + 48 when a tile follows, + 16 * what, + level */
#define GET_TILE   48u
#define PART       224u                /* + what comes below, then the length */
#define LATER      240u                /* + how many less 1 */
#define NODE_SHORT ((GET - NODE) << 8) /* shorter than this has the short form */

FF_STATIC_ASSERT(FF_MESSAGE_BODY_MAX >> 16 < NODE - NODE_LONG);
FF_STATIC_ASSERT(LATER + FF_PARTS_LATER_MAX == UINT8_MAX + 1);
FF_STATIC_ASSERT(GET + 2 * GET_TILE == PART && 3 * (FF_KEY_LEVEL_MAX + 1) == GET_TILE);
#define X(kind, name, asked_by, what, asks, answered_by, brings, ...)       \
    &&(asked_by != GET || (FF_ASKS_##asks == FF_ASKS_NODE && what < 3)) &&  \
        (FF_BRINGS_##brings != FF_BRINGS_PAYLOAD || answered_by == NODE) && \
        (FF_BRINGS_##brings != FF_BRINGS_PARTS || answered_by == PART)
FF_STATIC_ASSERT(1 FF_KIND_LIST(X));
#undef X

int ff_short_type(uint8_t byte, enum ff_kind *kind)
{
    if (byte < NODE_LONG) return 0;
    *kind = byte >= PART ? FF_KIND_VIEW : FF_KIND_ROOT;
    return byte >= GET && byte < PART ? FF_MSG_GET : FF_MSG_ANSWER;
}

int ff_short_has(const ff_message *message)
{
    return message->type == FF_MSG_GET      ? ff_kind[message->kind].asked_by == GET
           : message->type == FF_MSG_ANSWER ? ff_kind[message->kind].brings == FF_BRINGS_PAYLOAD ||
                                                  ff_kind[message->kind].brings == FF_BRINGS_PARTS
                                            : 0;
}

/* ---- encode ---- */

static void write_get(ff_writer *out, const ff_get *get, enum ff_kind kind)
{
    uint32_t tile = ff_key_tile(get->key);
    ff_message_require(&out->error, ff_message_get_ok(get, kind));
    ff_write_bytes(
        out, GET + (tile ? GET_TILE : 0) + 16u * ff_kind[kind].what + ff_key_level(get->key), 1);
    if (tile) ff_write_varint(out, tile);
    ff_write_varint(out, kind == FF_KIND_REFINEMENT
                             ? ff_key_code(get->key) << FF_SIDE_COUNT | get->sides
                             : ff_key_code(get->key));
}

static void write_node(ff_writer *out, const ff_data *data)
{
    uint32_t bytes = data->byte_count;
    int is_long = bytes >= NODE_SHORT;
    ff_message_require(&out->error, bytes <= FF_MESSAGE_BODY_MAX);
    ff_write_bytes(out, is_long ? NODE_LONG + (bytes >> 16) : NODE + (bytes >> 8), 1);
    ff_write_bytes(out, is_long ? bytes & 0xFFFFu : bytes & 0xFFu, is_long ? 2 : 1);
    ff_write_span(out, data->bytes, bytes);
}

static int part_ok(const ff_part *part)
{
    if (part->later)
        return part->later <= FF_PARTS_LATER_MAX && part->below == 0 && part->byte_count == 0;
    return part->below < 16 && (part->byte_count || !part->below) &&
           part->byte_count <= FF_MESSAGE_BODY_MAX;
}

static void write_part(ff_writer *out, const ff_part *part)
{
    ff_message_require(&out->error, part_ok(part));
    ff_write_bytes(out, part->later ? LATER + part->later - 1u : PART + part->below, 1);
    if (part->later) return;
    ff_write_varint(out, part->byte_count);
    ff_write_span(out, part->bytes, part->byte_count);
}

int ff_short_encode(const ff_message *message, uint8_t *out, size_t capacity)
{
    ff_writer writer = { out, out + capacity, FF_OK };
    if (message->type == FF_MSG_GET)
        write_get(&writer, &message->u.get, message->kind);
    else if (ff_kind[message->kind].brings == FF_BRINGS_PARTS)
        write_part(&writer, &message->u.part);
    else
        write_node(&writer, &message->u.data);
    return writer.error != FF_OK ? writer.error : (int)(writer.at - out);
}

/* ---- decode ---- */

int ff_short_measure(const uint8_t *bytes, size_t count, uint32_t *header, uint32_t *body)
{
    ff_reader in = { bytes + 1, bytes + count, FF_OK };
    uint8_t first = bytes[0];
    FF_ASSERT(first >= NODE_LONG);
    int is_long = first < NODE;
    if (first >= LATER)
        *body = 0;
    else if (first >= PART)
        *body = ff_read_varint(&in);
    else
        *body = is_long ? (first - NODE_LONG) << 16 | (uint32_t)ff_read_bytes(&in, 2)
                        : (first - NODE) << 8 | (uint32_t)ff_read_bytes(&in, 1);
    if (in.error == FF_ERR_TRUNCATED) return count < FF_MESSAGE_HEADER_MAX ? 0 : FF_ERR_RANGE;
    if (in.error != FF_OK || *body > FF_MESSAGE_BODY_MAX || (is_long && *body < NODE_SHORT))
        return FF_ERR_RANGE;
    *header = (uint32_t)(in.at - bytes);
    return 1;
}

/* The kind that is asked for so; FF_KIND_COUNT: there is none. */
static enum ff_kind kind_of(uint32_t what)
{
    unsigned kind = 0;
    while (kind < FF_KIND_COUNT && (ff_kind[kind].asked_by != GET || ff_kind[kind].what != what))
        kind++;
    return (enum ff_kind)kind;
}

static int decode_get(const uint8_t *bytes, size_t count, ff_message *out)
{
    ff_reader in = { bytes + 1, bytes + count, FF_OK };
    uint32_t form = bytes[0] - GET, has_tile = form >= GET_TILE;
    if (has_tile) form -= GET_TILE;
    uint32_t tile = has_tile ? ff_read_varint(&in) : 0, code = ff_read_varint(&in);
    if (in.error == FF_ERR_TRUNCATED) return 0;
    out->kind = kind_of(form >> 4);
    ff_message_require(&in.error, tile < FF_KEY_TILES_MAX && (tile || !has_tile));
    if (in.error != FF_OK) return in.error;
    FF_ASSERT(out->kind < FF_KIND_COUNT);
    out->u.get = (ff_get){ 0 };
    if (out->kind == FF_KIND_REFINEMENT) {
        out->u.get.sides = (uint8_t)(code & ((1u << FF_SIDE_COUNT) - 1));
        code >>= FF_SIDE_COUNT;
    }
    out->u.get.key = ff_key_make(tile, form & 15u, code);
    return ff_message_get_ok(&out->u.get, out->kind) ? (int)(in.at - bytes) : FF_ERR_RANGE;
}

int ff_short_decode(const uint8_t *bytes, size_t count, ff_message *out)
{
    uint32_t header, body;
    out->type = (enum ff_message_type)ff_short_type(bytes[0], &out->kind);
    if (out->type == FF_MSG_GET) return decode_get(bytes, count, out);
    int rc = ff_short_measure(bytes, count, &header, &body);
    if (rc <= 0) return rc;
    if (count - header < body) return 0;
    if (out->kind == FF_KIND_VIEW) {
        out->u.part = bytes[0] >= LATER
                          ? (ff_part){ .later = (uint8_t)(bytes[0] - LATER + 1) }
                          : (ff_part){ (uint8_t)(bytes[0] - PART), bytes + header, body, 0 };
        if (!part_ok(&out->u.part)) return FF_ERR_RANGE;
    } else {
        out->u.data = (ff_data){ bytes + header, body };
    }
    return (int)(header + body);
}
