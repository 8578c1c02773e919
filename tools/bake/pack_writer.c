#include "pack_writer.h"

#include "raster/bake_grid.h"
#include "bake_say.h"

#include <errno.h>
#include <fcntl.h>
#include <glob.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define PATH_BYTES       4096
#define COPY_BYTES       (1u << 18)
#define RECORD_CRC_BYTES 4
#define TEMP_MARK        ".tmp-"

static void put_le(uint8_t *out, uint64_t value, int bytes)
{
    for (int i = 0; i < bytes; i++) out[i] = (uint8_t)(value >> (8 * i));
}

/* ---- before ---- */

static void remove_leftovers(const char *path)
{
    char pattern[PATH_BYTES];
    glob_t found;
    snprintf(pattern, sizeof pattern, "%s" TEMP_MARK "*", path);
    if (glob(pattern, GLOB_NOSORT, NULL, &found)) return;
    for (size_t i = 0; i < found.gl_pathc; i++) {
        long pid = strtol(found.gl_pathv[i] + strlen(path) + strlen(TEMP_MARK), NULL, 10);
        if (pid > 0 && kill((pid_t)pid, 0) && errno == ESRCH) unlink(found.gl_pathv[i]);
    }
    globfree(&found);
}

static int temp_name(const char *path, char *temp)
{
    if (snprintf(temp, PATH_BYTES, "%s" TEMP_MARK "%ld", path, (long)getpid()) >= PATH_BYTES)
        return bake_fail("%s: the name is too long", path);
    return 0;
}

int pack_writer_prepare(const char *path)
{
    char temp[PATH_BYTES];
    struct stat status;
    if (temp_name(path, temp)) return -1;
    if (!stat(path, &status) && !S_ISREG(status.st_mode))
        return bake_fail("%s: not a plain file", path);
    int fd = open(temp, O_WRONLY | O_CREAT | O_EXCL, 0666);
    if (fd < 0) return bake_fail("cannot write %s: %s", path, strerror(errno));
    close(fd);
    unlink(temp);
    remove_leftovers(path);
    return 0;
}

/* ---- sections ---- */

int pack_writer_open(pack_writer *writer, const ff_terrain_info *info)
{
    *writer = (pack_writer){ .info = *info,
                             .section_count = ff_terrain_levels(info) + info->texture_levels };
    for (uint32_t i = 0; i < FF_PACK_SECTIONS_MAX; i++)
        writer->section[i].data_fd = writer->section[i].index_fd = -1;
    for (uint32_t i = 0; i < writer->section_count; i++) {
        writer->section[i].data_fd = bake_temp_open();
        writer->section[i].index_fd = writer->section[i].data_fd < 0 ? -1 : bake_temp_open();
        if (writer->section[i].index_fd < 0) {
            pack_writer_close(writer);
            return -1;
        }
    }
    return 0;
}

void pack_writer_close(pack_writer *writer)
{
    for (uint32_t i = 0; i < writer->section_count; i++) {
        if (writer->section[i].data_fd >= 0) close(writer->section[i].data_fd);
        if (writer->section[i].index_fd >= 0) close(writer->section[i].index_fd);
        writer->section[i].data_fd = writer->section[i].index_fd = -1;
    }
}

