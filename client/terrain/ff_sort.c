/* Heap sort of 64-bit keys: no memory, no recursion, no bad case. */
#include "ff_tree_local.h"

static void sift_down(uint64_t *keys, uint32_t at, uint32_t count)
{
    uint64_t moved = keys[at];
    FF_ASSERT(at < count);
    for (;;) {
        uint32_t child = 2 * at + 1;
        if (child >= count) break;
        if (child + 1 < count && keys[child + 1] > keys[child]) child++;
        if (keys[child] <= moved) break;
        keys[at] = keys[child];
        at = child;
    }
    keys[at] = moved;
    FF_ASSERT(2 * at + 1 >= count || keys[2 * at + 1] <= moved);
    FF_ASSERT(2 * at + 2 >= count || keys[2 * at + 2] <= moved);
}

void ff_sort_keys(uint64_t *keys, uint32_t count)
{
    FF_ASSERT(count <= 2 * FF_NODES_MAX);
    for (uint32_t i = count / 2; i-- > 0;) sift_down(keys, i, count);
    for (uint32_t end = count; end-- > 1;) {
        uint64_t largest = keys[0];
        keys[0] = keys[end];
        keys[end] = largest;
        FF_ASSERT(end + 1 == count || largest <= keys[end + 1]);
        sift_down(keys, 0, end);
    }
}
