/* Figures over the picture. A build without HUD leaves this file out (see handheld_hud_none.c). */
#include "handheld.h"

#include "../../common3d/c3d_text.h"

#include <string.h>

#define WIDTH  128
#define HEIGHT 16

void handheld_hud(handheld *device)
{
    static uint8_t rgba[WIDTH * HEIGHT * 4];
    char text[48];
    ff_client_stats stats;
    c3d_device *c3d = ff_client_device(device->client);
    if (!c3d) return;
    ff_client_get_stats(device->client, &stats);
    snprintf(text, sizeof text, "%u T %u N %u KB", (unsigned)stats.tree.triangles,
             (unsigned)stats.tree.nodes_held, (unsigned)(stats.bytes_down / 1024));
    memset(rgba, 0, sizeof rgba);
    c3d_text(rgba, WIDTH, HEIGHT, 2, 2, 0xFFFFFFFFu, text);
    c3d_texture picture = c3d_texture_make(c3d, C3D_RGBA8888, WIDTH, HEIGHT, rgba);
    c3d_overlay(c3d, picture, 0, 0, WIDTH, HEIGHT);
    c3d_texture_free(c3d, picture);
}
