/* Blocks of a section's index. What is read here may be damaged: no number is believed. */
#include "ff_index.h"

static uint64_t load(const uint8_t *bytes, unsigned count)
{
    uint64_t value = 0;

    for (unsigned i = count; i-- > 0;) value = value << 8 | bytes[i];
    return value;
}

/* How many of the first `count` bits are set. */
static uint32_t ones(const uint8_t *bits, uint32_t count)
{
    static const uint8_t in_nibble[16] = { 0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4 };
    uint32_t sum = 0;

    for (; count >= 8; count -= 8, bits++) sum += in_nibble[*bits & 15u] + in_nibble[*bits >> 4];
    if (count > 0) {
        uint8_t last = *bits & (uint8_t)((1u << count) - 1);
        sum += in_nibble[last & 15u] + in_nibble[last >> 4];
    }
    return sum;
}

int ff_index_number(const ff_index *index, const uint8_t *block, uint64_t place, uint32_t *number)
{
    uint32_t at = (uint32_t)(place % FF_INDEX_PLACES);
    uint64_t rank;

    FF_ASSERT(place < index->places);
    if (!(block[4 + at / 8] >> at % 8 & 1u)) return FF_ERR_NOT_FOUND;
    rank = load(block, 4) + ones(block + 4, at);
    if (rank >= index->records) return FF_ERR_RANGE;
    *number = (uint32_t)rank;
    return FF_OK;
}

static uint32_t bits_at(const uint8_t *bytes, size_t first, unsigned count)
{
    const uint8_t *at = bytes + first / 8;
    unsigned shift = first % 8, held = 8 - shift;
    uint32_t value = (uint32_t)*at >> shift;

    FF_ASSERT(count >= 1 && count <= FF_INDEX_LENGTH_BITS);
    for (; held < count; held += 8) value |= (uint32_t) * ++at << held;
    return value & ((1u << count) - 1);
}

int ff_index_record(const ff_index *index, const uint8_t *block, uint32_t number, uint64_t *offset,
                    uint32_t *bytes)
{
    uint32_t at = number % FF_INDEX_RECORDS, before = 0;
    unsigned bits = index->length_bits;

    FF_ASSERT(number < index->records);
    for (uint32_t i = 0; i < at; i++)
        before += FF_RECORD_CRC_BYTES + bits_at(block + 8, (size_t)i * bits, bits);
    *offset = load(block, 8);
    *bytes = bits_at(block + 8, (size_t)at * bits, bits);
    if (*bytes == 0 || *offset > UINT64_MAX - before) return FF_ERR_RANGE;
    *offset += before;
    return FF_OK;
}

uint16_t ff_crc16(const void *bytes, size_t count)
{
    const uint8_t *at = bytes;
    uint32_t crc = 0xFFFF;

    for (; count > 0; count--, at++) { /* the polynomial divides byte by byte, without a table */
        uint32_t x = (crc >> 8 ^ *at) & 0xFFu;
        x ^= x >> 4;
        crc = (crc << 8 ^ x << 12 ^ x << 5 ^ x) & 0xFFFFu;
    }
    return (uint16_t)crc;
}
