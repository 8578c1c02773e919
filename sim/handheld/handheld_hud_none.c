/* Stands in for handheld_hud.c in builds without HUD. */
#include "handheld.h"

void handheld_hud(handheld *device, const c3d_camera *camera) { (void)device, (void)camera; }
uint32_t handheld_hud_about(void) { return 0; }
