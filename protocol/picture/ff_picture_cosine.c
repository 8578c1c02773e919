/* The cosine transform of eight, in integers whose rows are as long as each other but for one in a
 * thousand (the same numbers as in H.265). */
#include "ff_picture_local.h"

/* out[x] = sum over u of in[u] M[u][x], `apart` each from the next. */
static void turn(const int32_t *in, unsigned apart, int32_t out[8])
{
    int32_t e0 = 64 * (in[0] + in[4 * apart]), e1 = 64 * (in[0] - in[4 * apart]),
            f0 = 83 * in[2 * apart] + 36 * in[6 * apart],
            f1 = 36 * in[2 * apart] - 83 * in[6 * apart];
    int32_t a = in[apart], b = in[3 * apart], c = in[5 * apart], d = in[7 * apart];
    const int32_t even[4] = { e0 + f0, e1 + f1, e1 - f1, e0 - f0 };
    const int32_t odd[4] = { 89 * a + 75 * b + 50 * c + 18 * d, 75 * a - 18 * b - 89 * c - 50 * d,
                             50 * a - 89 * b + 18 * c + 75 * d, 18 * a - 50 * b + 75 * c - 89 * d };
    for (unsigned x = 0; x < 4; x++) {
        out[x] = even[x] + odd[x];
        out[7 - x] = even[x] - odd[x];
    }
}

void ff_picture_block(const int16_t coefficient[64], int32_t left[64])
{
    int32_t in[64], out[8];
    for (unsigned v = 0; v < 8; v++) { /* rows without any stay 0 */
        int32_t any = 0;
        for (unsigned u = 0; u < 8; u++) {
            in[8 * v + u] = coefficient[8 * v + u];
            any |= in[8 * v + u];
        }
        if (!any) continue;
        turn(in + 8 * v, 1, out);
        for (unsigned x = 0; x < 8; x++) in[8 * v + x] = (out[x] + 64) >> 7;
    }
    for (unsigned x = 0; x < 8; x++) {
        turn(in + x, 8, out);
        for (unsigned y = 0; y < 8; y++) left[8 * y + x] = (out[y] + 2048) >> 12;
    }
}

void ff_picture_line(const int16_t coefficient[8], int32_t left[8])
{
    int32_t in[8];
    for (unsigned u = 0; u < 8; u++) in[u] = (coefficient[u] * 181 + 128) >> 8;
    turn(in, 1, left);
    for (unsigned x = 0; x < 8; x++) left[x] = (left[x] + 1024) >> 11;
}
