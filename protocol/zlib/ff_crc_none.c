/* CRC-32 without zlib: four bits at a time from a table of 64 bytes (polynomial 0xEDB88320,
 * reflected). */
#include "../ff_pack.h"

uint32_t ff_crc32(uint32_t crc, const void *bytes, size_t count)
{
    static const uint32_t table[16] = { 0x00000000, 0x1db71064, 0x3b6e20c8, 0x26d930ac,
                                        0x76dc4190, 0x6b6b51f4, 0x4db26158, 0x5005713c,
                                        0xedb88320, 0xf00f9344, 0xd6d6a3e8, 0xcb61b38c,
                                        0x9b64c2b0, 0x86d3d2d4, 0xa00ae278, 0xbdbdf21c };
    const uint8_t *at = bytes, *end = at + count;

    crc = ~crc;
    for (; at < end; at++) {
        crc = table[(crc ^ *at) & 15u] ^ crc >> 4;
        crc = table[(crc ^ *at >> 4) & 15u] ^ crc >> 4;
    }
    return ~crc;
}
