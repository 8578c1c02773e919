/* CRC-32 by zlib: the fastest there is on big machines. */
#include "../ff_pack.h"

#include <limits.h>
#include <zlib.h>

uint32_t ff_crc32(uint32_t crc, const void *bytes, size_t count)
{
    const uint8_t *at = bytes;
    uLong sum = crc;

    for (; count > UINT_MAX; count -= UINT_MAX, at += UINT_MAX) sum = crc32(sum, at, UINT_MAX);
    return (uint32_t)(count > 0 ? crc32(sum, at, (uInt)count) : sum);
}
