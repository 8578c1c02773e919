/* The pack reader finds every record, and names every kind of damage. */
#include "../../protocol/ff_pack.h"
#include "../rig/pack_fixture.h"
#include "../rig/slow_pack.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static uint16_t codec_room[FF_CODEC_ROOM_MAX / 2 + 1];

typedef struct fixture {
    uint8_t *bytes;
    size_t count;
} fixture;

static uint16_t other_hills(void *context, uint32_t x, uint32_t y)
{
    return pack_fixture_hills(context, x + 1, y) ^ 1u;
}

/* Two tiles of 2^4 cells, raw codec: every record of two such packs has the same length. */
static fixture make_small(uint16_t (*height)(void *context, uint32_t x, uint32_t y))
{
    static const uint8_t about[] = "\1\5Hills\2\6nobody";
    pack_fixture_desc desc = { .info = pack_fixture_info(4, 2, 1),
                               .height = height,
                               .about = { about, sizeof about - 1 } };
    fixture f;

    desc.info.node_log2 = 2;
    desc.info.codec = FF_CODEC_RAW;
    f.bytes = pack_fixture_make(&desc, &f.count);
    assert_non_null(f.bytes);
    return f;
}

static int make(void **state)
{
    fixture *f = calloc(1, sizeof(*f));

    *f = make_small(pack_fixture_hills);
    *state = f;
    return 0;
}

static int drop(void **state)
{
    free(((fixture *)*state)->bytes);
    free(*state);
    return 0;
}

static void put(uint8_t *at, uint64_t value, unsigned bytes)
{
    for (unsigned i = 0; i < bytes; i++) at[i] = (uint8_t)(value >> (8 * i));
}

static void reseal(fixture *f)
{
    put(f->bytes + 76, 0, 4);
    put(f->bytes + 76, ff_crc32(0, f->bytes, FF_PACK_HEADER_BYTES - 4), 4);
    put(f->bytes + FF_PACK_HEADER_BYTES - 4, ff_crc32(0, f->bytes, FF_PACK_HEADER_BYTES - 4), 4);
}

static int open_rc(const fixture *f)
{
    ff_pack pack;

    return ff_pack_open(&pack, f->bytes, f->count);
}

/* ---- good packs ---- */

static void crc_is_the_usual_one(void **state)
{
    (void)state;
    assert_int_equal(ff_crc32(0, "123456789", 9), 0xcbf43926);
    assert_int_equal(ff_crc32(ff_crc32(0, "1234", 4), "56789", 5), 0xcbf43926);
    assert_int_equal(ff_crc32(0, NULL, 0), 0);
}

static void walk(const ff_pack *pack, ff_decoder *dec, ff_key key, const uint16_t *heights,
                 uint32_t *nodes)
{
    static int32_t value[FF_REFINED_HEIGHTS_MAX];
    const ff_terrain_info *info = &pack->header.info;
    uint16_t refined[FF_REFINED_HEIGHTS_MAX], child[FF_NODE_HEIGHTS_MAX];
    uint32_t side = ff_node_side(info),
             step = 1u << (info->tile_log2 - info->node_log2 - ff_key_level(key));
    uint32_t x0 = (ff_key_tile(key) << info->tile_log2) +
                  (ff_morton_x(ff_key_code(key)) * step << info->node_log2);
    uint32_t y0 = ff_morton_y(ff_key_code(key)) * step << info->node_log2;
    ff_residuals residuals = { .value = value };
    const uint8_t *payload;

    ++*nodes;
    for (uint32_t i = 0; i < side * side; i++)
        assert_int_equal(heights[i],
                         pack_fixture_hills(NULL, x0 + i % side * step, y0 + i / side * step));
    if (ff_key_level(key) + 1 == ff_terrain_levels(info)) return;
    int bytes = ff_pack_record(pack, FF_SECTION_REFINEMENT, key, &payload);
    assert_true(bytes > 0);
    assert_int_equal(ff_decode_refinement(dec, payload, (size_t)bytes, &residuals), FF_OK);
    assert_int_equal(ff_reconstruct_refinement(info, heights, &residuals, refined, codec_room),
                     FF_OK);
    for (uint32_t q = 0; q < 4; q++) {
        ff_refined_child(info, refined, q, child);
        walk(pack, dec, ff_key_child(key, q), child, nodes);
    }
}

