#include "ff_key.h"

#define X_BITS 0x55555555u /* even bits hold x, odd bits y */
#define Y_BITS 0xaaaaaaaau

/* 16 bits to every second bit of 32, halving the gap each time. */
static uint32_t spread(uint32_t v)
{
    v &= 0xffffu;
    v = (v | (v << 8)) & 0x00ff00ffu;
    v = (v | (v << 4)) & 0x0f0f0f0fu;
    v = (v | (v << 2)) & 0x33333333u;
    return (v | (v << 1)) & X_BITS;
}

static uint32_t gather(uint32_t v)
{
    v &= X_BITS;
    v = (v | (v >> 1)) & 0x33333333u;
    v = (v | (v >> 2)) & 0x0f0f0f0fu;
    v = (v | (v >> 4)) & 0x00ff00ffu;
    return (v | (v >> 8)) & 0xffffu;
}

uint32_t ff_morton_encode(uint32_t x, uint32_t y) { return spread(x) | (spread(y) << 1); }
uint32_t ff_morton_x(uint32_t code) { return gather(code); }
uint32_t ff_morton_y(uint32_t code) { return gather(code >> 1); }

/* Steps one coordinate of a Morton code by one, up or down; the mask `own` marks its bits. The
 * other coordinate keeps its value: its bits are set to one while adding, so that a carry runs
 * through them, and cleared while subtracting, so that a borrow does. The result is cut to
 * `level_bits`: a step over the border of a tile comes in at the tile's other end. */
static uint32_t step(uint32_t code, uint32_t own, uint32_t level_bits, int up)
{
    uint32_t moved = up ? (code | ~own) + 1u : (code & own) - 1u;

    return (code & ~own) | (moved & own & level_bits);
}

/* Moves *tile to the tile across `side`. Returns 0 when the terrain ends there: *tile then names no
 * tile. */
static int next_tile(uint32_t tiles_x, uint32_t tiles_y, enum ff_side side, uint32_t *tile)
{
    uint32_t tx = *tile % tiles_x, ty = *tile / tiles_x;

    switch (side) {
        case FF_SIDE_SOUTH: *tile -= tiles_x; return ty > 0;
        case FF_SIDE_EAST: *tile += 1; return tx + 1 < tiles_x;
        case FF_SIDE_NORTH: *tile += tiles_x; return ty + 1 < tiles_y;
        default: *tile -= 1; return tx > 0;
    }
}

ff_key ff_key_neighbour(uint32_t tiles_x, uint32_t tiles_y, ff_key key, enum ff_side side)
{
    uint32_t tile = ff_key_tile(key), level = ff_key_level(key), code = ff_key_code(key);
    uint32_t level_bits = (1u << (2 * level)) - 1u;
    uint32_t own = (side == FF_SIDE_EAST || side == FF_SIDE_WEST) ? X_BITS : Y_BITS;
    int up = side == FF_SIDE_EAST || side == FF_SIDE_NORTH;
    /* the coordinate's value in the last node before the border */
    uint32_t border = up ? own & level_bits : 0;

    if ((code & own) == border && !next_tile(tiles_x, tiles_y, side, &tile)) return FF_KEY_NONE;
    return ff_key_make(tile, level, step(code, own, level_bits, up));
}
