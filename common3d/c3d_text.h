/* Text into pictures for c3d_overlay, in the font of c3d_font.h. Text that stands in the scene is
 * c3d.h's labels. */
#ifndef C3D_TEXT_H
#define C3D_TEXT_H

#include <stdint.h>

#define C3D_TEXT_ADVANCE_PX 6 /* from a character to the next one */
#define C3D_TEXT_LINE_PX    9 /* from a line to the next one; letters are 7 high */

/* Writes `text` (lines end with \n) into RGBA8888, top row first, the first letter's top left
 * corner at (x, y) pixels. Only the letters' pixels change, to `colour` (0xAABBGGRR). What does not
 * fit is cut off; characters not in the font show as '?'. */
void c3d_text(uint8_t *rgba, int width, int height, int x, int y, uint32_t colour,
              const char *text);

#endif
