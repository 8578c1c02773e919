#include "ff_inflate.h"

#include "../ff_assert.h"

#include <string.h>
#include <zlib.h>

/* zlib keeps about 7 kB for an inflate stream, its forks up to twice that; the window comes on
 * top. */
#define INFLATE_STATE_BYTES (20u * 1024u)
#define ALIGNMENT           16u

FF_STATIC_ASSERT((ALIGNMENT & (ALIGNMENT - 1)) == 0 && ALIGNMENT >= sizeof(voidpf));

struct ff_inflate {
    z_stream stream;
    uint8_t *arena; /* where zlib's allocations, made once, come from */
    size_t arena_bytes, arena_used;
};

const uint8_t ff_inflate_built = 1;

static size_t align_up(size_t bytes) { return (bytes + ALIGNMENT - 1) & ~(size_t)(ALIGNMENT - 1); }

size_t ff_inflate_bytes(int window_bits)
{
    FF_ASSERT(window_bits >= 9 && window_bits <= MAX_WBITS);
    return align_up(sizeof(ff_inflate)) + INFLATE_STATE_BYTES + ((size_t)1 << window_bits);
}

static voidpf arena_take(voidpf opaque, uInt items, uInt size)
{
    ff_inflate *inflater = opaque;
    size_t bytes = align_up((size_t)items * size);
    voidpf taken = inflater->arena + inflater->arena_used;

    FF_ASSERT(inflater->arena_used <= inflater->arena_bytes);
    FF_ASSERT(inflater->arena_used % ALIGNMENT == 0);
    if (bytes > inflater->arena_bytes - inflater->arena_used) return Z_NULL;
    inflater->arena_used += bytes;
    return taken;
}

/* Nothing is given back: the block goes away as a whole. */
static void arena_give(voidpf opaque, voidpf address)
{
    (void)opaque;
    (void)address;
}

ff_inflate *ff_inflate_create(int window_bits, void *memory, size_t bytes)
{
    ff_inflate *inflater = memory;

    if (bytes < ff_inflate_bytes(window_bits)) return NULL;
    memset(inflater, 0, sizeof(*inflater));
    inflater->arena = (uint8_t *)memory + align_up(sizeof(ff_inflate));
    inflater->arena_bytes = bytes - align_up(sizeof(ff_inflate));
    inflater->stream.zalloc = arena_take;
    inflater->stream.zfree = arena_give;
    inflater->stream.opaque = inflater;
    return inflateInit2(&inflater->stream, -window_bits) == Z_OK ? inflater : NULL;
}

int ff_inflate_all(ff_inflate *inflater, const uint8_t *in, size_t bytes, uint8_t *out,
                   uint32_t count)
{
    z_stream *z = &inflater->stream;
    int rc;

    FF_ASSERT((uInt)bytes == bytes);
    inflateReset(z);
    z->next_in = (z_const Bytef *)in;
    z->avail_in = (uInt)bytes;
    z->next_out = out;
    z->avail_out = count;
    rc = inflate(z, Z_FINISH);
    if (rc == Z_BUF_ERROR && z->avail_in == 0) return FF_ERR_TRUNCATED;
    return rc == Z_STREAM_END && z->avail_out == 0 && z->avail_in == 0 ? FF_OK : FF_ERR_FORMAT;
}
