#include "pack_append.h"

#define FLUSH_BYTES   (1u << 16)
#define FLUSH_RECORDS (1u << 14)

static int flush(pack_append *append, uint32_t section)
{
    int rc = pack_writer_add(append->writer, section, &append->blob[section], NULL);
    bake_blob_clear(&append->blob[section]);
    return rc;
}

int pack_append_add(pack_append *append, uint32_t section, const uint8_t *payload, size_t bytes)
{
    bake_blob *blob = &append->blob[section];
    if (bake_blob_add(blob, payload, bytes)) return -1;
    return blob->byte_count > FLUSH_BYTES || blob->record_count > FLUSH_RECORDS
               ? flush(append, section)
               : 0;
}

int pack_append_end(pack_append *append)
{
    for (uint32_t s = 0; s < append->writer->section_count; s++)
        if (flush(append, s)) return -1;
    return 0;
}

void pack_append_close(pack_append *append)
{
    for (uint32_t s = 0; s < FF_PACK_SECTIONS_MAX; s++) bake_blob_free(&append->blob[s]);
}
