/* What texels are expected to be before anything of them is known: the parent's, between its own
 * (SPEC.md, 5.2). */
#include "ff_picture_local.h"

#define TAPS 4
#define WIDE 8 /* of the parent's texels, as many lie around a part, each way */
#define GREY 128

/* How a place of the children's lattice weighs the parent's texels around it, in sixteenths: the
 * one before it, those it is at or between, the one behind. At the rims nothing across them counts.
 */
typedef struct taps {
    int32_t before, here, next, behind;
} taps;

static taps taps_at(unsigned place, unsigned side)
{
    unsigned at = place / 2;
    FF_ASSERT(place <= 2 * (side - 1));
    if (place % 2 == 0)
        return at == 0 || at == side - 1 ? (taps){ 0, 16, 0, 0 } : (taps){ 1, 14, 1, 0 };
    return at == 0 || at == side - 2 ? (taps){ 0, 8, 8, 0 } : (taps){ -1, 9, 9, -1 };
}

static inline int32_t weighed(taps t, const int16_t *value, unsigned apart)
{
    return t.before * value[0] + t.here * value[apart] + t.next * value[2 * apart] +
           t.behind * value[3 * apart];
}

/* Texels beyond the parent have no weight; any will do. */
static unsigned inside(unsigned at, unsigned side)
{
    return at < 1 ? 0 : at > side ? side - 1 : at - 1;
}

/* The parent's texels from one before place `x` on, a channel after the other; of row `row`,
 * counted alike. */
static void take_row(const ff_picture *p, unsigned x, unsigned row, int16_t channel[3][WIDE])
{
    const uint8_t *west = p->parent + ff_picture_at(p, 0, inside(row, p->side));
    for (unsigned i = 0; i < WIDE; i++) {
        const uint8_t *rgb = west + inside(x / 2 + i, p->side) * 3;
        for (unsigned c = 0; c < 3; c++) channel[c][i] = rgb[c];
    }
}

static uint8_t to_byte(int32_t value_q8)
{
    int32_t value = (value_q8 + 128) >> 8;
    return (uint8_t)(value < 0 ? 0 : value > 255 ? 255 : value);
}

/* A row of the parent at the columns of the part, from place x on, times 16. */
static void across(const ff_picture *p, const taps *column, unsigned x, unsigned width,
                   unsigned row, int16_t out[3][FF_PICTURE_BLOCK])
{
    int16_t channel[3][WIDE];
    FF_ASSERT(width <= FF_PICTURE_BLOCK);
    take_row(p, x, row, channel);
    for (unsigned i = 0; i < width; i++) {
        const int16_t *first = channel[0] + ((x + i) / 2 - x / 2);
        const taps t = column[i];
        for (unsigned c = 0; c < 3; c++) out[c][i] = (int16_t)weighed(t, first + c * WIDE, 1);
    }
}

static void from_parent(const ff_picture *p, ff_picture_part part, uint8_t rgb[64][3])
{
    int16_t row[WIDE][3][FF_PICTURE_BLOCK];
    taps column[FF_PICTURE_BLOCK];
    unsigned x = p->column + part.x, y = p->row + part.y,
             rows = (y + part.height - 1) / 2 - y / 2 + TAPS;
    FF_ASSERT(rows <= WIDE);
    for (unsigned i = 0; i < part.width; i++) column[i] = taps_at(x + i, p->side);
    for (unsigned j = 0; j < rows; j++) across(p, column, x, part.width, y / 2 + j, row[j]);
    for (unsigned j = 0; j < part.height; j++, rgb += part.width) {
        const int16_t *from = row[(y + j) / 2 - y / 2][0];
        const taps t = taps_at(y + j, p->side);
        for (unsigned c = 0; c < 3; c++)
            for (unsigned i = 0; i < part.width; i++)
                rgb[i][c] = to_byte(
                    weighed(t, from + c * FF_PICTURE_BLOCK + i, 3 * FF_PICTURE_BLOCK));
    }
}

/* A root's block: the mean of the texels west and south of it. */
static void from_neighbours(const ff_picture *p, ff_picture_part part, uint8_t rgb[64][3])
{
    unsigned column = part.x ? part.x - 1 : 0, row = part.y ? part.y - 1 : 0, sum[3] = { 8, 8, 8 };
    for (unsigned i = 0; i < FF_PICTURE_BLOCK; i++) {
        const uint8_t *west = p->rgb + ff_picture_at(p, column, part.y + i),
                      *south = p->rgb + ff_picture_at(p, part.x + i, row);
        for (unsigned c = 0; c < 3; c++) sum[c] += west[c] + south[c];
    }
    for (unsigned i = 0; i < 64; i++)
        for (unsigned c = 0; c < 3; c++) rgb[i][c] = (uint8_t)(sum[c] / 16);
}

void ff_picture_expect(const ff_picture *p, ff_picture_part part, uint8_t rgb[64][3])
{
    if (p->parent) {
        from_parent(p, part, rgb);
    } else if (part.width * part.height == 64) {
        from_neighbours(p, part, rgb);
    } else {
        for (unsigned c = 0; c < 3; c++) rgb[0][c] = GREY;
    }
}

void ff_picture_between(const ff_picture *p, ff_picture_part part, uint8_t rgb[64][3])
{
    unsigned last = p->side - 1, upright = part.height > 1, from = upright ? part.y : part.x;
    const uint8_t *a = p->rgb + ff_picture_at(p, upright ? part.x : 0, upright ? 0 : part.y),
                  *b = p->rgb + ff_picture_at(p, upright ? part.x : last, upright ? last : part.y);
    for (unsigned i = 0; i < FF_PICTURE_BLOCK; i++)
        for (unsigned c = 0; c < 3; c++)
            rgb[i][c] = (uint8_t)((a[c] * (last - from - i) + b[c] * (from + i) + last / 2) / last);
}
