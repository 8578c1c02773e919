/* PCG32 (O'Neill 2014, XSH-RR variant): 64-bit state, any odd increment is a stream of its own. */
#include "sys.h"

#include <assert.h>

#define PCG_MULTIPLIER UINT64_C(6364136223846793005)

void sys_random_seed(sys_random *random, uint64_t seed, uint64_t stream)
{
    random->state = 0;
    random->stream = (stream << 1) | 1;
    sys_random_u32(random);
    random->state += seed;
    sys_random_u32(random);
}

uint32_t sys_random_u32(sys_random *random)
{
    uint64_t old = random->state;
    random->state = old * PCG_MULTIPLIER + random->stream;
    uint32_t shifted = (uint32_t)(((old >> 18) ^ old) >> 27);
    uint32_t turn = (uint32_t)(old >> 59);
    return (shifted >> turn) | (shifted << ((32 - turn) & 31));
}

uint32_t sys_random_below(sys_random *random, uint32_t limit)
{
    assert(limit > 0);
    /* Numbers below 2^32 mod limit would come once too often: another number is drawn for them. */
    uint32_t threshold = (0u - limit) % limit;
    uint32_t value;
    do {
        value = sys_random_u32(random);
    } while (value < threshold);
    return value % limit;
}
