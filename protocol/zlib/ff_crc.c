/* CRC-32 by zlib: the fastest there is on big machines. */
#include "../ff_pack.h"

#include <limits.h>
#include <zlib.h>

/* Counts up to UINT_MAX and sums of 32 bits pass through zlib's types whole. */
FF_STATIC_ASSERT(sizeof(uInt) >= sizeof(unsigned) && sizeof(uLong) >= sizeof(uint32_t));

uint32_t ff_crc32(uint32_t crc, const void *bytes, size_t count)
{
    const uint8_t *at = bytes;
    uLong sum = crc;

    for (; count > UINT_MAX; count -= UINT_MAX, at += UINT_MAX) sum = crc32(sum, at, UINT_MAX);
    return (uint32_t)(count > 0 ? crc32(sum, at, (uInt)count) : sum);
}
