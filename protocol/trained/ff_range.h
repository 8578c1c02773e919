/* Private to codec trained and to pictures: a binary range coder (SPEC.md, "Payload, codec 3";
 * Martin, "Range encoding", 1979).
 *
 * A decision takes the lower part of what is left of a range, as large as the decision's
 * probability, when it is 1. The range grows by a byte whenever it has become small. Bytes read
 * beyond a stream's end are 0, so it ends with the fewest that lead into the range. */
#ifndef FF_RANGE_H
#define FF_RANGE_H

#include "../ff_assert.h"

#include <stddef.h>
#include <stdint.h>

#define FF_RANGE_LEAST (UINT32_C(1) << 24)

typedef struct ff_range {
    uint32_t width, code; /* of the range; how far the stream is above its beginning */
    const uint8_t *in;
    int32_t left; /* bytes; of what was read beyond the end less than none */
} ff_range;

static inline uint32_t ff_range_byte(ff_range *range)
{
    return range->left-- > 0 ? *range->in++ : 0;
}

static inline void ff_range_read(ff_range *range, const uint8_t *bytes, size_t count)
{
    *range = (ff_range){ .width = UINT32_MAX, .in = bytes, .left = (int32_t)count };
    if (count < 4) {
        for (unsigned i = 0; i < 4; i++) range->code = range->code << 8 | ff_range_byte(range);
        return;
    }
    range->code = (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 |
                  bytes[3];
    range->in += 4;
    range->left -= 4;
}

/* `one` of 65536 is how likely the decision is 1. */
static inline unsigned ff_range_take(ff_range *range, uint32_t one)
{
    uint32_t part = (range->width >> 16) * one;
    unsigned bit = range->code < part;
    FF_ASSERT(range->width >= FF_RANGE_LEAST && one > 0 && one < 65536);
    if (bit) {
        range->width = part;
    } else {
        range->width -= part;
        range->code -= part;
    }
    while (range->width < FF_RANGE_LEAST) {
        range->width <<= 8;
        range->code = range->code << 8 | ff_range_byte(range);
    }
    return bit;
}

static inline int ff_range_is_read(const ff_range *range) { return range->left <= 0; }

/* A stream that others follow takes so many bits beyond those that have grown its range: whatever
 * the next ones are, they do not lead out of it. */
static inline unsigned ff_range_tail(uint32_t width)
{
    FF_ASSERT(width >= FF_RANGE_LEAST);
#ifdef __GNUC__
    return 2 + (unsigned)__builtin_clz(width);
#else
    unsigned bits = 2;
    for (; !(width >> 31); width <<= 1) bits++;
    return bits;
#endif
}
/* How many it took, of `count` bytes that were given. */
static inline uint32_t ff_range_bits(const ff_range *range, size_t count)
{
    return 8 * (uint32_t)((int32_t)count - range->left - 4) + ff_range_tail(range->width);
}

/* ---- encoder ---- */

/* Bytes that a carry may still change are held back: one, and as many of 255 as follow it. */
typedef struct ff_range_writer {
    uint64_t low;
    uint32_t width, held;
    int begun; /* there is a byte held back */
    uint8_t byte;
    uint8_t *out, *begin, *limit;
    int is_full; /* bytes did not fit */
} ff_range_writer;

void ff_range_write(ff_range_writer *to, uint8_t *bytes, size_t limit);
/* The highest byte of 32 bits leaves. */
void ff_range_shift(ff_range_writer *to);
static inline void ff_range_put(ff_range_writer *to, uint32_t one, unsigned bit)
{
    uint32_t part = (to->width >> 16) * one;
    FF_ASSERT(to->width >= FF_RANGE_LEAST && one > 0 && one < 65536);
    if (bit) {
        to->width = part;
    } else {
        to->low += part;
        to->width -= part;
    }
    for (; to->width < FF_RANGE_LEAST; to->width <<= 8) ff_range_shift(to);
}
/* Bytes in all, or -1: they did not fit. */
int ff_range_end(ff_range_writer *to);
/* The same in bits, the fewest. */
int ff_range_end_bits(ff_range_writer *to);
/* Bits of a stream that others follow. */
int ff_range_end_before(ff_range_writer *to);

#endif
