/* How blocks of several sizes would be shared out for a pack's terrain that comes over a link: a
 * table, as `make size` shows it. */
#include "handheld.h"

#define BLOCKS 4 /* of 1, 2, 4 and 8 MB */

typedef struct plan {
    int pools; /* or why there are none */
    ff_pool_use pool[FF_POOLS_MAX];
} plan;

static size_t block_bytes(unsigned block) { return (size_t)1 << (20 + block); }

static void print_head(void)
{
    printf("| pool |");
    for (unsigned i = 0; i < BLOCKS; i++) printf(" items in %u MB | bytes |", 1u << i);
    printf("\n|---|");
    for (unsigned i = 0; i < BLOCKS; i++) printf("--:|--:|");
    puts("");
}

static void print_pool(const plan *plans, int at)
{
    int named = 0;
    for (unsigned i = 0; i < BLOCKS; i++) {
        if (plans[i].pools < 0) continue;
        const ff_pool_use *pool = &plans[i].pool[at];
        if (!named++) printf("| %s%s |", pool->inside ? "of it " : "", pool->name);
    }
    for (unsigned i = 0; i < BLOCKS; i++)
        if (plans[i].pools < 0)
            printf(" | |");
        else
            printf(" %u | %zu |", plans[i].pool[at].count, plans[i].pool[at].bytes);
    puts("");
}

/* What no pool has: rounding, and a tree that has all the nodes it may have. */
static void print_rest(const plan *plans)
{
    printf("| left |");
    for (unsigned i = 0; i < BLOCKS; i++) {
        size_t left = block_bytes(i);
        for (int at = 0; at < plans[i].pools; at++)
            if (!plans[i].pool[at].inside) left -= plans[i].pool[at].bytes;
        if (plans[i].pools < 0)
            printf(" does not fit | |");
        else
            printf(" | %zu |", left);
    }
    puts("");
}

void handheld_plan(const handheld *device)
{
    plan plans[BLOCKS];
    ff_client_desc desc = handheld_client_desc(device);
    int most = 0;
    desc.pack = NULL;
    desc.stream = (sys_stream *)&device->stream; /* asked only whether there is one */
    for (unsigned i = 0; i < BLOCKS; i++) {
        desc.memory_bytes = block_bytes(i);
        plans[i].pools = ff_client_plan(&desc, ff_client_terrain(device->client), plans[i].pool);
        if (plans[i].pools > most) most = plans[i].pools;
    }
    print_head();
    for (int at = 0; at < most; at++) print_pool(plans, at);
    print_rest(plans);
}
