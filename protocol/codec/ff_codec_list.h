/* The codecs: one row each. Everything else that knows them by number or by name reads this list.
 *
 * A new codec is one row here and one file, ff_codec_NAME.c, with the functions that its row names;
 * besides, a section in SPEC.md and a case in tests/rig/slow_decoder.c.
 *
 *   number       in packs and in WELCOME: 0, 1, 2, ... without gaps, never given to another codec
 *   constant     FF_CODEC_<constant>
 *   name         farfield-bake --codec, farfield-info
 *   needs        enum ff_codec_needs: what decoding needs beyond the payload
 *   head         bytes before the error codes: 0, or 1 of which bits 2-3 are their form; trained,
 *                which tells them in bits of its own, 0
 *   ways         predictions that an encoder has to choose from, ff_residuals.way: 1 or more
 *   memory       bytes of decoder memory it needs, and their setting up (ff_no_memory: none)
 *   decode       a payload to residuals, on the network worker
 *   predict      what the residuals are added to, and their order
 *   reconstruct  residuals and the parent's heights to heights, on the main thread
 *   make         encoder: the closed loop (ff_make_residuals: by `predict`)
 *   encode       encoder: residuals to a payload; both only in builds with FF_ENCODER
 *
 * ff_codec_local.h has the types of the functions. */
#ifndef FF_CODEC_LIST_H
#define FF_CODEC_LIST_H

/* clang-format off */
#define FF_CODEC_LIST(ROW) \
    /*  number, constant, name,      needs,   head, ways, memory,            decode,            predict,            reconstruct,            make,              encode */ \
    ROW(0,      RAW,      "raw",     NOTHING, 0,    1,    ff_no_memory,      ff_raw_decode,     ff_interpolate,     ff_add_residuals,       ff_make_residuals, ff_raw_encode) \
    ROW(1,      DEFLATE,  "deflate", ZLIB,    1,    1,    ff_deflate_memory, ff_deflate_decode, ff_interpolate,     ff_add_residuals,       ff_make_residuals, ff_deflate_encode) \
    ROW(2,      RICE,     "rice",    NOTHING, 1,    1,    ff_no_memory,      ff_rice_decode,    ff_interpolate,     ff_add_residuals,       ff_make_residuals, ff_rice_encode) \
    ROW(3,      TRAINED,  "trained", TRAINED, 0,    2,    ff_no_memory,      ff_trained_decode, ff_trained_predict, ff_trained_reconstruct, ff_trained_make,   ff_trained_encode)

#define ROW(number, constant, name, needs, head, ways, memory, decode, predict, reconstruct, make, encode) FF_CODEC_##constant = number,
enum ff_codec_id { FF_CODEC_LIST(ROW) FF_CODEC_COUNT };
#undef ROW
/* clang-format on */

#endif
