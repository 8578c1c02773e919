/* The sky is the client's own: a sphere of vertex colours from the horizon's colour, which is the
 * fog's and the clear colour, up to a deeper blue, and down to the colour of bare ground. Costs
 * nothing on the link, whatever the panorama shows. */
#ifndef FF_SKY_H
#define FF_SKY_H

#include "../common3d/c3d.h"

#define FF_SKY_HORIZON_COLOUR 0xFFE8D8C8u /* 0xAABBGGRR */

typedef struct ff_sky {
    c3d_mesh mesh;
    c3d_strip strip;
} ff_sky;

#define FF_SKY_VERTICES 80
#define FF_SKY_INDICES  178
/* Without room on the device there is just the clear colour. */
void ff_sky_make(ff_sky *sky, c3d_device *device);
void ff_sky_draw(const ff_sky *sky, c3d_device *device, int32_t near_wu);

#endif
