#include "sim_where.h"

#include "sim_client_options.h"
#include "../../protocol/shape/ff_shape.h"

#include <inttypes.h>
#include <stdio.h>

#define DEGREE_E9 INT64_C(1000000000)

/* ---- --at, --to ---- */

static int degrees_at(const char **text, unsigned most, int64_t *degrees_e9)
{
    uint64_t value;
    int south = **text == '-';
    *text += south;
    if (sys_decimal(text, (uint32_t)DEGREE_E9, most * (uint64_t)DEGREE_E9, &value))
        return SYS_NOT_ONE;
    *degrees_e9 = south ? -(int64_t)value : (int64_t)value;
    return 0;
}

static int take_place(const sys_option *option, const char *text, void *field)
{
    sim_spot place = { .given = 1, .above_wu = -1 };
    uint64_t above;
    (void)option;
    if (degrees_at(&text, 90, &place.latitude_e9) || *text++ != ',' ||
        degrees_at(&text, 360, &place.longitude_e9))
        return SYS_NOT_ONE;
    if (*text == ',') {
        text++;
        if (sys_decimal(&text, FF_WU_PER_METRE, (uint64_t)SIM_HEIGHT_M_MAX * FF_WU_PER_METRE,
                        &above))
            return SYS_NOT_ONE;
        place.above_wu = (int32_t)above;
    }
    *(sim_spot *)field = place;
    return *text ? SYS_NOT_ONE : 0;
}

static int place_range(const sys_option *option, char *text, size_t room)
{
    (void)option;
    return snprintf(text, room,
                    "degrees north, -90 to 90, degrees east, -360 to 360, and metres above "
                    "ground, 0 to %d",
                    SIM_HEIGHT_M_MAX);
}

const sys_option_type sim_spot_option = { "LAT,LON[,HEIGHT], ", place_range, take_place };

int sim_spot_find(const sim_spot *place, const ff_geo *geo, const ff_terrain_info *info,
                  int32_t xy_wu[2])
{
    const ff_geo_place on_earth = { place->latitude_e9, place->longitude_e9, 0 };
    int32_t position_wu[3];
    int64_t size_wu[2];
    int rc = ff_geo_to(geo, &on_earth, position_wu);
    ff_shape_size_wu(info, size_wu);
    for (int axis = 0; rc == FF_OK && axis < 2; axis++) {
        xy_wu[axis] = position_wu[axis];
        if (xy_wu[axis] < 0 || xy_wu[axis] > size_wu[axis]) rc = FF_ERR_RANGE;
    }
    return rc;
}

const char *sim_spot_why(int error)
{
    switch (error) {
        case FF_ERR_RANGE: return "the place lies outside the terrain";
        case FF_ERR_AGAIN: return "where the terrain lies on Earth is not known yet";
        case FF_ERR_NOT_FOUND: return "the pack does not say where on Earth it lies";
        case FF_ERR_UNSUPPORTED:
            return "this build cannot tell latitudes and longitudes in the pack's projection";
        default: return ff_error_text(error);
    }
}

/* ---- where a viewer is ---- */

int sim_where_ask(sim_where *where, ff_client *client)
{
    const ff_terrain_info *info = ff_client_terrain(client);
    if (!info) where->known = 0;
    if (!info) return FF_ERR_AGAIN;
    if (where->known && where->checksum == info->checksum) return FF_OK;
    int rc = ff_client_geo(client, &where->geo);
    where->known = rc == FF_OK;
    where->checksum = info->checksum;
    return rc;
}

/* Degrees with five digits, which is a metre, and on which side of the equator or Greenwich. */
static int put_degrees(int64_t degrees_e9, const char sides[2], char *text, size_t room)
{
    int64_t value = (degrees_e9 < 0 ? -degrees_e9 : degrees_e9) + DEGREE_E9 / 200000;
    return snprintf(text, room, "%" PRId64 ".%05" PRId64 " %c", value / DEGREE_E9,
                    value % DEGREE_E9 / (DEGREE_E9 / 100000), sides[degrees_e9 < 0]);
}

int sim_where_line(const sim_where *where, const c3d_camera *camera, char *text, size_t room)
{
    char latitude[24], longitude[24];
    ff_geo_place place;
    int32_t north;
    if (!where->known || ff_geo_of(&where->geo, camera->pos_wu, &place) != FF_OK ||
        ff_geo_north(&where->geo, camera->pos_wu, &north) != FF_OK)
        return 0;
    (void)put_degrees(place.latitude_e9, "NS", latitude, sizeof latitude);
    (void)put_degrees(place.longitude_e9, "EW", longitude, sizeof longitude);
    int heading = (int)(((uint32_t)(camera->yaw - north) & 65535) * 360 + 32768) / 65536 % 360;
    return snprintf(text, room, "%s %s %d deg", latitude, longitude, heading);
}
