/* JPEG through libjpeg's API. Errors leave by longjmp, never by exit; corrupt data that libjpeg would only warn of and paint
 * grey is an error too: a panorama that is wrong is worse than none. */
#include "../sys.h"

#include <limits.h>
#include <setjmp.h>
#include <stdio.h>

#include <jpeglib.h>

struct guard {
    struct jpeg_error_mgr errors; /* first: libjpeg knows this part */
    jmp_buf leave;
};

static void leave_on_error(j_common_ptr common) { longjmp(((struct guard *)(void *)common->err)->leave, 1); }

static void leave_on_warning(j_common_ptr common, int level)
{
    if (level < 0) leave_on_error(common);
}

static void no_output(j_common_ptr common) { (void)common; }

static struct jpeg_error_mgr *guard_init(struct guard *guard)
{
    jpeg_std_error(&guard->errors);
    guard->errors.error_exit = leave_on_error;
    guard->errors.emit_message = leave_on_warning;
    guard->errors.output_message = no_output;
    return &guard->errors;
}

int sys_jpeg_decode(const uint8_t *bytes, size_t byte_count, uint32_t width, uint32_t height, uint8_t *rgb)
{
    struct jpeg_decompress_struct jpeg = {0};
    struct guard guard;
    volatile int rc = FF_ERR_FORMAT;
    jpeg.err = guard_init(&guard);
    if (setjmp(guard.leave) == 0) {
        jpeg_create_decompress(&jpeg);
        jpeg_mem_src(&jpeg, bytes, (unsigned long)byte_count);
        jpeg_read_header(&jpeg, TRUE);
        if (jpeg.image_width != width || jpeg.image_height != height) {
            rc = FF_ERR_RANGE;
        } else if (!jpeg_has_multiple_scans(&jpeg)) { /* progressive ones need the memory of the whole picture, and any time */
            jpeg.out_color_space = JCS_RGB;
            jpeg.dct_method = JDCT_ISLOW; /* integers, the same result on every machine */
            jpeg_start_decompress(&jpeg);
            while (jpeg.output_scanline < height) {
                JSAMPROW row = rgb + (size_t)jpeg.output_scanline * width * 3;
                jpeg_read_scanlines(&jpeg, &row, 1);
            }
            jpeg_finish_decompress(&jpeg);
            rc = FF_OK;
        }
    }
    jpeg_destroy_decompress(&jpeg);
    return rc;
}

int sys_jpeg_size(const uint8_t *bytes, size_t byte_count, uint32_t *width, uint32_t *height)
{
    struct jpeg_decompress_struct jpeg = {0};
    struct guard guard;
    volatile int rc = FF_ERR_FORMAT;
    jpeg.err = guard_init(&guard);
    if (setjmp(guard.leave) == 0) {
        jpeg_create_decompress(&jpeg);
        jpeg_mem_src(&jpeg, bytes, (unsigned long)byte_count);
        jpeg_read_header(&jpeg, TRUE);
        *width = jpeg.image_width;
        *height = jpeg.image_height;
        rc = FF_OK;
    }
    jpeg_destroy_decompress(&jpeg);
    return rc;
}

/* ---- encoding into the caller's buffer: a full buffer leaves like any error ---- */

struct bounded {
    struct jpeg_destination_mgr manager; /* first: libjpeg knows this part */
    uint8_t *out;
    size_t capacity;
};

static void bounded_init(j_compress_ptr jpeg)
{
    struct bounded *bounded = (struct bounded *)(void *)jpeg->dest;
    bounded->manager.next_output_byte = bounded->out;
    bounded->manager.free_in_buffer = bounded->capacity;
}

static boolean bounded_full(j_compress_ptr jpeg)
{
    leave_on_error((j_common_ptr)jpeg);
    return FALSE;
}

static void bounded_done(j_compress_ptr jpeg) { (void)jpeg; }

int sys_jpeg_encode(const uint8_t *rgb, uint32_t width, uint32_t height, int quality, uint8_t *out, size_t capacity)
{
    if (width == 0 || height == 0 || width > 65500 || height > 65500 || quality < 1 || quality > 100)
        return FF_ERR_ARGUMENT;
    if (capacity == 0) return FF_ERR_FULL;
    if (capacity > INT_MAX) capacity = INT_MAX;
    struct jpeg_compress_struct jpeg = {0};
    struct guard guard;
    struct bounded bounded = {{0}, out, capacity};
    volatile int rc = FF_ERR_FULL;
    jpeg.err = guard_init(&guard);
    if (setjmp(guard.leave) == 0) {
        jpeg_create_compress(&jpeg);
        bounded.manager.init_destination = bounded_init;
        bounded.manager.empty_output_buffer = bounded_full;
        bounded.manager.term_destination = bounded_done;
        jpeg.dest = &bounded.manager;
        jpeg.image_width = width;
        jpeg.image_height = height;
        jpeg.input_components = 3;
        jpeg.in_color_space = JCS_RGB;
        jpeg_set_defaults(&jpeg);
        jpeg.dct_method = JDCT_ISLOW;
        jpeg.optimize_coding = TRUE; /* a few per cent of a slow link for one more pass over the coefficients */
        jpeg_set_quality(&jpeg, quality, TRUE);
        jpeg_start_compress(&jpeg, TRUE);
        while (jpeg.next_scanline < height) {
            JSAMPROW row = (JSAMPROW)(uintptr_t)(rgb + (size_t)jpeg.next_scanline * width * 3);
            jpeg_write_scanlines(&jpeg, &row, 1);
        }
        jpeg_finish_compress(&jpeg);
        rc = (int)(capacity - bounded.manager.free_in_buffer);
    }
    jpeg_destroy_compress(&jpeg);
    return rc;
}
