/* Codec "raw": error codes, then every residual as 16 bits (SPEC.md, "Payload, codec 0"). For tests
 * and as the floor of every comparison. */
#include "ff_codec_local.h"

int ff_raw_decode(const ff_decoder *dec, ff_payload *in, const ff_contents *contents,
                  ff_residuals *out)
{
    int rc = ff_take_errors(in, FF_ERRORS_EACH, contents->errors, out);

    FF_ASSERT(contents->count <= ff_refined_side(&dec->info) * ff_refined_side(&dec->info));
    (void)dec;
    return rc == FF_OK ? ff_take_words(in, contents->corners, out->value, contents->count) : rc;
}

#ifdef FF_ENCODER
size_t ff_raw_encode(const ff_terrain_info *info, const uint16_t *parent, const uint16_t *decoded,
                     const ff_contents *contents, const ff_residuals *res, uint8_t *out)
{
    size_t bytes = ff_put_errors(res, FF_ERRORS_EACH, contents->errors, out);

    FF_ASSERT(bytes == contents->errors + (res->filled != 0) + (res->leaf != 0) + (res->stub != 0));
    (void)info, (void)parent, (void)decoded;
    return bytes + ff_put_words(res->value, contents->count, out + bytes);
}
#endif
