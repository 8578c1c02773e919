/* Inside common3d/soft only. */
#ifndef SOFT_LOCAL_H
#define SOFT_LOCAL_H

#include "c3d_soft.h"

#define SOFT_SUB           4 /* fraction bits of screen coordinates */
#define SOFT_ONE           (1 << SOFT_SUB)
#define SOFT_HALF          (SOFT_ONE / 2)
#define SOFT_GUARD_Q4      65536 /* screen coordinates stay this close to the principal point */
#define SOFT_GUARD_CLIP_PX 4000  /* and are clipped here */
#define SOFT_EDGE_TABLE    513 /* heights of edges, Q4, with a reciprocal at hand: up to 32 pixels */
#define SOFT_TINY_TEXELS   64  /* each way: what soft_tiny multiplies stays below 2^28 */
#define SOFT_HEAP_UNIT     256

FF_STATIC_ASSERT(SOFT_EDGE_TABLE == 32 * SOFT_ONE + 1);
FF_STATIC_ASSERT(SOFT_GUARD_CLIP_PX *SOFT_ONE < SOFT_GUARD_Q4);
/* differences of two coordinates stay below 2^17 */
FF_STATIC_ASSERT(2 * SOFT_GUARD_Q4 <= 1 << 17);

/* Where a vertex lies: beside the screen (by pixel centres), or where the clipper must act. */
enum {
    SOFT_LEFT = 1,
    SOFT_RIGHT = 2,
    SOFT_ABOVE = 4,
    SOFT_BELOW = 8,
    SOFT_NEAR = 16,
    SOFT_FAR = 32,
    SOFT_GUARD = 64
};
#define SOFT_MUST_CLIP (SOFT_NEAR | SOFT_FAR | SOFT_GUARD)

typedef struct soft_vertex {
    int32_t x, y;     /* pixels, Q4; undefined where `out` says near */
    uint32_t w;       /* near/z, Q30; below 2^30 */
    int32_t s, t;     /* texels less one half, Q16; below 2^28 */
    int32_t c;        /* of a projector, below 2^30; undefined where `off` says so */
    int16_t fog_q8;   /* 256: clear, 0: all fog; may go on beyond both, within +-2^14 */
    uint8_t out, off; /* SOFT_LEFT ..; under a projector: SOFT_OFF_LEFT .. */
    uint8_t rgba[4];
} soft_vertex;
FF_STATIC_ASSERT(sizeof(soft_vertex) == 32);

/* Where a vertex lies beside a thrown picture: beyond its opaque texels, behind the projector, or
 * so far off that s and t cannot tell. */
enum {
    SOFT_OFF_LEFT = 1,
    SOFT_OFF_RIGHT = 2,
    SOFT_OFF_ABOVE = 4,
    SOFT_OFF_BELOW = 8,
    SOFT_OFF_BEHIND = 16,
    SOFT_OFF_FAR = 32
};
#define SOFT_OFF_SIDES (SOFT_OFF_FAR - 1)
#define SOFT_MUST_CUT  (SOFT_OFF_BEHIND | SOFT_OFF_FAR)
#define SOFT_THROWN_C  (1 << 16) /* c of what is not yet behind */

typedef struct soft_texture {
    uint8_t *texels;                /* from texel (-1, -1) on, which is in the rim */
    uint32_t first_unit, units;     /* of the heap; units 0: the slot is free */
    uint16_t width, height, stride; /* stride: width + 2 */
    uint8_t format, width_log2, height_log2;
} soft_texture;

/* Which pixels a draw takes: those where it is nearest, those nothing has covered, all. */
enum soft_depth { SOFT_DEPTH_TEST, SOFT_DEPTH_UNCOVERED, SOFT_DEPTH_NONE };
typedef struct soft_paint {
    const soft_texture *texture; /* NULL: untextured */
    enum soft_depth depth;
    uint8_t coloured; /* vertices differ in colour */
    uint8_t white;    /* all vertices are white: the texture is drawn as it is */
    uint8_t alpha_test, fog, on_top;
    uint8_t thrown;   /* the texture stands in place of the colours, where it is opaque */
    uint8_t through;  /* of that, 256ths of what is below it */
    uint8_t unmarked; /* the last backdrop marks no depths: nothing after it asks for them */
} soft_paint;

/* Attributes of a pixel, Q16: s, t, red, green, blue, fog (256: clear). */
enum { SOFT_S, SOFT_T, SOFT_R, SOFT_G, SOFT_B, SOFT_F, SOFT_ATTRIBUTES };

