/* A second decoder of fins, written from protocol/SPEC.md and slow on
 * purpose, as slow_decoder.h is of heights: it shares the learned numbers
 * with protocol/, which are part of the format, and no code. */
#ifndef SLOW_FAR_H
#define SLOW_FAR_H

#include <stddef.h>
#include <stdint.h>

#define SLOW_FAR_VERTICES 1024

typedef struct slow_vertex {
    long begins, column, height, distance;
} slow_vertex;

/* How many vertices there are, or -1 when the bytes break a rule of the specification. */
int slow_fins(const uint8_t *bytes, size_t count, slow_vertex vertex[SLOW_FAR_VERTICES]);
/* What a step of distances stands for, in wu. */
long slow_distance(int step);

#endif
