/* The second decoder of pictures, written from protocol/SPEC.md, 5.2, and slow on purpose: one
 * texel at a time from whole sums, blocks kept as they are. It shares the learned numbers with
 * protocol/, which are part of the format, and no code. */
#ifndef SLOW_PICTURE_H
#define SLOW_PICTURE_H

#include <stdint.h>

/* Texels of a picture of `side` texels, RGB565, south row first, and RGB888 before that, likewise.
 * `parent`: the parent's texels, `quadrant` which child it is; NULL: a root. -1 when the bytes
 * break a rule. */
int slow_picture(const uint8_t *bytes, long count, int side, const uint16_t *parent, int quadrant,
                 uint16_t *texels, uint8_t *rgb);

#endif
