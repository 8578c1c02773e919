/* Stands in for ff_stream.c in builds without network: ff_client_create takes a pack only. */
#include "ff_stream.h"

#include <string.h>

const uint8_t ff_link_built = 0;

void ff_stream_init(ff_stream *stream, sys_stream *io, ff_intake *intake, unsigned in_flight_max,
                    uint32_t answer_timeout_ms, uint8_t *recv, uint32_t recv_bytes)
{
    (void)stream, (void)io, (void)intake, (void)in_flight_max, (void)answer_timeout_ms, (void)recv,
        (void)recv_bytes;
}

void ff_stream_want_about(ff_stream *stream, uint32_t entries, uint8_t *bytes)
{
    (void)stream, (void)entries, (void)bytes;
}

int ff_stream_about_entry(ff_stream *stream, unsigned entry, uint8_t *value, size_t room)
{
    return (void)stream, (void)entry, (void)value, (void)room, FF_ERR_NOT_FOUND;
}

int ff_stream_step(ff_stream *stream, int64_t now_us) { return (void)stream, (void)now_us, 0; }
void ff_stream_accept(ff_stream *stream, int ok) { (void)stream, (void)ok; }
void ff_stream_restart(ff_stream *stream) { (void)stream; }
void ff_stream_get_shared(ff_stream *stream, ff_stream_shared *shared)
{
    (void)stream;
    memset(shared, 0, sizeof *shared);
}
void ff_stream_say(ff_stream *stream, int quiet, int no_prefetch)
{
    (void)stream, (void)quiet, (void)no_prefetch;
}
void ff_stream_close(ff_stream *stream) { (void)stream; }

void ff_stream_hurry(ff_stream *stream, int hurry)
{
    (void)stream;
    (void)hurry;
}
void ff_stream_allow(ff_stream *stream, uint32_t bytes_s) { (void)stream, (void)bytes_s; }
