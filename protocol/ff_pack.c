/* Pack reader, and the header's encoder. Everything read here may be damaged or hostile: sizes are
 * compared as quotients or differences that cannot overflow, and a record is looked at only after
 * its place was checked. */
#include "ff_pack.h"

#include "ff_assert.h"
#include "ff_bytes.h"
#include "shape/ff_shape.h"

#include <limits.h>
#include <string.h>

static const uint8_t magic[8] = { 0x89, 'F', 'F', 'P', '\r', '\n', 0x1a, '\n' };

/* info.checksum is the last field of the terrain. */
#define CHECKSUM_AT      (8 + 4 + FF_TERRAIN_BYTES - 4)
#define HEADER_CRC_AT    (FF_PACK_HEADER_BYTES - 4)
#define RECORD_CRC_BYTES 4
#define COUNT_AT         (CHECKSUM_AT + 4)
#define SECTION_BYTES    (4 + 4 + 4 + 4 + 4 * 8)
#define SECTION_VERSION  1 /* of all layouts so far */

FF_STATIC_ASSERT(COUNT_AT + 4 + FF_PACK_LISTED_MAX * SECTION_BYTES <= HEADER_CRC_AT);
FF_STATIC_ASSERT(FF_PACK_SECTIONS_MAX < FF_PACK_LISTED_MAX);
/* An index of any section, one entry longer than its records, is counted in 64 bits. */
FF_STATIC_ASSERT((uint64_t)FF_KEY_TILES_MAX << (2 * FF_KEY_LEVEL_MAX) < UINT64_MAX / 8);

static uint64_t load(const uint8_t *bytes, unsigned count)
{
    ff_reader in = { bytes, bytes + count, FF_OK };

    return ff_read_bytes(&in, count);
}

/* ---- header ---- */

static uint64_t records_expected(const ff_terrain_info *info, uint32_t level)
{
    FF_ASSERT(level <= FF_KEY_LEVEL_MAX);
    return (uint64_t)ff_shape_tiles(info) << (2 * level);
}

static int inside(uint64_t offset, uint64_t bytes, uint64_t size)
{
    return offset >= FF_PACK_HEADER_BYTES && offset <= size && bytes <= size - offset;
}

static uint32_t levels_of(const ff_terrain_info *info, enum ff_kind kind)
{
    switch (kind) {
#define X(kind, name, asked_by, what, asks, answered_by, brings, section, levels, ...) \
    case FF_KIND_##kind: return levels;
        FF_KIND_LIST(X)
#undef X
        case FF_KIND_COUNT: break;
    }
    return 0;
}

/* Sections come in one order only: kind after kind, each by level, with none missing and none
 * twice. */
int ff_pack_section_at(const ff_terrain_info *info, uint32_t number, ff_pack_section *section)
{
    for (unsigned kind = 0; kind < FF_KIND_COUNT; kind++) {
        uint32_t levels = levels_of(info, (enum ff_kind)kind);
        if (number < levels) {
            int heights = ff_kind[kind].data == FF_DATA_HEIGHTS;
            section->kind = ff_kind[kind].section;
            section->version = SECTION_VERSION;
            section->codec = heights ? info->codec : 0;
            section->level = (uint8_t)number;
            section->flags = FF_PACK_NEEDED;
            return 1;
        }
        number -= levels;
    }
    return 0;
}

ff_pack_section ff_pack_about_section(void)
{
    return (
        ff_pack_section){ .kind = FF_PACK_ABOUT, .version = SECTION_VERSION, .record_count = 1 };
}

static int same_sort(const ff_pack_section *a, const ff_pack_section *b)
{
    return a->kind == b->kind && a->version == b->version && a->codec == b->codec &&
           a->level == b->level && a->flags == b->flags && a->record_count == b->record_count;
}

static int check_sections(const ff_pack_header *header)
{
    const ff_terrain_info *info = &header->info;
    ff_pack_section expected;

    for (uint32_t i = 0; i < header->section_count; i++) {
        if (!ff_pack_section_at(info, i, &expected)) return FF_ERR_RANGE;
        expected.record_count = records_expected(info, expected.level);
        if (!same_sort(&header->section[i], &expected)) return FF_ERR_RANGE;
    }
    expected = ff_pack_about_section();
    if (header->about.kind && !same_sort(&header->about, &expected)) return FF_ERR_RANGE;
    return ff_pack_section_at(info, header->section_count, &expected) ? FF_ERR_RANGE : FF_OK;
}

