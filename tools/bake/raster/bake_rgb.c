#include "bake_rgb.h"

#include "../bake_say.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

#define BANDS      3
#define NAME_BYTES 512

/* By number of enum bake_rgb_word. */
static const struct {
    bake_rgb rgb;
    const char *name;     /* as metadata and people say */
    const char *words[6]; /* in the names of files and folders */
} encodings[] = {
    [BAKE_RGB_AUTO] = { { 0, 0 }, NULL, { NULL } },
    [BAKE_RGB_MAPBOX] = { { 0.1, -10000 },
                          "mapbox",
                          { "terrain-rgb", "terrain_rgb", "terrainrgb", "terrain-dem", "mapbox" } },
    [BAKE_RGB_TERRARIUM] = { { 1.0 / 256, -32768 }, "terrarium", { "terrarium", "mapterhorn" } },
};
#define ENCODINGS ((int)(sizeof encodings / sizeof *encodings))

int bake_rgb_is_palette(GDALDatasetH set)
{
    GDALRasterBandH band = GDALGetRasterBand(set, 1);
    return GDALGetRasterCount(set) == 1 && GDALGetRasterColorTable(band) &&
           GDALGetRasterDataType(band) == GDT_Byte;
}

static int has_rgb(GDALDatasetH set)
{
    for (int i = 1; i <= BANDS; i++)
        if (GDALGetRasterCount(set) < BANDS ||
            GDALGetRasterDataType(GDALGetRasterBand(set, i)) != GDT_Byte)
            return 0;
    return 1;
}

/* 1 when the first bands are colours of 8 or 16 bits. */
static int is_colour(GDALDatasetH set)
{
    GDALRasterBandH band = GDALGetRasterBand(set, 1);
    return has_rgb(set) || (GDALGetRasterCount(set) >= BANDS &&
                            GDALGetRasterColorInterpretation(band) == GCI_RedBand);
}

static int tagged(const char *tag)
{
    for (int e = 1; tag && e < ENCODINGS; e++)
        if (EQUAL(tag, encodings[e].name)) return e;
    return BAKE_RGB_AUTO;
}

/* By the name of the file and of its folder. */
static int named(const char *path)
{
    char name[NAME_BYTES] = "";
    const char *from = path + strlen(path);
    for (int slashes = 0; from > path; from--)
        if (from[-1] == '/' && from[0] && ++slashes == 2) break;
    snprintf(name, sizeof name, "%s", from);
    for (char *c = name; *c; c++) *c = (char)tolower((unsigned char)*c);
    for (int e = 1; e < ENCODINGS; e++)
        for (int w = 0; encodings[e].words[w]; w++)
            if (strstr(name, encodings[e].words[w])) return e;
    return BAKE_RGB_AUTO;
}

int bake_rgb_told(const bake_options *o, const char *tag)
{
    int encoding = o->rgb == BAKE_RGB_AUTO ? tagged(tag) : o->rgb;
    if (encoding == BAKE_RGB_AUTO) encoding = named(o->heights_path);
    if (encoding != BAKE_RGB_AUTO) return encoding;
    return bake_fail("%s: an image, not heights: say --rgb mapbox or --rgb terrarium where its "
                     "colours encode heights, --rgb none where its first band is heights",
                     o->heights_path);
}

int bake_rgb_choose(const bake_options *o, GDALDatasetH set, bake_rgb *rgb)
{
    const char *tag = GDALGetMetadataItem(set, "encoding", NULL);
    *rgb = encodings[BAKE_RGB_AUTO].rgb;
    if (o->rgb == BAKE_RGB_NONE || (o->rgb == BAKE_RGB_AUTO && !is_colour(set))) return 0;
    int encoding = bake_rgb_told(o, tag);
    if (encoding < 0) return -1;
    if (!has_rgb(set))
        return bake_fail("%s: --rgb %s needs three bands of 8 bits", o->heights_path,
                         encodings[encoding].name);
    if (o->rgb == BAKE_RGB_AUTO)
        bake_note("%s: colours taken as heights, encoded as its %s says (--rgb %s)",
                  o->heights_path, tagged(tag) ? "metadata" : "name", encodings[encoding].name);
    *rgb = encodings[encoding].rgb;
    return 0;
}

int bake_rgb_read(GDALDatasetH set, uint32_t width, uint32_t top, uint32_t rows, double *values,
                  float *room)
{
    size_t count = (size_t)rows * width;
    memset(values, 0, count * sizeof *values);
    for (int b = 1; b <= BANDS; b++) {
        if (GDALRasterIO(GDALGetRasterBand(set, b), GF_Read, 0, (int)top, (int)width, (int)rows,
                         room, (int)width, (int)rows, GDT_Float32, 0, 0) != CE_None)
            return -1;
        for (size_t i = 0; i < count; i++) values[i] = values[i] * 256 + (double)room[i];
    }
    return 0;
}
