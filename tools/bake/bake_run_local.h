/* Private to bake_run.c and bake_estimate.c: everything between raster and pack. */
#ifndef BAKE_RUN_LOCAL_H
#define BAKE_RUN_LOCAL_H

#include "image/bake_image.h"
#include "raster/bake_quantise.h"
#include "bake_run.h"
#include "bake_tiles.h"
#include "pack_writer.h"

/* One per run. */
typedef struct bake {
    const bake_options *options;
    bake_ground ground;
    bake_steps steps;
    ff_terrain_info info;
    bake_grid heights; /* uint16, rows south to north */
    bake_grid marks;   /* of filled samples, as the ground is; closed: there are none */
    bake_grid filled;  /* the same beside the heights, a byte each */
    bake_image image;
    ff_layers layers; /* names alone */
    const char *layer_path[FF_LAYERS_MAX];
    uint32_t layer_at; /* of the layer under way: added to numbers of the first one's sections */
    double rms_m;      /* of decoded heights: how far they are from their samples */
    pack_writer writer;
    uint8_t about[FF_ABOUT_BYTES_MAX];
    int64_t started_us;
} bake;

/* Reads the ground of the options, its voids filled or given a height. 0 or -1 (said). */
int bake_read(bake *b);
/* Describes the terrain of heights of b->heights' size, where the ground lies. 0 or -1 (said). */
int bake_describe(bake *b);
/* What the pack of a ground will say of itself, in b->about. */
ff_list bake_about_of(bake *b, const bake_ground *ground);
/* In world units; one out of range is refused when the terrain is described. */
uint32_t bake_spacing_wu(const bake_options *options, double spacing_m);

#endif
