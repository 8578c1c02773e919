/* A whole client for the stiff and extreme cases: over a small pack, local or behind a simulated
 * link and a real session; every changed frame is judged. A fault is written into the row of the
 * case and does not stop it. */
#ifndef EXTREME_RIG_H
#define EXTREME_RIG_H

#include "extreme_table.h"
#include "../rig/pack_fixture.h"
#include "../rig/terrain_fixture.h"
#include "../../client/farfield.h"
#include "../../sim/judge/sim_audit.h"
#include "../../sim/link/sim_server.h"

#define EXTREME_ERROR_PX 6 /* the error that FF_MEASURE_PIXELS, the rigs' default, asks for */

typedef struct extreme_rig {
    extreme_row *row;
    uint8_t *pack_bytes;
    ff_pack pack;
    sim_ground ground;
    sim_auditor *auditor;
    int64_t now_us, tick_us; /* the link is served every tick_us (default 10 ms) */
    sim_link *link;          /* NULL: the pack is the client's own */
    sim_stream end;
    sys_stream stream;
    sim_server server;
    sys_surface *surface; /* of desc.surface_api; without one nothing is drawn */
    void *memory;
    ff_client_desc desc; /* may be changed between extreme_open and extreme_start */
    ff_client *client;
    /* 240 x 320, 60 degrees wide, 200 m above the middle, looking north and down a little */
    c3d_camera camera;
    uint32_t changes; /* frames whose update asked to be drawn */
    uint8_t untimed;  /* 1: the case measures its run time itself */
} extreme_rig;

/* Ground for pack_fixture: 0 or 65535 in blocks of eight samples, 120 everywhere. */
uint16_t extreme_cliffs(void *context, uint32_t x, uint32_t y);
uint16_t extreme_flat(void *context, uint32_t x, uint32_t y);

/* info 0: 2 by 2 tiles of 64 cells of 32 m. */
void extreme_open(extreme_rig *rig, extreme_row *row, const ff_terrain_info *info,
                  uint16_t (*height)(void *, uint32_t, uint32_t));
/* Makes the client, which draws by integers unless a back end is set; `link` a description for
 * sim_link_create, NULL: local. */
void extreme_start(extreme_rig *rig, const sim_link_desc *link);
/* Adds the work done to the row. */
void extreme_close(extreme_rig *rig);

double extreme_ground_m(const extreme_rig *rig, double x_m, double y_m);
void extreme_place(extreme_rig *rig, double x_m, double y_m, double z_m);

/* A frame step_us later; every third is drawn and timed, an ordinary one with it. A crack, too many
 * requests in flight or a protocol error fail the row. 1 when the picture changed. */
int extreme_frame(extreme_rig *rig, int64_t step_us);
/* Steps until for ten frames no request is queued or unanswered; fails the row after frames_max. */
void extreme_settle(extreme_rig *rig, int64_t step_us, unsigned frames_max);
/* No oscillation: 40 frames with a still camera change nothing and ask for nothing; then, with the
 * camera going to and fro by one wu and one step of angle, nothing is asked for a second time. */
void extreme_calm(extreme_rig *rig);
/* The largest error in the present picture, by the auditor (nothing undrawn that should be seen)
 * and, where it sees no ground, of points of the ground in the window, hidden or not, by the
 * reference. */
double extreme_audit(extreme_rig *rig);
/* The most that EXTREME_ERROR_PX on the axis can become in the window's corner, and half a pixel
 * for rounding. */
double extreme_error_bound(const c3d_camera *camera);
/* Settles, audits into the row, and tests for calm. */
void extreme_judge(extreme_rig *rig);
/* Frees the ordinary case; called once, after all cases. */
void extreme_ordinary_close(void);
/* Error of the drawn heights round the camera in pixels, by the fixture's own function: its
 * terrain has 65536 cells of 10 m a side. */
double extreme_error_near(const terrain_fixture *fx, const ff_view *view, sys_random *random);
/* 1 when both show the same nodes and heights. */
int extreme_same_picture(const extreme_rig *a, const extreme_rig *b);

#endif
