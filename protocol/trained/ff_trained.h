/* Private to codec trained and to the tool that trains it: what is expected of every new height
 * (SPEC.md, "Expectation").
 *
 * A new height is expected at a weighted mean of known ones around it, and as far from that as a
 * weighted sum of how rough they are says. Weights, and how often what follows from such a
 * distance, are learned beforehand, from much ground: tools/train, ff_trained_tables.c. Nothing is
 * learned from a payload.
 *
 * A doubling makes its points in this order: R, the four sides of the grid; N, centres beside a
 * side; C, all other centres; H and V, points between two known ones of a row or of a column. */
#ifndef FF_TRAINED_H
#define FF_TRAINED_H

#include "../codec/ff_codec_local.h"

enum ff_trained_class { FF_POINT_R, FF_POINT_N, FF_POINT_C, FF_POINT_H, FF_POINT_V, FF_POINTS };

#define FF_TRAINED_SETS        2  /* of weights: a payload says by which it was made */
#define FF_TRAINED_TAPS        20 /* known heights that weigh in, at most */
#define FF_TRAINED_TRAITS      8  /* measures of roughness, at most */
#define FF_TRAINED_BUCKETS     7  /* by roughness */
#define FF_TRAINED_SCALES      48
#define FF_TRAINED_CLASSES     16 /* of a value: numbers of as many bits */
#define FF_TRAINED_TAPS_LOG2   14
#define FF_TRAINED_TRAITS_LOG2 12

typedef struct ff_taps {
    int16_t tap[FF_TRAINED_TAPS];
    int32_t sum; /* of them */
} ff_taps;

typedef struct ff_weights {
    ff_taps taps[FF_POINTS][FF_TRAINED_BUCKETS];
    int16_t trait[FF_POINTS][FF_TRAINED_TRAITS];
} ff_weights;

typedef struct ff_trained {
    ff_weights weights[FF_TRAINED_SETS];
    /* of 65536, how often a decision is 1: the value is as expected; it is beyond class c */
    uint16_t zero[FF_TRAINED_SCALES], beyond[FF_TRAINED_CLASSES - 1][FF_TRAINED_SCALES];
    /* it lies below, by where in its step what is expected lies */
    uint16_t below[4][FF_TRAINED_SCALES];
    /* the highest bits of a value of a class, below the first one: the second and the third */
    uint16_t second[FF_TRAINED_CLASSES][FF_TRAINED_SCALES],
        third[2 * FF_TRAINED_CLASSES][FF_TRAINED_SCALES];
} ff_trained;

extern const ff_trained ff_trained_tables;

/* What is known of a point beforehand. */
typedef struct ff_expected {
    uint32_t at;       /* its index in the grid */
    int32_t predicted; /* its height when its residual is 0 */
    int32_t residual;  /* the likeliest one */
    uint8_t scale;     /* how far it may be from that, as a row of ff_trained's */
    uint8_t phase;     /* a row of ff_trained.below */
    /* for who trains: what it comes from, see ff_trained_known */
    uint8_t kind, bucket; /* enum ff_trained_class; row of ff_weights.taps */
    int32_t base_q2, mean_q4, distance_q4, quantum;
    const uint16_t *height;
    const uint8_t *error;
    int32_t along, away;
    uint32_t error_shift;
} ff_expected;

/* Returns a point's height. */
typedef uint16_t ff_expected_fn(void *context, const ff_expected *point);

/* As ff_predict_fn, by weights of number `set`. Without errors, how far points were from what was
 * expected, only ff_expected.at and predicted are told. `room`: ff_codec_room() bytes. */
void ff_expect(const ff_trained *by, unsigned set, const ff_terrain_info *info, ff_cells cells,
               const uint16_t *parent, uint16_t *grid, int with_errors, void *room,
               ff_expected_fn *sample, void *context);
/* Encoder: the stream of a grid's residuals, of corners none. Bytes; `limit`: it takes no fewer. */
size_t ff_trained_stream(const ff_trained *by, unsigned set, const ff_terrain_info *info,
                         ff_cells cells, const uint16_t *parent, const uint16_t *decoded,
                         const int32_t *residual, uint8_t *out, size_t limit);
/* For who trains: the known heights that a point's mean comes from, and the measures that its
 * distance comes from. How many there are. */
uint32_t ff_trained_known(const ff_expected *p, int32_t known[FF_TRAINED_TAPS]);
uint32_t ff_trained_traits(const ff_expected *p, int32_t trait[FF_TRAINED_TRAITS]);

#endif
