#include "bake_json.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static size_t write_utf8(uint32_t code, char *to)
{
    if (code < 0x80) return to[0] = (char)code, 1;
    if (code < 0x800) {
        to[0] = (char)(0xc0 | code >> 6);
        to[1] = (char)(0x80 | (code & 0x3f));
        return 2;
    }
    to[0] = (char)(0xe0 | code >> 12);
    to[1] = (char)(0x80 | (code >> 6 & 0x3f));
    to[2] = (char)(0x80 | (code & 0x3f));
    return 3;
}

/* The character behind a backslash: *at is moved behind it. */
static uint32_t escaped(const char **at)
{
    char digits[5] = { 0 };
    char c = **at;
    *at += c != 0;
    if (c == 'n' || c == 't' || c == 'r' || c == 'b' || c == 'f') return ' ';
    if (c != 'u') return (unsigned char)c;
    for (int i = 0; i < 4 && **at; i++) digits[i] = *(*at)++;
    uint32_t code = (uint32_t)strtoul(digits, NULL, 16);
    return code >> 11 == 0x1b || !code ? '?' : code; /* halves of pairs are not put together */
}

/* The text that begins behind a quote: its end, behind the other quote. `to` NULL: not kept. 0 in
 * *room: it was too long. */
static const char *read_text(const char *at, char *to, size_t *room)
{
    while (*at && *at != '"') {
        uint32_t code = (unsigned char)*at++;
        int is_escape = code == '\\';
        if (is_escape) code = escaped(&at);
        if (!to) continue;
        if (*room < 5) {
            *room = 0;
            to = NULL;
            continue;
        }
        size_t count = is_escape ? write_utf8(code, to) : (*to = (char)code, 1);
        to += count;
        *room -= count;
    }
    if (to) *to = 0;
    return *at ? at + 1 : at;
}

void bake_json_text(const char *json, const char *name, char *value, size_t room)
{
    char found[64];
    char *copy = malloc(room);
    int depth = 0;
    for (const char *at = json; copy && *at;) {
        char c = *at++;
        size_t left = sizeof found;
        depth += c == '{' || c == '[';
        depth -= c == '}' || c == ']';
        if (c != '"') continue;
        at = read_text(at, found, &left);
        const char *next = at + strspn(at, " \t\r\n");
        if (depth != 1 || *next != ':' || !left || strcmp(found, name)) continue;
        next += 1 + strspn(next + 1, " \t\r\n");
        left = room;
        if (*next != '"') continue;
        at = read_text(next + 1, copy, &left);
        if (left) snprintf(value, room, "%s", copy);
        break;
    }
    free(copy);
}
