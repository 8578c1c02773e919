/* How errors spread over a picture: pixels by size of error, and what 95 of 100 of them do not
 * pass. Fills from ff_estimate.h. Sizes go in steps of a quarter octave from 1/256 pixel on. */
#ifndef FF_SPREAD_H
#define FF_SPREAD_H

#include <stdint.h>

#define FF_SPREAD_STEPS 104

/* Pixels, Q4. */
typedef struct ff_spread {
    uint32_t most[FF_SPREAD_STEPS];  /* whose error has a bound of this size */
    uint32_t known[FF_SPREAD_STEPS]; /* whose error has this size */
    /* Sum of the squares of the patches' pixels in `most`. Within a patch errors are alike. */
    uint64_t patches;
} ff_spread;

/* log2 of a value of at least 1, 8 fraction bits, straight between powers of two. */
int32_t ff_log2_q8(uint64_t value);
/* 2^(log_q8 / 256), of at least 0 and below 32, alike. */
uint32_t ff_exp2_q8(int32_t log_q8);
/* The step of an error of 2^log_q8 pixels Q8. */
unsigned ff_spread_step(int32_t log_q8);
/* The error, pixels Q8, that 95 % of the pixels likely do not pass; 0 where there are none. */
uint32_t ff_spread_p95_q8(const ff_spread *spread);

#endif
