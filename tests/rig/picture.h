/* Tiny renders as text, for tests of whatever draws: a device on an off-screen surface, simple
 * squares, pictures as letters. */
#ifndef PICTURE_H
#define PICTURE_H

#include "../../common3d/c3d.h"

enum picture_kind {
    PICTURE_GL /* OSMesa, desktop GL */,
    PICTURE_GLES1 /* EGL, GL ES 1.1 */,
    PICTURE_EGL_GL,
    PICTURE_SOFT /* RGBA8888 */,
    PICTURE_SOFT_565,
    PICTURE_KINDS
};

/* Squares of PICTURE_UNITS vertex units from the origin: level (x to the east, y to the north), or
 * upright and facing south or west. */
#define PICTURE_UNITS  64
#define PICTURE_STRIPS 32 /* that a kit's device holds */
enum picture_plane { PICTURE_LEVEL, PICTURE_SOUTH, PICTURE_WEST, PICTURE_PLANES };

typedef struct picture_kit {
    enum picture_kind kind;
    const sys_surface_api *api;
    sys_surface *surface;
    c3d_device *device;
    void *memory;
    int width, height;
    c3d_mesh square[PICTURE_PLANES];
    c3d_strip strip; /* the strip of a square */
    /* at the origin, looking north, 90 degrees wide, near 0.25 m, far 4 km, black; a test may
     * change it */
    c3d_frame frame;
} picture_kit;

/* Pool sizes are fixed and small. FF_OK or the error of the surface or the device. */
int picture_open(picture_kit *kit, enum picture_kind kind, int width, int height,
                 int use_vertex_buffers);
void picture_close(picture_kit *kit);

/* A square of size_wu (a multiple of PICTURE_UNITS, at most 16 km) with its corner at (x, y, z) wu
 * from the camera, in one colour: 0xAABBGGRR. */
c3d_draw picture_square(const picture_kit *kit, enum picture_plane plane, int64_t x_wu,
                        int64_t y_wu, int64_t z_wu, int32_t size_wu, uint32_t colour);

/* Begins, draws, ends and reads back a frame into rgb (width * height * 3). */
void picture_render(picture_kit *kit, const c3d_draw *draws, size_t count, uint8_t *rgb);

/* One letter a pixel, a line a row: . black, w white, r g b c m y full colours, - grey; ? none of
 * these within 40 of 255. */
void picture_text(const uint8_t *rgb, int width, int height, char *text);
/* Renders and compares with the expected text; prints both and returns 0 when they differ. */
int picture_is(picture_kit *kit, const c3d_draw *draws, size_t count, const char *expected);

/* Largest difference of two pixels' colours. */
int picture_apart(const uint8_t *a, const uint8_t *b);
/* Counts pixels of either picture that differ by more than `tolerance` from the other's pixel at
 * the same place and all beside it (edges may lie a pixel apart); *strict counts those that differ
 * at the same place. */
int picture_disagreement(const uint8_t *a, const uint8_t *b, int width, int height, int tolerance,
                         int *strict);

#define PICTURE_RED   0xFF0000FFu
#define PICTURE_GREEN 0xFF00FF00u
#define PICTURE_BLUE  0xFFFF0000u
#define PICTURE_WHITE 0xFFFFFFFFu
#define PICTURE_M     256 /* wu in a metre */

#endif
