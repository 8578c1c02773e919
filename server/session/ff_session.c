/* One client's session: a small parser, a queue of requests and a buffer of answers.
 *
 * Room in the buffer: nodes and textures up to out_bytes_max, above that one face of a panorama or
 * sector of a far set, above that short answers (FAILED, CANCELLED, PONG), and a last reserve for
 * the GOODBYE. So a slow reader costs a fixed amount of memory, and its own reading says when to go
 * on.
 */
#include "ff_session_local.h"
#include "../packs/ff_packs.h"
#include "../packs/ff_packs_entered.h"
#include "../view/ff_view_answer.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#define IN_BYTES            (FF_CAPS_BYTES_MAX + 128) /* the longest client message, and more */
#define SHORT_ANSWER_BYTES  64 /* ABOUT aside, more than any answer without a payload needs */
#define ABOUT_BYTES         (FF_MESSAGE_HEADER_MAX + FF_ABOUT_BYTES_MAX) /* WELCOME is shorter */
#define SHORT_ANSWERS_BYTES 8192 /* reserve for short answers */
#define FACE_BYTES          (FF_MESSAGE_BODY_MAX + FF_MESSAGE_HEADER_MAX)
#define MINUTE_US           60000000
#define VIEWS_AT_ONCE       8 /* one can take 0.1 s, in which no other client is heard */
#define VIEW_BYTES          4096 /* of parts that wait in the buffer, so that a CANCEL stops the rest */

typedef struct request {
    ff_session_fetch *fetch; /* NULL: cancelled */
    enum ff_kind kind;
    ff_key key;
    uint16_t id;   /* 0: it has none */
    uint8_t sides; /* as in ff_get */
    uint8_t layer; /* of images */
} request;

/* How often something dear may be asked for: some at once, then as time goes by. */
typedef struct allowance {
    int64_t credit_us, time_us;
} allowance;

struct ff_session {
    ff_session_desc desc;
    ff_session_stats stats;
    int error;                 /* not 0: the session is over */
    int greeted, welcomed;     /* HELLO has come; CAPS has, too */
    const ff_pack *pack;       /* as the client has it: */
    ff_packs_entered *entered; /* NULL: all of it */
    uint8_t layer;             /* of images, as told last */
    int64_t now_us, last_message_us;

    uint8_t in[IN_BYTES]; /* the beginning of one message, never a whole one */
    size_t in_count;

    request *queue; /* [queue_first, queue_end) wait, some of them cancelled */
    uint32_t queue_first, queue_end, queue_live;

    ff_face_job drawing; /* the panorama or far set being served, if drawing_on */
    int drawing_on, job_out, job_stale;
    uint8_t next_face; /* index into its list of faces or sectors */
    allowance drawings, views;
    ff_view_answer view; /* the one being served, which waits in the queue like any request */

    uint8_t *out; /* [out_first, out_end) waits to be sent */
    size_t out_first, out_end, out_capacity;
};

static uint32_t or_default(uint32_t value, uint32_t instead) { return value ? value : instead; }

static ff_session_desc desc_with_defaults(const ff_session_desc *desc)
{
    ff_session_desc full = *desc;
    full.out_bytes_max = or_default(desc->out_bytes_max, 256u << 10);
    full.requests_max = or_default(desc->requests_max, 256);
    full.panoramas_per_minute = or_default(desc->panoramas_per_minute, 120);
    full.views_per_minute = or_default(desc->views_per_minute, 60);
    full.idle_ms_max = or_default(desc->idle_ms_max, 10u * 60u * 1000u);
    return full;
}

ff_session *ff_session_create(const ff_session_desc *desc)
{
    ff_session *session = calloc(1, sizeof *session);
    if (!session) return NULL;
    session->desc = desc_with_defaults(desc);
    session->pack = session->desc.pack;
    session->out_capacity = (size_t)session->desc.out_bytes_max + FACE_BYTES + SHORT_ANSWERS_BYTES +
                            2 * SHORT_ANSWER_BYTES;
    session->queue = calloc(session->desc.requests_max, sizeof *session->queue);
    /* the buffer is large, but the system hands out its pages only as they are used */
    session->out = malloc(session->out_capacity);
    if (!session->queue || !session->out) {
        ff_session_destroy(session);
        return NULL;
    }
    session->now_us = session->last_message_us = desc->now_us;
    session->drawings = session->views = (allowance){ MINUTE_US, desc->now_us };
    return session;
}

void ff_session_destroy(ff_session *session)
{
    if (!session) return;
    free(session->queue);
    ff_view_answer_free(&session->view);
    ff_packs_leave(session->entered);
    free(session->out);
    free(session);
}

