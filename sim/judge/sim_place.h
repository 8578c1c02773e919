/* Points in metres among drawn nodes: the judge's own side of the shape (protocol/shape), in double
 * precision, so that what it finds does not hang on the client's arithmetic. Planar. */
#ifndef SIM_PLACE_H
#define SIM_PLACE_H

#include "../../client/terrain/ff_tree.h"
#include "sim_ground.h"

/* Column and row, in cells, of a point in a drawn node's grid: 1 when it lies over the node. */
int sim_place_in_node(const ff_terrain_info *info, const ff_drawn *drawn, const double point_m[3],
                      double cell[2]);
/* At a distance of d m ground lies d * d times this lower than its height says; 0: flat. */
double sim_place_curve_per_m(const ff_terrain_info *info);
/* The column and row, in cells, of the terrain's last sample where it lies in the node; else the
 * node's last ones. What is beyond is drawn there. */
void sim_place_last(const ff_terrain_info *info, const ff_drawn *drawn, double cell[2]);
/* A point of a drawn node's grid, given in cells, at a height. */
void sim_place_of_cell(const ff_drawn *drawn, const double cell[2], double height_m,
                       double point_m[3]);
/* The middle of a drawn node's ground, at height 0. */
void sim_place_middle(const ff_terrain_info *info, const ff_drawn *drawn, double point_m[3]);
/* The point straight over or under another one at a height, as an eye sees it: curved ground has
 * fallen away from the eye. */
void sim_place_lift(const sim_ground *ground, const double eye_m[3], const double point_m[3],
                    double height_m, double lifted_m[3]);
/* The way from a place to a point that an eye sees, along the axes of the frame there: as a
 * panorama taken at the place shows it. */
void sim_place_seen_from(const sim_ground *ground, const int32_t place_wu[3], const double eye_m[3],
                         const double point_m[3], double way_m[3]);

#endif
