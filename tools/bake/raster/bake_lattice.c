#include "bake_lattice.h"

#include "../../../platform/sys.h"
#include "../bake_say.h"
#include "bake_reference.h"

#include <math.h>
#include <string.h>

#define OFF_MAX   0.125 /* samples: as far as grids that are kept elsewhere are off at their ends */
#define DOUBLINGS 20
#define SAME      1e-6

int bake_lattice_open(const char *path, bake_lattice *lattice)
{
    sys_mapping mapping;
    ff_pack pack;
    int rc = sys_map_file(path, &mapping);
    if (rc) return bake_fail("%s: %s", path, ff_error_text(rc));
    rc = ff_pack_open(&pack, mapping.bytes, mapping.size);
    if (rc)
        bake_fail("%s: %s", path, ff_pack_error_text(&pack, rc));
    else
        *lattice = (bake_lattice){ path, pack.header.info, bake_reference_of(&pack) };
    sys_unmap_file(&mapping);
    return rc ? -1 : 0;
}

void bake_lattice_close(bake_lattice *lattice)
{
    if (lattice->srs) OSRDestroySpatialReference(lattice->srs);
    lattice->srs = NULL;
}

int bake_lattice_target(const bake_lattice *lattice, const bake_ground *ground,
                        OGRSpatialReferenceH *target)
{
    *target = NULL;
    if (!ground->has_place)
        return bake_fail("the raster has no georeference: it lies nowhere on the lattice of %s",
                         lattice->path);
    if (!lattice->srs != !ground->srs)
        return bake_fail("%s names no reference system, and so no place on the other's lattice",
                         lattice->srs ? "the raster" : lattice->path);
    if (lattice->srs && !OSRIsSame(lattice->srs, ground->srs)) *target = OSRClone(lattice->srs);
    return 0;
}

/* A spacing 2^doublings times the pack's, in world units; 0: it has none. */
static uint32_t spacing_of(const bake_lattice *lattice, int doublings)
{
    uint64_t wu = lattice->info.spacing_wu;
    if (doublings < 0) return wu & ((1u << -doublings) - 1) ? 0 : (uint32_t)(wu >> -doublings);
    return wu << doublings > UINT32_MAX ? 0 : (uint32_t)(wu << doublings);
}

int bake_lattice_spacing(const bake_lattice *lattice, int is_told, double *spacing_m)
{
    double wanted_wu = *spacing_m * FF_WU_PER_METRE, best = INFINITY, best_wu = 0;
    for (int doublings = -DOUBLINGS; doublings <= DOUBLINGS; doublings++) {
        uint32_t wu = spacing_of(lattice, doublings);
        double off = wu ? fabs(log2((double)wu / wanted_wu)) : INFINITY;
        if (off >= best) continue;
        best = off;
        best_wu = wu;
    }
    if (is_told && best > SAME)
        return bake_fail(
            "--spacing %g: not a power of two times the %.9g m of %s, in whole 1/%d m: "
            "the nearest is %.9g m",
            *spacing_m, (double)lattice->info.spacing_wu / FF_WU_PER_METRE, lattice->path,
            FF_WU_PER_METRE, best_wu / FF_WU_PER_METRE);
    *spacing_m = best_wu / FF_WU_PER_METRE;
    return 0;
}

static double origin_m(const bake_lattice *lattice, int axis)
{
    const ff_terrain_info *info = &lattice->info;
    return (double)(axis ? info->origin_y_mm : info->origin_x_mm) / 1000;
}

double bake_lattice_axis(const bake_lattice *lattice, int axis, double low, double high,
                         double spacing_m, double *first)
{
    double origin = origin_m(lattice, axis), half = spacing_m / 2 * (1 - SAME),
           from = ceil((low + half - origin) / spacing_m),
           to = floor((high - half - origin) / spacing_m);
    *first = origin + from * spacing_m;
    return to - from + 1;
}

/* The lattice's place for the first of `count` samples that are `apart` metres apart; 0: some are
 * too far from it. */
static int keep_axis(const bake_lattice *lattice, int axis, double at, double apart, double count,
                     double spacing_m, double *first)
{
    double origin = origin_m(lattice, axis), middle = at + (count - 1) * (apart - spacing_m) / 2;
    *first = origin + nearbyint((middle - origin) / spacing_m) * spacing_m;
    double off = fabs(at - *first),
           end_off = fabs(at + (count - 1) * apart - *first - (count - 1) * spacing_m);
    return fmax(off, end_off) <= OFF_MAX * spacing_m;
}

int bake_lattice_keeps(const bake_lattice *lattice, bake_ground *ground, double spacing_m)
{
    double *gt = ground->geotransform, columns = ground->grid.width, rows = ground->grid.height,
           high = fabs(gt[5]), south = gt[5] < 0 ? gt[3] + gt[5] * rows : gt[3], x, y;
    double turned = (fabs(gt[2]) * rows + fabs(gt[4]) * columns) / spacing_m;
    if (gt[1] <= 0 || turned > SAME ||
        !keep_axis(lattice, 0, gt[0] + gt[1] / 2, gt[1], columns, spacing_m, &x) ||
        !keep_axis(lattice, 1, south + high / 2, high, rows, spacing_m, &y))
        return 0;
    double kept[6] = { x - spacing_m / 2,
                       spacing_m,
                       0,
                       gt[5] < 0 ? y + (rows - 0.5) * spacing_m : y - spacing_m / 2,
                       0,
                       gt[5] < 0 ? -spacing_m : spacing_m };
    memcpy(gt, kept, sizeof kept);
    return 1;
}
