/* What a back end of the Common 3D API must offer: for authors of back ends; callers use c3d.h.
 *
 * c3d_device.c owns handles, pools, counters and all integer geometry; a back end owns what the
 * graphics library wants. A back end keeps its own state in state_bytes() of the device's
 * block, zeroed, and never allocates. Everything it is handed is checked already: handles resolved,
 * indices inside the mesh, pictures powers of two.
 */
#ifndef C3D_BACKEND_H
#define C3D_BACKEND_H

#include "c3d.h"
#include "c3d_assert.h"

/* Fraction bits of eye coordinates inside the device: rounding to whole wu would show as cracks a
 * pixel wide close to the eye. */
#define C3D_EYE_SHIFT 14

typedef struct c3d_mesh_data {
    uint32_t buffer; /* the back end's name of its copy; 0: none, use `vertices` */
    /* copy in the pool, see mesh_form; NULL when `buffer` has the vertices */
    const c3d_vertex *vertices;
    uint32_t count;
    uint32_t reach[3];         /* largest |x|, |y|, |z| */
    int32_t least[3], most[3]; /* x, y, z */
} c3d_mesh_data;

/* A strip's triangles and then its edges (pairs of indices, for lines), in one array or buffer.
 * Lines have edges alone: their count is 0. */
typedef struct c3d_strip_data {
    uint32_t buffer;
    const uint16_t *indices; /* the strip, then the edges; NULL when `buffer` has them */
    uint32_t count, edge_count;
    uint32_t triangles; /* not degenerate ones */
    uint16_t index_max;
} c3d_strip_data;

typedef struct c3d_resolved_draw {
    const c3d_draw *draw;
    const c3d_mesh_data *mesh;
    const c3d_strip_data *strip; /* NULL for points */
    uint32_t texture;            /* the back end's name; 0: untextured */
    /* origin of the mesh: x right, y up, z forward, wu with C3D_EYE_SHIFT fraction bits */
    int64_t eye_q14[3];
} c3d_resolved_draw;

/* A label that may be seen. */
typedef struct c3d_placed_label {
    const char *text; /* 1 .. C3D_LABEL_CHARS characters */
    int32_t x, y;     /* pixel at the top left of its first letter; may lie off the picture */
    int64_t z_q14;    /* eye depth, C3D_EYE_SHIFT fraction bits, already brought nearer */
    uint32_t colour;
} c3d_placed_label;

struct c3d_backend {
    const char *name;
    size_t (*state_bytes)(const c3d_desc *desc);
    /* The surface's context is current. *buffers says whether vertex buffers are wanted, and
     * receives whether they will be used. FF_OK or FF_ERR_UNSUPPORTED. */
    int (*open)(void *state, const c3d_desc *desc, int *buffers);
    void (*close)(void *state);
    /* Turns a copy of a mesh, in place, into what the library reads; NULL: it reads c3d_vertex. */
    void (*mesh_form)(c3d_vertex *vertices, uint32_t count);
    /* Copies data into a buffer object and returns its name, 0 when the library has no room. Called
     * only when vertex buffers are in use; NULL when this back end never has any. */
    uint32_t (*mesh_upload)(void *state, const c3d_vertex *vertices, uint32_t count);
    uint32_t (*strip_upload)(void *state, const uint16_t *indices, uint32_t count);
    void (*buffer_free)(void *state, uint32_t buffer);
    uint32_t (*texture_upload)(void *state, enum c3d_texture_format format, uint32_t width,
                               uint32_t height, const void *pixels);
    void (*texture_free)(void *state, uint32_t texture);
    void (*begin)(void *state, const c3d_frame *frame, const c3d_rotation *rotation);
    void (*draw)(void *state, const c3d_resolved_draw *resolved);
    /* Flags: COLOURED, ON_TOP or neither. */
    void (*points)(void *state, const c3d_resolved_draw *resolved);
    void (*label)(void *state, const c3d_placed_label *label);
    /* Draws what the back end kept for later, before a strip that may belong to it goes away. NULL:
     * it keeps nothing. */
    void (*flush)(void *state);
    void (*overlay)(void *state, uint32_t texture, int x, int y, int width, int height);
    void (*end)(void *state);
    /* Rows first_row .. first_row + rows - 1 from the bottom as RGBA8888, bottom row first. */
    int (*read_rows)(void *state, uint32_t width, uint32_t first_row, uint32_t rows, uint8_t *rgba);
    /* see c3d_frame_pixels; or NULL */
    const void *(*pixels)(void *state, enum c3d_texture_format *format);
    /* see c3d_read_depth; NULL: it cannot say */
    void (*read_depth)(void *state, int32_t *depth_wu);
};

/* c3d_to_eye with C3D_EYE_SHIFT fraction bits. */
void c3d_to_eye_q14(const c3d_rotation *rotation, const int64_t offset_wu[3], int64_t eye_q14[3]);

/* The edges of a strip's triangles as pairs of indices, each triangle's new edges once; degenerate
 * triangles give none. `edges` holds at least 4 * count; the number written is returned, *triangles
 * counts those not degenerate. */
uint32_t c3d_strip_edges(const uint16_t *indices, uint32_t count, uint16_t *edges,
                         uint32_t *triangles);

#endif
