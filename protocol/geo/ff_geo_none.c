/* Stands in for builds without: no place on Earth is known. */
#include "ff_geo.h"

#include "../ff_error.h"

int ff_geo_make(ff_geo *geo, const ff_about_projection *projection, const ff_terrain_info *info)
{
    return (void)geo, (void)projection, (void)info, FF_ERR_UNSUPPORTED;
}

int ff_geo_pack(ff_geo *geo, const ff_pack *pack)
{
    return (void)geo, (void)pack, FF_ERR_UNSUPPORTED;
}

int ff_geo_of(const ff_geo *geo, const int32_t position_wu[3], ff_geo_place *place)
{
    return (void)geo, (void)position_wu, (void)place, FF_ERR_UNSUPPORTED;
}

int ff_geo_to(const ff_geo *geo, const ff_geo_place *place, int32_t position_wu[3])
{
    return (void)geo, (void)place, (void)position_wu, FF_ERR_UNSUPPORTED;
}

int ff_geo_north(const ff_geo *geo, const int32_t position_wu[3], int32_t *north_brad16)
{
    return (void)geo, (void)position_wu, (void)north_brad16, FF_ERR_UNSUPPORTED;
}
