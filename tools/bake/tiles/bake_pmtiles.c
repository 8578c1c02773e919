#include "bake_pmtiles.h"

#include "../bake_say.h"
#include "../raster/bake_grid.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#define HEADER_BYTES    127
#define MAGIC           "PMTiles"
#define VERSION         3
#define PACKED_MAX      (16u << 20) /* of a directory or the metadata */
#define UNPACKED_MAX    (64u << 20)
#define DEPTH_MAX       4 /* directories between root and tile */
#define GZIP_WINDOW     (16 + MAX_WBITS)
#define ENTRY_BYTES_MIN 4 /* a byte in each of four columns */
#define PACKED_NONE     1
#define PACKED_GZIP     2
#define DEGREES_A_UNIT  1e-7

static int damaged(const bake_pmtiles *file, const char *what)
{
    return bake_fail("%s: damaged PMTiles: %s", file->path, what);
}

/* ---- bytes ---- */

static uint64_t get_le(const uint8_t *bytes, int count)
{
    uint64_t value = 0;
    for (int i = count; i-- > 0;) value = value << 8 | bytes[i];
    return value;
}

/* Unpacks gzip into memory to be freed, with a zero behind it; NULL when it is damaged or would be
 * more than `most`. */
static uint8_t *gunzip(const uint8_t *packed, size_t packed_bytes, size_t most, size_t *count)
{
    z_stream stream = { .next_in = (Bytef *)packed, .avail_in = (uInt)packed_bytes };
    size_t room = 4 * packed_bytes + 1024;
    uint8_t *out = NULL;
    int rc = inflateInit2(&stream, GZIP_WINDOW);
    if (rc != Z_OK) return NULL;
    do {
        if (room > most) room = most;
        uint8_t *grown = realloc(out, room + 1);
        if (!grown) break;
        out = grown;
        stream.next_out = out + stream.total_out;
        stream.avail_out = (uInt)(room - stream.total_out);
        rc = inflate(&stream, Z_NO_FLUSH);
        if (rc == Z_OK && stream.avail_out) break; /* it wants more than there is */
        if (rc == Z_OK && room == most) break;
        room *= 2;
    } while (rc == Z_OK);
    *count = stream.total_out;
    inflateEnd(&stream);
    if (rc == Z_STREAM_END) {
        out[*count] = 0;
        return out;
    }
    free(out);
    return NULL;
}

/* Reads a part of a section, unpacked, into memory to be freed, with a zero behind it; NULL (said).
 */
static uint8_t *read_part(const bake_pmtiles *file, bake_pm_section section, uint64_t offset,
                          uint64_t bytes, int packed, size_t *count)
{
    if (offset > section.bytes || bytes > section.bytes - offset) {
        damaged(file, "a part lies outside the file");
        return NULL;
    }
    if (bytes > BAKE_TILE_BYTES_MAX) {
        damaged(file, "a part is too large");
        return NULL;
    }
    uint8_t *raw = malloc(bytes + 1);
    if (!raw) bake_fail("out of memory");
    if (!raw || bake_pread(file->fd, raw, bytes, section.offset + offset)) {
        free(raw);
        return NULL;
    }
    raw[bytes] = 0;
    *count = bytes;
    if (!packed) return raw;
    uint8_t *unpacked = gunzip(raw, bytes, UNPACKED_MAX, count);
    free(raw);
    if (!unpacked) damaged(file, "a part cannot be unpacked");
    return unpacked;
}

/* ---- directories ---- */

typedef struct cursor {
    const uint8_t *at, *end;
    int failed;
} cursor;

/* Seven bits a byte, the lowest first. */
static uint64_t take_number(cursor *in)
{
    uint64_t value = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
        if (in->at == in->end) break;
        uint8_t byte = *in->at++;
        value |= (uint64_t)(byte & 127) << shift;
        if (byte < 128) return value;
    }
    in->failed = 1;
    return 0;
}

static void take_columns(cursor *in, bake_pm_entry *entry, size_t count)
{
    uint64_t number = 0;
    for (size_t i = 0; i < count; i++) {
        uint64_t step = take_number(in);
        in->failed |= (i && step == 0) || number + step < number;
        entry[i].number = number += step;
    }
    for (size_t i = 0; i < count; i++) {
        uint64_t run = take_number(in);
        in->failed |= run > UINT32_MAX;
        entry[i].run = (uint32_t)run;
    }
    for (size_t i = 0; i < count; i++) {
        uint64_t bytes = take_number(in);
        in->failed |= bytes == 0 || bytes > BAKE_TILE_BYTES_MAX;
        entry[i].bytes = (uint32_t)bytes;
    }
    for (size_t i = 0; i < count; i++) {
        uint64_t offset = take_number(in);
        in->failed |= i == 0 && offset == 0;
        entry[i].offset = offset ? offset - 1 : i ? entry[i - 1].offset + entry[i - 1].bytes : 0;
    }
}

static int read_directory(const bake_pmtiles *file, bake_pm_section section, uint64_t offset,
                          uint64_t bytes, bake_pm_directory *directory)
{
    size_t count;
    if (bytes > PACKED_MAX) return damaged(file, "a directory is too large");
    uint8_t *raw = read_part(file, section, offset, bytes, file->directories_packed, &count);
    if (!raw) return -1;
    cursor in = { raw, raw + count, 0 };
    uint64_t entries = take_number(&in);
    int rc = in.failed || !entries || entries > count / ENTRY_BYTES_MIN
                 ? damaged(file, "a directory has no or too many entries")
                 : 0;
    bake_pm_entry *entry = rc ? NULL : calloc(entries, sizeof *entry);
    if (!rc && !entry) rc = bake_fail("out of memory");
    if (!rc) take_columns(&in, entry, entries);
    if (!rc && in.failed) rc = damaged(file, "a directory's entry");
    free(raw);
    if (rc) {
        free(entry);
        return rc;
    }
    free(directory->entry);
    *directory = (bake_pm_directory){ entry, entries, offset };
    return 0;
}

