/* The samples of several packs on their joint lattice, as a bake takes them (bake_samples.h).
 *
 * A place has the sample of the finest pack that has one there, of the one named first among
 * equals; one that its pack tells as filled gives way wherever another pack reaches. Where packs
 * reach, all other places are between samples. Beyond their reach heights are filled from around,
 * on a lattice so coarse that it costs next to nothing.
 */
#ifndef MERGE_SAMPLES_H
#define MERGE_SAMPLES_H

#include "../bake/bake_samples.h"
#include "../export/export_ground.h"
#include "merge_lattice.h"

/* A pack's part in it. */
typedef struct merge_layer {
    export_ground ground; /* decoded; its cells are rows from north to south */
    merge_place place;
    merge_rectangle reach;
} merge_layer;

typedef struct merge_samples {
    bake_samples samples;
    const merge_lattice *lattice;
    uint32_t count;
    merge_layer layer[MERGE_PACKS_MAX]; /* each holds over those before it */
    double gap;                         /* the share of places that no pack reaches */
    bake_grid fill;                     /* uint16: heights for them; closed while there are none */
    uint32_t fill_log2; /* places from one to the next; the last column and row have some, too */
} merge_samples;

/* Decodes packs whose places are found, in the order they were named. The lattice stays where it is
 * meanwhile. Close it whatever comes back: 0 or -1 (said). */
int merge_samples_open(const bake_unpack unpack[], const merge_place place[], uint32_t count,
                       const merge_lattice *lattice, merge_samples *samples);
void merge_samples_close(merge_samples *samples);

#endif
