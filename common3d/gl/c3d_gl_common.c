/* Fixed-function drawing shared by both GL back ends. */
#include "c3d_gl_local.h"
#include "../c3d_font.h"
#include "../c3d_text.h"

#include <string.h>

#define ALPHA_LEAST 0.5f /* of texels that the alpha test lets be drawn */

static const void *offset_pointer(const void *base, size_t offset)
{
    return (const void *)((uintptr_t)base + offset);
}

static void bind_array(c3d_gl_state *state, uint32_t buffer)
{
    if (!state->buffers || state->array_buffer == buffer) return;
    state->gl.BindBuffer(GL_ARRAY_BUFFER, buffer);
    state->array_buffer = buffer;
}

static void bind_elements(c3d_gl_state *state, uint32_t buffer)
{
    if (!state->buffers || state->element_buffer == buffer) return;
    state->gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffer);
    state->element_buffer = buffer;
}

static void bind_texture(c3d_gl_state *state, uint32_t texture)
{
    if (state->texture == texture) return;
    state->gl.BindTexture(GL_TEXTURE_2D, texture);
    state->texture = texture;
}

static void enable(c3d_gl_state *state, unsigned capability, int on)
{
    if (on)
        state->gl.Enable(capability);
    else
        state->gl.Disable(capability);
}

static void enable_array(c3d_gl_state *state, unsigned array, int on)
{
    if (on)
        state->gl.EnableClientState(array);
    else
        state->gl.DisableClientState(array);
}

int c3d_gl_version(const char *text)
{
    if (text[0] < '0' || text[0] > '9' || text[1] != '.' || text[2] < '0' || text[2] > '9')
        return 0;
    return (text[0] - '0') * 10 + text[2] - '0';
}

/* Sets everything a frame relies on, because another device may share this context and may have
 * drawn in it. */
static void set_up(c3d_gl_state *state)
{
    c3d_gl_api *gl = &state->gl;
    if (gl->BindBuffer) {
        gl->BindBuffer(GL_ARRAY_BUFFER, 0);
        gl->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, 0);
    }
    state->array_buffer = state->element_buffer = 0;
    state->texture = UINT32_MAX;
    state->flags = UINT32_MAX;
    gl->Disable(GL_DITHER);
    gl->Disable(GL_CULL_FACE);
    gl->Disable(GL_LIGHTING);
    gl->DepthFunc(GL_LEQUAL);
    gl->AlphaFunc(GL_GEQUAL, ALPHA_LEAST);
    gl->BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    gl->Fogf(GL_FOG_MODE, (float)GL_LINEAR);
    gl->TexEnvf(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, (float)GL_MODULATE);
    gl->EnableClientState(GL_VERTEX_ARRAY);
}

size_t c3d_gl_state_bytes(const c3d_desc *desc)
{
    return sizeof(c3d_gl_state) + desc->mesh_vertices_max * sizeof(float[2]);
}

void c3d_gl_close(void *opaque)
{
    c3d_gl_state *state = opaque;
    if (state->font) c3d_gl_texture_free(state, state->font);
    state->gl.Finish();
}

/* ---- what the library holds ---- */

static uint32_t upload(c3d_gl_state *state, unsigned target, const void *data, size_t bytes)
{
    uint32_t buffer = 0;
    while (state->gl.GetError()) {
    }
    state->gl.GenBuffers(1, &buffer);
    if (target == GL_ARRAY_BUFFER)
        bind_array(state, buffer);
    else
        bind_elements(state, buffer);
    state->gl.BufferData(target, (ptrdiff_t)bytes, data, GL_STATIC_DRAW);
    if (state->gl.GetError()) { /* out of memory */
        c3d_gl_buffer_free(state, buffer);
        return 0;
    }
    return buffer;
}

/* ES knows no 32-bit integers, and not every library divides GL_FIXED by 65536 (Mesa's llvmpipe:
 * by 65535): x, y and z become floats where they lie. */
