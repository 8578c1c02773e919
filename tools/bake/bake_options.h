/* What farfield-bake was asked for. */
#ifndef BAKE_OPTIONS_H
#define BAKE_OPTIONS_H

#include <stdint.h>

typedef struct bake_raw { /* --raw WxH[:le|be][:u16|s16]; width 0: not raw */
    uint32_t width, height;
    int big_endian, is_signed;
} bake_raw;

typedef struct bake_options {
    const char *heights_path, *color_path, *out_path;
    bake_raw raw;
    double scale;     /* source value * scale = metres; 0: from the source's own unit */
    double hscale_m;  /* metres a height step; 0: chosen */
    double spacing_m; /* 0: the source's */
    double max_error_m;
    uint32_t node_log2;
    uint32_t tile_log2; /* 0: chosen */
    uint32_t densify;   /* 1: none */
    uint32_t texture_log2;
    uint32_t texture_levels; /* 0: chosen */
    int texture_quality;
    int codec;       /* enum ff_codec_id */
    int target_epsg; /* 0: local UTM zone */
    int no_project;
    int jobs;
    int json, quiet;
} bake_options;

/* Fills `options` from the command line. 0: go on; 1: --help or --version answered; -1: wrong, said
 * why. */
int bake_options_parse(bake_options *options, int argc, char **argv);

#endif
