/* The whole ground of a pack in memory, in double precision metres: the truth that flights keep
 * clear of and pictures are judged by.
 *
 * Heights lie row by row from the south-west; between samples the ground is two triangles a cell,
 * the diagonal from south-west to north-east as in the drawn strips. It ends with the source's last
 * sample: at a level coarser than the finest the last column and row of cells may be narrower. A
 * pyramid of block maxima
 * makes ray casting fast: it starts at blocks of 4 x 4 cells.
 *
 * Several grounds joined are one truth: at a place the one with the narrowest cells that has it
 * counts, of equal ones the first. Where two meet at different heights there is a wall between
 * them, for whoever comes from the lower one.
 */
#ifndef SIM_GROUND_H
#define SIM_GROUND_H

#include "../../platform/sys.h"
#include "../../protocol/ff_pack.h"

#define SIM_GROUND_PYRAMID_FIRST 2 /* log2 of the cells along the finest block's side */
#define SIM_GROUND_PYRAMID_MAX   32

typedef struct sim_ground {
    struct sim_ground *next; /* another one joined to it, or NULL */
    double west_m, south_m;  /* the place of its south-west sample */
    uint32_t level;          /* of the tiles' quadtrees, as decoded */
    uint32_t columns, rows;  /* of heights */
    double cell_m;
    double size[2]; /* to the source's last sample, in cells */
    double hscale_m, hoffset_m;
    double curve_per_m; /* at a distance of d m ground lies d * d * curve_per_m lower; 0: flat */
    const uint16_t *height;
    /* a byte for each node, row by row: 1 when some of its ground was void in the source */
    const uint8_t *filled;
    uint32_t node_cells, node_columns, node_rows;
    void *block;         /* the memory of `height`, when it was decoded here */
    sys_mapping mapping; /* else the mapped file, shared by all who fly over this ground */
    unsigned top;        /* one block of 2^top cells a side covers everything */
    /* by log2 of the block's cells */
    struct {
        uint32_t columns, rows;
        uint16_t *max;
    } pyramid[SIM_GROUND_PYRAMID_MAX];
} sim_ground;

/* Decodes the finest level that has at most samples_max heights (level 0 whatever its size). FF_OK,
 * FF_ERR_MEMORY or an error of the pack's records. */
int sim_ground_load(sim_ground *ground, const ff_pack *pack, uint64_t samples_max);
/* The same by way of a file, when cache_path is not NULL: heights are taken from there when the
 * file is of this pack and level, else they are decoded and left there. FF_ERR_SYSTEM: the file
 * cannot be written. */
int sim_ground_load_cached(sim_ground *ground, const ff_pack *pack, uint64_t samples_max,
                           const char *cache_path);
/* Frees this one; of joined ones each is freed. */
void sim_ground_free(sim_ground *ground);
/* Joins ground to one and what was joined to it before; both stay where they are. The first one
 * says how all fall away. */
void sim_ground_join(sim_ground *first, sim_ground *more);
/* Why one terrain's ground cannot be the truth of the other's, in words: another number of samples,
 * spacing or place. NULL: it can; heights may differ, and how they are cut into tiles. */
const char *sim_ground_differs(const ff_terrain_info *a, const ff_terrain_info *b);

/* The one that counts at (x, y), or NULL. */
const sim_ground *sim_ground_at(const sim_ground *ground, double x_m, double y_m);
/* 1 when there is ground at (x, y). */
int sim_ground_has(const sim_ground *ground, double x_m, double y_m);
/* 1 where there is ground in a node that has filled voids. */
int sim_ground_filled(const sim_ground *ground, double x_m, double y_m);
/* Height at (x, y), clamped to the rim, of several the nearest. */
double sim_ground_height_m(const sim_ground *ground, double x_m, double y_m);
/* How much lower than its height says ground lies for an eye so far away. */
double sim_ground_drop_m(const sim_ground *ground, double east_m, double north_m);
/* From no place on it to another is it further. */
double sim_ground_reach_m(const sim_ground *ground);
/* 1 on ground no further from ground of another one than so many cells of the coarser; not at
 * corners behind which one of them goes on below the other. */
int sim_ground_near_border(const sim_ground *ground, double x_m, double y_m, double cells);
/* First ground along from + t * direction, 0 < t <= t_max (direction of any length): 1 and *t_hit,
 * or 0. Curved ground has fallen away from `from`: the point met lies by sim_ground_drop_m lower
 * than its height. The ground is a surface without walls: who comes in below its edge meets it from
 * below, if at all. */
int sim_ground_cast(const sim_ground *ground, const double from_m[3], const double direction[3],
                    double t_max, double *t_hit);

#endif