void c3d_gl_mesh_form(c3d_vertex *vertices, uint32_t count)
{
    for (c3d_vertex *vertex = vertices; vertex < vertices + count; vertex++) {
        const float place[3] = { (float)vertex->x, (float)vertex->y, (float)vertex->z };
        memcpy(vertex, place, sizeof place);
    }
}

uint32_t c3d_gl_mesh_upload(void *state, const c3d_vertex *vertices, uint32_t count)
{
    return upload(state, GL_ARRAY_BUFFER, vertices, count * sizeof *vertices);
}

uint32_t c3d_gl_strip_upload(void *state, const uint16_t *indices, uint32_t count)
{
    return upload(state, GL_ELEMENT_ARRAY_BUFFER, indices, count * sizeof *indices);
}

void c3d_gl_buffer_free(void *opaque, uint32_t buffer)
{
    c3d_gl_state *state = opaque;
    if (state->array_buffer == buffer) state->array_buffer = 0; /* deleting unbinds */
    if (state->element_buffer == buffer) state->element_buffer = 0;
    state->gl.DeleteBuffers(1, &buffer);
}

uint32_t c3d_gl_texture_upload(void *opaque, enum c3d_texture_format format, uint32_t width,
                               uint32_t height, const void *pixels)
{
    static const struct {
        unsigned format, type;
    } formats[] = { [C3D_RGB565] = { GL_RGB, GL_UNSIGNED_SHORT_5_6_5 },
                    [C3D_RGBA5551] = { GL_RGBA, GL_UNSIGNED_SHORT_5_5_5_1 },
                    [C3D_RGBA8888] = { GL_RGBA, GL_UNSIGNED_BYTE } };
    c3d_gl_state *state = opaque;
    c3d_gl_api *gl = &state->gl;
    uint32_t texture = 0;
    while (gl->GetError()) {
    }
    gl->GenTextures(1, &texture);
    bind_texture(state, texture);
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    gl->TexParameterf(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, (float)GL_LINEAR);
    gl->TexParameterf(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, (float)GL_LINEAR);
    gl->TexParameterf(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, (float)GL_CLAMP_TO_EDGE);
    gl->TexParameterf(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, (float)GL_CLAMP_TO_EDGE);
    gl->TexImage2D(GL_TEXTURE_2D, 0, (int)formats[format].format, (int)width, (int)height, 0,
                   formats[format].format, formats[format].type, pixels);
    if (gl->GetError()) {
        c3d_gl_texture_free(state, texture);
        return 0;
    }
    return texture;
}

void c3d_gl_texture_free(void *opaque, uint32_t texture)
{
    c3d_gl_state *state = opaque;
    if (state->texture == texture) state->texture = 0;
    state->gl.DeleteTextures(1, &texture);
}

/* ---- a frame ---- */

void c3d_gl_begin(void *opaque, const c3d_frame *frame, const c3d_rotation *rotation)
{
    c3d_gl_state *state = opaque;
    c3d_gl_api *gl = &state->gl;
    float clear[4], fog[4];
    state->rotation = *rotation;
    state->width = frame->camera.width;
    state->height = frame->camera.height;
    state->fog = frame->fog_end_wu > 0;
    set_up(state);
    c3d_gl_projection(state->projection, &frame->camera);
    c3d_gl_backdrop_projection(state->backdrop_projection, &frame->camera);
    c3d_gl_colour(clear, frame->clear_colour);
    c3d_gl_colour(fog, frame->fog_colour);
    gl->Viewport(0, 0, state->width, state->height);
    gl->ClearColor(clear[0], clear[1], clear[2], clear[3]);
    gl->DepthMask(1);
    gl->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    gl->Fogf(GL_FOG_START, (float)frame->fog_start_wu * (1.0f / 256.0f));
    gl->Fogf(GL_FOG_END, (float)frame->fog_end_wu * (1.0f / 256.0f));
    gl->Fogfv(GL_FOG_COLOR, fog);
}

