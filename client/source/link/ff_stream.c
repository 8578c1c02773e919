/* Connection, sending and time-outs; what comes in is in ff_receive.c. */
#include "ff_stream.h"
#include "ff_receive.h"
#include "../../../protocol/ff_assert.h"
#include "../../../protocol/shape/ff_shape.h"

#include <string.h>

#define CONNECT_US_MAX     30000000
#define PING_AFTER_US      60000000 /* far below the server's idle limit */
#define RECEIVE_ROUNDS_MAX 16       /* a step stays short, whatever the link brings */
/* While no answer has ever come, the link may be slower than thought: the time-out doubles up to
 * PATIENCE_MAX times. Later it is at least PATIENCE_ROUND_TRIPS round trips. */
#define PATIENCE_MAX         4
#define PATIENCE_ROUND_TRIPS 4
/* What is asked for ahead waits for company so long, of the 3 s and some round trips that it is
 * ahead. */
#define COMPANY_US     1000000
#define ABOUT_AFTER_US 20000000 /* so long ground in view goes first, always */

#define PURSE_S 4 /* so that 40 s have at most a tenth more than they may */

FF_STATIC_ASSERT(FF_REQUEST_BYTES_MAX <= FF_STREAM_SEND_BYTES);
FF_STATIC_ASSERT(FF_BACKOFF_US_MIN < FF_BACKOFF_US_MAX && FF_BACKOFF_US_MAX <= INT64_MAX / 2);
/* UINT32_MAX milliseconds are below 2^42 microseconds */
FF_STATIC_ASSERT(42 + PATIENCE_MAX < 63 && PATIENCE_MAX <= UINT8_MAX);

void ff_stream_init(ff_stream *stream, sys_stream *io, ff_intake *intake, unsigned in_flight_max,
                    uint32_t answer_timeout_ms, uint8_t *recv, uint32_t recv_bytes)
{
    FF_ASSERT(in_flight_max >= 1 && in_flight_max <= UINT16_MAX);
    FF_ASSERT(recv_bytes > FF_REQUEST_BYTES_MAX);
    memset(stream, 0, sizeof *stream);
    stream->io = io;
    stream->intake = intake;
    stream->in_flight_max = (uint16_t)in_flight_max;
    stream->answer_timeout_us = (int64_t)answer_timeout_ms * 1000;
    stream->recv = recv;
    stream->recv_bytes = recv_bytes;
    stream->reach_wu = INT32_MAX;
    stream->backoff_us = FF_BACKOFF_US_MIN;
    stream->connect_us = stream->heard_us = stream->sent_us = INT64_MIN;
    stream->ahead_us = stream->purse_us = INT64_MIN / 2; /* the purse is full */
    ff_link_estimate_reset(&stream->link);
}

void ff_stream_want_about(ff_stream *stream, uint32_t entries, uint8_t *bytes)
{
    FF_ASSERT(stream->state == FF_STREAM_CONNECTING);
    stream->about.entries = entries;
    stream->about.bytes = bytes;
}

int ff_stream_about_entry(ff_stream *stream, unsigned entry, uint8_t *value, size_t room)
{
    const uint8_t *found;
    sys_mutex_lock(&stream->intake->requests->mutex);
    ff_list list = { stream->about.bytes, stream->about.byte_count };
    int bytes = ff_list_find(list, entry, &found);
    if (stream->about.state != FF_ABOUT_HERE) bytes = FF_ERR_AGAIN;
    if (bytes > 0 && (size_t)bytes > room) bytes = FF_ERR_FULL;
    if (bytes > 0) memcpy(value, found, (size_t)bytes);
    sys_mutex_unlock(&stream->intake->requests->mutex);
    return bytes;
}

static void publish(ff_stream *stream)
{
    ff_stream_shared *shared = &stream->shared;
    FF_ASSERT(stream->recv_count <= stream->recv_high && stream->recv_high <= stream->recv_bytes);
    sys_mutex_lock(&stream->intake->requests->mutex);
    FF_ASSERT(shared->bytes_down <= stream->bytes_down && shared->bytes_up <= stream->bytes_up);
    FF_ASSERT(shared->losses <= stream->losses && shared->reconnects <= stream->reconnects);
    shared->state = stream->state;
    shared->bytes_down = stream->bytes_down;
    shared->bytes_up = stream->bytes_up;
    memcpy(shared->answer_bytes, stream->answer_bytes, sizeof shared->answer_bytes);
    shared->protocol_errors = stream->protocol_errors;
    shared->reconnects = stream->reconnects;
    shared->received = stream->recv_count;
    shared->received_high = stream->recv_high;
    shared->losses = stream->losses;
    shared->about_bytes = stream->about.byte_count;
    shared->rtt_us = stream->link.rtt_us;
    shared->bytes_s = stream->link.bytes_s;
    sys_mutex_unlock(&stream->intake->requests->mutex);
}

