/* Bits at a payload's end. */
#include "ff_tail.h"

#include <string.h>

/* What comes next, from the highest bit down: 25 bits or more. */
static inline uint32_t ahead(const ff_tail *tail)
{
    return ff_tail_word(tail, tail->at / 8) << tail->at % 8;
}

uint32_t ff_tail_take(ff_tail *tail, unsigned bits)
{
    uint32_t value = ahead(tail) >> 16 >> (16 - bits);
    FF_ASSERT(bits <= 16);
    tail->at += bits;
    return value;
}

uint32_t ff_tail_number(ff_tail *tail, unsigned order)
{
    unsigned ones = 0;
    for (uint32_t next = ahead(tail); next >> 31; next <<= 1) ones++;
    FF_ASSERT(order + FF_TAIL_ONES_MAX <= 16);
    if (ones > FF_TAIL_ONES_MAX) {
        tail->at = 8 * tail->count + 1;
        return 0;
    }
    tail->at += ones + 1;
    return (1u << (ones + order)) - (1u << order) + ff_tail_take(tail, ones + order);
}

uint32_t ff_tail_before(const ff_tail *tail, uint8_t *last)
{
    uint32_t whole = tail->at / 8, shared = tail->at % 8;
    FF_ASSERT(!ff_tail_is_short(tail) && whole <= tail->count);
    *last = (uint8_t)(ff_tail_byte(tail, whole) << shared);
    return tail->count - whole;
}

uint32_t ff_stream_bits(const uint8_t *bytes, uint32_t count, uint8_t last)
{
    uint32_t bits = 8 * count, byte = last;
    while (bits > 0 && !byte) {
        bits -= 8;
        byte = bits > 0 ? bytes[bits / 8 - 1] : 0;
    }
    for (; byte && !(byte & 1u); byte >>= 1) bits--;
    FF_ASSERT(bits <= 8 * count && (!byte || bits > 0));
    return bits;
}

void ff_bits_put(ff_bits *bits, uint32_t value, unsigned count)
{
    FF_ASSERT(bits->count + count <= 8 * FF_BITS_BYTES_MAX);
    while (count-- > 0) {
        bits->bytes[bits->count / 8] |= (uint8_t)((value >> count & 1u) << (7 - bits->count % 8));
        bits->count++;
    }
}

void ff_bits_number(ff_bits *bits, uint32_t value, unsigned order)
{
    unsigned ones = 0;
    value += 1u << order;
    while (value >> (ones + order) > 1) ones++;
    FF_ASSERT(ones <= FF_TAIL_ONES_MAX);
    ff_bits_put(bits, (1u << (ones + 1)) - 2, ones + 1);
    ff_bits_put(bits, value, ones + order);
}

void ff_bits_copy(ff_bits *bits, ff_tail *from, uint32_t count)
{
    FF_ASSERT(bits->count + count <= 8 * FF_BITS_BYTES_MAX);
    for (; count > 8; count -= 8) ff_bits_put(bits, ff_tail_take(from, 8), 8);
    ff_bits_put(bits, ff_tail_take(from, count), count);
}

size_t ff_bits_join(const ff_bits *bits, uint8_t *out, uint32_t stream_bits)
{
    size_t stream = (stream_bits + 7) / 8, all = (stream_bits + bits->count + 7) / 8;
    uint32_t whole = bits->count / 8, shared = bits->count % 8;
    memset(out + stream, 0, all - stream);
    FF_ASSERT(whole + (shared > 0) <= FF_BITS_BYTES_MAX && all >= whole);
    if (shared)
        out[all - 1 - whole] = (uint8_t)(out[all - 1 - whole] >> shared | bits->bytes[whole]);
    for (uint32_t i = 0; i < whole; i++) out[all - 1 - i] = bits->bytes[i];
    return all;
}
