/* Shared by the recorder and the player of tapes. */
#ifndef SIM_TAPE_LOCAL_H
#define SIM_TAPE_LOCAL_H

#include "sim_tape.h"

#define SIM_TAPE_MAGIC       "fftape 5"
#define SIM_TAPE_MAGIC_BYTES 8
#define SIM_TAPE_HEAD        29 /* numbers */

/* FNV-1a, 32 bits. */
static inline uint32_t sim_tape_hash(const uint8_t *bytes, size_t count)
{
    uint32_t hash = 2166136261u;
    for (size_t i = 0; i < count; i++) hash = (hash ^ bytes[i]) * 16777619u;
    return hash;
}

#endif
