/* Pack reader, and the header's encoder. Everything read here may be damaged or hostile: sizes are
 * compared as quotients or differences that cannot overflow, and a record is looked at only after
 * its place was checked. */
#include "ff_pack.h"

#include "ff_assert.h"
#include "ff_bytes.h"
#include "ff_entry.h"
#include "shape/ff_shape.h"

#include <limits.h>
#include <string.h>

static const uint8_t magic[8] = { 0x89, 'F', 'F', 'P', '\r', '\n', 0x1a, '\n' };

/* info.checksum is the last field of the terrain. */
#define CHECKSUM_AT     (8 + 4 + FF_TERRAIN_BYTES - 4)
#define HEADER_CRC_AT   (FF_PACK_HEADER_BYTES - 4)
#define COUNT_AT        (CHECKSUM_AT + 4)
#define SECTION_BYTES   (4 + 4 + 4 + 4 + 4 + 4 + 3 * 8)
#define SECTION_VERSION 1 /* of all layouts so far */

FF_STATIC_ASSERT(COUNT_AT + 4 + FF_PACK_LISTED_MAX * SECTION_BYTES <= HEADER_CRC_AT);
FF_STATIC_ASSERT(FF_PACK_SECTIONS_MAX < FF_PACK_LISTED_MAX);

static uint64_t load(const uint8_t *bytes, unsigned count)
{
    ff_reader in = { bytes, bytes + count, FF_OK };

    return ff_read_bytes(&in, count);
}

/* ---- header ---- */

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
    return (ff_pack_section){ .kind = FF_PACK_ABOUT, .version = SECTION_VERSION };
}

static int same_sort(const ff_pack_section *a, const ff_pack_section *b)
{
    return a->kind == b->kind && a->version == b->version && a->codec == b->codec &&
           a->level == b->level && a->flags == b->flags;
}

uint32_t ff_pack_layer_first(const ff_pack *pack, unsigned layer)
{
    uint32_t first = ff_terrain_levels(&pack->header.info);

    FF_ASSERT(layer <= pack->header.layers);
    for (unsigned before = 0; before < layer; before++) first += pack->header.layer_levels[before];
    return first;
}

ff_pack_section ff_pack_layer_section(unsigned layer, unsigned level)
{
    FF_ASSERT(layer >= 1 && layer < FF_LAYERS_MAX && level <= FF_KEY_LEVEL_MAX);
    return (ff_pack_section){ .kind = FF_SECTION_TEXTURE,
                              .version = SECTION_VERSION,
                              .codec = (uint8_t)layer,
                              .level = (uint8_t)level };
}

/* The section whose records are the parents of another's; NULL: there are none. */
static const ff_pack_section *section_above(const ff_pack_header *header, uint32_t number)
{
    const ff_pack_section *section = &header->section[number];
    if (section->kind == FF_SECTION_ROOT) return NULL;
    return section->level ? section - 1 : header->section;
}

/* Works out the places of a section, those above known, and checks that its records fit them. */
static int place_records(ff_pack_header *header, uint32_t number)
{
    ff_index *index = &header->section[number].index;
    const ff_pack_section *above = section_above(header, number);

    index->places = above
                        ? (uint64_t)above->index.records << (header->section[number].level ? 2 : 0)
                        : 0;
    if (above ? index->records > index->places : index->records != ff_shape_tiles(&header->info))
        return FF_ERR_RANGE;
    return (index->length_bits > 0) == (index->records > 0) &&
                   index->length_bits <= FF_INDEX_LENGTH_BITS
               ? FF_OK
               : FF_ERR_RANGE;
}

/* Behind a terrain's sections: the next level of the layer at hand, or the first one of another. 1,
 * or 0: it is neither. */
static int take_layer(ff_pack_header *header, const ff_pack_section *section)
{
    uint32_t layer = section->codec;
    if (!header->layers || layer < header->layers - 1u || layer > header->layers) return 0;
    if (layer >= FF_LAYERS_MAX || !layer) return 0;
    if (layer == header->layers) header->layer_levels[header->layers++] = 0;
    if (header->layer_levels[layer] > FF_KEY_LEVEL_MAX) return 0;
    const ff_pack_section expected = ff_pack_layer_section(layer, header->layer_levels[layer]++);
    return same_sort(section, &expected);
}

