#include "slow_pack.h"

#include <string.h>

static uint64_t number_at(const uint8_t *at, int bytes)
{
    return bytes ? at[0] + 256 * number_at(at + 1, bytes - 1) : 0;
}

static uint32_t crc(const uint8_t *at, size_t bytes)
{
    uint32_t rest = 0xFFFFFFFF;
    for (size_t i = 0; i < bytes; i++) {
        rest ^= at[i];
        for (int bit = 0; bit < 8; bit++) rest = rest / 2 ^ (rest & 1 ? 0xEDB88320 : 0);
    }
    return rest ^ 0xFFFFFFFF;
}

static int is_known(const uint8_t *section)
{
    static const char known[][5] = { "ROOT", "REFI", "IMAG", "ABOU" };
    for (int i = 0; i < 4; i++)
        if (!memcmp(section, known[i], 4))
            return section[4] == 1 && section[5] <= (i < 2 ? 3 : i < 3 ? 7 : 0);
    return 0;
}

static int can_be_read(const uint8_t *pack, size_t bytes)
{
    static const uint8_t magic[] = { 0x89, 0x46, 0x46, 0x50, 0x0D, 0x0A, 0x1A, 0x0A };
    uint8_t zeroed[4092];
    if (bytes < 4096 || memcmp(pack, magic, 8) || number_at(pack + 8, 4) != 9) return 0;
    if (crc(pack, 4092) != number_at(pack + 4092, 4)) return 0;
    memcpy(zeroed, pack, sizeof zeroed);
    memset(zeroed + 76, 0, 4);
    if (crc(zeroed, 4092) != number_at(pack + 76, 4) || number_at(pack + 80, 4) > 80) return 0;
    for (uint64_t i = 0; i < number_at(pack + 80, 4); i++)
        if (!is_known(pack + 84 + 48 * i) && (pack[84 + 48 * i + 7] & 1)) return 0;
    return 1;
}

static unsigned crc16(const uint8_t *at, size_t bytes)
{
    unsigned rest = 0xFFFF;
    for (size_t i = 0; i < 8 * bytes; i++) {
        unsigned bit = at[i / 8] >> (7 - i % 8) & 1;
        rest = rest >> 15 != bit ? (2 * rest ^ 0x1021) & 0xFFFF : 2 * rest & 0xFFFF;
    }
    return rest;
}

static int bit_at(const uint8_t *bytes, uint64_t bit) { return bytes[bit / 8] >> bit % 8 & 1; }

/* The row of a section, by its letters and level, and 256 times the layer of images; NULL: there is
 * none. */
static const uint8_t *section_of(const uint8_t *pack, const char *letters, unsigned level)
{
    for (uint64_t i = 0; i < number_at(pack + 80, 4); i++) {
        const uint8_t *section = pack + 84 + 48 * i;
        unsigned layer = memcmp(letters, "IMAG", 4) ? 0 : section[5];
        if (!memcmp(section, letters, 4) && section[6] + 256u * layer == level) return section;
    }
    return NULL;
}

/* Bits of presence of a section: 0 for roots. */
static uint64_t places_of(const uint8_t *pack, const char *letters, unsigned level)
{
    const uint8_t *above = section_of(pack, level % 256 ? letters : "ROOT",
                                      level % 256 ? level - 1 : 0);
    if (!memcmp(letters, "ROOT", 4)) return 0;
    return number_at(above + 16, 4) * (level % 256 ? 4 : 1);
}

/* The record at a place: it counts all bits before. -1: there is none. */
static int64_t record_at(const uint8_t *pack, const char *letters, unsigned level, uint64_t place)
{
    const uint8_t *index = pack + number_at(section_of(pack, letters, level) + 24, 8);
    int64_t before = 0;
    if (!memcmp(letters, "ROOT", 4)) return (int64_t)place;
    for (uint64_t p = 0; p < place; p++) before += bit_at(index + p / 256 * 36 + 4, p % 256);
    if (number_at(index + place / 256 * 36, 4) + 256 < (uint64_t)before) return -1;
    return bit_at(index + place / 256 * 36 + 4, place % 256) ? before : -1;
}

