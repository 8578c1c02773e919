/* Labels: the font's pixels, all at one depth. Left out with labels. */
#include "soft_local.h"
#include "../c3d_font.h"
#include "../c3d_text.h"

/* near/z, Q30, as soft_vertex has it. */
static uint32_t w_of(const soft_state *state, int64_t z_q14)
{
    int64_t near_q14 = (int64_t)state->frame.camera.near_wu << C3D_EYE_SHIFT,
            most = ((int64_t)1 << 30) - 1, w = c3d_muldiv64(near_q14, most, z_q14);
    return (uint32_t)(w < 1 ? 1 : w);
}

static void draw_letter(soft_state *state, const uint8_t *rows, int32_t x, int32_t y, uint32_t w,
                        uint32_t colour)
{
    for (int32_t row = y < 0 ? -y : 0; row < C3D_FONT_ROWS && y + row < state->height; row++)
        for (int32_t column = 0; column < C3D_FONT_COLUMNS; column++) {
            int32_t at_x = x + column;
            uint32_t at = (uint32_t)((y + row) * state->width + at_x);
            if (!(rows[row] >> (C3D_FONT_COLUMNS - 1 - column) & 1)) continue;
            if (at_x < 0 || at_x >= state->width || w < state->depth[at]) continue;
            state->depth[at] = w;
            soft_put(state, at, (int32_t)(colour & 255), (int32_t)(colour >> 8 & 255),
                     (int32_t)(colour >> 16 & 255));
        }
}

void soft_label(void *opaque, const c3d_placed_label *label)
{
    soft_state *state = opaque;
    uint32_t w = w_of(state, label->z_q14);
    int32_t x = label->x, top = label->y < 0 ? 0 : label->y;
    if (state->blank) return;
    state->painted = 1;
    state->top_row = top < state->top_row ? top : state->top_row;
    for (const char *c = label->text; *c; c++, x += C3D_TEXT_ADVANCE_PX)
        draw_letter(state, c3d_font_rows(c3d_font_index(*c)), x, label->y, w, label->colour);
}
