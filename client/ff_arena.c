#include "ff_arena.h"
#include "../protocol/ff_assert.h"

#include <string.h>

FF_STATIC_ASSERT((FF_ARENA_ALIGN & (FF_ARENA_ALIGN - 1)) == 0);
FF_STATIC_ASSERT(FF_ARENA_ALIGN % sizeof(int64_t) == 0 && FF_ARENA_ALIGN % sizeof(void *) == 0);

size_t ff_arena_cost(size_t bytes)
{
    return (bytes + FF_ARENA_ALIGN - 1) & ~(size_t)(FF_ARENA_ALIGN - 1);
}

void ff_arena_init(ff_arena *arena, void *memory, size_t bytes)
{
    size_t skip = (FF_ARENA_ALIGN - ((uintptr_t)memory & (FF_ARENA_ALIGN - 1))) &
                  (FF_ARENA_ALIGN - 1);
    if (skip > bytes) skip = bytes;
    arena->base = (uint8_t *)memory + skip;
    arena->bytes = bytes - skip;
    arena->used = 0;
    arena->sealed = 0;
    FF_ASSERT(arena->bytes == 0 || (uintptr_t)arena->base % FF_ARENA_ALIGN == 0);
}

size_t ff_arena_left(const ff_arena *arena)
{
    FF_ASSERT(arena->used <= arena->bytes);
    return arena->bytes - arena->used;
}

void *ff_arena_take(ff_arena *arena, size_t bytes)
{
    FF_ASSERT(!arena->sealed);
    size_t cost = ff_arena_cost(bytes);
    if (cost < bytes || cost > ff_arena_left(arena)) return NULL;
    FF_ASSERT(arena->used % FF_ARENA_ALIGN == 0);
    void *place = arena->base + arena->used;
    arena->used += cost;
    return memset(place, 0, cost);
}

void ff_arena_seal(ff_arena *arena) { arena->sealed = 1; }

void ff_arena_back_to(ff_arena *arena, size_t used)
{
    FF_ASSERT(used <= arena->used && used % FF_ARENA_ALIGN == 0);
    arena->used = used;
    arena->sealed = 0;
}
