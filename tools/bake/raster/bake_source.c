#include "bake_source.h"

#include "bake_area.h"
#include "../bake_say.h"
#include "bake_place.h"
#include "bake_seam.h"
#include "bake_turn.h"
#include "bake_colour.h"
#include "bake_rgb.h"
#include "bake_unit.h"
#include "bake_validity.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STRIP_SAMPLES_MAX (2u << 20)
#define WHOLE_TOLERANCE_M 1e-3 /* single precision at 10 km keeps this */

/* What is found out while all values are read. */
typedef struct source_scan {
    bake_unit unit;
    bake_validity validity;
    int whole_values, whole_metres;
    uint64_t voids;
} source_scan;

static GDALDatasetH open_raw_file(const bake_options *o)
{
    char xml[5000];
    char *path = CPLEscapeString(o->heights_path, -1, CPLES_XML);
    snprintf(
        xml, sizeof xml,
        "<VRTDataset rasterXSize=\"%u\" rasterYSize=\"%u\"><VRTRasterBand dataType=\"%s\" band=\"1\" "
        "subClass=\"VRTRawRasterBand\"><SourceFilename relativetoVRT=\"0\">%s</SourceFilename>"
        "<ImageOffset>0</ImageOffset><PixelOffset>2</PixelOffset><LineOffset>%u</LineOffset><ByteOrder>%s</ByteOrder>"
        "</VRTRasterBand></VRTDataset>",
        o->raw.width, o->raw.height, o->raw.is_signed ? "Int16" : "UInt16", path, o->raw.width * 2,
        o->raw.big_endian ? "MSB" : "LSB");
    CPLFree(path);
    return GDALOpen(xml, GA_ReadOnly);
}

/* A raw file must have exactly the size that --raw tells: a wrong width would shear the ground
 * without a word. */
static int check_raw_size(const bake_options *o)
{
    FILE *file = fopen(o->heights_path, "rb");
    if (!file) return bake_fail("%s: %s", o->heights_path, strerror(errno));
    fseek(file, 0, SEEK_END);
    long long bytes = ftello(file), wanted = 2ll * o->raw.width * o->raw.height;
    fclose(file);
    if (bytes != wanted)
        return bake_fail("%s: %lld bytes, but --raw %ux%u needs %lld", o->heights_path, bytes,
                         o->raw.width, o->raw.height, wanted);
    return 0;
}

static GDALDatasetH open_raster(const bake_options *o)
{
    CPLErrorReset();
    if (o->raw.width && check_raw_size(o)) return NULL;
    GDALDatasetH set = o->raw.width ? open_raw_file(o) : GDALOpen(o->heights_path, GA_ReadOnly);
    if (!set) {
        VSIStatBufL there;
        if (!VSIStatL(o->heights_path, &there) && !GDALIdentifyDriver(o->heights_path, NULL))
            bake_fail("cannot read %s: no raster that GDAL knows; bare 16-bit heights need --raw",
                      o->heights_path);
        else
            bake_fail_gdal("cannot read %s", o->heights_path);
        return NULL;
    }
    int width = GDALGetRasterXSize(set), height = GDALGetRasterYSize(set);
    if (GDALGetRasterCount(set) < 1) {
        bake_fail("%s: no raster in it by itself; name one of its subdatasets (see gdalinfo)",
                  o->heights_path);
    } else if (width < 2 || height < 2) {
        bake_fail("%s: %d x %d samples; ground needs at least 2 rows and 2 columns",
                  o->heights_path, width, height);
    } else if ((double)width * height > BAKE_SAMPLES_MAX) {
        bake_fail("%s: %d x %d samples, more than %g: cut a part with gdal_translate -projwin",
                  o->heights_path, width, height, BAKE_SAMPLES_MAX);
    } else {
        return set;
    }
    GDALClose(set);
    return NULL;
}

/* Turns a row of raster values into metres; voids become NaN. */
static void scan_row(const double *values, float *metres, uint32_t count, source_scan *scan)
{
    for (uint32_t i = 0; i < count; i++) {
        double value = values[i], z = value * scan->unit.scale + scan->unit.offset;
        int sentinel = bake_validity_sentinel(&scan->validity, value);
        if (sentinel >= 0) {
            metres[i] = (float)fmax(z, -FLT_MAX);
            scan->validity.sentinel_samples[sentinel]++;
            continue;
        }
        if (bake_validity_is_void(&scan->validity, &scan->unit, value)) {
            metres[i] = NAN;
            scan->voids++;
            continue;
        }
        metres[i] = (float)z;
        if (scan->whole_values && value != nearbyint(value)) scan->whole_values = 0;
        if (scan->whole_metres && fabs(z - nearbyint(z)) > WHOLE_TOLERANCE_M)
            scan->whole_metres = 0;
    }
}

