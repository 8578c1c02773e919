/* One client as the server sees it: bytes in, bytes out, limits. No sockets, processes or clock:
 * the worker process feeds it from a socket, sim/ from a simulated link, tests from arrays. Nothing
 * a client sends can do more than end its own session.
 */
#ifndef FF_SESSION_H
#define FF_SESSION_H

#include "../../protocol/message/ff_message.h"
#include "../../protocol/ff_pack.h"

typedef struct ff_session ff_session;

typedef struct ff_session_desc {
    const ff_pack *pack;
    /* answers buffered (and one face besides); 0: 256 kB. While the buffer is full, requests wait
     * in a queue, so that a CANCEL still reaches them; without room even for short answers, bytes
     * wait unread */
    uint32_t out_bytes_max;
    /* requests waiting; 0: 256; more closes the session (GOODBYE, FULL) */
    uint32_t requests_max;
    uint32_t panoramas_per_minute; /* and far sets; 0: 120; more are answered FAILED(FULL) */
    uint32_t lacks;                /* bits of FF_LACKS_: what is never drawn, the client is told */
    uint32_t views_per_minute; /* 0: 60, 8 at once; more get what they name and nothing below it */
    uint32_t idle_ms_max;      /* no message for this long closes; 0: 10 minutes */
    int64_t now_us; /* time of the connection: idle counts from here until it is welcomed */
} ff_session_desc;

typedef struct ff_session_stats {
    uint64_t bytes_in, bytes_out;
    uint32_t answers[FF_DATA_CLASSES]; /* those that brought something */
    uint32_t panoramas, far_sets, views, failed, cancelled;
    uint32_t damaged; /* of the failed: records whose checksum is wrong */
} ff_session_stats;

ff_session *ff_session_create(const ff_session_desc *desc); /* malloc; NULL when out of memory */
void ff_session_destroy(ff_session *session);

/* Bytes from the client. Returns bytes taken (fewer while the out buffer is full: offer the rest
 * again after ff_session_sent), or a negative error: send what is pending (a GOODBYE), then
 * close. */
int ff_session_receive(ff_session *session, const uint8_t *bytes, size_t count, int64_t now_us);
/* Pending output: count and *bytes. After sending n of them call ff_session_sent(n). */
size_t ff_session_output(ff_session *session, const uint8_t **bytes);
void ff_session_sent(ff_session *session, size_t count);
/* Ends the session from the server's side: GOODBYE with `reason` (a negative error), then as after
 * an error of ff_session_receive. */
void ff_session_end(ff_session *session, int reason);
/* 1 when idle for too long. */
int ff_session_idle(const ff_session *session, int64_t now_us);

/* Panoramas and far sets are rendered elsewhere: the next face or sector to render, 1 and the job,
 * or 0. At most one of a session is out at a time, and a newer request for either supersedes the
 * faces or sectors of an older one not yet rendered (its id is answered CANCELLED). */
typedef struct ff_face_job {
    enum ff_kind kind;       /* FF_KIND_FACE or FF_KIND_FAR */
    ff_get_panorama request; /* of a face */
    ff_get_far far;          /* of a sector */
    uint8_t face;            /* or sector */
    uint8_t last;
} ff_face_job;
int ff_session_next_face(ff_session *session, ff_face_job *job);
/* Takes the rendered face, a complete message; or a negative error, which is answered FAILED. A
 * face that was superseded is thrown away here. */
void ff_session_face_done(ff_session *session, const ff_face_job *job, const uint8_t *message,
                          int bytes_or_error);

void ff_session_get_stats(const ff_session *session, ff_session_stats *stats);

#endif
