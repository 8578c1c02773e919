/* Fills the gaps of a picture smoothly from what is round them, so that neither coding nor
 * filtering brings a foreign colour to its edges. Pure functions. */
#ifndef FF_FAR_FILL_H
#define FF_FAR_FILL_H

#include <stddef.h>
#include <stdint.h>

/* A colour and how much of it there is; 0: none. */
typedef struct ff_far_texel {
    uint16_t rgb_q8[3], weight;
} ff_far_texel;

/* Texels of a picture and of all the smaller ones that filling needs behind it. */
size_t ff_far_fill_texels(uint32_t width, uint32_t height);
/* Gives texels of weight 0 a colour, if any has one. */
void ff_far_fill(ff_far_texel *texel, uint32_t width, uint32_t height);

#endif