static int read_strip(GDALDatasetH set, uint32_t top, uint32_t rows, double *values, float *metres,
                      bake_ground *ground, source_scan *scan)
{
    uint32_t width = ground->grid.width;
    CPLErrorReset();
    int rc = 0;
    if (scan->unit.is_rgb)
        rc = bake_rgb_read(set, width, top, rows, values, metres);
    else
        rc = GDALRasterIO(GDALGetRasterBand(set, 1), GF_Read, 0, (int)top, (int)width, (int)rows,
                          values, (int)width, (int)rows, GDT_Float64, 0, 0) != CE_None;
    if (rc) return bake_fail_gdal("cannot read rows %u to %u", top, top + rows - 1);
    if (bake_validity_mask(&scan->validity, width, top, rows, values, metres)) return -1;
    for (uint32_t row = 0; row < rows; row++)
        scan_row(values + (size_t)row * width, metres + (size_t)row * width, width, scan);
    return bake_pwrite(ground->grid.fd, metres, (size_t)rows * width * sizeof *metres,
                       (uint64_t)top * width * sizeof *metres);
}

static int read_heights(GDALDatasetH set, bake_ground *ground, source_scan *scan)
{
    uint32_t width = ground->grid.width, height = ground->grid.height;
    int block_x, block_y;
    GDALGetBlockSize(GDALGetRasterBand(set, 1), &block_x, &block_y);
    uint32_t strip = STRIP_SAMPLES_MAX / width;
    if (strip > (uint32_t)block_y && block_y > 0) strip -= strip % (uint32_t)block_y;
    if (strip < 1) strip = 1;
    if (strip > height) strip = height;
    double *values = malloc((size_t)strip * width * sizeof *values);
    float *metres = malloc((size_t)strip * width * sizeof *metres);
    int rc = values && metres ? 0 : bake_fail("out of memory");
    for (uint32_t top = 0; !rc && top < height; top += strip) {
        uint32_t rows = height - top < strip ? height - top : strip;
        rc = read_strip(set, top, rows, values, metres, ground, scan);
        bake_progress("reading", top + rows, height);
    }
    free(values);
    free(metres);
    return rc;
}

static int read_all(const bake_options *o, GDALDatasetH set, bake_ground *ground)
{
    bake_rgb rgb;
    uint32_t width = (uint32_t)GDALGetRasterXSize(set), height = (uint32_t)GDALGetRasterYSize(set);
    if (bake_rgb_choose(o, set, &rgb) || bake_place_read(o, set, ground)) return -1;
    source_scan scan = { .unit = bake_unit_read(o, set, &rgb, ground),
                         .whole_values = 1,
                         .whole_metres = 1 };
    bake_validity_open(o, set, &scan.unit, &scan.validity);
    if (bake_grid_open(&ground->grid, width, height, sizeof(float))) return -1;
    if (read_heights(set, ground, &scan)) return -1;
    ground->source_width = width;
    ground->source_height = height;
    memcpy(ground->source_geotransform, ground->geotransform, sizeof ground->geotransform);
    if (ground->srs) ground->source_srs = OSRClone(ground->srs);
    if (ground->has_place && bake_turn(&ground->grid, ground->geotransform)) return -1;
    ground->voids = scan.voids;
    if (bake_validity_settle(&scan.validity, &scan.unit, ground)) return -1;
    if (ground->voids == (uint64_t)width * height)
        return bake_fail("%s: not one valid height in %u x %u samples", o->heights_path, width,
                         height);
    if (scan.whole_values) {
        ground->step_m = scan.unit.scale;
        ground->base_m = scan.unit.offset;
    } else if (scan.whole_metres)
        ground->step_m = 1;
    return 0;
}

/* Reads a raster, of a palette its colours. */
static int read_set(const bake_options *o, GDALDatasetH set, bake_ground *ground)
{
    GDALDatasetH view[1 + BAKE_COLOUR_VIEWS_MAX] = { set };
    int is_palette = o->rgb != BAKE_RGB_NONE && bake_rgb_is_palette(set),
        views = is_palette ? bake_colour_views(set, o->heights_path, view + 1) : 0;
    int rc = views < 0 ? -1 : read_all(o, view[views], ground);
    for (; views > 0; views--) GDALClose(view[views]);
    return rc;
}

int bake_source_read(const bake_options *o, GDALDatasetH set, bake_ground *ground)
{
    *ground = (bake_ground){ .grid = BAKE_GRID_CLOSED };
    GDALDatasetH own = set ? NULL : open_raster(o);
    if (own && !o->raw.width) own = bake_seam_join(o->heights_path, own);
    bake_texts told = BAKE_TEXTS(o);
    int rc = set || own ? read_set(o, set ? set : own, ground) : -1;
    if (!rc) bake_about_read(&told, set ? set : own, &ground->about);
    if (own) GDALClose(own);
    if (rc) bake_ground_close(ground);
    return rc;
}

void bake_ground_forget_place(bake_ground *ground)
{
    double plain[6] = { 0, 1, 0, ground->grid.height, 0, -1 };
    memcpy(ground->geotransform, plain, sizeof plain);
    memcpy(ground->source_geotransform, plain, sizeof plain);
    ground->has_place = ground->is_geographic = 0;
    if (ground->srs) OSRDestroySpatialReference(ground->srs);
    ground->srs = NULL;
}

void bake_ground_close(bake_ground *ground)
{
    bake_grid_close(&ground->grid);
    if (ground->srs) OSRDestroySpatialReference(ground->srs);
    if (ground->source_srs) OSRDestroySpatialReference(ground->source_srs);
    ground->srs = ground->source_srs = NULL;
}
