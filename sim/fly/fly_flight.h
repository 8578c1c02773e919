/* The flight itself: time steps, frames, events, rows, pictures. */
#ifndef FLY_FLIGHT_H
#define FLY_FLIGHT_H

#include "fly_sample.h"
#include "fly_world.h"

typedef struct fly_flight {
    fly_world *world;
    const fly_options *options;
    FILE *csv; /* or NULL */
    c3d_camera camera;
    int64_t start_us; /* the clock at t = 0 */
    /* faces the server has rendered; after each the client's GL context is made current again */
    uint32_t faces_seen;
    int had_ground;       /* 1: some frame so far has drawn ground */
    uint64_t events_done; /* bit per event */
    uint8_t *rgb, *reference_rgb;
    double reference_t_s; /* when the picture in reference_rgb was drawn for; -1: none yet */
    fly_sample *sample;
    size_t sample_count, sample_capacity;
    fly_totals totals;
} fly_flight;

/* Flies the whole flight. 0, or -1 with one line on stderr. Rows lie in `sample` afterwards; free
 * with fly_flight_free. */
int fly_flight_run(fly_flight *flight, fly_world *world, FILE *csv);
void fly_flight_free(fly_flight *flight);

#endif
