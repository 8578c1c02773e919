/* The server's end of a simulated link, in the simulation's own process: server/ff_session and the
 * renderers of panoramas and far sets, one client. A face takes a stated constant time of the
 * simulated clock, however long it takes here.
 */
#ifndef SIM_SERVER_H
#define SIM_SERVER_H

#include "../../server/far/ff_far_render.h"
#include "../../server/panorama/ff_panorama_render.h"
#include "../../server/session/ff_session.h"
#include "sim_stream.h"

/* Assumed time in which a server renders a face of 256 x 256, JPEG included, or a sector. */
#define SIM_SERVER_FACE_US     120000
#define SIM_SERVER_INPUT_BYTES 4096

typedef struct sim_server {
    const ff_pack *pack;
    sim_link *link;
    const int64_t *now_us;
    sim_stream end;
    sys_stream stream;
    unsigned connection; /* of the link that `session` serves */
    ff_session *session;
    int closing; /* 1: the session has ended; its pending bytes go out, then the link is cut */
    uint8_t input[SIM_SERVER_INPUT_BYTES];
    size_t input_count;
    ff_panorama_renderer *renderer; /* opened at the first panorama */
    int renderer_error;
    ff_far_renderer *far_renderer; /* opened at the first far set */
    ff_face_job job;
    int64_t job_done_us; /* 0: none under way */
    uint8_t *face;
    int face_bytes;
    uint32_t faces_rendered; /* of panoramas: each leaves the renderer's GL context current */
} sim_server;

/* FF_OK or FF_ERR_MEMORY. All pointers must outlive the server. */
int sim_server_init(sim_server *server, const ff_pack *pack, sim_link *link, const int64_t *now_us);
void sim_server_free(sim_server *server);
/* Receives, answers, renders and sends at *now_us. FF_OK or FF_ERR_MEMORY. */
int sim_server_step(sim_server *server);

#endif