static void set_flags(c3d_gl_state *state, uint32_t flags)
{
    c3d_gl_api *gl = &state->gl;
    if (state->flags == flags) return;
    int backdrop = (flags & C3D_DRAW_BACKDROP) != 0, thrown = (flags & C3D_DRAW_PROJECTED) != 0,
        textured = thrown || (flags & C3D_DRAW_TEXTURED);
    unsigned mode = !thrown                       ? GL_MODULATE
                    : flags & C3D_DRAW_ALPHA_TEST ? GL_REPLACE /* the texture's alpha is tested */
                                                  : GL_DECAL;
    gl->TexEnvf(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, (float)mode);
    enable(state, GL_DEPTH_TEST, !backdrop);
    gl->DepthMask((unsigned char)!backdrop);
    enable(state, GL_FOG, state->fog && !backdrop);
    enable(state, GL_ALPHA_TEST, (flags & C3D_DRAW_ALPHA_TEST) != 0);
    gl->Disable(GL_BLEND);
    enable(state, GL_TEXTURE_2D, textured);
    enable_array(state, GL_TEXTURE_COORD_ARRAY, textured);
    enable_array(state, GL_COLOR_ARRAY, (flags & C3D_DRAW_COLOURED) != 0);
    gl->MatrixMode(GL_PROJECTION);
    gl->LoadMatrixf(backdrop ? state->backdrop_projection : state->projection);
    gl->MatrixMode(GL_MODELVIEW);
    state->flags = flags;
}

static float grid_place(uint32_t at, uint32_t first_q16, uint32_t last_q16)
{
    float first = (float)first_q16 * (1.0f / 65536.0f), last = (float)last_q16 * (1.0f / 65536.0f);
    if ((float)at < first) return first;
    return last_q16 && last < (float)at ? last : (float)at;
}

/* All meshes of as many columns, and of the same first and last ones, have the same grid. */
static void set_grid(c3d_gl_state *state, const c3d_draw *draw, uint32_t count)
{
    uint32_t columns = draw->tex_columns;
    const uint32_t *first = draw->tex_first_q16, *last = draw->tex_last_q16;
    if (state->grid_columns != columns ||
        memcmp(state->grid_first_q16, first, sizeof state->grid_first_q16) != 0 ||
        memcmp(state->grid_last_q16, last, sizeof state->grid_last_q16) != 0)
        state->grid_count = 0;
    state->grid_columns = columns;
    memcpy(state->grid_first_q16, first, sizeof state->grid_first_q16);
    memcpy(state->grid_last_q16, last, sizeof state->grid_last_q16);
    for (uint32_t i = state->grid_count; i < count; i++) {
        state->grid[i][0] = grid_place(i % columns, first[0], last[0]);
        state->grid[i][1] = grid_place(i / columns, first[1], last[1]);
    }
    if (state->grid_count < count) state->grid_count = count;
    bind_array(state, 0);
    state->gl.TexCoordPointer(2, GL_FLOAT, 0, state->grid);
}

static void set_texture(c3d_gl_state *state, const c3d_resolved_draw *resolved)
{
    float matrix[16];
    set_grid(state, resolved->draw, resolved->mesh->count);
    bind_texture(state, resolved->texture);
    c3d_gl_texture_matrix(matrix, resolved->draw);
    state->gl.MatrixMode(GL_TEXTURE);
    state->gl.LoadMatrixf(matrix);
    state->gl.MatrixMode(GL_MODELVIEW);
}

/* Vertices are their own texture coordinates; their array is bound. */
static void set_thrown(c3d_gl_state *state, const c3d_resolved_draw *resolved,
                       const float matrix[16])
{
    const c3d_vertex *base = resolved->mesh->vertices;
    bind_texture(state, resolved->texture);
    state->gl.TexCoordPointer(3, GL_FLOAT, (int)sizeof *base, base);
    state->gl.MatrixMode(GL_TEXTURE);
    state->gl.LoadMatrixf(matrix);
    state->gl.MatrixMode(GL_MODELVIEW);
}

