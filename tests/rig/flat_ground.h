/* Level ground for tests of far sets: one tile of 256 cells of 90 m; and a level camera over its
 * middle. */
#ifndef FLAT_GROUND_H
#define FLAT_GROUND_H

#include "../../common3d/c3d.h"
#include "../../protocol/ff_terrain.h"

static inline ff_terrain_info flat_ground(void)
{
    return (ff_terrain_info){ .node_log2 = 3,
                              .tile_log2 = 8,
                              .height_max = 2000,
                              .tiles_x = 1,
                              .tiles_y = 1,
                              .samples_x = 257,
                              .samples_y = 257,
                              .spacing_wu = 90 * FF_WU_PER_METRE,
                              .hscale_q24 = 1 << 24 };
}

static inline c3d_camera flat_ground_camera(uint16_t wide, uint16_t high, int32_t focal)
{
    return (c3d_camera){ .pos_wu = { 100000 * FF_WU_PER_METRE, 100000 * FF_WU_PER_METRE,
                                     2000 * FF_WU_PER_METRE },
                         .focal_q8 = focal * 256,
                         .width = wide,
                         .height = high,
                         .near_wu = 50 * FF_WU_PER_METRE,
                         .far_wu = 60000 * FF_WU_PER_METRE };
}

#endif
