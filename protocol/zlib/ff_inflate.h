/* Private to protocol/: raw deflate (RFC 1951), what the codec "deflate" needs of zlib. A build
 * without it has ff_inflate_none.c in place of ff_inflate.c and decodes packs made with
 * `farfield-bake --codec rice`. */
#ifndef FF_INFLATE_H
#define FF_INFLATE_H

#include "../ff_error.h"

#include <stddef.h>
#include <stdint.h>

extern const uint8_t ff_inflate_built; /* 0: left out of this build */

typedef struct ff_inflate ff_inflate;
size_t ff_inflate_bytes(int window_bits);
/* `memory` itself, or NULL when `bytes` is too small or inflating is left out. Aligned for any
 * type; nothing else is ever allocated. */
ff_inflate *ff_inflate_create(int window_bits, void *memory, size_t bytes);
/* All of `in` to exactly `count` bytes: FF_OK, FF_ERR_TRUNCATED or FF_ERR_FORMAT. */
int ff_inflate_all(ff_inflate *inflater, const uint8_t *in, size_t bytes, uint8_t *out,
                   uint32_t count);

#endif