static void read_section(ff_reader *in, ff_pack_section *section)
{
    section->kind = (uint32_t)ff_read_bytes(in, 4);
    section->version = (uint8_t)ff_read_bytes(in, 1);
    section->codec = (uint8_t)ff_read_bytes(in, 1);
    section->level = (uint8_t)ff_read_bytes(in, 1);
    section->flags = (uint8_t)ff_read_bytes(in, 1);
    section->index_crc = (uint32_t)ff_read_bytes(in, 4);
    section->records_crc = (uint32_t)ff_read_bytes(in, 4);
    section->record_count = ff_read_bytes(in, 8);
    section->index_offset = ff_read_bytes(in, 8);
    section->data_offset = ff_read_bytes(in, 8);
    section->data_bytes = ff_read_bytes(in, 8);
}

static void write_section(ff_writer *out, const ff_pack_section *section)
{
    ff_write_bytes(out, section->kind, 4);
    ff_write_bytes(out, section->version, 1);
    ff_write_bytes(out, section->codec, 1);
    ff_write_bytes(out, section->level, 1);
    ff_write_bytes(out, section->flags, 1);
    ff_write_bytes(out, section->index_crc, 4);
    ff_write_bytes(out, section->records_crc, 4);
    ff_write_bytes(out, section->record_count, 8);
    ff_write_bytes(out, section->index_offset, 8);
    ff_write_bytes(out, section->data_offset, 8);
    ff_write_bytes(out, section->data_bytes, 8);
}

int ff_pack_header_encode(const ff_pack_header *header, uint8_t *out)
{
    ff_writer writer = { out, out + HEADER_CRC_AT, FF_OK };
    uint32_t checksum, has_about = header->about.kind != 0;

    if (ff_terrain_check(&header->info) != FF_OK || check_sections(header) != FF_OK)
        return FF_ERR_RANGE;
    FF_ASSERT(header->section_count <= FF_PACK_SECTIONS_MAX);
    memset(out, 0, FF_PACK_HEADER_BYTES);
    ff_write_span(&writer, magic, sizeof(magic));
    ff_write_bytes(&writer, FF_PACK_VERSION, 4);
    ff_write_terrain(&writer, &header->info);
    ff_write_bytes(&writer, header->section_count + has_about, 4);
    for (uint32_t i = 0; i < header->section_count; i++)
        write_section(&writer, &header->section[i]);
    if (has_about) write_section(&writer, &header->about);
    FF_ASSERT(writer.error == FF_OK &&
              writer.at - out ==
                  COUNT_AT + 4 + (ptrdiff_t)(header->section_count + has_about) * SECTION_BYTES);
    memset(out + CHECKSUM_AT, 0, 4);
    checksum = ff_crc32(0, out, HEADER_CRC_AT);
    writer.at = out + CHECKSUM_AT;
    ff_write_bytes(&writer, checksum, 4);
    checksum = ff_crc32(0, out, HEADER_CRC_AT);
    writer.at = out + HEADER_CRC_AT;
    writer.end = out + FF_PACK_HEADER_BYTES;
    ff_write_bytes(&writer, checksum, 4);
    return writer.error;
}

/* ---- refusals in words ---- */

/* the longest of them, with its numbers */
FF_STATIC_ASSERT(sizeof((ff_pack *)0)->refusal > 110);

static char *put_text(char *at, const char *text)
{
    while (*text) *at++ = *text++;
    return at;
}

static char *put_number(char *at, uint32_t number)
{
    uint32_t unit = 1;
    while (number / unit > 9) unit *= 10;
    for (; unit; unit /= 10) *at++ = (char)('0' + number / unit % 10);
    return at;
}

static int refuse_version(ff_pack *pack, uint32_t version)
{
    static const char older[] = ": bake it again: farfield-bake HEIGHTS -o OUT.ffp",
                      newer[] = ": it needs a newer Farfield";
    char *at = put_text(pack->refusal, "a pack of version ");
    at = put_text(put_number(at, version), ", this program reads ");
    at = put_text(put_number(at, FF_PACK_VERSION), version < FF_PACK_VERSION ? older : newer);
    *at = 0;
    return FF_ERR_VERSION;
}

