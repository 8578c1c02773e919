#include "ff_receive.h"
#include "../../../protocol/ff_assert.h"

#include <string.h>

/* The reason is kept for those who wait in vain; FF_OK: they wait no longer. */
static void note_refusal(ff_stream *stream, int error)
{
    sys_mutex_lock(&stream->intake->requests->mutex);
    stream->shared.refusal = (int8_t)error;
    sys_mutex_unlock(&stream->intake->requests->mutex);
}

static void note_lacks(ff_stream *stream, uint32_t lacks)
{
    sys_mutex_lock(&stream->intake->requests->mutex);
    stream->shared.lacks = lacks;
    sys_mutex_unlock(&stream->intake->requests->mutex);
}

/* 1 when the grounds are those that the client was told of last. */
static int holds_all_of(const ff_stream *stream, const ff_welcome *welcome)
{
    const ff_intake *intake = stream->intake;
    int same = ff_welcome_count(welcome) == intake->told_count;
    for (unsigned i = 0; same && i < intake->told_count; i++) {
        ff_terrain_info info;
        uint32_t whole;
        ff_welcome_ground(welcome, i, &info, &whole);
        same = ff_terrain_same(&intake->info[i], &info);
    }
    return same;
}

static int take_welcome(ff_stream *stream, const ff_welcome *welcome, int64_t now_us)
{
    if (stream->state != FF_STREAM_GREETING) return FF_ERR_FORMAT;
    FF_ASSERT(welcome->version == FF_PROTOCOL_VERSION); /* others are not decoded */
    const unsigned count = (unsigned)ff_welcome_count(welcome);
    FF_ASSERT(count >= 1 && count <= FF_WELCOME_GROUNDS);
    stream->awaiting = 0;
    stream->welcomed_us = now_us;
    stream->backoff_us = FF_BACKOFF_US_MIN;
    note_refusal(stream, FF_OK);
    note_lacks(stream, ff_welcome_lacks(welcome));
    if (stream->has_terrain && holds_all_of(stream, welcome)) {
        stream->state = FF_STREAM_UP;
        return FF_OK;
    }
    sys_mutex_lock(&stream->intake->requests->mutex);
    for (unsigned i = 0; i < count; i++)
        ff_welcome_ground(welcome, i, &stream->welcome[i], &stream->whole[i]);
    stream->welcome_count = (uint8_t)count;
    ff_welcome_layers(welcome, &stream->layers);
    stream->about.state = FF_ABOUT_UNKNOWN; /* another pack's */
    stream->about.byte_count = 0;
    sys_mutex_unlock(&stream->intake->requests->mutex);
    stream->state = FF_STREAM_WELCOMED;
    return FF_OK;
}

static int asked_for(const uint8_t *list, unsigned count, unsigned one)
{
    FF_ASSERT(count >= 1 && count <= FF_FAR_SECTORS);
    for (unsigned i = 0; i < count; i++)
        if (list[i] == one) return 1;
    return 0;
}

/* Whether this is an answer to that request, of a kind that has a number. */
static int answers(const ff_requests *requests, const ff_message *message,
                   const ff_request *request)
{
    FF_ASSERT(message->kind < FF_KIND_COUNT && request->kind < FF_KIND_COUNT);
    if (message->kind != request->kind) return 0;
    const ff_ask *ask = ff_requests_ask_of(requests, request);
    return message->kind == FF_KIND_FACE
               ? asked_for(ask->panorama.face, ask->panorama.face_count, message->u.face.face)
               : asked_for(ask->far.sector, ask->far.sector_count, message->u.far.sector);
}

/* The terrain has this node, and there is room for it in what was asked for. */
static int is_part_of(const ff_stream *stream, const ff_request *request, enum ff_kind kind,
                      ff_key key, uint32_t bytes)
{
    const ff_intake *intake = stream->intake;
    int ground = ff_intake_ground(intake, key);
    const ff_terrain_info *info = &intake->info[ground < 0 ? 0 : ground];
    return ground >= 0 && ff_terrain_has_node(info, key) &&
           (kind == FF_KIND_ROOT || ff_key_level(key) + 1 < ff_terrain_levels(info)) &&
           request->bytes_came + bytes <= intake->requests->view.bytes_max;
}

