/* Where an image lies over the ground. */
#include "bake_image_local.h"
#include "../bake_say.h"
#include "../raster/bake_area.h"
#include "../raster/bake_place.h"
#include "../raster/bake_view.h"
#include "../raster/bake_warp.h"

#include <math.h>
#include <stdio.h>

/* Edges, in pixels of the heights' raster, of an image without georeference. Such an image covers
 * the whole area of the raster's pixels; or, when it has one pixel for each cell between samples
 * (or a multiple of that), the area from the first sample to the last. */
static void stretched_edges(uint32_t image_size, uint32_t raster_size, double *low, double *high)
{
    int per_cell = image_size % raster_size != 0 && image_size % (raster_size - 1) == 0;
    *low = per_cell ? 0.5 : 0;
    *high = raster_size - *low;
}

/* The geotransform of an image without georeference: its pixels lie where the raster's lie, however
 * that is turned. */
static void stretched_place(const bake_ground *ground, GDALDatasetH set, double *place)
{
    const double *gt = ground->source_geotransform;
    double left, right, top, bottom;
    int columns = GDALGetRasterXSize(set), rows = GDALGetRasterYSize(set);
    stretched_edges((uint32_t)columns, ground->source_width, &left, &right);
    stretched_edges((uint32_t)rows, ground->source_height, &top, &bottom);
    double across = (right - left) / columns, down = (bottom - top) / rows;
    place[0] = gt[0] + gt[1] * left + gt[2] * top;
    place[1] = gt[1] * across;
    place[2] = gt[2] * down;
    place[3] = gt[3] + gt[4] * left + gt[5] * top;
    place[4] = gt[4] * across;
    place[5] = gt[5] * down;
}

static char **add_reference(char **list, const char *flag, OGRSpatialReferenceH srs)
{
    char *wkt = NULL;
    if (!srs || OSRExportToWkt(srs, &wkt) != OGRERR_NONE) return list;
    list = CSLAddString(CSLAddString(list, flag), wkt);
    CPLFree(wkt);
    return list;
}

static char **add_numbers(char **list, const char *flag, const double *number, int count)
{
    char text[40];
    list = CSLAddString(list, flag);
    for (int i = 0; i < count; i++) {
        snprintf(text, sizeof text, "%.12g", number[i]);
        list = CSLAddString(list, text);
    }
    return list;
}

/* Makes a view of the image that names its reference system. */
static GDALDatasetH name_reference(GDALDatasetH set, OGRSpatialReferenceH srs)
{
    return bake_view(set, add_reference(NULL, "-a_srs", srs));
}

/* Makes a view of the image that lies where the source raster lies. */
static GDALDatasetH lay_over_source(const bake_ground *ground, GDALDatasetH set)
{
    double place[6];
    stretched_place(ground, set, place);
    GDALDatasetH laid = name_reference(set, ground->source_srs);
    if (laid) GDALSetGeoTransform(laid, place);
    return laid;
}

/* Makes a view of the image warped onto the ground's plane, as far as it reaches over its area, in
 * about its own resolution. */
static GDALDatasetH warp_onto_ground(const bake_ground *ground, GDALDatasetH set,
                                     const bake_area *reach, const bake_shift *shift)
{
    const double *gt = ground->geotransform;
    double y0 = gt[3], y1 = gt[3] + gt[5] * ground->grid.height;
    double area[4] = { fmax(gt[0], reach->west), fmax(fmin(y0, y1), reach->south),
                       fmin(gt[0] + gt[1] * ground->grid.width, reach->east),
                       fmin(fmax(y0, y1), reach->north) };
    char **list = CSLAddString(CSLAddString(NULL, "-of"), "VRT");
    list = CSLAddString(CSLAddString(list, "-r"), "bilinear");
    list = CSLAddString(list, "-dstalpha");
    list = CSLAddString(CSLAddString(list, "-wo"), "XSCALE=1"); /* else what is turned blurs */
    list = CSLAddString(CSLAddString(list, "-wo"), "YSCALE=1");
    list = add_reference(list, "-t_srs", ground->srs);
    if (*shift->operation) list = CSLAddString(CSLAddString(list, "-ct"), shift->operation);
    list = add_numbers(list, "-te", area, 4);
    GDALWarpAppOptions *options = GDALWarpAppOptionsNew(list, NULL);
    GDALDatasetH warped = GDALWarp("", NULL, 1, &set, options, NULL);
    GDALWarpAppOptionsFree(options);
    CSLDestroy(list);
    return warped;
}

