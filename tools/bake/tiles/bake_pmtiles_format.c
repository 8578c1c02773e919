#include "bake_pmtiles_format.h"

#include <math.h>
#include <string.h>

#define UNITS_A_DEGREE 1e7

/* ---- the header ---- */

static uint64_t get_le(const uint8_t *bytes, int count)
{
    uint64_t value = 0;
    for (int i = count; i-- > 0;) value = value << 8 | bytes[i];
    return value;
}

static void put_le(uint8_t *bytes, uint64_t value, int count)
{
    for (int i = 0; i < count; i++) bytes[i] = (uint8_t)(value >> (8 * i));
}

static bake_pm_section take_section(const uint8_t *bytes)
{
    return (bake_pm_section){ get_le(bytes, 8), get_le(bytes + 8, 8) };
}

static void put_section(uint8_t *bytes, bake_pm_section section)
{
    put_le(bytes, section.offset, 8);
    put_le(bytes + 8, section.bytes, 8);
}

static double take_degrees(const uint8_t *bytes)
{
    return (int32_t)(uint32_t)get_le(bytes, 4) / UNITS_A_DEGREE;
}

static void put_degrees(uint8_t *bytes, double degrees)
{
    put_le(bytes, (uint32_t)(int32_t)lround(degrees * UNITS_A_DEGREE), 4);
}

void bake_pm_header_take(const uint8_t bytes[BAKE_PM_HEADER_BYTES], bake_pm_header *header)
{
    *header = (bake_pm_header){
        .version = bytes[7],
        .root = take_section(bytes + 8),
        .metadata = take_section(bytes + 24),
        .leaves = take_section(bytes + 40),
        .tiles = take_section(bytes + 56),
        .addressed = get_le(bytes + 72, 8),
        .entries = get_le(bytes + 80, 8),
        .contents = get_le(bytes + 88, 8),
        .clustered = bytes[96],
        .directories_packed = bytes[97],
        .tiles_packed = bytes[98],
        .kind = bytes[99],
        .zoom_min = bytes[100],
        .zoom_max = bytes[101],
        .west = take_degrees(bytes + 102),
        .south = take_degrees(bytes + 106),
        .east = take_degrees(bytes + 110),
        .north = take_degrees(bytes + 114),
        .zoom_middle = bytes[118],
        .middle_x = take_degrees(bytes + 119),
        .middle_y = take_degrees(bytes + 123),
    };
}

void bake_pm_header_put(const bake_pm_header *header, uint8_t bytes[BAKE_PM_HEADER_BYTES])
{
    memcpy(bytes, BAKE_PM_MAGIC, 7);
    bytes[7] = (uint8_t)header->version;
    put_section(bytes + 8, header->root);
    put_section(bytes + 24, header->metadata);
    put_section(bytes + 40, header->leaves);
    put_section(bytes + 56, header->tiles);
    put_le(bytes + 72, header->addressed, 8);
    put_le(bytes + 80, header->entries, 8);
    put_le(bytes + 88, header->contents, 8);
    bytes[96] = (uint8_t)header->clustered;
    bytes[97] = (uint8_t)header->directories_packed;
    bytes[98] = (uint8_t)header->tiles_packed;
    bytes[99] = (uint8_t)header->kind;
    bytes[100] = (uint8_t)header->zoom_min;
    bytes[101] = (uint8_t)header->zoom_max;
    put_degrees(bytes + 102, header->west);
    put_degrees(bytes + 106, header->south);
    put_degrees(bytes + 110, header->east);
    put_degrees(bytes + 114, header->north);
    bytes[118] = (uint8_t)header->zoom_middle;
    put_degrees(bytes + 119, header->middle_x);
    put_degrees(bytes + 123, header->middle_y);
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

size_t bake_pm_directory_count(const uint8_t *bytes, size_t count)
{
    cursor in = { bytes, bytes + count, 0 };
    uint64_t entries = take_number(&in);
    return in.failed || entries > count / BAKE_PM_ENTRY_MIN ? 0 : (size_t)entries;
}

int bake_pm_directory_take(const uint8_t *bytes, size_t count, bake_pm_entry *entry, size_t entries)
{
    cursor in = { bytes, bytes + count, 0 };
    (void)take_number(&in);
    take_columns(&in, entry, entries);
    return in.failed ? -1 : 0;
}

static uint8_t *put_number(uint8_t *out, uint64_t value)
{
    for (; value > 127; value >>= 7) *out++ = (uint8_t)(value | 128);
    *out++ = (uint8_t)value;
    return out;
}

size_t bake_pm_directory_put(const bake_pm_entry *entry, size_t entries, uint8_t *bytes)
{
    uint8_t *out = put_number(bytes, entries);
    for (size_t i = 0; i < entries; i++)
        out = put_number(out, entry[i].number - (i ? entry[i - 1].number : 0));
    for (size_t i = 0; i < entries; i++) out = put_number(out, entry[i].run);
    for (size_t i = 0; i < entries; i++) out = put_number(out, entry[i].bytes);
    for (size_t i = 0; i < entries; i++) {
        int follows = i && entry[i].offset == entry[i - 1].offset + entry[i - 1].bytes;
        out = put_number(out, follows ? 0 : entry[i].offset + 1);
    }
    return (size_t)(out - bytes);
}

/* ---- numbers ---- */

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