static int allowed(const ff_session *session, allowance *of, uint32_t per_minute, uint32_t at_once)
{
    int64_t cost_us = MINUTE_US / per_minute, most_us = cost_us * at_once,
            gained_us = session->now_us - of->time_us;
    of->time_us = session->now_us;
    if (gained_us >= 0)
        of->credit_us = gained_us >= most_us - of->credit_us ? most_us : of->credit_us + gained_us;
    if (of->credit_us < cost_us) return 0;
    of->credit_us -= cost_us;
    return 1;
}

/* ---- answers ---- */

static size_t out_pending(const ff_session *session)
{
    return session->out_end - session->out_first;
}

/* Room for `bytes` at the end of the buffer; the caller has checked that they fit. */
static uint8_t *out_room(ff_session *session, size_t bytes)
{
    assert(out_pending(session) + bytes <= session->out_capacity);
    if (session->out_end + bytes > session->out_capacity) {
        memmove(session->out, session->out + session->out_first, out_pending(session));
        session->out_end = out_pending(session);
        session->out_first = 0;
    }
    return session->out + session->out_end;
}

static void answer_short(ff_session *session, const ff_message *message)
{
    size_t room = ff_message_bytes_max(message);
    int bytes = ff_message_encode(message, out_room(session, room), room);
    assert(bytes > 0);
    session->out_end += (size_t)bytes;
}

static void answer_failed(ff_session *session, uint16_t id, int error)
{
    ff_message message = { .type = FF_MSG_FAILED,
                           .u.failed = { .id = id, .error = (int8_t)error } };
    session->stats.failed++;
    answer_short(session, &message);
}

static void answer_cancelled(ff_session *session, uint16_t id)
{
    ff_message message = { .type = FF_MSG_CANCELLED, .u.cancel = { .id = id } };
    session->stats.cancelled++;
    answer_short(session, &message);
}

/* 1 when any client message can be taken: a message may need two short answers (a panorama that
 * supersedes and is refused), and a GOODBYE after it needs room of its own. */
static int short_answers_fit(const ff_session *session)
{
    return out_pending(session) + ABOUT_BYTES + 3 * SHORT_ANSWER_BYTES <=
           session->out_capacity - FACE_BYTES;
}

static int end_session(ff_session *session, int error)
{
    ff_message message = { .type = FF_MSG_GOODBYE,
                           .u.failed = { .id = 0, .error = (int8_t)error } };
    session->error = error;
    answer_short(session, &message);
    return error;
}

/* ---- what waits in turn ---- */

static int fetch_answer(const ff_session *session, const request *wanted, ff_message *message)
{
    *message = (ff_message){ .type = FF_MSG_ANSWER, .kind = wanted->kind };
    int bytes = wanted->fetch(session, wanted->kind, wanted->layer, wanted->key,
                              &message->u.data.bytes);
    if (bytes < 0) return bytes;
    message->u.data.byte_count = (uint32_t)bytes;
    return ff_message_bytes_max(message) <= FACE_BYTES ? FF_OK : FF_ERR_FULL;
}

/* Puts an answer of a kind into the buffer while less than `bytes_max` waits there, or nothing:
 * what is longer goes alone, and where it leaves no room for the face being drawn, after that. 1,
 * 0: there is no room for it yet, or a negative error: it is too long. */
static int put_answer(ff_session *session, const ff_message *message, size_t bytes_max)
{
    size_t room = ff_message_bytes_max(message);
    int alone = out_pending(session) == 0 &&
                (room <= session->desc.out_bytes_max || !session->job_out);
    if (out_pending(session) + room > bytes_max && !alone) return 0;
    int rc = ff_message_encode(message, out_room(session, room), room);
    if (rc < 0) return rc;
    session->out_end += (size_t)rc;
    return 1;
}

/* What cannot be answered; 1, or 0 when the buffer has no room for that yet. */
static int put_error(ff_session *session, uint16_t id, int error)
{
    if (!short_answers_fit(session)) return 0;
    session->stats.damaged += error == FF_ERR_CHECKSUM;
    answer_failed(session, id, error);
    return 1;
}

static int serve_payload(ff_session *session, const request *wanted)
{
    ff_message message;
    uint8_t less[FF_PAYLOAD_BYTES_MAX];
    int rc = fetch_answer(session, wanted, &message);
    if (rc == FF_OK && wanted->kind == FF_KIND_REFINEMENT)
        rc = ff_leave_out(session->pack, wanted->key, wanted->sides, less, &message.u.data);
    if (rc == FF_OK) rc = put_answer(session, &message, session->desc.out_bytes_max);
    if (rc < 0) return put_error(session, wanted->id, rc);
    session->stats.answers[ff_kind[wanted->kind].data] += (uint32_t)rc;
    return rc;
}

