#include "ff_spread.h"
#include "../../protocol/ff_assert.h"

#define STEP_Q8  64 /* of log2 */
#define BOUND_Q8 (32 << 8)
#define PART     20 /* one in so many pixels may pass the percentile */
/* Until so many patches of a size are seen the errors of one may be most of the picture: then the
 * middle one counts as much as the spread of all. */
#define PATCHES 5

FF_STATIC_ASSERT((FF_SPREAD_STEPS + 1) * STEP_Q8 < BOUND_Q8);

/* How many pixels, of 256, are off by more than 2^(-i/4) of their node's geometric error: counted
 * over 32288 pixels of the auditor, six terrains, four qualities, 100 and 2000 m up. */
static const uint8_t beyond[] = { 0,   0,   1,   3,   7,   13,  20,  29,  40,  51,
                                  61,  73,  87,  102, 118, 131, 143, 156, 169, 181,
                                  192, 200, 207, 214, 220, 225, 230, 234, 238 };
#define BEYOND_STEPS (sizeof beyond / sizeof *beyond)
#define BEYOND_REST  250 /* further down */
#define MIDDLE_STEPS 13  /* half of the pixels are off by a tenth */

int32_t ff_log2_q8(uint64_t value)
{
    int bits = 0;
    FF_ASSERT(value >= 1);
    for (int half = 32; half; half /= 2)
        if (value >> bits >> half) bits += half;
    uint64_t mantissa = bits > 8 ? value >> (bits - 8) : value << (8 - bits);
    return (int32_t)(bits << 8) + (int32_t)(mantissa & 255);
}

uint32_t ff_exp2_q8(int32_t log_q8)
{
    FF_ASSERT(log_q8 >= 0 && log_q8 < BOUND_Q8);
    uint64_t mantissa = 256 + (uint64_t)(log_q8 & 255);
    return (uint32_t)((mantissa << (log_q8 >> 8)) >> 8);
}

unsigned ff_spread_step(int32_t log_q8)
{
    int32_t step = log_q8 / STEP_Q8;
    return step < 0 ? 0 : step < FF_SPREAD_STEPS ? (unsigned)step : FF_SPREAD_STEPS - 1;
}

/* Share of the pixels of a bound that are off by more than a size so many steps below it, of 256:
 * of all of them, or as if all were off like the middle one. */
static uint32_t share_beyond(int below, int middle)
{
    FF_ASSERT(below >= 0);
    if (middle) return below >= MIDDLE_STEPS ? 256 : 0;
    return below < (int)BEYOND_STEPS ? beyond[below] : BEYOND_REST;
}

/* Pixels that are off by more than the size of a step, Q12. */
static uint64_t pixels_beyond(const ff_spread *spread, int step, int middle)
{
    uint64_t sum = 0;
    for (int i = step < 0 ? 0 : step; i < FF_SPREAD_STEPS; i++) {
        if (i > step) sum += (uint64_t)spread->known[i] << 8;
        sum += (uint64_t)spread->most[i] * share_beyond(i - step, middle);
    }
    return sum;
}

/* log2 of the percentile, Q8; between two steps by the pixels between them. */
static int32_t percentile_q8(const ff_spread *spread, uint64_t pixels, int middle)
{
    uint64_t limit = (pixels << 8) / PART, below = 0, above = pixels << 8;
    int low = -1, high = FF_SPREAD_STEPS; /* more pixels than the limit are beyond low, not high */
    while (high - low > 1) {
        int step = (low + high) / 2;
        uint64_t beyond_step = pixels_beyond(spread, step, middle);
        if (beyond_step > limit) {
            low = step;
            above = beyond_step;
        } else {
            high = step;
            below = beyond_step;
        }
    }
    if (low < 0) return 0;
    FF_ASSERT(above > below && above > limit);
    return low * STEP_Q8 + (int32_t)((above - limit) * STEP_Q8 / (above - below));
}

uint32_t ff_spread_p95_q8(const ff_spread *spread)
{
    uint64_t bounded = 0, known = 0;
    for (unsigned i = 0; i < FF_SPREAD_STEPS; i++) {
        bounded += spread->most[i];
        known += spread->known[i];
    }
    if (bounded + known == 0) return 0;
    int32_t all_q8 = percentile_q8(spread, bounded + known, 0);
    if (!spread->patches) return all_q8 ? ff_exp2_q8(all_q8) : 0;
    int32_t middle_q8 = percentile_q8(spread, bounded + known, 1);
    int64_t patches = (int64_t)(bounded * bounded / spread->patches);
    int32_t log_q8 = (int32_t)((all_q8 * patches + (int64_t)middle_q8 * PATCHES) /
                               (patches + PATCHES));
    return log_q8 ? ff_exp2_q8(log_q8) : 0;
}
