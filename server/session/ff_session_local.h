/* How a session answers kinds; shared by ff_session*.c only. */
#ifndef FF_SESSION_LOCAL_H
#define FF_SESSION_LOCAL_H

#include "ff_session.h"

/* What to do when a kind is asked for, by the name in its row of ff_kind.h: answer, or see to it
 * that an answer comes. FF_OK, or a negative error: the session has ended. */
#define X(kind, name, asked_by, what, asks, answered_by, brings, section, levels, data, has_image, \
          server)                                                                                  \
    int ff_session_ask_##server(ff_session *session, const ff_message *ask);
FF_KIND_LIST(X)
#undef X

/* The payload of an answer: its bytes, or a negative error that is answered instead. *payload stays
 * valid until the next call. */
typedef int ff_session_fetch(const ff_session *session, enum ff_kind kind, unsigned layer,
                             ff_key key, const uint8_t **payload);

/* For kinds of one node that one payload answers: the request waits in turn until the answer finds
 * room in the buffer, and is fetched then. */
int ff_session_queue(ff_session *session, const ff_message *ask, ff_session_fetch *fetch);

#endif
