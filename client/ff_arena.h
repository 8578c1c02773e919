/* The one block of memory of a client, carved from its start. After sealing nothing may be taken
 * any more; going back to a mark (a new terrain in the same block) opens it again. */
#ifndef FF_ARENA_H
#define FF_ARENA_H

#include <stddef.h>
#include <stdint.h>

#define FF_ARENA_ALIGN 16u

typedef struct ff_arena {
    uint8_t *base; /* aligned */
    size_t bytes, used;
    uint8_t sealed;
} ff_arena;

void ff_arena_init(ff_arena *arena, void *memory, size_t bytes);
/* Zeroed bytes aligned for any type, or NULL when they do not fit. Never after ff_arena_seal. */
void *ff_arena_take(ff_arena *arena, size_t bytes);
/* What ff_arena_take(bytes) uses up. */
size_t ff_arena_cost(size_t bytes);
size_t ff_arena_left(const ff_arena *arena);
void ff_arena_seal(ff_arena *arena);
/* Gives back everything taken since `used` was read from the arena, and opens it. */
void ff_arena_back_to(ff_arena *arena, size_t used);

#endif
