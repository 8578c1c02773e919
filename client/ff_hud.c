#include "ff_hud.h"

#include "farfield.h"

#if FF_HUD

size_t ff_hud_bytes(void)
{
    return (size_t)FF_HUD_WIDTH * FF_HUD_HEIGHT * 4;
}

void ff_hud_draw(ff_hud *hud, c3d_device *device, const struct ff_client_stats *stats)
{
    (void)hud;
    (void)device;
    (void)stats;
}

#endif
