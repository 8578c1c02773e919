/* Messages off the receive buffer, each checked against the request it answers. For ff_stream.c
 * only. */
#ifndef FF_RECEIVE_H
#define FF_RECEIVE_H

#include "ff_stream.h"

/* Takes in what the receive buffer holds. FF_OK (stream->blocked tells whether the new-data list is
 * full), FF_ERR_CLOSED when the server says goodbye, or another error: the peer speaks nonsense. */
int ff_receive_messages(ff_stream *stream, int64_t now_us);

#endif