/* Sends the next messages of the view; 1 when it is whole, 0: there is no room for the next one. */
static int serve_view(ff_session *session)
{
    ff_message message;
    uint8_t less[FF_PAYLOAD_BYTES_MAX];
    int error;
    size_t bytes_max = VIEW_BYTES < session->desc.out_bytes_max ? VIEW_BYTES
                                                                : session->desc.out_bytes_max;
    while (ff_view_answer_next(&session->view, session->pack, less, &message, &error)) {
        if (put_answer(session, &message, bytes_max) <= 0) return 0;
        ff_view_answer_sent(&session->view, &message);
        session->stats.damaged += error == FF_ERR_CHECKSUM;
        session->stats.answers[FF_DATA_HEIGHTS] += message.type == FF_MSG_ANSWER &&
                                                   message.u.part.byte_count;
    }
    return 1;
}

/* Answers a request; 1 when answered, 0 when the buffer has no room for the answer yet. */
static int serve(ff_session *session, const request *wanted)
{
    return wanted->kind == FF_KIND_VIEW ? serve_view(session) : serve_payload(session, wanted);
}

static void serve_queue(ff_session *session)
{
    while (session->queue_first < session->queue_end) {
        const request *wanted = &session->queue[session->queue_first];
        if (wanted->fetch) {
            if (!serve(session, wanted)) return;
            session->queue_live--;
        }
        session->queue_first++;
    }
    session->queue_first = session->queue_end = 0;
}

static void queue_compact(ff_session *session)
{
    uint32_t kept = 0;
    for (uint32_t i = session->queue_first; i < session->queue_end; i++)
        if (session->queue[i].fetch) session->queue[kept++] = session->queue[i];
    session->queue_first = 0;
    session->queue_end = kept;
}

static int enqueue(ff_session *session, request wanted)
{
    if (session->queue_live == session->desc.requests_max) return end_session(session, FF_ERR_FULL);
    if (session->queue_end == session->desc.requests_max) queue_compact(session);
    session->queue[session->queue_end++] = wanted;
    session->queue_live++;
    serve_queue(session);
    return FF_OK;
}

int ff_session_queue(ff_session *session, const ff_message *ask, ff_session_fetch *fetch)
{
    assert(ff_kind[ask->kind].asks == FF_ASKS_NODE &&
           ff_kind[ask->kind].brings == FF_BRINGS_PAYLOAD);
    return enqueue(session, (request){ fetch, ask->kind, ask->u.get.key, 0, ask->u.get.sides,
                                       session->layer });
}

static int fetch_record(const ff_session *session, enum ff_kind kind, unsigned layer, ff_key key,
                        const uint8_t **payload)
{
    enum ff_section_kind section = (enum ff_section_kind)ff_kind[kind].section;
    if (section == FF_SECTION_TEXTURE)
        return ff_pack_layer_record(session->pack, layer, key, payload);
    return ff_pack_record(session->pack, section, key, payload);
}

int ff_session_ask_record(ff_session *session, const ff_message *ask)
{
    return ff_session_queue(session, ask, fetch_record);
}

/* ---- views ---- */

/* Who asks for views too often gets what it names: that costs no more than single requests. */
int ff_session_ask_view(ff_session *session, const ff_message *ask)
{
    const ff_get_view *wanted = &ask->u.view;
    int rc = ff_view_answer_begin(
        &session->view, session->pack, wanted,
        session->view.on ||
            allowed(session, &session->views, session->desc.views_per_minute, VIEWS_AT_ONCE));
    if (rc < 0) {
        answer_failed(session, wanted->id, rc);
        return FF_OK;
    }
    session->stats.views++;
    return enqueue(session, (request){ fetch_record, ask->kind, 0, wanted->id, 0, 0 });
}

/* ---- panoramas and far sets ---- */

static void drawing_drop(ff_session *session)
{
    session->drawing_on = 0;
    session->job_stale = session->job_out;
}

static uint16_t drawing_id(const ff_face_job *job)
{
    return job->kind == FF_KIND_FAR ? job->far.id : job->request.id;
}

static int draw(ff_session *session, ff_face_job job)
{
    if (!allowed(session, &session->drawings, session->desc.panoramas_per_minute,
                 session->desc.panoramas_per_minute)) {
        answer_failed(session, drawing_id(&job), FF_ERR_FULL);
        return FF_OK;
    }
    if (session->drawing_on) {
        answer_cancelled(session, drawing_id(&session->drawing));
        drawing_drop(session);
    }
    *(job.kind == FF_KIND_FAR ? &session->stats.far_sets : &session->stats.panoramas) += 1;
    session->drawing = job;
    session->drawing_on = 1;
    session->next_face = 0;
    return FF_OK;
}

