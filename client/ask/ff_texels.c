#include "ff_texels.h"

void ff_texels_bleed(uint16_t *texel, unsigned width, unsigned height)
{
    for (unsigned y = 0; y < height; y++)
        for (unsigned x = 0; x < width; x++) {
            uint16_t *here = texel + (size_t)y * width + x;
            if (*here & 1u) continue;
            uint16_t beside = 0;
            if (x > 0 && here[-1] & 1u)
                beside = here[-1];
            else if (x + 1 < width && here[1] & 1u)
                beside = here[1];
            else if (y > 0 && here[-(ptrdiff_t)width] & 1u)
                beside = here[-(ptrdiff_t)width];
            else if (y + 1 < height && here[width] & 1u)
                beside = here[width];
            if (beside) *here = (uint16_t)(beside & ~1u);
        }
}
