#ifdef FF_ENCODER

#include "ff_deflate.h"

#include "../ff_assert.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

/* Bytes in `out`, or 0 when they would not be fewer than `limit`. */
static size_t deflate_as(int strategy, int window_bits, const uint8_t *in, uint32_t bytes,
                         uint8_t *out, size_t limit)
{
    z_stream z;
    size_t written = 0;

    FF_ASSERT(window_bits >= 9 && window_bits <= MAX_WBITS);
    FF_ASSERT(limit > 1 && limit <= FF_DEFLATE_LIMIT_MAX);
    FF_ASSERT(bytes < 1u << (8 + 6)); /* the symbol buffer of level 8 */
    memset(&z, 0, sizeof(z));
    /* The least memory level whose symbol buffer holds the input whole: one block, and little to
     * allocate and clear. */
    if (deflateInit2(&z, 9, Z_DEFLATED, -window_bits, bytes < 1000 ? 4 : 8, strategy) != Z_OK)
        abort();
    z.next_in = (z_const Bytef *)in;
    z.avail_in = bytes;
    z.next_out = out;
    z.avail_out = (uInt)limit - 1;
    if (deflate(&z, Z_FINISH) == Z_STREAM_END) written = (size_t)(z.next_out - out);
    deflateEnd(&z);
    FF_ASSERT(written < limit);
    return written;
}

size_t ff_deflate_all(int window_bits, const uint8_t *in, uint32_t bytes, uint8_t *out,
                      size_t limit)
{
    static const int strategies[] = { Z_DEFAULT_STRATEGY, Z_FIXED, Z_HUFFMAN_ONLY };
    uint8_t trial[FF_DEFLATE_LIMIT_MAX];
    size_t shortest = 0;

    FF_ASSERT(limit <= sizeof(trial));
    for (size_t s = 0; s < sizeof(strategies) / sizeof(strategies[0]) && limit > 1; s++) {
        size_t written = deflate_as(strategies[s], window_bits, in, bytes, trial, limit);
        if (written > 0) {
            memcpy(out, trial, written);
            shortest = limit = written;
        }
    }
    return shortest;
}

#else
typedef int ff_deflate_not_built; /* ISO C wants a declaration in every file */
#endif
