/* Between sim_ground.c and sim_ground_cache.c: a ground's heights in memory and on disk follow the
 * same head. */
#ifndef SIM_GROUND_LOCAL_H
#define SIM_GROUND_LOCAL_H

#include "sim_ground.h"

typedef struct sim_ground_head {
    char magic[8];
    uint32_t checksum, level, columns, rows; /* of the pack; of the ground */
    uint32_t zero[2];
} sim_ground_head;

/* `ground` has level, columns and rows. 1: its heights are now those of the file; 0: there is no
 * file, or it is of another ground. */
int sim_ground_cache_open(sim_ground *ground, uint32_t checksum, const char *path);
/* FF_OK or FF_ERR_SYSTEM. */
int sim_ground_cache_write(const sim_ground *ground, uint32_t checksum, const char *path);

#endif
