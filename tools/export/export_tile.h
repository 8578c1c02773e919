/* One map tile as it is made: floats, and what they are; and as an image. */
#ifndef EXPORT_TILE_H
#define EXPORT_TILE_H

#include "export_encoding.h"
#include "export_ground.h"
#include "export_options.h"

#define EXPORT_TILE_SIDE  256
#define EXPORT_TILE_CELLS (EXPORT_TILE_SIDE * EXPORT_TILE_SIDE)

typedef struct export_tile {
    int bands;                         /* 1: metres; 3: colours, 0 .. 255 */
    float value[3][EXPORT_TILE_CELLS]; /* row 0 north; [0] alone of heights */
    uint8_t mask[EXPORT_TILE_CELLS];   /* enum export_cell */
} export_tile;

/* How tiles become images. */
typedef struct export_paint {
    const export_encoding *encoding; /* of heights; NULL: colours */
    int is_jpeg, jpeg_quality;       /* else PNG */
    int clear_beyond, clear_filled;  /* those cells become clear: PNG alone */
} export_paint;

/* 1 when a cell is no ground to average, or to be judged. */
int export_tile_is_void(const export_paint *paint, uint8_t cell);
/* Puts a tile into a quadrant (0 and 1 north, 0 and 2 west) of its parent, four cells to one:
 * their mean, over ground alone where there is some. */
void export_tile_shrink(const export_paint *paint, const export_tile *child, int quadrant,
                        export_tile *parent);
/* Makes a quadrant NAN, and beyond the ground. */
void export_tile_clear(export_tile *tile, int quadrant);
/* The tile as a file in memory to be freed by VSIFree, or NULL (said). */
uint8_t *export_tile_paint(const export_paint *paint, const export_tile *tile, size_t *count);

#endif
