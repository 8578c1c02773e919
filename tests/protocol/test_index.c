/* Indexes of sections: every record is found and no other, whatever is missing, in a mapping and by
 * a function that reads, below and beyond 4 GB. */
#include "../../platform/sys.h"
#include "../../protocol/ff_pack.h"
#include "../rig/pack_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include <fcntl.h>
#include <unistd.h>

#define PLACES 3000

static uint32_t next_random(uint32_t *seed)
{
    *seed = *seed * 1664525 + 1013904223;
    return *seed >> 8;
}

/* Presence and lengths of all places, in blocks. The bytes (free them). */
static uint8_t *make_index(ff_index *index, const uint32_t *length)
{
    uint32_t present[PLACES], count = 0, longest = 0;
    for (uint32_t i = 0; i < PLACES; i++) {
        if (length[i]) present[count++] = length[i];
        longest = length[i] > longest ? length[i] : longest;
    }
    *index = (ff_index){ .places = PLACES, .records = count };
    while (longest >> index->length_bits) index->length_bits++;
    uint8_t *bytes = malloc((size_t)ff_index_bytes(index) + 1), *at = bytes;
    uint32_t rank = 0;
    for (uint32_t i = 0; i < PLACES; i += FF_INDEX_PLACES, at += FF_INDEX_PRESENCE_BYTES) {
        uint32_t places = PLACES - i < FF_INDEX_PLACES ? PLACES - i : FF_INDEX_PLACES;
        ff_index_put_presence(length + i, places, rank, at);
        for (uint32_t k = 0; k < places; k++) rank += length[i + k] > 0;
    }
    uint64_t offset = 0;
    for (uint32_t i = 0; i < count; i += FF_INDEX_RECORDS, at += ff_index_block_bytes(index)) {
        uint32_t records = count - i < FF_INDEX_RECORDS ? count - i : FF_INDEX_RECORDS;
        ff_index_put_lengths(index, present + i, records, offset, at);
        for (uint32_t k = 0; k < records; k++) offset += FF_RECORD_CRC_BYTES + present[i + k];
    }
    assert_int_equal(at - bytes, ff_index_bytes(index));
    return bytes;
}

static void check(const uint32_t *length)
{
    ff_index index;
    uint8_t *bytes = make_index(&index, length);
    uint64_t expected = 0;
    uint32_t rank = 0;
    for (uint32_t place = 0; place < PLACES; place++) {
        uint32_t number, found;
        uint64_t offset;
        int rc = ff_index_number(&index, bytes + place / FF_INDEX_PLACES * FF_INDEX_PRESENCE_BYTES,
                                 place, &number);
        assert_int_equal(rc, length[place] ? FF_OK : FF_ERR_NOT_FOUND);
        if (rc != FF_OK) continue;
        assert_int_equal(number, rank++);
        rc = ff_index_record(&index,
                             bytes + ff_index_blocks_at(&index) +
                                 number / FF_INDEX_RECORDS * ff_index_block_bytes(&index),
                             number, &offset, &found);
        assert_int_equal(rc, FF_OK);
        assert_int_equal(found, length[place]);
        assert_int_equal(offset, expected);
        expected += FF_RECORD_CRC_BYTES + found;
    }
    free(bytes);
}

static void every_record_is_found_and_no_other(void **state)
{
    static uint32_t length[PLACES];
    uint32_t seed = 1;
    (void)state;
    for (uint32_t bits = 1; bits <= FF_INDEX_LENGTH_BITS; bits++)
        for (uint32_t share = 0; share <= 100; share += 25) {
            for (uint32_t i = 0; i < PLACES; i++) {
                uint32_t any = next_random(&seed) & ((1u << bits) - 1);
                length[i] = next_random(&seed) % 100 < share ? (any ? any : 1) : 0;
            }
            check(length);
        }
    memset(length, 0, sizeof length);
    length[PLACES - 1] = 77;
    check(length);
}

static void crc16_is_the_usual_one(void **state)
{
    (void)state;
    assert_int_equal(ff_crc16("123456789", 9), 0x29B1);
    assert_int_equal(ff_crc16("", 0), 0xFFFF);
}

/* ---- a pack that is read, not mapped ---- */

typedef struct source {
    const uint8_t *bytes;
    uint64_t size, hole_at, hole_bytes; /* beyond hole_at everything lies hole_bytes further on */
    uint32_t reads, fail_at;            /* 0: never */
} source;

static int read_source(void *context, uint64_t offset, void *out, size_t count)
{
    source *from = context;
    if (++from->reads == from->fail_at) return FF_ERR_SYSTEM;
    if (offset >= from->hole_at + from->hole_bytes)
        offset -= from->hole_bytes;
    else
        assert_true(offset + count <= from->hole_at);
    assert_true(offset + count <= from->size);
    memcpy(out, from->bytes + offset, count);
    return FF_OK;
}

