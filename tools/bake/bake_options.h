/* What farfield-bake was asked for: a row for each option, see sys_options.h. */
#ifndef BAKE_OPTIONS_H
#define BAKE_OPTIONS_H

#include "../../client/farfield.h"
#include "../../platform/options/sys_options.h"

typedef struct bake_raw { /* --raw WxH[:le|be][:u16|s16]; width 0: not raw */
    uint32_t width, height;
    int big_endian, is_signed;
} bake_raw;
typedef struct bake_nodata { /* --nodata V, or none */
    int is_given, is_none;
    double value;
} bake_nodata;
typedef struct bake_box { /* --bbox W,S,E,N, degrees; east of W, across the antimeridian if need be
                           */
    double west, south, east, north;
    int is_given;
} bake_box;
enum bake_rgb_word { BAKE_RGB_AUTO, BAKE_RGB_MAPBOX, BAKE_RGB_TERRARIUM, BAKE_RGB_NONE };
typedef int bake_epsg;           /* --t-srs EPSG:N */
typedef uint32_t bake_power_two; /* within SYS_WHOLE */
extern const sys_option_type bake_raw_option, bake_nodata_option, bake_box_option, bake_epsg_option,
    bake_power_two_option;

#define BAKE_FACTOR  SYS_REAL(1e-6, 1e6, "")
#define BAKE_STEP    SYS_REAL(1e-6, 127, "m")
#define BAKE_SPACING SYS_REAL(1.0 / FF_WU_PER_METRE, 1e6, "m")
#define BAKE_HEIGHT  SYS_REAL(-1e6, 1e6, "m")
#define BAKE_LEVELS  SYS_WHOLE(1, FF_KEY_LEVEL_MAX, "")
#define BAKE_TILES   SYS_WHOLE(1, FF_TILE_LOG2_MAX, "")
#define BAKE_NODES   SYS_WHOLE(1, FF_NODE_LOG2_MAX, "")

/* clang-format off */
/* rows that farfield-merge has, too */
#define BAKE_ABOUT_OPTIONS(OPTION) \
    OPTION(sys_text, name, "name", "TEXT", NULL, SYS_ANY, "what ground it is") \
    OPTION(sys_text, attribution, "attribution", "TEXT", NULL, SYS_ANY, \
           "whose it is, as it is to be shown") \
    OPTION(sys_text, licence, "licence", "TEXT", NULL, SYS_ANY, "what may be done with it") \
    OPTION(sys_text, date, "date", "TEXT", NULL, SYS_ANY, "of the source") \
    OPTION(sys_text, vertical_datum, "vertical-datum", "TEXT", NULL, SYS_ANY, \
           "what heights are above")
#define BAKE_JOBS_OPTION(OPTION) \
    OPTION(sys_whole, jobs, "jobs", "N", NULL, SYS_WHOLE(1, 64, ""), \
           "threads; default: the processors, at most 16; any N gives the same bytes")
#define BAKE_SAY_OPTIONS(OPTION) \
    OPTION(sys_flag, json, "json", NULL, NULL, SYS_ANY, "a summary on stdout") \
    OPTION(sys_flag, quiet, "quiet", NULL, NULL, SYS_ANY, "errors only")
