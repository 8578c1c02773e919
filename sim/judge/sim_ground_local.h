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

#endif
