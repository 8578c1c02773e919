/* The encoder's half of pictures: from texels to numbers. For tools. */
#ifdef FF_ENCODER

#include "ff_picture_local.h"

#define DEAD_256 82 /* of a step, besides its half, that becomes 0: 0.32 */

static const int8_t matrix[8][8] = {
    { 64, 64, 64, 64, 64, 64, 64, 64 },     { 89, 75, 50, 18, -18, -50, -75, -89 },
    { 83, 36, -36, -83, -83, -36, 36, 83 }, { 75, -18, -89, -50, 50, 89, 18, -75 },
    { 64, -64, -64, 64, 64, -64, -64, 64 }, { 50, -89, 18, 75, -75, -18, 89, -50 },
    { 36, -83, 83, -36, -36, 83, -83, 36 }, { 18, -50, 75, -89, 89, -75, 50, -18 }
};

/* Steps of `size`, in 2^shift of a sixteenth. */
static int32_t steps_of(int64_t size, unsigned shift, int32_t step_q4, int dead_256)
{
    int64_t whole = (int64_t)step_q4 << shift, away = size < 0 ? -size : size;
    int32_t steps = (int32_t)((away + whole / 2 - whole * dead_256 / 512) / whole);
    return size < 0 ? -steps : steps;
}

/* What is left of a texel, times 4: Y, Co, Cg. */
static void left_of(const ff_picture *p, unsigned x, unsigned y, const uint8_t expected[3],
                    int32_t left[3])
{
    const uint8_t *rgb = p->source + ff_picture_at(p, x, y);
    int32_t r = rgb[0] - expected[0], g = rgb[1] - expected[1], b = rgb[2] - expected[2];
    left[0] = r + 2 * g + b;
    left[1] = 2 * (r - b);
    left[2] = 2 * g - r - b;
}

void ff_picture_count_corner(const ff_picture *p, ff_picture_part part, uint8_t expected[64][3],
                             int32_t value[3][64])
{
    int32_t left[3];
    left_of(p, part.x, part.y, expected[0], left);
    for (unsigned c = 0; c < 3; c++)
        value[c][0] = steps_of((int64_t)left[c] * 4 * (1 << FF_PICTURE_CORNER_FINER), 0,
                               p->step_q4[c], 0);
}

/* Texels that are coded otherwise count as the next that is not. */
static unsigned next_inside(unsigned at, unsigned first, unsigned last, unsigned side)
{
    if (at == 0) at = 1;
    if (at == side - 1) at = side - 2;
    FF_ASSERT(at >= first && at <= last);
    (void)first, (void)last;
    return at;
}

void ff_picture_count_line(const ff_picture *p, ff_picture_part part, uint8_t expected[64][3],
                           int32_t value[3][64])
{
    unsigned upright = part.height > 1, from = upright ? part.y : part.x;
    int32_t left[8][3];
    for (unsigned i = 0; i < 8; i++) {
        unsigned at = next_inside(from + i, from, from + 7, p->side);
        left_of(p, upright ? part.x : at, upright ? at : part.y, expected[at - from], left[i]);
    }
    for (unsigned c = 0; c < 3; c++)
        for (unsigned u = 0; u < 8; u++) {
            int64_t sum = 0;
            for (unsigned i = 0; i < 8; i++) sum += matrix[u][i] * left[i][c];
            /* sixteenths: of 4 * 181.02 times as much, and 181.02 is 2^15 / 181.02 */
            value[c][u] = u ? steps_of(sum * 4 * 181, FF_PICTURE_ONE_LOG2, p->step_q4[c], DEAD_256)
                            : steps_of(sum * 4 * 181 * (1 << FF_PICTURE_MEAN_FINER),
                                       FF_PICTURE_ONE_LOG2, p->step_q4[c], 0);
        }
}

void ff_picture_count_block(const ff_picture *p, ff_picture_part part, uint8_t expected[64][3],
                            int32_t value[3][64])
{
    int32_t left[64][3];
    for (unsigned i = 0; i < 64; i++) {
        unsigned x = next_inside(part.x + i % 8, part.x, part.x + 7, p->side),
                 y = next_inside(part.y + i / 8, part.y, part.y + 7, p->side);
        left_of(p, x, y, expected[(y - part.y) * 8 + x - part.x], left[i]);
    }
    ff_picture_steps(p, left, DEAD_256, value);
}

void ff_picture_coefficients(int32_t left[64][3], int64_t whole[3][64])
{
    int32_t half[64];
    for (unsigned c = 0; c < 3; c++) {
        for (unsigned y = 0; y < 8; y++)
            for (unsigned u = 0; u < 8; u++) {
                half[8 * y + u] = 0;
                for (unsigned x = 0; x < 8; x++)
                    half[8 * y + u] += matrix[u][x] * left[8 * y + x][c];
            }
        for (unsigned v = 0; v < 8; v++)
            for (unsigned u = 0; u < 8; u++) {
                int64_t sum = 0;
                for (unsigned y = 0; y < 8; y++) sum += (int64_t)matrix[v][y] * half[8 * y + u];
                whole[c][8 * v + u] = sum * 4;
            }
    }
}

void ff_picture_steps(const ff_picture *p, int32_t left[64][3], int dead_256, int32_t value[3][64])
{
    int64_t whole[3][64];
    ff_picture_coefficients(left, whole);
    for (unsigned c = 0; c < 3; c++)
        for (unsigned z = 0; z < 64; z++)
            value[c][z] = steps_of(whole[c][z], FF_PICTURE_ONE_LOG2, p->step_q4[c], dead_256);
}

int ff_picture_put(const ff_picture_tables *by, const ff_picture_eye *eye, const uint8_t *source,
                   unsigned log2, ff_picture_above above, unsigned quality, ff_picture_room *room,
                   uint8_t *rgb, uint8_t *out, size_t limit)
{
    ff_range_writer to;
    ff_picture p = { .by = by, .eye = eye, .room = room, .rgb = rgb, .source = source, .to = &to };
    if (limit < 1) return FF_ERR_FULL;
    int rc = ff_picture_begin(&p, log2, quality, above);
    if (rc != FF_OK) return FF_ERR_ARGUMENT;
    *out = (uint8_t)quality;
    ff_range_write(&to, out + 1, limit - 1);
    ff_picture_go(&p);
    int bytes = ff_range_end(&to);
    return bytes < 0 ? FF_ERR_FULL : 1 + bytes;
}

int ff_picture_encode(const uint8_t *source, unsigned log2, ff_picture_above above,
                      unsigned quality, ff_picture_room *room, uint8_t *rgb, uint8_t *out,
                      size_t limit)
{
    return ff_picture_put(&ff_picture_learned, NULL, source, log2, above, quality, room, rgb, out,
                          limit);
}

#else
typedef int ff_picture_put_not_built; /* ISO C wants a declaration in every file */
#endif
