/* A second decoder of roots and refinements, written from protocol/SPEC.md and slow on purpose:
 * bits one at a time, a grid with coordinates, no sharing with protocol/. Where both agree,
 * specification and decoder are one. */
#ifndef SLOW_DECODER_H
#define SLOW_DECODER_H

#include "../../protocol/ff_terrain.h"

#include <stddef.h>

/* `parent` NULL: a root. 0 and heights row by row, or -1 when the payload breaks a rule of the
 * specification. */
int slow_decode(const ff_terrain_info *info, const uint16_t *parent, const uint8_t *payload,
                size_t bytes, uint16_t *heights);

#endif
