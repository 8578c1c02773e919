/* The second decoder of pictures, written from protocol/SPEC.md, 5.2, and slow on purpose: one
 * texel at a time from whole sums, blocks kept as they are. It shares the learned numbers with
 * protocol/, which are part of the format, and no code. */
#ifndef SLOW_PICTURE_H
#define SLOW_PICTURE_H

#include <stdint.h>

/* A picture of `side` texels, RGB888, north row first; so is `parent`, the parent's, of which it is
 * child `quadrant`; NULL: a root. -1 when the bytes break a rule. */
int slow_picture(const uint8_t *bytes, long count, int side, const uint8_t *parent, int quadrant,
                 uint8_t *rgb);

/* The same of paint (SPEC.md, 5.3), top row first, of columns x rows blocks, at most 32 each way.
 * Which are there, and how many in all, or -1. */
int slow_paint(const uint8_t *bytes, long count, int columns, int rows, uint8_t *there,
               uint8_t *rgb);

#endif