/* An image whose coordinates have no named reference system has the heights', as they were read or
 * as they were projected: the one in whose plane it lies over them. */
static OGRSpatialReferenceH reference_for(const bake_ground *ground, GDALDatasetH set)
{
    double gt[6];
    GDALGetGeoTransform(set, gt);
    bake_area image = bake_area_of(gt, (uint32_t)GDALGetRasterXSize(set),
                                   (uint32_t)GDALGetRasterYSize(set)),
              source = bake_area_of(ground->source_geotransform, ground->source_width,
                                    ground->source_height),
              now = bake_area_of(ground->geotransform, ground->grid.width, ground->grid.height);
    if (bake_area_meets(&image, &source)) return ground->source_srs;
    return bake_area_meets(&image, &now) ? ground->srs : NULL;
}

/* Whether any of the image comes to lie on the ground, told before a pixel is read, and which area
 * it then has; -1 (said). */
static int meets_ground(const bake_ground *ground, GDALDatasetH set, const bake_shift *shift,
                        bake_area *reach)
{
    void *transform = bake_warp_transform(set, ground->srs, shift);
    double gt[6], extent[4];
    int columns, rows;
    if (!transform) return -1;
    int ok = GDALSuggestedWarpOutput2(set, GDALGenImgProjTransform, transform, gt, &columns, &rows,
                                      extent, 0) == CE_None;
    GDALDestroyGenImgProjTransformer(transform);
    if (!ok) return 0;
    bake_area here = bake_area_of(ground->geotransform, ground->grid.width, ground->grid.height);
    *reach = (bake_area){ extent[0], extent[1], extent[2], extent[3] };
    return bake_area_meets(reach, &here);
}

static int check_bands(const char *path, GDALDatasetH set)
{
    int bands = GDALGetRasterCount(set);
    if (bands < 1) return bake_fail("%s: no image in it", path);
    for (int i = 1; i <= bands && i <= 3; i++)
        if (GDALGetRasterDataType(GDALGetRasterBand(set, i)) != GDT_Byte)
            return bake_fail("%s: an image of 8 bits a band is wanted", path);
    return 0;
}

/* Tells where the set's edges are, whose rows run from west to east and from north to south. */
static void place(const bake_ground *ground, bake_picture *picture, const double *lies)
{
    double west = lies[0], east = lies[0] + lies[1] * GDALGetRasterXSize(picture->set);
    double north = lies[3], south = lies[3] + lies[5] * GDALGetRasterYSize(picture->set);
    const double *gt = ground->geotransform;
    double spacing = gt[1], south_edge = gt[5] < 0 ? gt[3] + gt[5] * ground->grid.height : gt[3];
    double x0 = gt[0] + spacing / 2, y0 = south_edge + spacing / 2;
    picture->west = (west - x0) / spacing;
    picture->east = (east - x0) / spacing;
    picture->south = (south - y0) / spacing;
    picture->north = (north - y0) / spacing;
    picture->width = (uint32_t)GDALGetRasterXSize(picture->set);
    picture->height = (uint32_t)GDALGetRasterYSize(picture->set);
}

bake_picture bake_picture_of(const bake_ground *ground, GDALDatasetH set)
{
    bake_picture picture = { .set = set };
    double gt[6];
    GDALGetGeoTransform(set, gt);
    place(ground, &picture, gt);
    return picture;
}

/* Puts a view in front of the present set. 0, or -1 when it could not be made (said). */
static int stack_view(bake_picture *picture, GDALDatasetH view, const char *path)
{
    if (!view) return bake_fail_gdal("%s: cannot lay the image over the ground", path);
    picture->behind[picture->behind_count++] = picture->set;
    picture->set = view;
    return 0;
}