static void whole_ground_comes_back(void **state)
{
    const fixture *f = *state;
    static int32_t value[FF_REFINED_HEIGHTS_MAX];
    ff_residuals residuals = { .value = value };
    uint16_t root[FF_NODE_HEIGHTS_MAX];
    const uint8_t *payload;
    uint64_t bad = 99;
    uint32_t nodes = 0;
    ff_pack pack;

    assert_int_equal(ff_pack_open(&pack, f->bytes, f->count), FF_OK);
    assert_int_equal(ff_pack_verify(&pack, &bad), FF_OK);
    assert_int_equal(bad, 0);
    size_t memory_bytes = ff_decoder_bytes(&pack.header.info);
    void *memory = malloc(memory_bytes);
    ff_decoder *dec = ff_decoder_create(&pack.header.info, memory, memory_bytes);
    for (uint32_t tile = 0; tile < 2; tile++) {
        int bytes = ff_pack_record(&pack, FF_SECTION_ROOT, ff_key_make(tile, 0, 0), &payload);
        assert_true(bytes > 0);
        assert_int_equal(ff_decode_root(dec, payload, (size_t)bytes, &residuals), FF_OK);
        assert_int_equal(ff_reconstruct_root(&pack.header.info, &residuals, root, codec_room),
                         FF_OK);
        walk(&pack, dec, ff_key_make(tile, 0, 0), root, &nodes);
    }
    assert_int_equal(nodes, 2 * (1 + 4 + 16));
    free(memory);
}

static void keys_without_record_are_not_found(void **state)
{
    const fixture *f = *state;
    const uint8_t *payload;
    ff_pack pack;

    assert_int_equal(ff_pack_open(&pack, f->bytes, f->count), FF_OK);
    assert_int_equal(ff_pack_record(&pack, FF_SECTION_ROOT, ff_key_make(2, 0, 0), &payload),
                     FF_ERR_NOT_FOUND);
    assert_int_equal(ff_pack_record(&pack, FF_SECTION_ROOT, ff_key_make(0, 1, 0), &payload),
                     FF_ERR_NOT_FOUND);
    assert_int_equal(ff_pack_record(&pack, FF_SECTION_REFINEMENT, ff_key_make(0, 2, 0), &payload),
                     FF_ERR_NOT_FOUND);
    assert_int_equal(ff_pack_record(&pack, FF_SECTION_REFINEMENT, ff_key_make(0, 1, 4), &payload),
                     FF_ERR_NOT_FOUND);
    assert_int_equal(ff_pack_record(&pack, FF_SECTION_TEXTURE, ff_key_make(0, 0, 0), &payload),
                     FF_ERR_NOT_FOUND);
    assert_int_equal(ff_pack_record(&pack, FF_SECTION_ROOT, FF_KEY_NONE, &payload),
                     FF_ERR_NOT_FOUND);
}

/* Same terrain, same sizes, other heights: a cache of one pack must not serve the other. */
static void checksum_tells_packs_apart(void **state)
{
    const fixture *f = *state;
    fixture same = make_small(pack_fixture_hills), other = make_small(other_hills);
    ff_pack pack, same_pack, other_pack;

    assert_int_equal(other.count, f->count);
    assert_int_equal(ff_pack_open(&pack, f->bytes, f->count), FF_OK);
    assert_int_equal(ff_pack_open(&same_pack, same.bytes, same.count), FF_OK);
    assert_int_equal(ff_pack_open(&other_pack, other.bytes, other.count), FF_OK);
    assert_int_equal(pack.header.info.checksum, same_pack.header.info.checksum);
    assert_int_not_equal(pack.header.info.checksum, other_pack.header.info.checksum);
    assert_int_not_equal(pack.header.info.checksum, 0);
    free(same.bytes);
    free(other.bytes);
}

/* ---- damage ---- */

