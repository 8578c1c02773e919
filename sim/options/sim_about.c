#include "sim_about.h"

#include <string.h>

#define VALUE_ROOM  512
#define FIRST_LATIN 0xC0

/* From FIRST_LATIN on. */
static const char latin[] = "AAAAAAACEEEEIIIIDNOOOOOXOUUUUYTSaaaaaaaceeeeiiiidnooooo/ouuuuyty"
                            "AaAaAaCcCcCcCcDdDdEeEeEeEeEeGgGgGgGgHhHhIiIiIiIiIiJjJjKkkLlLlLlL"
                            "lLlNnNnNnnNnOoOoOoOoRrRrRrSsSsSsSsTtTtTtUuUuUuUuUuUuWwYyYZzZzZzs";
FF_STATIC_ASSERT(sizeof latin - 1 == 0x180 - FIRST_LATIN);

/* Signs that sources like in what they ask to have shown: spaces, dashes, quotation marks. */
static char letter(uint32_t code)
{
    if (code < 0x80) return (char)code;
    if (code >= FIRST_LATIN && code < 0x180) return latin[code - FIRST_LATIN];
    if (code == 0xA0 || code == 0x202F || (code >= 0x2000 && code <= 0x200A)) return ' ';
    if (code == 0xB7 || (code >= 0x2010 && code <= 0x2015) || code == 0x2022) return '-';
    if (code >= 0x2018 && code <= 0x201B) return '\'';
    if (code == 0xAB || code == 0xBB || (code >= 0x201C && code <= 0x201F)) return '"';
    return '?';
}

/* Whole characters of UTF-8, which the client has checked, in letters of the font. */
static size_t plain(const uint8_t *bytes, size_t count, char *to, size_t room)
{
    size_t made = 0;
    for (size_t at = 0; at < count && made + 4 < room;) {
        uint32_t code = bytes[at++];
        if (code >= 0xC0) code &= code < 0xE0 ? 0x1F : code < 0xF0 ? 0x0F : 0x07;
        while (at < count && (bytes[at] & 0xC0) == 0x80) code = code << 6 | (bytes[at++] & 0x3Fu);
        if (code == 0xA9) {
            memcpy(to + made, "(c)", 3);
            made += 3;
            continue;
        }
        to[made++] = letter(code);
    }
    return made;
}

/* Where a line ends: behind its last whole word, or within a word that is longer. */
static size_t line_end(const char *text, size_t count, size_t columns)
{
    size_t end = columns;
    if (count <= columns) return count;
    while (end && text[end] != ' ') end--;
    return end ? end : columns;
}

static unsigned wrap(const char *from, size_t count, unsigned columns, unsigned lines, char *text,
                     size_t room)
{
    size_t used = strlen(text);
    unsigned made = 0;
    while (count && made < lines) {
        size_t end = line_end(from, count, columns);
        if (used + end + 2 > room) break;
        memcpy(text + used, from, end);
        used += end;
        text[used++] = '\n';
        text[used] = 0;
        made++;
        if (end < count && from[end] == ' ') end++;
        from += end;
        count -= end;
    }
    return made;
}

/* 1 when a source before says the same. */
static int is_said(ff_client *client, enum ff_about_entry entry, unsigned source,
                   const uint8_t *value, int bytes)
{
    uint8_t other[VALUE_ROOM];
    while (source-- > 0)
        if (ff_client_source_about(client, source, entry, other, sizeof other) == bytes &&
            !memcmp(other, value, (size_t)bytes))
            return 1;
    return 0;
}

unsigned sim_about_lines(ff_client *client, unsigned columns, unsigned lines, char *text,
                         size_t room)
{
    static const enum ff_about_entry shown[] = { FF_ABOUT_NAME, FF_ABOUT_ATTRIBUTION };
    unsigned made = 0;
    *text = 0;
    for (unsigned i = 0; i < 2 * FF_SOURCES_MAX; i++) {
        enum ff_about_entry entry = shown[i / FF_SOURCES_MAX];
        unsigned source = i % FF_SOURCES_MAX;
        uint8_t value[VALUE_ROOM];
        char letters[VALUE_ROOM];
        int bytes = ff_client_source_about(client, source, entry, value, sizeof value);
        if (bytes <= 0 || is_said(client, entry, source, value, bytes)) continue;
        size_t count = plain(value, (size_t)bytes, letters, sizeof letters);
        made += wrap(letters, count, columns, lines - made, text, room);
    }
    return made;
}
