#include "pack_writer.h"

#include "raster/bake_grid.h"
#include "bake_leftovers.h"
#include "bake_say.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define PATH_BYTES   4096
#define COPY_BYTES   (1u << 18)
#define LENGTH_BYTES sizeof(uint32_t)

static void put_le(uint8_t *out, uint64_t value, int bytes)
{
    for (int i = 0; i < bytes; i++) out[i] = (uint8_t)(value >> (8 * i));
}

/* ---- before ---- */

static void remove_one(const char *leftover) { unlink(leftover); }

int pack_writer_prepare(const char *path)
{
    char temp[PATH_BYTES];
    struct stat status;
    if (bake_temp_name(path, temp, sizeof temp)) return -1;
    if (!stat(path, &status) && !S_ISREG(status.st_mode))
        return bake_fail("%s: not a plain file", path);
    int fd = open(temp, O_WRONLY | O_CREAT | O_EXCL, 0666);
    if (fd < 0) return bake_fail("cannot write %s: %s", path, strerror(errno));
    close(fd);
    unlink(temp);
    bake_leftovers_remove(path, remove_one);
    return 0;
}

/* ---- sections ---- */

static int open_sections(pack_writer *writer, uint32_t count)
{
    for (; count > 0; count--) {
        pack_section_file *section = &writer->section[writer->section_count++];
        section->data_fd = bake_temp_open();
        section->length_fd = section->data_fd < 0 ? -1 : bake_temp_open();
        if (section->length_fd < 0) {
            pack_writer_close(writer);
            return -1;
        }
    }
    return 0;
}

int pack_writer_open(pack_writer *writer, const ff_terrain_info *info)
{
    *writer = (pack_writer){ .info = *info, .layers = info->texture_levels > 0 };
    for (uint32_t i = 0; i < FF_PACK_SECTIONS_MAX; i++)
        writer->section[i].data_fd = writer->section[i].length_fd = -1;
    return open_sections(writer, ff_terrain_levels(info) + info->texture_levels);
}

int pack_writer_add_layer(pack_writer *writer, uint32_t levels, uint32_t *first)
{
    *first = writer->section_count;
    if (levels > FF_PACK_SECTIONS_MAX - writer->section_count)
        return bake_fail("a pack has %d levels of heights and images at most: fewer layers, or "
                         "--texture-levels",
                         FF_PACK_SECTIONS_MAX);
    writer->layer_first[writer->layers++] = *first;
    return open_sections(writer, levels);
}

int pack_writer_add_layers(pack_writer *writer, const ff_pack_header *header)
{
    uint32_t first;
    for (unsigned layer = 1; layer < header->layers; layer++)
        if (pack_writer_add_layer(writer, header->layer_levels[layer], &first)) return -1;
    return 0;
}

void pack_writer_close(pack_writer *writer)
{
    for (uint32_t i = 0; i < writer->section_count; i++) {
        if (writer->section[i].data_fd >= 0) close(writer->section[i].data_fd);
        if (writer->section[i].length_fd >= 0) close(writer->section[i].length_fd);
        writer->section[i].data_fd = writer->section[i].length_fd = -1;
    }
}

/* The lengths of those records that have a place. How many, or -1 (said). */
static int64_t take_lengths(pack_section_file *section, const bake_blob *blob,
                            const bake_blob *above, uint32_t *length)
{
    size_t each = above ? blob->record_count / above->record_count : 1;
    int64_t places = 0;
    for (size_t i = 0; i < blob->record_count; i++) {
        if (above && above->length[i / each] == 0) {
            if (blob->length[i]) return bake_fail("a record has no parent");
            continue;
        }
        length[places++] = blob->length[i];
        section->records += blob->length[i] > 0;
        if (blob->length[i] > section->length_max) section->length_max = blob->length[i];
    }
    return places;
}

/* CRC and payload of each record; bytes of all. */
static size_t put_records(const bake_blob *blob, uint8_t *out)
{
    uint8_t *at = out;
    const uint8_t *payload = blob->bytes;
    for (size_t i = 0; i < blob->record_count; i++) {
        uint32_t bytes = blob->length[i];
        if (bytes == 0) continue;
        put_le(at, ff_crc16(payload, bytes), FF_RECORD_CRC_BYTES);
        memcpy(at + FF_RECORD_CRC_BYTES, payload, bytes);
        at += FF_RECORD_CRC_BYTES + bytes;
        payload += bytes;
    }
    return (size_t)(at - out);
}

