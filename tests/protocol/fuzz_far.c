/* Any bytes as fins or as blocks of paint: what our decoder reads, the slow one reads alike, and it
 * encodes to the same bytes again; what one refuses the other refuses. Input: a byte of what it is,
 * 0 fins, else blocks in rows of so many; and, of blocks, a byte of rows less 1. */
#include "../../protocol/far/ff_far.h"
#include "../rig/slow_far.h"

#include <assert.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

static void fins(const uint8_t *bytes, size_t count)
{
    static ff_fin_vertex vertex[FF_FAR_VERTICES_MAX];
    static slow_vertex slow[SLOW_FAR_VERTICES];
    static uint8_t again[FF_FAR_FINS_BYTES];
    int found = ff_fins_decode(bytes, count, vertex, FF_FAR_VERTICES_MAX),
        told = slow_fins(bytes, count, slow);

    assert(found < 0 ? told < 0 : told == found);
    for (int i = 0; i < found; i++)
        assert(vertex[i].begins == slow[i].begins && vertex[i].column == slow[i].column &&
               vertex[i].up_q2 == slow[i].height && vertex[i].distance == slow[i].distance);
    if (found < 0) return;
    assert(ff_fins_encode(vertex, (uint32_t)found, again, sizeof again) == (int)count);
    assert(memcmp(again, bytes, count) == 0);
}

static void blocks(const uint8_t *bytes, size_t count, unsigned number)
{
    static uint8_t there[256 * 256], slow[256 * 256], again[256 * 256];
    int found = ff_blocks_decode(bytes, count, there, number);

    if (number > FF_FAR_BLOCKS_MAX * FF_FAR_BLOCKS_MAX) {
        assert(found < 0);
        return;
    }
    int told = slow_blocks(bytes, count, (int)number, slow);
    assert(found < 0 ? told < 0 : told == found);
    if (found < 0) return;
    assert(memcmp(there, slow, number) == 0);
    assert(ff_blocks_encode(there, number, again, sizeof again) == (int)count);
    assert(memcmp(again, bytes, count) == 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    if (count > 0 && bytes[0] == 0)
        fins(bytes + 1, count - 1);
    else if (count > 1)
        blocks(bytes + 2, count - 2, bytes[0] * (bytes[1] + 1u));
    return 0;
}
