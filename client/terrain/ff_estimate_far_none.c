/* Stands in for ff_estimate_far.c in builds without far sets: nobody asks. */
#include "ff_gaze.h"

void ff_gaze_far(ff_gaze *at, const ff_square *s, uint32_t pixels_q4, int32_t error_log_q8)
{
    (void)at, (void)s, (void)pixels_q4, (void)error_log_q8;
}