int pack_writer_add(pack_writer *writer, uint32_t number, const bake_blob *blob,
                    const bake_blob *above)
{
    pack_section_file *section = &writer->section[number];
    uint8_t *data = malloc(blob->byte_count + blob->record_count * FF_RECORD_CRC_BYTES + 1);
    uint32_t *length = malloc((blob->record_count + 1) * LENGTH_BYTES);
    int64_t places = data && length ? take_lengths(section, blob, above, length)
                                    : bake_fail("out of memory");
    int rc = places < 0 ? -1
                        : bake_pwrite(section->length_fd, length, (size_t)places * LENGTH_BYTES,
                                      section->places * LENGTH_BYTES);
    if (!rc) {
        size_t bytes = put_records(blob, data);
        rc = bake_pwrite(section->data_fd, data, bytes, section->data_bytes);
        section->places += (uint64_t)places;
        section->data_bytes += bytes;
    }
    free(data);
    free(length);
    return rc;
}

/* ---- the index ---- */

typedef struct index_file {
    int fd;
    uint64_t at;
    uint32_t crc;
} index_file;

static int put_block(index_file *to, const uint8_t *block, size_t bytes)
{
    int rc = bake_pwrite(to->fd, block, bytes, to->at);
    to->crc = ff_crc32(to->crc, block, bytes);
    to->at += bytes;
    return rc;
}

static int put_presence(const pack_section_file *from, index_file *to)
{
    uint32_t length[FF_INDEX_PLACES], rank = 0;
    uint8_t block[FF_INDEX_PRESENCE_BYTES];
    for (uint64_t place = 0; place < from->places; place += FF_INDEX_PLACES) {
        uint32_t count = from->places - place < FF_INDEX_PLACES ? (uint32_t)(from->places - place)
                                                                : FF_INDEX_PLACES;
        if (bake_pread(from->length_fd, length, count * LENGTH_BYTES, place * LENGTH_BYTES))
            return -1;
        ff_index_put_presence(length, count, rank, block);
        for (uint32_t i = 0; i < count; i++) rank += length[i] > 0;
        if (put_block(to, block, sizeof block)) return -1;
    }
    return 0;
}

static int put_lengths(const pack_section_file *from, const ff_index *index, index_file *to)
{
    uint32_t length[FF_INDEX_PLACES], some[FF_INDEX_RECORDS], held = 0;
    uint8_t block[FF_INDEX_BLOCK_MAX];
    uint64_t first = 0, offset = 0;
    for (uint64_t place = 0; place < from->places; place += FF_INDEX_PLACES) {
        uint32_t count = from->places - place < FF_INDEX_PLACES ? (uint32_t)(from->places - place)
                                                                : FF_INDEX_PLACES;
        if (bake_pread(from->length_fd, length, count * LENGTH_BYTES, place * LENGTH_BYTES))
            return -1;
        for (uint32_t i = 0; i < count; i++) {
            if (length[i] == 0) continue;
            some[held++] = length[i];
            offset += FF_RECORD_CRC_BYTES + length[i];
            if (held < FF_INDEX_RECORDS) continue;
            ff_index_put_lengths(index, some, held, first, block);
            if (put_block(to, block, ff_index_block_bytes(index))) return -1;
            first = offset;
            held = 0;
        }
    }
    if (held == 0) return 0;
    ff_index_put_lengths(index, some, held, first, block);
    return put_block(to, block, ff_index_block_bytes(index));
}

/* Roots have all their places. */
static int put_index(const pack_section_file *from, int fd, ff_pack_section *section)
{
    index_file to = { fd, section->index_offset, 0 };
    ff_index *index = &section->index;
    if (from->records > UINT32_MAX) return bake_fail("more than 2^32 nodes of a level");
    index->records = (uint32_t)from->records;
    while (from->length_max >> index->length_bits) index->length_bits++;
    if (index->length_bits > FF_INDEX_LENGTH_BITS) return bake_fail("a record is too long");
    if (section->kind != FF_SECTION_ROOT) index->places = from->places;
    if (index->places && put_presence(from, &to)) return -1;
    if (put_lengths(from, index, &to)) return -1;
    section->index_crc = to.crc;
    return 0;
}

/* ---- the file ---- */

