/* What stands at the end of payloads of codec 3 (trained), bit by bit, for its second decoder:
 * written from protocol/SPEC.md, "Payload, codec 3". */
#ifndef SLOW_TAIL_H
#define SLOW_TAIL_H

#include <stdint.h>

/* A payload, and where its tail is read: so many bits from the end. */
typedef struct slow_payload {
    const uint8_t *bytes;
    int64_t count, tail;
} slow_payload;

typedef struct slow_head {
    int set, form, stub, leaf, filled;
} slow_head;

/* Of all bits behind the end there are as many 0 as are asked for. */
int slow_tail_bit(const slow_payload *p, int64_t number);
int64_t slow_tail_bits(slow_payload *p, int count);
int64_t slow_tail_number(slow_payload *p, int order);
/* The bits of the payload before its tail, as bytes: so many, the last filled up with 0. `bytes`
 * has room for one more than the payload. */
int64_t slow_stream_of(const slow_payload *p, uint8_t *bytes);
/* 0, or -1: it breaks a rule. */
int slow_head_of(slow_payload *p, int root, int64_t max_error, slow_head *is);

#endif
