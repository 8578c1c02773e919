/* The codecs of ff_codec_list.h, by number. */
#include "ff_codec_local.h"

const ff_codec *ff_codec_row(int codec)
{
/* clang-format off */
#define ROW(number, constant, name, needs, head, ways, memory, decode, predict, reconstruct, make, encode) \
    [number] = { name, FF_NEEDS_##needs, memory, decode, predict, reconstruct },
    static const ff_codec rows[FF_CODEC_COUNT] = { FF_CODEC_LIST(ROW) };
#undef ROW
    /* clang-format on */

    return codec >= 0 && codec < FF_CODEC_COUNT ? &rows[codec] : NULL;
}

#ifdef FF_ENCODER
ff_encode_fn *ff_codec_encoder(int codec)
{
/* clang-format off */
#define ROW(number, constant, name, needs, head, ways, memory, decode, predict, reconstruct, make, encode) [number] = encode,
    static ff_encode_fn *const encoders[FF_CODEC_COUNT] = { FF_CODEC_LIST(ROW) };
#undef ROW
    /* clang-format on */

    return codec >= 0 && codec < FF_CODEC_COUNT ? encoders[codec] : NULL;
}

ff_make_fn *ff_codec_maker(int codec)
{
/* clang-format off */
#define ROW(number, constant, name, needs, head, ways, memory, decode, predict, reconstruct, make, encode) [number] = make,
    static ff_make_fn *const makers[FF_CODEC_COUNT] = { FF_CODEC_LIST(ROW) };
#undef ROW
    /* clang-format on */

    return codec >= 0 && codec < FF_CODEC_COUNT ? makers[codec] : NULL;
}

size_t ff_codec_head(int codec)
{
/* clang-format off */
#define ROW(number, constant, name, needs, head, ways, memory, decode, predict, reconstruct, make, encode) [number] = head,
    static const uint8_t heads[FF_CODEC_COUNT] = { FF_CODEC_LIST(ROW) };
#undef ROW
    /* clang-format on */

    return codec >= 0 && codec < FF_CODEC_COUNT ? heads[codec] : 0;
}

unsigned ff_codec_ways(int codec)
{
/* clang-format off */
#define ROW(number, constant, name, needs, head, ways, memory, decode, predict, reconstruct, make, encode) [number] = ways,
    static const uint8_t all[FF_CODEC_COUNT] = { FF_CODEC_LIST(ROW) };
#undef ROW
    /* clang-format on */

    return codec >= 0 && codec < FF_CODEC_COUNT ? all[codec] : 0;
}
#endif
