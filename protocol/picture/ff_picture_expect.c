/* What texels are expected to be before anything of them is known: the parent's, between its own
 * (SPEC.md, 5.2). */
#include "ff_picture_local.h"

#define TAPS     4
#define ROWS_MAX 8
#define GREY     128

void ff_picture_spread(uint16_t texel, uint8_t rgb[3])
{
    unsigned r = texel >> 11, g = texel >> 5 & 63u, b = texel & 31u;
    rgb[0] = (uint8_t)(r << 3 | r >> 2);
    rgb[1] = (uint8_t)(g << 2 | g >> 4);
    rgb[2] = (uint8_t)(b << 3 | b >> 2);
}

/* How a place of the children's lattice weighs the four of the parent's texels from `first` on, in
 * sixteenths. At the rims nothing across them does. */
typedef struct taps {
    int first;
    int8_t weight[TAPS];
} taps;

static taps taps_at(unsigned place, unsigned side)
{
    unsigned at = place / 2;
    taps t = { .first = (int)at - 1 };
    FF_ASSERT(place <= 2 * (side - 1));
    if (place % 2 == 0 && (at == 0 || at == side - 1))
        t.weight[1] = 16;
    else if (place % 2 == 0)
        t = (taps){ (int)at - 1, { 1, 14, 1, 0 } };
    else if (at == 0 || at == side - 2)
        t.weight[1] = t.weight[2] = 8;
    else
        t = (taps){ (int)at - 1, { -1, 9, 9, -1 } };
    return t;
}

/* Texels beyond the parent have no weight; any will do. */
static unsigned inside(int at, unsigned side)
{
    return at < 0 ? 0 : at >= (int)side ? side - 1 : (unsigned)at;
}

/* A row of the parent at the columns of the part, times 16. */
static void across(const ff_picture *p, const taps *column, unsigned width, const uint16_t *row,
                   int16_t out[8][3])
{
    for (unsigned i = 0; i < width; i++) {
        int32_t sum[3] = { 0, 0, 0 };
        for (unsigned k = 0; k < TAPS; k++) {
            uint8_t rgb[3];
            if (!column[i].weight[k]) continue;
            ff_picture_spread(row[inside(column[i].first + (int)k, p->side)], rgb);
            for (unsigned c = 0; c < 3; c++) sum[c] += column[i].weight[k] * rgb[c];
        }
        for (unsigned c = 0; c < 3; c++) out[i][c] = (int16_t)sum[c];
    }
}

static uint8_t to_byte(int32_t value_q8)
{
    int32_t value = (value_q8 + 128) >> 8;
    return (uint8_t)(value < 0 ? 0 : value > 255 ? 255 : value);
}

static void from_parent(const ff_picture *p, ff_picture_part part, uint8_t rgb[64][3])
{
    int16_t row[ROWS_MAX][8][3];
    taps column[8];
    unsigned x = p->column + part.x, y = p->row + part.y;
    int first = (int)(y / 2) - 1, last = (int)((y + part.height - 1) / 2) + 2;
    FF_ASSERT(last - first < ROWS_MAX);
    for (unsigned i = 0; i < part.width; i++) column[i] = taps_at(x + i, p->side);
    for (int j = first; j <= last; j++)
        across(p, column, part.width, p->parent + inside(j, p->side) * p->side, row[j - first]);
    for (unsigned j = 0; j < part.height; j++) {
        taps t = taps_at(y + j, p->side);
        int16_t(*at)[8][3] = &row[t.first - first];
        for (unsigned i = 0; i < part.width; i++)
            for (unsigned c = 0; c < 3; c++) {
                int32_t sum = 0;
                for (unsigned k = 0; k < TAPS; k++)
                    if (t.weight[k]) sum += t.weight[k] * at[k][i][c];
                rgb[j * part.width + i][c] = to_byte(sum);
            }
    }
}

/* A root's block: the mean of the texels west and south of it. */
static void from_neighbours(const ff_picture *p, ff_picture_part part, uint8_t rgb[64][3])
{
    unsigned column = part.x ? part.x - 1 : 0, row = part.y ? part.y - 1 : 0, sum[3] = { 8, 8, 8 };
    for (unsigned i = 0; i < FF_PICTURE_BLOCK; i++) {
        uint8_t west[3], south[3];
        ff_picture_spread(p->texels[(part.y + i) * p->side + column], west);
        ff_picture_spread(p->texels[row * p->side + part.x + i], south);
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
    uint8_t a[3], b[3];
    ff_picture_spread(p->texels[upright ? part.x : part.y * p->side], a);
    ff_picture_spread(p->texels[upright ? last * p->side + part.x : part.y * p->side + last], b);
    for (unsigned i = 0; i < FF_PICTURE_BLOCK; i++)
        for (unsigned c = 0; c < 3; c++)
            rgb[i][c] = (uint8_t)((a[c] * (last - from - i) + b[c] * (from + i) + last / 2) / last);
}
