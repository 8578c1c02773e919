/* Node keys: tile, level of detail and Morton code in one 64-bit integer (Hybrid, section 6.1.1,
 * figure 11).
 *
 * The terrain is a grid of tiles_x by tiles_y tiles, tile number = ty * tiles_x + tx, tx to the
 * east, ty to the north. Every tile is the root (level 0) of a quadtree; level l of a tile holds
 * 2^l by 2^l nodes. The Morton code of node (x, y) interleaves the bits of x (even bits) and y (odd
 * bits), so the two lowest bits are the quadrant within the parent: 0 south-west, 1 south-east, 2
 * north-west, 3 north-east.
 *
 *   bit 63       36 35    32 31              0
 *       tile (28)   level(4)  Morton code (2*level bits used)
 */
#ifndef FF_KEY_H
#define FF_KEY_H

#include <stdint.h>

typedef uint64_t ff_key;

#define FF_KEY_NONE      UINT64_MAX
#define FF_KEY_TILES_MAX (1u << 28)
#define FF_KEY_LEVEL_MAX 15u

enum ff_side { FF_SIDE_SOUTH, FF_SIDE_EAST, FF_SIDE_NORTH, FF_SIDE_WEST, FF_SIDE_COUNT };

static inline ff_key ff_key_make(uint32_t tile, uint32_t level, uint32_t code)
{
    return ((ff_key)tile << 36) | ((ff_key)(level & 15u) << 32) | code;
}

static inline uint32_t ff_key_tile(ff_key key) { return (uint32_t)(key >> 36); }
static inline uint32_t ff_key_level(ff_key key) { return (uint32_t)(key >> 32) & 15u; }
static inline uint32_t ff_key_code(ff_key key) { return (uint32_t)key; }
static inline uint32_t ff_key_quadrant(ff_key key) { return (uint32_t)key & 3u; }

/* The child in `quadrant` (0..3) of a node whose level is less than FF_KEY_LEVEL_MAX; the parent of
 * a node whose level is more than 0. */
static inline ff_key ff_key_child(ff_key key, uint32_t quadrant)
{
    return ff_key_make(ff_key_tile(key), ff_key_level(key) + 1, (ff_key_code(key) << 2) | quadrant);
}
static inline ff_key ff_key_parent(ff_key key)
{
    return ff_key_make(ff_key_tile(key), ff_key_level(key) - 1, ff_key_code(key) >> 2);
}

/* Morton code of (x, y), each below 2^16, and back. */
uint32_t ff_morton_encode(uint32_t x, uint32_t y);
uint32_t ff_morton_x(uint32_t code);
uint32_t ff_morton_y(uint32_t code);

/* The node of the same level that touches `key` across `side`, found by arithmetic on the
 * interleaved bits alone. Across a tile's border it lies in the next tile; across the terrain's
 * border the answer is FF_KEY_NONE. */
ff_key ff_key_neighbour(uint32_t tiles_x, uint32_t tiles_y, ff_key key, enum ff_side side);

#endif
