/* Bytes in gzip. */
#ifndef EXPORT_GZIP_H
#define EXPORT_GZIP_H

#include <stddef.h>
#include <stdint.h>

/* Memory to be freed, of *count bytes, or NULL (said). */
uint8_t *export_gzip(const void *plain, size_t plain_count, size_t *count);

#endif
