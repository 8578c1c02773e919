/* Private to paint and to the tool that trains its tables (SPEC.md, 5.3). */
#ifndef FF_PAINT_LOCAL_H
#define FF_PAINT_LOCAL_H

#include "ff_paint.h"
#include "ff_picture_local.h"

typedef struct ff_paint_tables {
    ff_picture_tables numbers;
    uint16_t there[FF_PAINT_THERE];
} ff_paint_tables;

extern const ff_paint_tables ff_paint_learned;

/* Paint at work, both ways. */
typedef struct ff_paint {
    ff_picture picture; /* steps, decisions */
    unsigned columns, rows, count;
    ff_paint_room *room;
    const ff_paint_sink *sink;
    const ff_paint_source *source; /* the encoder's */
} ff_paint;

int ff_paint_begin(ff_paint *paint, const ff_paint_tables *by, unsigned quality);
void ff_paint_go(ff_paint *paint);
/* Step of a coefficient, in 1/16. Colour's grow with the frequency: broad tints are seen, fine ones
 * are not. */
int32_t ff_paint_step_q4(const ff_picture *p, unsigned plane, unsigned z);
/* What is left of a block, from its numbers. */
void ff_paint_left(const ff_picture *p, int32_t value[3][64]);

/* Encoder: a block's numbers. ff_paint_put.c */
void ff_paint_count_block(ff_paint *paint, unsigned column, unsigned row,
                          const ff_picture_sizes *of_left, const ff_picture_sizes *of_above,
                          uint8_t expected[64][3], int32_t value[3][64]);
/* As ff_paint_encode, by other tables, and for who trains. */
int ff_paint_put(const ff_paint_tables *by, const ff_picture_eye *eye,
                 const ff_paint_source *source, unsigned quality, ff_paint_room *room,
                 const ff_paint_sink *sink, uint8_t *out, size_t limit);

#endif
