#include "sim_place.h"

#include <math.h>

int sim_place_in_node(const ff_terrain_info *info, const ff_drawn *drawn, const double point_m[3],
                      double cell[2])
{
    double side = (double)(1u << info->node_log2),
           cell_m = (double)drawn->cell_wu / FF_WU_PER_METRE;
    for (int i = 0; i < 2; i++)
        cell[i] = (point_m[i] - (double)drawn->origin_wu[i] / FF_WU_PER_METRE) / cell_m;
    return cell[0] >= 0 && cell[1] >= 0 && cell[0] <= side && cell[1] <= side;
}

double sim_place_curve_per_m(const ff_terrain_info *info)
{
    return ldexp((double)info->curve_q60, -60) * FF_WU_PER_METRE;
}

void sim_place_last(const ff_terrain_info *info, const ff_drawn *drawn, double cell[2])
{
    const int32_t south_west_wu[2] = { info->west_wu, info->south_wu };
    int64_t size_wu[2];
    ff_shape_size_wu(info, size_wu);
    for (int i = 0; i < 2; i++)
        cell[i] = fmin(1u << info->node_log2,
                       (double)(south_west_wu[i] + size_wu[i] - drawn->origin_wu[i]) /
                           drawn->cell_wu);
}

void sim_place_of_cell(const ff_drawn *drawn, const double cell[2], double height_m,
                       double point_m[3])
{
    for (int i = 0; i < 2; i++)
        point_m[i] = ((double)drawn->origin_wu[i] + cell[i] * drawn->cell_wu) / FF_WU_PER_METRE;
    point_m[2] = height_m;
}

void sim_place_middle(const ff_terrain_info *info, const ff_drawn *drawn, double point_m[3])
{
    double last[2], cell_m = (double)drawn->cell_wu / FF_WU_PER_METRE;
    sim_place_last(info, drawn, last);
    for (int i = 0; i < 2; i++)
        point_m[i] = (double)drawn->origin_wu[i] / FF_WU_PER_METRE + last[i] * cell_m / 2;
    point_m[2] = 0;
}

static double fallen_m(const sim_ground *ground, const double eye_m[3], const double point_m[3])
{
    return sim_ground_drop_m(ground, point_m[0] - eye_m[0], point_m[1] - eye_m[1]);
}

void sim_place_lift(const sim_ground *ground, const double eye_m[3], const double point_m[3],
                    double height_m, double lifted_m[3])
{
    lifted_m[0] = point_m[0];
    lifted_m[1] = point_m[1];
    lifted_m[2] = height_m - fallen_m(ground, eye_m, point_m);
}

void sim_place_seen_from(const sim_ground *ground, const int32_t place_wu[3], const double eye_m[3],
                         const double point_m[3], double way_m[3])
{
    double place_m[3];
    for (int i = 0; i < 3; i++) {
        place_m[i] = (double)place_wu[i] / FF_WU_PER_METRE;
        way_m[i] = point_m[i] - place_m[i];
    }
    way_m[2] += fallen_m(ground, eye_m, point_m) - fallen_m(ground, place_m, point_m);
}
