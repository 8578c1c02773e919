/* Where a flight of the device's own goes: along the terrain's diagonal, from --at on, or to --to.
 */
#include "handheld.h"

#include "../../protocol/shape/ff_shape.h"

#define HERE         2 / 5   /* where the flight begins, of the diagonal */
#define PITCH_BRAD16 (-1092) /* 6 degrees down */
#define FOV_BRAD16   10923   /* 60 degrees */

static int fail(const char *option, int rc)
{
    fprintf(stderr, "farfield-handheld: %s: %s\n", option, sim_spot_why(rc));
    return -1;
}

/* Once a terrain and its place on Earth are known. 0, or -1 having said why not. */
static int find_way(handheld *device, const ff_terrain_info *info)
{
    const handheld_options *options = device->options;
    if (device->has_way) return 0;
    ff_shape_size_wu(info, device->way_wu);
    for (int axis = 0; axis < 2; axis++)
        device->at_wu[axis] = (int32_t)(device->way_wu[axis] * HERE);
    int rc = options->at.given ? sim_where_ask(&device->where, device->client) : FF_OK;
    if (rc == FF_ERR_AGAIN) return 0;
    if (rc == FF_OK && options->at.given)
        rc = sim_spot_find(&options->at, &device->where.geo, info, device->at_wu);
    if (rc != FF_OK) return fail("--at", rc);
    if (options->to.given) {
        int32_t to_wu[2];
        rc = sim_spot_find(&options->to, &device->where.geo, info, to_wu);
        if (rc != FF_OK) return fail("--to", rc);
        for (int axis = 0; axis < 2; axis++)
            device->way_wu[axis] = (int64_t)to_wu[axis] - device->at_wu[axis];
    }
    device->has_way = 1;
    return 0;
}

/* The yaw that looks east and north by so much. */
static int32_t yaw_towards(int64_t east, int64_t north)
{
    int32_t yaw = east < 0 ? 32768 : 0;
    for (int32_t step = 16384; step; step >>= 1)
        if (east * c3d_cos_q30(yaw + step) >= north * c3d_sin_q30(yaw + step)) yaw += step;
    return yaw;
}

static int64_t above_wu(const handheld_options *options, const sim_spot *place)
{
    return place->above_wu >= 0 && place->given ? place->above_wu
                                                : (int64_t)options->height_m * FF_WU_PER_METRE;
}

int handheld_way(handheld *device, uint32_t frame, c3d_camera *camera)
{
    const handheld_options *options = device->options;
    const ff_terrain_info *info = ff_client_terrain(device->client);
    int64_t flown_wu = (int64_t)frame * HANDHELD_FRAME_US * options->speed_kmh / 3600 *
                       FF_WU_PER_METRE / 1000;
    *camera = (c3d_camera){ .yaw = 8192,
                            .pitch = PITCH_BRAD16,
                            .width = device->width,
                            .height = device->height,
                            .focal_q8 = c3d_focal_q8(FOV_BRAD16, device->width) };
    if (!info) return 0;
    if (find_way(device, info)) return -1;
    int64_t east = device->way_wu[0], north = device->way_wu[1],
            way_wu = c3d_length64(east, north, 0), above = above_wu(options, &options->at);
    if (way_wu == 0) way_wu = 1;
    if (options->to.given) {
        if (flown_wu > way_wu) flown_wu = way_wu;
        if (east || north) camera->yaw = yaw_towards(east, north);
        above += (above_wu(options, &options->to) - above) * flown_wu / way_wu;
    }
    camera->pos_wu[0] = (int32_t)(device->at_wu[0] + flown_wu * east / way_wu);
    camera->pos_wu[1] = (int32_t)(device->at_wu[1] + flown_wu * north / way_wu);
    int32_t ground_wu = 0;
    if (!ff_client_ground(device->client, camera->pos_wu[0], camera->pos_wu[1], &ground_wu))
        ground_wu = ff_height_wu(info, info->height_max);
    camera->pos_wu[2] = ground_wu + (int32_t)above;
    if (options->map_m) handheld_map(device, ground_wu, camera);
    return 0;
}