static void every_truncation_is_noticed(void **state)
{
    fixture *f = *state;

    for (size_t count = 0; count < f->count;
         count += count < 16 || f->count - count < 64 ? 1 : 13) {
        uint8_t *exact = malloc(count > 0 ? count : 1);
        ff_pack pack;
        memcpy(exact, f->bytes, count);
        assert_int_equal(ff_pack_open(&pack, exact, count), FF_ERR_TRUNCATED);
        free(exact);
    }
}

static void every_flipped_header_bit_is_noticed(void **state)
{
    fixture *f = *state;

    for (size_t bit = 0; bit < 8 * FF_PACK_HEADER_BYTES; bit++) {
        f->bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
        int rc = open_rc(f), expected = bit < 64   ? FF_ERR_FORMAT
                                        : bit < 96 ? FF_ERR_VERSION
                                                   : FF_ERR_CHECKSUM;
        assert_int_equal(rc, expected);
        f->bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
    }
    assert_int_equal(open_rc(f), FF_OK);
}

static void every_flipped_body_bit_is_found_by_verify(void **state)
{
    fixture *f = *state;
    ff_pack pack;

    assert_int_equal(ff_pack_open(&pack, f->bytes, f->count), FF_OK);
    for (size_t bit = 8 * FF_PACK_HEADER_BYTES; bit < 8 * f->count; bit += 3) {
        uint64_t bad;
        f->bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
        assert_int_equal(ff_pack_verify(&pack, &bad), FF_ERR_CHECKSUM);
        f->bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
    }
}

static void damaged_records_are_counted_and_refused(void **state)
{
    fixture *f = *state;
    const uint8_t *payload;
    uint64_t bad;
    ff_pack pack;

    assert_int_equal(ff_pack_open(&pack, f->bytes, f->count), FF_OK);
    const ff_pack_section *roots = &pack.header.section[0];
    f->bytes[roots->data_offset + 6] ^= 1;
    assert_int_equal(ff_pack_record(&pack, FF_SECTION_ROOT, ff_key_make(0, 0, 0), &payload),
                     FF_ERR_CHECKSUM);
    assert_true(ff_pack_record(&pack, FF_SECTION_ROOT, ff_key_make(1, 0, 0), &payload) > 0);
    assert_int_equal(ff_pack_verify(&pack, &bad), FF_ERR_CHECKSUM);
    assert_int_equal(bad, 1);
}

/* The records are sound, but the header was made for others. */
static void exchanged_records_are_found_by_verify(void **state)
{
    fixture *f = *state;
    uint64_t bad;
    ff_pack pack;

    assert_int_equal(ff_pack_open(&pack, f->bytes, f->count), FF_OK);
    pack.header.section[1].data_crc ^= 1;
    assert_int_equal(ff_pack_verify(&pack, &bad), FF_ERR_CHECKSUM);
    assert_int_equal(bad, 0);
}

/* A rank, a length or an offset that leads out of the section is noticed, whatever stands there. */
static void wild_indexes_are_out_of_range(void **state)
{
    static const uint64_t offsets[] = { UINT64_MAX, UINT64_MAX - 40, (uint64_t)1 << 40, 1 << 20 };
    fixture *f = *state;
    const uint8_t *payload;
    ff_pack pack;

    assert_int_equal(ff_pack_open(&pack, f->bytes, f->count), FF_OK);
    uint8_t *roots = f->bytes + pack.header.section[0].index_offset,
            *presence = f->bytes + pack.header.section[1].index_offset;
    for (unsigned i = 0; i < sizeof(offsets) / sizeof(offsets[0]); i++) {
        put(roots, offsets[i], 8);
        assert_int_equal(ff_pack_record(&pack, FF_SECTION_ROOT, ff_key_make(1, 0, 0), &payload),
                         FF_ERR_RANGE);
    }
    put(roots, 0, 8);
    put(roots + 8, 0, 8); /* lengths */
    assert_int_equal(ff_pack_record(&pack, FF_SECTION_ROOT, ff_key_make(0, 0, 0), &payload),
                     FF_ERR_RANGE);
    put(presence, 3, 4); /* records before */
    assert_int_equal(ff_pack_record(&pack, FF_SECTION_REFINEMENT, ff_key_make(0, 0, 0), &payload),
                     FF_ERR_RANGE);
    memset(presence, 0, FF_INDEX_PRESENCE_BYTES);
    assert_int_equal(ff_pack_record(&pack, FF_SECTION_REFINEMENT, ff_key_make(0, 0, 0), &payload),
                     FF_ERR_NOT_FOUND);
}

