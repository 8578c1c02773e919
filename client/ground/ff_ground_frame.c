#include "ff_ground_frame.h"
#include "../../protocol/ff_assert.h"

#define FOLLOW_WU FF_SHAPE_DROP_SLACK_WU

/* The height that becomes z = 0: in the middle of the terrain's, so that the call's origin is near
 * its ground. */
static int32_t base_height(const ff_terrain_info *info)
{
    FF_ASSERT(info->height_min <= info->height_max);
    return info->height_min + (info->height_max - info->height_min) / 2;
}

static ff_box level_bounds(const ff_terrain_info *info)
{
    static const int64_t height_wu[2] = { 0, 0 };
    static const int32_t from_wu[3] = { 0, 0, 0 };
    const ff_frame world = { 0 };
    return ff_shape_bounds(info, &world, height_wu, from_wu);
}

/* A ground's origin along an axis: its last sample up to the frame's, or its nearest one. */
static int32_t origin_of(const ff_ground_frame *frame, const ff_terrain_info *info, int axis)
{
    ff_box ground = level_bounds(info);
    int64_t at_wu = frame->origin_wu[axis], spacing = info->spacing_wu;
    at_wu = at_wu < ground.lo[axis] ? ground.lo[axis] : at_wu;
    at_wu = at_wu > ground.hi[axis] ? ground.hi[axis] : at_wu;
    return (int32_t)(at_wu - (at_wu - ground.lo[axis]) % spacing);
}

/* Samples from the origin to the node's south-west corner along an axis. Both lie on the ground,
 * and both on samples. */
static int32_t samples_to(const ff_ground_frame *frame, const ff_terrain_info *info,
                          const ff_drawn *drawn, int axis)
{
    int32_t away_wu = drawn->origin_wu[axis] - origin_of(frame, info, axis);
    FF_ASSERT(away_wu % (int32_t)info->spacing_wu == 0);
    return away_wu / (int32_t)info->spacing_wu;
}

/* Keeps a coordinate within all grounds. */
static int32_t place_on(const ff_terrain_info *grounds, uint32_t count, int axis, int32_t at_wu)
{
    int64_t lo = INT64_MAX, hi = INT64_MIN;
    for (uint32_t g = 0; g < count; g++) {
        ff_box ground = level_bounds(&grounds[g]);
        lo = ground.lo[axis] < lo ? ground.lo[axis] : lo;
        hi = ground.hi[axis] > hi ? ground.hi[axis] : hi;
    }
    FF_ASSERT(lo >= INT32_MIN && lo < hi && hi <= INT32_MAX);
    return (int32_t)(at_wu < lo ? lo : at_wu > hi ? hi : at_wu);
}

int ff_ground_frame_follow(ff_ground_frame *frame, const ff_terrain_info *grounds, uint32_t count,
                           const c3d_camera *camera)
{
    int64_t spacing = grounds->spacing_wu, reach = spacing > FOLLOW_WU ? spacing : FOLLOW_WU;
    ff_box first = level_bounds(grounds);
    int32_t place_wu[2], near = frame->set;
    for (int axis = 0; axis < 2; axis++) {
        place_wu[axis] = place_on(grounds, count, axis, camera->pos_wu[axis]);
        int64_t away_wu = (int64_t)place_wu[axis] - frame->origin_wu[axis];
        near = near && away_wu <= reach && away_wu >= -reach;
        away_wu = (int64_t)camera->pos_wu[axis] - frame->centre_wu[axis];
        near = near && (!grounds->curve_q60 || (away_wu <= FOLLOW_WU && away_wu >= -FOLLOW_WU));
    }
    if (near) return 0;
    for (int axis = 0; axis < 2; axis++) {
        frame->centre_wu[axis] = camera->pos_wu[axis];
        frame->origin_wu[axis] = (int32_t)(place_wu[axis] -
                                           (place_wu[axis] - first.lo[axis]) % spacing);
    }
    frame->set = 1;
    return 1;
}