int ff_session_ask_faces(ff_session *session, const ff_message *ask)
{
    ff_face_job job = { .kind = ask->kind, .request = ask->u.panorama };
    job.request.layer = session->layer;
    return draw(session, job);
}

int ff_session_ask_far(ff_session *session, const ff_message *ask)
{
    ff_face_job job = { .kind = ask->kind, .far = ask->u.get_far };
    job.far.layer = session->layer;
    return draw(session, job);
}

int ff_session_next_face(ff_session *session, ff_face_job *job)
{
    if (session->error || !session->drawing_on || session->job_out ||
        out_pending(session) > session->desc.out_bytes_max)
        return 0;
    *job = session->drawing;
    int far = job->kind == FF_KIND_FAR;
    job->face = (far ? job->far.sector : job->request.face)[session->next_face];
    job->last = session->next_face + 1 == (far ? job->far.sector_count : job->request.face_count);
    session->job_out = 1;
    session->job_stale = 0;
    return 1;
}

void ff_session_face_done(ff_session *session, const ff_face_job *job, const uint8_t *message,
                          int bytes_or_error)
{
    assert(session->job_out);
    session->job_out = 0;
    if (session->error) return;
    if (session->job_stale) {
        serve_queue(session); /* an answer may have waited for the face */
        return;
    }
    assert(session->drawing_on && drawing_id(&session->drawing) == drawing_id(job));
    if (bytes_or_error > (int)FACE_BYTES || bytes_or_error == 0) bytes_or_error = FF_ERR_RANGE;
    if (bytes_or_error < 0) {
        session->drawing_on = 0;
        answer_failed(session, drawing_id(job), bytes_or_error);
        return;
    }
    memcpy(out_room(session, (size_t)bytes_or_error), message, (size_t)bytes_or_error);
    session->out_end += (size_t)bytes_or_error;
    session->stats.answers[ff_kind[job->kind].data]++;
    session->next_face++;
    if (job->last) session->drawing_on = 0;
    serve_queue(session);
}

/* ---- messages ---- */

static void cancel(ff_session *session, uint16_t id)
{
    if (session->drawing_on && drawing_id(&session->drawing) == id) {
        drawing_drop(session);
        answer_cancelled(session, id);
        return;
    }
    for (uint32_t i = session->queue_first; i < session->queue_end; i++) {
        request *waiting = &session->queue[i];
        if (waiting->fetch && waiting->id && waiting->id == id) {
            waiting->fetch = NULL;
            if (waiting->kind == FF_KIND_VIEW) session->view.on = 0;
            session->queue_live--;
            answer_cancelled(session, id);
            serve_queue(session); /* the cancelled request may have been the one without room */
            return;
        }
    }
    /* Answered already: the answer is under way, and is all the client needs. */
}

static int hello(ff_session *session, const ff_hello *greeting)
{
    if (session->greeted) return end_session(session, FF_ERR_FORMAT);
    if (greeting->version != FF_PROTOCOL_VERSION) return end_session(session, FF_ERR_VERSION);
    session->greeted = 1;
    return FF_OK;
}

/* Who looks no further than so far gets the packs without the levels that are too coarse for it. A
 * server that has no memory for that hands out all of them. */
static void enter_packs(ff_session *session, ff_list told)
{
    const uint8_t *value;
    if (ff_list_find(told, FF_CAPS_REACH, &value) != 4) return;
    ff_reader in = { value, value + 4, FF_OK };
    uint64_t reach_wu = ff_read_bytes(&in, 4);
    if (reach_wu <= INT32_MAX)
        (void)ff_packs_enter(session->desc.pack, (int32_t)reach_wu, &session->entered);
    if (session->entered) session->pack = ff_packs_entered_first(session->entered);
}

/* Nothing else that a client says of itself changes the answers yet. */
static int caps(ff_session *session, ff_list told)
{
    uint8_t more[FF_WELCOME_BYTES_MAX];
    if (!session->greeted || session->welcomed) return end_session(session, FF_ERR_FORMAT);
    ff_message welcome = { .type = FF_MSG_WELCOME };
    welcome.u.welcome.version = FF_PROTOCOL_VERSION;
    enter_packs(session, told);
    welcome.u.welcome.info = session->pack->header.info;
    welcome.u.welcome.more = ff_packs_welcome(session->pack, session->desc.lacks, more);
    session->welcomed = 1;
    answer_short(session, &welcome);
    return FF_OK;
}

