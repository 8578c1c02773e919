/* Any bytes as a picture. Byte 0: log2 of its side less 4 (bits 0-2, modulo 5), a root (bit 3), its
 * quadrant (bits 4-5), a rough parent (bit 6), a row of pictures as of an entered root (bit 7).
 * When it decodes, its texels must be the slow decoder's. */
#include "../../protocol/picture/ff_picture.h"
#include "../rig/slow_picture.h"

#include <assert.h>
#include <string.h>

#define SIDE_MAX 256

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

static void make_parent(int side, int rough, uint16_t *parent)
{
    for (int i = 0; i < side * side; i++) {
        unsigned x = (unsigned)(i % side), y = (unsigned)(i / side);
        parent[i] = (uint16_t)(rough ? (x * 40503u ^ y * 9973u) >> 2 : (x / 2) << 11 | y);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    static uint16_t parent[SIDE_MAX * SIDE_MAX], texels[SIDE_MAX * SIDE_MAX + 1],
        slow[SIDE_MAX * SIDE_MAX];
    static uint8_t rgb[SIDE_MAX * SIDE_MAX * 3 + 1], slow_rgb[SIDE_MAX * SIDE_MAX * 3];
    static ff_picture_room room;
    if (count < 1) return 0;
    unsigned log2 = 4 + (bytes[0] & 7u) % 5, quadrant = bytes[0] >> 4 & 3u;
    int side = 1 << log2, is_root = bytes[0] >> 3 & 1;
    make_parent(side, bytes[0] >> 6 & 1, parent);
    if (bytes[0] >> 7) {
        ff_picture_decode_row(bytes + 1, count - 1, log2, quadrant, 27, &room, texels, slow);
        return 0;
    }
    texels[side * side] = 0xABCD;
    rgb[side * side * 3] = 0xAB;
    ff_picture_above above = { is_root ? NULL : parent, is_root ? 0 : quadrant };
    int rc = ff_picture_decode(bytes + 1, count - 1, log2, above, &room, texels, rgb);
    int slow_rc = slow_picture(bytes + 1, (long)count - 1, side, above.texels, (int)above.quadrant,
                               slow, slow_rgb);
    assert((rc == FF_OK) == (slow_rc == 0));
    assert(texels[side * side] == 0xABCD && rgb[side * side * 3] == 0xAB);
    if (rc != FF_OK) return 0;
    assert(memcmp(texels, slow, sizeof *texels * (size_t)(side * side)) == 0);
    for (int y = 0; y < side; y++)
        assert(memcmp(rgb + (side - 1 - y) * side * 3, slow_rgb + y * side * 3, (size_t)side * 3) ==
               0);
    return 0;
}
