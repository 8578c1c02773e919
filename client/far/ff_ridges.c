#include "ff_ridges.h"

#include "../../protocol/ff_assert.h"

#include <string.h>

#define FORWARD_LOG2 10    /* wu to a unit of `behind` */
#define BEHIND_Q8    288   /* so many times as far away as a ridge ground is behind it */
#define ABOVE_Q2     4     /* quarter texels: so far above its line paint shows some of it */
#define TAN_HALF_Q16 13036 /* of 11.25 degrees */

/* ---- columns ---- */

/* Where the middle of a column is, in 256ths of a texel from the sector's. */
static int32_t middle_q8(unsigned column, int32_t focal)
{
    int64_t width = 2 * (int64_t)focal * TAN_HALF_Q16; /* Q16 */
    return (int32_t)((width * (2 * (int32_t)column + 1 - FF_RIDGES_COLUMNS) /
                      (2 * FF_RIDGES_COLUMNS)) >>
                     8);
}

/* The line between others that rises least above the one before it. */
static unsigned least_step(const ff_ridge *line, unsigned count)
{
    unsigned least = 1;
    int32_t smallest = INT32_MAX;
    for (unsigned i = 0; i + 2 < count; i++) {
        int32_t rise = line[i + 1].slope_q14 - line[i].slope_q14;
        if (rise < smallest) smallest = rise, least = i + 1;
    }
    return least;
}

/* Keeps the lines in order, and each higher than the one before it. */
static void add_line(ff_ridges *ridges, unsigned column, ff_ridge added)
{
    ff_ridge kept[FF_RIDGES_LINES + 1];
    const ff_ridge *line = ridges->line[column];
    unsigned count = 0, i = 0, had = ridges->count[column];
    for (; i < had && line[i].behind <= added.behind; i++) kept[count++] = line[i];
    if (count && kept[count - 1].slope_q14 >= added.slope_q14) return;
    if (count && kept[count - 1].behind == added.behind) count--;
    kept[count++] = added;
    for (; i < had; i++)
        if (line[i].slope_q14 > added.slope_q14) kept[count++] = line[i];
    if (count > FF_RIDGES_LINES) {
        unsigned lost = least_step(kept, count);
        count--;
        memmove(kept + lost, kept + lost + 1, (count - lost) * sizeof *kept);
    }
    FF_ASSERT(count <= FF_RIDGES_LINES);
    memcpy(ridges->line[column], kept, count * sizeof *kept);
    ridges->count[column] = (uint8_t)count;
}

/* ---- fins ---- */

/* The line from a to b where it crosses columns. */
static void add_part(ff_ridges *ridges, int32_t focal, const ff_fin_vertex *a,
                     const ff_fin_vertex *b)
{
    int32_t whole = (b->column - a->column) * 256;
    if (whole <= 0) return;
    for (unsigned column = 0; column < FF_RIDGES_COLUMNS; column++) {
        int32_t part = middle_q8(column, focal) - a->column * 256;
        if (part < 0 || part >= whole) continue;
        int32_t up_q2 = a->up_q2 + (int32_t)((int64_t)(b->up_q2 - a->up_q2) * part / whole);
        int32_t step = a->distance + (int32_t)((int64_t)(b->distance - a->distance) * part / whole);
        int64_t behind = ((int64_t)ff_far_distance_wu((unsigned)step) * BEHIND_Q8 >> 8) >>
                         FORWARD_LOG2,
                slope = (int64_t)(up_q2 + ABOVE_Q2) * (1 << 12) / focal;
        if (behind > UINT16_MAX || slope < INT16_MIN) continue;
        if (slope > INT16_MAX) slope = INT16_MAX;
        add_line(ridges, column, (ff_ridge){ (uint16_t)behind, (int16_t)slope });
    }
}

void ff_ridges_make(ff_ridges *ridges, int32_t focal, const ff_fin_vertex *fin, uint32_t count)
{
    FF_ASSERT(focal >= FF_FAR_FOCAL_MIN && focal <= FF_FAR_FOCAL_MAX);
    memset(ridges, 0, sizeof *ridges);
    for (uint32_t i = 1; i < count; i++)
        if (!fin[i].begins) add_part(ridges, focal, &fin[i - 1], &fin[i]);
}

int ff_ridges_hide(const ff_ridges *ridges, int64_t forward_wu, int64_t right_wu, int64_t up_wu)
{
    int32_t forward = (int32_t)(forward_wu >> FORWARD_LOG2),
            half = (int32_t)((int64_t)forward * TAN_HALF_Q16 >> 16);
    int64_t from_left = (right_wu >> FORWARD_LOG2) + half;
    if (half <= 0 || from_left < 0 || from_left >= 2 * half) return 0;
    unsigned column = (uint32_t)from_left * FF_RIDGES_COLUMNS / (uint32_t)(2 * half);
    const ff_ridge *line = ridges->line[column];
    unsigned i = ridges->count[column];
    while (i > 0 && line[i - 1].behind > forward) i--;
    return i > 0 &&
           up_wu * (1 << 14) < line[i - 1].slope_q14 * forward_wu; /* the highest before it */
}
