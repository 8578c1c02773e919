/* Bare JPEGs (protocol/SPEC.md, "Images") through libjpeg's API. Its abbreviated format leaves the
 * tables out; this file strips the few headers that remain, and puts them back for decoding. Errors
 * leave by longjmp, never by exit. Corrupt data, which libjpeg would only warn of and paint grey,
 * is an error too: a wrong panorama is worse than none. */
#include "../sys.h"
#include "jpeg_tables.h"

#include <limits.h>
#include <setjmp.h>
#include <stdio.h>
#include <string.h>

#include <jpeglib.h>

#define SIDE_MAX 65500

struct guard {
    struct jpeg_error_mgr errors; /* first: libjpeg knows this part */
    jmp_buf leave;
};

static void leave_on_error(j_common_ptr common)
{
    longjmp(((struct guard *)(void *)common->err)->leave, 1);
}

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

/* ---- decoding: headers, the caller's bytes and the end marker, one after the other ---- */

#define HEADER_BYTES 35

struct pieces {
    struct jpeg_source_mgr manager; /* first: libjpeg knows this part */
    struct {
        const uint8_t *bytes;
        size_t count;
    } piece[3];
    unsigned next;
};

/* Makes the headers of image, frame and scan: all bare images share them, but for the size. */
static void make_header(uint8_t header[HEADER_BYTES], uint32_t width, uint32_t height)
{
    static const uint8_t usual[HEADER_BYTES] = { 0xFF, 0xD8, 0xFF, 0xC0, 0,    17, 8,  0,    0,
                                                 0,    0,    3,    1,    0x22, 0,  2,  0x11, 1,
                                                 3,    0x11, 1,    0xFF, 0xDA, 0,  12, 3,    1,
                                                 0,    2,    0x11, 3,    0x11, 0,  63, 0 };
    memcpy(header, usual, sizeof usual);
    header[7] = (uint8_t)(height >> 8);
    header[8] = (uint8_t)height;
    header[9] = (uint8_t)(width >> 8);
    header[10] = (uint8_t)width;
}

static void no_source(j_decompress_ptr jpeg) { (void)jpeg; }

static boolean next_piece(j_decompress_ptr jpeg)
{
    struct pieces *pieces = (struct pieces *)(void *)jpeg->src;
    if (pieces->next == 3) leave_on_error((j_common_ptr)jpeg);
    pieces->manager.next_input_byte = pieces->piece[pieces->next].bytes;
    pieces->manager.bytes_in_buffer = pieces->piece[pieces->next++].count;
    return TRUE;
}

static void skip_bytes(j_decompress_ptr jpeg, long count)
{
    if (count > 0) /* no header of ours has anything to skip */
        leave_on_error((j_common_ptr)jpeg);
}

static void set_source(j_decompress_ptr jpeg, struct pieces *pieces, const uint8_t *header,
                       const uint8_t *scan, size_t scan_bytes)
{
    static const uint8_t end[2] = { 0xFF, 0xD9 };
    pieces->manager = (struct jpeg_source_mgr){ .init_source = no_source,
                                                .fill_input_buffer = next_piece,
                                                .skip_input_data = skip_bytes,
                                                .resync_to_restart = jpeg_resync_to_restart,
                                                .term_source = no_source };
    pieces->piece[0].bytes = header;
    pieces->piece[0].count = HEADER_BYTES;
    pieces->piece[1].bytes = scan;
    pieces->piece[1].count = scan_bytes;
    pieces->piece[2].bytes = end;
    pieces->piece[2].count = sizeof end;
    pieces->next = 0;
    jpeg->src = &pieces->manager;
}

/* 1 when the scan has no markers: they could bring tables, restarts, other scans. */
static int is_plain_scan(const uint8_t *bytes, size_t count)
{
    if (count == 0 || bytes[count - 1] == 0xFF) return 0;
    for (size_t i = 0; i + 1 < count; i++)
        if (bytes[i] == 0xFF && bytes[i + 1] != 0) return 0;
    return 1;
}

