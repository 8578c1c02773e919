/* Lists of (type, length, value): the parts of the formats that grow. A pack's words about itself
 * are one, and so are CAPS, WELCOME and ABOUT (SPEC.md, "Lists"). Whoever does not know a type
 * skips its entry.
 */
#ifndef FF_LIST_H
#define FF_LIST_H

#include "ff_bytes.h"

/* Entries one after the other; the bytes belong to someone else. */
typedef struct ff_list {
    const uint8_t *bytes;
    uint32_t byte_count;
} ff_list;

typedef struct ff_list_entry {
    uint8_t type; /* 1..255 */
    const uint8_t *value;
    uint32_t byte_count;
} ff_list_entry;

/* How long the values of a type may be. */
typedef struct ff_list_rule {
    uint8_t type;
    uint16_t least, most;
} ff_list_rule;

/* Takes the first entry off the front of `rest`: 1, 0 at the end, or a negative error: TRUNCATED,
 * RANGE. */
int ff_list_next(ff_list *rest, ff_list_entry *entry);
/* Whether a list keeps the form: types above 0, ascending, each once, and the lengths of those that
 * stand in `rule`. FF_OK, TRUNCATED or RANGE. */
int ff_list_check(ff_list list, const ff_list_rule *rule, unsigned rules);
/* The value of a type: its bytes, or FF_ERR_NOT_FOUND. */
int ff_list_find(ff_list list, unsigned type, const uint8_t **value);
void ff_list_write(ff_writer *out, unsigned type, const uint8_t *value, uint32_t byte_count);

#endif
