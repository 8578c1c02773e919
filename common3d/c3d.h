/* Common 3D API: what the terrain needs of a renderer, in integers (Hybrid, section 4.2).
 *
 * Conventions
 *   World: x east, y north, z up, in wu (1/256 m).
 *   Eye: x right, y up, z forward (towards the scene).
 *   Camera angles: yaw 0 looks north and grows clockwise (east is 16384); pitch grows upwards; roll
 *       grows clockwise as the viewer sees the device turn, so the picture turns the other way.
 *   Screen: pixel (0,0) is top left, its centre at (0.5, 0.5); the principal point is (width/2,
 *       height/2).
 *   Projection: x_px = width/2 + x_eye*d/z_eye, y_px = height/2 - y_eye*d/z_eye, with d the focal
 *       distance in pixels (Hybrid, equation 1).
 *   Faces: front faces are counter-clockwise seen from outside. Back faces are drawn too.
 *   Colours: 0xAABBGGRR words, that is bytes r, g, b, a in memory.
 *   Mesh origins: relative to the camera. The caller subtracts in 64-bit integers, so that nothing
 *       jitters far from the world's origin.
 *   Handles: slot and generation in 32 bits; 0 is never valid. Using a stale or zero handle draws
 *       nothing and is counted. Whatever has a handle may be made and freed at any time, between
 *       frames or within one: a draw takes what it needs before it returns.
 * Back ends stand behind one table (c3d_backend.h): common3d/gl (desktop GL 1.5), common3d/gles1
 * (GL ES 1.1), common3d/soft (integers, no GL). All memory of a device comes from the block given
 * to c3d_open.
 */
#ifndef C3D_H
#define C3D_H

#include "../platform/sys.h"
#include "c3d_fixed.h"

typedef struct c3d_camera {
    int32_t pos_wu[3];
    int32_t yaw, pitch, roll; /* brad16 */
    int32_t focal_q8;         /* d in pixels, Q8; at least 256 */
    uint16_t width, height;   /* viewport in pixels, 1..4096 */
    int32_t near_wu, far_wu;  /* 0 < near < far */
} c3d_camera;

/* Rows: right, up, forward; orthonormal, Q30. */
typedef struct c3d_rotation {
    int32_t m[3][3];
} c3d_rotation;
void c3d_rotation_from_camera(const c3d_camera *camera, c3d_rotation *rotation);
/* Focal distance for a full horizontal field of view in brad16 (0.1 to 170 degrees) over width
 * pixels. */
int32_t c3d_focal_q8(int32_t fov_brad16, int32_t width_px);
/* World offset from the camera (|each| < 2^33 wu) to eye space, wu. */
void c3d_to_eye(const c3d_rotation *rotation, const int64_t offset_wu[3], int64_t eye_wu[3]);

/* x, y and z count the draw's units (its scales) from its origin. Along no axis may a vertex lie
 * 2^33 wu from the camera. 16 bytes. */
typedef struct c3d_vertex {
    int32_t x, y, z;
    uint8_t rgba[4];
} c3d_vertex;

typedef struct {
    uint32_t id;
} c3d_mesh;
typedef struct {
    uint32_t id;
} c3d_strip; /* 16-bit indices: one triangle strip with its edges, or lines */
typedef struct {
    uint32_t id;
} c3d_texture;
typedef struct {
    uint32_t id;
} c3d_label; /* one line of text */

/* 16-bit formats have red in the highest bits; C3D_RGBA5551 alpha in the lowest. */
enum c3d_texture_format { C3D_RGB565, C3D_RGBA5551, C3D_RGBA8888 };

enum c3d_draw_flags {
    C3D_DRAW_TEXTURED = 1,    /* texture times vertex colour */
    C3D_DRAW_COLOURED = 2,    /* use vertex colours, else `colour` */
    C3D_DRAW_WIREFRAME = 4,   /* the strip's edges, or its lines: a pixel wide, no texture */
    C3D_DRAW_BACKDROP = 8,    /* the sky, a panorama: no depth test, no depth written, no fog */
    C3D_DRAW_ALPHA_TEST = 16, /* texels with alpha below one half are not drawn */
    /* tests depth with a bias towards the viewer of 1/64 of the distance: wireframe over ground */
    C3D_DRAW_ON_TOP = 32,
    /* `texture` is thrown on the mesh by `projector`, not modulated: where it has an opaque texel
     * that stands in place of the vertex colour, elsewhere the vertex colour stays. With ALPHA_TEST
     * nothing is drawn elsewhere: several projectors are drawn one after the other, the first
     * without; equal depths pass. Fog comes over it as over the rest. Without TEXTURED; wireframes
     * and backdrops have no pictures thrown on them. */
    C3D_DRAW_PROJECTED = 64
};

