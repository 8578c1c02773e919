/* Packed column spans of a panorama face (SPEC.md, "Columns"). A skyline is often level, or moves
 * by a row or two from column to column, so each list is written as runs and steps, four bits at a
 * time. */
#include "ff_message.h"

#define SMALL_MAX       5  /* steps of -5..5 are one nibble, 0..10, zigzag */
#define NIBBLE_RUN      11 /* the last value 1..16 times again: one more nibble */
#define NIBBLE_LONG_RUN 12 /* 17..272 times: two more */
#define NIBBLE_STEP     13 /* any step: three more, zigzag */

FF_STATIC_ASSERT(NIBBLE_RUN == 2 * SMALL_MAX + 1); /* the nibbles below are small steps */
FF_STATIC_ASSERT(2 * FF_FACE_SIZE_MAX < 1 << 12);  /* three nibbles hold every step */

typedef struct nibbles {
    uint8_t *out;      /* NULL when reading */
    const uint8_t *in; /* NULL when writing */
    size_t at, limit;  /* in nibbles; `at` runs on beyond `limit` when there was too little room */
} nibbles;

static void put(nibbles *n, uint32_t value)
{
    FF_ASSERT(value <= 15);
    if (n->at < n->limit) {
        if (n->at % 2 == 0) n->out[n->at / 2] = 0;
        n->out[n->at / 2] |= (uint8_t)(value << (n->at % 2 * 4));
    }
    n->at++;
}

/* The next `count` nibbles as one number, low nibble first. Nibbles beyond the end are zeros; the
 * caller sees by `at` that they were read. */
static uint32_t take(nibbles *n, unsigned count)
{
    uint32_t value = 0;

    FF_ASSERT(count <= 3); /* as many as any token is followed by */
    for (unsigned i = 0; i < count; i++, n->at++)
        if (n->at < n->limit)
            value |= (uint32_t)(n->in[n->at / 2] >> (n->at % 2 * 4) & 15u) << (4 * i);
    return value;
}

static uint32_t run_length(const uint16_t *list, uint32_t i, uint32_t count, uint32_t value)
{
    uint32_t length = 0;

    while (i + length < count && length < 272 && list[i + length] == value) length++;
    return length;
}

static void put_step(nibbles *n, int32_t step)
{
    uint32_t zigzag = step < 0 ? ~((uint32_t)step << 1) : (uint32_t)step << 1;

    if (zigzag <= 2 * SMALL_MAX) {
        put(n, zigzag);
        return;
    }
    FF_ASSERT(zigzag >> 12 == 0);
    put(n, NIBBLE_STEP);
    for (int shift = 0; shift < 12; shift += 4) put(n, zigzag >> shift & 15u);
}

static void put_list(nibbles *n, const uint16_t *list, uint32_t count)
{
    uint32_t previous = 0;

    for (uint32_t i = 0; i < count;) {
        uint32_t run = run_length(list, i, count, previous);
        FF_ASSERT(run <= count - i && run <= 17 + UINT8_MAX);
        if (run > 16) {
            put(n, NIBBLE_LONG_RUN);
            put(n, (run - 17) & 15u);
            put(n, (run - 17) >> 4);
            i += run;
        } else if (run > 2) {
            put(n, NIBBLE_RUN);
            put(n, run - 1);
            i += run;
        } else {
            put_step(n, (int32_t)list[i] - (int32_t)previous);
            previous = list[i++];
        }
    }
}

int ff_face_columns_encode(const uint16_t *top, const uint16_t *bottom, uint32_t count,
                           uint8_t *out, size_t capacity)
{
    nibbles n = { out, NULL, 0, 2 * capacity };

    for (uint32_t i = 0; i < count; i++)
        if (top[i] > bottom[i] || bottom[i] > FF_FACE_SIZE_MAX) return FF_ERR_RANGE;
    put_list(&n, top, count);
    put_list(&n, bottom, count);
    FF_ASSERT((n.at + 1) / 2 <= 4 * (size_t)count + 8); /* as ff_message.h promises */
    return n.at <= n.limit ? (int)((n.at + 1) / 2) : FF_ERR_FULL;
}

static int take_list(nibbles *n, uint16_t *list, uint32_t count, uint32_t row_count)
{
    int32_t value = 0;

    FF_ASSERT(row_count <= FF_FACE_SIZE_MAX);
    for (uint32_t i = 0; i < count;) {
        uint32_t token = take(n, 1), run = 1;
        if (token == NIBBLE_RUN) {
            run = take(n, 1) + 1;
        } else if (token == NIBBLE_LONG_RUN) {
            run = take(n, 2) + 17;
        } else if (token <= NIBBLE_STEP) {
            uint32_t zigzag = token == NIBBLE_STEP ? take(n, 3) : token;
            value += (int32_t)(zigzag >> 1) ^ -(int32_t)(zigzag & 1u);
        } else {
            return FF_ERR_RANGE;
        }
        if (n->at > n->limit) return FF_ERR_TRUNCATED;
        if (value < 0 || value > (int32_t)row_count || run > count - i) return FF_ERR_RANGE;
        for (; run > 0; run--) list[i++] = (uint16_t)value;
    }
    return FF_OK;
}

int ff_face_columns_decode(const uint8_t *bytes, size_t byte_count, uint32_t count,
                           uint32_t row_count, uint16_t *top, uint16_t *bottom)
{
    nibbles n = { NULL, bytes, 0, 2 * byte_count };
    int rc = take_list(&n, top, count, row_count);

    if (rc == FF_OK) rc = take_list(&n, bottom, count, row_count);
    if (rc == FF_OK && (n.at + 1) / 2 != byte_count) return FF_ERR_RANGE;
    for (uint32_t i = 0; rc == FF_OK && i < count; i++)
        if (top[i] > bottom[i]) return FF_ERR_RANGE;
    return rc;
}
