#include "c3d_backend.h"

uint32_t c3d_strip_edges(const uint16_t *indices, uint32_t count, uint16_t *edges,
                         uint32_t *triangles)
{
    uint32_t written = 0;
    int previous_drawn = 0; /* 1: the previous triangle's last edge is this one's first */
    *triangles = 0;
    for (uint32_t i = 2; i < count; i++) {
        uint16_t a = indices[i - 2], b = indices[i - 1], c = indices[i];
        int drawn = a != b && b != c && a != c;
        const uint16_t pairs[6] = { a, b, b, c, a, c };
        for (int j = previous_drawn ? 2 : 0; drawn && j < 6; j++) edges[written++] = pairs[j];
        *triangles += (uint32_t)drawn;
        previous_drawn = drawn;
    }
    /* three edges of the first triangle of a run, two of each after it */
    C3D_ASSERT(written >= 4 * *triangles && written <= 6 * *triangles);
    C3D_ASSERT(*triangles + 2 <= count && written <= 4 * count);
    return written;
}
