/* Text over the picture, for people who tune: a small font of our own, drawn into an RGBA8888 buffer that c3d_overlay shows.
 * Build switch FF_HUD (default 1); 0 leaves no code and no bytes. */
#ifndef FF_HUD_H
#define FF_HUD_H

#include <stdint.h>

#ifndef FF_HUD
#define FF_HUD 1
#endif

#define FF_HUD_CHAR_PX 6  /* from one character to the next */
#define FF_HUD_LINE_PX 10 /* from one line to the next */

#if FF_HUD
/* Writes `text` (ASCII; lower case shows as capitals, unknown characters as blanks; '\n' starts a line) white and opaque into the
 * image of width by height pixels, top row first, with its top left corner at (x, y). What lies outside is cut off. */
void ff_hud_text(uint8_t *rgba, int width, int height, int x, int y, const char *text);
#endif

#endif
