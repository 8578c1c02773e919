#include "bake_seam.h"

#include "../bake_say.h"
#include "bake_place.h"
#include "bake_view.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STRIP_ROWS 64

/* Columns of a raster, and the longest run of them in which there is nothing. */
typedef struct column_run {
    int from, to;            /* the longest so far */
    int open_from, open_end; /* the one that may go on */
} column_run;

static void add_empty(column_run *run, int from, int to)
{
    if (from != run->open_end) run->open_from = from;
    run->open_end = to;
    if (to - run->open_from > run->to - run->from) {
        run->from = run->open_from;
        run->to = to;
    }
}

/* Asks the driver for the empty ones among the columns from..to. 0, or -1 when it cannot tell. */
static int ask_columns(GDALRasterBandH band, int from, int to, column_run *run)
{
    int has = GDALGetDataCoverageStatus(band, from, 0, to - from, GDALGetRasterBandYSize(band), 0,
                                        NULL);
    if (has & GDAL_DATA_COVERAGE_STATUS_UNIMPLEMENTED) return -1;
    if (!(has & GDAL_DATA_COVERAGE_STATUS_EMPTY)) return 0;
    if (!(has & GDAL_DATA_COVERAGE_STATUS_DATA)) {
        add_empty(run, from, to);
        return 0;
    }
    int middle = from + (to - from) / 2;
    if (middle == from) return 0;
    return ask_columns(band, from, middle, run) || ask_columns(band, middle, to, run) ? -1 : 0;
}

/* Reads the mask, and marks the columns in which anything is valid. 0 or -1. */
static int read_columns(GDALRasterBandH band, uint8_t *mask, uint8_t *valid)
{
    int width = GDALGetRasterBandXSize(band), height = GDALGetRasterBandYSize(band);
    for (int top = 0; top < height; top += STRIP_ROWS) {
        int rows = height - top < STRIP_ROWS ? height - top : STRIP_ROWS;
        if (GDALRasterIO(GDALGetMaskBand(band), GF_Read, 0, top, width, rows, mask, width, rows,
                         GDT_Byte, 0, 0) != CE_None)
            return -1;
        for (int j = 0; j < rows; j++)
            for (int i = 0; i < width; i++) valid[i] |= mask[(size_t)j * width + i];
    }
    return 0;
}

/* Finds the longest run of columns in which all is void. 0 or -1. */
static int find_void_columns(GDALRasterBandH band, column_run *run)
{
    size_t width = (size_t)GDALGetRasterBandXSize(band);
    if (GDALGetMaskFlags(band) & GMF_ALL_VALID) return 0;
    uint8_t *memory = calloc(STRIP_ROWS + 1, width);
    int rc = memory ? read_columns(band, memory + width, memory) : -1;
    for (int i = 0; !rc && i < (int)width; i++)
        if (!memory[i]) add_empty(run, i, i + 1);
    free(memory);
    return rc;
}

/* Columns in 360 degrees, when the raster is one of degrees that goes all round; else 0. */
static int columns_round(GDALDatasetH set)
{
    double gt[6];
    int width = GDALGetRasterXSize(set), height = GDALGetRasterYSize(set);
    OGRSpatialReferenceH srs = GDALGetSpatialRef(set);
    if (GDALGetGeoTransform(set, gt) != CE_None || !(gt[1] > 0) || gt[2] != 0 || gt[4] != 0)
        return 0;
    if (srs ? !OSRIsGeographic(srs)
            : !bake_place_looks_geographic(gt, (uint32_t)width, (uint32_t)height))
        return 0;
    double degree = srs ? OSRGetAngularUnits(srs, NULL) * 57.29577951308232 : 1,
           round = 360 / (gt[1] * degree);
    int whole = (int)fmin(nearbyint(round), 1e9);
    return fabs(round - whole) < 0.01 && width - whole <= 2 && width >= whole ? whole : 0;
}

/* Lays the first `columns` columns of `set` over those of `view` from `at` on. */
static int lay_behind(GDALDatasetH set, GDALDatasetH view, int columns, int at)
{
    int height = GDALGetRasterYSize(set), bands = GDALGetRasterCount(set), rc = 0;
    for (int n = 1; n <= bands + 1 && !rc; n++) {
        GDALRasterBandH from = GDALGetRasterBand(set, n > bands ? 1 : n),
                        to = GDALGetRasterBand(view, n > bands ? 1 : n);
        if (n > bands && !(GDALGetMaskFlags(from) & GMF_PER_DATASET)) break;
        if (n > bands && GDALGetMaskFlags(from) & (GMF_ALPHA | GMF_NODATA)) break;
        if (n > bands) {
            from = GDALGetMaskBand(from);
            to = GDALGetMaskBand(to);
        }
        rc = VRTAddSimpleSource((VRTSourcedRasterBandH)to, from, 0, 0, columns, height, at, 0,
                                columns, height, "near", VRT_NODATA_UNSET) == CE_None
                 ? 0
                 : -1;
    }
    return rc;
}

static GDALDatasetH make_view(GDALDatasetH set, int from, int columns)
{
    char number[2][20];
    snprintf(number[0], sizeof number[0], "%d", from);
    snprintf(number[1], sizeof number[1], "%d", columns);
    char rows[20];
    snprintf(rows, sizeof rows, "%d", GDALGetRasterYSize(set));
    const char *word[] = { "-srcwin", number[0], "0", number[1], rows };
    char **list = NULL;
    for (size_t i = 0; i < sizeof word / sizeof *word; i++) list = CSLAddString(list, word[i]);
    return bake_view(set, list);
}

static int is_most(const column_run *run, int round) { return 2 * (run->to - run->from) > round; }

GDALDatasetH bake_seam_join(const char *path, GDALDatasetH set)
{
    int round = columns_round(set), width = GDALGetRasterXSize(set);
    column_run run = { 0 };
    GDALRasterBandH band = GDALGetRasterBand(set, 1);
    if (!round) return set;
    if (ask_columns(band, 0, width, &run) || !is_most(&run, round)) {
        run = (column_run){ 0 };
        if (find_void_columns(band, &run) || !is_most(&run, round)) return set;
    }
    int joins = run.from > 0 && run.to < width, from = run.to < width ? run.to : 0,
        columns = joins ? round - run.to + run.from : width - (run.to - run.from);
    if (columns < 2) return set; /* no ground: refused when it is read */
    CPLErrorReset();
    GDALDatasetH view = make_view(set, from, columns);
    int rc = view ? 0 : -1;
    if (!rc && joins) rc = lay_behind(set, view, run.from, round - run.to);
    if (rc) bake_fail_gdal("%s: cannot join it at 180 degrees", path);
    if (!rc && joins) bake_note("%s: its two ends are joined at 180 degrees", path);
    GDALReleaseDataset(set);
    if (!rc) return view;
    if (view) GDALClose(view);
    return NULL;
}
