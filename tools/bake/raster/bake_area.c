#include "bake_area.h"

#include <math.h>

bake_area bake_area_of(const double *gt, uint32_t width, uint32_t height)
{
    bake_area area = { INFINITY, INFINITY, -INFINITY, -INFINITY };
    for (int corner = 0; corner < 4; corner++) {
        double column = corner & 1 ? width : 0, row = corner & 2 ? height : 0;
        double x = gt[0] + gt[1] * column + gt[2] * row, y = gt[3] + gt[4] * column + gt[5] * row;
        area.west = fmin(area.west, x);
        area.east = fmax(area.east, x);
        area.south = fmin(area.south, y);
        area.north = fmax(area.north, y);
    }
    return area;
}

int bake_area_meets(const bake_area *a, const bake_area *b)
{
    return a->west < b->east && b->west < a->east && a->south < b->north && b->south < a->north;
}