/* The last entry that begins at or before `number`, or NULL. */
static const bake_pm_entry *find_entry(const bake_pm_directory *directory, uint64_t number)
{
    size_t low = 0, high = directory->count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (directory->entry[middle].number <= number)
            low = middle + 1;
        else
            high = middle;
    }
    return low ? &directory->entry[low - 1] : NULL;
}

uint64_t bake_pmtiles_number(uint32_t zoom, uint32_t x, uint32_t y)
{
    uint64_t side = UINT64_C(1) << zoom, number = (side * side - 1) / 3, i = x, j = y;
    for (uint64_t s = side / 2; s > 0; s /= 2) {
        uint64_t right = (i & s) != 0, down = (j & s) != 0;
        number += s * s * ((3 * right) ^ down);
        if (down) continue;
        if (right) {
            i = side - 1 - i;
            j = side - 1 - j;
        }
        uint64_t swap = i;
        i = j;
        j = swap;
    }
    return number;
}

int bake_pmtiles_get(bake_pmtiles *file, uint32_t zoom, uint32_t x, uint32_t y, uint8_t **bytes,
                     size_t *count)
{
    uint64_t number = bake_pmtiles_number(zoom, x, y);
    const bake_pm_directory *directory = &file->root;
    for (int depth = 0; depth < DEPTH_MAX; depth++) {
        const bake_pm_entry *entry = find_entry(directory, number);
        if (!entry) return 0;
        if (entry->run) {
            if (number - entry->number >= entry->run) return 0;
            *bytes = read_part(file, file->tiles, entry->offset, entry->bytes, file->tiles_packed,
                               count);
            return *bytes ? 1 : -1;
        }
        uint64_t offset = entry->offset;
        if ((!file->leaf.entry || file->leaf.offset != offset) &&
            read_directory(file, file->leaves, offset, entry->bytes, &file->leaf))
            return -1;
        directory = &file->leaf;
    }
    return damaged(file, "too many directories in one another");
}

/* ---- header ---- */

static int read_bytes(const char *path, uint8_t *bytes, size_t count)
{
    FILE *in = fopen(path, "rb");
    size_t got = in ? fread(bytes, 1, count, in) : 0;
    if (in) fclose(in);
    return got == count ? 0 : -1;
}

int bake_pmtiles_is(const char *path)
{
    uint8_t head[sizeof MAGIC - 1];
    return !read_bytes(path, head, sizeof head) && !memcmp(head, MAGIC, sizeof head);
}

/* A section, and whether it lies in the file. */
static int take_section(const uint8_t *head, uint64_t file_bytes, bake_pm_section *section)
{
    section->offset = get_le(head, 8);
    section->bytes = get_le(head + 8, 8);
    return section->offset <= file_bytes && section->bytes <= file_bytes - section->offset;
}

static double take_degrees(const uint8_t *head)
{
    return (int32_t)(uint32_t)get_le(head, 4) * DEGREES_A_UNIT;
}

static int read_header(bake_pmtiles *file, uint64_t file_bytes)
{
    uint8_t head[HEADER_BYTES];
    if (file_bytes < sizeof head) return damaged(file, "it ends in its header");
    if (bake_pread(file->fd, head, sizeof head, 0)) return -1;
    if (head[7] != VERSION)
        return bake_fail("%s: PMTiles of version %d, but only %d is read", file->path, head[7],
                         VERSION);
    if (!take_section(head + 8, file_bytes, &file->root_at) ||
        !take_section(head + 24, file_bytes, &file->metadata) ||
        !take_section(head + 40, file_bytes, &file->leaves) ||
        !take_section(head + 56, file_bytes, &file->tiles))
        return damaged(file, "it is cut off, or a section lies outside it");
    for (int i = 97; i <= 98; i++)
        if (head[i] > PACKED_GZIP)
            return bake_fail("%s: packed in a way (%d) that is not read: only gzip is", file->path,
                             head[i]);
    file->directories_packed = head[97] == PACKED_GZIP;
    file->tiles_packed = head[98] == PACKED_GZIP;
    file->zoom_min = head[100];
    file->zoom_max = head[101];
    if (file->zoom_min > file->zoom_max || file->zoom_max > BAKE_ZOOM_MAX)
        return damaged(file, "its zooms");
    file->west = take_degrees(head + 102);
    file->south = take_degrees(head + 106);
    file->east = take_degrees(head + 110);
    file->north = take_degrees(head + 114);
    return 0;
}

int bake_pmtiles_open(const char *path, bake_pmtiles *file)
{
    struct stat status;
    *file = (bake_pmtiles){ .fd = open(path, O_RDONLY | O_CLOEXEC), .path = path };
    if (file->fd < 0 || fstat(file->fd, &status)) {
        bake_pmtiles_close(file);
        return bake_fail("%s: %s", path, strerror(errno));
    }
    int rc = read_header(file, (uint64_t)status.st_size);
    if (!rc) rc = read_directory(file, file->root_at, 0, file->root_at.bytes, &file->root);
    if (rc) bake_pmtiles_close(file);
    return rc;
}

void bake_pmtiles_close(bake_pmtiles *file)
{
    if (file->fd >= 0) close(file->fd);
    free(file->root.entry);
    free(file->leaf.entry);
    *file = (bake_pmtiles){ .fd = -1 };
}

char *bake_pmtiles_metadata(const bake_pmtiles *file)
{
    size_t count;
    return (char *)read_part(file, file->metadata, 0, file->metadata.bytes,
                             file->directories_packed && file->metadata.bytes, &count);
}
