#include "slow_tail.h"

#include <string.h>

/* ---- the tail -------------------------------------------------------------------------------- */

int slow_tail_bit(const slow_payload *p, int64_t number)
{
    return number < 8 * p->count ? p->bytes[p->count - 1 - number / 8] >> (7 - number % 8) & 1 : 0;
}

int64_t slow_tail_bits(slow_payload *p, int count)
{
    int64_t value = 0;

    while (count-- > 0) value = 2 * value + slow_tail_bit(p, p->tail++);
    return value;
}

int64_t slow_tail_number(slow_payload *p, int order)
{
    int ones = 0;

    while (ones <= 9 && slow_tail_bits(p, 1)) ones++;
    if (ones > 9) p->tail = 8 * p->count + 1000;
    return (INT64_C(1) << (ones + order)) - (1 << order) + slow_tail_bits(p, ones + order);
}

int64_t slow_stream_of(const slow_payload *p, uint8_t *bytes)
{
    int64_t bits = 8 * p->count - p->tail, whole = p->count - p->tail / 8;

    memset(bytes, 0, (size_t)p->count + 1);
    for (int64_t i = 0; i < bits; i++) {
        int64_t in_last = 8 * (whole - 1) + p->tail % 8, from = i;
        if (i >= 8 * (whole - 1)) from = in_last + i - 8 * (whole - 1);
        bytes[i / 8] |= (uint8_t)((p->bytes[from / 8] >> (7 - from % 8) & 1) << (7 - i % 8));
    }
    return whole;
}

/* ---- the head -------------------------------------------------------------------------------- */

/* 0, or -1. */
static int codes(slow_payload *p, int errors, int bound)
{
    int64_t sum = 0, first = 0;

    for (int i = 0; i < errors; i++) {
        int64_t code, v;
        if (i == 0) {
            code = slow_tail_bits(p, 1) ? bound - slow_tail_number(p, 1) : slow_tail_bits(p, 8);
            first = code;
        } else {
            v = slow_tail_number(p, first <= bound ? 1 : 3);
            code = (sum + i / 2) / i + (v % 2 ? -(v + 1) / 2 : v / 2);
        }
        if (code < 0 || code > 208) return -1;
        sum += code;
    }
    return 0;
}

static int mark(slow_payload *p) { return slow_tail_bits(p, 1) ? (int)slow_tail_bits(p, 4) : 0; }

/* What is rounded up. */
static int code_of(int64_t steps)
{
    for (int code = 0; code < 208; code++)
        if ((code < 32 ? code : (16 + code % 16) << (code / 16 - 1)) >= steps) return code;
    return 208;
}

/* 0, or -1. */
int slow_head_of(slow_payload *p, int root, int64_t max_error, slow_head *is)
{
    int as_bound = 1;

    memset(is, 0, sizeof(*is));
    if (slow_tail_bits(p, 1)) return 0;
    if (slow_tail_bits(p, 1)) {
        is->set = 1;
        return 0;
    }
    if (slow_tail_bits(p, 1)) {
        is->set = (int)slow_tail_bits(p, 1);
        as_bound = 0;
    } else {
        is->set = (int)slow_tail_bits(p, 1);
        is->form = (int)slow_tail_bits(p, 2);
        if (slow_tail_bits(p, 1)) {
            is->stub = mark(p);
            is->leaf = mark(p);
            is->filled = mark(p);
        }
        as_bound = slow_tail_bits(p, 1) || slow_tail_bits(p, 1); /* or all 0 */
    }
    if (root && (is->stub > 1 || is->leaf > 1 || is->filled > 1 || is->form == 1)) return -1;
    if (is->stub & is->leaf || is->form == 3) return -1;
    return as_bound ? 0 : codes(p, root ? 1 : 4, code_of(max_error));
}
