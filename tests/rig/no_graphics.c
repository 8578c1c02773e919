/* Stands in for graphics libraries and libpng on machines without them: there is no GL, and
 * pictures meant for looking at are not kept. */
#include "../../common3d/c3d.h"

const sys_surface_api *sys_surface_glfw(void) { return NULL; }
const sys_surface_api *sys_surface_egl(void) { return NULL; }
const sys_surface_api *sys_surface_osmesa(void) { return NULL; }
const struct c3d_backend *c3d_backend_gl(void) { return NULL; }
const struct c3d_backend *c3d_backend_gles1(void) { return NULL; }

int sys_png_write(const char *path, const uint8_t *rgb, uint32_t width, uint32_t height)
{
    (void)path, (void)rgb, (void)width, (void)height;
    return FF_OK;
}