/* Pixels of a row over which everything changes linearly. */
typedef struct soft_segment {
    uint32_t first, count; /* of the frame's pixels */
    uint32_t w, dw;        /* wraps */
    int w_shift;           /* under a thrown texture w is shifted up by this */
    int32_t value[SOFT_ATTRIBUTES], step[SOFT_ATTRIBUTES];
} soft_segment;

/* From vertices to eye space, for one draw. World units: 2^shift to a wu; eye units are two of
 * them. */
typedef struct soft_space {
    int shift;
    uint8_t near;             /* 1: places fit 32 bits, and origin[] and scale are valid */
    int32_t origin[3], scale; /* world units */
    int64_t origin_wu[3];
    int32_t scale_wu;
    uint32_t z_scale_q16; /* wu */
    int32_t near_eye, far_eye;
    uint32_t near_norm; /* the near plane's distance in wu, shifted up until bit 31 is set */
    int near_shift;     /* near_norm times 1/z, shifted right by this, is near/z in Q30 */
} soft_space;

/* From vertices to a thrown picture, for one draw: a, b and c. */
typedef struct soft_throw {
    int32_t row_q24[3][3];
    int64_t from_wu[3]; /* the mesh's origin, from the projector's point */
    int32_t scale_wu;
    uint32_t z_scale_q16;
    int shift;                /* wu to units in which offsets have 30 bits */
    int sum_shift;            /* brings sums down to 30 bits */
    uint8_t near;             /* 1: places fit 32 bits, and origin[] and scale are valid */
    int32_t origin[3], scale; /* in those units */
} soft_throw;

/* From eye space to the screen, for one frame. */
typedef struct soft_view {
    /* right and up times the focal distance, forward times 2: Q30, see soft_transform.c */
    int32_t row[3][3];
    int focal_shift;            /* right and up are multiplied with focal_q8 << focal_shift, Q30 */
    int32_t centre[2];          /* twice the principal point, Q4 */
    int32_t guard_from[2];      /* the least x and y that need no clipping, Q4 */
    int32_t right_q4, below_q4; /* centres of the last column and row of pixels */
} soft_view;

typedef struct soft_deferred {
    c3d_draw draw;
    c3d_resolved_draw resolved;
    c3d_mesh_data mesh;
} soft_deferred;

/* Part of a row: pixels from .. to - 1. */
typedef struct soft_part {
    uint16_t from, to;
} soft_part;

typedef struct soft_state soft_state;
struct soft_state {
    /* memory, in the block */
    uint8_t *colour; /* 2 or 4 bytes a pixel, top row first */
    uint32_t *depth;
    soft_vertex *vertices; /* of the mesh transformed last */
    soft_texture *textures;
    /* while backdrops fill: the open pixels of each row, which nothing has covered, lie within
     * open_from .. open_to - 1 */
    uint16_t *open_from, *open_to;
    /* of each row, a run of pixels that something other than a backdrop covers */
    soft_part *covered;
    uint8_t *heap, *heap_used; /* texels, in units; for each unit 1 when it is in use */
    uint32_t heap_units, pixels_max;
    uint16_t texture_count;
    uint8_t wide; /* 1: RGBA8888, 0: RGB565 */

    uint32_t reciprocal[512]; /* 2^61/n for n around 2^30 + i * 2^21, see soft_reciprocal */
    int32_t edge_reciprocal[SOFT_EDGE_TABLE]; /* floor((2^31 - 1) / n) */

    /* the frame */
    uint16_t width, height;
    uint8_t blank;   /* the viewport is larger than the memory: nothing is drawn */
    uint8_t painted; /* something other than deferred backdrops was drawn */
    /* no depth was marked in rows above this one; what paints a triangle keeps that true */
    int32_t top_row;
    int32_t open_end;  /* while backdrops fill: no pixel is open from this row on */
    int32_t open_rows; /* while backdrops fill: nothing covers the rows above this one */
    c3d_frame frame;
    soft_view view;
    int frame_shift; /* soft_space.shift of ordinary draws */

    /* the draw */
    soft_paint paint;
    soft_segment segment; /* of the row being drawn */
    /* draws a segment with this paint, where there is no fog */
    void (*span)(struct soft_state *state, const soft_segment *segment);
    soft_space space;
    c3d_draw cached; /* the draw whose vertices are in `vertices` */
    const c3d_vertex *cached_mesh;
    c3d_projector projector; /* of a thrown texture */
    soft_throw throw;
    uint8_t off_texture;  /* 1: some vertex lies beyond the texture's edges */
    uint8_t tiny_rows;    /* 1: texture_rows, and the texture is small enough for soft_tiny */
    uint8_t tiny_colours; /* 1: nothing but colours, into RGB565, depth tested, no fog */
    uint8_t texture_rows; /* 1: nothing but a texture, never off it, into RGB565, depth tested */
    uint32_t deferred_count;
    soft_deferred deferred[C3D_SOFT_BACKDROPS];
    uint32_t deferred_vertices;
    c3d_vertex deferred_vertex[C3D_SOFT_BACKDROP_VERTICES];
};

