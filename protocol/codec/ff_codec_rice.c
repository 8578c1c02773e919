/* Codec "rice": a head and a body without the form DEFLATE (ff_body.h), so high parts are always in
 * unary, which makes a Golomb-Rice code: for devices without zlib. */
#include "ff_body.h"

int ff_rice_decode(const ff_decoder *dec, ff_payload *in, const ff_contents *contents,
                   ff_residuals *out)
{
    return ff_take_body(dec, in, contents, NULL, out);
}

#ifdef FF_ENCODER
size_t ff_rice_encode(const ff_terrain_info *info, const uint16_t *parent, const uint16_t *decoded,
                      const ff_contents *contents, const ff_residuals *res, uint8_t *out)
{
    (void)parent, (void)decoded;
    return ff_put_body(info, contents, res, NULL, out);
}
#endif
