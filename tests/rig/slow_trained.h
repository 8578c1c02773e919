/* The second decoder of codec 3 (trained), written from protocol/SPEC.md, "Expectation" and
 * "Payload, codec 3", and slow on purpose: lists of places, coordinates that are clamped, one class
 * of points after another. It shares the trained numbers with protocol/, which are part of the
 * format, and no code. */
#ifndef SLOW_TRAINED_H
#define SLOW_TRAINED_H

#include "../../protocol/ff_terrain.h"

/* All heights of a grid, row by row, from a payload; of sides that are left out, `heights` has
 * them. `columns`, `rows`: cells with ground. Gives marks as slow_decode does, -1 when the payload
 * breaks a rule of the specification. */
int slow_trained(const ff_terrain_info *info, int columns, int rows, const uint16_t *parent,
                 const uint8_t *payload, long bytes, uint16_t *heights);

#endif