static void read_image(j_decompress_ptr jpeg, int quality, uint8_t *rgb)
{
    jpeg_tables_set(jpeg, quality);
    jpeg_read_header(jpeg, TRUE);
    jpeg->out_color_space = JCS_RGB;
    jpeg->dct_method = JDCT_ISLOW; /* integers, the same result on every machine */
    jpeg_start_decompress(jpeg);
    while (jpeg->output_scanline < jpeg->output_height) {
        JSAMPROW row = rgb + (size_t)jpeg->output_scanline * jpeg->output_width * 3;
        jpeg_read_scanlines(jpeg, &row, 1);
    }
    jpeg_finish_decompress(jpeg);
}

int sys_jpeg_decode(const uint8_t *bytes, size_t byte_count, uint32_t width, uint32_t height,
                    uint8_t *rgb)
{
    if (width == 0 || height == 0 || width > SIDE_MAX || height > SIDE_MAX) return FF_ERR_ARGUMENT;
    if (byte_count < 2 || bytes[0] < 1 || bytes[0] > 100 ||
        !is_plain_scan(bytes + 1, byte_count - 1))
        return FF_ERR_FORMAT;
    struct jpeg_decompress_struct jpeg = { 0 };
    struct guard guard;
    struct pieces pieces;
    uint8_t header[HEADER_BYTES];
    volatile int rc = FF_ERR_FORMAT;
    make_header(header, width, height);
    jpeg.err = guard_init(&guard);
    if (setjmp(guard.leave) == 0) {
        jpeg_create_decompress(&jpeg);
        set_source(&jpeg, &pieces, header, bytes + 1, byte_count - 1);
        read_image(&jpeg, bytes[0], rgb);
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

/* Moves the scan of a whole JPEG to the JPEG's beginning. Returns its length, 0 when there is
 * none. */
static size_t bare_scan(uint8_t *jpeg, size_t count)
{
    size_t at = 2;
    while (at + 4 <= count && jpeg[at] == 0xFF) {
        uint8_t marker = jpeg[at + 1];
        at += 2 + (size_t)(jpeg[at + 2] << 8 | jpeg[at + 3]);
        if (marker != 0xDA) continue;
        if (at + 2 > count) return 0;
        memmove(jpeg, jpeg + at, count - at - 2);
        return count - at - 2;
    }
    return 0;
}

int sys_jpeg_encode(const uint8_t *rgb, uint32_t width, uint32_t height, int quality, uint8_t *out,
                    size_t capacity)
{
    if (width == 0 || height == 0 || width > SIDE_MAX || height > SIDE_MAX || quality < 1 ||
        quality > 100)
        return FF_ERR_ARGUMENT;
    if (capacity < 2) return FF_ERR_FULL;
    if (capacity > INT_MAX) capacity = INT_MAX;
    struct jpeg_compress_struct jpeg = { 0 };
    struct guard guard;
    struct bounded bounded = { { 0 }, out + 1, capacity - 1 };
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
        jpeg_set_quality(&jpeg, quality, TRUE);
        jpeg.write_JFIF_header = FALSE;
        jpeg_suppress_tables(&jpeg, TRUE);
        jpeg_start_compress(&jpeg, FALSE);
        while (jpeg.next_scanline < height) {
            JSAMPROW row = (JSAMPROW)(uintptr_t)(rgb + (size_t)jpeg.next_scanline * width * 3);
            jpeg_write_scanlines(&jpeg, &row, 1);
        }
        jpeg_finish_compress(&jpeg);
        out[0] = (uint8_t)quality;
        rc = 1 + (int)bare_scan(out + 1, capacity - 1 - bounded.manager.free_in_buffer);
    }
    jpeg_destroy_compress(&jpeg);
    return rc;
}