/* A picture thrown from one point on whatever stands before it (projective texturing): a place
 * whose offset from that point is (x, y, z) has the texture coordinates s = a/c, t = b/c, where a,
 * b, c are the rows times the offset; 0..1 over the texture, t = 0 its first row. Nothing is thrown
 * where c <= 0, nor beyond the texture. */
typedef struct c3d_projector {
    int64_t origin_wu[3]; /* the point, relative to the camera */
    int32_t row_q24[3][3];
} c3d_projector;

typedef struct c3d_draw {
    c3d_mesh mesh;
    c3d_strip strip;
    int64_t origin_wu[3]; /* of vertex (0,0,0), relative to the camera */
    int32_t xy_scale_wu;  /* wu per vertex unit in x and y */
    uint32_t z_scale_q16; /* wu per vertex unit in z, Q16 */
    uint32_t flags;       /* enum c3d_draw_flags */
    uint32_t colour;      /* 0xAABBGGRR, when not C3D_DRAW_COLOURED */
    /* A projected one has alpha, and is transparent in its outermost rows and columns: those are
     * repeated without end. */
    c3d_texture texture;
    /* A texture lies on the grid of the mesh, not on its places: vertex i is in column
     * i % tex_columns and row i / tex_columns. s = column * scale + offset in texture widths, t
     * likewise by row; t = 0 is the texture's first row. TEXTURED alone needs them. */
    int32_t tex_scale_q16[2], tex_offset_q16[2];
    /* columns and rows before the first and beyond the last of these places have their s and t:
     * vertices moved there, or of no triangle drawn; last 0: none are beyond */
    uint32_t tex_first_q16[2], tex_last_q16[2];
    uint16_t tex_columns; /* at least 1 */
    uint8_t point_px;     /* c3d_draw_points alone: edge of a point, 1..64 pixels */
    /* C3D_DRAW_PROJECTED with ALPHA_TEST alone: so many 256ths of what is drawn there already show
     * through what is thrown, a share of 32ths in RGB565; 0: none */
    uint8_t through;
    const c3d_projector *projector; /* C3D_DRAW_PROJECTED alone; read before the draw returns */
} c3d_draw;

/* A label's text stands upright on the screen, whatever the camera does, 7 pixels high and 6 pixels
 * a character. Its last row of pixels is the row of the point it names; its middle is above the
 * point. */
typedef struct c3d_label_draw {
    c3d_label label;
    int64_t origin_wu[3];      /* of the point, relative to the camera */
    uint32_t colour;           /* 0xAABBGGRR */
    int16_t right_px, down_px; /* moves the text on the screen, not its depth */
} c3d_label_draw;

typedef struct c3d_frame {
    c3d_camera camera;
    uint32_t clear_colour;
    int32_t fog_start_wu, fog_end_wu; /* linear, by eye depth; end 0: no fog */
    uint32_t fog_colour;
} c3d_frame;

typedef struct c3d_desc {
    const sys_surface_api *surface_api; /* the context is current when c3d_open is called */
    uint16_t mesh_count, strip_count, texture_count; /* pool sizes */
    uint16_t label_count;                            /* 32 bytes each */
    uint16_t mesh_vertices_max;                      /* of one mesh */
    uint32_t strip_indices_max; /* of all strips together; see c3d_lines_make */
    /* 1: vertex buffers when the GL has them; 0: plain arrays */
    uint8_t use_vertex_buffers;
    /* For back ends that hold the picture themselves (soft); the others leave these alone. */
    uint8_t frame_format; /* C3D_RGB565 (0, default) or C3D_RGBA8888 */
    /* largest viewport, default 240x320; in a larger one nothing is drawn */
    uint16_t width, height;
    /* of all textures together. A texture takes a rim of one texel besides, and 4 bytes a texel
     * (RGBA5551: 2); default 32 KB for each texture */
    uint32_t texture_bytes;
} c3d_desc;

/* Counters since c3d_open, and of the frame being drawn (or last drawn). */
typedef struct c3d_stats {
    /* frame_triangles counts neither degenerate triangles nor those of wireframes */
    uint32_t frame_triangles, frame_draws;
    /* uses of stale or zero handles, and strips that reach beyond their mesh */
    uint32_t stale_handles;
    /* of the pools: in use, and the most at once */
    uint32_t mesh_held, strip_held, texture_held;
    uint32_t mesh_high, strip_high, texture_high, label_high;
    uint32_t strip_indices_high; /* of strip_indices_max, gaps between strips counted */
    uint8_t vertex_buffers_used;
} c3d_stats;

