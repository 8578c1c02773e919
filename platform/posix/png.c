/* PNG writing through libpng: encoded in memory, then written at once by sys_write_file, so no half picture stays behind. */
#include "../sys.h"

#include <png.h>
#include <stdlib.h>
#include <string.h>

int sys_png_write(const char *path, const uint8_t *rgb, uint32_t width, uint32_t height)
{
    png_image image;
    memset(&image, 0, sizeof image);
    image.version = PNG_IMAGE_VERSION;
    image.width = width;
    image.height = height;
    image.format = PNG_FORMAT_RGB;
    if (width == 0 || height == 0 || width > 65535 || height > 65535) return FF_ERR_ARGUMENT;
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
    uint8_t *bytes = malloc(size);
    if (!bytes) return FF_ERR_MEMORY;
    int rc = FF_ERR_SYSTEM;
    if (png_image_write_to_memory(&image, bytes, &size, 0, rgb, 0, NULL)) rc = sys_write_file(path, bytes, size);
    png_image_free(&image);
    free(bytes);
    return rc;
}