static void a_pack_is_read_through_a_function(void **state)
{
    static uint8_t room[FF_PACK_HEADER_BYTES + FF_PAYLOAD_BYTES_MAX];
    size_t count;
    uint8_t *bytes = pack_fixture_usual(&count);
    source from = { .bytes = bytes, .size = count, .hole_at = count };
    ff_pack mapped, read;
    uint64_t bad;
    (void)state;
    assert_int_equal(ff_pack_open(&mapped, bytes, count), FF_OK);
    assert_int_equal(ff_pack_open_reader(&read, read_source, &from, count, room, 4095),
                     FF_ERR_FULL);
    assert_int_equal(ff_pack_open_reader(&read, read_source, &from, count, room, sizeof room),
                     FF_OK);
    assert_memory_equal(&read.header, &mapped.header, sizeof read.header);
    assert_int_equal(ff_pack_verify(&read, &bad), FF_OK);
    for (uint32_t tile = 0; tile < 4; tile++)
        for (uint32_t level = 0; level < 3; level++)
            for (uint32_t code = 0; code < 1u << 2 * level; code++) {
                const uint8_t *a, *b;
                ff_key key = ff_key_make(tile, level, code);
                int a_bytes = ff_pack_record(&mapped, FF_SECTION_REFINEMENT, key, &a);
                from.reads = 0;
                int b_bytes = ff_pack_record(&read, FF_SECTION_REFINEMENT, key, &b);
                assert_in_range(from.reads, 3, level + 3); /* a block a level, lengths, record */
                assert_true(a_bytes > 0);
                assert_int_equal(a_bytes, b_bytes);
                assert_memory_equal(a, b, (size_t)a_bytes);
                from.reads = 0;
                from.fail_at = 1 + code % (level + 3);
                assert_int_equal(ff_pack_record(&read, FF_SECTION_REFINEMENT, key, &b),
                                 FF_ERR_SYSTEM);
                from.fail_at = 0;
            }
    free(bytes);
}

/* The usual pack, its last section's data behind a hole of 5 GB. */
typedef struct large_pack {
    uint8_t *bytes;
    ff_pack mapped; /* without the hole */
    source from;
    uint64_t size;
    uint32_t level; /* of the last section */
} large_pack;

static void make_large(large_pack *p)
{
    size_t count;
    p->bytes = pack_fixture_usual(&count);
    assert_int_equal(ff_pack_open(&p->mapped, p->bytes, count), FF_OK);
    ff_pack_header header = p->mapped.header;
    ff_pack_section *last = &header.section[header.section_count - 1];
    p->level = last->level;
    p->from = (source){ .bytes = p->bytes,
                        .size = count,
                        .hole_at = last->data_offset,
                        .hole_bytes = UINT64_C(5) << 30 };
    p->size = count + p->from.hole_bytes;
    if (last->index_offset >= last->data_offset) last->index_offset += p->from.hole_bytes;
    last->data_offset += p->from.hole_bytes;
    assert_int_equal(ff_pack_header_encode(&header, p->bytes), FF_OK);
}

static void expect_same(const large_pack *p, const ff_pack *large)
{
    const uint8_t *a, *b;
    for (uint32_t code = 0; code < 1u << 2 * p->level; code++) {
        ff_key key = ff_key_make(3, p->level, code);
        int a_bytes = ff_pack_record(&p->mapped, FF_SECTION_REFINEMENT, key, &a);
        assert_true(a_bytes > 0);
        assert_int_equal(ff_pack_record(large, FF_SECTION_REFINEMENT, key, &b), a_bytes);
        assert_memory_equal(a, b, (size_t)a_bytes);
    }
}

static void records_beyond_4_gb_are_read(void **state)
{
    static uint8_t room[FF_PACK_HEADER_BYTES + FF_PAYLOAD_BYTES_MAX];
    static large_pack p;
    ff_pack read;
    (void)state;
    make_large(&p);
    assert_int_equal(ff_pack_open_reader(&read, read_source, &p.from, p.size, room, sizeof room),
                     FF_OK);
    expect_same(&p, &read);
    free(p.bytes);
}

/* A file with a real hole; skipped where the disk makes none. */
static void records_beyond_4_gb_are_found_in_a_mapping(void **state)
{
    static const char path[] = "build/test_index.ffp";
    static large_pack p;
    sys_mapping mapping;
    ff_pack large;
    (void)state;
    make_large(&p);
    uint64_t at = p.from.hole_at, behind = p.from.size - at;
    int fd = open(path, O_RDWR | O_CREAT | O_TRUNC, 0666);
    assert_true(fd >= 0);
    int made = pwrite(fd, p.bytes, at, 0) == (ssize_t)at &&
               pwrite(fd, p.bytes + at, behind, (off_t)(at + p.from.hole_bytes)) == (ssize_t)behind;
    close(fd);
    int rc = made ? sys_map_file(path, &mapping) : FF_ERR_SYSTEM;
    unlink(path);
    if (rc == FF_OK) {
        assert_true(mapping.size == p.size);
        assert_int_equal(ff_pack_open(&large, mapping.bytes, mapping.size), FF_OK);
        expect_same(&p, &large);
        sys_unmap_file(&mapping);
    }
    free(p.bytes);
    if (rc != FF_OK) skip();
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(every_record_is_found_and_no_other),
                                        cmocka_unit_test(crc16_is_the_usual_one),
                                        cmocka_unit_test(a_pack_is_read_through_a_function),
                                        cmocka_unit_test(records_beyond_4_gb_are_read),
                                        cmocka_unit_test(
                                            records_beyond_4_gb_are_found_in_a_mapping) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
