/* The one small font, of pictures (c3d_text.h) and of labels (c3d.h): capitals only, lower case
 * shows as capitals. Inside common3d only. */
#ifndef C3D_FONT_H
#define C3D_FONT_H

#include <stdint.h>

#define C3D_FONT_GLYPHS  64
#define C3D_FONT_ROWS    7
#define C3D_FONT_COLUMNS 5

/* The glyph of a character, below C3D_FONT_GLYPHS; that of '?' for what is not in the font. */
unsigned c3d_font_index(char c);
/* C3D_FONT_ROWS rows from the top, the highest of C3D_FONT_COLUMNS bits leftmost. */
const uint8_t *c3d_font_rows(unsigned index);

#endif
