/* Any bytes as fins or as paint: what our decoder reads, the slow one reads alike; what one refuses
 * the other refuses. Input: a byte of what it is, 0 fins, else paint of so many columns of blocks
 * (modulo 32, plus 1); and, of paint, a byte of rows likewise. */
#include "../../protocol/far/ff_far.h"
#include "../../protocol/picture/ff_paint.h"
#include "../rig/slow_far.h"
#include "../rig/slow_picture.h"

#include <assert.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

static void fins(const uint8_t *bytes, size_t count)
{
    static ff_fin_vertex vertex[FF_FAR_VERTICES_MAX];
    static slow_vertex slow[SLOW_FAR_VERTICES];
    int found = ff_fins_decode(bytes, count, vertex, FF_FAR_VERTICES_MAX),
        told = slow_fins(bytes, count, slow);

    assert(found < 0 ? told < 0 : told == found);
    for (int i = 0; i < found; i++)
        assert(vertex[i].begins == slow[i].begins && vertex[i].column == slow[i].column &&
               vertex[i].up_q2 == slow[i].height && vertex[i].distance == slow[i].distance);
}

static uint8_t rgb[256 * 256 * 3], there[32 * 32];

static void lay(void *context, unsigned column, unsigned row, uint8_t texel[64][3])
{
    unsigned columns = *(unsigned *)context;
    there[row * columns + column] = 1;
    for (unsigned i = 0; i < 64; i++)
        memcpy(rgb + (((row * 8 + i / 8) * columns + column) * 8 + i % 8) * 3, texel[i], 3);
}

static void paint(const uint8_t *bytes, size_t count, unsigned columns, unsigned rows)
{
    static uint8_t slow[256 * 256 * 3], slow_there[32 * 32];
    static uint64_t room[4096];
    const ff_paint_sink sink = { &columns, lay };
    assert(ff_paint_room_bytes(columns) <= sizeof room);
    memset(rgb, 0, sizeof rgb);
    memset(there, 0, sizeof there);
    int found = ff_paint_decode(bytes, count, columns, rows, (ff_paint_room *)(void *)room, &sink),
        told = slow_paint(bytes, (long)count, (int)columns, (int)rows, slow_there, slow);
    assert(found < 0 ? told < 0 : told == found);
    if (found < 0) return;
    assert(memcmp(there, slow_there, columns * rows) == 0);
    assert(memcmp(rgb, slow, columns * rows * 192) == 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    if (count > 0 && bytes[0] == 0)
        fins(bytes + 1, count - 1);
    else if (count > 1)
        paint(bytes + 2, count - 2, 1 + bytes[0] % 32u, 1 + bytes[1] % 32u);
    return 0;
}
