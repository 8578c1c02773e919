/* The index of a pack's section: which nodes have a record, and where it lies (protocol/SPEC.md,
 * "Index"). It grows with what is stored, not with what could be.
 *
 * A node has a *place* where its parent's record is stored: four places to a record of the level
 * above, one to a tile's root for level 0. A bit a place says whether the record is there; the
 * record's number is the count of bits before it, told every 256 places. Records lie in order of
 * number; the offset of every 64th is told, and each one's length in as many bits as the section's
 * longest needs. So a record is found in as many steps as its level has, each of constant time.
 */
#ifndef FF_INDEX_H
#define FF_INDEX_H

#include "ff_assert.h"
#include "ff_error.h"

#include <stddef.h>
#include <stdint.h>

#define FF_INDEX_PLACES         256u /* in a block of presence */
#define FF_INDEX_PRESENCE_BYTES (4 + FF_INDEX_PLACES / 8)
#define FF_INDEX_RECORDS        64u /* in a block of lengths */
#define FF_INDEX_LENGTH_BITS    18  /* of the longest payload: what a message may have */
#define FF_INDEX_BLOCK_MAX      (8 + FF_INDEX_RECORDS / 8 * FF_INDEX_LENGTH_BITS)
#define FF_RECORD_CRC_BYTES     2

/* What an index is of. */
typedef struct ff_index {
    uint64_t places; /* 0: every record is there, and has the number of its place */
    uint32_t records;
    uint8_t length_bits; /* of a payload; 1..FF_INDEX_LENGTH_BITS, 0 where there are no records */
} ff_index;

static inline size_t ff_index_block_bytes(const ff_index *index)
{
    return 8 + FF_INDEX_RECORDS / 8 * (size_t)index->length_bits;
}
/* From the index's start to its blocks of lengths, and to its end. */
static inline uint64_t ff_index_blocks_at(const ff_index *index)
{
    FF_ASSERT(index->places <= UINT64_MAX / 2);
    return (index->places + FF_INDEX_PLACES - 1) / FF_INDEX_PLACES * FF_INDEX_PRESENCE_BYTES;
}
static inline uint64_t ff_index_bytes(const ff_index *index)
{
    uint64_t blocks = ((uint64_t)index->records + FF_INDEX_RECORDS - 1) / FF_INDEX_RECORDS;
    return ff_index_blocks_at(index) + blocks * ff_index_block_bytes(index);
}

/* The number of the record at a place, from the block of presence that holds the place
 * (FF_INDEX_PRESENCE_BYTES). FF_OK, NOT_FOUND, or RANGE: the block is damaged. */
int ff_index_number(const ff_index *index, const uint8_t *block, uint64_t place, uint32_t *number);
/* Where a record lies, from the block of lengths that holds it (ff_index_block_bytes): offset of
 * its CRC in the section's data, and bytes of its payload. FF_OK or RANGE. */
int ff_index_record(const ff_index *index, const uint8_t *block, uint32_t number, uint64_t *offset,
                    uint32_t *bytes);

/* The same the other way, for writers: lengths are those of payloads, 0 where there is none. A
 * block of presence from up to 256 places, of which the first record would have number `rank`; a
 * block of lengths from up to 64 records. */
void ff_index_put_presence(const uint32_t *length, uint32_t places, uint32_t rank,
                           uint8_t block[FF_INDEX_PRESENCE_BYTES]);
void ff_index_put_lengths(const ff_index *index, const uint32_t *length, uint32_t records,
                          uint64_t offset, uint8_t *block);

/* CRC-16 of a record's payload: polynomial 0x1021, from 0xFFFF, highest bit first; of "123456789"
 * 0x29B1. */
uint16_t ff_crc16(const void *bytes, size_t count);

#endif
