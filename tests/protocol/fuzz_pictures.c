/* Any bytes as a picture. Byte 0: log2 of its side less 4 (bits 0-2, modulo 5), a root (bit 3), its
 * quadrant (bits 4-5), a rough parent (bit 6), a row of pictures as of an entered root (bit 7).
 * When it decodes, its texels must be the slow decoder's. */
#include "../../protocol/picture/ff_picture.h"
#include "../rig/slow_picture.h"

#include <assert.h>
#include <string.h>

#define SIDE_MAX 256

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

static void make_parent(int side, int rough, uint8_t *parent)
{
    for (int i = 0; i < side * side * 3; i++) {
        unsigned x = (unsigned)(i / 3 % side), y = (unsigned)(i / 3 / side);
        parent[i] = (uint8_t)(rough ? (x * 40503u ^ y * 9973u ^ i * 31u) >> 2 : x + 2 * y);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    static uint8_t parent[SIDE_MAX * SIDE_MAX * 3], rgb[SIDE_MAX * SIDE_MAX * 3 + 1],
        slow[SIDE_MAX * SIDE_MAX * 3];
    static ff_picture_room room;
    if (count < 1) return 0;
    unsigned log2 = 4 + (bytes[0] & 7u) % 5, quadrant = bytes[0] >> 4 & 3u;
    int side = 1 << log2, is_root = bytes[0] >> 3 & 1;
    make_parent(side, bytes[0] >> 6 & 1, parent);
    if (bytes[0] >> 7) {
        ff_picture_decode_row(bytes + 1, count - 1, log2, quadrant, 27, &room, rgb, slow);
        return 0;
    }
    rgb[side * side * 3] = 0xAB;
    ff_picture_above above = { is_root ? NULL : parent, is_root ? 0 : quadrant };
    int rc = ff_picture_decode(bytes + 1, count - 1, log2, above, &room, rgb);
    int slow_rc = slow_picture(bytes + 1, (long)count - 1, side, above.rgb, (int)above.quadrant,
                               slow);
    assert((rc == FF_OK) == (slow_rc == 0));
    assert(rgb[side * side * 3] == 0xAB);
    if (rc == FF_OK) assert(memcmp(rgb, slow, (size_t)(side * side) * 3) == 0);
    return 0;
}
