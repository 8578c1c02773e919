/* Any bytes as a bare JPEG. Bytes 0 and 1: width and height, 1..256. An input that decodes gives
 * the same picture when decoded again. */
#include "../../platform/sys.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    if (count < 2) return 0;
    uint32_t width = bytes[0] + 1u, height = bytes[1] + 1u;
    size_t rgb_bytes = (size_t)3 * width * height;
    uint8_t *rgb = malloc(rgb_bytes), *again = malloc(rgb_bytes);
    assert(rgb && again);
    if (sys_jpeg_decode(bytes + 2, count - 2, width, height, rgb) == FF_OK) {
        assert(sys_jpeg_decode(bytes + 2, count - 2, width, height, again) == FF_OK);
        assert(memcmp(rgb, again, rgb_bytes) == 0);
    }
    free(rgb);
    free(again);
    return 0;
}