#define SECTION_AT(number, field) (84 + 48 * (number) + (field))

/* Headers with a right checksum that lie: the section table's fields hold what a hostile writer
 * would like. */
static void lying_section_tables_are_refused(void **state)
{
    static const struct {
        unsigned at, bytes;
        uint64_t value;
        int expected;
    } lies[] = {
        { 80, 4, 0, FF_ERR_RANGE },
        { 80, 4, 2, FF_ERR_RANGE },
        { 80, 4, 81, FF_ERR_RANGE },
        { 80, 4, UINT32_MAX, FF_ERR_RANGE },
        { SECTION_AT(0, 0), 4, FF_SECTION_TEXTURE, FF_ERR_RANGE },
        { SECTION_AT(0, 5), 1, FF_CODEC_RICE, FF_ERR_RANGE }, /* not the terrain's */
        { SECTION_AT(1, 6), 1, 1, FF_ERR_RANGE },
        { SECTION_AT(1, 7), 1, 0, FF_ERR_RANGE },  /* heights are needed */
        { SECTION_AT(0, 16), 4, 1, FF_ERR_RANGE }, /* every tile has a root */
        { SECTION_AT(1, 16), 4, 3, FF_ERR_RANGE },
        { SECTION_AT(1, 16), 4, UINT32_MAX, FF_ERR_RANGE },
        { SECTION_AT(2, 16), 4, 9, FF_ERR_RANGE },
        { SECTION_AT(1, 16), 4, 0, FF_ERR_RANGE }, /* lengths of nothing */
        { SECTION_AT(1, 20), 1, 0, FF_ERR_RANGE },
        { SECTION_AT(1, 20), 1, 19, FF_ERR_RANGE },
        { SECTION_AT(0, 24), 8, 0, FF_ERR_TRUNCATED },
        { SECTION_AT(0, 24), 8, UINT64_MAX - 8, FF_ERR_TRUNCATED },
        { SECTION_AT(0, 32), 8, UINT64_MAX, FF_ERR_TRUNCATED },
        { SECTION_AT(0, 32), 8, 100, FF_ERR_TRUNCATED },
        { SECTION_AT(2, 40), 8, UINT64_MAX, FF_ERR_TRUNCATED },
        { SECTION_AT(3, 6), 1, 1, FF_ERR_RANGE }, /* what it says of itself has no levels */
        { SECTION_AT(3, 7), 1, FF_PACK_NEEDED, FF_ERR_RANGE },
        { SECTION_AT(3, 16), 4, 1, FF_ERR_RANGE }, /* nor records */
        { SECTION_AT(3, 20), 1, 5, FF_ERR_RANGE },
        { SECTION_AT(3, 32), 8, 0, FF_ERR_TRUNCATED },
        { SECTION_AT(3, 40), 8, UINT64_MAX, FF_ERR_RANGE },
        { SECTION_AT(3, 40), 8, 4000, FF_ERR_TRUNCATED },
        { 12, 1, 9, FF_ERR_RANGE },
        { 24, 4, 0, FF_ERR_RANGE },
        { 24, 4, UINT32_MAX, FF_ERR_RANGE },
        { 24, 4, 3, FF_ERR_RANGE },
    };
    fixture *f = *state;
    uint8_t keep[FF_PACK_HEADER_BYTES];

    memcpy(keep, f->bytes, sizeof(keep));
    for (unsigned i = 0; i < sizeof(lies) / sizeof(lies[0]); i++) {
        put(f->bytes + lies[i].at, lies[i].value, lies[i].bytes);
        reseal(f);
        assert_int_equal(open_rc(f), lies[i].expected);
        memcpy(f->bytes, keep, sizeof(keep));
    }
    assert_int_equal(open_rc(f), FF_OK);
}

