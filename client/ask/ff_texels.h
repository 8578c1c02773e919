/* Texels of paint that arrive, as RGBA5551: faces and sectors alike. */
#ifndef FF_TEXELS_H
#define FF_TEXELS_H

#include <stddef.h>
#include <stdint.h>

/* Rounded: cut off, the whole picture would be darker. */
static inline unsigned ff_texel_of_31(unsigned of_255) { return (of_255 * 31 + 127) / 255; }

static inline uint16_t ff_texel_5551(const uint8_t rgb[3], unsigned opaque)
{
    return (uint16_t)(ff_texel_of_31(rgb[0]) << 11 | ff_texel_of_31(rgb[1]) << 6 |
                      ff_texel_of_31(rgb[2]) << 1 | opaque);
}

/* Gives transparent texels beside opaque ones their colour: filtering mixes both, and black would
 * draw a dark line along a horizon. */
void ff_texels_bleed(uint16_t *texel, unsigned width, unsigned height);

#endif