/* Copies `count` bytes from the start of a temporary file; *crc goes on over them. */
static int copy_part(int from, int to, uint64_t count, uint64_t to_offset, uint32_t *crc)
{
    uint8_t *buffer = malloc(COPY_BYTES);
    if (!buffer) return bake_fail("out of memory");
    int rc = 0;
    for (uint64_t at = 0; !rc && at < count;) {
        size_t bytes = count - at < COPY_BYTES ? (size_t)(count - at) : COPY_BYTES;
        rc = bake_pread(from, buffer, bytes, at);
        if (!rc) rc = bake_pwrite(to, buffer, bytes, to_offset + at);
        *crc = ff_crc32(*crc, buffer, bytes);
        at += bytes;
    }
    free(buffer);
    return rc;
}

static ff_pack_section section_of(const pack_writer *writer, uint32_t number)
{
    ff_pack_section section = { 0 };
    if (ff_pack_section_at(&writer->info, number, &section)) return section;
    uint32_t layer = writer->layers - 1;
    while (number < writer->layer_first[layer]) layer--;
    return ff_pack_layer_section(layer, number - writer->layer_first[layer]);
}

static int write_sections(const pack_writer *writer, int fd, ff_pack_header *header, uint64_t *end)
{
    *end = FF_PACK_HEADER_BYTES;
    for (uint32_t i = 0; i < writer->section_count; i++) {
        const pack_section_file *from = &writer->section[i];
        ff_pack_section *section = &header->section[i];
        *section = section_of(writer, i);
        section->index_offset = *end;
        if (put_index(from, fd, section)) return -1;
        section->data_offset = *end + ff_index_bytes(&section->index);
        section->data_bytes = from->data_bytes;
        if (copy_part(from->data_fd, fd, from->data_bytes, section->data_offset,
                      &section->data_crc))
            return -1;
        *end = section->data_offset + section->data_bytes;
        bake_progress("writing", i + 1, writer->section_count);
    }
    return 0;
}

/* A section of its bytes alone. */
/* What the pack says of itself, from `at` to *end, and its header, which tells the checksum. */
static int write_head(ff_list about, int fd, ff_pack_header *header, uint64_t at, uint64_t *end)
{
    static uint8_t bytes[FF_PACK_HEADER_BYTES];
    if (about.byte_count) {
        header->about = ff_pack_about_section();
        header->about.index_offset = header->about.data_offset = at;
        header->about.data_bytes = about.byte_count;
        header->about.data_crc = ff_crc32(0, about.bytes, about.byte_count);
        if (bake_pwrite(fd, about.bytes, about.byte_count, at)) return -1;
    }
    *end = at + about.byte_count;
    int rc = ff_pack_header_encode(header, bytes);
    if (rc) return bake_fail("the pack's header does not hold: %s", ff_error_text(rc));
    return bake_pwrite(fd, bytes, sizeof bytes, 0);
}

static int write_file(const pack_writer *writer, int fd, uint64_t *file_bytes)
{
    static ff_pack_header header;
    uint8_t list[FF_ABOUT_BYTES_MAX];
    uint64_t at;
    header = (ff_pack_header){ .info = writer->info, .section_count = writer->section_count };
    if (write_sections(writer, fd, &header, &at) ||
        write_head(writer->about, fd, &header, at, file_bytes))
        return -1;
    if (writer->has_whole && header.info.checksum != writer->whole) {
        int bytes = ff_about_put_whole(writer->about, writer->whole, list, sizeof list);
        FF_ASSERT(bytes > 0); /* entries that are known fit together */
        if (write_head((ff_list){ list, (uint32_t)bytes }, fd, &header, at, file_bytes)) return -1;
    }
    if (fsync(fd)) return bake_fail("cannot sync the pack: %s", strerror(errno));
    return 0;
}

int pack_writer_finish(pack_writer *writer, const char *path, uint64_t *file_bytes)
{
    char temp[PATH_BYTES];
    if (bake_temp_name(path, temp, sizeof temp)) return -1;
    int fd = open(temp, O_RDWR | O_CREAT | O_TRUNC, 0666);
    if (fd < 0) return bake_fail("cannot write %s: %s", path, strerror(errno));
    int rc = write_file(writer, fd, file_bytes);
    if (close(fd) && !rc) rc = bake_fail("cannot write %s: %s", path, strerror(errno));
    if (!rc && rename(temp, path)) rc = bake_fail("cannot rename to %s: %s", path, strerror(errno));
    if (rc) unlink(temp);
    return rc;
}
