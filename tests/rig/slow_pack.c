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
        if (!memcmp(section, known[i], 4)) return section[4] == 1 && section[5] <= (i < 2 ? 2 : 0);
    return 0;
}

static int can_be_read(const uint8_t *pack, size_t bytes)
{
    static const uint8_t magic[] = { 0x89, 0x46, 0x46, 0x50, 0x0D, 0x0A, 0x1A, 0x0A };
    uint8_t zeroed[4092];
    if (bytes < 4096 || memcmp(pack, magic, 8) || number_at(pack + 8, 4) != 5) return 0;
    if (crc(pack, 4092) != number_at(pack + 4092, 4)) return 0;
    memcpy(zeroed, pack, sizeof zeroed);
    memset(zeroed + 76, 0, 4);
    if (crc(zeroed, 4092) != number_at(pack + 76, 4) || number_at(pack + 80, 4) > 80) return 0;
    for (uint64_t i = 0; i < number_at(pack + 80, 4); i++)
        if (!is_known(pack + 84 + 48 * i) && (pack[84 + 48 * i + 7] & 1)) return 0;
    return 1;
}

long slow_pack_record(const uint8_t *pack, size_t bytes, const char *letters, unsigned level,
                      uint64_t number, const uint8_t **payload)
{
    if (!can_be_read(pack, bytes)) return -1;
    for (uint64_t i = 0; i < number_at(pack + 80, 4); i++) {
        const uint8_t *section = pack + 84 + 48 * i;
        uint64_t count = number_at(section + 16, 8), index = number_at(section + 24, 8),
                 data = number_at(section + 32, 8), data_bytes = number_at(section + 40, 8);
        if (memcmp(section, letters, 4) || section[6] != level || number >= count) continue;
        if (crc(pack + index, 8 * (count + 1)) != number_at(section + 8, 4)) return -1;
        uint64_t begin = number_at(pack + index + 8 * number, 8),
                 end = number_at(pack + index + 8 * number + 8, 8);
        if (begin + 4 > end || end > data_bytes) return -1;
        *payload = pack + data + begin + 4;
        if (crc(*payload, end - begin - 4) != number_at(pack + data + begin, 4)) return -1;
        return (long)(end - begin - 4);
    }
    return -1;
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