static int refuse_section(ff_pack *pack, const ff_pack_section *section)
{
    char *at = put_text(pack->refusal, "it needs section ");
    for (unsigned i = 0; i < 4; i++) {
        unsigned letter = section->kind >> 8 * i & 0xffu;
        *at++ = (letter | 32) >= 'a' && (letter | 32) <= 'z' ? (char)letter : '?';
    }
    at = put_number(put_text(at, " version "), section->version);
    at = put_number(put_text(at, " codec "), section->codec);
    *put_text(at, ", which this program does not know") = 0;
    return FF_ERR_UNSUPPORTED;
}

const char *ff_pack_error_text(const ff_pack *pack, int error)
{
    int said = pack->refusal[0] && (error == FF_ERR_VERSION || error == FF_ERR_UNSUPPORTED);
    return said ? pack->refusal : ff_error_text(error);
}

/* ---- reading the header ---- */

static int is_known(const ff_pack_section *section)
{
    if (section->version != SECTION_VERSION) return 0;
    if (section->kind == FF_PACK_ABOUT) return section->codec == 0;
    for (unsigned kind = 0; kind < FF_KIND_COUNT; kind++)
        if (ff_kind[kind].section == section->kind && section->kind)
            return ff_kind[kind].data == FF_DATA_HEIGHTS ? ff_codec_name(section->codec) != NULL
                                                         : section->codec == 0;
    return 0;
}

/* Those that are not known are looked at no further. */
static int take_section(ff_pack *pack, const ff_pack_section *section)
{
    ff_pack_header *header = &pack->header;

    if (!is_known(section))
        return section->flags & FF_PACK_NEEDED ? refuse_section(pack, section) : FF_OK;
    if (section->kind == FF_PACK_ABOUT) {
        if (header->about.kind) return FF_ERR_RANGE;
        header->about = *section;
        return FF_OK;
    }
    if (header->section_count == FF_PACK_SECTIONS_MAX) return FF_ERR_RANGE;
    header->section[header->section_count++] = *section;
    return FF_OK;
}

/* Sections come first: a pack that is not for this reader is refused by their names, not by a
 * number in its terrain. */
static int read_header(ff_pack *pack, const uint8_t *bytes)
{
    ff_reader in = { bytes + sizeof(magic) + 4, bytes + COUNT_AT, FF_OK },
              list = { bytes + COUNT_AT, bytes + HEADER_CRC_AT, FF_OK };
    uint32_t count = (uint32_t)ff_read_bytes(&list, 4);
    ff_pack_section section;
    int rc = count > FF_PACK_LISTED_MAX ? FF_ERR_RANGE : FF_OK;

    for (uint32_t i = 0; rc == FF_OK && i < count; i++) {
        read_section(&list, &section);
        FF_ASSERT(list.error == FF_OK);
        rc = take_section(pack, &section);
    }
    if (rc != FF_OK) return rc;
    ff_read_terrain(&in, &pack->header.info);
    FF_ASSERT(in.at == in.end);
    return in.error != FF_OK ? in.error : check_sections(&pack->header);
}

static int check_place(const ff_pack_section *section, uint64_t size)
{
    FF_ASSERT(section->record_count < UINT64_MAX / 8);
    return inside(section->index_offset, (section->record_count + 1) * 8, size) &&
                   inside(section->data_offset, section->data_bytes, size)
               ? FF_OK
               : FF_ERR_TRUNCATED;
}

int ff_pack_open(ff_pack *pack, const void *bytes, uint64_t size)
{
    const uint8_t *file = bytes;
    int rc;

    memset(pack, 0, sizeof(*pack));
    if (size == 0) /* an empty file maps to no address at all */
        return FF_ERR_TRUNCATED;
    if (size < sizeof(magic) || memcmp(file, magic, sizeof(magic)) != 0)
        return size < sizeof(magic) && memcmp(file, magic, (size_t)size) == 0 ? FF_ERR_TRUNCATED
                                                                              : FF_ERR_FORMAT;
    if (size < FF_PACK_HEADER_BYTES) return FF_ERR_TRUNCATED;
    if (load(file + sizeof(magic), 4) != FF_PACK_VERSION)
        return refuse_version(pack, (uint32_t)load(file + sizeof(magic), 4));
    if (load(file + HEADER_CRC_AT, 4) != ff_crc32(0, file, HEADER_CRC_AT)) return FF_ERR_CHECKSUM;
    rc = read_header(pack, file);
    for (uint32_t i = 0; rc == FF_OK && i < pack->header.section_count; i++)
        rc = check_place(&pack->header.section[i], size);
    if (rc == FF_OK && pack->header.about.kind) rc = check_place(&pack->header.about, size);
    pack->bytes = bytes;
    pack->size = size;
    return rc;
}

