/* Private to codec trained: the bits at a payload's end (SPEC.md, "Payload, codec 3").
 *
 * A payload is a stream from its beginning on, and bits from its end on: the first is the highest
 * bit of the last byte, and behind the lowest one follows the byte before. Where they end inside a
 * byte, its lower bits are the stream's: its last ones, which a reader of the stream finds shifted
 * up. So what is told of a payload, its sides and its stream share bytes, and stored bits go
 * together anew wherever they lay. */
#ifndef FF_TAIL_H
#define FF_TAIL_H

#include "../ff_assert.h"

#include <stddef.h>
#include <stdint.h>

/* ---- taking ---- */

typedef struct ff_tail {
    const uint8_t *bytes; /* the whole payload */
    uint32_t count;
    uint32_t at; /* bits that are taken; beyond the payload they are 0 */
} ff_tail;

static inline uint32_t ff_tail_byte(const ff_tail *tail, uint32_t number)
{
    return number < tail->count ? tail->bytes[tail->count - 1 - number] : 0;
}
/* Four of them, the first one highest: as they lie, the first one last. */
static inline uint32_t ff_tail_word(const ff_tail *tail, uint32_t number)
{
    if (number + 4 <= tail->count) {
        const uint8_t *at = tail->bytes + (tail->count - number - 4);
        return at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
    }
    return ff_tail_byte(tail, number) << 24 | ff_tail_byte(tail, number + 1) << 16 |
           ff_tail_byte(tail, number + 2) << 8 | ff_tail_byte(tail, number + 3);
}
/* More was taken than there is. */
static inline int ff_tail_is_short(const ff_tail *tail) { return tail->at > 8 * tail->count; }
/* Bits, at most 16, the first one highest. */
uint32_t ff_tail_take(ff_tail *tail, unsigned bits);
/* A number of order n: u times 1 and a 0, then u + n bits b: 2^(u + n) - 2^n + b. From
 * FF_TAIL_ONES_MAX + 1 ones on it is none, and more was taken than there is. */
#define FF_TAIL_ONES_MAX 9
uint32_t ff_tail_number(ff_tail *tail, unsigned order);
/* Of what lies before the bits that are taken: bytes, the last of which, where bits of it are
 * taken, is *last; and its bits up to the last one that is 1. */
uint32_t ff_tail_before(const ff_tail *tail, uint8_t *last);
uint32_t ff_stream_bits(const uint8_t *bytes, uint32_t count, uint8_t last);

/* ---- putting ---- */

#define FF_BITS_BYTES_MAX 320

typedef struct ff_bits { /* all 0: none */
    uint32_t count;
    uint8_t bytes[FF_BITS_BYTES_MAX];
} ff_bits;

/* The lowest `bits` of a value, the highest of them first. */
void ff_bits_put(ff_bits *bits, uint32_t value, unsigned count);
void ff_bits_number(ff_bits *bits, uint32_t value, unsigned order);
/* The next ones of a tail. */
void ff_bits_copy(ff_bits *bits, ff_tail *from, uint32_t count);
/* Puts bits behind a stream of `stream_bits`, which is at `out` already, with zeros to the end of
 * its last byte. Bytes in all. */
size_t ff_bits_join(const ff_bits *bits, uint8_t *out, uint32_t stream_bits);

#endif
