#include "c3d_text.h"
#include "c3d_assert.h"
#include "c3d_font.h"

FF_STATIC_ASSERT(C3D_TEXT_ADVANCE_PX > C3D_FONT_COLUMNS && C3D_TEXT_LINE_PX > C3D_FONT_ROWS);

static void put_pixel(uint8_t *pixel, uint32_t colour)
{
    pixel[0] = (uint8_t)colour;
    pixel[1] = (uint8_t)(colour >> 8);
    pixel[2] = (uint8_t)(colour >> 16);
    pixel[3] = (uint8_t)(colour >> 24);
}

static void put_glyph(uint8_t *rgba, int width, int height, int x, int y, uint32_t colour,
                      const uint8_t *glyph)
{
    for (int row = 0; row < C3D_FONT_ROWS; row++) {
        C3D_ASSERT(glyph[row] >> C3D_FONT_COLUMNS == 0);
        for (int column = 0; column < C3D_FONT_COLUMNS; column++) {
            int at_x = x + column, at_y = y + row;
            if (!(glyph[row] >> (C3D_FONT_COLUMNS - 1 - column) & 1)) continue;
            if (at_x < 0 || at_y < 0 || at_x >= width || at_y >= height) continue;
            put_pixel(rgba + 4 * ((int64_t)at_y * width + at_x), colour);
        }
    }
}

void c3d_text(uint8_t *rgba, int width, int height, int x, int y, uint32_t colour, const char *text)
{
    int left = x;
    for (; *text; text++) {
        if (*text == '\n') {
            x = left;
            y += C3D_TEXT_LINE_PX;
            continue;
        }
        if (x < width && y < height)
            put_glyph(rgba, width, height, x, y, colour, c3d_font_rows(c3d_font_index(*text)));
        x += C3D_TEXT_ADVANCE_PX;
    }
}
