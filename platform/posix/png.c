/* PNG through libpng. Writing: encoded in memory, then written at once by sys_write_file, so no
 * half picture stays behind. */
#include "../sys.h"

#include <png.h>
#include <stdlib.h>
#include <string.h>

#define READ_PIXELS_MAX (UINT32_C(1) << 26)

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
    if (png_image_write_to_memory(&image, bytes, &size, 0, rgb, 0, NULL))
        rc = sys_write_file(path, bytes, size);
    png_image_free(&image);
    free(bytes);
    return rc;
}

static int read_mapped(const sys_mapping *mapping, png_image *image, uint8_t **rgb)
{
    if (!png_image_begin_read_from_memory(image, mapping->bytes, (size_t)mapping->size))
        return FF_ERR_FORMAT;
    if ((uint64_t)image->width * image->height > READ_PIXELS_MAX) return FF_ERR_RANGE;
    image->format = PNG_FORMAT_RGB;
    uint8_t *bytes = malloc(PNG_IMAGE_SIZE(*image));
    if (!bytes) return FF_ERR_MEMORY;
    const png_color black = { 0, 0, 0 };
    if (!png_image_finish_read(image, &black, bytes, 0, NULL)) {
        free(bytes);
        return FF_ERR_FORMAT;
    }
    *rgb = bytes;
    return FF_OK;
}

int sys_png_read(const char *path, uint8_t **rgb, uint32_t *width, uint32_t *height)
{
    sys_mapping mapping;
    png_image image;
    memset(&image, 0, sizeof image);
    image.version = PNG_IMAGE_VERSION;
    int rc = sys_map_file(path, &mapping);
    if (rc < 0) return rc;
    rc = read_mapped(&mapping, &image, rgb);
    *width = image.width;
    *height = image.height;
    png_image_free(&image);
    sys_unmap_file(&mapping);
    return rc;
}
