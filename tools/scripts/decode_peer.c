/* decode_peer PEER FILE WIDTH HEIGHT: decodes a grid of heights that another codec has packed (see
 * codec_peers.py) from memory to memory, for bench_codec.py: linked with Debian's own libraries for
 * armel, counted by tcg_count.c. What is decoding lies in the phase "work". Prints how many heights
 * there are, and their sum. */
#include "count_marks.h"

#include <charls/charls.h>
#include <jxl/decode.h>
#include <Lerc_c_api.h>
#include <openjpeg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LERC_USHORT 3

typedef struct packed {
    uint8_t *bytes;
    size_t count, read; /* JPEG 2000: what its reader has taken */
    unsigned width, height;
} packed;

/* Each: 0 when `heights` are there. */

static int jpeg_ls(packed *in, uint16_t *heights, size_t bytes)
{
    charls_jpegls_decoder *decoder = charls_jpegls_decoder_create();
    return !decoder || charls_jpegls_decoder_set_source_buffer(decoder, in->bytes, in->count) ||
           charls_jpegls_decoder_read_header(decoder) ||
           charls_jpegls_decoder_decode_to_buffer(decoder, heights, bytes, 0);
}

static int lerc(packed *in, uint16_t *heights, size_t bytes)
{
    (void)bytes;
    return (int)lerc_decode(in->bytes, (unsigned)in->count, 0, NULL, 1, (int)in->width,
                            (int)in->height, 1, LERC_USHORT, heights);
}

static OPJ_SIZE_T read_more(void *out, OPJ_SIZE_T bytes, void *context)
{
    packed *in = context;
    size_t left = in->count - in->read;
    if (!left) return (OPJ_SIZE_T)-1;
    if (bytes > left) bytes = left;
    memcpy(out, in->bytes + in->read, bytes);
    in->read += bytes;
    return bytes;
}

static int jpeg_2000(packed *in, uint16_t *heights, size_t bytes)
{
    opj_dparameters_t parameters;
    opj_image_t *image = NULL;
    opj_codec_t *codec = opj_create_decompress(OPJ_CODEC_J2K);
    opj_stream_t *stream = opj_stream_create(in->count, OPJ_TRUE);
    opj_set_default_decoder_parameters(&parameters);
    opj_stream_set_read_function(stream, read_more);
    opj_stream_set_user_data(stream, in, NULL);
    opj_stream_set_user_data_length(stream, in->count);
    if (!opj_setup_decoder(codec, &parameters) || !opj_read_header(stream, codec, &image) ||
        !opj_decode(codec, stream, image))
        return 1;
    for (size_t i = 0; i < bytes / 2; i++) heights[i] = (uint16_t)image->comps[0].data[i];
    return 0;
}

static int jpeg_xl(packed *in, uint16_t *heights, size_t bytes)
{
    const JxlPixelFormat format = { 1, JXL_TYPE_UINT16, JXL_NATIVE_ENDIAN, 0 };
    JxlDecoder *decoder = JxlDecoderCreate(NULL);
    if (JxlDecoderSubscribeEvents(decoder, JXL_DEC_FULL_IMAGE) ||
        JxlDecoderSetInput(decoder, in->bytes, in->count))
        return 1;
    JxlDecoderCloseInput(decoder);
    for (;;) {
        JxlDecoderStatus status = JxlDecoderProcessInput(decoder);
        if (status == JXL_DEC_FULL_IMAGE) return 0;
        if (status != JXL_DEC_NEED_IMAGE_OUT_BUFFER ||
            JxlDecoderSetImageOutBuffer(decoder, &format, heights, bytes))
            return 1;
    }
}

static const struct peer {
    const char *name;
    int (*decode)(packed *in, uint16_t *heights, size_t bytes);
} peer[] = { { "JPEG-LS", jpeg_ls },
             { "LERC", lerc },
             { "JPEG 2000", jpeg_2000 },
             { "JPEG XL", jpeg_xl } };

static int fail(const char *what)
{
    fprintf(stderr, "decode_peer: %s\n", what);
    return 1;
}

static int read_file(const char *path, packed *in)
{
    FILE *file = fopen(path, "rb");
    if (!file || fseek(file, 0, SEEK_END)) return -1;
    in->count = (size_t)ftell(file);
    rewind(file);
    in->bytes = malloc(in->count);
    return in->bytes && fread(in->bytes, 1, in->count, file) == in->count ? 0 : -1;
}

int main(int argc, char **argv)
{
    packed in = { 0 };
    unsigned long long sum = 0;
    if (argc != 5 || read_file(argv[2], &in)) return fail("decode_peer PEER FILE WIDTH HEIGHT");
    in.width = (unsigned)atoi(argv[3]);
    in.height = (unsigned)atoi(argv[4]);
    size_t count = (size_t)in.width * in.height;
    uint16_t *heights = malloc(2 * count);
    handheld_mark_start();
    for (size_t i = 0; i < sizeof peer / sizeof *peer; i++) {
        if (strcmp(argv[1], peer[i].name)) continue;
        handheld_mark_work();
        int failed = peer[i].decode(&in, heights, 2 * count);
        handheld_mark_outside();
        if (failed) return fail("it cannot be decoded");
        for (size_t j = 0; j < count; j++) sum += heights[j];
        printf("heights %zu\nsum %llu\n", count, sum);
        return 0;
    }
    return fail("no such peer");
}
