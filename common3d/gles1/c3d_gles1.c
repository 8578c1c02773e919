/* GL ES 1.x, common profile: vertex buffers from 1.1 on, plain arrays with 1.0. */
#include "../gl/c3d_gl_local.h"

#include <string.h>

static int gles1_open(void *opaque, const c3d_desc *desc, int *buffers)
{
    static const char prefix[] = "OpenGL ES-CM ";
    c3d_gl_state *state = opaque;
    int rc = c3d_gl_load(&state->gl, desc->surface_api, buffers);
    if (rc < 0) return rc;
    const char *text = (const char *)state->gl.GetString(GL_VERSION);
    if (!text || strncmp(text, prefix, sizeof prefix - 1) != 0) return FF_ERR_UNSUPPORTED;
    int version = c3d_gl_version(text + sizeof prefix - 1);
    if (version / 10 != 1) return FF_ERR_UNSUPPORTED;
    state->gl.ClipPlane = NULL; /* desktop GL's, which some loaders find anyway */
    if (version < 11) state->gl.ClipPlanef = NULL;
    *buffers = *buffers && version >= 11;
    state->buffers = *buffers;
    return FF_OK;
}

const struct c3d_backend *c3d_backend_gles1(void)
{
    static const struct c3d_backend backend = { .name = "gles1", .open = gles1_open, C3D_GL_TABLE };
    return &backend;
}