/* A pack that says nothing of itself, or nonsense, is an empty list. */
static void about(ff_session *session, uint32_t entries)
{
    uint8_t all[FF_ABOUT_BYTES_MAX], bytes[FF_ABOUT_BYTES_MAX];
    int count = ff_about_select(ff_packs_about(session->desc.pack, all), entries, bytes,
                                sizeof bytes);
    assert(count >= 0);
    answer_short(session,
                 &(ff_message){ .type = FF_MSG_ABOUT, .u.list = { bytes, (uint32_t)count } });
}

static int take_request(ff_session *session, const ff_message *message)
{
    switch (message->kind) {
#define X(kind, name, asked_by, what, asks, answered_by, brings, section, levels, data, has_image, \
          server)                                                                                  \
    case FF_KIND_##kind: return ff_session_ask_##server(session, message);
        FF_KIND_LIST(X)
#undef X
        case FF_KIND_COUNT: break;
    }
    return end_session(session, FF_ERR_FORMAT);
}

static int handle(ff_session *session, const ff_message *message)
{
    if (message->type == FF_MSG_HELLO) return hello(session, &message->u.hello);
    if (message->type == FF_MSG_CAPS) return caps(session, message->u.list);
    if (!session->welcomed) return end_session(session, FF_ERR_FORMAT);
    switch (message->type) {
        case FF_MSG_GET: return take_request(session, message);
        case FF_MSG_LAYER: session->layer = message->u.layer.layer; return FF_OK;
        case FF_MSG_GET_ABOUT: about(session, message->u.get_about.entries); return FF_OK;
        case FF_MSG_CANCEL: cancel(session, message->u.cancel.id); return FF_OK;
        case FF_MSG_PING:
            answer_short(session, &(ff_message){ .type = FF_MSG_PONG, .u.ping = message->u.ping });
            return FF_OK;
        default: /* kept out by take_message */ return end_session(session, FF_ERR_FORMAT);
    }
}

/* Takes one message out of `in` and the bytes after it. Returns how many of `bytes` were taken or a
 * negative error; *complete tells whether there was a whole message. */
static int take_message(ff_session *session, const uint8_t *bytes, size_t count, int *complete)
{
    size_t held = session->in_count;
    size_t added = count < IN_BYTES - held ? count : IN_BYTES - held;
    memcpy(session->in + held, bytes, added);
    ff_message message;
    /* What no client says is refused by its first byte: a peer that speaks another protocol need
     * not be heard out. */
    int used = ff_message_from_client(session->in[0])
                   ? ff_message_decode(session->in, held + added, &message)
                   : FF_ERR_FORMAT;
    *complete = used > 0;
    if (used < 0) return end_session(session, used);
    if (used == 0) {
        if (held + added == IN_BYTES) /* no client message is that long */
            return end_session(session, FF_ERR_FORMAT);
        session->in_count = held + added;
        return (int)added;
    }
    assert((size_t)used > held);
    session->in_count = 0;
    int rc = handle(session, &message);
    if (session->welcomed) session->last_message_us = session->now_us;
    return rc < 0 ? rc : used - (int)held;
}

int ff_session_receive(ff_session *session, const uint8_t *bytes, size_t count, int64_t now_us)
{
    size_t taken = 0;
    int complete = 1;
    if (now_us > session->now_us) session->now_us = now_us;
    if (count > INT32_MAX) count = INT32_MAX;
    while (!session->error && complete && taken < count && short_answers_fit(session)) {
        int rc = take_message(session, bytes + taken, count - taken, &complete);
        if (rc >= 0) taken += (size_t)rc;
    }
    session->stats.bytes_in += taken;
    return session->error ? session->error : (int)taken;
}

size_t ff_session_output(ff_session *session, const uint8_t **bytes)
{
    *bytes = session->out + session->out_first;
    return out_pending(session);
}

void ff_session_sent(ff_session *session, size_t count)
{
    assert(count <= out_pending(session));
    session->out_first += count;
    session->stats.bytes_out += count;
    if (session->out_first == session->out_end) session->out_first = session->out_end = 0;
    if (!session->error) serve_queue(session);
}

void ff_session_end(ff_session *session, int reason)
{
    if (!session->error) end_session(session, reason);
}

int ff_session_idle(const ff_session *session, int64_t now_us)
{
    return now_us - session->last_message_us > (int64_t)session->desc.idle_ms_max * 1000;
}

void ff_session_get_stats(const ff_session *session, ff_session_stats *stats)
{
    *stats = session->stats;
}
