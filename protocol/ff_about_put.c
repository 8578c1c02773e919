/* For those who write what a pack says of itself. */
#include "ff_about.h"
#include "ff_error.h"

#include <string.h>

#define BETWEEN "; "
#define MARK    ((uint32_t)sizeof BETWEEN - 1)

/* The first word's bytes. */
static uint32_t word(const uint8_t *text, uint32_t byte_count)
{
    uint32_t at = 0;
    while (at < byte_count && (byte_count - at < MARK || memcmp(text + at, BETWEEN, MARK))) at++;
    return at;
}

static int has_word(const uint8_t *text, uint32_t byte_count, const uint8_t *wanted, uint32_t bytes)
{
    for (uint32_t at = 0, own; at < byte_count; at += own + MARK) {
        own = word(text + at, byte_count - at);
        if (own == bytes && !memcmp(text + at, wanted, bytes)) return 1;
    }
    return 0;
}

uint32_t ff_about_add_words(uint8_t *text, uint32_t byte_count, uint32_t room, const uint8_t *from,
                            uint32_t from_bytes)
{
    for (uint32_t at = 0, bytes; at < from_bytes; at += bytes + MARK) {
        uint32_t mark = byte_count ? MARK : 0;
        bytes = word(from + at, from_bytes - at);
        if (!bytes || byte_count + mark + bytes > room ||
            has_word(text, byte_count, from + at, bytes))
            continue;
        memcpy(text + byte_count, BETWEEN, mark);
        memcpy(text + byte_count + mark, from + at, bytes);
        byte_count += mark + bytes;
    }
    return byte_count;
}

int ff_about_put_whole(ff_list about, uint32_t checksum, uint8_t *out, uint32_t capacity)
{
    uint8_t whole[4];
    ff_writer number = { whole, whole + sizeof whole, FF_OK },
              writer = { out, out + capacity, FF_OK };
    ff_list_entry entry;
    int is_told = 0;
    ff_write_bytes(&number, checksum, sizeof whole);
    while (ff_list_next(&about, &entry) > 0) {
        if (entry.type == FF_ABOUT_WHOLE) continue;
        if (entry.type > FF_ABOUT_WHOLE && !is_told++)
            ff_list_write(&writer, FF_ABOUT_WHOLE, whole, sizeof whole);
        ff_list_write(&writer, entry.type, entry.value, entry.byte_count);
    }
    if (!is_told) ff_list_write(&writer, FF_ABOUT_WHOLE, whole, sizeof whole);
    return writer.error != FF_OK ? writer.error : (int)(writer.at - out);
}