static void bad_headers_are_not_written(void **state)
{
    const fixture *f = *state;
    uint8_t out[FF_PACK_HEADER_BYTES];
    ff_pack pack;

    assert_int_equal(ff_pack_open(&pack, f->bytes, f->count), FF_OK);
    ff_pack_header header = pack.header;
    header.info.checksum = 12345; /* the writer computes the checksum anew */
    assert_int_equal(ff_pack_header_encode(&header, out), FF_OK);
    assert_memory_equal(out, f->bytes, sizeof(out));
    header.section[1].level = 7;
    assert_int_equal(ff_pack_header_encode(&header, out), FF_ERR_RANGE);
    header = pack.header;
    header.about.index.records = 1;
    assert_int_equal(ff_pack_header_encode(&header, out), FF_ERR_RANGE);
    header = pack.header;
    header.section_count--;
    assert_int_equal(ff_pack_header_encode(&header, out), FF_ERR_RANGE);
    header = pack.header;
    header.info.node_log2 = 0;
    assert_int_equal(ff_pack_header_encode(&header, out), FF_ERR_RANGE);
}

/* Offsets beyond 32 bits, without a file of that size: the reader looks at nothing but the header
 * when it opens. */
static void large_packs_are_measured_in_64_bits(void **state)
{
    const fixture *f = *state;
    uint8_t header_bytes[FF_PACK_HEADER_BYTES];
    ff_pack pack, large;

    assert_int_equal(ff_pack_open(&pack, f->bytes, f->count), FF_OK);
    ff_pack_header header = pack.header;
    header.section[2].data_offset = (uint64_t)1 << 40;
    header.section[2].data_bytes = (uint64_t)1 << 33;
    assert_int_equal(ff_pack_header_encode(&header, header_bytes), FF_OK);
    assert_int_equal(ff_pack_open(&large, header_bytes, ((uint64_t)1 << 40) + ((uint64_t)1 << 33)),
                     FF_OK);
    assert_true(large.header.section[2].data_offset == (uint64_t)1 << 40);
    assert_int_equal(
        ff_pack_open(&large, header_bytes, ((uint64_t)1 << 40) + ((uint64_t)1 << 33) - 1),
        FF_ERR_TRUNCATED);
}

/* ---- formats grow ---- */

#define SECTION_BYTES 48

/* Puts a section of other letters into the list at `place`. */
static void insert_section(fixture *f, unsigned place, const char *letters, unsigned version,
                           unsigned codec, unsigned flags)
{
    uint8_t *count = f->bytes + 80, *at = f->bytes + SECTION_AT(place, 0);
    memmove(at + SECTION_BYTES, at, (size_t)(*count - place) * SECTION_BYTES);
    memset(at, 0xff, SECTION_BYTES); /* a place that this reader must not look for */
    memcpy(at, letters, 4);
    at[4] = (uint8_t)version;
    at[5] = (uint8_t)codec;
    at[7] = (uint8_t)flags;
    ++*count;
    reseal(f);
}

static void unknown_sections_are_passed_over_wherever_they_stand(void **state)
{
    fixture *f = *state;
    const uint8_t *payload;
    ff_list about;
    uint64_t bad;
    ff_pack pack;

    for (unsigned place = 0; place <= 4; place++) insert_section(f, 2 * place, "MARK", 1, 0, 0xfe);
    assert_int_equal(ff_pack_open(&pack, f->bytes, f->count), FF_OK);
    assert_int_equal(pack.header.section_count, 3);
    assert_int_equal(ff_pack_verify(&pack, &bad), FF_OK);
    assert_true(ff_pack_record(&pack, FF_SECTION_ROOT, ff_key_make(1, 0, 0), &payload) > 0);
    assert_int_equal(ff_pack_about(&pack, &about), FF_OK);
    assert_int_equal(about.byte_count, 15);
}

