/* Slots addressed by handles: slot number and generation in 32 bits, 0 never valid. Inside common3d
 * only. */
#ifndef C3D_POOL_H
#define C3D_POOL_H

#include "c3d_backend.h"

/* First member of every pooled struct. */
typedef struct c3d_slot {
    uint16_t generation; /* of the next or present owner, never 0 */
    uint16_t used;
    uint32_t next_free; /* number of the next free slot; the pool's count: none */
} c3d_slot;

typedef struct c3d_pool {
    uint8_t *slots;
    size_t slot_bytes;
    uint32_t count, first_free, in_use, high;
} c3d_pool;

void c3d_pool_init(c3d_pool *pool, void *slots, size_t slot_bytes, uint32_t count);
uint32_t c3d_pool_take(c3d_pool *pool);            /* a handle, 0 when full */
void c3d_pool_give(c3d_pool *pool, uint32_t id);   /* id is in use */
void *c3d_pool_get(c3d_pool *pool, uint32_t id);   /* NULL for a stale or zero handle */
void *c3d_pool_at(c3d_pool *pool, uint32_t index); /* any slot, used or not */
static inline uint32_t c3d_pool_index(uint32_t id) { return id & 0xFFFF; }

#endif
