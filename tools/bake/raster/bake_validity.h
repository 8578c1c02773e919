/* Which values of a raster are no heights: what its masks, alpha and nodata say, and sentinels that
 * nothing declares. */
#ifndef BAKE_VALIDITY_H
#define BAKE_VALIDITY_H

#include "bake_gdal.h"
#include "bake_source.h"
#include "bake_unit.h"

#define BAKE_MASKS_MAX     2
#define BAKE_SENTINELS_MAX 8

typedef struct bake_validity {
    GDALRasterBandH mask[BAKE_MASKS_MAX]; /* 0 in any of them: void */
    int mask_count;
    double nodata;
    int has_nodata;
    const double *sentinel; /* BAKE_SENTINELS_MAX of them, the highest first */
    /* Values that stand for void where nothing says so; taken as heights until all are read. */
    uint64_t sentinel_samples[BAKE_SENTINELS_MAX];
    int looks_for_sentinels;
    double lowest;   /* of all other heights, metres */
    uint64_t absurd; /* values further from 0 than unit->absurd_m */
    double absurd_value;
} bake_validity;

/* What the raster's bands and --nodata say. */
void bake_validity_open(const bake_options *options, GDALDatasetH set, const bake_unit *unit,
                        bake_validity *validity);
/* Reads the masks of `rows` rows from `top` on; values that they exclude become NaN. `room` holds
 * as many floats as there are values. 0 or -1 (said). */
int bake_validity_mask(const bake_validity *validity, uint32_t width, uint32_t top, uint32_t rows,
                       double *values, float *room);
int bake_validity_which(const bake_validity *validity, double value);
/* Index of the sentinel that `value` is, or -1. */
static inline int bake_validity_sentinel(const bake_validity *validity, double value)
{
    return value <= validity->sentinel[0] ? bake_validity_which(validity, value) : -1;
}
/* 1 when a value that is no sentinel is no height either; counted when it is absurd. */
int bake_validity_is_void(bake_validity *validity, const bake_unit *unit, double value);
/* Says what was noticed. Samples of a sentinel that lies apart from all heights become NaN in the
 * grid, and are added to ground->voids; any other sentinel is a height. 0 or -1 (said). */
int bake_validity_settle(const bake_validity *validity, const bake_unit *unit, bake_ground *ground);

#endif
