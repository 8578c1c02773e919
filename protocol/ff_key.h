/* Node keys: tile, level of detail and Morton code in one 64-bit integer (Hybrid, section 6.1.1,
 * figure 11).
 *
 * Every tile is the root (level 0) of a quadtree; level l of a tile holds 2^l by 2^l nodes, x to
 * the tile's east, y to its north. The Morton code of node (x, y) interleaves the bits of x (even
 * bits) and y (odd bits), so the two lowest bits are the quadrant within the parent: 0 south-west,
 * 1 south-east, 2 north-west, 3 north-east. Where tiles lie and touch is the terrain's shape
 * (shape/ff_shape.h).
 *
 *   bit 63       36 35    32 31              0
 *       tile (28)   level(4)  Morton code (2*level bits used)
 */
#ifndef FF_KEY_H
#define FF_KEY_H

#include "ff_assert.h"

#include <stdint.h>

typedef uint64_t ff_key;

#define FF_KEY_NONE       UINT64_MAX
#define FF_KEY_TILES_MAX  (1u << 28)
#define FF_KEY_TILE_SHIFT 36
#define FF_KEY_LEVEL_MAX  15u

/* Tile, level and code fill a key. A code has two bits a level, so the key of all ones is no
 * node's. */
FF_STATIC_ASSERT(((ff_key)(FF_KEY_TILES_MAX - 1) << FF_KEY_TILE_SHIFT |
                  (ff_key)FF_KEY_LEVEL_MAX << 32 | UINT32_MAX) == FF_KEY_NONE);
FF_STATIC_ASSERT(2 * FF_KEY_LEVEL_MAX < 32);

/* Of a node's grid: its first row, last column, last row, first column. They run round it. */
enum ff_side { FF_SIDE_SOUTH, FF_SIDE_EAST, FF_SIDE_NORTH, FF_SIDE_WEST, FF_SIDE_COUNT };

static inline ff_key ff_key_make(uint32_t tile, uint32_t level, uint32_t code)
{
    FF_ASSERT(level <= FF_KEY_LEVEL_MAX);
    return ((ff_key)tile << FF_KEY_TILE_SHIFT) | ((ff_key)(level & 15u) << 32) | code;
}

static inline uint32_t ff_key_tile(ff_key key) { return (uint32_t)(key >> FF_KEY_TILE_SHIFT); }
static inline uint32_t ff_key_level(ff_key key) { return (uint32_t)(key >> 32) & 15u; }
static inline uint32_t ff_key_code(ff_key key) { return (uint32_t)key; }
static inline uint32_t ff_key_quadrant(ff_key key) { return (uint32_t)key & 3u; }

/* The child in `quadrant` (0..3) of a node whose level is less than FF_KEY_LEVEL_MAX; the parent of
 * a node whose level is more than 0. */
static inline ff_key ff_key_child(ff_key key, uint32_t quadrant)
{
    FF_ASSERT(ff_key_level(key) < FF_KEY_LEVEL_MAX && quadrant < 4);
    FF_ASSERT((uint64_t)ff_key_code(key) >> (2 * ff_key_level(key)) == 0);
    return ff_key_make(ff_key_tile(key), ff_key_level(key) + 1, (ff_key_code(key) << 2) | quadrant);
}
static inline ff_key ff_key_parent(ff_key key)
{
    FF_ASSERT(ff_key_level(key) > 0);
    return ff_key_make(ff_key_tile(key), ff_key_level(key) - 1, ff_key_code(key) >> 2);
}

/* Morton code of (x, y), each below 2^16, and back. */
uint32_t ff_morton_encode(uint32_t x, uint32_t y);
uint32_t ff_morton_x(uint32_t code);
uint32_t ff_morton_y(uint32_t code);

#define FF_KEY_X_BITS 0x55555555u /* even bits hold x, odd bits y */
#define FF_KEY_Y_BITS 0xaaaaaaaau
FF_STATIC_ASSERT((FF_KEY_X_BITS ^ FF_KEY_Y_BITS) == UINT32_MAX);

/* The code of the node of the same level across `side` in the same tile, by arithmetic on the
 * interleaved bits alone. 1 when that leads over the tile's border: *code is then where the step
 * comes in again at the opposite side.
 *
 * The mask `own` marks the bits of the coordinate that steps. The other coordinate keeps its value:
 * its bits are set to one while adding, so that a carry runs through them, and cleared while
 * subtracting, so that a borrow does. */
static inline int ff_key_step(ff_key key, enum ff_side side, uint32_t *code)
{
    uint32_t from = ff_key_code(key), level_bits = (1u << (2 * ff_key_level(key))) - 1u;
    uint32_t own = side == FF_SIDE_EAST || side == FF_SIDE_WEST ? FF_KEY_X_BITS : FF_KEY_Y_BITS;
    int up = side == FF_SIDE_EAST || side == FF_SIDE_NORTH;
    uint32_t moved = up ? (from | ~own) + 1u : (from & own) - 1u;
    /* the coordinate's value in the last node before the border */
    uint32_t border = up ? own & level_bits : 0;

    FF_ASSERT((unsigned)side < FF_SIDE_COUNT && (from & ~level_bits) == 0);
    *code = (from & ~own) | (moved & own & level_bits);
    return (from & own) == border;
}

#endif