/* Lowers vertices in the frame by what curved ground falls away, in height steps. */
static void bend(const ff_ground_frame *frame, const ff_terrain_info *info, c3d_vertex *vertices,
                 uint32_t count)
{
    uint64_t per_wu = (UINT64_C(1) << 48) / info->hscale_q24; /* steps, Q32 */
    int64_t from_wu[2];
    unsigned shift = 32;
    for (; per_wu >> 33; per_wu >>= 1) shift--;
    for (int axis = 0; axis < 2; axis++)
        from_wu[axis] = (int64_t)origin_of(frame, info, axis) - frame->centre_wu[axis];
    FF_ASSERT(shift > 16 && per_wu > 0);
    for (uint32_t i = 0; i < count; i++) {
        int64_t spacing = info->spacing_wu;
        uint64_t drop_wu = (uint64_t)ff_shape_drop_wu(info, from_wu[0] + vertices[i].x * spacing,
                                                      from_wu[1] + vertices[i].y * spacing);
        vertices[i].z -= (int32_t)((drop_wu * per_wu + (UINT64_C(1) << (shift - 1))) >> shift);
    }
}

void ff_ground_frame_vertices(const ff_ground_frame *frame, const ff_terrain_info *info,
                              const ff_drawn *drawn, c3d_vertex *vertices, uint32_t count)
{
    unsigned level = ff_key_level(drawn->key), shift = info->tile_log2 - info->node_log2 - level;
    int32_t west = samples_to(frame, info, drawn, 0), south = samples_to(frame, info, drawn, 1);
    int32_t lift = 32768 - base_height(info);
    ff_extent extent = ff_shape_extent(info, drawn->key);
    int32_t columns = (int32_t)extent.columns, rows = (int32_t)extent.rows;
    FF_ASSERT(level < ff_terrain_levels(info) && count <= FF_NODE_HEIGHTS_MAX);
    for (uint32_t i = 0; i < count; i++) {
        FF_ASSERT(vertices[i].x <= 1 << info->node_log2 && vertices[i].y <= 1 << info->node_log2);
        int32_t column = vertices[i].x << shift, row = vertices[i].y << shift;
        vertices[i].x = west + (column < columns ? column : columns);
        vertices[i].y = south + (row < rows ? row : rows);
        vertices[i].z += lift;
    }
    if (info->curve_q60) bend(frame, info, vertices, count);
}

void ff_ground_frame_last(const ff_terrain_info *info, const ff_drawn *drawn, c3d_draw *draw)
{
    unsigned cell_log2 = info->tile_log2 - info->node_log2 - ff_key_level(drawn->key);
    ff_extent extent = ff_shape_extent(info, drawn->key);
    FF_ASSERT(extent.columns > 0 && extent.rows > 0);
    const uint32_t last_q16[2] = { (uint32_t)(((uint64_t)extent.columns << 16) >> cell_log2),
                                   (uint32_t)(((uint64_t)extent.rows << 16) >> cell_log2) };
    for (int axis = 0; axis < 2; axis++)
        if (!draw->tex_last_q16[axis] || draw->tex_last_q16[axis] > last_q16[axis])
            draw->tex_last_q16[axis] = last_q16[axis];
}

void ff_ground_frame_draw(const ff_ground_frame *frame, const ff_terrain_info *info,
                          const c3d_camera *camera, c3d_draw *draw)
{
    FF_ASSERT(frame->set == 1 && info->spacing_wu <= INT32_MAX);
    for (int axis = 0; axis < 2; axis++)
        draw->origin_wu[axis] = (int64_t)origin_of(frame, info, axis) - camera->pos_wu[axis];
    draw->origin_wu[2] = (int64_t)ff_height_wu(info, (uint32_t)base_height(info)) -
                         camera->pos_wu[2];
    draw->xy_scale_wu = (int32_t)info->spacing_wu;
    draw->z_scale_q16 = info->hscale_q24;
    draw->tex_columns = (uint16_t)ff_node_side(info);
}