typedef struct c3d_device c3d_device;
struct c3d_backend;
const struct c3d_backend *c3d_backend_gl(void);
const struct c3d_backend *c3d_backend_gles1(void);
/* integers only, no GL: common3d/soft/c3d_soft.h */
const struct c3d_backend *c3d_backend_soft(void);

/* Bytes of the block. With vertex buffers the GL holds meshes and strips; without, the block holds
 * copies of them. */
size_t c3d_bytes(const struct c3d_backend *backend, const c3d_desc *desc);
/* FF_OK, FF_ERR_MEMORY, FF_ERR_UNSUPPORTED (the context is of another kind, or a GL function is
 * missing). When vertex buffers are wanted but the GL has none, plain arrays take their place if
 * the block has room for the copies; if not, the answer is FF_ERR_MEMORY. The block must outlive
 * the device, and the device's context must be current in every call. */
int c3d_open(const struct c3d_backend *backend, const c3d_desc *desc, void *memory, size_t bytes,
             c3d_device **device);
void c3d_close(c3d_device *device);

/* A handle, or id 0 when the pool is full: no error, the caller draws a coarser picture. Data is
 * copied. */
c3d_mesh c3d_mesh_make(c3d_device *device, const c3d_vertex *vertices, uint32_t count);
void c3d_mesh_free(c3d_device *device, c3d_mesh mesh);
/* A triangle strip of at least 3 indices. */
c3d_strip c3d_strip_make(c3d_device *device, const uint16_t *indices, uint32_t count);
/* Lines between pairs of vertices: an even number of indices. Five take the room of one index of a
 * triangle strip. C3D_DRAW_WIREFRAME draws them; without it they draw nothing. */
c3d_strip c3d_lines_make(c3d_device *device, const uint16_t *indices, uint32_t count);
void c3d_strip_free(c3d_device *device, c3d_strip strip);
/* Pixels tightly packed, row 0 first = south / bottom (t = 0). Width and height powers of two.
 * Bilinear, clamped to edge. */
c3d_texture c3d_texture_make(c3d_device *device, enum c3d_texture_format format, uint32_t width,
                             uint32_t height, const void *pixels);
void c3d_texture_free(c3d_device *device, c3d_texture texture);
/* At most C3D_LABEL_CHARS characters of `text` are kept; id 0 for none. Letters as in c3d_text.h,
 * no line breaks. */
#define C3D_LABEL_CHARS 23
c3d_label c3d_label_make(c3d_device *device, const char *text);
void c3d_label_free(c3d_device *device, c3d_label label);

void c3d_begin(c3d_device *device, const c3d_frame *frame);
void c3d_draw_strip(c3d_device *device, const c3d_draw *draw);
/* Draws each vertex of the mesh whose place lies in the picture as a square of draw->point_px
 * pixels round that place, at the vertex's depth. Strip and texture are ignored, and all flags but
 * COLOURED and ON_TOP. */
void c3d_draw_points(c3d_device *device, const c3d_draw *draw);
/* Draws a label. It is hidden by what is more than 1/64 nearer than its point (as C3D_DRAW_ON_TOP),
 * and never in fog. A point nearer than the near plane or beyond the far plane has no label. */
void c3d_draw_label(c3d_device *device, const c3d_label_draw *draw);
/* Draws an RGBA8888 image (top row first, sides powers of two) over the picture, with its top left
 * corner at (x, y) pixels: the HUD. */
void c3d_overlay(c3d_device *device, c3d_texture texture, int x, int y, int width, int height);
void c3d_end(c3d_device *device);
/* The finished frame as RGB888, top row first, width*height*3 bytes; before present(). */
int c3d_read_rgb(c3d_device *device, uint8_t *rgb);
/* The finished frame in the back end's own memory, top row first, rows packed (RGBA8888: bytes r,
 * g, b, a); NULL when a GL holds it. Valid until the next c3d_begin. */
const void *c3d_frame_pixels(c3d_device *device, enum c3d_texture_format *format);
/* How far from the eye, along its axis, the finished frame's pixels are: width*height values, wu,
 * top row first; INT32_MAX where nothing was drawn. FF_ERR_UNSUPPORTED: the back end cannot say
 * (only soft can). */
int c3d_read_depth(c3d_device *device, int32_t *depth_wu);
void c3d_get_stats(const c3d_device *device, c3d_stats *stats);

#endif
