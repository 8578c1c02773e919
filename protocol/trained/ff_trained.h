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

/* Who makes the points. */
typedef struct ff_points {
    /* Returns a point's height. */
    uint16_t (*height)(void *context, const ff_expected *point);
    /* Of a refinement, or NULL: a side's points come next, so many; with FF_SIDE_COUNT all that
     * are on none. 1: those of the side are in the grid already, and none is asked for. */
    int (*side)(void *context, unsigned side, uint32_t points);
    /* or NULL: of the last doubling a fourth and more is made; 0: the rest is not wanted */
    int (*go_on)(void *context);
    void *context;
} ff_points;

/* As ff_predict_fn, by weights of number `set`. Without errors, how far points were from what was
 * expected, only ff_expected.at and predicted are told. `room`: ff_codec_room() bytes. */
void ff_expect(const ff_trained *by, unsigned set, const ff_terrain_info *info, ff_cells cells,
               const uint16_t *parent, uint16_t *grid, int with_errors, void *room,
               const ff_points *points);
/* Encoder: the closed loop and a body in one. Of a grid, with its corners where it is a root's, the
 * residuals of all other points of `source`, and what is decoded. `apart`, of a refinement: sides
 * as streams of their own. `half`, or NULL: receives the bytes when the middles of the last
 * doubling begin; if it was not 0, and they are more, the rest is given up. Bytes of the body,
 * without corners; FF_TRAINED_BODY_MAX, of which `out` has room: it takes no fewer, or a side more
 * than its length can tell; SIZE_MAX: given up. */
size_t ff_trained_put(const ff_trained *by, unsigned set, const ff_terrain_info *info,
                      ff_cells cells, const uint16_t *parent, const ff_source_heights *source,
                      int32_t *residual, uint16_t *decoded, int apart, uint8_t *out,
                      uint16_t *half);

/* ---- payloads (SPEC.md, "Payload, codec 3") ---- */

#define FF_TRAINED_WORDS       0x01u
#define FF_TRAINED_SET_SHIFT   1
#define FF_TRAINED_SET         (1u << FF_TRAINED_SET_SHIFT)
#define FF_TRAINED_SIDES_SHIFT 4 /* bit s: side s is left out */
#define FF_TRAINED_SIDES       0xf0u
/* sides have streams of their own, and their lengths are left out; a refinement is one stream */
#define FF_TRAINED_ALL (FF_TRAINED_WORDS | FF_TRAINED_SIDES)
#define FF_TRAINED_ONE (FF_TRAINED_WORDS | 1u << FF_TRAINED_SIDES_SHIFT)

#define FF_TRAINED_BODY_MAX (2 * FF_REFINED_HEIGHTS_MAX)
FF_STATIC_ASSERT(FF_TRAINED_BODY_MAX < FF_PAYLOAD_BYTES_MAX);

/* The lengths of four sides take so many bytes; each so many bits. */
static inline unsigned ff_trained_length_bits(const ff_terrain_info *info)
{
    return info->node_log2 + 1u;
}
static inline size_t ff_trained_lengths(const ff_terrain_info *info)
{
    return (4 * (size_t)ff_trained_length_bits(info) + 7) / 8;
}
/* The first one's lie lowest. */
static inline void ff_trained_lengths_of(const ff_terrain_info *info, const uint8_t *bytes,
                                         uint8_t length[4])
{
    uint32_t all = 0, width = ff_trained_length_bits(info);
    FF_ASSERT(4 * width <= 32 && 8 * ff_trained_lengths(info) >= 4 * width);
    for (size_t i = 0; i < ff_trained_lengths(info); i++) all |= (uint32_t)bytes[i] << 8 * i;
    for (unsigned i = 0; i < 4; i++, all >>= width)
        length[i] = (uint8_t)(all & ((1u << width) - 1));
}
/* For who trains: the known heights that a point's mean comes from, and the measures that its
 * distance comes from. How many there are. */
uint32_t ff_trained_known(const ff_expected *p, int32_t known[FF_TRAINED_TAPS]);
uint32_t ff_trained_traits(const ff_expected *p, int32_t trait[FF_TRAINED_TRAITS]);

#endif
