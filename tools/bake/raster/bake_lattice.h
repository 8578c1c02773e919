/* The lattice of a pack, which other ground is baked on so that farfield-merge joins the two. */
#ifndef BAKE_LATTICE_H
#define BAKE_LATTICE_H

#include "../../../protocol/ff_terrain.h"
#include "bake_source.h"

typedef struct bake_lattice {
    const char *path;
    ff_terrain_info info;
    OGRSpatialReferenceH srs; /* NULL: the pack names none */
} bake_lattice;

/* 0 or -1 (said). */
int bake_lattice_open(const char *path, bake_lattice *lattice);
void bake_lattice_close(bake_lattice *lattice);

/* *target: the lattice's plane, or NULL where the ground is in it. To be destroyed. 0 or -1
 * (said). */
int bake_lattice_target(const bake_lattice *lattice, const bake_ground *ground,
                        OGRSpatialReferenceH *target);
/* *spacing_m becomes the nearest that is a power of two away from the pack's. 0, or -1 (said):
 * it has to be that one, `is_told`, and is not. */
int bake_lattice_spacing(const bake_lattice *lattice, int is_told, double *spacing_m);
/* Places between low and high of an axis (0 east, 1 north), at least half a spacing from both ends:
 * the first, and how many. */
double bake_lattice_axis(const bake_lattice *lattice, int axis, double low, double high,
                         double spacing_m, double *first);
/* Moves an upright grid of about this spacing onto the lattice, when all of its samples are within
 * 1/8 of a sample of it: 1; else 0. */
int bake_lattice_keeps(const bake_lattice *lattice, bake_ground *ground, double spacing_m);

#endif
