/* Which packs lie on one lattice, and where each of them lies on it: arithmetic alone.
 *
 * The joint lattice has the finest spacing. Each pack's samples are places of every finer pack's
 * lattice, so that a sample stands on the level of the tree that its pack has it on. Its corners
 * are samples' places of the coarsest pack's lattice. */
#ifndef MERGE_LATTICE_H
#define MERGE_LATTICE_H

#include "../../protocol/ff_terrain.h"

#define MERGE_PACKS_MAX 64

/* A pack on the joint lattice. */
typedef struct merge_place {
    uint32_t apart_log2;   /* places from a sample to the next: 2^that */
    uint32_t left, bottom; /* its south-west sample */
    uint32_t columns, rows;
    int32_t steps; /* to be added to its heights */
} merge_place;

typedef struct merge_lattice {
    uint32_t width, height; /* places, both ends within */
    uint32_t apart_log2;    /* of the coarsest pack */
    ff_terrain_info info;   /* of the joint terrain: all but its tiles, samples and textures */
} merge_lattice;

/* Why a pack is not joined with the first one. */
enum merge_fault {
    MERGE_FITS,
    MERGE_SYSTEM,  /* another reference system */
    MERGE_CURVE,   /* ground that falls away otherwise */
    MERGE_SPACING, /* not a power of two apart */
    MERGE_PLACES,  /* samples between the places of a finer pack */
    MERGE_STEP,    /* another height step, or heights that are not whole steps apart */
    MERGE_RANGE,   /* all heights together span more than 16 bits */
    MERGE_NODES,   /* another size of nodes, or codec */
    MERGE_LOSSY,   /* heights that cannot be kept: max_error is not 0 */
    MERGE_FAR      /* the rectangle round all is no terrain */
};

/* Finds the lattice and the places of `count` packs on it, or the first pack that does not fit:
 * *which. `info` of each has passed ff_terrain_check. */
enum merge_fault merge_lattice_find(const ff_terrain_info *const info[], uint32_t count,
                                    merge_lattice *lattice, merge_place place[], uint32_t *which);

double merge_spacing_m(const ff_terrain_info *info);
/* 1 when `a` holds where both have ground: it is finer, or as fine and named before. */
int merge_place_precedes(const merge_place place[], uint32_t a, uint32_t b);
/* Places, both ends within. */
typedef struct merge_rectangle {
    uint32_t left, bottom, right, top;
} merge_rectangle;

/* The places that a pack covers: between its samples, and beyond its rim nearer than another sample
 * would be, since samples of packs side by side are as far apart as those of one. */
merge_rectangle merge_place_reach(const merge_lattice *lattice, const merge_place *place);
/* The share of the lattice's rectangle that no pack covers. */
double merge_lattice_gap(const merge_lattice *lattice, const merge_place place[], uint32_t count);

#endif