void ff_stream_get_shared(ff_stream *stream, ff_stream_shared *shared)
{
    sys_mutex_lock(&stream->intake->requests->mutex);
    *shared = stream->shared;
    sys_mutex_unlock(&stream->intake->requests->mutex);
}

void ff_stream_say(ff_stream *stream, int quiet, int no_prefetch)
{
    sys_mutex_lock(&stream->intake->requests->mutex);
    stream->shared.quiet = (uint8_t)quiet;
    stream->shared.no_prefetch = (uint8_t)no_prefetch;
    sys_mutex_unlock(&stream->intake->requests->mutex);
}

void ff_stream_hurry(ff_stream *stream, int hurry)
{
    sys_mutex_lock(&stream->intake->requests->mutex);
    stream->shared.hurry = (uint8_t)hurry;
    sys_mutex_unlock(&stream->intake->requests->mutex);
}

void ff_stream_allow(ff_stream *stream, uint32_t bytes_s)
{
    sys_mutex_lock(&stream->intake->requests->mutex);
    stream->shared.allowed_bytes_s = bytes_s;
    sys_mutex_unlock(&stream->intake->requests->mutex);
}

/* Closes a connection that is of no more use. Half-received messages and unsent bytes are dropped,
 * requests without an answer are queued again. */
static void give_up(ff_stream *stream, int64_t now_us)
{
    FF_ASSERT(stream->state != FF_STREAM_DOWN && stream->state != FF_STREAM_DEAD);
    FF_ASSERT(stream->backoff_us >= FF_BACKOFF_US_MIN && stream->backoff_us <= FF_BACKOFF_US_MAX);
    stream->io->close(stream->io->state);
    ff_requests_lost(stream->intake->requests);
    stream->recv_count = stream->send_count = stream->skip = 0;
    stream->awaiting = stream->blocked = stream->view_out = 0;
    if (stream->about.state == FF_ABOUT_ASKED) stream->about.state = FF_ABOUT_UNKNOWN;
    stream->losses++;
    stream->link.since_us = INT64_MIN;
    stream->state = stream->io->reconnect ? FF_STREAM_DOWN : FF_STREAM_DEAD;
    stream->retry_us = now_us + stream->backoff_us;
    stream->backoff_us = stream->backoff_us * 2 > FF_BACKOFF_US_MAX ? FF_BACKOFF_US_MAX
                                                                    : stream->backoff_us * 2;
}

void ff_stream_accept(ff_stream *stream, int ok)
{
    FF_ASSERT(stream->state == FF_STREAM_WELCOMED);
    stream->has_terrain = (uint8_t)ok;
    if (ok) {
        stream->state = FF_STREAM_UP;
    } else {
        stream->io->close(stream->io->state);
        stream->state = FF_STREAM_DEAD;
    }
    publish(stream);
}

void ff_stream_restart(ff_stream *stream)
{
    stream->has_terrain = 0;
    if (stream->state == FF_STREAM_DEAD || stream->state == FF_STREAM_DOWN) return;
    stream->backoff_us = FF_BACKOFF_US_MIN;
    give_up(stream, 0);
    stream->retry_us = INT64_MIN; /* at once */
    publish(stream);
}

void ff_stream_close(ff_stream *stream)
{
    if (stream->state != FF_STREAM_DOWN && stream->state != FF_STREAM_DEAD)
        stream->io->close(stream->io->state);
    stream->state = FF_STREAM_DEAD;
}

static void append(ff_stream *stream, const ff_message *message)
{
    int count = ff_message_encode(message, stream->send + stream->send_count,
                                  sizeof stream->send - stream->send_count);
    FF_ASSERT(count > 0); /* a request that is not sent would be waited for */
    stream->send_count += (uint32_t)count;
}

#define LAYER_BYTES 3

static int has_send_room(const ff_stream *stream)
{
    FF_ASSERT(stream->send_count <= sizeof stream->send);
    return stream->send_count + FF_REQUEST_BYTES_MAX + LAYER_BYTES <= sizeof stream->send;
}

