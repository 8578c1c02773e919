/* A second decoder of roots and refinements, written from protocol/SPEC.md and slow on purpose: it
 * reads bit by bit into a grid with coordinates, and shares no code with protocol/. While both
 * agree, the decoder does what the specification says. */
#ifndef SLOW_DECODER_H
#define SLOW_DECODER_H

#include "../../protocol/ff_terrain.h"

#include <stddef.h>

/* `parent` NULL: a root. Gives the heights row by row, and a bit for each child that holds filled
 * ground plus 16 times a bit for each that is a leaf, or -1 when the payload breaks a rule of the
 * specification. */
int slow_decode(const ff_terrain_info *info, const uint16_t *parent, const uint8_t *payload,
                size_t bytes, uint16_t *heights);
/* The same where so many columns and rows of the grid's cells have ground, the others padding. */
int slow_decode_part(const ff_terrain_info *info, int columns, int rows, const uint16_t *parent,
                     const uint8_t *payload, size_t bytes, uint16_t *heights);

#endif
