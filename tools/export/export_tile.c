#include "export_tile.h"

#include "../bake/bake_say.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define SIDE     EXPORT_TILE_SIDE
#define HALF     (SIDE / 2)
#define RGBA     4
#define GROUND_A 2 /* of four cells this many make ground */

int export_tile_is_void(const export_paint *paint, uint8_t cell)
{
    return cell == EXPORT_BEYOND || (cell == EXPORT_FILLED && paint->clear_filled);
}

/* ---- parents ---- */

static void shrink_cell(const export_paint *paint, const export_tile *child, const size_t four[4],
                        export_tile *parent, size_t to)
{
    int ground = 0, use_all;
    uint8_t is = EXPORT_MEASURED, lack = EXPORT_MEASURED;
    for (int i = 0; i < 4; i++) {
        uint8_t cell = child->mask[four[i]];
        if (export_tile_is_void(paint, cell)) {
            lack = cell;
            continue;
        }
        ground++;
        if (cell == EXPORT_FILLED) is = cell;
    }
    use_all = ground == 0;
    for (int b = 0; b < child->bands; b++) {
        double sum = 0;
        for (int i = 0; i < 4; i++)
            if (use_all || !export_tile_is_void(paint, child->mask[four[i]]))
                sum += child->value[b][four[i]];
        parent->value[b][to] = (float)(sum / (use_all ? 4 : ground));
    }
    parent->mask[to] = ground >= GROUND_A ? is : lack;
}

void export_tile_shrink(const export_paint *paint, const export_tile *child, int quadrant,
                        export_tile *parent)
{
    size_t left = quadrant & 1 ? HALF : 0, top = quadrant & 2 ? HALF : 0;
    for (size_t j = 0; j < HALF; j++)
        for (size_t i = 0; i < HALF; i++) {
            size_t at = 2 * j * SIDE + 2 * i;
            const size_t four[4] = { at, at + 1, at + SIDE, at + SIDE + 1 };
            shrink_cell(paint, child, four, parent, (top + j) * SIDE + left + i);
        }
}

void export_tile_clear(export_tile *tile, int quadrant)
{
    size_t left = quadrant & 1 ? HALF : 0, top = quadrant & 2 ? HALF : 0;
    for (size_t j = 0; j < HALF; j++)
        for (size_t i = 0; i < HALF; i++) {
            size_t at = (top + j) * SIDE + left + i;
            for (int b = 0; b < tile->bands; b++) tile->value[b][at] = NAN;
            tile->mask[at] = EXPORT_BEYOND;
        }
}

/* ---- images ---- */

static void paint_cell(const export_paint *paint, const export_tile *tile, size_t at,
                       uint8_t rgba[RGBA])
{
    uint8_t cell = tile->mask[at];
    int is_clear = (cell == EXPORT_BEYOND && paint->clear_beyond) ||
                   (cell == EXPORT_FILLED && paint->clear_filled);
    if (paint->encoding) {
        export_encode(paint->encoding, (double)tile->value[0][at], rgba);
    } else {
        for (int b = 0; b < 3; b++) rgba[b] = (uint8_t)lrintf(tile->value[b][at]);
    }
    rgba[3] = is_clear ? 0 : UINT8_MAX;
}

/* A picture of so many bands in memory, to be closed; NULL (said). */
static GDALDatasetH make_picture(const uint8_t *rgba, int bands)
{
    GDALDatasetH set = GDALCreate(GDALGetDriverByName("MEM"), "", SIDE, SIDE, bands, GDT_Byte,
                                  NULL);
    int failed = !set ||
                 GDALDatasetRasterIO(set, GF_Write, 0, 0, SIDE, SIDE, (void *)rgba, SIDE, SIDE,
                                     GDT_Byte, bands, NULL, RGBA, (int)RGBA * SIDE, 1) != CE_None;
    for (int b = 0; set && b < bands; b++)
        GDALSetRasterColorInterpretation(GDALGetRasterBand(set, b + 1),
                                         (GDALColorInterp)(GCI_RedBand + b));
    if (!failed) return set;
    if (set) GDALClose(set);
    bake_fail_gdal("cannot make a tile");
    return NULL;
}

static uint8_t *pack_picture(const export_paint *paint, GDALDatasetH set, size_t *count)
{
    static const char name[] = "/vsimem/farfield-export-tile";
    char quality[16];
    vsi_l_offset bytes = 0;
    snprintf(quality, sizeof quality, "%d", paint->jpeg_quality);
    char **settings = paint->is_jpeg ? CSLSetNameValue(NULL, "QUALITY", quality)
                                     : CSLSetNameValue(NULL, "ZLEVEL", "9");
    CPLErrorReset();
    GDALDatasetH copy = GDALCreateCopy(GDALGetDriverByName(paint->is_jpeg ? "JPEG" : "PNG"), name,
                                       set, 0, settings, NULL, NULL);
    CSLDestroy(settings);
    if (copy) GDALClose(copy);
    uint8_t *file = copy ? VSIGetMemFileBuffer(name, &bytes, TRUE) : NULL;
    if (!file) bake_fail_gdal("cannot make a tile");
    *count = (size_t)bytes;
    return file;
}

uint8_t *export_tile_paint(const export_paint *paint, const export_tile *tile, size_t *count)
{
    int bands = 3;
    uint8_t *rgba = malloc((size_t)RGBA * EXPORT_TILE_CELLS), *file = NULL;
    if (!rgba) bake_fail("out of memory");
    for (size_t i = 0; rgba && i < EXPORT_TILE_CELLS; i++) {
        paint_cell(paint, tile, i, rgba + RGBA * i);
        if (!rgba[RGBA * i + 3]) bands = RGBA;
    }
    GDALDatasetH set = rgba ? make_picture(rgba, bands) : NULL;
    if (set) file = pack_picture(paint, set, count);
    if (set) GDALClose(set);
    free(rgba);
    return file;
}
