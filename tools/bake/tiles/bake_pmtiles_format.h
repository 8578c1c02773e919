/* PMTiles version 3, byte for byte, for who reads and who writes them
 * (https://github.com/protomaps/PMTiles, spec/v3): the header, directories, numbers of tiles. */
#ifndef BAKE_PMTILES_FORMAT_H
#define BAKE_PMTILES_FORMAT_H

#include <stddef.h>
#include <stdint.h>

#define BAKE_PM_HEADER_BYTES 127
#define BAKE_PM_MAGIC        "PMTiles"
#define BAKE_PM_VERSION      3
/* The header and the root directory are read at once. */
#define BAKE_PM_FIRST_BYTES 16384
/* Of an entry, at least and at most. */
#define BAKE_PM_ENTRY_MIN   4
#define BAKE_PM_ENTRY_MAX   40
#define BAKE_TILE_BYTES_MAX (32u << 20)
#define BAKE_ZOOM_MAX       24

enum bake_pm_packing { BAKE_PM_PLAIN = 1, BAKE_PM_GZIP = 2 };
enum bake_pm_tiles { BAKE_PM_PNG = 2, BAKE_PM_JPEG = 3 };

typedef struct bake_pm_section {
    uint64_t offset, bytes;
} bake_pm_section;

typedef struct bake_pm_header {
    int version;
    bake_pm_section root, metadata, leaves, tiles;
    uint64_t addressed, entries, contents; /* tiles, and what they share */
    int clustered;                         /* tiles lie in the order of their numbers */
    int directories_packed, tiles_packed;  /* enum bake_pm_packing */
    int kind;                              /* enum bake_pm_tiles */
    uint32_t zoom_min, zoom_max, zoom_middle;
    double west, south, east, north, middle_x, middle_y; /* degrees */
} bake_pm_header;

typedef struct bake_pm_entry {
    uint64_t number; /* of the first tile */
    uint64_t offset;
    uint32_t bytes;
    uint32_t run; /* tiles that are all alike; 0: a leaf directory from `number` on */
} bake_pm_entry;

/* As the bytes say: nothing is checked. */
void bake_pm_header_take(const uint8_t bytes[BAKE_PM_HEADER_BYTES], bake_pm_header *header);
void bake_pm_header_put(const bake_pm_header *header, uint8_t bytes[BAKE_PM_HEADER_BYTES]);

/* How many entries an unpacked directory says that it has; 0: damaged. */
size_t bake_pm_directory_count(const uint8_t *bytes, size_t count);
/* Reads so many. 0, or -1: damaged. */
int bake_pm_directory_take(const uint8_t *bytes, size_t count, bake_pm_entry *entry,
                           size_t entries);
/* Writes a directory, at most (entries + 1) * BAKE_PM_ENTRY_MAX bytes; returns how many. */
size_t bake_pm_directory_put(const bake_pm_entry *entry, size_t entries, uint8_t *bytes);

/* Of a tile along the Hilbert curves, zoom by zoom; x and y are below 2^zoom. */
uint64_t bake_pmtiles_number(uint32_t zoom, uint32_t x, uint32_t y);

#endif