static int take_part(ff_stream *stream, const ff_part *part, uint32_t bytes, int64_t now_us)
{
    ff_request request;
    enum ff_kind kind;
    ff_key key;
    int named;
    if (!stream->view_out || !ff_parts_next(&stream->parts, &kind, &key, &named) ||
        !ff_requests_oldest(stream->intake->requests, FF_ASKS_VIEW, &request))
        return FF_ERR_FORMAT;
    if (part->byte_count && !request.forgotten) {
        if (!is_part_of(stream, &request, kind, key, named ? 0 : part->byte_count))
            return FF_ERR_FORMAT;
        int rc = ff_intake_part(stream->intake, &request, kind, key, part);
        if (rc != FF_OK) return rc;
        if (!request.bytes_came) ff_link_estimate_answer(&stream->link, request.sent_us, now_us);
    }
    stream->answer_bytes[FF_KIND_VIEW] += bytes;
    return ff_parts_take(&stream->parts, part);
}

/* All parts of the view have come. FF_OK also when they have not. */
static int end_view(ff_stream *stream)
{
    ff_request request;
    const ff_message nothing = { .type = FF_MSG_ANSWER, .kind = FF_KIND_VIEW };
    if (!stream->view_out || !ff_parts_done(&stream->parts)) return FF_OK;
    if (!ff_requests_oldest(stream->intake->requests, FF_ASKS_VIEW, &request)) return FF_ERR_FORMAT;
    int rc = FF_OK;
    if (request.forgotten)
        ff_requests_passed(stream->intake->requests, request.id);
    else
        rc = ff_intake_answer(stream->intake, &request, &nothing, 0);
    if (rc == FF_OK) stream->view_out = 0;
    return rc;
}

static int take_roots(ff_stream *stream, const ff_roots *roots)
{
    return stream->view_out ? ff_parts_roots(&stream->parts, roots) : FF_ERR_FORMAT;
}

static int take_edge(ff_stream *stream, uint32_t needed)
{
    return stream->view_out ? ff_parts_edge(&stream->parts, needed) : FF_ERR_FORMAT;
}

/* No more messages answer its request after this one. */
static int is_last(const ff_message *message)
{
    if (message->kind == FF_KIND_FAR) return message->u.far.flags & FF_FACE_LAST;
    return message->kind != FF_KIND_FACE || message->u.face.flags & FF_FACE_LAST;
}

/* The request of a number; 0: the oldest that asks so. */
static int find_request(ff_stream *stream, uint16_t id, enum ff_kind_asks asks, ff_request *request)
{
    return id ? ff_requests_answered(stream->intake->requests, id, request)
              : ff_requests_oldest(stream->intake->requests, asks, request);
}

static int take_answer(ff_stream *stream, const ff_message *message, uint32_t bytes, int64_t now_us)
{
    ff_request request;
    if (message->kind == FF_KIND_VIEW) return take_part(stream, &message->u.part, bytes, now_us);
    int payload = ff_kind[message->kind].brings == FF_BRINGS_PAYLOAD;
    enum ff_kind_asks asks = (enum ff_kind_asks)ff_kind[message->kind].asks;
    if (!find_request(stream, ff_message_id(message), asks, &request) ||
        (!payload && !answers(stream->intake->requests, message, &request)))
        return FF_ERR_FORMAT;
    if (request.forgotten) {
        stream->answer_bytes[request.kind] += bytes;
        if (is_last(message)) ff_requests_passed(stream->intake->requests, request.id);
        return FF_OK;
    }
    int rc = ff_intake_answer(stream->intake, &request, message, bytes);
    if (rc != FF_OK) return rc;
    stream->answer_bytes[request.kind] += bytes;
    /* what lies in a pack comes at once: it tells of the link, not of a server's work */
    if (payload) ff_link_estimate_answer(&stream->link, request.sent_us, now_us);
    return FF_OK;
}

static int fail_request(ff_stream *stream, const ff_request *request, int error)
{
    int rc = FF_OK;
    if (request->forgotten)
        ff_requests_passed(stream->intake->requests, request->id);
    else
        rc = ff_intake_failed(stream->intake, request, error);
    if (rc == FF_OK && request->kind == FF_KIND_VIEW) stream->view_out = 0;
    return rc;
}

static int take_failed(ff_stream *stream, uint16_t id, int error)
{
    ff_request request;
    return find_request(stream, id, FF_ASKS_NODE, &request) ? fail_request(stream, &request, error)
                                                            : FF_ERR_FORMAT;
}

/* What was asked for, and nothing else: so there is room for it. */
static int take_about(ff_stream *stream, ff_list list)
{
    ff_stream_about *about = &stream->about;
    ff_list rest = list;
    ff_list_entry entry;
    if (about->state != FF_ABOUT_ASKED) return FF_ERR_FORMAT;
    while (ff_list_next(&rest, &entry) > 0)
        if (!ff_about_in(about->entries, entry.type)) return FF_ERR_FORMAT;
    if (list.byte_count > ff_about_bytes_max(about->entries)) return FF_ERR_RANGE;
    sys_mutex_lock(&stream->intake->requests->mutex);
    if (list.byte_count) memcpy(about->bytes, list.bytes, list.byte_count);
    about->byte_count = list.byte_count;
    about->state = FF_ABOUT_HERE;
    sys_mutex_unlock(&stream->intake->requests->mutex);
    stream->awaiting = 0;
    return FF_OK;
}

