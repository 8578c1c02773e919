#include "export_gzip.h"

#include "../bake/bake_say.h"

#include <stdlib.h>
#include <zlib.h>

#define GZIP_WINDOW (15 + 16)

uint8_t *export_gzip(const void *plain, size_t plain_count, size_t *count)
{
    size_t room = compressBound((uLong)plain_count) + 64;
    uint8_t *packed = malloc(room);
    z_stream stream = { .next_in = (Bytef *)plain,
                        .avail_in = (uInt)plain_count,
                        .next_out = packed,
                        .avail_out = (uInt)room };
    if (!packed ||
        deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, GZIP_WINDOW, 8, Z_DEFAULT_STRATEGY)) {
        free(packed);
        bake_fail("out of memory");
        return NULL;
    }
    (void)deflate(&stream, Z_FINISH); /* there is room for all of it */
    *count = stream.total_out;
    deflateEnd(&stream);
    return packed;
}