/* Names the reference system of an image that has a place and none. 0 or -1 (said). */
static int find_reference(const bake_ground *ground, const char *path, bake_picture *picture)
{
    if (!ground->srs || GDALGetSpatialRef(picture->set)) return 0;
    OGRSpatialReferenceH srs = reference_for(ground, picture->set);
    if (!srs)
        return bake_fail("%s names no reference system, and in the heights' own it shows nothing "
                         "of this ground: name it with gdal_translate -a_srs",
                         path);
    bake_note("%s names no reference system: taken as the heights'%s", path,
              srs == ground->srs ? " after projection" : "");
    return stack_view(picture, name_reference(picture->set, srs), path);
}

/* Chooses how the image gets from its datum to the ground's: over the ground's own area, so that an
 * image on the datum that the heights came from goes their way. 0 or -1 (said). */
static int find_shift(const bake_ground *ground, const char *path, GDALDatasetH set,
                      bake_shift *shift)
{
    bake_area degrees;
    *shift = (bake_shift){ 0 };
    if (!ground->srs || !ground->source_srs ||
        bake_shift_area(ground->source_srs, ground->source_geotransform, ground->source_width,
                        ground->source_height, &degrees))
        return 0;
    return bake_shift_find(path, GDALGetSpatialRef(set), ground->srs, &degrees,
                           "project it first with gdalwarp", shift);
}

static int lay_picture(const bake_ground *ground, const char *path, bake_picture *picture)
{
    double gt[6];
    int own_place = GDALGetGeoTransform(picture->set, gt) == CE_None && ground->has_place;
    if (!own_place && ground->has_place && bake_place_check(path, picture->set)) return -1;
    if (!own_place) stretched_place(ground, picture->set, gt);
    if (!own_place && !ground->resampled && gt[1] > 0 && gt[5] < 0 && gt[2] == 0 && gt[4] == 0) {
        place(ground, picture, gt);
        return 0;
    }
    if (!own_place && stack_view(picture, lay_over_source(ground, picture->set), path)) return -1;
    if (own_place && find_reference(ground, path, picture)) return -1;
    bake_shift shift;
    if (find_shift(ground, path, picture->set, &shift)) return -1;
    bake_area reach;
    int meets = meets_ground(ground, picture->set, &shift, &reach);
    if (meets < 0) return -1;
    if (!meets) return bake_fail("%s: the image shows nothing of this ground", path);
    if (stack_view(picture, warp_onto_ground(ground, picture->set, &reach, &shift), path))
        return -1;
    double columns = GDALGetRasterXSize(picture->set), rows = GDALGetRasterYSize(picture->set);
    if (columns * rows > BAKE_SAMPLES_MAX)
        return bake_fail(
            "%s: its resolution over its part of the ground makes %.0f x %.0f pixels, more than %g: "
            "make it coarser (gdalwarp -tr), or the heights fewer (gdal_translate -projwin)",
            path, columns, rows, BAKE_SAMPLES_MAX);
    GDALGetGeoTransform(picture->set, gt);
    if (own_place) bake_shift_note(path, &shift, gt[1]);
    place(ground, picture, gt);
    return 0;
}

int bake_picture_open(const bake_options *o, const bake_ground *ground, bake_picture *picture)
{
    CPLErrorReset();
    *picture = (bake_picture){ .set = GDALOpen(o->color_path, GA_ReadOnly) };
    if (!picture->set) return bake_fail_gdal("cannot read %s", o->color_path);
    int rc = check_bands(o->color_path, picture->set);
    GDALDatasetH view[BAKE_COLOUR_VIEWS_MAX];
    int views = rc ? 0 : bake_colour_views(picture->set, o->color_path, view);
    if (views < 0) rc = -1;
    for (int i = 0; i < views; i++) stack_view(picture, view[i], o->color_path);
    if (!rc) rc = lay_picture(ground, o->color_path, picture);
    if (rc) bake_picture_close(picture);
    return rc;
}

void bake_picture_close(bake_picture *picture)
{
    if (picture->set) GDALClose(picture->set);
    while (picture->behind_count > 0) GDALClose(picture->behind[--picture->behind_count]);
    *picture = (bake_picture){ 0 };
}

int bake_picture_row(const bake_picture *picture, uint32_t row, uint8_t *rgba)
{
    CPLErrorReset();
    if (bake_colour_read(picture->set, (int)row, 1, rgba))
        return bake_fail_gdal("cannot read row %u of the image", row);
    return 0;
}