static void append_caps(ff_stream *stream)
{
    uint8_t reach[4], entry[8];
    ff_writer value = { reach, reach + sizeof reach, FF_OK },
              list = { entry, entry + sizeof entry, FF_OK };
    if (stream->reach_wu < INT32_MAX) {
        ff_write_bytes(&value, (uint32_t)stream->reach_wu, 4);
        ff_list_write(&list, FF_CAPS_REACH, reach, sizeof reach);
    }
    FF_ASSERT(value.error == FF_OK && list.error == FF_OK);
    append(stream,
           &(ff_message){ .type = FF_MSG_CAPS, .u.list = { entry, (uint32_t)(list.at - entry) } });
}

static void greet(ff_stream *stream, int64_t now_us)
{
    FF_ASSERT(stream->state == FF_STREAM_CONNECTING);
    /* of the connection before this one nothing is left */
    FF_ASSERT(stream->send_count == 0 && stream->recv_count == 0 && stream->skip == 0);
    ff_message hello = { .type = FF_MSG_HELLO };
    hello.u.hello.version = FF_PROTOCOL_VERSION;
    hello.u.hello.known_checksum = stream->has_terrain ? stream->intake->info[0].checksum : 0;
    append(stream, &hello);
    append_caps(stream); /* in one piece with HELLO */
    FF_ASSERT(stream->send_count > 0);
    stream->state = FF_STREAM_GREETING;
    stream->heard_us = stream->sent_us = now_us;
    stream->awaiting = 1;
    stream->layer = 0;
}

static int connect_step(ff_stream *stream, int64_t now_us)
{
    if (stream->state == FF_STREAM_DOWN) {
        if (now_us < stream->retry_us) return 0;
        stream->state = FF_STREAM_CONNECTING;
        stream->attempt = 1;
        stream->connect_us = now_us;
        stream->reconnects++;
    }
    /* the stream was handed over connected, or connecting: then it takes no bytes yet */
    if (!stream->attempt) {
        greet(stream, now_us);
        return 1;
    }
    int rc = stream->io->reconnect(stream->io->state);
    if (rc == FF_OK)
        greet(stream, now_us);
    else if (rc != FF_ERR_AGAIN || now_us - stream->connect_us > CONNECT_US_MAX)
        give_up(stream, now_us);
    else
        return 0;
    return 1;
}

/* Sides of a refinement that are held, or are asked for already: answers come in order. */
static unsigned sides_known(const ff_stream *stream, const ff_request *request)
{
    const ff_intake *intake = stream->intake;
    unsigned sides = request->sides;
    if (request->kind != FF_KIND_REFINEMENT) return 0;
    int ground = ff_intake_ground(intake, request->key);
    for (unsigned side = 0; ground >= 0 && side < FF_SIDE_COUNT; side++) {
        ff_key beside =
            ff_shape_neighbour(&intake->info[ground], request->key, (enum ff_side)side).key;
        if (beside != FF_KEY_NONE && ff_requests_out(intake->requests, FF_KIND_REFINEMENT, beside))
            sides |= 1u << side;
    }
    FF_ASSERT(sides >> FF_SIDE_COUNT == 0);
    return sides;
}

/* Whose images are asked for is told when it changes, not with each request. */
static void tell_layer(ff_stream *stream, const ff_request *request)
{
    if (!ff_kind[request->kind].has_image || request->layer == stream->layer) return;
    append(stream, &(ff_message){ .type = FF_MSG_LAYER, .u.layer = { request->layer } });
    stream->layer = request->layer;
}

static void encode_request(ff_stream *stream, const ff_request *request)
{
    FF_ASSERT(request->state == FF_REQUEST_SENT && has_send_room(stream));
    const ff_requests *requests = stream->intake->requests;
    ff_message message = { .type = FF_MSG_GET, .kind = (enum ff_kind)request->kind };
    switch ((enum ff_kind_asks)ff_kind[request->kind].asks) {
        case FF_ASKS_NODE:
            message.u.get = (ff_get){ request->key, (uint8_t)sides_known(stream, request) };
            break;
        case FF_ASKS_VIEW:
            message.u.view = requests->view;
            ff_parts_begin(&stream->parts, &requests->view);
            stream->view_out = 1;
            break;
        case FF_ASKS_PANORAMA:
            message.u.panorama = ff_requests_ask_of(requests, request)->panorama;
            break;
        case FF_ASKS_FAR: message.u.get_far = ff_requests_ask_of(requests, request)->far; break;
    }
    tell_layer(stream, request);
    append(stream, &message);
}

/* What is asked for ahead has time: it leaves together with what has not, or with more of its own.
 * So fewer packets go, and come back, each with a header of IP and TCP. */
static int in_company(ff_stream *stream, int64_t now_us)
{
    return now_us - stream->ahead_us >= COMPANY_US ||
           ff_requests_waiting(stream->intake->requests, FF_CLASS_IN_VIEW);
}

