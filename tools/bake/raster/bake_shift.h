/* From one datum to another: by which of the operations that PROJ knows, and how well that is
 * known. */
#ifndef BAKE_SHIFT_H
#define BAKE_SHIFT_H

#include "bake_area.h"
#include "bake_gdal.h"

#define BAKE_OPERATION_MAX 2000

typedef struct bake_shift {
    /* the whole way from plane to plane, in PROJ's words; empty: the datum stays, and there is but
     * one way */
    char operation[BAKE_OPERATION_MAX];
    char name[200];          /* of the step between the datums */
    char from[100], to[100]; /* the systems of degrees */
    double accuracy_m;       /* negative: PROJ does not know */
    int is_ballpark;         /* nothing is shifted: degrees are taken for those of `to` */
    int is_beyond;           /* some of the area lies where the operation is not meant for */
    int is_known;            /* PROJ knows both datums */
    char grids[200];         /* files of a better operation that are not here; empty: none */
    double grids_m;          /* its accuracy */
    int stay_epsg;           /* a plane in metres on the ground's own datum; 0: none found */
} bake_shift;

/* The box of degrees round a raster, its east less than its west across 180 degrees. 0, or -1: it
 * lies nowhere on the Earth. */
int bake_shift_area(OGRSpatialReferenceH srs, const double *geotransform, uint32_t width,
                    uint32_t height, bake_area *degrees);
/* Finds the operation that brings all of a place, told in degrees, from one system to another: the
 * one that PROJ holds to be best there, of those whose grids are here. GDAL left to itself chooses
 * again for each point. 0, or -1 where nothing is known between two known datums (said, of
 * `path`); NULL for a system: no shift. `otherwise`: what to do instead; NULL: to name a plane on
 * the ground's own datum with --t-srs. */
int bake_shift_find(const char *path, OGRSpatialReferenceH from, OGRSpatialReferenceH to,
                    const bake_area *degrees, const char *otherwise, bake_shift *shift);
/* Tells of a shift that may move the ground by more than half a cell: less is told by nothing in
 * the ground, and is the most that any sample of a bake may lie off. */
void bake_shift_note(const char *path, const bake_shift *shift, double cell_m);

#endif
