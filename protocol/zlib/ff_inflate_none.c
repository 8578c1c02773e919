/* Stands in for ff_inflate.c in builds without zlib. */
#include "ff_inflate.h"

const uint8_t ff_inflate_built = 0;

size_t ff_inflate_bytes(int window_bits) { return (void)window_bits, 0; }

ff_inflate *ff_inflate_create(int window_bits, void *memory, size_t bytes)
{
    (void)window_bits, (void)memory, (void)bytes;
    return NULL;
}

int ff_inflate_all(ff_inflate *inflater, const uint8_t *in, size_t bytes, uint8_t *out,
                   uint32_t count)
{
    (void)inflater, (void)in, (void)bytes, (void)out, (void)count;
    return FF_ERR_UNSUPPORTED;
}
