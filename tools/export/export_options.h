/* What farfield-export was asked for: a row for each option, see sys_options.h. */
#ifndef EXPORT_OPTIONS_H
#define EXPORT_OPTIONS_H

#include "../bake/bake_options.h"

#define EXPORT_ZOOM_MAX 24

enum export_voids_word { EXPORT_VOIDS_KEEP, EXPORT_VOIDS_NODATA };
enum export_encoding_word { EXPORT_AUTO, EXPORT_TERRARIUM, EXPORT_MAPBOX };
enum export_picture_word { EXPORT_JPEG, EXPORT_PNG };

typedef struct export_zooms { /* --zoom A-B, or one alone */
    uint32_t low, high;
    int is_given;
} export_zooms;
extern const sys_option_type export_zooms_option;

/* clang-format off */
#define EXPORT_OPTIONS(OPTION, HEADING) \
    OPTION(sys_text, pack_path, NULL, "PACK", NULL, SYS_FLAGS(SYS_NEEDED), "the pack") \
    OPTION(sys_text, out_path, "output", "FILE", NULL, SYS_FLAGS(SYS_NEEDED | SYS_LETTER), \
           "OUT.tif, .png or .r16; a part as a pack: OUT.ffp; map tiles: OUT.pmtiles, OUT.mbtiles, or a folder OUT/") \
    OPTION(sys_flag, images, "images", NULL, NULL, SYS_ANY, \
           "the images laid over the ground (OUT.jpg, too) instead of its heights; what they do not " \
           "cover is clear, but in JPEGs") \
    OPTION(sys_text, layer, "layer", "LAYER", NULL, SYS_ANY, \
           "of the layers of images the one of this name; default: the first") \
    OPTION(sys_whole, level, "level", "L", NULL, SYS_WHOLE(0, FF_KEY_LEVEL_MAX, ""), \
           "0: roots only; default: the finest level") \
    OPTION(bake_box, region, "region", "W,S,E,N", NULL, SYS_ANY, \
           "this part, in degrees") \
    OPTION(sys_word, voids, "voids", "NAME", "keep", SYS_WORDS(export_voids_words), \
           "nodata: what the source lacked, and was filled, is marked as void") \
    HEADING("A part as a pack") \
    OPTION(sys_flag, estimate, "estimate", NULL, NULL, SYS_FLAGS(SYS_ALONE), \
           "tells the size of OUT.ffp beforehand; writes nothing") \
    HEADING("Map tiles") \
    OPTION(export_zooms, zooms, "zoom", "A-B", NULL, SYS_ANY, \
           "these zooms; default: from one tile to the first whose pixels are no larger than samples") \
    OPTION(sys_word, encoding, "encoding", "NAME", "auto", SYS_WORDS(export_encoding_words), \
           "how colours encode heights; auto: mapbox (Terrain-RGB, steps of 0.1 m) unless the pack's are finer") \
    OPTION(sys_word, picture, "tile-images", "NAME", "jpeg", SYS_WORDS(export_picture_words), \
           "of --images; png: without loss, and clear beyond the ground") \
    HEADING("Meshes for Cesium") \
    OPTION(sys_flag, mesh, "mesh", NULL, NULL, SYS_ANY, \
           "quantized-mesh tiles with layer.json in the folder OUT/") \
    OPTION(sys_real, mesh_error_m, "mesh-error", "M", NULL, SYS_REAL(0.001, 1e6, "m"), \
           "of the finest zoom's meshes; each coarser one's is twice as large; default: 1/8 of the spacing") \
    OPTION(sys_flag, normals, "normals", NULL, NULL, SYS_ANY, "with octvertexnormals") \
    OPTION(sys_flag, gzip, "gzip", NULL, NULL, SYS_ANY, \
           "packed: to be served with Content-Encoding: gzip") \
    HEADING("Run") \
    OPTION(sys_whole, jpeg_quality, "jpeg-quality", "Q", "85", SYS_WHOLE(1, 100, ""), \
           "of JPEGs that are written") \
    OPTION(sys_flag, quiet, "quiet", NULL, NULL, SYS_ANY, "errors only")
/* clang-format on */

typedef struct export_options {
    EXPORT_OPTIONS(SYS_FIELD, SYS_NO_FIELD)
    int has_level;
} export_options;

/* 0: go on; 1: --help or --version answered; -1: wrong usage, said in one line on stderr. */
int export_options_parse(export_options *options, int argc, char **argv);

#endif
