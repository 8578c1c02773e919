/* The raster of a draw as a file, see property_surface.h. */
#include "property_surface.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    const char *driver, *ending, *option;
} formats[FILES] = {
    { "GTiff", "tif", NULL },   { "VRT", "vrt", NULL }, { "PNG", "png", "WORLDFILE=YES" },
    { "AAIGrid", "asc", NULL }, { NULL, "r16", NULL },  { "netCDF", "nc", NULL },
    { "SRTMHGT", "hgt", NULL }
};

/* Headerless, little-endian, 16 bits without a sign. */
static int write_raw(const property_draw *d, const property_raster *r, const char *path)
{
    FILE *file = fopen(path, "wb");
    if (!file) return -1;
    for (int n = 0; n < d->columns * d->rows; n++) {
        unsigned value = (unsigned)r->value[n];
        putc((int)(value & 255), file);
        putc((int)(value >> 8), file);
    }
    return fclose(file);
}

static void describe(const property_draw *d, GDALDatasetH set)
{
    GDALRasterBandH band = GDALGetRasterBand(set, 1);
    OGRSpatialReferenceH srs = property_reference(d->place->srs);
    if (!d->place->srs || *d->place->srs) GDALSetGeoTransform(set, (double *)d->gt);
    if (srs) {
        GDALSetSpatialRef(set, srs);
        OSRDestroySpatialReference(srs);
    }
    if (d->level[PROPERTY_TRANSFORM] == TRANSFORM_POINT)
        GDALSetMetadataItem(set, "AREA_OR_POINT", "Point", NULL);
    int voids = d->level[PROPERTY_VOIDS];
    if (voids == VOIDS_NODATA || (voids == VOIDS_NAN && d->number % 2))
        GDALSetRasterNoDataValue(band, d->nodata);
    if (*d->unit) GDALSetRasterUnitType(band, d->unit);
    if (!property_has(d, OPTION_SCALE)) return;
    GDALSetRasterScale(band, d->scale);
    GDALSetRasterOffset(band, d->offset);
}

static int write_band(const property_draw *d, GDALRasterBandH band, void *values, GDALDataType type)
{
    return GDALRasterIO(band, GF_Write, 0, 0, d->columns, d->rows, values, d->columns, d->rows,
                        type, 0, 0) != CE_None;
}

/* Which samples are valid, as a mask or an alpha band. */
static int write_valid(const property_draw *d, const property_raster *r, GDALDatasetH set)
{
    int voids = d->level[PROPERTY_VOIDS], count = d->columns * d->rows;
    if (voids != VOIDS_MASK && voids != VOIDS_ALPHA) return 0;
    uint8_t *valid = malloc((size_t)count);
    if (!valid) return -1;
    for (int n = 0; n < count; n++) valid[n] = r->mark[n] ? 0 : 255;
    GDALRasterBandH band = NULL;
    if (voids == VOIDS_ALPHA) {
        band = GDALGetRasterBand(set, 2);
        GDALSetRasterColorInterpretation(band, GCI_AlphaBand);
    } else if (GDALCreateDatasetMaskBand(set, GMF_PER_DATASET) == CE_None) {
        band = GDALGetMaskBand(GDALGetRasterBand(set, 1));
    }
    int rc = band ? write_band(d, band, valid, GDT_Byte) : -1;
    free(valid);
    return rc;
}

/* Odd numbers keep their mask in a file beside. */
static int write_tiff(const property_draw *d, const property_raster *r, const char *path)
{
    CPLSetConfigOption("GDAL_TIFF_INTERNAL_MASK", d->number % 2 ? "NO" : "YES");
    int bands = d->level[PROPERTY_VOIDS] == VOIDS_ALPHA ? 2 : 1;
    char **settings = CSLSetNameValue(NULL, "TILED", d->number % 3 ? "NO" : "YES");
    GDALDatasetH set = GDALCreate(GDALGetDriverByName("GTiff"), path, d->columns, d->rows, bands,
                                  d->type, settings);
    CSLDestroy(settings);
    if (!set) return -1;
    describe(d, set);
    int rc = write_band(d, GDALGetRasterBand(set, 1), r->value, GDT_Float64);
    if (!rc) rc = write_valid(d, r, set);
    GDALClose(set);
    return rc;
}

static int copy(const char *from, int file, const char *to)
{
    char **settings = NULL;
    if (formats[file].option) settings = CSLAddString(settings, formats[file].option);
    GDALDatasetH set = GDALOpen(from, GA_ReadOnly);
    GDALDatasetH made = set ? GDALCreateCopy(GDALGetDriverByName(formats[file].driver), to, set, 0,
                                             settings, NULL, NULL)
                            : NULL;
    CSLDestroy(settings);
    if (made) GDALClose(made);
    if (set) GDALClose(set);
    return made ? 0 : -1;
}

int property_raster_write(const property_draw *d, const property_raster *raster, const char *folder,
                          char *path, size_t size)
{
    char tiff[1000];
    int file = d->level[PROPERTY_FILE];
    snprintf(path, size, "%s/draw-%u.%s", folder, d->number, formats[file].ending);
    if (file == FILE_HGT) /* named by its south-west corner */
        snprintf(path, size, "%s/%c%02d%c%03d.hgt", folder, d->latitude < 0 ? 'S' : 'N',
                 abs((int)floor(d->latitude)), d->longitude < 0 ? 'W' : 'E',
                 abs((int)floor(d->longitude)));
    if (file == FILE_RAW) return write_raw(d, raster, path);
    if (file == FILE_GTIFF) return write_tiff(d, raster, path);
    snprintf(tiff, sizeof tiff, "%s/draw-%u.tif", folder, d->number);
    return write_tiff(d, raster, tiff) || copy(tiff, file, path) ? -1 : 0;
}
