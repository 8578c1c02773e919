/* Private to protocol/: raw deflate (RFC 1951), the encoder's side, for tools: zlib allocates. */
#ifndef FF_DEFLATE_H
#define FF_DEFLATE_H

#include <stddef.h>
#include <stdint.h>

#define FF_DEFLATE_LIMIT_MAX (1u << 14)

/* All of `in` as one stream, by the strategy that makes it shortest. Bytes in `out`, or 0 when they
 * would not be fewer than `limit`, which is
 * FF_DEFLATE_LIMIT_MAX at most. */
size_t ff_deflate_all(int window_bits, const uint8_t *in, uint32_t bytes, uint8_t *out,
                      size_t limit);

#endif
