#include "c3d_pool.h"
#include "c3d_assert.h"

void *c3d_pool_at(c3d_pool *pool, uint32_t index)
{
    C3D_ASSERT(index < pool->count);
    return pool->slots + (size_t)index * pool->slot_bytes;
}

void c3d_pool_init(c3d_pool *pool, void *slots, size_t slot_bytes, uint32_t count)
{
    C3D_ASSERT(count <= UINT16_MAX && slot_bytes >= sizeof(c3d_slot));
    *pool = (c3d_pool){ slots, slot_bytes, count, 0, 0, 0 };
    for (uint32_t i = 0; i < count; i++) {
        c3d_slot *slot = c3d_pool_at(pool, i);
        *slot = (c3d_slot){ 1, 0, i + 1 };
    }
}

uint32_t c3d_pool_take(c3d_pool *pool)
{
    C3D_ASSERT((pool->first_free == pool->count) == (pool->in_use == pool->count));
    if (pool->first_free == pool->count) return 0;
    uint32_t index = pool->first_free;
    c3d_slot *slot = c3d_pool_at(pool, index);
    C3D_ASSERT(!slot->used && slot->generation > 0 && slot->next_free <= pool->count);
    pool->first_free = slot->next_free;
    slot->used = 1;
    if (++pool->in_use > pool->high) pool->high = pool->in_use;
    return (uint32_t)slot->generation << 16 | index;
}

void *c3d_pool_get(c3d_pool *pool, uint32_t id)
{
    uint32_t index = c3d_pool_index(id);
    if (index >= pool->count) return NULL;
    c3d_slot *slot = c3d_pool_at(pool, index);
    return slot->used && slot->generation == id >> 16 ? slot : NULL;
}

void c3d_pool_give(c3d_pool *pool, uint32_t id)
{
    c3d_slot *slot = c3d_pool_get(pool, id);
    C3D_ASSERT(slot);
    C3D_ASSERT(pool->in_use > 0 && pool->in_use <= pool->high);
    slot->used = 0;
    if (++slot->generation == 0) slot->generation = 1;
    slot->next_free = pool->first_free;
    pool->first_free = c3d_pool_index(id);
    pool->in_use--;
}
