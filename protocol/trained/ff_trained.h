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
#include "ff_tail.h"

enum ff_trained_class { FF_POINT_R, FF_POINT_N, FF_POINT_C, FF_POINT_H, FF_POINT_V, FF_POINTS };

#define FF_TRAINED_SETS        2  /* of weights: a payload says by which it was made */
#define FF_TRAINED_TAPS        20 /* known heights that weigh in, at most */
#define FF_TRAINED_TRAITS      8  /* measures of roughness, at most */
#define FF_TRAINED_BUCKETS     7  /* by roughness */
#define FF_TRAINED_SCALES      48
#define FF_TRAINED_CLASSES     16 /* of a value: numbers of as many bits */
#define FF_TRAINED_TAPS_LOG2   14
#define FF_TRAINED_TRAITS_LOG2 12

/* Taps together are less than 2^15, whatever their signs, so that sums of them by heights fit 32
 * bits. So do sums of traits: from the third on none is more than FF_TRAINED_TRAIT_MAX. */
#define FF_TRAINED_TRAIT_MAX (2 * 255 << 11)
typedef struct ff_taps {
    int16_t tap[FF_TRAINED_TAPS];
    int32_t sum; /* of them */
} ff_taps;

typedef struct ff_weights {
    ff_taps taps[FF_POINTS][FF_TRAINED_BUCKETS];
    int16_t trait[FF_POINTS][FF_TRAINED_TRAITS];
} ff_weights;

/* Of 65536, how often a decision is 1. */
typedef struct ff_odds {
    uint16_t zero;                           /* the value is as expected */
    uint16_t below[4];                       /* it lies below, by ff_expected.phase */
    uint16_t beyond[FF_TRAINED_CLASSES - 1]; /* it is beyond class c */
    uint16_t second[FF_TRAINED_CLASSES];     /* of a value of a class: its second bit from above */
    uint16_t third[2 * FF_TRAINED_CLASSES];  /* its third one: 2 c and the second */
} ff_odds;
#define FF_TRAINED_DECISIONS (sizeof(ff_odds) / sizeof(uint16_t))

typedef struct ff_trained {
    ff_weights weights[FF_TRAINED_SETS];
    ff_odds odds[FF_TRAINED_SCALES];
} ff_trained;

extern const ff_trained ff_trained_tables;

/* What is known of a point beforehand. */
typedef struct ff_expected {
    int32_t predicted; /* its height when its residual is 0 */
    int32_t residual;  /* the likeliest one */
    uint8_t scale;     /* how far it may be from that, as a row of ff_trained.odds */
    uint8_t phase;     /* where in its step what is expected lies */
    /* for who trains: what it comes from, see ff_trained_known */
    uint8_t kind, bucket; /* enum ff_trained_class; row of ff_weights.taps */
    int32_t mean_q4, distance_q4, quantum;
    int32_t along, away;
    uint32_t error_shift;
    const uint16_t *height; /* in a copy of the grid's points, FF_TRAINED_PITCH to a row */
    const uint16_t *first;  /* of the copy */
    const uint8_t *error;   /* the same of how far points were from what was expected */
    uint32_t side, step;    /* the grid's points of a row, of which every `step` are in the copy */
} ff_expected;

#define FF_TRAINED_MARGIN 2 /* points beyond a side that are looked at */
/* The same whatever the nodes' size: places around a point lie at known distances. */
#define FF_TRAINED_PITCH ((2 << FF_NODE_LOG2_MAX) + 1 + 2 * FF_TRAINED_MARGIN)

/* Its index in the grid. */
static inline uint32_t ff_expected_at(const ff_expected *p)
{
    uint32_t place = (uint32_t)(p->height - p->first), row = place / FF_TRAINED_PITCH;
    return (row * p->side + place % FF_TRAINED_PITCH) * p->step;
}

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

/* As ff_predict_fn, by weights of number `set`. `room`: ff_codec_room() bytes. */
void ff_expect(const ff_trained *by, unsigned set, const ff_terrain_info *info, ff_cells cells,
               const uint16_t *parent, uint16_t *grid, void *room, const ff_points *points);
/* ---- payloads (SPEC.md, "Payload, codec 3") ---- */

#define FF_TRAINED_SIDES 15u /* bit s: side s is left out */

/* The most bits of a side's stream. */
static inline uint32_t ff_trained_side_bits(const ff_terrain_info *info)
{
    return 16u << info->node_log2;
}
/* Of the number that tells how many it has. */
static inline unsigned ff_trained_length_order(const ff_terrain_info *info)
{
    return info->node_log2 + 1u;
}

/* The head: what a payload tells of its children, its set as `way`, its form as `apart`, and its
 * sides. FF_OK, or FF_ERR_TRUNCATED, FF_ERR_FORMAT, FF_ERR_RANGE. */
int ff_trained_take_head(const ff_terrain_info *info, int root, ff_tail *tail, ff_residuals *out);
void ff_trained_put_head(const ff_terrain_info *info, int root, const ff_residuals *res,
                         ff_bits *to);

/* Passes lengths, and the sides they are of. FF_OK, FF_ERR_TRUNCATED, FF_ERR_FORMAT. */
int ff_trained_pass_sides(const ff_terrain_info *info, ff_tail *tail);

/* Bytes of a stream; a side's, that of all else. */
#define FF_TRAINED_SIDE_BYTES (2 << FF_NODE_LOG2_MAX)
#define FF_TRAINED_BODY_MAX   (2 * FF_REFINED_HEIGHTS_MAX)
FF_STATIC_ASSERT(FF_TRAINED_BODY_MAX < FF_PAYLOAD_BYTES_MAX);

/* Streams of sides, each from its first byte on. */
typedef struct ff_trained_sides {
    uint32_t bits[FF_SIDE_COUNT];
    uint8_t bytes[FF_SIDE_COUNT][FF_TRAINED_SIDE_BYTES + 4]; /* a writer goes a little beyond */
} ff_trained_sides;

static inline uint32_t ff_trained_bits_of(const ff_trained_sides *sides)
{
    return sides->bits[0] + sides->bits[1] + sides->bits[2] + sides->bits[3];
}

/* Encoder: the closed loop and a body in one. Of a grid, with its corners where it is a root's, the
 * residuals of all other points of `source`, and what is decoded. `sides`, of a refinement, or
 * NULL: receives those as streams of their own. `half`, or NULL: receives the bytes when the
 * middles of the last doubling begin; if it was not 0, and they are more, the rest is given up.
 * Bits of the stream at `out`, which has room for FF_TRAINED_BODY_MAX bytes. */
#define FF_TRAINED_GIVEN_UP UINT32_MAX
#define FF_TRAINED_FULL     (8u * FF_TRAINED_BODY_MAX) /* it takes no fewer, or a side too many */
uint32_t ff_trained_put(const ff_trained *by, unsigned set, const ff_terrain_info *info,
                        ff_cells cells, const uint16_t *parent, const ff_source_heights *source,
                        int32_t *residual, uint16_t *decoded, ff_trained_sides *sides, uint8_t *out,
                        uint16_t *half);

/* For who trains: the known heights that a point's mean comes from, and four times that which they
 * are told from; the measures that its distance comes from. How many there are. */
uint32_t ff_trained_known(const ff_expected *p, int32_t known[FF_TRAINED_TAPS], int32_t *base_q2);
uint32_t ff_trained_traits(const ff_expected *p, int32_t trait[FF_TRAINED_TRAITS]);

#endif
