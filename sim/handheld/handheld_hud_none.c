/* Stands in for handheld_hud.c in builds without HUD. */
#include "handheld.h"

void handheld_hud(handheld *device) { (void)device; }