/* What may still be asked for of the bytes allowed, and what has been saved while little came. */
static uint32_t purse(ff_stream *stream, uint32_t bytes_s, int64_t now_us)
{
    int64_t most = (int64_t)bytes_s * PURSE_S, passed_us = now_us - stream->purse_us;
    if (!bytes_s) { /* a budget that is set later begins anew */
        stream->purse = 0;
        stream->purse_us = INT64_MIN / 2;
        stream->purse_down = stream->bytes_down;
        return UINT32_MAX;
    }
    FF_ASSERT(stream->bytes_down >= stream->purse_down);
    if (passed_us > PURSE_S * 1000000ll) passed_us = PURSE_S * 1000000ll;
    stream->purse += passed_us * bytes_s -
                     (int64_t)(stream->bytes_down - stream->purse_down) * 1000000;
    if (stream->purse > most * 1000000) stream->purse = most * 1000000;
    stream->purse_us = now_us;
    stream->purse_down = stream->bytes_down;
    return stream->purse > 0 ? (uint32_t)(stream->purse / 1000000) : 0;
}

/* Puts requests into the send buffer, as many as the link's window and the buffer take, so that
 * they leave in one piece. */
static int ask(ff_stream *stream, int64_t now_us)
{
    ff_requests *requests = stream->intake->requests;
    sys_mutex_lock(&requests->mutex);
    int quiet = stream->shared.quiet;
    int prefetch = !stream->shared.no_prefetch &&
                   requests->counts.in_flight < stream->in_flight_max / 2u;
    int hurry = stream->shared.hurry;
    uint32_t bytes_s = stream->shared.allowed_bytes_s, in_flight = requests->counts.bytes_in_flight;
    sys_mutex_unlock(&requests->mutex);
    int company = hurry || in_company(stream, now_us);
    prefetch &= company;
    FF_ASSERT(stream->state == FF_STREAM_UP || stream->state == FF_STREAM_GREETING);
    uint32_t window = ff_link_estimate_window(&stream->link), left = purse(stream, bytes_s, now_us);
    quiet |= left <= in_flight;
    int moved = 0;
    ff_request request;
    while (has_send_room(stream)) {
        uint16_t id = ff_requests_next_cancel(requests);
        if (id) {
            ff_message cancel = { .type = FF_MSG_CANCEL };
            cancel.u.cancel.id = id;
            append(stream, &cancel);
        } else if (!quiet && ff_requests_next(requests, now_us, stream->in_flight_max,
                                              window < left ? window : left, prefetch, &request)) {
            encode_request(stream, &request);
            if (request.rank >= FF_CLASS_PREFETCH) stream->ahead_us = now_us;
            ff_link_estimate_sent(&stream->link, now_us);
        } else {
            break;
        }
        moved = 1;
    }
    /* more requests would have gone; the reserve waits for other reasons */
    if (left < window) return moved;
    stream->link.window_full |= (uint8_t)ff_requests_waiting(requests, company ? FF_CLASS_PREFETCH
                                                                               : FF_CLASS_IN_VIEW);
    return moved;
}

static void keep_alive(ff_stream *stream, int64_t now_us)
{
    if (stream->awaiting || stream->send_count || now_us - stream->sent_us < PING_AFTER_US) return;
    ff_message ping = { .type = FF_MSG_PING };
    ping.u.ping.stamp = (uint32_t)(now_us / 1000);
    append(stream, &ping);
    stream->awaiting = 1;
}

/* Whose the ground is can wait until some of it is here and nothing in view is left to be asked
 * for, but not for ever. */
static void ask_about(ff_stream *stream, int64_t now_us)
{
    ff_request_counts counts;
    if (!stream->about.entries || stream->about.state != FF_ABOUT_UNKNOWN || stream->awaiting ||
        !has_send_room(stream))
        return;
    ff_requests_get_counts(stream->intake->requests, &counts, NULL);
    int in_view = !counts.done || ff_requests_waiting(stream->intake->requests, FF_CLASS_IN_VIEW);
    if (in_view && now_us - stream->welcomed_us < ABOUT_AFTER_US) return;
    append(stream,
           &(ff_message){ .type = FF_MSG_GET_ABOUT, .u.get_about = { stream->about.entries } });
    stream->about.state = FF_ABOUT_ASKED;
    stream->awaiting = 1;
}

/* 1 while requests wait for answers. */
static int outstanding(ff_stream *stream)
{
    ff_request_counts counts;
    ff_requests_get_counts(stream->intake->requests, &counts, NULL);
    return counts.in_flight != 0;
}

