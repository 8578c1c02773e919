/* Records of a tile, or of a part of it, in one section, waiting for their turn to be written. */
#ifndef BAKE_BLOB_H
#define BAKE_BLOB_H

#include <stddef.h>
#include <stdint.h>

typedef struct bake_blob {
    uint8_t *bytes;
    size_t byte_count, byte_capacity;
    uint32_t *length; /* of each record */
    size_t record_count, record_capacity;
} bake_blob;

/* Appends one record; `count` 0: there is none at this place. 0 or -1 (said). */
int bake_blob_add(bake_blob *blob, const uint8_t *payload, size_t count);
/* Empties the blob, and keeps its memory. */
void bake_blob_clear(bake_blob *blob);
void bake_blob_free(bake_blob *blob);

#endif
