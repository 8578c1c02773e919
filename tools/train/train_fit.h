/* Weights by least squares, and probabilities by counting. */
#ifndef TRAIN_FIT_H
#define TRAIN_FIT_H

#include "../../protocol/trained/ff_trained.h"

/* A point that is made. */
typedef struct train_point {
    const ff_terrain_info *info;
    const ff_expected *expected;
    int32_t height, residual;
    unsigned set; /* of weights that it is made by */
    double share; /* how much it counts */
} train_point;

/* Sums of products, of a set of weights: of taps and the height they are to give, of traits and the
 * distance. */
typedef struct train_sums {
    double tap[FF_POINTS][FF_TRAINED_BUCKETS][FF_TRAINED_TAPS][FF_TRAINED_TAPS + 1];
    double trait[FF_POINTS][FF_TRAINED_TRAITS][FF_TRAINED_TRAITS + 1];
} train_sums;

/* Of each decision: how often it was 0, and 1. */
typedef struct train_counts {
    double of[FF_TRAINED_SCALES][FF_TRAINED_DECISIONS][2]; /* as in ff_odds */
} train_counts;

void train_begin(ff_trained *tables); /* what the first round goes by */
void train_sum(train_sums sums[FF_TRAINED_SETS], const train_point *point);
/* Of all sets; changes the sums. */
void train_weights(train_sums sums[FF_TRAINED_SETS], ff_trained *tables);
/* 1: sums of them fit 32 bits, see ff_taps. */
int train_weights_fit(const ff_trained *tables);
void train_count(train_counts *counts, const train_point *point);
/* How many bits a residual takes. */
double train_bits(const ff_trained *tables, const ff_expected *p, int32_t residual);
void train_probabilities(train_counts *counts, ff_trained *tables);

#endif
