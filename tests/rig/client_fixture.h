/* A client over a server in the same process: the stream between them is an array that can be cut,
 * silenced, spoilt and chopped. Faces are made up: side faces show a strip of ground, UP and DOWN
 * are empty; so are sectors of far sets: each has one fin. Time is a number. */
#ifndef CLIENT_FIXTURE_H
#define CLIENT_FIXTURE_H

#include "pack_fixture.h"
#include "../../client/farfield.h"
#include "../../server/session/ff_session.h"

typedef struct client_rig {
    uint8_t *pack_bytes;
    ff_pack pack;
    ff_session *session; /* of the present connection; NULL: none */
    sys_stream stream;
    uint8_t inbox[4096]; /* sent by the client, not yet taken by the session */
    size_t inbox_count;

    /* faults; places are counted in bytes to the client since the start, UINT64_MAX: never */
    uint64_t cut_at, silent_at, spoil_at;
    uint8_t spoil_with; /* the byte at spoil_at becomes this, and all after it */
    int refuse;         /* no new connection */
    uint8_t version;    /* not 0: what the server hears of a HELLO's version */
    uint8_t about_set;  /* not 0: and of the entries that GET_ABOUT asks for */
    int no_faces;       /* the renderer never answers */
    uint32_t lacks;     /* the server tells: bits of FF_LACKS_ */
    unsigned spoilt;    /* bits of a far set's sectors whose fins are nonsense */
    unsigned chop;      /* recv gives at most this many bytes; 0: all there are */

    uint64_t bytes_down;
    unsigned connections;
    uint32_t asked[FF_KIND_COUNT]; /* messages from the client, by kind */
    uint32_t sides_left_out;       /* of refinements asked for singly */
    uint32_t pings, asked_about;
    uint64_t about_at; /* bytes_down when that was asked first */
    ff_list about;     /* what the pack says of itself */
    int32_t epsg;      /* of the place of its origin */
    int64_t origin_mm[2];
    int64_t now_us, frame_us; /* of server and worker; of the frames */

    void *memory;
    size_t memory_bytes;
    ff_client_desc desc;
    ff_client *client;
    c3d_camera camera;
    unsigned updates; /* updates that asked to be drawn */
} client_rig;

/* Opens the usual pack of hills, with images when texture_log2 is not 0; makes no client yet. */
void rig_open(client_rig *rig, unsigned texture_log2);
/* As rig_open, with nodes of another size. */
void rig_use_node_log2(client_rig *rig, unsigned node_log2, unsigned texture_log2);
/* As rig_open, with ground that ends earlier: 66 to 129 samples each way. */
void rig_use_samples(client_rig *rig, uint32_t samples_x, uint32_t samples_y,
                     unsigned texture_log2);
/* As rig_open, with images that are pictures, not JPEGs. */
void rig_use_pictures(client_rig *rig, unsigned texture_log2);
/* As rig_use_samples, with heights of codec trained, which can leave out sides. */
void rig_use_trained(client_rig *rig, uint32_t samples_x, uint32_t samples_y);
/* As rig_open, with a filled void (pack_fixture_hole). */
void rig_use_filled(client_rig *rig);
/* As rig_open, with nothing stored below level 1. */
void rig_use_leaves(client_rig *rig);
/* One in which nothing finer is stored of the roots' children, of heights and of images. */
void rig_use_stubs(client_rig *rig, unsigned texture_log2);
/* As rig_open, with a pack that says this of itself. */
void rig_use_about(client_rig *rig, ff_list about);
/* As rig_open, with ground that lies so many metres east and north in a reference system (0: none).
 */
void rig_use_place(client_rig *rig, int32_t epsg, int east_m, int north_m);
/* Serves another terrain on all further connections. */
void rig_change_terrain(client_rig *rig);
/* Makes a client with a block of `bytes` over the stream; the test sets rig->desc's other fields
 * before. */
void rig_client(client_rig *rig, size_t bytes);
/* Makes a client of rig->desc as it is. */
void rig_client_of(client_rig *rig, size_t bytes);
/* Makes a client over the pack itself. */
void rig_local_client(client_rig *rig, size_t bytes);
void rig_close(client_rig *rig);

/* Runs one frame, `us` later: server, worker, update. */
void rig_step(client_rig *rig, int64_t us);
/* Runs frames of 50 ms, 6 m north and east each, turning slowly. */
void rig_fly(client_rig *rig, unsigned frames);
/* Runs frames of 50 ms, at most `frames`, until for a while no request is queued or unanswered. 1
 * when settled. */
int rig_settle(client_rig *rig, unsigned frames);
ff_client_stats rig_stats(const client_rig *rig);
/* Roots and refinements that the present connection's server has answered with. */
uint32_t rig_heights(const client_rig *rig);
/* 1 when both show the same nodes, borders and heights. */
int rig_same_picture(const client_rig *a, const client_rig *b);

#endif
