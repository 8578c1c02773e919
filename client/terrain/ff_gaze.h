/* A look at drawn ground in squares: which of them the picture shows, how large they are in it and
 * what nearer ground hides. For the estimates of the picture (ff_estimate.h) only. */
#ifndef FF_GAZE_H
#define FF_GAZE_H

#include "ff_estimate.h"
#include "ff_spread.h"
#include "ff_tree_local.h"

/* Lengths are in units of 16 wu from the eye: 2^33 wu fit 32 bits, and their products 64. */
#define FF_GAZE_UNIT_LOG2 4
#define FF_GAZE_SECTORS   32 /* round the eye, that ground may hide ground in */

typedef struct ff_gaze {
    const ff_tree *tree;
    ff_spread spread;
    int32_t rotation_q14[3][3];           /* rows: right, up, forward */
    int32_t half_q8[2];                   /* of the picture, pixels */
    int64_t normal_q8[2];                 /* length of the normals of its sides */
    int32_t horizon_q12[FF_GAZE_SECTORS]; /* the steepest slope up to ground seen so far */
    uint8_t under;                        /* 1: the eye is below the drawn ground */
    uint64_t cell_pixels_q4;              /* of the cell being looked at */
    uint16_t cell[2];
    struct ff_far_sum *far; /* what is counted of far ground; NULL: nobody asks */
} ff_gaze;

/* A piece of ground: its corners (south-west, south-east, north-west, north-east), and what is
 * found of it. */
typedef struct ff_square {
    int32_t corner[4][3], middle[3], eye[3];
    int64_t away, wide;
    int64_t inverse_q40; /* of the depth */
} ff_square;

enum ff_sight { FF_UNSEEN, FF_TOO_WIDE, FF_SEEN };

static inline int64_t size_of(int64_t value) { return value < 0 ? -value : value; }

static inline int64_t within(int64_t value, int64_t most)
{
    return value > most ? most : value < -most ? -most : value;
}

/* Length of a vector, at most 8 % off. */
static inline int64_t about_length(int64_t x, int64_t y, int64_t z)
{
    int64_t a = size_of(x), b = size_of(y), c = size_of(z), most = a > b ? a : b;
    most = most > c ? most : c;
    return most + (a + b + c - most) * 5 / 16;
}

/* Finds what of the picture a square is; `may_split`: one that is too wide for its distance is not
 * looked at whole. */
enum ff_sight ff_gaze_look(const ff_gaze *at, ff_square *s, int may_split);
/* Of a length across the line of sight at the square: pixels Q8. */
int64_t ff_gaze_pixels_q8(const ff_gaze *at, const ff_square *s, int64_t length);
/* How many pixels the square covers, Q4: half the product of its diagonals as seen; at least what
 * it would cover if it were tilted by 1 in `tilt` (0: not at all) towards the viewer. */
uint32_t ff_gaze_covers_q4(const ff_gaze *at, const ff_square *s, int tilt);
unsigned ff_gaze_sector(const ff_square *s);
int32_t ff_gaze_slope_q12(const ff_square *s);
/* An eye where the last selection's camera is. */
void ff_gaze_open(ff_gaze *at, const ff_tree *tree);
/* ff_estimate.c: counts a drawn node. */
void ff_gaze_node(ff_gaze *at, const ff_drawn *drawn);
/* ff_estimate_far.c: counts a square of drawn ground that nothing before it hides, of so many
 * pixels Q4, off by 2^error_log_q8 pixels Q8. */
void ff_gaze_far(ff_gaze *at, const ff_square *s, uint32_t pixels_q4, int32_t error_log_q8);
/* ff_estimate_beyond.c: counts what lies beyond the drawn ground, once that has been looked at. */
void ff_gaze_beyond(ff_gaze *at, const ff_beyond *beyond);

#endif
