/* Fins (client/far): upright strips that are drawn with the ground. Their triangles are taken as
 * the client has made them; which are drawn, and where, is told for each frame. */
#ifndef SIM_FINS_H
#define SIM_FINS_H

#include "../../common3d/c3d.h"
#include "../../protocol/ff_terrain.h"

typedef struct sim_fin {
    ff_key set;
    unsigned sector;
    double corner_m[3][3]; /* relative to the set's O */
} sim_fin;

typedef struct sim_fins {
    sim_fin *fin; /* in the order in which they came */
    size_t count, capacity;
    int rc; /* FF_OK, or FF_ERR_MEMORY: some are missing */
} sim_fins;

/* `fins` starts as zeros. Takes a strip in; for ff_client_watch_fins: `context` is a sim_fins. A
 * sector that comes once more after others takes its own place. */
void sim_fins_take(void *context, ff_key set, unsigned sector, const c3d_vertex *vertex,
                   uint32_t vertices, const uint16_t *index, uint32_t indices);
/* Those of sets before this one will not be drawn again. */
void sim_fins_forget(sim_fins *fins, ff_key set);
void sim_fins_free(sim_fins *fins);

/* What a frame draws of them: sectors of one set, a bit each. fins NULL: none. */
typedef struct sim_drawn_fins {
    const sim_fins *fins;
    ff_key set;
    unsigned sectors;
    int32_t position_wu[3]; /* O */
} sim_drawn_fins;

#endif
