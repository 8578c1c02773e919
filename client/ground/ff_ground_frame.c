#include "ff_ground_frame.h"

#include <string.h>

#define HEIGHT_RANGE_MAX 60000 /* leaves room for what lossy decoding adds */
#define FOLLOW_WU        (512 * FF_WU_PER_METRE)

/* Samples from the frame to the node's south-west corner, and samples a cell as a power of two; 0
 * when out of 16 bits' reach. */
typedef struct node_place {
    int64_t base[2];
    uint8_t shift;
} node_place;

static int place_node(const ff_ground_frame *frame, const ff_terrain_info *info,
                      const ff_drawn *drawn, node_place *place)
{
    place->shift = (uint8_t)(info->tile_log2 - info->node_log2 - ff_key_level(drawn->key));
    for (int axis = 0; axis < 2; axis++) {
        int64_t away_wu = (int64_t)drawn->origin_wu[axis] - frame->origin_wu[axis];
        int64_t samples = c3d_divide_saturated((uint64_t)(away_wu < 0 ? -away_wu : away_wu),
                                               info->spacing_wu);
        int64_t base = away_wu < 0 ? -samples : samples;
        int64_t end = base + ((int64_t)1 << (info->node_log2 + place->shift));
        if (base < INT16_MIN || end > INT16_MAX) return 0;
        place->base[axis] = base;
    }
    return 1;
}

/* The height that becomes z = 0: in the middle of the terrain's, so that the call's origin is near
 * its ground. Terrains that need nearly all 16 bits keep ff_tree_vertices' own. */
static int32_t base_height(const ff_terrain_info *info)
{
    uint32_t range = (uint32_t)(info->height_max - info->height_min);
    return range > HEIGHT_RANGE_MAX ? 32768 : info->height_min + (int32_t)(range / 2);
}

static int16_t to_int16(int32_t value)
{
    return (int16_t)(value < INT16_MIN ? INT16_MIN : value > INT16_MAX ? INT16_MAX : value);
}

int ff_ground_frame_follow(ff_ground_frame *frame, const ff_terrain_info *info,
                           const c3d_camera *camera)
{
    int64_t spacing = info->spacing_wu, reach = spacing > FOLLOW_WU ? spacing : FOLLOW_WU;
    int near = frame->set;
    for (int axis = 0; axis < 2; axis++) {
        int64_t away = (int64_t)camera->pos_wu[axis] - frame->origin_wu[axis];
        near = near && away <= reach && away >= -reach;
    }
    if (near) return 0;
    for (int axis = 0; axis < 2; axis++)
        frame->origin_wu[axis] = (int32_t)(camera->pos_wu[axis] / spacing * spacing);
    frame->set = 1;
    return 1;
}

void ff_ground_frame_vertices(const ff_ground_frame *frame, const ff_terrain_info *info,
                              const ff_drawn *drawn, c3d_vertex *vertices, uint32_t count)
{
    node_place place;
    int32_t lift = 32768 - base_height(info);
    for (uint32_t i = 0; i < count; i++) vertices[i].z = to_int16(vertices[i].z + lift);
    if (!place_node(frame, info, drawn, &place)) return;
    for (uint32_t i = 0; i < count; i++) {
        vertices[i].x = (int16_t)(place.base[0] + (vertices[i].x << place.shift));
        vertices[i].y = (int16_t)(place.base[1] + (vertices[i].y << place.shift));
    }
}

void ff_ground_frame_draw(const ff_ground_frame *frame, const ff_terrain_info *info,
                          const ff_drawn *drawn, const c3d_camera *camera, c3d_draw *draw)
{
    node_place place;
    int placed = place_node(frame, info, drawn, &place);
    if (!placed) memset(&place, 0, sizeof place);
    for (int axis = 0; axis < 2; axis++) {
        draw->origin_wu[axis] = (int64_t)(placed ? frame->origin_wu[axis]
                                                 : drawn->origin_wu[axis]) -
                                camera->pos_wu[axis];
        draw->tex_origin[axis] = (int32_t)place.base[axis];
    }
    draw->origin_wu[2] = (int64_t)ff_height_wu(info, (uint32_t)base_height(info)) -
                         camera->pos_wu[2];
    draw->tex_shift = place.shift;
    draw->xy_scale_wu = placed ? (int32_t)info->spacing_wu : drawn->cell_wu;
    draw->z_scale_q16 = info->hscale_q24;
}