/* Sends what the link takes of the send buffer. FF_OK or FF_ERR_CLOSED. */
static int flush(ff_stream *stream, int64_t now_us, int *moved)
{
    if (!stream->send_count) return FF_OK;
    int count = stream->io->send(stream->io->state, stream->send, stream->send_count);
    if (count < 0) return FF_ERR_CLOSED;
    if (count > 0) {
        stream->send_count -= (uint32_t)count;
        memmove(stream->send, stream->send + count, stream->send_count);
        stream->bytes_up += (uint32_t)count;
        /* silence is counted from the first bytes that can be answered */
        if (!outstanding(stream)) stream->heard_us = now_us;
        stream->sent_us = now_us;
        *moved = 1;
    }
    return FF_OK;
}

static int receive(ff_stream *stream, int64_t now_us, int *moved)
{
    for (int round = 0; round < RECEIVE_ROUNDS_MAX; round++) {
        /* what could not be put on the list last time comes first */
        int rc = ff_receive_messages(stream, now_us);
        if (rc < 0) return rc;
        if (stream->blocked || stream->state == FF_STREAM_WELCOMED) return FF_OK;
        /* a full buffer holds a whole message, or one that passes by */
        FF_ASSERT(stream->recv_count < stream->recv_bytes);
        int count = stream->io->recv(stream->io->state, stream->recv + stream->recv_count,
                                     stream->recv_bytes - stream->recv_count);
        if (count < 0) return FF_ERR_CLOSED;
        if (count == 0) return FF_OK;
        stream->recv_count += (uint32_t)count;
        if (stream->recv_count > stream->recv_high) stream->recv_high = stream->recv_count;
        stream->bytes_down += (uint32_t)count;
        stream->heard_us = now_us;
        *moved = 1;
        ff_link_estimate_received(&stream->link, (uint32_t)count, outstanding(stream), now_us);
    }
    return FF_OK;
}

static int silent_too_long(ff_stream *stream, int64_t now_us)
{
    FF_ASSERT(stream->patience <= PATIENCE_MAX);
    int64_t limit_us = stream->answer_timeout_us << stream->patience,
            round_trips_us = PATIENCE_ROUND_TRIPS * (int64_t)stream->link.rtt_us;
    if (stream->blocked || stream->state == FF_STREAM_WELCOMED ||
        (!stream->awaiting && !outstanding(stream)))
        return 0;
    if (stream->link.rtt_us) {
        stream->patience = 0;
        limit_us = round_trips_us > stream->answer_timeout_us ? round_trips_us
                                                              : stream->answer_timeout_us;
    }
    if (now_us - stream->heard_us <= limit_us) return 0;
    stream->patience += !stream->link.rtt_us && stream->patience < PATIENCE_MAX;
    return 1;
}

static int link_step(ff_stream *stream, int64_t now_us)
{
    int moved = 0;
    int rc = receive(stream, now_us, &moved);
    if (rc == FF_OK && stream->state == FF_STREAM_UP) {
        /* no answer was owed until now */
        if (!outstanding(stream) && !stream->awaiting) stream->heard_us = now_us;
        moved |= ask(stream, now_us);
        ask_about(stream, now_us);
        keep_alive(stream, now_us);
    }
    /* without a terrain nothing is asked for but what the greeting may bring */
    if (rc == FF_OK && stream->state == FF_STREAM_GREETING && !stream->has_terrain)
        moved |= ask(stream, now_us);
    if (rc == FF_OK) rc = flush(stream, now_us, &moved);
    if (rc == FF_OK && silent_too_long(stream, now_us)) rc = FF_ERR_CLOSED;
    if (rc != FF_OK) {
        stream->protocol_errors += rc != FF_ERR_CLOSED;
        give_up(stream, now_us);
        return 1;
    }
    return moved;
}

int ff_stream_step(ff_stream *stream, int64_t now_us)
{
    int moved = 0;
    switch (stream->state) {
        case FF_STREAM_CONNECTING:
        case FF_STREAM_DOWN: moved = connect_step(stream, now_us); break;
        case FF_STREAM_GREETING:
        case FF_STREAM_UP: moved = link_step(stream, now_us); break;
        case FF_STREAM_WELCOMED:
        case FF_STREAM_DEAD: return 0;
    }
    if (stream->state == FF_STREAM_GREETING && stream->send_count) {
        int ignored = 0;
        if (!stream->has_terrain) (void)ask(stream, now_us); /* in one piece with the greeting */
        if (flush(stream, now_us, &ignored) != FF_OK) give_up(stream, now_us);
    }
    publish(stream);
    return moved;
}
