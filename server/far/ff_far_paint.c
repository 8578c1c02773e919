#include "ff_far_paint.h"

#include <stdlib.h>
#include <string.h>

#define B       FF_FAR_BLOCK
#define SAME_Q8 280 /* nearest and farthest are one place when they differ by less */

/* ---- from subs to texels ---- */

static int64_t floor_div(int64_t a, int64_t b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

/* Subs of a texel along one axis: first to last, of which those on its very edges count half. */
typedef struct far_subs {
    int32_t first, last;
    uint8_t first_half, last_half;
} far_subs;

/* Middles of columns of subs stand on whole numbers, counted from the middle one: the texel from
 * x to x + 1 has those from x * subs / texels to (x + 1) * subs / texels. */
static far_subs subs_across(const ff_far_picture *picture, int32_t focal, int32_t x)
{
    int64_t from = (int64_t)x * picture->focal, to = from + picture->focal;
    far_subs subs = { (int32_t)-floor_div(-from, focal), (int32_t)floor_div(to, focal),
                      from % focal == 0, to % focal == 0 };
    subs.first += ff_far_middle(picture);
    subs.last += ff_far_middle(picture);
    return subs;
}

/* Middles of rows stand between whole numbers, counted from the horizon down. */
static far_subs subs_down(const ff_far_picture *picture, int32_t focal, int32_t y)
{
    int64_t from = (int64_t)y * picture->focal, to = from + picture->focal;
    far_subs subs = { (int32_t)-floor_div(-(2 * from - focal), 2 * focal),
                      (int32_t)-floor_div(-(2 * to - focal), 2 * focal) - 1, 0, 0 };
    subs.first += picture->height / 2;
    subs.last += picture->height / 2;
    return subs;
}

typedef struct far_sum {
    uint32_t rgb[3], weight, whole;
    int32_t nearest_wu, farthest_wu;
    uint32_t nearest[2], farthest[2]; /* column, row */
} far_sum;

static void add_sub(far_sum *sum, const ff_far_picture *picture, int32_t column, int32_t row,
                    uint32_t weight)
{
    sum->whole += weight;
    if (column < 0 || row < 0 || column >= picture->width || row >= picture->height) return;
    size_t at = (size_t)row * picture->width + (size_t)column;
    int32_t distance = picture->distance[at];
    if (distance == FF_FAR_NOTHING) return;
    for (int c = 0; c < 3; c++) sum->rgb[c] += picture->rgba[4 * at + (size_t)c] * weight;
    sum->weight += weight;
    if (distance < sum->nearest_wu) {
        sum->nearest_wu = distance;
        sum->nearest[0] = (uint32_t)column, sum->nearest[1] = (uint32_t)row;
    }
    if (distance > sum->farthest_wu) {
        sum->farthest_wu = distance;
        sum->farthest[0] = (uint32_t)column, sum->farthest[1] = (uint32_t)row;
    }
}

static far_sum sum_subs(const ff_far_picture *picture, far_subs across, far_subs down)
{
    far_sum sum = { .nearest_wu = INT32_MAX };
    for (int32_t row = down.first; row <= down.last; row++)
        for (int32_t column = across.first; column <= across.last; column++) {
            int half = (column == across.first && across.first_half) ||
                       (column == across.last && across.last_half);
            add_sub(&sum, picture, column, row, half ? 1 : 2);
        }
    return sum;
}

static int take_texel(ff_far_paint *paint, const far_sum *sum, size_t at, ff_far_spots *spots)
{
    ff_far_texel *texel = &paint->texel[at];
    if (sum->weight == 0) return FF_OK;
    for (int c = 0; c < 3; c++)
        texel->rgb_q8[c] = (uint16_t)((uint64_t)sum->rgb[c] * 256 / sum->weight);
    texel->weight = (uint16_t)(1 + 255 * (uint64_t)sum->weight / sum->whole);
    int64_t spot = ff_far_spots_add(spots, sum->nearest[0], sum->nearest[1]);
    if (spot < 0) return (int)spot;
    paint->nearest[at] = paint->farthest[at] = (uint32_t)spot + 1;
    if ((int64_t)sum->farthest_wu * 256 < (int64_t)sum->nearest_wu * SAME_Q8) return FF_OK;
    spot = ff_far_spots_add(spots, sum->farthest[0], sum->farthest[1]);
    if (spot < 0) return (int)spot;
    paint->farthest[at] = (uint32_t)spot + 1;
    return FF_OK;
}

/* ---- the whole picture ---- */

static int make_room(ff_far_paint *paint)
{
    size_t texels = (size_t)paint->width * paint->height;
    paint->texel = calloc(ff_far_fill_texels(paint->width, paint->height), sizeof *paint->texel);
    paint->nearest = calloc(texels, sizeof *paint->nearest);
    paint->farthest = calloc(texels, sizeof *paint->farthest);
    paint->there = calloc(texels / (B * B), 1);
    return paint->texel && paint->nearest && paint->farthest && paint->there ? FF_OK
                                                                             : FF_ERR_MEMORY;
}

/* The first row of the picture that shows ground, and the last. */
static int ground_rows(const ff_far_picture *picture, int32_t *first, int32_t *last)
{
    *first = picture->height, *last = -1;
    for (int32_t row = 0; row < picture->height; row++) {
        const int32_t *at = picture->distance + (size_t)row * picture->width;
        int32_t column = 0;
        while (column < picture->width && at[column] == FF_FAR_NOTHING) column++;
        if (column == picture->width) continue;
        *first = row < *first ? row : *first;
        *last = row;
    }
    return *last >= 0;
}

int ff_far_paint_take(ff_far_paint *paint, const ff_far_picture *picture, const ff_get_far *request,
                      ff_far_spots *spots)
{
    int32_t first, last;
    memset(paint, 0, sizeof *paint);
    paint->focal = request->focal >> request->paint_shift;
    if (!request->quality || !ground_rows(picture, &first, &last)) return FF_OK;
    int32_t half = ff_far_half(paint->focal), horizon = picture->height / 2,
            top = (int32_t)floor_div((int64_t)(first - horizon) * paint->focal, picture->focal),
            end = (int32_t)floor_div((int64_t)(last + 1 - horizon) * paint->focal, picture->focal) +
                  1,
            down = request->down >> request->paint_shift;
    if (end > down) end = down + 1;
    if (end > top + FF_FAR_ROWS_MAX * B) end = top + FF_FAR_ROWS_MAX * B;
    if (end <= top) return FF_OK;
    paint->top = -top;
    paint->width = (uint32_t)ff_far_blocks_x(paint->focal) * B;
    paint->height = (uint32_t)(end - top + B - 1) / B * B;
    int rc = make_room(paint);
    for (int32_t row = top; row < end && rc == FF_OK; row++) {
        far_subs down_subs = subs_down(picture, paint->focal, row);
        for (int32_t x = -half; x < half && rc == FF_OK; x++) {
            far_sum sum = sum_subs(picture, subs_across(picture, paint->focal, x), down_subs);
            size_t at = (size_t)(row - top) * paint->width +
                        (size_t)(x + (int32_t)paint->width / 2);
            rc = take_texel(paint, &sum, at, spots);
        }
    }
    return rc;
}

/* ---- what is kept ---- */

/* Lets go of texels that nobody sees; marks blocks that have others. */
static void mark_blocks(ff_far_paint *paint, const ff_far_spots *spots)
{
    size_t texels = (size_t)paint->width * paint->height;
    uint32_t blocks_x = paint->width / B;
    for (size_t i = 0; i < texels; i++) {
        paint->ground += paint->nearest[i] != 0;
        int seen = paint->nearest[i] && (spots->spot[paint->nearest[i] - 1].seen ||
                                         spots->spot[paint->farthest[i] - 1].seen);
        if (!seen)
            paint->texel[i].weight = 0;
        else
            paint->there[i / paint->width / B * blocks_x + i % paint->width / B] = 1;
        paint->seen += (uint32_t)seen;
    }
}

/* Rows of blocks above the first that is there, and below the last. */
static void cut_rows(ff_far_paint *paint)
{
    uint32_t blocks_x = paint->width / B, rows = paint->height / B, first = 0;
    while (rows > 0 && !memchr(paint->there + (rows - 1) * blocks_x, 1, blocks_x)) rows--;
    while (first < rows && !memchr(paint->there + first * blocks_x, 1, blocks_x)) first++;
    memmove(paint->there, paint->there + first * blocks_x, (rows - first) * blocks_x);
    memmove(paint->texel, paint->texel + (size_t)first * B * paint->width,
            (size_t)(rows - first) * B * paint->width * sizeof *paint->texel);
    paint->top -= (int32_t)(first * B);
    paint->height = (rows - first) * B;
}

int ff_far_paint_keep(ff_far_paint *paint, const ff_far_spots *spots)
{
    if (!paint->texel) return FF_OK;
    mark_blocks(paint, spots);
    cut_rows(paint);
    size_t texels = (size_t)paint->width * paint->height;
    for (size_t i = 0; i < texels / (B * B); i++) paint->blocks_there += paint->there[i];
    if (paint->blocks_there == 0) return FF_OK;
    paint->rgb = malloc(texels * 3);
    paint->needed = malloc(texels);
    if (!paint->rgb || !paint->needed) return FF_ERR_MEMORY;
    for (size_t i = 0; i < texels; i++) paint->needed[i] = paint->texel[i].weight != 0;
    ff_far_fill(paint->texel, paint->width, paint->height);
    for (size_t i = 0; i < 3 * texels; i++) {
        unsigned value = (paint->texel[i / 3].rgb_q8[i % 3] + 128u) >> 8;
        paint->rgb[i] = (uint8_t)(value > 255 ? 255 : value);
    }
    return FF_OK;
}

void ff_far_paint_free(ff_far_paint *paint)
{
    free(paint->texel);
    free(paint->nearest);
    free(paint->farthest);
    free(paint->there);
    free(paint->rgb);
    free(paint->needed);
    memset(paint, 0, sizeof *paint);
}
