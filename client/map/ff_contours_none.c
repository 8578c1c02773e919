/* Stands in for ff_contours.c in builds without maps. */
#include "ff_contours.h"

const int ff_contours_built = 0;

int ff_contours_make(ff_contours *contours, c3d_device *device, c3d_vertex *vertex)
{
    *contours = (ff_contours){ .device = device, .vertex = vertex };
    return FF_OK;
}
void ff_contours_strip(ff_contours *contours, const ff_contour_node *node, const uint16_t *index,
                       uint32_t count)
{
    (void)contours, (void)node, (void)index, (void)count;
}
void ff_contours_flush(ff_contours *contours, const c3d_draw *ground)
{
    (void)contours, (void)ground;
}
void ff_contours_point(ff_contours *contours, const int64_t offset_wu[3])
{
    (void)contours, (void)offset_wu;
}
