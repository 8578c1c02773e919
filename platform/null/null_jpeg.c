/* No JPEG: for the blank port, and for builds of other ports that leave it out. */
#include "../sys.h"

int sys_jpeg_decode(const uint8_t *bytes, size_t byte_count, uint32_t width, uint32_t height,
                    uint8_t *rgb)
{
    (void)bytes, (void)byte_count, (void)width, (void)height, (void)rgb;
    return FF_ERR_UNSUPPORTED;
}

int sys_jpeg_encode(const uint8_t *rgb, uint32_t width, uint32_t height, int quality, uint8_t *out,
                    size_t capacity)
{
    (void)rgb, (void)width, (void)height, (void)quality, (void)out, (void)capacity;
    return FF_ERR_UNSUPPORTED;
}
