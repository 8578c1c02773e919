#include "bake_validity.h"

#include "../bake_say.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

/* A sentinel lies at least so far below the lowest height; next to heights it is one itself, such
 * as the floor of a trench. */
#define APART_M 100

/* What programs write for void, and often do not declare. */
static const double sentinels[BAKE_SENTINELS_MAX] = { -9999,  -32768,   -32767,   -99999,
                                                      -10000, -FLT_MAX, -DBL_MAX, -999999 };

/* Of encoded colours: the lowest height, where nothing was drawn. */
static const double black[BAKE_SENTINELS_MAX] = { 0, NAN, NAN, NAN, NAN, NAN, NAN, NAN };

static void add_mask(bake_validity *validity, GDALRasterBandH band)
{
    if (validity->mask_count < BAKE_MASKS_MAX) validity->mask[validity->mask_count++] = band;
}

/* GDAL's mask, unless it only repeats the nodata value; and an alpha band of any type, of which
 * GDAL makes a mask only beside one or three bands of 8 or 16 bits. */
static void find_masks(GDALDatasetH set, bake_validity *validity)
{
    GDALRasterBandH band = GDALGetRasterBand(set, 1);
    int flags = GDALGetMaskFlags(band);
    if (!(flags & GMF_ALL_VALID) && flags != GMF_NODATA) add_mask(validity, GDALGetMaskBand(band));
    for (int i = 2; i <= GDALGetRasterCount(set) && !(flags & GMF_ALPHA); i++)
        if (GDALGetRasterColorInterpretation(GDALGetRasterBand(set, i)) == GCI_AlphaBand)
            add_mask(validity, GDALGetRasterBand(set, i));
}

static void find_nodata(GDALRasterBandH band, bake_validity *validity)
{
    GDALDataType type = GDALGetRasterDataType(band);
    if (type == GDT_Int64)
        validity->nodata = (double)GDALGetRasterNoDataValueAsInt64(band, &validity->has_nodata);
    else if (type == GDT_UInt64)
        validity->nodata = (double)GDALGetRasterNoDataValueAsUInt64(band, &validity->has_nodata);
    else
        validity->nodata = GDALGetRasterNoDataValue(band, &validity->has_nodata);
}

void bake_validity_open(const bake_options *o, GDALDatasetH set, const bake_unit *unit,
                        bake_validity *validity)
{
    *validity = (bake_validity){ .lowest = INFINITY,
                                 .looks_for_sentinels = !o->nodata.is_given,
                                 .sentinel = unit->is_rgb ? black : sentinels };
    find_masks(set, validity);
    find_nodata(GDALGetRasterBand(set, 1), validity);
    if (unit->is_rgb) validity->nodata *= 0x010101; /* the same in all bands */
    if (!o->nodata.is_given) return;
    validity->has_nodata = !o->nodata.is_none;
    validity->nodata = o->nodata.value;
    if (unit->is_rgb) validity->nodata = nearbyint((o->nodata.value - unit->offset) / unit->scale);
}

int bake_validity_mask(const bake_validity *validity, uint32_t width, uint32_t top, uint32_t rows,
                       double *values, float *room)
{
    for (int m = 0; m < validity->mask_count; m++) {
        CPLErrorReset();
        if (GDALRasterIO(validity->mask[m], GF_Read, 0, (int)top, (int)width, (int)rows, room,
                         (int)width, (int)rows, GDT_Float32, 0, 0) != CE_None)
            return bake_fail_gdal("cannot read the mask of rows %u to %u", top, top + rows - 1);
        for (size_t i = 0; i < (size_t)rows * width; i++)
            if (room[i] == 0) values[i] = NAN;
    }
    return 0;
}

static int is_nodata(const bake_validity *validity, double value)
{
    return validity->has_nodata &&
           (value == validity->nodata || (float)value == (float)validity->nodata);
}

int bake_validity_which(const bake_validity *validity, double value)
{
    if (!validity->looks_for_sentinels || is_nodata(validity, value)) return -1;
    for (int s = 0; s < BAKE_SENTINELS_MAX; s++)
        if (value == validity->sentinel[s]) return s;
    return -1;
}

int bake_validity_is_void(bake_validity *validity, const bake_unit *unit, double value)
{
    if (!isfinite(value) || is_nodata(validity, value)) return 1;
    double z = value * unit->scale + unit->offset;
    if (fabs(z) > unit->absurd_m) {
        if (!validity->absurd++) validity->absurd_value = value;
        return 1;
    }
    if (z < validity->lowest) validity->lowest = z;
    return 0;
}

/* Makes the samples of height z void. */
static int drop(bake_ground *ground, float z)
{
    const bake_grid *grid = &ground->grid;
    float *row = malloc(grid->width * sizeof *row);
    int rc = row ? 0 : bake_fail("out of memory");
    for (uint32_t j = 0; !rc && j < grid->height; j++) {
        rc = bake_grid_read(grid, j, 0, grid->width, row);
        for (uint32_t i = 0; !rc && i < grid->width; i++)
            if (row[i] == z) row[i] = NAN;
        if (!rc) rc = bake_grid_write(grid, j, 0, grid->width, row);
    }
    free(row);
    return rc;
}

static int settle_sentinel(const bake_validity *validity, const bake_unit *unit, int number,
                           bake_ground *ground)
{
    double value = validity->sentinel[number], z = value * unit->scale + unit->offset;
    uint64_t samples = validity->sentinel_samples[number];
    if (!samples) return 0;
    if (unit->is_rgb) value = z; /* as --nodata takes it */
    if (fabs(z) <= unit->absurd_m && z > validity->lowest - APART_M) {
        bake_note("%" PRIu64
                  " samples are %.9g, which often stands for void: taken as heights, like those "
                  "near it; --nodata %.9g makes them void",
                  samples, value, value);
        return 0;
    }
    bake_note("%" PRIu64 " samples are %.9g, which no nodata tag declares: taken as void; "
              "--nodata none takes them as heights",
              samples, value);
    ground->voids += samples;
    return drop(ground, (float)fmax(z, -FLT_MAX));
}

int bake_validity_settle(const bake_validity *validity, const bake_unit *unit, bake_ground *ground)
{
    if (validity->absurd)
        bake_note("%" PRIu64 " samples such as %.9g are beyond +-%.9g m, which no ground reaches: "
                  "taken as void",
                  validity->absurd, validity->absurd_value, unit->absurd_m);
    for (int s = 0; s < BAKE_SENTINELS_MAX; s++)
        if (settle_sentinel(validity, unit, s, ground)) return -1;
    return 0;
}