/* SPEC.md: reserved bits and bytes are not looked at. */
static void reserved_bits_are_not_looked_at(void **state)
{
    fixture *f = *state;
    const uint8_t *payload;
    ff_list about;
    ff_pack pack;

    for (unsigned number = 0; number < 4; number++) {
        f->bytes[SECTION_AT(number, 7)] |= 0xfe;
        memset(f->bytes + SECTION_AT(number, 21), 0xff, 3);
    }
    memset(f->bytes + SECTION_AT(4, 0), 0xff, 4000 - SECTION_AT(4, 0));
    reseal(f);
    assert_int_equal(ff_pack_open(&pack, f->bytes, f->count), FF_OK);
    assert_true(ff_pack_record(&pack, FF_SECTION_ROOT, ff_key_make(1, 0, 0), &payload) > 0);
    assert_int_equal(ff_pack_about(&pack, &about), FF_OK);
}

/* What a pack says of itself may be in a form that this reader does not know. */
static void an_unknown_form_of_what_is_not_needed_is_passed_over(void **state)
{
    fixture *f = *state;
    ff_list about;
    ff_pack pack;

    f->bytes[SECTION_AT(3, 4)] = 2;
    reseal(f);
    assert_int_equal(ff_pack_open(&pack, f->bytes, f->count), FF_OK);
    assert_int_equal(ff_pack_about(&pack, &about), FF_ERR_NOT_FOUND);
}

static void unknown_sections_that_are_needed_are_refused_by_name(void **state)
{
    static const struct {
        const char *letters;
        unsigned version, codec;
        const char *said;
    } row[] = {
        { "MARK", 1, 0,
          "it needs section MARK version 1 codec 0, which this program does not know" },
        { "ROOT", 2, 0,
          "it needs section ROOT version 2 codec 0, which this program does not know" },
        { "REFI", 1, 200,
          "it needs section REFI version 1 codec 200, which this program does not know" },
        { "IMAG", 1, 8,
          "it needs section IMAG version 1 codec 8, which this program does not know" },
        { "\033[2J", 255, 255,
          "it needs section ???J version 255 codec 255, which this program does not know" },
    };
    fixture *f = *state;
    uint8_t keep[FF_PACK_HEADER_BYTES];
    ff_pack pack;

    memcpy(keep, f->bytes, sizeof(keep));
    for (unsigned i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
        insert_section(f, i % 5, row[i].letters, row[i].version, row[i].codec, FF_PACK_NEEDED);
        int rc = ff_pack_open(&pack, f->bytes, f->count);
        assert_int_equal(rc, FF_ERR_UNSUPPORTED);
        assert_string_equal(ff_pack_error_text(&pack, rc), row[i].said);
        memcpy(f->bytes, keep, sizeof(keep));
    }
}

static void older_packs_are_refused_with_the_command_that_bakes_them(void **state)
{
    fixture *f = *state;
    ff_pack pack;

    f->bytes[8] = 5;
    int rc = ff_pack_open(&pack, f->bytes, f->count);
    assert_int_equal(rc, FF_ERR_VERSION);
    assert_string_equal(ff_pack_error_text(&pack, rc),
                        "a pack of version 5, this program reads 9: bake it again: farfield-bake "
                        "HEIGHTS -o OUT.ffp");
    memset(f->bytes + 8, 0xff, 4);
    rc = ff_pack_open(&pack, f->bytes, f->count);
    assert_string_equal(ff_pack_error_text(&pack, rc),
                        "a pack of version 4294967295, this program reads 9: it needs a newer "
                        "Farfield");
    assert_string_equal(ff_pack_error_text(&pack, FF_ERR_MEMORY), ff_error_text(FF_ERR_MEMORY));
}

static void what_a_pack_says_of_itself_comes_back_or_is_known_to_be_damaged(void **state)
{
    fixture *f = *state;
    const uint8_t *name;
    ff_list about;
    uint64_t bad;
    ff_pack pack;

    assert_int_equal(ff_pack_open(&pack, f->bytes, f->count), FF_OK);
    assert_int_equal(ff_pack_about(&pack, &about), FF_OK);
    assert_int_equal(ff_list_find(about, FF_ABOUT_NAME, &name), 5);
    assert_memory_equal(name, "Hills", 5);
    f->bytes[f->count - 1] ^= 1;
    assert_int_equal(ff_pack_about(&pack, &about), FF_ERR_CHECKSUM);
    assert_int_equal(ff_pack_verify(&pack, &bad), FF_ERR_CHECKSUM);
    assert_int_equal(bad, 1);
    insert_section(f, 4, "ABOU", 1, 0, 0);
    assert_int_equal(open_rc(f), FF_ERR_RANGE);
}

