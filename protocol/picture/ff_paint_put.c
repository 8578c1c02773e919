/* The encoder's half of paint: for tools and the server. */
#ifdef FF_ENCODER

#include "ff_paint_local.h"

#include <string.h>

#define B     FF_PAINT_BLOCK
#define WORTH 4 /* of 65536: a step's square for a 256th of a bit, times 1 + the frequency */

/* What is left of the source, each channel times 4. */
static void left_of(const uint8_t *rgb, const uint8_t expected[3], int32_t left[3])
{
    int32_t r = rgb[0] - expected[0], g = rgb[1] - expected[1], b = rgb[2] - expected[2];
    left[0] = r + 2 * g + b;
    left[1] = 2 * (r - b);
    left[2] = 2 * g - r - b;
}

/* ---- numbers ---- */

/* What a plane's numbers take, 256ths of a bit. */
static uint32_t cost_of(ff_picture *p, unsigned plane, const ff_picture_sizes *of_left,
                        const ff_picture_sizes *of_above, const int32_t value[64],
                        ff_picture_sizes *here)
{
    uint32_t cost = 0;
    int32_t copy[64];
    memcpy(copy, value, sizeof copy);
    p->cost = &cost;
    (void)ff_picture_numbers(p, plane, of_left, of_above, copy, here);
    p->cost = NULL;
    return cost;
}

/* Square of what a number is off, 65536 a step. */
static int64_t off_of(int64_t whole, int32_t value, int32_t step_q4)
{
    int64_t off = ((whole >> FF_PICTURE_ONE_LOG2) - (int64_t)value * step_q4) * 256 / step_q4;
    return off * off;
}

/* Lets go of what takes more than it is worth: numbers become smaller by one, from the highest on.
 */
static void thin_out(ff_picture *p, unsigned plane, const ff_picture_sizes *of_left,
                     const ff_picture_sizes *of_above, const int64_t whole[64], int32_t value[64],
                     ff_picture_sizes *here)
{
    uint32_t cost = cost_of(p, plane, of_left, of_above, value, here);
    for (unsigned i = 64; i-- > 0;) {
        unsigned z = ff_picture_zigzag[i];
        int32_t was = value[z], less = was > 0 ? was - 1 : was + 1;
        if (!was) continue;
        value[z] = less;
        uint32_t then = cost_of(p, plane, of_left, of_above, value, here);
        int32_t step_q4 = ff_paint_step_q4(p, plane, z);
        int64_t worse = off_of(whole[z], less, step_q4) - off_of(whole[z], was, step_q4);
        if (worse < ((int64_t)cost - then) * WORTH * (1 + z / B + z % B))
            cost = then;
        else
            value[z] = was;
    }
    (void)cost_of(p, plane, of_left, of_above, value, here);
}

static int32_t rounded(int64_t whole, int32_t step_q4)
{
    int64_t step = (int64_t)step_q4 << FF_PICTURE_ONE_LOG2;
    return (int32_t)((whole < 0 ? whole - step / 2 : whole + step / 2) / step);
}

void ff_paint_count_block(ff_paint *paint, unsigned column, unsigned row,
                          const ff_picture_sizes *of_left, const ff_picture_sizes *of_above,
                          uint8_t expected[64][3], int32_t value[3][64])
{
    const ff_paint_source *from = paint->source;
    ff_picture *p = &paint->picture;
    int32_t left[64][3];
    int64_t whole[3][64];
    ff_picture_sizes here;
    for (unsigned i = 0; i < 64; i++) {
        size_t at = (size_t)(row * B + i / B) * from->columns * B + column * B + i % B;
        left_of(from->rgb + 3 * at, expected[i], left[i]);
    }
    ff_picture_coefficients(left, whole);
    for (unsigned c = 0; c < 3; c++)
        for (unsigned z = 0; z < 64; z++)
            value[c][z] = rounded(whole[c][z], ff_paint_step_q4(p, c, z));
    for (unsigned c = 0; c < 3; c++) thin_out(p, c, of_left, of_above, whole[c], value[c], &here);
}

int ff_paint_put(const ff_paint_tables *by, const ff_picture_eye *eye,
                 const ff_paint_source *source, unsigned quality, ff_paint_room *room,
                 const ff_paint_sink *sink, uint8_t *out, size_t limit)
{
    ff_range_writer to;
    ff_paint paint = { .picture = { .eye = eye, .to = &to },
                       .columns = source->columns,
                       .rows = source->rows,
                       .room = room,
                       .sink = sink,
                       .source = source };
    if (limit < 1) return FF_ERR_FULL;
    if (ff_paint_begin(&paint, by, quality) != FF_OK) return FF_ERR_ARGUMENT;
    *out = (uint8_t)quality;
    ff_range_write(&to, out + 1, limit - 1);
    ff_paint_go(&paint);
    int bytes = ff_range_end(&to);
    return bytes < 0 ? FF_ERR_FULL : 1 + bytes;
}

int ff_paint_encode(const ff_paint_source *source, unsigned quality, ff_paint_room *room,
                    const ff_paint_sink *sink, uint8_t *out, size_t limit)
{
    return ff_paint_put(&ff_paint_learned, NULL, source, quality, room, sink, out, limit);
}

#else
typedef int ff_paint_put_not_built; /* ISO C wants a declaration in every file */
#endif