/* 2^61 / n for n in 2^30 .. 2^31 - 1, within 2^-19 of its value. */
static inline uint32_t soft_reciprocal(const soft_state *state, uint32_t n)
{
    C3D_ASSERT(n >> 30 == 1);
    uint32_t r = state->reciprocal[(n >> 21) & 511];
    uint32_t error = (uint32_t)(((uint64_t)n * r) >> 32); /* 2^29 when exact */
    return (uint32_t)(((uint64_t)r * ((UINT32_C(1) << 30) - error)) >> 29);
}

/* The same within 2^-29 of its value. */
static inline uint32_t soft_fine_reciprocal(const soft_state *state, uint32_t n)
{
    uint32_t r = soft_reciprocal(state, n);
    uint32_t error = (uint32_t)(((uint64_t)n * r) >> 32);
    return (uint32_t)(((uint64_t)r * ((UINT32_C(1) << 30) - error)) >> 29);
}

/* For inner loops, which are worth their size. */
#if defined(__GNUC__)
#define SOFT_INLINE inline __attribute__((always_inline))
#else
#define SOFT_INLINE inline
#endif

static inline int soft_leading_zeros(uint32_t n)
{
    C3D_ASSERT(n > 0);
#if defined(__GNUC__)
    return __builtin_clz(n);
#else
    int count = 0;
    while (!(n & 0x80000000u)) n <<= 1, count++;
    return count;
#endif
}

static inline int soft_log2(uint64_t n)
{
    C3D_ASSERT(n > 0);
    return n >> 32 ? 63 - soft_leading_zeros((uint32_t)(n >> 32))
                   : 31 - soft_leading_zeros((uint32_t)n);
}

/* The upper word of the product: one instruction. */
static inline int32_t soft_high(int32_t a, int32_t b) { return (int32_t)(((int64_t)a * b) >> 32); }

static inline int64_t soft_scale64(int64_t value, int shift) /* times 2^shift */
{
    C3D_ASSERT(shift > -64 && shift < 63);
    C3D_ASSERT(shift < 0 || (value <= INT64_MAX >> shift && value >= -(INT64_MAX >> shift)));
    return shift >= 0 ? value * ((int64_t)1 << shift) : value >> -shift;
}

/* Of every segment that is painted: at least a pixel, all of them the frame's. */
static inline int soft_in_frame(const soft_state *state, uint32_t first, uint32_t count)
{
    uint32_t pixels = (uint32_t)state->width * state->height;
    return count > 0 && count <= pixels && first <= pixels - count;
}

/* soft_texture.c */
uint32_t soft_texture_upload(void *state, enum c3d_texture_format format, uint32_t width,
                             uint32_t height, const void *pixels);
void soft_texture_free(void *state, uint32_t texture);
/* Bilinear, all four channels 0..255. s, t as in soft_vertex, any value. */
void soft_sample(const soft_texture *texture, int32_t s, int32_t t, int32_t rgba[4]);

/* soft_transform.c */
/* Prepares a frame, whose width and height are known. */
void soft_begin_view(soft_state *state, const c3d_rotation *rotation);
/* Transforms a draw's vertices into state->vertices. */
void soft_transform(soft_state *state, const c3d_resolved_draw *resolved);
/* Eye space of a vertex of the mesh transformed last; and, for a place in eye space, the x, y, w
 * and `out` of a vertex. */
void soft_eye(const soft_state *state, const soft_vertex *vertex, int32_t eye[3]);
void soft_project(const soft_state *state, const int32_t eye[3], soft_vertex *vertex);

/* soft_thrown.c: s, t, c and `off` of the vertices transformed last, under a projector. */
void soft_transform_thrown(soft_state *state, const c3d_draw *draw, const c3d_mesh_data *mesh);
/* a, b and c of one of them, below 2^30; and what a corner of a part gets that has them. Where
 * parts of triangles end, rounding puts no corner behind the projector or too far off. */
void soft_thrown_sums(const soft_state *state, const soft_vertex *vertex, int32_t sum[3]);
void soft_throw_vertex(const soft_state *state, const int32_t sum[3], soft_vertex *vertex);

