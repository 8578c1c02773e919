/* The seam between grounds over each other: the coarser dives under the finer.
 *
 * Let f be a ground that stands in a rectangle, and g one after it in order. g is drawn outside of
 * the rectangle, and inside of it in a ring along its border; beyond the ring it is left out. No
 * mesh changes, only heights:
 *   - g's vertices inside the rectangle are lowered to just below f's surface (the dive): by how
 *     much g is higher than f at the vertex and, a cell from the border on, half-way along its
 *     edges. Along the ring's inner
 *     border, where g's sheet ends, they are lowered below all of f there may be along the edges
 *     that meet in them.
 *   - f's vertices on the border are lowered until f's rim lies below g's sheet, as it is drawn,
 *     all along the edges that meet in them.
 * So along f's rim g is above f, along g's inner border f is above g, and the upper one of the two
 * sheets is whole: neither has an end that is seen. f's triangles that the rim moves reach two
 * cells inwards; g is left out only beyond them, so what g dives under is f as it is held.
 * With more grounds, g dives under each one before it, lowered as that is itself; then rims are
 * lowered, from the last ground to the first, below each one after their own, as it is drawn.
 *
 * How much a vertex is lowered depends on its place and on the cuts alone: nodes that share it
 * lower it alike, and stay whole. What is lowered of a node is kept, and found anew when what it
 * was made of has changed. Nodes out of view are not lowered. */
#ifndef FF_SEAM_H
#define FF_SEAM_H

#include "ff_cover.h"

typedef struct ff_seam {
    ff_key key;                /* of the node; used: stamp is not 0 */
    uint64_t dive_of, drop_of; /* hashes of what the grids were made of; 0: nothing yet */
    uint32_t slot, stamp;      /* stamp of the last selection that needed it */
} ff_seam;

typedef struct ff_seams {
    ff_seam *seam;
    uint16_t *dive, *drop; /* a grid for each: FF_LOWERED_DIVED, FF_LOWERED_DRAWN */
    uint16_t *of_slot;     /* of each slot: number of its seam + 1; may be another node's */
    uint32_t count, stamp;
} ff_seams;

/* ff_seam_dive.c */
/* 1 when a node has vertices that dive. */
int ff_seam_dives(const ff_tree *tree, const ff_node *node);
uint64_t ff_seam_dive_of(const ff_tree *tree, const ff_node *node);
/* Writes how many steps each vertex dives; 0 when some should dive deeper than a grid can say. */
int ff_seam_dive(const ff_tree *tree, const ff_node *node, uint16_t *dive);

/* ff_seam_rim.c */
/* 1 when a node has vertices on its ground's rim that may be lowered. */
int ff_seam_has_rim(const ff_tree *tree, const ff_node *node);
uint64_t ff_seam_rim_of(const ff_tree *tree, const ff_node *node);
/* Adds to `drop`, a copy of the dive, what the rim is lowered; alike. */
int ff_seam_rim(const ff_tree *tree, const ff_node *node, uint16_t *drop);

/* ff_seam.c */
/* Hash over a ground's nodes that touch an area, drawn or left out, and how they are lowered. */
uint64_t ff_seam_hash(const ff_tree *tree, uint32_t ground, const ff_area *area,
                      enum ff_lowered how, uint64_t hash);
/* Steps that make up a length, rounded up; more than 0 for any length. */
uint32_t ff_seam_steps(const ff_terrain_info *info, int64_t length_wu);
/* Lowers a vertex by so many steps, at least; 0 when that is too deep. */
int ff_seam_lower(uint16_t *vertex, uint32_t steps);

#endif
