/* Blocks of a section's index, for writers. */
#include "ff_index.h"

#include <string.h>

static void store(uint8_t *bytes, uint64_t value, unsigned count)
{
    for (unsigned i = 0; i < count; i++) bytes[i] = (uint8_t)(value >> 8 * i);
}

void ff_index_put_presence(const uint32_t *length, uint32_t places, uint32_t rank,
                           uint8_t block[FF_INDEX_PRESENCE_BYTES])
{
    FF_ASSERT(places <= FF_INDEX_PLACES);
    memset(block, 0, FF_INDEX_PRESENCE_BYTES);
    store(block, rank, 4);
    for (uint32_t i = 0; i < places; i++) block[4 + i / 8] |= (uint8_t)((length[i] > 0) << i % 8);
}

void ff_index_put_lengths(const ff_index *index, const uint32_t *length, uint32_t records,
                          uint64_t offset, uint8_t *block)
{
    unsigned bits = index->length_bits;

    FF_ASSERT(records <= FF_INDEX_RECORDS);
    memset(block, 0, ff_index_block_bytes(index));
    store(block, offset, 8);
    for (uint32_t i = 0; i < records; i++) {
        FF_ASSERT(length[i] > 0 && length[i] >> bits == 0);
        for (unsigned bit = 0; bit < bits; bit++) {
            size_t at = (size_t)i * bits + bit;
            block[8 + at / 8] |= (uint8_t)((length[i] >> bit & 1u) << at % 8);
        }
    }
}