int pack_writer_add(pack_writer *writer, uint32_t number, const bake_blob *blob)
{
    pack_section_file *section = &writer->section[number];
    size_t index_bytes = blob->record_count * 8,
           data_most = blob->byte_count + blob->record_count * RECORD_CRC_BYTES;
    uint8_t *memory = malloc(index_bytes + data_most + 1);
    if (!memory) return bake_fail("out of memory");
    uint8_t *data = memory + index_bytes, *at = data;
    const uint8_t *payload = blob->bytes;
    for (size_t i = 0; i < blob->record_count; i++) {
        put_le(memory + 8 * i, section->data_bytes + (uint64_t)(at - data), 8);
        if (blob->length[i] == 0) continue;
        put_le(at, ff_crc32(0, payload, blob->length[i]), RECORD_CRC_BYTES);
        section->records_crc = ff_crc32(section->records_crc, at, RECORD_CRC_BYTES);
        memcpy(at + RECORD_CRC_BYTES, payload, blob->length[i]);
        at += RECORD_CRC_BYTES + blob->length[i];
        payload += blob->length[i];
    }
    size_t data_bytes = (size_t)(at - data);
    int rc = bake_pwrite(section->index_fd, memory, index_bytes, section->records * 8);
    if (!rc) rc = bake_pwrite(section->data_fd, data, data_bytes, section->data_bytes);
    section->records += blob->record_count;
    section->data_bytes += data_bytes;
    free(memory);
    return rc;
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

static int write_sections(const pack_writer *writer, int fd, ff_pack_header *header, uint64_t *end)
{
    *end = FF_PACK_HEADER_BYTES;
    for (uint32_t i = 0; i < writer->section_count; i++) {
        const pack_section_file *from = &writer->section[i];
        ff_pack_section *section = &header->section[i];
        uint8_t last[8];
        uint32_t unused = 0;
        ff_pack_section_at(&writer->info, i, section);
        section->record_count = from->records;
        section->records_crc = from->records_crc;
        section->index_offset = *end;
        section->data_offset = *end + 8 * (from->records + 1);
        section->data_bytes = from->data_bytes;
        put_le(last, from->data_bytes, 8);
        if (copy_part(from->index_fd, fd, 8 * from->records, section->index_offset,
                      &section->index_crc))
            return -1;
        if (bake_pwrite(fd, last, 8, section->data_offset - 8)) return -1;
        section->index_crc = ff_crc32(section->index_crc, last, 8);
        if (copy_part(from->data_fd, fd, from->data_bytes, section->data_offset, &unused))
            return -1;
        *end = section->data_offset + section->data_bytes;
        bake_progress("writing", i + 1, writer->section_count);
    }
    return 0;
}

/* A section of one record, with its index. */
static int write_about(const pack_writer *writer, int fd, ff_pack_section *section, uint64_t *end)
{
    uint8_t bytes[16 + RECORD_CRC_BYTES + FF_ABOUT_BYTES_MAX] = { 0 }, *record = bytes + 16;
    uint32_t count = writer->about.byte_count;
    if (!count) return 0;
    *section = ff_pack_about_section();
    section->index_offset = *end;
    section->data_offset = *end + 16;
    section->data_bytes = RECORD_CRC_BYTES + count;
    put_le(bytes + 8, section->data_bytes, 8);
    put_le(record, ff_crc32(0, writer->about.bytes, count), RECORD_CRC_BYTES);
    memcpy(record + RECORD_CRC_BYTES, writer->about.bytes, count);
    section->index_crc = ff_crc32(0, bytes, 16);
    section->records_crc = ff_crc32(0, record, RECORD_CRC_BYTES);
    *end = section->data_offset + section->data_bytes;
    return bake_pwrite(fd, bytes, 16 + (size_t)section->data_bytes, section->index_offset);
}

static int write_file(const pack_writer *writer, int fd, uint64_t *file_bytes)
{
    static ff_pack_header header;
    static uint8_t bytes[FF_PACK_HEADER_BYTES];
    header = (ff_pack_header){ .info = writer->info, .section_count = writer->section_count };
    if (write_sections(writer, fd, &header, file_bytes) ||
        write_about(writer, fd, &header.about, file_bytes))
        return -1;
    int rc = ff_pack_header_encode(&header, bytes);
    if (rc) return bake_fail("the pack's header does not hold: %s", ff_error_text(rc));
    if (bake_pwrite(fd, bytes, sizeof bytes, 0)) return -1;
    if (fsync(fd)) return bake_fail("cannot sync the pack: %s", strerror(errno));
    return 0;
}

int pack_writer_finish(pack_writer *writer, const char *path, uint64_t *file_bytes)
{
    char temp[PATH_BYTES];
    if (temp_name(path, temp)) return -1;
    int fd = open(temp, O_RDWR | O_CREAT | O_TRUNC, 0666);
    if (fd < 0) return bake_fail("cannot write %s: %s", path, strerror(errno));
    int rc = write_file(writer, fd, file_bytes);
    if (close(fd) && !rc) rc = bake_fail("cannot write %s: %s", path, strerror(errno));
    if (!rc && rename(temp, path)) rc = bake_fail("cannot rename to %s: %s", path, strerror(errno));
    if (rc) unlink(temp);
    return rc;
}
