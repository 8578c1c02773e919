/* The fixed-function GL that both back ends speak: GL ES 1.1 and what desktop GL 1.5 shares with
 * it. Functions are loaded from the surface of the device and never linked, so that several GL
 * libraries live side by side in one process; constants are those of the OpenGL registry, spelt
 * here so that no GL header is needed. Inside common3d/gl and common3d/gles1 only.
 */
#ifndef C3D_GL_API_H
#define C3D_GL_API_H

#include "../c3d_backend.h"

enum {
    GL_POINTS = 0x0000,
    GL_LINES = 0x0001,
    GL_TRIANGLES = 0x0004,
    GL_TRIANGLE_STRIP = 0x0005,
    GL_SRC_ALPHA = 0x0302,
    GL_ONE_MINUS_SRC_ALPHA = 0x0303,
    GL_LEQUAL = 0x0203,
    GL_GEQUAL = 0x0206,
    GL_DEPTH_BUFFER_BIT = 0x0100,
    GL_COLOR_BUFFER_BIT = 0x4000,
    GL_CLIP_PLANE0 = 0x3000,
    GL_CULL_FACE = 0x0B44,
    GL_LIGHTING = 0x0B50,
    GL_FOG = 0x0B60,
    GL_DEPTH_TEST = 0x0B71,
    GL_ALPHA_TEST = 0x0BC0,
    GL_DITHER = 0x0BD0,
    GL_BLEND = 0x0BE2,
    GL_TEXTURE_2D = 0x0DE1,
    GL_FOG_START = 0x0B63,
    GL_FOG_END = 0x0B64,
    GL_FOG_MODE = 0x0B65,
    GL_FOG_COLOR = 0x0B66,
    GL_UNPACK_ALIGNMENT = 0x0CF5,
    GL_PACK_ALIGNMENT = 0x0D05,
    GL_UNSIGNED_BYTE = 0x1401,
    GL_UNSIGNED_SHORT = 0x1403,
    GL_FLOAT = 0x1406,
    GL_UNSIGNED_SHORT_5_5_5_1 = 0x8034,
    GL_UNSIGNED_SHORT_5_6_5 = 0x8363,
    GL_MODELVIEW = 0x1700,
    GL_PROJECTION = 0x1701,
    GL_TEXTURE = 0x1702,
    GL_RGB = 0x1907,
    GL_RGBA = 0x1908,
    GL_VERSION = 0x1F02,
    GL_REPLACE = 0x1E01,
    GL_MODULATE = 0x2100,
    GL_DECAL = 0x2101,
    GL_TEXTURE_ENV_MODE = 0x2200,
    GL_TEXTURE_ENV = 0x2300,
    GL_LINEAR = 0x2601,
    GL_TEXTURE_MAG_FILTER = 0x2800,
    GL_TEXTURE_MIN_FILTER = 0x2801,
    GL_TEXTURE_WRAP_S = 0x2802,
    GL_TEXTURE_WRAP_T = 0x2803,
    GL_CLAMP_TO_EDGE = 0x812F,
    GL_VERTEX_ARRAY = 0x8074,
    GL_COLOR_ARRAY = 0x8076,
    GL_TEXTURE_COORD_ARRAY = 0x8078,
    GL_ARRAY_BUFFER = 0x8892,
    GL_ELEMENT_ARRAY_BUFFER = 0x8893,
    GL_STATIC_DRAW = 0x88E4
};

/* X(result, name, arguments): functions every context must have, then those of vertex buffers, then
 * those of which a context has one. */
#define C3D_GL_FUNCTIONS(X)                                                                \
    X(void, AlphaFunc, (unsigned function, float reference))                               \
    X(void, BindTexture, (unsigned target, unsigned texture))                              \
    X(void, BlendFunc, (unsigned source, unsigned target))                                 \
    X(void, Clear, (unsigned mask))                                                        \
    X(void, ClearColor, (float red, float green, float blue, float alpha))                 \
    X(void, Color4f, (float red, float green, float blue, float alpha))                    \
    X(void, ColorPointer, (int size, unsigned type, int stride, const void *pointer))      \
    X(void, DeleteTextures, (int count, const unsigned *textures))                         \
    X(void, DepthFunc, (unsigned function))                                                \
    X(void, DepthMask, (unsigned char flag))                                               \
    X(void, Disable, (unsigned capability))                                                \
    X(void, DisableClientState, (unsigned array))                                          \
    X(void, DrawArrays, (unsigned mode, int first, int count))                             \
    X(void, DrawElements, (unsigned mode, int count, unsigned type, const void *indices))  \
    X(void, Enable, (unsigned capability))                                                 \
    X(void, EnableClientState, (unsigned array))                                           \
    X(void, Finish, (void))                                                                \
    X(void, Fogf, (unsigned name, float value))                                            \
    X(void, Fogfv, (unsigned name, const float *values))                                   \
    X(void, GenTextures, (int count, unsigned *textures))                                  \
    X(unsigned, GetError, (void))                                                          \
    X(const unsigned char *, GetString, (unsigned name))                                   \
    X(void, LoadIdentity, (void))                                                          \
    X(void, LoadMatrixf, (const float *matrix))                                            \
    X(void, MatrixMode, (unsigned mode))                                                   \
    X(void, PixelStorei, (unsigned name, int value))                                       \
    X(void, PointSize, (float size))                                                       \
    X(void, ReadPixels,                                                                    \
      (int x, int y, int width, int height, unsigned format, unsigned type, void *pixels)) \
    X(void, TexCoordPointer, (int size, unsigned type, int stride, const void *pointer))   \
    X(void, TexEnvf, (unsigned target, unsigned name, float value))                        \
    X(void, TexImage2D,                                                                    \
      (unsigned target, int level, int internal_format, int width, int height, int border, \
       unsigned format, unsigned type, const void *pixels))                                \
    X(void, TexParameterf, (unsigned target, unsigned name, float value))                  \
    X(void, VertexPointer, (int size, unsigned type, int stride, const void *pointer))     \
    X(void, Viewport, (int x, int y, int width, int height))

#define C3D_GL_BUFFER_FUNCTIONS(X)                                                           \
    X(void, BindBuffer, (unsigned target, unsigned buffer))                                  \
    X(void, BufferData, (unsigned target, ptrdiff_t size, const void *data, unsigned usage)) \
    X(void, DeleteBuffers, (int count, const unsigned *buffers))                             \
    X(void, GenBuffers, (int count, unsigned *buffers))

#define C3D_GL_CLIP_FUNCTIONS(X)                                                    \
    X(void, ClipPlane, (unsigned plane, const double equation[4])) /* desktop GL */ \
    X(void, ClipPlanef, (unsigned plane, const float equation[4])) /* GL ES */

typedef struct c3d_gl_api {
#define X(result, name, arguments) result(*name) arguments;
    C3D_GL_FUNCTIONS(X)
    C3D_GL_BUFFER_FUNCTIONS(X)
    C3D_GL_CLIP_FUNCTIONS(X)
#undef X
} c3d_gl_api;

/* FF_OK or FF_ERR_UNSUPPORTED. *buffers says whether vertex buffers are wanted; it becomes 0 when
 * their functions are missing. */
int c3d_gl_load(c3d_gl_api *gl, const sys_surface_api *surface_api, int *buffers);

#endif
