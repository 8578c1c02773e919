#include "ff_far.h"

#include "../ff_assert.h"

#define STEPS    32    /* to an octave */
#define FIRST_WU 16384 /* 64 m */

/* 2^(i / 32), Q16 */
static const uint32_t root_q16[STEPS] = { 65536,  66971,  68438,  69936,  71468,  73032,  74632,
                                          76266,  77936,  79642,  81386,  83169,  84990,  86851,
                                          88752,  90696,  92682,  94711,  96785,  98905,  101070,
                                          103283, 105545, 107856, 110218, 112631, 115098, 117618,
                                          120194, 122825, 125515, 128263 };

void ff_far_axes(unsigned sector, int32_t forward_q30[2], int32_t right_q30[2])
{
    /* sine of so many sixteenths of a turn */
    static const int32_t sine_q30[FF_FAR_SECTORS] = {
        0, 410903207,  759250125,  992008094,  1 << 30,    992008094,  759250125,  410903207,
        0, -410903207, -759250125, -992008094, -(1 << 30), -992008094, -759250125, -410903207
    };
    FF_ASSERT(sector < FF_FAR_SECTORS);
    forward_q30[0] = sine_q30[sector];
    forward_q30[1] = sine_q30[(sector + 4) % FF_FAR_SECTORS];
    right_q30[0] = forward_q30[1];
    right_q30[1] = -forward_q30[0];
}

int32_t ff_far_distance_wu(unsigned step)
{
    FF_ASSERT(step <= FF_FAR_DISTANCE_MAX);
    return (int32_t)(((uint64_t)root_q16[step % STEPS] * FIRST_WU << step / STEPS) >> 16);
}

unsigned ff_far_distance_step(int32_t distance_wu)
{
    unsigned low = 0, high = FF_FAR_DISTANCE_MAX;
    while (low < high) { /* the last step that is no farther */
        unsigned middle = (low + high + 1) / 2;
        if (ff_far_distance_wu(middle) <= distance_wu)
            low = middle;
        else
            high = middle - 1;
    }
    if (low == FF_FAR_DISTANCE_MAX || distance_wu < FIRST_WU) return low;
    int32_t near_wu = distance_wu - ff_far_distance_wu(low),
            far_wu = ff_far_distance_wu(low + 1) - distance_wu;
    return far_wu < near_wu ? low + 1 : low;
}