static int check_sections(ff_pack_header *header)
{
    const ff_terrain_info *info = &header->info;
    ff_pack_section expected;

    header->layers = info->texture_levels > 0;
    header->layer_levels[0] = info->texture_levels;
    for (uint32_t i = 0; i < header->section_count; i++) {
        int ok = ff_pack_section_at(info, i, &expected) ? same_sort(&header->section[i], &expected)
                                                        : take_layer(header, &header->section[i]);
        if (!ok || place_records(header, i) != FF_OK) return FF_ERR_RANGE;
    }
    expected = ff_pack_about_section();
    if (header->about.kind &&
        (!same_sort(&header->about, &expected) || header->about.index.records ||
         header->about.index.length_bits || header->about.data_bytes > FF_ABOUT_BYTES_MAX))
        return FF_ERR_RANGE;
    return ff_pack_section_at(info, header->section_count, &expected) ? FF_ERR_RANGE : FF_OK;
}

static void read_section(ff_reader *in, ff_pack_section *section)
{
    section->kind = (uint32_t)ff_read_bytes(in, 4);
    section->version = (uint8_t)ff_read_bytes(in, 1);
    section->codec = (uint8_t)ff_read_bytes(in, 1);
    section->level = (uint8_t)ff_read_bytes(in, 1);
    section->flags = (uint8_t)(ff_read_bytes(in, 1) & FF_PACK_NEEDED); /* others are reserved */
    section->index_crc = (uint32_t)ff_read_bytes(in, 4);
    section->data_crc = (uint32_t)ff_read_bytes(in, 4);
    section->index.places = 0;
    section->index.records = (uint32_t)ff_read_bytes(in, 4);
    section->index.length_bits = (uint8_t)ff_read_bytes(in, 1);
    (void)ff_read_bytes(in, 3);
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
    ff_write_bytes(out, section->data_crc, 4);
    ff_write_bytes(out, section->index.records, 4);
    ff_write_bytes(out, section->index.length_bits, 1);
    ff_write_bytes(out, 0, 3);
    ff_write_bytes(out, section->index_offset, 8);
    ff_write_bytes(out, section->data_offset, 8);
    ff_write_bytes(out, section->data_bytes, 8);
}

int ff_pack_header_encode(ff_pack_header *header, uint8_t *out)
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
    header->info.checksum = ff_crc32(0, out, HEADER_CRC_AT);
    writer.at = out + CHECKSUM_AT;
    ff_write_bytes(&writer, header->info.checksum, 4);
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
                                                         : section->codec < FF_LAYERS_MAX;
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
    return inside(section->index_offset, ff_index_bytes(&section->index), size) &&
                   inside(section->data_offset, section->data_bytes, size)
               ? FF_OK
               : FF_ERR_TRUNCATED;
}

/* `count` bytes from `offset` on: in the mapping, or read into `room`. */
static int fetch(const ff_pack *pack, uint64_t offset, size_t count, uint8_t *room,
                 const uint8_t **at)
{
    FF_ASSERT(offset <= pack->size && count <= pack->size - offset);
    *at = pack->bytes ? pack->bytes + offset : room;
    return pack->bytes ? FF_OK : pack->read(pack->context, offset, room, count);
}

/* The magic and all of the header. */
static int open_header(ff_pack *pack, const uint8_t *file)
{
    int rc;

    if (load(file + sizeof(magic), 4) != FF_PACK_VERSION)
        return refuse_version(pack, (uint32_t)load(file + sizeof(magic), 4));
    if (load(file + HEADER_CRC_AT, 4) != ff_crc32(0, file, HEADER_CRC_AT)) return FF_ERR_CHECKSUM;
    rc = read_header(pack, file);
    for (uint32_t i = 0; rc == FF_OK && i < pack->header.section_count; i++)
        rc = check_place(&pack->header.section[i], pack->size);
    if (rc == FF_OK && pack->header.about.kind) rc = check_place(&pack->header.about, pack->size);
    return rc;
}

static int open_pack(ff_pack *pack)
{
    const uint8_t *file;
    size_t begin = pack->size < sizeof(magic) ? (size_t)pack->size : sizeof(magic);
    int rc;

    if (begin == 0) /* an empty file maps to no address at all */
        return FF_ERR_TRUNCATED;
    rc = fetch(pack, 0, begin, pack->room, &file);
    if (rc != FF_OK) return rc;
    if (memcmp(file, magic, begin) != 0) return FF_ERR_FORMAT;
    if (pack->size < FF_PACK_HEADER_BYTES) return FF_ERR_TRUNCATED;
    rc = fetch(pack, 0, FF_PACK_HEADER_BYTES, pack->room, &file);
    if (rc == FF_OK) rc = open_header(pack, file);
    pack->tiles = pack->header.section[0].index.records; /* which are roots */
    return rc;
}

