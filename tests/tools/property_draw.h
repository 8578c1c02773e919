/* Rasters by chance: what draw `number` of a seed is. A draw follows from the two numbers alone, so
 * that any of them is repeated by itself.
 *
 * A draw picks one level of each factor (place, geotransform, type, voids, file, options), and what
 * cannot go together gives way to what can (property_settle). Draw N forces the N-th pair of levels
 * of two factors; the rest is chance, so that a long run sees all pairs. */
#ifndef PROPERTY_DRAW_H
#define PROPERTY_DRAW_H

#include "../../tools/bake/raster/bake_gdal.h"

#include <stdint.h>

enum property_factor {
    PROPERTY_PLACE,
    PROPERTY_TRANSFORM,
    PROPERTY_TYPE,
    PROPERTY_VOIDS,
    PROPERTY_FILE,
    PROPERTY_OPTION,
    PROPERTY_FACTORS
};

enum property_transform {
    TRANSFORM_NORTH_UP,
    TRANSFORM_SOUTH_UP,
    TRANSFORM_WESTWARDS,
    TRANSFORM_EXCHANGED,
    TRANSFORM_EXCHANGED_BACK,
    TRANSFORM_TURNED,
    TRANSFORM_MIRRORED,
    TRANSFORM_SHEARED,
    TRANSFORM_UNLIKE,
    TRANSFORM_POINT,
    TRANSFORM_FINE,
    TRANSFORM_COARSE,
    TRANSFORM_UNEVEN,
    TRANSFORMS
};

enum property_voids {
    VOIDS_NONE,
    VOIDS_NODATA,
    VOIDS_SENTINEL,
    VOIDS_NAN,
    VOIDS_MASK,
    VOIDS_ALPHA,
    VOIDS_OPTION,
    VOIDS
};

enum property_file {
    FILE_GTIFF,
    FILE_VRT,
    FILE_PNG,
    FILE_AAIGRID,
    FILE_RAW,
    FILE_NETCDF,
    FILE_HGT,
    FILES
};

enum property_option {
    OPTION_NONE,
    OPTION_MAX_ERROR,
    OPTION_SPACING,
    OPTION_T_SRS,
    OPTION_DENSIFY,
    OPTION_NODES,
    OPTION_CODEC,
    OPTION_JOBS,
    OPTION_NO_PROJECT,
    OPTION_VOID_HEIGHT,
    OPTION_RIM_HEIGHT,
    OPTION_SCALE,
    OPTIONS
};

/* Where on a body. `srs` NULL: a plane of metres without a reference system; "": no place at all.
 */
typedef struct property_place {
    const char *name, *srs;
    double west, south, east, north; /* degrees: middles of rasters lie here */
    double radius_m;                 /* 0: the Earth */
} property_place;

typedef struct property_draw {
    uint32_t seed, number;
    int level[PROPERTY_FACTORS];
    uint32_t options; /* a bit for each option: that of the level, and others by chance */
    uint64_t chance;  /* what is left of it, for the voids */
    const property_place *place;
    GDALDataType type;
    int columns, rows;
    double longitude, latitude; /* middle, on the body; of planes 0 */
    double gt[6];               /* cells to the plane */
    double cell_m;              /* on the ground, about: the root of its area */
    /* metres = (value * scale + offset) * unit_m */
    const char *unit;
    double unit_m, scale, offset;
    double middle_m, swing_m;          /* heights are middle +- swing */
    double nodata;                     /* the value that stands for void */
    double wave[2], turn[2], phase[2]; /* of the surface: cells, radians, radians */
    double spacing_m, max_error_m, void_m;
    int epsg, densify, node_log2, tile_log2, codec, jobs;
} property_draw;

/* Draws; -1 where PROJ does not know the place. */
int property_draw_make(property_draw *d, uint32_t seed, uint32_t number);

/* Names of levels; NULL behind the last. */
const char *property_level_name(enum property_factor factor, int level);
const char *property_factor_name(enum property_factor factor);

/* 0 to 1, from the draw's own chance. */
double property_chance(property_draw *d);

int property_has(const property_draw *d, enum property_option option);
/* Whether the type has whole values only. */
int property_is_whole(const property_draw *d);
/* A reference system whose first axis is x: by name, with the reference of the place itself for
 * NULL. NULL where there is none. */
OGRSpatialReferenceH property_reference(const char *name);
/* The degrees that the surface is told in: WGS 84 on the Earth, the body's own elsewhere. */
OGRSpatialReferenceH property_degrees(const property_draw *d);
/* From one system to another, by the operation that PROJ holds to be best round the draw's middle:
 * without grids there are several between old datums, metres apart. */
OGRCoordinateTransformationH property_transformation(const property_draw *d,
                                                     OGRSpatialReferenceH from,
                                                     OGRSpatialReferenceH to);

#endif
