/* Between sim_ground.c and the files beside it: a ground's heights in memory and on disk follow the
 * same head; what is asked of one ground alone, whatever it is joined with. */
#ifndef SIM_GROUND_LOCAL_H
#define SIM_GROUND_LOCAL_H

#include "sim_ground.h"

typedef struct sim_ground_head {
    char magic[8];
    uint32_t checksum, level, columns, rows; /* of the pack; of the ground */
    uint32_t zero[2];
} sim_ground_head;

/* Of head, heights and marks of filled nodes, in memory and in the file. */
static inline uint64_t sim_ground_bytes(const sim_ground *ground)
{
    return sizeof(sim_ground_head) +
           (uint64_t)ground->columns * ground->rows * sizeof *ground->height +
           (uint64_t)ground->node_columns * ground->node_rows;
}

/* Points the ground's heights and marks into them. */
static inline void sim_ground_lie(sim_ground *ground, const void *bytes)
{
    ground->height = (const uint16_t *)((const uint8_t *)bytes + sizeof(sim_ground_head));
    ground->filled = (const uint8_t *)(ground->height + (size_t)ground->columns * ground->rows);
}

/* `ground` has level, columns and rows. 1: its heights are now those of the file; 0: there is no
 * file, or it is of another ground. */
int sim_ground_cache_open(sim_ground *ground, uint32_t checksum, const char *path);
/* FF_OK or FF_ERR_SYSTEM. */
int sim_ground_cache_write(const sim_ground *ground, uint32_t checksum, const char *path);

/* ---- one ground alone: sim_ground_plane.c ---- */

int sim_ground_own_has(const sim_ground *ground, double x_m, double y_m);
/* The place of the ground that is nearest to another one. */
void sim_ground_own_nearest(const sim_ground *ground, double x_m, double y_m, double place_m[2]);
/* Of a place that it has. */
int sim_ground_own_filled(const sim_ground *ground, double x_m, double y_m);
double sim_ground_own_height_m(const sim_ground *ground, double x_m, double y_m);
/* Cuts t[0]..t[1] of a ray down to what lies over the ground: 1, or 0 when nothing is left. */
int sim_ground_own_span(const sim_ground *ground, const double from_m[3], const double direction[3],
                        double t[2]);
/* How much higher the ray, bent up by t * t * bend_m, is than the ground under or over it. */
double sim_ground_own_above_m(const sim_ground *ground, const double from_m[3],
                              const double direction[3], double bend_m, double t);
/* First ground on t[0]..t[1], which lies over it, as sim_ground_cast. */
int sim_ground_own_cast(const sim_ground *ground, const double from_m[3], const double direction[3],
                        double bend_m, const double t[2], double *t_hit);

#endif