/* ---- records ---- */

static int read_record(const ff_pack *pack, const ff_pack_section *section, uint64_t number,
                       const uint8_t **payload)
{
    const uint8_t *entry = pack->bytes + section->index_offset + 8 * number;
    const uint8_t *record;
    uint64_t first, end;

    FF_ASSERT(number < section->record_count);
    FF_ASSERT(inside(section->index_offset, (section->record_count + 1) * 8, pack->size));
    FF_ASSERT(inside(section->data_offset, section->data_bytes, pack->size));
    first = load(entry, 8);
    end = load(entry + 8, 8);
    if (first > end || end > section->data_bytes) return FF_ERR_RANGE;
    if (first == end) return FF_ERR_NOT_FOUND;
    if (end - first < RECORD_CRC_BYTES || end - first - RECORD_CRC_BYTES > INT_MAX)
        return FF_ERR_RANGE;
    record = pack->bytes + section->data_offset + first;
    FF_ASSERT(section->data_offset + end <= pack->size);
    *payload = record + RECORD_CRC_BYTES;
    if (load(record, RECORD_CRC_BYTES) !=
        ff_crc32(0, *payload, (size_t)(end - first) - RECORD_CRC_BYTES))
        return FF_ERR_CHECKSUM;
    return (int)(end - first - RECORD_CRC_BYTES);
}

int ff_pack_record(const ff_pack *pack, enum ff_section_kind kind, ff_key key,
                   const uint8_t **payload)
{
    uint32_t level = ff_key_level(key);

    FF_ASSERT(pack->header.section_count <= FF_PACK_SECTIONS_MAX);
    for (uint32_t i = 0; i < pack->header.section_count; i++) {
        const ff_pack_section *section = &pack->header.section[i];
        if (section->kind == kind && section->level == level) {
            if ((uint64_t)ff_key_code(key) >> (2 * level) != 0 ||
                ff_pack_record_number(key) >= section->record_count)
                return FF_ERR_NOT_FOUND;
            return read_record(pack, section, ff_pack_record_number(key), payload);
        }
    }
    return FF_ERR_NOT_FOUND;
}

int ff_pack_about(const ff_pack *pack, ff_list *about)
{
    const uint8_t *list;
    int bytes = pack->header.about.kind ? read_record(pack, &pack->header.about, 0, &list)
                                        : FF_ERR_NOT_FOUND;

    if (bytes < 0) return bytes;
    *about = (ff_list){ list, (uint32_t)bytes };
    return ff_about_check(*about);
}

/* The number of damaged records in one section. Clears *whole when the section's index, or the list
 * of its records' CRCs, is not what the header says. */
static uint64_t verify_section(const ff_pack *pack, const ff_pack_section *section, int *whole)
{
    const uint8_t *index = pack->bytes + section->index_offset, *payload;
    int may_have_gaps = section->kind == FF_SECTION_REFINEMENT || section->kind == FF_SECTION_TEXTURE;
    uint64_t bad = 0;
    uint32_t records_crc = 0;

    if (load(index, 8) != 0 || load(index + 8 * section->record_count, 8) != section->data_bytes ||
        ff_crc32(0, index, (size_t)(8 * (section->record_count + 1))) != section->index_crc)
        *whole = 0;
    for (uint64_t number = 0; number < section->record_count; number++) {
        int rc = read_record(pack, section, number, &payload);
        if (rc >= 0)
            records_crc = ff_crc32(records_crc, payload - RECORD_CRC_BYTES, RECORD_CRC_BYTES);
        else if (rc != FF_ERR_NOT_FOUND || !may_have_gaps)
            bad++;
    }
    FF_ASSERT(bad <= section->record_count);
    if (bad == 0 && records_crc != section->records_crc) *whole = 0;
    return bad;
}

int ff_pack_verify(const ff_pack *pack, uint64_t *bad)
{
    int whole = 1, rc = FF_OK;
    ff_list about;

    *bad = 0;
    for (uint32_t i = 0; i < pack->header.section_count; i++)
        *bad += verify_section(pack, &pack->header.section[i], &whole);
    if (pack->header.about.kind) {
        *bad += verify_section(pack, &pack->header.about, &whole);
        rc = ff_pack_about(pack, &about);
    }
    return *bad == 0 && whole ? rc : FF_ERR_CHECKSUM;
}
