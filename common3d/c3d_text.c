#include "c3d_text.h"

#define GLYPH_ROWS    7
#define GLYPH_COLUMNS 5

/* Rows from the top, the highest of five bits leftmost. All zero but the blank: not in the font. */
static const uint8_t glyphs['_' - ' ' + 1][GLYPH_ROWS] = {
    [' ' - ' '] = { 0, 0, 0, 0, 0, 0, 0 },        ['!' - ' '] = { 4, 4, 4, 4, 4, 0, 4 },
    ['%' - ' '] = { 25, 25, 2, 4, 8, 19, 19 },    ['\'' - ' '] = { 4, 4, 8, 0, 0, 0, 0 },
    ['(' - ' '] = { 2, 4, 8, 8, 8, 4, 2 },        [')' - ' '] = { 8, 4, 2, 2, 2, 4, 8 },
    ['*' - ' '] = { 0, 4, 21, 14, 21, 4, 0 },     ['+' - ' '] = { 0, 4, 4, 31, 4, 4, 0 },
    [',' - ' '] = { 0, 0, 0, 0, 6, 2, 4 },        ['-' - ' '] = { 0, 0, 0, 31, 0, 0, 0 },
    ['.' - ' '] = { 0, 0, 0, 0, 0, 6, 6 },        ['/' - ' '] = { 1, 1, 2, 4, 8, 16, 16 },
    ['0' - ' '] = { 14, 17, 19, 21, 25, 17, 14 }, ['1' - ' '] = { 4, 12, 4, 4, 4, 4, 14 },
    ['2' - ' '] = { 14, 17, 1, 6, 8, 16, 31 },    ['3' - ' '] = { 30, 1, 1, 14, 1, 1, 30 },
    ['4' - ' '] = { 2, 6, 10, 18, 31, 2, 2 },     ['5' - ' '] = { 31, 16, 30, 1, 1, 17, 14 },
    ['6' - ' '] = { 14, 16, 16, 30, 17, 17, 14 }, ['7' - ' '] = { 31, 1, 2, 2, 4, 4, 4 },
    ['8' - ' '] = { 14, 17, 17, 14, 17, 17, 14 }, ['9' - ' '] = { 14, 17, 17, 15, 1, 1, 14 },
    [':' - ' '] = { 0, 6, 6, 0, 6, 6, 0 },        ['<' - ' '] = { 2, 4, 8, 16, 8, 4, 2 },
    ['=' - ' '] = { 0, 0, 31, 0, 31, 0, 0 },      ['>' - ' '] = { 8, 4, 2, 1, 2, 4, 8 },
    ['?' - ' '] = { 14, 17, 1, 6, 4, 0, 4 },      ['A' - ' '] = { 14, 17, 17, 31, 17, 17, 17 },
    ['B' - ' '] = { 30, 17, 17, 30, 17, 17, 30 }, ['C' - ' '] = { 14, 17, 16, 16, 16, 17, 14 },
    ['D' - ' '] = { 30, 17, 17, 17, 17, 17, 30 }, ['E' - ' '] = { 31, 16, 16, 30, 16, 16, 31 },
    ['F' - ' '] = { 31, 16, 16, 30, 16, 16, 16 }, ['G' - ' '] = { 14, 17, 16, 23, 17, 17, 15 },
    ['H' - ' '] = { 17, 17, 17, 31, 17, 17, 17 }, ['I' - ' '] = { 14, 4, 4, 4, 4, 4, 14 },
    ['J' - ' '] = { 7, 2, 2, 2, 2, 18, 12 },      ['K' - ' '] = { 17, 18, 20, 24, 20, 18, 17 },
    ['L' - ' '] = { 16, 16, 16, 16, 16, 16, 31 }, ['M' - ' '] = { 17, 27, 21, 21, 17, 17, 17 },
    ['N' - ' '] = { 17, 25, 25, 21, 19, 19, 17 }, ['O' - ' '] = { 14, 17, 17, 17, 17, 17, 14 },
    ['P' - ' '] = { 30, 17, 17, 30, 16, 16, 16 }, ['Q' - ' '] = { 14, 17, 17, 17, 21, 18, 13 },
    ['R' - ' '] = { 30, 17, 17, 30, 20, 18, 17 }, ['S' - ' '] = { 15, 16, 16, 14, 1, 1, 30 },
    ['T' - ' '] = { 31, 4, 4, 4, 4, 4, 4 },       ['U' - ' '] = { 17, 17, 17, 17, 17, 17, 14 },
    ['V' - ' '] = { 17, 17, 17, 17, 10, 10, 4 },  ['W' - ' '] = { 17, 17, 17, 21, 21, 27, 17 },
    ['X' - ' '] = { 17, 17, 10, 4, 10, 17, 17 },  ['Y' - ' '] = { 17, 17, 10, 4, 4, 4, 4 },
    ['Z' - ' '] = { 31, 1, 2, 4, 8, 16, 31 },     ['_' - ' '] = { 0, 0, 0, 0, 0, 0, 31 },
};

static const uint8_t *glyph_of(char c)
{
    if (c >= 'a' && c <= 'z') c = (char)(c - 'a' + 'A');
    if (c == ' ') return glyphs[0];
    if (c < ' ' || c > '_') return glyphs['?' - ' '];
    const uint8_t *glyph = glyphs[c - ' '];
    for (int row = 0; row < GLYPH_ROWS; row++)
        if (glyph[row]) return glyph;
    return glyphs['?' - ' '];
}

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
    for (int row = 0; row < GLYPH_ROWS; row++)
        for (int column = 0; column < GLYPH_COLUMNS; column++) {
            int at_x = x + column, at_y = y + row;
            if (!(glyph[row] >> (GLYPH_COLUMNS - 1 - column) & 1)) continue;
            if (at_x < 0 || at_y < 0 || at_x >= width || at_y >= height) continue;
            put_pixel(rgba + 4 * ((int64_t)at_y * width + at_x), colour);
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
        if (x < width && y < height) put_glyph(rgba, width, height, x, y, colour, glyph_of(*text));
        x += C3D_TEXT_ADVANCE_PX;
    }
}
