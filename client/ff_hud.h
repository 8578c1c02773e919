/* A few lines of text over the picture: numbers for people who tune. Build switch FF_HUD (default 1); 0 leaves no code and no bytes. */
#ifndef FF_HUD_H
#define FF_HUD_H

#include "../common3d/c3d.h"

#ifndef FF_HUD
#define FF_HUD 1
#endif

struct ff_client_stats;

#define FF_HUD_WIDTH 128
#define FF_HUD_HEIGHT 64

typedef struct ff_hud {
    uint8_t *rgba;           /* FF_HUD_WIDTH x FF_HUD_HEIGHT, top row first; NULL: no HUD */
    c3d_texture texture;
    uint64_t shown;          /* hash of the text in the texture */
} ff_hud;

size_t ff_hud_bytes(void);
void ff_hud_draw(ff_hud *hud, c3d_device *device, const struct ff_client_stats *stats);

#endif
