/* Paint: the walk through blocks, which both halves share, and decoding. */
#include "ff_paint_local.h"

#include <string.h>

#define B    FF_PAINT_BLOCK
#define GREY 128
/* How much of what a texel beside the block is off their mean is left so many texels away: of 256.
 */
static const uint8_t fade[B] = { 120, 85, 62, 46, 34, 25, 20, 15 };

int ff_paint_begin(ff_paint *paint, const ff_paint_tables *by, unsigned quality)
{
    ff_picture *p = &paint->picture;
    ff_paint_room *room = paint->room;
    int32_t step_q4 = ff_picture_step_q4(quality);
    if (!step_q4) return FF_ERR_FORMAT;
    p->by = &by->numbers;
    p->step_q4[0] = step_q4;
    p->one = room->one;
    memset(room, 0, ff_paint_room_bytes(paint->columns));
    memcpy(room->one, by->numbers.one, sizeof room->one);
    memcpy(room->there, by->there, sizeof room->there);
    memset(room->before.count, B, sizeof room->before.count);
    memset(room->edge, GREY, sizeof room->edge);
    return FF_OK;
}

/* ---- what is expected ---- */

static void mean_of(uint8_t edge[B][3], uint32_t sum[3])
{
    for (unsigned i = 0; i < B; i++)
        for (unsigned c = 0; c < 3; c++) sum[c] += edge[i][c];
}

/* `left`, `above`: texels beside the block; NULL: none. */
static void expect(uint8_t left[B][3], uint8_t above[B][3], uint8_t rgb[64][3])
{
    uint32_t sum[3] = { 0, 0, 0 }, parts = left && above ? 16 : 8;
    FF_ASSERT(left || above);
    if (left) mean_of(left, sum);
    if (above) mean_of(above, sum);
    for (unsigned c = 0; c < 3; c++) {
        int32_t mean = (int32_t)((sum[c] + parts / 2) / parts);
        for (unsigned i = 0; i < 64; i++) {
            unsigned x = i % B, y = i / B;
            int32_t off = left ? fade[x] * (left[y][c] - mean) : 0;
            if (above) off += fade[y] * (above[x][c] - mean);
            rgb[i][c] = ff_picture_byte(mean + ((off + 128) >> 8));
        }
    }
}

/* ---- blocks ---- */

int32_t ff_paint_step_q4(const ff_picture *p, unsigned plane, unsigned z)
{
    /* in halves of luma's: the mean, broad waves, finer and finest */
    static const uint8_t halves[3][4] = { { 2, 2, 2, 2 }, { 3, 5, 7, 10 }, { 3, 4, 5, 8 } };
    unsigned frequency = z / B + z % B;
    FF_ASSERT(plane < 3 && z < B * B);
    return p->step_q4[0] * halves[plane][frequency < 3 ? frequency : 3] / 2;
}

void ff_paint_left(const ff_picture *p, int32_t value[3][64])
{
    FF_ASSERT(p->step_q4[0] > 0);
    for (unsigned plane = 0; plane < 3; plane++) {
        int16_t whole[64];
        for (unsigned z = 0; z < 64; z++)
            whole[z] = ff_picture_coefficient(value[plane][z], ff_paint_step_q4(p, plane, z));
        ff_picture_block(whole, value[plane]);
    }
}

static void go_block(ff_paint *paint, unsigned column, unsigned row, int is_left_there)
{
    ff_paint_room *room = paint->room;
    ff_paint_column *above = &room->column[column];
    FF_ASSERT(column < paint->columns && row < paint->rows);
    uint8_t texel[64][3];
    int32_t value[3][64] = { { 0 } };
    ff_picture_sizes here;
    const ff_picture_sizes *of_above = above->there ? &above->sizes : &room->before,
                           *of_left = is_left_there || !above->there ? &room->before : of_above;
    expect(is_left_there || !above->there ? room->edge : NULL, above->there ? above->edge : NULL,
           texel);
#ifdef FF_ENCODER
    if (paint->source) ff_paint_count_block(paint, column, row, of_left, of_above, texel, value);
#endif
    for (unsigned plane = 0; plane < 3; plane++)
        ff_picture_numbers(&paint->picture, plane, of_left, of_above, value[plane], &here);
    ff_paint_left(&paint->picture, value);
    for (unsigned i = 0; i < 64; i++)
        ff_picture_add(texel[i], value[0][i], value[1][i], value[2][i], texel[i]);
    paint->sink->block(paint->sink->context, column, row, texel);
    for (unsigned i = 0; i < B; i++) {
        memcpy(room->edge[i], texel[i * B + B - 1], 3);
        memcpy(above->edge[i], texel[(B - 1) * B + i], 3);
    }
    room->before = above->sizes = here;
}

/* Is it there, as the blocks left of it and above are? */
static unsigned take_there(ff_paint *paint, unsigned column, unsigned row, unsigned context)
{
    unsigned bit = 0;
    FF_ASSERT(context < 16);
#ifdef FF_ENCODER
    if (paint->source) bit = paint->source->there[row * paint->columns + column];
#endif
    (void)row, (void)column;
    return ff_picture_decide(&paint->picture, &paint->room->there[context], bit);
}

void ff_paint_go(ff_paint *paint)
{
    ff_paint_column *all = paint->room->column;
    for (unsigned row = 0; row < paint->rows; row++) {
        unsigned left = 0, above_left = 0;
        for (unsigned column = 0; column < paint->columns; column++) {
            unsigned above = all[column].there,
                     above_right = column + 1 < paint->columns ? all[column + 1].there : 0;
            unsigned there = take_there(paint, column, row,
                                        left | above << 1 | above_left << 2 | above_right << 3);
            if (there) go_block(paint, column, row, (int)left);
            paint->count += there;
            all[column].there = (uint8_t)there;
            above_left = above;
            left = there;
        }
    }
}

int ff_paint_decode(const uint8_t *bytes, size_t count, unsigned columns, unsigned rows,
                    ff_paint_room *room, const ff_paint_sink *sink)
{
    ff_paint paint = { .columns = columns, .rows = rows, .room = room, .sink = sink };
    ff_range *range = &paint.picture.range;
    if (count == 0) return FF_ERR_TRUNCATED;
    int rc = ff_paint_begin(&paint, &ff_paint_learned, bytes[0]);
    if (rc != FF_OK) return rc;
    ff_range_read(range, bytes + 1, count - 1);
    ff_paint_go(&paint);
    /* a stream has no byte that says nothing */
    if (!ff_range_is_read(range) || (count > 1 && !bytes[count - 1])) return FF_ERR_FORMAT;
    return paint.count ? (int)paint.count : FF_ERR_FORMAT;
}
