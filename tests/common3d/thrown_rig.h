/* Pictures thrown on a mesh, and what they must look like: in double precision, ray by ray, by
 * geometry that shares nothing with the back ends. */
#ifndef THROWN_RIG_H
#define THROWN_RIG_H

#include "../rig/picture.h"

#define THROWN_SIDE 33 /* vertices each way of a mesh at most */
enum { THROWN_WIDE = 160, THROWN_HIGH = 120, THROWN_PIXELS = THROWN_WIDE * THROWN_HIGH };

/* A grid of vertices; its strip goes row by row. */
typedef struct thrown_mesh {
    c3d_vertex vertex[THROWN_SIDE * THROWN_SIDE];
    uint16_t index[(THROWN_SIDE - 1) * (2 * THROWN_SIDE + 2)];
    uint32_t side, vertices, indices;
} thrown_mesh;
/* Gives a mesh of side x side vertices, whose x, y, z and colours are set, its strip. */
void thrown_join(thrown_mesh *mesh, uint32_t side);

/* Texels as RGBA, one of them a word; kept as the format will keep them. */
typedef struct thrown_picture {
    enum c3d_texture_format format;
    int width, height;
    uint32_t *rgba; /* 0xAABBGGRR */
} thrown_picture;
/* Waves of all colours, opaque but for the outermost texels. free() what rgba points to. */
thrown_picture thrown_waves(enum c3d_texture_format format, int width, int height);
c3d_texture thrown_upload(c3d_device *device, const thrown_picture *picture);

/* A projector that looks level in a direction (brad16), with its horizon in the middle of the
 * picture; focal in texels. */
c3d_projector thrown_projector(const int64_t origin_wu[3], int32_t yaw, const thrown_picture *onto,
                               double focal);

/* What stands at a pixel of the frame. */
typedef struct thrown_pixel {
    int hit, unsure;          /* between opaque texels and others, which GL blends */
    double place_wu[3], z_wu; /* from the eye; along its axis */
    double rgb[3];            /* of the vertices' colours, or the draw's */
} thrown_pixel;
/* All pixels' first hits of a draw, THROWN_PIXELS of them. */
void thrown_hits(const c3d_frame *frame, const c3d_draw *draw, const thrown_mesh *mesh,
                 thrown_pixel *pixel);
/* Texture coordinates of a place in texels, 0 where nothing is thrown. */
int thrown_texel(const c3d_projector *projector, const thrown_picture *picture,
                 const double place_wu[3], double st[2]);
/* Throws a picture on hits: changes their colours. */
void thrown_paint(const c3d_projector *projector, const thrown_picture *picture,
                  thrown_pixel *pixel);
/* With the frame's fog; what was not hit has its clear colour. */
void thrown_rgb(const c3d_frame *frame, const thrown_pixel *pixel, uint8_t *rgb);

#endif
