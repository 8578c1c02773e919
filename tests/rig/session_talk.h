/* Talking to a session in the same process, message by message. */
#ifndef SESSION_TALK_H
#define SESSION_TALK_H

#include "../../server/session/ff_session.h"

/* What the session says to a message at that time: its bytes, all of them taken, or an error. */
int session_tell_at(ff_session *session, const ff_message *message, int64_t now_us);
static inline int session_tell(ff_session *session, const ff_message *message)
{
    return session_tell_at(session, message, 0);
}
/* Takes the next message off the output; type 0: there is none. What it points into stays until the
 * next call. */
ff_message session_heard(ff_session *session);
/* HELLO and CAPS, and the WELCOME that answers them. */
void session_greet(ff_session *session);
/* Asks for tile 0 whole, from its root down, as one view. */
ff_message session_deep_view(void);

#endif
