/* Paint: pictures of far ground, of which only some blocks are there (SPEC.md, 5.3).
 *
 * The coder of pictures (ff_picture.h) without anything above: blocks of 8 x 8 texels, row by row
 * from the top, each from the left. Of each it is told whether it is there; if so, it is expected
 * from the texels left of it and above it, and what is left is coded as in a picture, by numbers of
 * its own (ff_paint_tables.c). Nothing else is kept than the last row of blocks. */
#ifndef FF_PAINT_H
#define FF_PAINT_H

#include "ff_picture.h"

#define FF_PAINT_BLOCK 8
#define FF_PAINT_THERE 16 /* contexts of whether a block is there */

/* The last block of a column: its lowest texels, and numbers; and whether it is there. */
typedef struct ff_paint_column {
    ff_picture_sizes sizes;
    uint8_t edge[FF_PAINT_BLOCK][3];
    uint8_t there;
} ff_paint_column;

/* Memory that coding takes: ff_paint_room_bytes(columns). */
typedef struct ff_paint_room {
    uint16_t one[FF_PICTURE_CONTEXTS], there[FF_PAINT_THERE];
    ff_picture_sizes before;
    uint8_t edge[FF_PAINT_BLOCK][3]; /* of the block before, its rightmost texels */
    ff_paint_column column[];
} ff_paint_room;

static inline size_t ff_paint_room_bytes(unsigned columns)
{
    return sizeof(ff_paint_room) + columns * sizeof(ff_paint_column);
}

/* Who takes a block that is there: its texels row by row from the top. */
typedef struct ff_paint_sink {
    void *context;
    void (*block)(void *context, unsigned column, unsigned row, uint8_t rgb[64][3]);
} ff_paint_sink;

/* How many blocks are there, or an error, when what the sink got is of no use. */
int ff_paint_decode(const uint8_t *bytes, size_t count, unsigned columns, unsigned rows,
                    ff_paint_room *room, const ff_paint_sink *sink);

/* Encoder: a picture of whole blocks, top row first, and which are there, a byte each, row by row.
 * Texels that do not matter are best filled smoothly. */
typedef struct ff_paint_source {
    unsigned columns, rows;
    const uint8_t *there, *rgb;
} ff_paint_source;

/* Bytes written, or an error; what decoding makes of them goes to the sink. Quality 1..100. */
int ff_paint_encode(const ff_paint_source *source, unsigned quality, ff_paint_room *room,
                    const ff_paint_sink *sink, uint8_t *out, size_t limit);

#endif
