/* The network worker's half of the client: one connection, greeted, kept alive, made again when
 * lost (Hybrid, section 8.2). A non-blocking step(); whoever calls it is the worker. Bytes come and
 * go through a sys_stream, decoded answers leave through the new-data list, requests come out of
 * the request queue. Nothing here knows the tree or a graphics API.
 *
 *   CONNECTING --connected--> GREETING --WELCOME, new terrain----> WELCOMED --ff_stream_accept-->
 * UP
 *                                      --WELCOME, terrain held--------------------------------> UP
 *   any state  --closed, nonsense or silent too long--> DOWN --after 0.5, 1, 2 .. 30 s-->
 * CONNECTING
 *              --the same, and no way to reconnect----> DEAD
 */
#ifndef FF_STREAM_H
#define FF_STREAM_H

#include "../../ask/ff_intake.h"
#include "../../../protocol/message/ff_parts.h"
#include "ff_link_estimate.h"

#define FF_STREAM_SEND_BYTES 2048
#define FF_BACKOFF_US_MIN    500000
#define FF_BACKOFF_US_MAX    30000000

enum ff_stream_state {
    FF_STREAM_CONNECTING,
    FF_STREAM_GREETING,
    FF_STREAM_WELCOMED,
    FF_STREAM_UP,
    FF_STREAM_DOWN,
    FF_STREAM_DEAD
};

/* What the main thread reads of the worker, and tells it; guarded by the request queue's lock. */
typedef struct ff_stream_shared {
    enum ff_stream_state state;
    uint32_t received; /* bytes of messages that have not come whole yet */
    uint64_t bytes_down, bytes_up, answer_bytes[FF_KIND_COUNT];
    uint32_t received_high; /* the most ever */
    uint32_t about_bytes;   /* of what the pack says of itself */
    uint32_t protocol_errors, reconnects, rtt_us, bytes_s;
    uint32_t losses; /* connections lost: what was asked is to be ranked again */
    int8_t refusal;  /* why the server would not have this client: an error, or FF_OK */
    uint8_t quiet;   /* main: ask nothing new (interruption) */
    uint8_t no_prefetch;
    uint32_t allowed_bytes_s; /* main: of ff_stream_allow */
    uint8_t hurry;  /* main: the viewer turns, what is asked for ahead does not wait for company */
    uint32_t lacks; /* FF_LACKS_ of the last WELCOME */
} ff_stream_shared;

/* What the pack says of itself, asked for once the first ground is here. */
enum ff_stream_about_state { FF_ABOUT_UNKNOWN, FF_ABOUT_ASKED, FF_ABOUT_HERE };

typedef struct ff_stream_about {
    uint32_t entries; /* FF_ABOUT_BIT of those wanted; 0: it is not asked for */
    uint8_t *bytes;   /* room for ff_about_bytes_max(entries) */
    /* under the request queue's lock */
    uint32_t byte_count;
    enum ff_stream_about_state state;
} ff_stream_about;

typedef struct ff_stream {
    sys_stream *io;
    ff_intake *intake;
    uint16_t in_flight_max;
    int64_t answer_timeout_us;
    /* the server is told that nothing beyond is looked at (FF_CAPS_REACH); INT32_MAX: it is not.
     * Changed before a restart alone */
    int32_t reach_wu;
    /* worker only */
    enum ff_stream_state state;
    uint8_t has_terrain; /* the client's pools hold the grounds of `intake` */
    uint8_t attempt;     /* CONNECTING: 1 when reconnect() has to be called */
    uint8_t blocked;     /* the new-data list is full */
    uint8_t *recv;
    uint32_t recv_bytes, recv_count, recv_high, skip;
    uint8_t send[FF_STREAM_SEND_BYTES];
    uint32_t send_count;
    int64_t retry_us, backoff_us, connect_us, heard_us, sent_us;
    int64_t ahead_us; /* when something was last asked for ahead */
    uint8_t awaiting; /* HELLO, PING or GET_ABOUT unanswered */
    uint8_t layer;    /* of images, as the server was told last */
    uint8_t view_out; /* 1: parts answer the view that was sent, or will */
    uint8_t patience; /* how often the time-out has been doubled */
    ff_link_estimate link;
    ff_parts parts; /* of that view */
    uint64_t bytes_down, bytes_up, answer_bytes[FF_KIND_COUNT];
    uint32_t protocol_errors, reconnects, losses;
    ff_stream_about about; /* of the terrain held */
    int64_t welcomed_us;
    int64_t purse, purse_us; /* byte microseconds that are left, and when that was */
    uint64_t purse_down;     /* bytes_down then */
    ff_stream_shared shared;
    /* in WELCOMED, where the worker waits, for the main thread: the grounds, and the checksum of
     * the whole pack that each is a part of */
    ff_terrain_info welcome[FF_WELCOME_GROUNDS];
    uint32_t whole[FF_WELCOME_GROUNDS];
    uint8_t welcome_count;
    ff_layers layers; /* over them */
} ff_stream;

void ff_stream_init(ff_stream *stream, sys_stream *io, ff_intake *intake, unsigned in_flight_max,
                    uint32_t answer_timeout_ms, uint8_t *recv, uint32_t recv_bytes);
/* Before the first step: wants what the pack says of itself, those entries, in `bytes` of
 * ff_about_bytes_max(entries). */
void ff_stream_want_about(ff_stream *stream, uint32_t entries, uint8_t *bytes);
/* Copies an entry into `value`: its bytes, or FF_ERR_AGAIN: nothing has come yet; FF_ERR_NOT_FOUND:
 * the pack does not say; FF_ERR_FULL. */
int ff_stream_about_entry(ff_stream *stream, unsigned entry, uint8_t *value, size_t room);
/* Sends, receives, decodes. 1 when anything moved. */
int ff_stream_step(ff_stream *stream, int64_t now_us);
/* Says that the pools for the terrain of WELCOME are ready (ok), or that the terrain does not fit:
 * then the connection is given up. Not while stepping. */
void ff_stream_accept(ff_stream *stream, int ok);
/* Forgets the terrain held and connects anew at once. Not while stepping. */
void ff_stream_restart(ff_stream *stream);
void ff_stream_get_shared(ff_stream *stream, ff_stream_shared *shared);
void ff_stream_say(ff_stream *stream, int quiet, int no_prefetch);
void ff_stream_hurry(ff_stream *stream, int hurry);
/* So many bytes may come in a second, and four seconds more that were saved up; 0: as many as do.
 */
void ff_stream_allow(ff_stream *stream, uint32_t bytes_s);
void ff_stream_close(ff_stream *stream);

#endif
