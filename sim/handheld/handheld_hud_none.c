/* Stands in for handheld_hud.c in builds without HUD. */
#include "handheld.h"

void handheld_hud(handheld *device) { (void)device; }
uint32_t handheld_hud_about(void) { return 0; }
