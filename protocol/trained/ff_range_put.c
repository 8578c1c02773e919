/* The writing half of the range coder: for tools. */
#ifdef FF_ENCODER

#include "ff_range.h"

void ff_range_write(ff_range_writer *to, uint8_t *bytes, size_t limit)
{
    *to = (ff_range_writer){
        .width = UINT32_MAX, .out = bytes, .begin = bytes, .limit = bytes + limit
    };
}

/* Zeros at the end are not kept: of those alone there may be too many. */
static void emit(ff_range_writer *to, uint32_t byte)
{
    if (to->out < to->limit)
        *to->out++ = (uint8_t)byte;
    else if ((uint8_t)byte)
        to->is_full = 1;
}

void ff_range_shift(ff_range_writer *to)
{
    uint32_t carry = (uint32_t)(to->low >> 32), byte = (uint32_t)to->low >> 24;
    if (byte == 255 && !carry) {
        to->held++;
    } else {
        if (to->begun) emit(to, to->byte + carry);
        for (; to->held > 0; to->held--) emit(to, 255 + carry);
        to->byte = (uint8_t)byte;
        to->begun = 1;
    }
    to->low = (to->low & 0xFFFFFFu) << 8;
}

int ff_range_end_before(ff_range_writer *to)
{
    unsigned bits = ff_range_tail(to->width);
    uint64_t rest = (UINT64_C(1) << (32 - bits)) - 1;
    to->low = (to->low + rest) & ~rest;
    for (unsigned i = 0; i < 5; i++) ff_range_shift(to);
    FF_ASSERT(to->is_full || to->out - to->begin >= 4);
    return to->is_full ? -1 : 8 * ((int)(to->out - to->begin) - 4) + (int)bits;
}

/* Of all numbers in the range that with the most zeros at its end, told in steps of bits. Bytes. */
static int end_in(ff_range_writer *to, unsigned step)
{
    for (unsigned bits = 32;; bits -= step) {
        uint64_t rest = (UINT64_C(1) << bits) - 1, value = (to->low + rest) & ~rest;
        if (value >= to->low + to->width) continue;
        to->low = value;
        break;
    }
    for (unsigned i = 0; i < 5; i++) ff_range_shift(to);
    while (to->out > to->begin && !to->out[-1]) to->out--;
    return to->is_full ? -1 : (int)(to->out - to->begin);
}

int ff_range_end(ff_range_writer *to) { return end_in(to, 8); }

int ff_range_end_bits(ff_range_writer *to)
{
    int bytes = end_in(to, 1), bits = 8 * bytes;
    for (unsigned last = bytes > 0 ? to->out[-1] : 1; !(last & 1u); last >>= 1) bits--;
    return bytes < 0 ? -1 : bits;
}

#else
typedef int ff_range_put_not_built; /* ISO C wants a declaration in every file */
#endif
