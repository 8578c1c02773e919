/* A session under any bytes, cut anyhow, read anyhow, with faces and sectors that come late, wrong
 * or never. Input: a byte of limits, then steps of one byte each: kind in the two lowest bits,
 * amount n in the rest.
 *   0, 1: the next n bytes come from the client; 2: it reads 16*n bytes; 3: n/4 seconds pass, and a
 *       face or sector is asked for or comes back.
 */
#include "../rig/pack_fixture.h"
#include "../../server/session/ff_session.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

static const ff_pack *the_pack(void)
{
    static ff_pack pack;
    static uint8_t *bytes;
    if (!bytes) {
        pack_fixture_desc desc = { .info = pack_fixture_info(5, 2, 1),
                                   .height = pack_fixture_hills,
                                   .about = { (const uint8_t *)"\1\5Hills\2\2us", 11 } };
        size_t size;
        bytes = pack_fixture_make(&desc, &size);
        if (!bytes || ff_pack_open(&pack, bytes, size) != FF_OK) abort();
    }
    return &pack;
}

typedef struct fuzz_run {
    ff_session *session;
    ff_face_job job;
    int job_out;
    int64_t now_us;
} fuzz_run;

static void feed(fuzz_run *run, const uint8_t *bytes, size_t count)
{
    while (count > 0) {
        int taken = ff_session_receive(run->session, bytes, count, run->now_us);
        if (taken <= 0) return; /* the session closed or is full: this client loses the rest */
        bytes += taken;
        count -= (size_t)taken;
    }
}

/* The server must send whole, known messages only. */
static void drain(fuzz_run *run, size_t most)
{
    const uint8_t *bytes;
    ff_message message;
    size_t count = ff_session_output(run->session, &bytes), sent = 0;
    while (sent < count && sent < most) {
        int used = ff_message_decode(bytes + sent, count - sent, &message);
        if (used <= 0) abort();
        sent += (size_t)used;
    }
    ff_session_sent(run->session, sent);
}

static ff_message drawn(const ff_face_job *job)
{
    uint8_t flags = (uint8_t)(FF_FACE_EMPTY | (job->last ? FF_FACE_LAST : 0));
    ff_message message = { .type = FF_MSG_ANSWER, .kind = (enum ff_kind)job->kind };
    if (job->kind == FF_KIND_FAR)
        message.u.far = (ff_far){ .sector = job->face, .flags = flags };
    else
        message.u.face = (ff_face){ .id = job->request.id,
                                    .face = job->face,
                                    .face_size = job->request.face_size,
                                    .flags = flags };
    return message;
}

static void face(fuzz_run *run, unsigned amount)
{
    uint8_t bytes[64];
    run->now_us += amount * INT64_C(250000);
    ff_session_idle(run->session, run->now_us);
    if (!run->job_out) {
        run->job_out = ff_session_next_face(run->session, &run->job);
        return;
    }
    ff_message message = drawn(&run->job);
    int count = amount % 3 == 0 ? FF_ERR_SYSTEM : ff_message_encode(&message, bytes, sizeof bytes);
    run->job_out = 0;
    ff_session_face_done(run->session, &run->job, bytes, count);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    ff_session_desc desc = { .pack = the_pack() };
    if (count == 0) return 0;
    desc.out_bytes_max = bytes[0] & 1 ? 0 : 1 + bytes[0] * 8u;
    desc.requests_max = bytes[0] & 2 ? 0 : 1 + bytes[0] / 16u;
    desc.panoramas_per_minute = bytes[0] & 4 ? 0 : 3;
    fuzz_run run = { .session = ff_session_create(&desc) };
    if (!run.session) abort();
    for (size_t at = 1; at < count;) {
        unsigned kind = bytes[at] & 3, amount = bytes[at] >> 2;
        at++;
        if (kind < 2) {
            size_t piece = amount < count - at ? amount : count - at;
            feed(&run, bytes + at, piece);
            at += piece;
        } else if (kind == 2) {
            drain(&run, 16u * amount);
        } else {
            face(&run, amount);
        }
    }
    ff_session_end(run.session, FF_ERR_CLOSED);
    drain(&run, SIZE_MAX);
    ff_session_destroy(run.session);
    return 0;
}
