/* Numbers in bits, lowest bit of each byte first, in exponential Golomb codes (SPEC.md, "Fins").
 * For protocol/far only. */
#ifndef FF_BITS_H
#define FF_BITS_H

#include "../ff_error.h"
#include "../ff_assert.h"

#include <stddef.h>
#include <stdint.h>

#define FF_BITS_PREFIX_MAX 16 /* ones before a number: it has at most 16 + order bits */

typedef struct ff_bits {
    uint8_t *out;      /* NULL when reading */
    const uint8_t *in; /* NULL when writing */
    size_t at, limit;  /* in bits; `at` runs on beyond `limit` when there was too little room */
    int error;         /* of what was read: FF_ERR_FORMAT */
} ff_bits;

static inline void ff_bits_put(ff_bits *bits, uint32_t value, unsigned count)
{
    for (unsigned i = 0; i < count; i++, bits->at++) {
        if (bits->at >= bits->limit) continue;
        if (bits->at % 8 == 0) bits->out[bits->at / 8] = 0;
        bits->out[bits->at / 8] |= (uint8_t)((value >> i & 1u) << bits->at % 8);
    }
}

/* Bits beyond the end are zeros; the caller sees by `at` that they were read. */
static inline uint32_t ff_bits_take(ff_bits *bits, unsigned count)
{
    uint32_t value = 0;
    for (unsigned i = 0; i < count; i++, bits->at++)
        if (bits->at < bits->limit)
            value |= (uint32_t)(bits->in[bits->at / 8] >> bits->at % 8 & 1u) << i;
    return value;
}

/* p ones and a zero, then order + p bits: of a number less the 2^order * (2^p - 1) below them. */
static inline void ff_bits_put_number(ff_bits *bits, uint32_t value, unsigned order)
{
    unsigned prefix = 0;
    while (value >> order >> prefix) value -= UINT32_C(1) << (order + prefix++);
    FF_ASSERT(prefix <= FF_BITS_PREFIX_MAX);
    ff_bits_put(bits, (UINT32_C(1) << prefix) - 1, prefix + 1);
    ff_bits_put(bits, value, order + prefix);
}

static inline uint32_t ff_bits_take_number(ff_bits *bits, unsigned order)
{
    unsigned prefix = 0;
    while (prefix <= FF_BITS_PREFIX_MAX && ff_bits_take(bits, 1)) prefix++;
    if (prefix > FF_BITS_PREFIX_MAX) {
        bits->error = FF_ERR_FORMAT;
        return 0;
    }
    uint32_t below = ((UINT32_C(1) << prefix) - 1) << order;
    return below + ff_bits_take(bits, order + prefix);
}

static inline void ff_bits_put_signed(ff_bits *bits, int32_t value, unsigned order)
{
    ff_bits_put_number(bits, value < 0 ? ~((uint32_t)value << 1) : (uint32_t)value << 1, order);
}

static inline int32_t ff_bits_take_signed(ff_bits *bits, unsigned order)
{
    uint32_t zigzag = ff_bits_take_number(bits, order);
    return (int32_t)(zigzag >> 1) ^ -(int32_t)(zigzag & 1u);
}

/* FF_OK when the number of bits read is that of the bytes, but for less than a byte of zeros. */
static inline int ff_bits_end(ff_bits *bits)
{
    if (bits->error != FF_OK) return bits->error;
    if (bits->at > bits->limit) return FF_ERR_TRUNCATED;
    if (bits->limit - bits->at >= 8) return FF_ERR_FORMAT;
    return ff_bits_take(bits, (unsigned)(bits->limit - bits->at)) ? FF_ERR_FORMAT : FF_OK;
}

static inline int ff_bits_written(const ff_bits *bits)
{
    return bits->at > bits->limit ? FF_ERR_FULL : (int)((bits->at + 7) / 8);
}

#endif
