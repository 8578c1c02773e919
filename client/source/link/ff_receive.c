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

/* Whether this is an answer to that request. */
static int answers(const ff_requests *requests, const ff_message *message,
                   const ff_request *request)
{
    FF_ASSERT(message->kind < FF_KIND_COUNT && request->kind < FF_KIND_COUNT);
    const ff_kind_row *kind = &ff_kind[request->kind];
    if (ff_kind[message->kind].answered_by != kind->answered_by) return 0;
    if (kind->brings != FF_BRINGS_FACE && kind->brings != FF_BRINGS_FAR) return 1;
    const ff_ask *ask = ff_requests_ask_of(requests, request);
    return kind->brings == FF_BRINGS_FACE
               ? asked_for(ask->panorama.face, ask->panorama.face_count, message->u.face.face)
               : asked_for(ask->far.sector, ask->far.sector_count, message->u.far.sector);
}

/* A node that the view may bring and the terrain has. Once the parts have more bytes than were
 * asked for, only what is named and has not come: so they end. */
static int is_part_of(const ff_stream *stream, const ff_request *request, const ff_part *part)
{
    const ff_intake *intake = stream->intake;
    int ground = ff_intake_ground(intake, part->key);
    const ff_terrain_info *info = &intake->info[ground < 0 ? 0 : ground];
    const ff_get_view *view = &stream->intake->requests->view;
    int root = part->what == FF_PART_ROOT;
    enum ff_kind kind = root ? FF_KIND_ROOT : FF_KIND_REFINEMENT;
    return ground >= 0 && ff_terrain_has_node(info, part->key) &&
           (root || ff_key_level(part->key) + 1 < ff_terrain_levels(info)) &&
           ff_view_covers(view, kind, part->key) &&
           (request->bytes_came <= view->bytes_max ||
            ff_view_names(view, kind, part->key) & ~(uint32_t)request->named);
}

static int take_part(ff_stream *stream, const ff_request *request, const ff_message *message,
                     uint32_t bytes, int64_t now_us)
{
    const ff_part *part = &message->u.part;
    int end = part->what == FF_PART_END;
    if (!end && !is_part_of(stream, request, part)) return FF_ERR_FORMAT;
    int rc = end ? ff_intake_answer(stream->intake, request, message, bytes)
                 : ff_intake_part(stream->intake, request, part);
    if (rc != FF_OK) return rc;
    stream->answer_bytes[request->kind] += bytes;
    if (!request->bytes_came) ff_link_estimate_answer(&stream->link, request->sent_us, now_us);
    return FF_OK;
}

/* No more messages answer its request after this one. */
static int is_last(const ff_message *message)
{
    if (message->kind == FF_KIND_VIEW) return message->u.part.what == FF_PART_END;
    if (message->kind == FF_KIND_FAR) return message->u.far.flags & FF_FACE_LAST;
    return message->kind != FF_KIND_FACE || message->u.face.flags & FF_FACE_LAST;
}

static int take_answer(ff_stream *stream, const ff_message *message, uint32_t bytes, int64_t now_us)
{
    ff_request request;
    if (!ff_requests_answered(stream->intake->requests, ff_message_id(message), &request) ||
        !answers(stream->intake->requests, message, &request))
        return FF_ERR_FORMAT;
    if (request.forgotten) {
        stream->answer_bytes[request.kind] += bytes;
        if (is_last(message)) ff_requests_passed(stream->intake->requests, request.id);
        return FF_OK;
    }
    if (request.kind == FF_KIND_VIEW) return take_part(stream, &request, message, bytes, now_us);
    int rc = ff_intake_answer(stream->intake, &request, message, bytes);
    if (rc != FF_OK) return rc;
    stream->answer_bytes[request.kind] += bytes;
    /* what lies in a pack comes at once: it tells of the link, not of a server's work */
    if (ff_kind[request.kind].section)
        ff_link_estimate_answer(&stream->link, request.sent_us, now_us);
    return FF_OK;
}

static int take_failed(ff_stream *stream, uint16_t id, int error)
{
    ff_request request;
    if (!ff_requests_answered(stream->intake->requests, id, &request)) return FF_ERR_FORMAT;
    if (request.forgotten) return ff_requests_passed(stream->intake->requests, id), FF_OK;
    return ff_intake_failed(stream->intake, &request, error);
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
        case FF_MSG_PONG: stream->awaiting = 0; return FF_OK;
        case FF_MSG_ABOUT: return take_about(stream, message->u.list);
        default: return FF_ERR_FORMAT; /* a client's message */
    }
}

/* When a legal message is too long for the receive buffer, its request fails and its bytes pass by
 * unread (stream->skip). FF_OK also for a message that is just not complete yet. */
static int take_oversize(ff_stream *stream, uint32_t at)
{
    const uint8_t *bytes = stream->recv + at;
    uint32_t count = stream->recv_count - at, body = 0, header = 1;
    for (unsigned shift = 0;; shift += 7, header++) {
        if (header >= count || header >= FF_MESSAGE_HEADER_MAX) return FF_OK;
        FF_ASSERT(shift <= 7 * (FF_MESSAGE_HEADER_MAX - 2));
        body |= (uint32_t)(bytes[header] & 0x7f) << shift;
        if (!(bytes[header] & 0x80)) break;
    }
    header++;
    FF_ASSERT(header <= FF_MESSAGE_HEADER_MAX && header <= count);
    if (header + body <= stream->recv_bytes || count < header + 2) return FF_OK;
    if (ff_message_type_of(bytes[0]) != FF_MSG_ANSWER) return FF_ERR_RANGE;
    int rc = take_failed(stream, (uint16_t)(bytes[header] | bytes[header + 1] << 8), FF_ERR_FULL);
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
        if (at == stream->recv_count) break;
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