int ff_pack_open(ff_pack *pack, const void *bytes, uint64_t size)
{
    memset(pack, 0, sizeof(*pack));
    pack->bytes = bytes;
    pack->size = size;
    return open_pack(pack);
}

int ff_pack_open_reader(ff_pack *pack, ff_pack_read_fn *read, void *context, uint64_t size,
                        void *room, size_t room_bytes)
{
    memset(pack, 0, sizeof(*pack));
    pack->read = read;
    pack->context = context;
    pack->room = room;
    pack->room_bytes = room_bytes;
    pack->size = size;
    return room_bytes < FF_PACK_HEADER_BYTES ? FF_ERR_FULL : open_pack(pack);
}

/* ---- records ---- */

static int read_record(const ff_pack *pack, const ff_pack_section *section, uint32_t number,
                       const uint8_t **payload)
{
    const ff_index *index = &section->index;
    uint64_t offset, block_at = section->index_offset + ff_index_blocks_at(index) +
                                (uint64_t)(number / FF_INDEX_RECORDS) * ff_index_block_bytes(index);
    uint8_t room[FF_INDEX_BLOCK_MAX];
    const uint8_t *record;
    uint32_t bytes;
    int rc = fetch(pack, block_at, ff_index_block_bytes(index), room, &record);

    if (rc == FF_OK) rc = ff_index_record(index, record, number, &offset, &bytes);
    if (rc != FF_OK) return rc;
    if (offset > section->data_bytes ||
        (uint64_t)bytes + FF_RECORD_CRC_BYTES > section->data_bytes - offset)
        return FF_ERR_RANGE;
    if (!pack->bytes && bytes + FF_RECORD_CRC_BYTES > pack->room_bytes) return FF_ERR_FULL;
    rc = fetch(pack, section->data_offset + offset, FF_RECORD_CRC_BYTES + (size_t)bytes, pack->room,
               &record);
    if (rc != FF_OK) return rc;
    *payload = record + FF_RECORD_CRC_BYTES;
    return load(record, FF_RECORD_CRC_BYTES) == ff_crc16(*payload, bytes) ? (int)bytes
                                                                          : FF_ERR_CHECKSUM;
}

/* The number of the record at a place of a section. */
static int number_at(const ff_pack *pack, const ff_pack_section *section, uint64_t place,
                     uint32_t *number)
{
    uint8_t room[FF_INDEX_PRESENCE_BYTES];
    const uint8_t *block;
    int rc;

    FF_ASSERT(place < section->index.places);
    rc = fetch(pack, section->index_offset + place / FF_INDEX_PLACES * FF_INDEX_PRESENCE_BYTES,
               FF_INDEX_PRESENCE_BYTES, room, &block);
    return rc == FF_OK ? ff_index_number(&section->index, block, place, number) : rc;
}

/* The first section of a kind, and of images of a layer; they follow each other by level. NULL: the
 * pack has none. */
static const ff_pack_section *first_section(const ff_pack *pack, uint32_t kind, unsigned layer)
{
    for (uint32_t i = 0; i < pack->header.section_count; i++) {
        const ff_pack_section *section = &pack->header.section[i];
        if (section->kind == kind && (kind != FF_SECTION_TEXTURE || section->codec == layer))
            return section;
    }
    return NULL;
}

static int has_level(const ff_pack *pack, const ff_pack_section *first, uint32_t level)
{
    uint32_t number = (uint32_t)(first - pack->header.section) + level;
    return number < pack->header.section_count &&
           pack->header.section[number].kind == first->kind &&
           pack->header.section[number].codec == first->codec;
}

static int has_image(const ff_pack *pack, unsigned layer, ff_key key)
{
    ff_terrain_info info = pack->header.info;
    info.texture_levels = (uint8_t)ff_pack_image_levels(pack, layer);
    return ff_terrain_has_image(&info, key);
}

