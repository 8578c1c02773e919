/* Squares of heights, in and out of a lattice that is `pitch` points wide. */
#ifndef BAKE_SQUARE_H
#define BAKE_SQUARE_H

#include <stddef.h>
#include <stdint.h>

/* Copies a square of `side` points, `stride` apart, from a lattice. */
static inline void bake_gather(const uint16_t *lattice, size_t pitch, uint32_t side, size_t stride,
                               uint16_t *out)
{
    for (uint32_t j = 0; j < side; j++)
        for (uint32_t i = 0; i < side; i++) *out++ = lattice[(j * pitch + i) * stride];
}

/* Copies it back. */
static inline void bake_scatter(const uint16_t *in, size_t pitch, uint32_t side, size_t stride,
                                uint16_t *lattice)
{
    for (uint32_t j = 0; j < side; j++)
        for (uint32_t i = 0; i < side; i++) lattice[(j * pitch + i) * stride] = *in++;
}

#endif