static void set_mesh(c3d_gl_state *state, const c3d_resolved_draw *resolved, uint32_t flags)
{
    c3d_gl_api *gl = &state->gl;
    const c3d_draw *draw = resolved->draw;
    /* NULL with a vertex buffer: GL then takes pointers as offsets */
    const c3d_vertex *base = resolved->mesh->vertices;
    float matrix[16];
    set_flags(state, flags);
    c3d_gl_modelview(matrix, resolved, &state->rotation);
    gl->LoadMatrixf(matrix);
    if (flags & C3D_DRAW_TEXTURED) set_texture(state, resolved);
    bind_array(state, resolved->mesh->buffer);
    gl->VertexPointer(3, GL_FLOAT, (int)sizeof *base, base);
    if (draw->flags & C3D_DRAW_COLOURED) {
        gl->ColorPointer(4, GL_UNSIGNED_BYTE, (int)sizeof *base,
                         offset_pointer(base, offsetof(c3d_vertex, rgba)));
    } else {
        float rgba[4];
        c3d_gl_colour(rgba, draw->colour);
        gl->Color4f(rgba[0], rgba[1], rgba[2], rgba[3]);
    }
}

static void draw_elements(c3d_gl_state *state, const c3d_strip_data *strip, uint32_t flags)
{
    bind_elements(state, strip->buffer);
    if (flags & C3D_DRAW_WIREFRAME)
        state->gl.DrawElements(
            GL_LINES, (int)strip->edge_count, GL_UNSIGNED_SHORT,
            offset_pointer(strip->indices, strip->count * sizeof *strip->indices));
    else
        state->gl.DrawElements(GL_TRIANGLE_STRIP, (int)strip->count, GL_UNSIGNED_SHORT,
                               strip->indices);
}

static void clip_by(c3d_gl_state *state, const double plane[4])
{
    const float rounded[4] = { (float)plane[0], (float)plane[1], (float)plane[2], (float)plane[3] };
    if (state->gl.ClipPlane)
        state->gl.ClipPlane(GL_CLIP_PLANE0, plane);
    else
        state->gl.ClipPlanef(GL_CLIP_PLANE0, rounded);
    state->gl.Enable(GL_CLIP_PLANE0);
}

/* A thrown picture that lets through what is below it: all of it has the same alpha, which the test
 * reckons with. */
static void set_through(c3d_gl_state *state, uint8_t through)
{
    c3d_gl_api *gl = &state->gl;
    float alpha = (float)(256 - through) * (1.0f / 256.0f);
    gl->TexEnvf(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, (float)GL_MODULATE);
    gl->AlphaFunc(GL_GEQUAL, ALPHA_LEAST * alpha);
    gl->Enable(GL_BLEND);
    enable_array(state, GL_COLOR_ARRAY, 0);
    gl->Color4f(1, 1, 1, alpha);
}

static void end_through(c3d_gl_state *state)
{
    state->gl.AlphaFunc(GL_GEQUAL, ALPHA_LEAST);
    state->flags = UINT32_MAX; /* the others are set again */
}

/* What lies behind the projector, where texture coordinates would come out as before it, is drawn
 * without it; then the rest is drawn over that. */
static void draw_thrown(c3d_gl_state *state, const c3d_resolved_draw *resolved)
{
    const uint32_t flags = resolved->draw->flags, plain = flags & ~(uint32_t)C3D_DRAW_PROJECTED;
    float matrix[16];
    double plane[4];
    enum c3d_gl_thrown where = c3d_gl_throw_matrix(matrix, plane, resolved);
    int over = (flags & C3D_DRAW_ALPHA_TEST) != 0;
    if (where == C3D_GL_ACROSS && !state->gl.ClipPlane && !state->gl.ClipPlanef)
        where = C3D_GL_BEHIND;
    if (where != C3D_GL_BEFORE && !over) {
        set_mesh(state, resolved, plain);
        draw_elements(state, resolved->strip, plain);
    }
    if (where == C3D_GL_BEHIND) return;
    set_mesh(state, resolved,
             where == C3D_GL_ACROSS ? flags | (uint32_t)C3D_DRAW_ALPHA_TEST : flags);
    if (where == C3D_GL_ACROSS) clip_by(state, plane);
    set_thrown(state, resolved, matrix);
    if (over && resolved->draw->through) set_through(state, resolved->draw->through);
    draw_elements(state, resolved->strip, flags);
    if (over && resolved->draw->through) end_through(state);
    if (where == C3D_GL_ACROSS) state->gl.Disable(GL_CLIP_PLANE0);
}