/* Takes in a message. FF_OK, FF_ERR_AGAIN when the new-data list is full, or another error. */
static int take(ff_stream *stream, const ff_message *message, uint32_t bytes, int64_t now_us)
{
    if (message->type == FF_MSG_GOODBYE) {
        note_refusal(stream, message->u.failed.error);
        return FF_ERR_CLOSED;
    }
    if (message->type == FF_MSG_WELCOME) return take_welcome(stream, &message->u.welcome, now_us);
    if (stream->state != FF_STREAM_UP) return FF_ERR_FORMAT;
    switch (message->type) {
        case FF_MSG_ANSWER: return take_answer(stream, message, bytes, now_us);
        case FF_MSG_FAILED:
            return take_failed(stream, message->u.failed.id, message->u.failed.error);
        case FF_MSG_CANCELLED: return take_failed(stream, message->u.cancel.id, FF_ERR_CLOSED);
        case FF_MSG_ROOTS: return take_roots(stream, &message->u.roots);
        case FF_MSG_EDGE: return take_edge(stream, message->u.edge.needed);
        case FF_MSG_PONG: stream->awaiting = 0; return FF_OK;
        case FF_MSG_ABOUT: return take_about(stream, message->u.list);
        default: return FF_ERR_FORMAT; /* a client's message */
    }
}

/* When a legal answer is too long for the receive buffer, its request fails and its bytes pass by
 * unread (stream->skip). FF_OK also for a message that is just not complete yet. */
static int take_oversize(ff_stream *stream, uint32_t at)
{
    const uint8_t *bytes = stream->recv + at;
    uint32_t count = stream->recv_count - at, header, body;
    int known = ff_message_measure(bytes, count, &header, &body);
    if (known <= 0 || header + body <= stream->recv_bytes) return known < 0 ? known : FF_OK;
    enum ff_kind kind;
    /* no part of a view is that long */
    if (ff_message_type_of(bytes[0], &kind) != FF_MSG_ANSWER || kind == FF_KIND_VIEW)
        return FF_ERR_RANGE;
    int numbered = kind == FF_KIND_FACE;
    if (numbered && count < header + 2) return FF_OK;
    uint16_t id = numbered ? (uint16_t)(bytes[header] | bytes[header + 1] << 8) : 0;
    ff_request request;
    if ((numbered && !id) ||
        !find_request(stream, id, (enum ff_kind_asks)ff_kind[kind].asks, &request))
        return FF_ERR_FORMAT;
    int rc = fail_request(stream, &request, FF_ERR_FULL);
    if (rc == FF_OK) stream->skip = header + body;
    return rc;
}

static void drop_front(ff_stream *stream, uint32_t count)
{
    FF_ASSERT(count <= stream->recv_count);
    stream->recv_count -= count;
    memmove(stream->recv, stream->recv + count, stream->recv_count);
}

static uint32_t skip_front(ff_stream *stream, uint32_t at)
{
    FF_ASSERT(at <= stream->recv_count);
    uint32_t here = stream->recv_count - at;
    uint32_t count = stream->skip < here ? stream->skip : here;
    stream->skip -= count;
    return at + count;
}

int ff_receive_messages(ff_stream *stream, int64_t now_us)
{
    uint32_t at = 0;
    int rc = FF_OK;
    FF_ASSERT(stream->recv_count <= stream->recv_bytes);
    stream->blocked = 0;
    while (rc == FF_OK && stream->state != FF_STREAM_WELCOMED) {
        at = skip_front(stream, at);
        rc = end_view(stream);
        if (rc != FF_OK || at == stream->recv_count) break;
        FF_ASSERT(stream->skip == 0 && at < stream->recv_count);
        ff_message message;
        int count = ff_message_decode(stream->recv + at, stream->recv_count - at, &message);
        if (count == FF_ERR_VERSION) note_refusal(stream, count);
        if (count < 0) return count;
        FF_ASSERT((uint32_t)count <= stream->recv_count - at);
        if (count == 0) {
            rc = take_oversize(stream, at);
            if (rc != FF_OK || !stream->skip) break;
            continue;
        }
        rc = take(stream, &message, (uint32_t)count, now_us);
        if (rc == FF_OK) at += (uint32_t)count;
    }
    drop_front(stream, at);
    if (rc == FF_ERR_AGAIN) {
        stream->blocked = 1;
        rc = FF_OK;
    }
    return rc;
}
