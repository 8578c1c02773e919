/* All that a flight needs, opened and closed: packs, grounds, link, server, surface and
 * client. */
#ifndef FLY_WORLD_H
#define FLY_WORLD_H

#include "fly_grounds.h"
#include "fly_path.h"
#include "fly_reference.h"
#include "../judge/sim_audit.h"
#include "../judge/sim_relevance.h"
#include "../link/sim_server.h"
#include "../tape/sim_tape.h"

typedef struct fly_world {
    const fly_options *options;
    int64_t now_us;      /* the clock of the flight */
    ff_packs packs;      /* the server's: its grounds */
    ff_packs locals;     /* on the device, each by itself */
    const ff_pack *pack; /* the first of the server's */
    ff_source_desc more[FF_SOURCES_MAX - 1];
    fly_grounds grounds; /* of both */
    sim_auditor *auditor;
    sim_fins fins; /* of the client's far sets, for the auditor */
    fly_path path;
    ff_geo geo;     /* of the first pack */
    int geo_error;  /* or why there is none */
    sim_link *link; /* NULL with a real server */
    sim_stream client_end;
    sim_server server;
    sim_relevance *relevance; /* NULL with a real server */
    sys_tcp tcp;              /* with a real server */
    sys_stream stream;
    sim_tape_recorder tape; /* file NULL: no tape is recorded */
    const sys_surface_api *surface_api;
    sys_surface *surface;
    fly_reference reference; /* pack NULL: no reference is drawn */
    void *memory;
    ff_client *client;
    /* what the client is told of its start, as ff_client_desc */
    int32_t velocity_wu_s[2];
    uint32_t first_answer_ms;
} fly_world;

/* 0, or -1 with one line on stderr. Call close in both cases. `options` must outlive the world. */
int fly_world_open(fly_world *world, const fly_options *options);
/* Shows a layer of images by its name, "off": none; pictures of the truth, too. 0, or -1 likewise.
 */
int fly_world_layer(fly_world *world, const char *name);
void fly_world_close(fly_world *world);

#endif
