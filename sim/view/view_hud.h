/* The emulator's text over the picture: counters, link and device state, or what the pools of the
 * client's block hold; and the list of keys. */
#ifndef VIEW_HUD_H
#define VIEW_HUD_H

#include "../../client/farfield.h"

#define VIEW_HUD_SIZE 256 /* pixels each way */
#define VIEW_HUD_TEXT 2048

struct view_app;

typedef struct view_hud {
    char text[VIEW_HUD_TEXT];  /* wanted */
    char shown[VIEW_HUD_TEXT]; /* in the texture */
    int bar_px;                /* of the map's scale; 0: no map is shown */
    int32_t north;             /* clockwise from up, brad16 */
    c3d_texture texture;
    const c3d_device *device; /* holds the texture; made for the terrain of this checksum */
    uint32_t checksum;
    uint8_t rgba[VIEW_HUD_SIZE * VIEW_HUD_SIZE * 4];
} view_hud;

/* Writes the text anew; 1 when it differs from the text shown. */
int view_hud_update(view_hud *hud, const struct view_app *app);
/* Draws the text over the picture just drawn with `device`. The device keeps the texture, and frees
 * it when it is closed. */
void view_hud_draw(view_hud *hud, const struct view_app *app, c3d_device *device);

#endif
