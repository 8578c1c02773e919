/* What the two GL back ends share. They differ in the contexts they accept and in how a context
 * tells its version. */
#ifndef C3D_GL_LOCAL_H
#define C3D_GL_LOCAL_H

#include "c3d_gl_api.h"

typedef struct c3d_gl_state {
    c3d_gl_api gl;
    int buffers;
    uint32_t flags; /* enum c3d_draw_flags that GL is set to; UINT32_MAX: unknown */
    uint32_t array_buffer, element_buffer, texture; /* bound now */
    uint32_t font; /* texture of all glyphs, made with the first label; 0: not yet */
    uint32_t grid_columns, grid_first_q16[2], grid_last_q16[2], grid_count; /* of `grid` now */
    int fog;
    uint16_t width, height;
    c3d_rotation rotation;
    float projection[16], backdrop_projection[16];
    float grid[][2]; /* column and row of each vertex */
} c3d_gl_state;

/* "M.N" at `text` as 10*M + N, 0 when there is none. */
int c3d_gl_version(const char *text);

size_t c3d_gl_state_bytes(const c3d_desc *desc);
void c3d_gl_close(void *state);
void c3d_gl_mesh_form(c3d_vertex *vertices, uint32_t count);
uint32_t c3d_gl_mesh_upload(void *state, const c3d_vertex *vertices, uint32_t count);
uint32_t c3d_gl_strip_upload(void *state, const uint16_t *indices, uint32_t count);
void c3d_gl_buffer_free(void *state, uint32_t buffer);
uint32_t c3d_gl_texture_upload(void *state, enum c3d_texture_format format, uint32_t width,
                               uint32_t height, const void *pixels);
void c3d_gl_texture_free(void *state, uint32_t texture);
void c3d_gl_begin(void *state, const c3d_frame *frame, const c3d_rotation *rotation);
void c3d_gl_draw(void *state, const c3d_resolved_draw *resolved);
void c3d_gl_points(void *state, const c3d_resolved_draw *resolved);
void c3d_gl_label(void *state, const c3d_placed_label *label);
void c3d_gl_overlay(void *state, uint32_t texture, int x, int y, int width, int height);
void c3d_gl_end(void *state);
int c3d_gl_read_rows(void *state, uint32_t width, uint32_t first_row, uint32_t rows, uint8_t *rgba);

/* What the tables of both GL back ends have in common. */
#define C3D_GL_TABLE                                                                              \
    .state_bytes = c3d_gl_state_bytes, .mesh_form = c3d_gl_mesh_form, .close = c3d_gl_close,      \
    .mesh_upload = c3d_gl_mesh_upload, .strip_upload = c3d_gl_strip_upload,                       \
    .buffer_free = c3d_gl_buffer_free, .texture_upload = c3d_gl_texture_upload,                   \
    .texture_free = c3d_gl_texture_free, .begin = c3d_gl_begin, .draw = c3d_gl_draw,              \
    .points = c3d_gl_points, .label = c3d_gl_label, .overlay = c3d_gl_overlay, .end = c3d_gl_end, \
    .read_rows = c3d_gl_read_rows

/* Matrices, column by column, in metres (c3d_gl_matrix.c). */
void c3d_gl_projection(float matrix[16], const c3d_camera *camera);
void c3d_gl_backdrop_projection(float matrix[16], const c3d_camera *camera);
void c3d_gl_modelview(float matrix[16], const c3d_resolved_draw *resolved,
                      const c3d_rotation *rotation);
void c3d_gl_texture_matrix(float matrix[16], const c3d_draw *draw);
/* Of vertices to a thrown texture, q being c; and where the mesh lies. `plane` cuts off of it what
 * is behind the projector. */
enum c3d_gl_thrown { C3D_GL_BEHIND, C3D_GL_ACROSS, C3D_GL_BEFORE };
enum c3d_gl_thrown c3d_gl_throw_matrix(float matrix[16], double plane[4],
                                       const c3d_resolved_draw *resolved);
void c3d_gl_colour(float rgba[4], uint32_t colour);

#endif
