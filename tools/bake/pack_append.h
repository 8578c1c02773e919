/* Records on their way into a pack one by one, in the order of each section. */
#ifndef PACK_APPEND_H
#define PACK_APPEND_H

#include "pack_writer.h"

typedef struct pack_append {
    pack_writer *writer;                  /* opened, closed and finished by whoever appends */
    bake_blob blob[FF_PACK_SECTIONS_MAX]; /* to be written together */
} pack_append;

/* Gives the next place of a section its record; `bytes` 0: it has none. 0 or -1 (said). */
int pack_append_add(pack_append *append, uint32_t section, const uint8_t *payload, size_t bytes);
/* Writes what waits, when no more records come. 0 or -1 (said). */
int pack_append_end(pack_append *append);
void pack_append_close(pack_append *append);

#endif