static void the_second_reader_finds_the_same_bytes(void **state)
{
    static const char *const letters[] = { "ROOT", "REFI", "REFI" };
    fixture *f = *state;
    const uint8_t *mine, *other;
    ff_list about;
    ff_pack pack;

    insert_section(f, 1, "MARK", 1, 0, 0);
    assert_int_equal(ff_pack_open(&pack, f->bytes, f->count), FF_OK);
    for (uint32_t s = 0; s < 3; s++) {
        uint32_t level = pack.header.section[s].level, per_tile = 1u << 2 * level;
        for (uint32_t i = 0; i < 2 * per_tile; i++) {
            int bytes = ff_pack_record(&pack, (enum ff_section_kind)pack.header.section[s].kind,
                                       ff_key_make(i / per_tile, level, i % per_tile), &mine);
            assert_int_equal(slow_pack_record(f->bytes, f->count, letters[s], level, i / per_tile,
                                              i % per_tile, &other),
                             bytes);
            assert_ptr_equal(mine, other);
        }
    }
    assert_int_equal(ff_pack_about(&pack, &about), FF_OK);
    assert_int_equal(slow_pack_record(f->bytes, f->count, "ABOU", 0, 0, 0, &other),
                     about.byte_count);
    assert_ptr_equal(other, about.bytes);
    assert_int_equal(slow_list_find(other, about.byte_count, 2, &other), 6);
    assert_memory_equal(other, "nobody", 6);
    insert_section(f, 1, "MARK", 1, 0, FF_PACK_NEEDED);
    assert_int_equal(slow_pack_record(f->bytes, f->count, "ROOT", 0, 0, 0, &other), -1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(crc_is_the_usual_one),
        cmocka_unit_test_setup_teardown(whole_ground_comes_back, make, drop),
        cmocka_unit_test_setup_teardown(keys_without_record_are_not_found, make, drop),
        cmocka_unit_test_setup_teardown(checksum_tells_packs_apart, make, drop),
        cmocka_unit_test_setup_teardown(every_truncation_is_noticed, make, drop),
        cmocka_unit_test_setup_teardown(every_flipped_header_bit_is_noticed, make, drop),
        cmocka_unit_test_setup_teardown(every_flipped_body_bit_is_found_by_verify, make, drop),
        cmocka_unit_test_setup_teardown(damaged_records_are_counted_and_refused, make, drop),
        cmocka_unit_test_setup_teardown(exchanged_records_are_found_by_verify, make, drop),
        cmocka_unit_test_setup_teardown(wild_indexes_are_out_of_range, make, drop),
        cmocka_unit_test_setup_teardown(lying_section_tables_are_refused, make, drop),
        cmocka_unit_test_setup_teardown(bad_headers_are_not_written, make, drop),
        cmocka_unit_test_setup_teardown(unknown_sections_are_passed_over_wherever_they_stand, make,
                                        drop),
        cmocka_unit_test_setup_teardown(reserved_bits_are_not_looked_at, make, drop),
        cmocka_unit_test_setup_teardown(an_unknown_form_of_what_is_not_needed_is_passed_over, make,
                                        drop),
        cmocka_unit_test_setup_teardown(unknown_sections_that_are_needed_are_refused_by_name, make,
                                        drop),
        cmocka_unit_test_setup_teardown(older_packs_are_refused_with_the_command_that_bakes_them,
                                        make, drop),
        cmocka_unit_test_setup_teardown(
            what_a_pack_says_of_itself_comes_back_or_is_known_to_be_damaged, make, drop),
        cmocka_unit_test_setup_teardown(the_second_reader_finds_the_same_bytes, make, drop),
        cmocka_unit_test_setup_teardown(large_packs_are_measured_in_64_bits, make, drop),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
