/* Desktop GL, compatibility profile: vertex buffers from 1.5 on, plain arrays from 1.2 on. */
#include "c3d_gl_local.h"

static int gl_open(void *opaque, const c3d_desc *desc, int *buffers)
{
    c3d_gl_state *state = opaque;
    int rc = c3d_gl_load(&state->gl, desc->surface_api, buffers);
    if (rc < 0) return rc;
    const unsigned char *text = state->gl.GetString(GL_VERSION);
    /* GL ES begins its version with a word, which gives 0 */
    int version = text ? c3d_gl_version((const char *)text) : 0;
    if (version < 12) return FF_ERR_UNSUPPORTED;
    state->gl.ClipPlanef = NULL; /* GL ES's, which some loaders find anyway */
    *buffers = *buffers && version >= 15;
    state->buffers = *buffers;
    return FF_OK;
}

const struct c3d_backend *c3d_backend_gl(void)
{
    static const struct c3d_backend backend = { .name = "gl", .open = gl_open, C3D_GL_TABLE };
    return &backend;
}
