/* The second decoder of codec 3 (trained), written from protocol/SPEC.md, "Expectation" and
 * "Payload, codec 3", and slow on purpose: lists of places, coordinates that are clamped, one class
 * of points after another. It shares the trained numbers with protocol/, which are part of the
 * format, and no code. slow_decoder.h reads what stands before a body. */
#ifndef SLOW_TRAINED_H
#define SLOW_TRAINED_H

#include "../../protocol/ff_terrain.h"

/* All heights of a grid, row by row, from a payload's head and its body; of sides that are left
 * out, `heights` has them. `columns`, `rows`: cells with ground. A root has no `parent` but four
 * `corner` values. -1 when head or body break a rule of the specification. */
int slow_trained(const ff_terrain_info *info, int columns, int rows, const uint16_t *parent,
                 const long *corner, unsigned head, const uint8_t *body, long bytes,
                 uint16_t *heights);

#endif
