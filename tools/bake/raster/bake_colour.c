#include "bake_colour.h"

#include "../bake_say.h"
#include "bake_view.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A view without a nodata value; takes `words` over. */
static GDALDatasetH translate(GDALDatasetH set, char **words)
{
    return bake_view(set, CSLAddString(CSLAddString(words, "-a_nodata"), "none"));
}

int bake_colour_has_alpha(GDALDatasetH set)
{
    GDALRasterBandH last = GDALGetRasterBand(set, GDALGetRasterCount(set));
    return GDALGetRasterCount(set) > 1 && GDALGetRasterColorInterpretation(last) == GCI_AlphaBand;
}

/* ---- palettes ---- */

/* A view of the palette's band whose nodata value is a transparent entry. */
static GDALDatasetH palette_view(GDALDatasetH set)
{
    int has_nodata;
    GDALRasterBandH band = GDALGetRasterBand(set, 1);
    double nodata = GDALGetRasterNoDataValue(band, &has_nodata);
    GDALDatasetH view = translate(set, CSLAddString(CSLAddString(NULL, "-b"), "1"));
    if (!view) return NULL;
    GDALColorTableH table = GDALCloneColorTable(GDALGetRasterColorTable(band));
    if (has_nodata && nodata >= 0 && nodata < GDALGetColorEntryCount(table)) {
        GDALColorEntry entry = *GDALGetColorEntry(table, (int)nodata);
        entry.c4 = 0;
        GDALSetColorEntry(table, (int)nodata, &entry);
    }
    GDALSetRasterColorTable(GDALGetRasterBand(view, 1), table);
    GDALDestroyColorTable(table);
    return view;
}

static int expand_palette(GDALDatasetH set, GDALDatasetH view[BAKE_COLOUR_VIEWS_MAX])
{
    view[0] = palette_view(set);
    if (!view[0]) return 0;
    view[1] = translate(view[0], CSLAddString(CSLAddString(NULL, "-expand"), "rgba"));
    if (view[1]) return 2;
    GDALClose(view[0]);
    return 0;
}

/* ---- greys and masks ---- */

/* The most that a grey or colour of fewer than 8 bits can be, else 255. */
static int white_of(GDALRasterBandH band)
{
    const char *bits = GDALGetMetadataItem(band, "NBITS", "IMAGE_STRUCTURE");
    int count = bits ? atoi(bits) : 8;
    return count >= 1 && count < 8 ? (1 << count) - 1 : 255;
}

/* A band of `set`, its values up to `white` as 0 to 255, as the next one of a view. */
static char **add_band(char **list, int number, int source, int white)
{
    char text[24];
    snprintf(text, sizeof text, "%d", source);
    list = CSLAddString(CSLAddString(list, "-b"), text);
    if (white == 255) return list;
    snprintf(text, sizeof text, "-scale_%d", number);
    list = CSLAddString(CSLAddString(list, text), "0");
    snprintf(text, sizeof text, "%d", white);
    return CSLAddString(CSLAddString(CSLAddString(list, text), "0"), "255");
}

/* A view of the first bands and, behind them, what covers them: alpha, or a mask, or nothing. */
static GDALDatasetH covered_view(GDALDatasetH set, int colours, int white, int masked)
{
    int has_alpha = bake_colour_has_alpha(set);
    char **list = NULL;
    for (int i = 1; i <= colours; i++) list = add_band(list, i, i, white);
    if (has_alpha) list = add_band(list, colours + 1, GDALGetRasterCount(set), white);
    if (masked) {
        list = CSLAddString(CSLAddString(list, "-b"), "mask");
        list = CSLAddString(CSLAddString(list, "-mask"), "none");
    }
    GDALDatasetH view = translate(set, list);
    if (view && (masked || has_alpha))
        GDALSetRasterColorInterpretation(GDALGetRasterBand(view, colours + 1), GCI_AlphaBand);
    return view;
}

/* A view of three colours that are void only where all of them are their nodata value: a mask of
 * GDAL's is of one band otherwise. */
static GDALDatasetH nodata_view(GDALDatasetH set)
{
    char values[100] = "NODATA_VALUES=", number[16];
    char **list = NULL;
    for (int i = 1; i <= 3; i++) {
        double nodata = GDALGetRasterNoDataValue(GDALGetRasterBand(set, i), NULL);
        size_t used = strlen(values);
        snprintf(values + used, sizeof values - used, "%s%.0f", i > 1 ? " " : "", nodata);
        snprintf(number, sizeof number, "%d", i);
        list = CSLAddString(CSLAddString(list, "-b"), number);
    }
    return translate(set, CSLAddString(CSLAddString(list, "-mo"), values));
}

int bake_colour_views(GDALDatasetH set, const char *path, GDALDatasetH view[BAKE_COLOUR_VIEWS_MAX])
{
    GDALRasterBandH band = GDALGetRasterBand(set, 1);
    int colours = GDALGetRasterCount(set) >= 3 ? 3 : 1, flags = GDALGetMaskFlags(band), count = 0;
    int white = white_of(band);
    int masked = !(flags & (GMF_ALL_VALID | GMF_ALPHA)) && !bake_colour_has_alpha(set);
    CPLErrorReset();
    if (GDALGetRasterColorTable(band) && GDALGetRasterCount(set) == 1) {
        count = expand_palette(set, view);
        return count ? count : bake_fail_gdal("%s: cannot read its colours", path);
    }
    if (!masked && white == 255) return 0;
    if (colours == 3 && flags == GMF_NODATA) {
        view[count] = nodata_view(set);
        if (!view[count]) return bake_fail_gdal("%s: cannot read its colours", path);
        set = view[count++];
    }
    view[count] = covered_view(set, colours, white, masked);
    if (view[count]) return count + 1;
    if (count) GDALClose(view[0]);
    return bake_fail_gdal("%s: cannot read its colours", path);
}

int bake_colour_read(GDALDatasetH set, int top, int rows, uint8_t *rgba)
{
    int width = GDALGetRasterXSize(set), bands = GDALGetRasterCount(set),
        has_alpha = bake_colour_has_alpha(set), is_colour = bands - has_alpha >= 3;
    int from[4] = { 1, is_colour ? 2 : 1, is_colour ? 3 : 1, bands };
    if (!has_alpha) memset(rgba, 255, (size_t)rows * (size_t)width * 4);
    return GDALDatasetRasterIO(set, GF_Read, 0, top, width, rows, rgba, width, rows, GDT_Byte,
                               has_alpha ? 4 : 3, from, 4, 4 * width, 1) == CE_None
               ? 0
               : -1;
}