#define BAKE_OPTIONS(OPTION, HEADING) \
    OPTION(sys_text, heights_path, NULL, "HEIGHTS", NULL, SYS_FLAGS(SYS_NEEDED), "the raster") \
    HEADING("Input") \
    OPTION(sys_text, color_path, "color", "IMAGE", NULL, SYS_ANY, \
           "image over the same ground or a part of it, any resolution: where it ends, or is clear " \
           "(alpha, mask or nodata), the ground has its own colours, and no bytes") \
    OPTION(sys_texts, layers, "layer", "NAME=IMAGE", NULL, SYS_FLAGS(SYS_REPEATABLE), \
           "one more image over it, or a part of it, which viewers choose by its name; at most 8 with " \
           "--color") \
    OPTION(bake_raw, raw, "raw", "WxH[:le|be][:u16|s16]", NULL, SYS_ANY, \
           "HEIGHTS is headerless 16 bit, top row north; default: le, u16") \
    OPTION(bake_nodata, nodata, "nodata", "V", NULL, SYS_ANY, \
           "source value that stands for void, or none; default: the raster's own, and told sentinels") \
    OPTION(sys_real, void_height_m, "void-height", "M", NULL, BAKE_HEIGHT, \
           "gives voids this height; default: they are filled from around them") \
    OPTION(sys_real, rim_void_height_m, "rim-void-height", "M", NULL, BAKE_HEIGHT, \
           "the same for voids that touch the raster's rim: 0 where they are sea") \
    OPTION(sys_word, rgb, "rgb", "NAME", "auto", SYS_WORDS(rgb_words), \
           "how colours encode heights; auto: as metadata or the name says; none: the first band is heights") \
    OPTION(bake_box, bbox, "bbox", "W,S,E,N", NULL, SYS_ANY, \
           "of map tiles this part, in degrees") \
    OPTION(sys_whole, zoom, "zoom", "Z", NULL, SYS_WHOLE(1, 24, ""), \
           "of map tiles this zoom; default: the finest there is") \
    OPTION(sys_real, scale, "scale", "F", NULL, BAKE_FACTOR, \
           "source value * F = metres; default: the source's unit, else 1") \
    OPTION(sys_real, hscale_m, "hscale", "M", NULL, BAKE_STEP, \
           "metres a height step; alone with plain 16-bit images: metres a unit") \
    OPTION(sys_real, spacing_m, "spacing", "M", NULL, BAKE_SPACING, \
           "metres between samples; resamples georeferenced rasters") \
    OPTION(bake_epsg, target_epsg, "t-srs", "EPSG:N", NULL, SYS_ANY, \
           "projects to this CRS (units metres) instead of the local UTM zone") \
    OPTION(sys_flag, no_project, "no-project", NULL, NULL, SYS_ANY, \
           "takes the samples as they are, in their own plane") \
    OPTION(sys_text, lattice_path, "lattice", "PACK", NULL, SYS_ANY, \
           "on the places of this pack, in its system, height steps, nodes and codec: for farfield-merge") \
    OPTION(bake_power_two, densify, "densify", "N", "1", SYS_WHOLE(1, 64, ""), \
           "inserts N - 1 invented samples between neighbours") \
    OPTION(sys_flag, flat, "flat", NULL, NULL, SYS_ANY, \
           "the ground is a plane; default: it falls away as on its ellipsoid") \
    OPTION(sys_real, refraction, "refraction", "K", NULL, SYS_REAL(-1, 0.99, ""), \
           "how light bends with the ground; default: 0.13 on the Earth, else 0") \
    HEADING("Pack") \
    OPTION(sys_text, out_path, "output", "OUT.ffp", NULL, SYS_FLAGS(SYS_NEEDED | SYS_LETTER), \
           "the pack") \
    OPTION(sys_real, max_error_m, "max-error", "M", "0", SYS_REAL(0, 1e6, "m"), \
           "no decoded height is further from its source") \
    OPTION(sys_real, rms_error_m, "rms-error", "M", "0", SYS_REAL(0, 1e6, "m"), \
           "the largest --max-error at which the root mean square of all is no more; bakes some five times") \
    OPTION(sys_whole, node_log2, "node-log2", "K", "3", BAKE_NODES, "nodes of (2^K+1)^2 heights") \
    OPTION(sys_whole, tile_log2, "tile-log2", "N", NULL, BAKE_TILES, \
           "tiles of (2^N+1)^2 heights; default: one tile for all") \
    OPTION(sys_whole, texture_log2, "texture-log2", "T", "6", SYS_WHOLE(4, 8, ""), \
           "textures of (2^T)^2 texels; clients of 4 MB show 6, in pictures of 240 x 320 7, too; 8 takes " \
           "8 MB") \
    OPTION(sys_whole, texture_levels, "texture-levels", "L", NULL, BAKE_LEVELS, \
           "levels with textures; default: down to the image's resolution") \
    OPTION(sys_whole, texture_quality, "texture-quality", "Q", "75", SYS_WHOLE(1, 100, ""), \
           "quality of textures, as of JPEGs") \
    OPTION(sys_word, image_codec, "image-codec", "NAME", "picture", SYS_WORDS(image_codec_words), \
           "jpeg: twice the bytes; for clients built without pictures") \
    OPTION(sys_word, codec, "codec", "NAME", "trained", SYS_WORDS(codec_words), \
           "deflate, rice: cheaper to decode; rice: for devices without zlib and tables") \
    HEADING("What the pack says of itself; default: what the source says") \
    BAKE_ABOUT_OPTIONS(OPTION) \
    HEADING("Run") \
    BAKE_JOBS_OPTION(OPTION) \
    OPTION(sys_flag, estimate, "estimate", NULL, NULL, SYS_FLAGS(SYS_ALONE), \
           "tells size, time and memory beforehand, by windows spread over the ground; writes no pack") \
    BAKE_SAY_OPTIONS(OPTION)
/* clang-format on */

/* A number not given is 0: chosen while baking. */
typedef struct bake_options {
    BAKE_OPTIONS(SYS_FIELD, SYS_NO_FIELD)
    const char *layer_text[FF_LAYERS_MAX];
    const struct bake_lattice *lattice; /* that lattice_path names, while there is one */
} bake_options;

/* Threads when none are told. */
uint32_t bake_processors(void);

/* Fills `options` from the command line. 0: go on; 1: --help or --version answered; -1: wrong
 * usage, said in one line on stderr. */
int bake_options_parse(bake_options *options, int argc, char **argv);

#endif