/* soft_thrown_strip.c: draws a strip under a projector; and a triangle that needs no clipping. */
void soft_thrown_strip(soft_state *state, const uint16_t *indices, uint32_t count);
void soft_thrown_triangle(soft_state *state, const soft_vertex *a, const soft_vertex *b,
                          const soft_vertex *c);
/* soft_thrown_tiny.c: draws one of a few rows on the texture, whose s and t may be interpolated
 * linearly, or returns 0; a.y <= b.y <= c.y. */
int soft_thrown_tiny(soft_state *state, const soft_vertex *a, const soft_vertex *b,
                     const soft_vertex *c);
/* soft_thrown_rows.c: draws any such triangle; a.y <= b.y <= c.y. */
void soft_thrown_rows(soft_state *state, const soft_vertex *a, const soft_vertex *b,
                      const soft_vertex *c, int64_t area);
void soft_span_thrown(soft_state *state, const soft_segment *segment); /* RGBA5551, into RGB565 */
/* How much nearer than they are a segment's pixels count as that are thrown over others, which
 * other ways have drawn: those round depths in theirs. */
static inline uint32_t soft_thrown_bias(uint32_t w, int32_t dw)
{
    return (w >> 10) + (uint32_t)(dw < 0 ? -dw : dw) / 4 + 64;
}

/* soft_clip.c, for vertices of the mesh transformed last: cuts a triangle at the planes and draws
 * the rest. */
void soft_clip(soft_state *state, const soft_vertex *a, const soft_vertex *b, const soft_vertex *c);
/* The same, at the edges of the thrown picture, too. */
void soft_clip_thrown(soft_state *state, const soft_vertex *a, const soft_vertex *b,
                      const soft_vertex *c);
/* Cuts a line at the planes; 0 when nothing is left of it. */
int soft_clip_line(const soft_state *state, const soft_vertex *a, const soft_vertex *b,
                   soft_vertex cut[2]);

/* soft_triangle.c */
void soft_strip(soft_state *state, const uint16_t *indices, uint32_t count);
/* Draws a triangle that needs no clipping. */
void soft_triangle(soft_state *state, const soft_vertex *a, const soft_vertex *b,
                   const soft_vertex *c);
/* soft_perspective.c: draws any triangle; a.y <= b.y <= c.y, `area` is twice its area in Q8. */
void soft_perspective(soft_state *state, const soft_vertex *a, const soft_vertex *b,
                      const soft_vertex *c, int64_t area);

/* soft_small.c: draws a triangle that is small and flat enough, or returns 0. a.y <= b.y <= c.y. */
int soft_small(soft_state *state, const soft_vertex *a, const soft_vertex *b, const soft_vertex *c);

/* soft_tiny.c: draws a triangle of a few rows, or returns 0; only where state->tiny_rows. Corners
 * in any order. */
int soft_tiny(soft_state *state, const soft_vertex *a, const soft_vertex *b, const soft_vertex *c);

/* soft_tiny_colours.c: the same in colours; only where state->tiny_colours. */
int soft_tiny_colours(soft_state *state, const soft_vertex *a, const soft_vertex *b,
                      const soft_vertex *c);

/* soft_spans.c: sets state->span for the paint; after soft_transform. */
void soft_choose_span(soft_state *state);

/* soft_backdrop.c: sets open_from and open_to of all rows; then the spans that fill open pixels,
 * into RGB565. */
void soft_find_open_parts(soft_state *state);
void soft_span_backdrop(soft_state *state, const soft_segment *segment); /* colours: the sky */
/* RGBA5551 with the alpha test: a panorama */
void soft_span_holes(soft_state *state, const soft_segment *segment);

/* soft_line.c */
void soft_lines(soft_state *state, const uint16_t *indices, uint32_t count);

/* soft_point.c: the first `count` vertices transformed last. */
void soft_points(soft_state *state, uint32_t count, int32_t size_px);

/* soft_label.c; soft_label_none.c where labels are left out */
void soft_label(void *state, const c3d_placed_label *label);

/* soft_pixels.c: draws a segment with any paint, into any format. */
void soft_segment_paint(soft_state *state, const soft_segment *segment);
/* Blends four texels of RGBA5551, `texel` being the upper left one, x and y in 1/32 texel: RGB565,
 * or SOFT_CLEAR. */
#define SOFT_CLEAR 0x10000u
uint32_t soft_blend_5551(const uint16_t *texel, uint32_t stride, uint32_t x, uint32_t y);
void soft_put(soft_state *state, uint32_t at, int32_t red, int32_t green, int32_t blue);
void soft_get(const soft_state *state, uint32_t at, uint8_t rgb[3]);

#endif
