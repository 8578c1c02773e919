#include "bake_blob.h"

#include "bake_say.h"

#include <stdlib.h>
#include <string.h>

/* Room for `more` entries of `size` bytes behind `count`; the array doubles. */
static void *grow(void *array, size_t count, size_t more, size_t size, size_t *capacity)
{
    if (count + more <= *capacity) return array;
    size_t wanted = *capacity ? *capacity * 2 : 64;
    while (wanted < count + more) wanted *= 2;
    void *grown = realloc(array, wanted * size);
    if (grown) *capacity = wanted;
    return grown;
}

int bake_blob_add(bake_blob *blob, const uint8_t *payload, size_t count)
{
    uint32_t *length = grow(blob->length, blob->record_count, 1, sizeof *length,
                            &blob->record_capacity);
    if (!length) return bake_fail("out of memory");
    blob->length = length;
    if (count > 0) {
        uint8_t *bytes = grow(blob->bytes, blob->byte_count, count, 1, &blob->byte_capacity);
        if (!bytes) return bake_fail("out of memory");
        blob->bytes = bytes;
        memcpy(bytes + blob->byte_count, payload, count);
        blob->byte_count += count;
    }
    length[blob->record_count++] = (uint32_t)count;
    return 0;
}

void bake_blob_clear(bake_blob *blob) { blob->byte_count = blob->record_count = 0; }

void bake_blob_free(bake_blob *blob)
{
    free(blob->bytes);
    free(blob->length);
    *blob = (bake_blob){ 0 };
}