static long payload_of(const uint8_t *pack, const char *letters, unsigned level, uint64_t number,
                       const uint8_t **payload)
{
    const uint8_t *section = section_of(pack, letters, level);
    unsigned bits = section[20];
    uint64_t count = number_at(section + 16, 4), at = number_at(section + 32, 8), bytes = 0;
    uint64_t blocks = (places_of(pack, letters, level) + 255) / 256 * 36;
    const uint8_t *lengths = pack + number_at(section + 24, 8) + blocks;
    if (number >= count) return -1;
    for (uint64_t r = 0; r <= number; r++) { /* all records before lie before it */
        const uint8_t *block = lengths + r / 64 * (8 + 8 * bits);
        if (r > 0) at += bytes + 2;
        if (r % 64 == 0 && number_at(block, 8) + number_at(section + 32, 8) != at) return -1;
        bytes = 0;
        for (unsigned bit = 0; bit < bits; bit++)
            bytes += (uint64_t)bit_at(block + 8, r % 64 * bits + bit) << bit;
    }
    if (number_at(pack + at, 2) != crc16(pack + at + 2, bytes)) return -1;
    *payload = pack + at + 2;
    return (long)bytes;
}

long slow_pack_record(const uint8_t *pack, size_t bytes, const char *letters, unsigned level,
                      uint64_t tile, uint32_t code, const uint8_t **payload)
{
    if (!can_be_read(pack, bytes) || !section_of(pack, letters, level)) return -1;
    const uint8_t *section = section_of(pack, letters, level);
    int64_t number = (int64_t)tile;
    if (!memcmp(letters, "ABOU", 4)) {
        *payload = pack + number_at(section + 32, 8);
        return (long)number_at(section + 40, 8);
    }
    for (unsigned l = 0; l <= level % 256 && number >= 0; l++) {
        unsigned quadrant = code >> 2 * (level % 256 - l) & 3;
        number = record_at(pack, letters, level - level % 256 + l,
                           l ? 4 * (uint64_t)number + quadrant : (uint64_t)number);
    }
    return number < 0 ? -1 : payload_of(pack, letters, level, (uint64_t)number, payload);
}

int slow_layer(const uint8_t *rows, size_t bytes, unsigned number, unsigned grounds, char name[32],
               uint8_t *levels)
{
    size_t at = 0;
    for (; number > 0 && at < bytes; number--) at += 1 + (size_t)rows[at];
    if (at + 2 > bytes || at + 1 + rows[at] > bytes || rows[at + 1] > 31) return -1;
    size_t length = rows[at + 1];
    if (1 + length + grounds > rows[at]) return -1;
    memcpy(name, rows + at + 2, length);
    name[length] = 0;
    memcpy(levels, rows + at + 2 + length, grounds);
    return 0;
}

long slow_list_find(const uint8_t *list, size_t bytes, unsigned type, const uint8_t **value)
{
    long found = -1;
    for (size_t at = 0, last = 0; at < bytes;) {
        size_t here = list[at++], length = 0, scale = 1;
        if (here <= last) return -2;
        last = here;
        for (;; scale *= 128) {
            if (at == bytes) return -2;
            length += scale * (list[at] % 128);
            if (list[at++] < 128) break;
        }
        if (length > bytes - at) return -2;
        if (here == type) {
            *value = list + at;
            found = (long)length;
        }
        at += length;
    }
    return found;
}

int slow_terrain(const uint8_t *value, size_t bytes, uint8_t plain[68])
{
    size_t at = 9;
    if (bytes < 9 || value[8] > 15) return -1;
    for (int i = 0; i < 68; i++) {
        int there = value[i / 8] / (1 << i % 8) % 2;
        if (there && (at == bytes || value[at] == 0)) return -1;
        plain[i] = there ? value[at] : 0;
        at += (size_t)there;
    }
    return at == bytes ? 0 : -1;
}
