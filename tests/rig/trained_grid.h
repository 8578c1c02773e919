/* Grids for codec trained's tests: ground by chance and of known shape, and a payload that both
 * decoders take, or both refuse. */
#ifndef TRAINED_GRID_H
#define TRAINED_GRID_H

#include "../../protocol/trained/ff_trained.h"

static const uint16_t max_errors[] = { 0, 1, 4, 100, 32767 };
#define MAX_ERRORS (sizeof max_errors / sizeof *max_errors)

extern uint32_t grid_random_state;
uint32_t grid_random_below(uint32_t limit);

typedef struct grid_test {
    ff_terrain_info info;
    ff_cells cells;
    int root;
    uint16_t parent[FF_NODE_HEIGHTS_MAX], source[FF_REFINED_HEIGHTS_MAX],
        decoded[FF_REFINED_HEIGHTS_MAX];
    uint8_t payload[FF_PAYLOAD_BYTES_MAX];
    size_t bytes;   /* of it */
    uint32_t count; /* residuals, of corners none */
} grid_test;

enum { FLAT, NOISE, CLIFF, CHECKER, SMOOTH, ROUGH, EXTREMES, GROUNDS };

uint32_t grid_side(const grid_test *t);
const uint16_t *grid_parent(const grid_test *t);
/* The whole of it has ground. */
void grid_set(grid_test *t, uint8_t k, int root, uint16_t max_error);
/* Beyond its ground it repeats the last sample, as decoded grids do; the parent has every other
 * sample of it. */
void grid_make(grid_test *t, int kind);
/* Bytes of the payload. */
int grid_encode(grid_test *t);
/* Both decoders take the payload and make the same of it, or both refuse it. They find in the grid
 * what the encoder has made of its sides, should some be left out, and nothing of the rest. */
int grid_decode_both(const grid_test *t, const uint8_t *payload, size_t bytes, uint16_t *heights);

#endif