static int find_record(const ff_pack *pack, enum ff_section_kind kind, unsigned layer, ff_key key,
                       const uint8_t **payload)
{
    uint32_t level, code, number;
    const ff_pack_section *section;

    pack = ff_pack_of(pack, key);
    if (!pack) return FF_ERR_NOT_FOUND;
    if (pack->stored) {
        int pictures = pack->header.info.flags & FF_TERRAIN_PICTURES;
        if (!(kind == FF_SECTION_TEXTURE ? has_image(pack, layer, key)
                                         : ff_terrain_has_node(&pack->header.info, key)))
            return FF_ERR_NOT_FOUND;
        if (ff_key_level(key) == 0 &&
            (kind == FF_SECTION_ROOT || (kind == FF_SECTION_TEXTURE && pictures)))
            return pack->make_root(pack->root_context, kind, layer, ff_key_tile(key), payload);
        key = ff_entry_key(&pack->stored->header.info, &pack->header.info, key);
        pack = pack->stored;
    }
    level = ff_key_level(key);
    code = ff_key_code(key);
    number = ff_key_tile(key) - pack->header.info.first_tile;
    section = first_section(pack, kind, layer);
    if (!section || !has_level(pack, section, level) || (uint64_t)code >> (2 * level) != 0)
        return FF_ERR_NOT_FOUND;
    for (uint32_t l = 0; kind != FF_SECTION_ROOT && l <= level; l++) {
        uint64_t place = l ? 4 * (uint64_t)number + (code >> 2 * (level - l) & 3u) : number;
        int rc = number_at(pack, section + l, place, &number);
        if (rc != FF_OK) return rc;
    }
    return read_record(pack, section + level, number, payload);
}

int ff_pack_record(const ff_pack *pack, enum ff_section_kind kind, ff_key key,
                   const uint8_t **payload)
{
    return find_record(pack, kind, 0, key, payload);
}

int ff_pack_layer_record(const ff_pack *pack, unsigned layer, ff_key key, const uint8_t **payload)
{
    return find_record(pack, FF_SECTION_TEXTURE, layer, key, payload);
}

int ff_pack_image(const ff_pack *pack, unsigned layer, ff_key *key, const uint8_t **payload)
{
    int bytes = ff_pack_layer_record(pack, layer, *key, payload);

    while (bytes == FF_ERR_NOT_FOUND && ff_key_level(*key) > 0) {
        *key = ff_key_parent(*key);
        bytes = ff_pack_layer_record(pack, layer, *key, payload);
    }
    return bytes;
}

int ff_pack_about(const ff_pack *pack, ff_list *about)
{
    const ff_pack_section *section = &pack->header.about;
    const uint8_t *list;
    int rc;

    if (!section->kind) return FF_ERR_NOT_FOUND;
    if (!pack->bytes && section->data_bytes > pack->room_bytes) return FF_ERR_FULL;
    rc = fetch(pack, section->data_offset, (size_t)section->data_bytes, pack->room, &list);
    if (rc != FF_OK) return rc;
    if (ff_crc32(0, list, (size_t)section->data_bytes) != section->data_crc) return FF_ERR_CHECKSUM;
    *about = (ff_list){ list, (uint32_t)section->data_bytes };
    return ff_about_check(*about);
}

/* ---- verification ---- */

/* The CRC-32 of `count` bytes from `offset` on. */
static int crc_of(const ff_pack *pack, uint64_t offset, uint64_t count, uint32_t *crc)
{
    uint8_t room[1024];

    *crc = 0;
    for (uint64_t done = 0; done < count;) {
        size_t bytes = count - done < sizeof(room) ? (size_t)(count - done) : sizeof(room);
        const uint8_t *at;
        int rc = fetch(pack, offset + done, bytes, room, &at);
        if (rc != FF_OK) return rc;
        *crc = ff_crc32(*crc, at, bytes);
        done += bytes;
    }
    return FF_OK;
}

/* FF_OK when a section's index and data are those that the header is of. */
static int verify_bytes(const ff_pack *pack, const ff_pack_section *section)
{
    uint32_t crc;
    int rc = crc_of(pack, section->index_offset, ff_index_bytes(&section->index), &crc);

    if (rc == FF_OK && crc != section->index_crc) rc = FF_ERR_CHECKSUM;
    if (rc == FF_OK) rc = crc_of(pack, section->data_offset, section->data_bytes, &crc);
    return rc == FF_OK && crc != section->data_crc ? FF_ERR_CHECKSUM : rc;
}

int ff_pack_verify(const ff_pack *pack, uint64_t *bad)
{
    int rc = FF_OK, one;
    const uint8_t *payload;
    ff_list about;

    *bad = 0;
    for (uint32_t i = 0; i < pack->header.section_count; i++) {
        const ff_pack_section *section = &pack->header.section[i];
        one = verify_bytes(pack, section);
        rc = rc == FF_OK ? one : rc;
        for (uint32_t number = 0; number < section->index.records; number++)
            *bad += read_record(pack, section, number, &payload) < 0;
    }
    if (pack->header.about.kind) {
        one = ff_pack_about(pack, &about);
        rc = rc == FF_OK ? one : rc;
        *bad += one == FF_ERR_CHECKSUM;
    }
    return rc == FF_OK && *bad ? FF_ERR_CHECKSUM : rc;
}