void c3d_gl_draw(void *opaque, const c3d_resolved_draw *resolved)
{
    c3d_gl_state *state = opaque;
    uint32_t flags = resolved->draw->flags;
    if ((flags & C3D_DRAW_PROJECTED) && !(flags & C3D_DRAW_WIREFRAME)) {
        draw_thrown(state, resolved);
        return;
    }
    flags &= ~(uint32_t)C3D_DRAW_PROJECTED;
    set_mesh(state, resolved, flags);
    draw_elements(state, resolved->strip, flags);
}

void c3d_gl_points(void *opaque, const c3d_resolved_draw *resolved)
{
    c3d_gl_state *state = opaque;
    set_mesh(state, resolved, resolved->draw->flags);
    state->gl.PointSize((float)resolved->draw->point_px);
    state->gl.DrawArrays(GL_POINTS, 0, (int)resolved->mesh->count);
}

/* Draws a rectangle in clip coordinates; t = 0 is the image's first row, at the top. */
void c3d_gl_overlay(void *opaque, uint32_t texture, int x, int y, int width, int height)
{
    static const float corners[8] = { 0, 0, 0, 1, 1, 0, 1, 1 };
    c3d_gl_state *state = opaque;
    c3d_gl_api *gl = &state->gl;
    float across = 2.0f / state->width, down = -2.0f / state->height;
    float place[16] = { (float)width * across,
                        0,
                        0,
                        0,
                        0,
                        (float)height * down,
                        0,
                        0,
                        0,
                        0,
                        1,
                        0,
                        (float)x * across - 1.0f,
                        (float)y * down + 1.0f,
                        0,
                        1 };
    set_flags(state, C3D_DRAW_TEXTURED | C3D_DRAW_BACKDROP);
    /* blending and the projection below belong to the overlay alone */
    state->flags = UINT32_MAX;
    gl->Enable(GL_BLEND);
    gl->MatrixMode(GL_PROJECTION);
    gl->LoadIdentity();
    gl->MatrixMode(GL_TEXTURE);
    gl->LoadIdentity();
    gl->MatrixMode(GL_MODELVIEW);
    gl->LoadMatrixf(place);
    gl->Color4f(1, 1, 1, 1);
    bind_texture(state, texture);
    bind_array(state, 0);
    gl->VertexPointer(2, GL_FLOAT, 0, corners);
    gl->TexCoordPointer(2, GL_FLOAT, 0, corners);
    gl->DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

/* ---- labels ---- */

enum {
    FONT_CELL_PX = 8,
    FONT_COLUMNS = 16,
    FONT_WIDTH = FONT_CELL_PX * FONT_COLUMNS,
    FONT_HEIGHT = FONT_CELL_PX * C3D_FONT_GLYPHS / FONT_COLUMNS,
    CHAR_VERTICES = 6 /* two triangles */
};

/* Makes the texture of all glyphs: white letters on clear ground. */
static uint32_t upload_font(c3d_gl_state *state)
{
    uint16_t texels[FONT_WIDTH * FONT_HEIGHT] = { 0 }; /* RGBA5551 */
    for (unsigned glyph = 0; glyph < C3D_FONT_GLYPHS; glyph++) {
        const uint8_t *rows = c3d_font_rows(glyph);
        uint16_t *cell = texels +
                         (glyph / FONT_COLUMNS * FONT_WIDTH + glyph % FONT_COLUMNS) * FONT_CELL_PX;
        for (int row = 0; row < C3D_FONT_ROWS; row++)
            for (int column = 0; column < C3D_FONT_COLUMNS; column++)
                cell[row * FONT_WIDTH + column] = rows[row] >> (C3D_FONT_COLUMNS - 1 - column) & 1
                                                      ? 0xFFFF
                                                      : 0xFFFE;
    }
    return c3d_gl_texture_upload(state, C3D_RGBA5551, FONT_WIDTH, FONT_HEIGHT, texels);
}

/* A letter's corner: where it is in eye space, and in the font. */
typedef struct label_vertex {
    float place[3], texel[2];
} label_vertex;

/* Places a letter's corners: on corners of pixels, at the label's depth. */
static void place_letter(const c3d_gl_state *state, const c3d_placed_label *label, int i,
                         label_vertex corner[CHAR_VERTICES])
{
    static const uint8_t of_quad[CHAR_VERTICES][2] = { { 0, 0 }, { 0, 1 }, { 1, 0 },
                                                       { 1, 0 }, { 0, 1 }, { 1, 1 } };
    unsigned glyph = c3d_font_index(label->text[i]);
    double z = (double)label->z_q14 / (256.0 * (1 << C3D_EYE_SHIFT));
    for (int c = 0; c < CHAR_VERTICES; c++) {
        int right = of_quad[c][0] * C3D_FONT_COLUMNS, down = of_quad[c][1] * C3D_FONT_ROWS;
        double x_px = label->x + i * C3D_TEXT_ADVANCE_PX + right, y_px = label->y + down;
        corner[c].place[0] = (float)((2 * x_px / state->width - 1) * z / state->projection[0]);
        corner[c].place[1] = (float)((1 - 2 * y_px / state->height) * z / state->projection[5]);
        corner[c].place[2] = (float)-z;
        corner[c].texel[0] = (float)(glyph % FONT_COLUMNS * FONT_CELL_PX + (unsigned)right) /
                             FONT_WIDTH;
        corner[c].texel[1] = (float)(glyph / FONT_COLUMNS * FONT_CELL_PX + (unsigned)down) /
                             FONT_HEIGHT;
    }
}

void c3d_gl_label(void *opaque, const c3d_placed_label *label)
{
    c3d_gl_state *state = opaque;
    c3d_gl_api *gl = &state->gl;
    label_vertex corner[C3D_LABEL_CHARS * CHAR_VERTICES];
    float rgba[4];
    int count = 0;
    if (!state->font) state->font = upload_font(state);
    if (!state->font) return;
    for (int i = 0; label->text[i]; i++, count += CHAR_VERTICES)
        place_letter(state, label, i, corner + count);
    set_flags(state, C3D_DRAW_TEXTURED | C3D_DRAW_ALPHA_TEST);
    state->flags = UINT32_MAX; /* no fog belongs to the label alone */
    gl->Disable(GL_FOG);
    gl->MatrixMode(GL_TEXTURE);
    gl->LoadIdentity();
    gl->MatrixMode(GL_MODELVIEW);
    gl->LoadIdentity();
    c3d_gl_colour(rgba, label->colour | 0xFF000000u);
    gl->Color4f(rgba[0], rgba[1], rgba[2], rgba[3]);
    bind_texture(state, state->font);
    bind_array(state, 0);
    gl->VertexPointer(3, GL_FLOAT, (int)sizeof *corner, corner->place);
    gl->TexCoordPointer(2, GL_FLOAT, (int)sizeof *corner, corner->texel);
    gl->DrawArrays(GL_TRIANGLES, 0, count);
}

void c3d_gl_end(void *opaque)
{
    c3d_gl_state *state = opaque;
    state->gl.Finish();
}

int c3d_gl_read_rows(void *opaque, uint32_t width, uint32_t first_row, uint32_t rows, uint8_t *rgba)
{
    c3d_gl_state *state = opaque;
    while (state->gl.GetError()) {
    }
    state->gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
    state->gl.ReadPixels(0, (int)first_row, (int)width, (int)rows, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
    return state->gl.GetError() ? FF_ERR_SYSTEM : FF_OK;
}
