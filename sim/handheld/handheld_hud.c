/* Figures over the picture. A build without HUD leaves this file out (see handheld_hud_none.c). */
#include "handheld.h"

#include "../../common3d/c3d_text.h"

#include <string.h>

#define WIDTH  128
#define HEIGHT 16

#define ABOUT_WIDTH  256
#define ABOUT_HEIGHT 32
#define ABOUT_LINES  3
#define ABOUT_FRAMES 300 /* ten seconds */
#define MARGIN       2

uint32_t handheld_hud_about(void) { return SIM_ABOUT_SHOWN | SIM_WHERE_ABOUT; }

static void show(c3d_device *c3d, int width, int height, int y, const char *text)
{
    static uint8_t rgba[ABOUT_WIDTH * ABOUT_HEIGHT * 4]; /* the larger of the two */
    memset(rgba, 0, (size_t)width * (size_t)height * 4);
    c3d_text(rgba, width, height, MARGIN, MARGIN, 0xFFFFFFFFu, text);
    c3d_texture picture = c3d_texture_make(c3d, C3D_RGBA8888, width, height, rgba);
    c3d_overlay(c3d, picture, 0, y, width, height);
    c3d_texture_free(c3d, picture);
}

/* At the foot of the picture, for a while: name and attribution are to be seen, not in the way. */
static void show_about(handheld *device, c3d_device *c3d)
{
    char text[ABOUT_LINES * (ABOUT_WIDTH / C3D_TEXT_ADVANCE_PX + 1) + 1];
    int width = device->width < ABOUT_WIDTH ? device->width : ABOUT_WIDTH;
    if (device->about_frames >= ABOUT_FRAMES) return;
    int lines = (int)sim_about_lines(device->client,
                                     (unsigned)((width - 2 * MARGIN) / C3D_TEXT_ADVANCE_PX),
                                     ABOUT_LINES, text, sizeof text);
    if (!lines) return;
    device->about_frames++;
    show(c3d, ABOUT_WIDTH, ABOUT_HEIGHT, device->height - lines * C3D_TEXT_LINE_PX - 2 * MARGIN,
         text);
}

void handheld_hud(handheld *device, const c3d_camera *camera)
{
    char text[80];
    ff_client_stats stats;
    c3d_device *c3d = ff_client_device(device->client);
    if (!c3d) return;
    ff_client_get_stats(device->client, &stats);
    snprintf(text, sizeof text, "%u T %u N %u KB", (unsigned)stats.tree.triangles,
             (unsigned)stats.tree.nodes_held, (unsigned)(stats.bytes_down / 1024));
    show(c3d, WIDTH, HEIGHT, 0, text);
    if (sim_where_ask(&device->where, device->client) == FF_OK &&
        sim_where_line(&device->where, camera, text, sizeof text))
        show(c3d, ABOUT_WIDTH, HEIGHT, C3D_TEXT_LINE_PX, text);
    show_about(device, c3d);
}
