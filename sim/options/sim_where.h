/* Places on Earth for programs with a client: --at and --to, and the line that tells where a viewer
 * is. In integers alone. */
#ifndef SIM_WHERE_H
#define SIM_WHERE_H

#include "../../client/farfield.h"
#include "../../platform/options/sys_options.h"

/* LAT,LON[,HEIGHT]: degrees north and east, and metres above ground. */
typedef struct sim_spot {
    uint8_t given;
    int64_t latitude_e9, longitude_e9;
    int32_t above_wu; /* -1: not said */
} sim_spot;
extern const sys_option_type sim_spot_option;

/* clang-format off */
#define SIM_SPOT_OPTIONS(OPTION, at_help, to_help) \
    OPTION(sim_spot, at, "at", "LAT,LON[,HEIGHT]", NULL, SYS_ANY, at_help) \
    OPTION(sim_spot, to, "to", "LAT,LON[,HEIGHT]", NULL, SYS_ANY, to_help)
/* clang-format on */

/* Where it lies in the world. FF_OK, or FF_ERR_RANGE: outside the ground of `info`. */
int sim_spot_find(const sim_spot *place, const ff_geo *geo, const ff_terrain_info *info,
                  int32_t xy_wu[2]);
/* What to say where a place cannot be found: of an error of that, or of what made `geo`. */
const char *sim_spot_why(int error);

/* Where a client's ground lies, asked once for a terrain. All zero at first. */
typedef struct sim_where {
    ff_geo geo;
    uint8_t known;
    uint32_t checksum; /* of the terrain that it is known of */
} sim_where;
/* FF_OK, or as ff_client_geo, whose desc.about has to have SIM_WHERE_ABOUT. */
#define SIM_WHERE_ABOUT FF_ABOUT_BIT(FF_ABOUT_PROJECTION)
int sim_where_ask(sim_where *where, ff_client *client);
/* "37.57780 N 105.48560 W 123 deg": of a camera, 123 degrees from true north. Bytes, or 0: not
 * known. */
int sim_where_line(const sim_where *where, const c3d_camera *camera, char *text, size_t room);

#endif
