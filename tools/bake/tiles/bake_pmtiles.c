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

#define PACKED_MAX   (16u << 20) /* of a directory or the metadata */
#define UNPACKED_MAX (64u << 20)
#define DEPTH_MAX    4 /* directories between root and tile */
#define GZIP_WINDOW  (16 + MAX_WBITS)

static int damaged(const bake_pmtiles *file, const char *what)
{
    return bake_fail("%s: damaged PMTiles: %s", file->path, what);
}

/* ---- bytes ---- */

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

static int read_directory(const bake_pmtiles *file, bake_pm_section section, uint64_t offset,
                          uint64_t bytes, bake_pm_directory *directory)
{
    size_t count;
    if (bytes > PACKED_MAX) return damaged(file, "a directory is too large");
    uint8_t *raw = read_part(file, section, offset, bytes,
                             file->head.directories_packed == BAKE_PM_GZIP, &count);
    if (!raw) return -1;
    size_t entries = bake_pm_directory_count(raw, count);
    int rc = entries ? 0 : damaged(file, "a directory has no or too many entries");
    bake_pm_entry *entry = rc ? NULL : calloc(entries, sizeof *entry);
    if (!rc && !entry) rc = bake_fail("out of memory");
    if (!rc && bake_pm_directory_take(raw, count, entry, entries))
        rc = damaged(file, "a directory's entry");
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
            *bytes = read_part(file, file->head.tiles, entry->offset, entry->bytes,
                               file->head.tiles_packed == BAKE_PM_GZIP, count);
            return *bytes ? 1 : -1;
        }
        uint64_t offset = entry->offset;
        if ((!file->leaf.entry || file->leaf.offset != offset) &&
            read_directory(file, file->head.leaves, offset, entry->bytes, &file->leaf))
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
    uint8_t head[sizeof BAKE_PM_MAGIC - 1];
    return !read_bytes(path, head, sizeof head) && !memcmp(head, BAKE_PM_MAGIC, sizeof head);
}

static int lies_in(bake_pm_section section, uint64_t file_bytes)
{
    return section.offset <= file_bytes && section.bytes <= file_bytes - section.offset;
}

static int read_header(bake_pmtiles *file, uint64_t file_bytes)
{
    uint8_t bytes[BAKE_PM_HEADER_BYTES];
    bake_pm_header *head = &file->head;
    if (file_bytes < sizeof bytes) return damaged(file, "it ends in its header");
    if (bake_pread(file->fd, bytes, sizeof bytes, 0)) return -1;
    bake_pm_header_take(bytes, head);
    if (head->version != BAKE_PM_VERSION)
        return bake_fail("%s: PMTiles of version %d, but only %d is read", file->path,
                         head->version, BAKE_PM_VERSION);
    if (!lies_in(head->root, file_bytes) || !lies_in(head->metadata, file_bytes) ||
        !lies_in(head->leaves, file_bytes) || !lies_in(head->tiles, file_bytes))
        return damaged(file, "it is cut off, or a section lies outside it");
    int packed[] = { head->directories_packed, head->tiles_packed };
    for (int i = 0; i < 2; i++)
        if (packed[i] > BAKE_PM_GZIP)
            return bake_fail("%s: packed in a way (%d) that is not read: only gzip is", file->path,
                             packed[i]);
    if (head->zoom_min > head->zoom_max || head->zoom_max > BAKE_ZOOM_MAX)
        return damaged(file, "its zooms");
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
    if (!rc) rc = read_directory(file, file->head.root, 0, file->head.root.bytes, &file->root);
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
    return (char *)read_part(
        file, file->head.metadata, 0, file->head.metadata.bytes,
        file->head.directories_packed == BAKE_PM_GZIP && file->head.metadata.bytes, &count);
}
