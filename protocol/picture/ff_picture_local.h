/* Private to pictures and to the tool that trains their tables (SPEC.md, 5.2).
 *
 * Every number that is coded, a coefficient or how many a block has, is expected as a weighted sum
 * of known ones. How large the sum is chooses the probabilities that the number is coded with.
 * Weights, and the probabilities that a picture begins with, are learned beforehand
 * (ff_picture_tables.c); probabilities follow each decision by a 32nd. */
#ifndef FF_PICTURE_LOCAL_H
#define FF_PICTURE_LOCAL_H

#include "../trained/ff_range.h"
#include "ff_picture.h"

#define FF_PICTURE_BLOCK 8
#define FF_PICTURE_KINDS 6 /* Y, Co, Cg of pictures with a parent, and of roots */
#define FF_PICTURE_KNOWN 5 /* numbers that a sum is of */

/* Rows of weights: of coefficients by kind and u + v; of lines by kind and u; of counts by kind. */
#define FF_PICTURE_OF_BLOCK(kind, d) ((kind)*15u + (d))
#define FF_PICTURE_OF_LINE(kind, u)  (FF_PICTURE_KINDS * 15u + (kind)*8u + (u))
#define FF_PICTURE_OF_COUNT(kind)    (FF_PICTURE_KINDS * 23u + (kind))
#define FF_PICTURE_ROWS              (FF_PICTURE_KINDS * 24u)

/* Places of probabilities: a number is not 0; it is beyond n; a count is beyond a class; its bits.
 */
#define FF_PICTURE_SCALES  24u
#define FF_PICTURE_COUNTS  16u /* scales of counts */
#define FF_PICTURE_CLASSES 7u  /* of counts, besides 0 */
#define FF_PICTURE_UNARY   14u
#define FF_PICTURE_BEYOND  (FF_PICTURE_KINDS * FF_PICTURE_SCALES)
#define FF_PICTURE_CLASS   (FF_PICTURE_BEYOND + 2u * FF_PICTURE_UNARY * FF_PICTURE_SCALES)
#define FF_PICTURE_BITS \
    (FF_PICTURE_CLASS + FF_PICTURE_KINDS * FF_PICTURE_COUNTS * FF_PICTURE_CLASSES)

FF_STATIC_ASSERT(FF_PICTURE_BITS + FF_PICTURE_KINDS * 8u * 3u == FF_PICTURE_CONTEXTS);

typedef struct ff_picture_tables {
    int16_t weight[FF_PICTURE_ROWS][FF_PICTURE_KNOWN]; /* of 256 */
    uint8_t corner[FF_PICTURE_KINDS];                  /* scales of the corners' numbers */
    uint16_t one[FF_PICTURE_CONTEXTS];                 /* what a picture begins with */
} ff_picture_tables;

extern const ff_picture_tables ff_picture_learned;

/* Who trains sees what is expected of numbers, and decisions. */
typedef struct ff_picture_eye {
    void *context;
    void (*number)(void *context, unsigned row, const int32_t known[FF_PICTURE_KNOWN],
                   int32_t size);
    void (*corner)(void *context, unsigned kind, int32_t size);
    void (*decision)(void *context, unsigned place, unsigned bit);
} ff_picture_eye;

/* A picture at work: both ways, so that they cannot differ. */
typedef struct ff_picture {
    const ff_picture_tables *by;
    unsigned side, root;  /* texels; 3 for roots, else 0 */
    int32_t step_q4[3];   /* of Y, Co and Cg */
    unsigned column, row; /* of the lattice of the parent's children: the south-west texel's */
    const uint8_t *parent;
    ff_picture_room *room;
    uint16_t *one; /* the room's */
    uint8_t *rgb;
    ff_range range;
    /* the encoder's; NULL: this is the decoder */
    ff_range_writer *to;
    const uint8_t *source;
    const ff_picture_eye *eye;
    uint32_t *cost; /* only asks what decisions take: 256ths of a bit are added here; else NULL */
} ff_picture;

/* A corner's steps are 4 times as fine, those of an eight's mean twice: on even ground a line must
 * not be farther off than the blocks beside it. As powers of two. */
#define FF_PICTURE_CORNER_FINER 2
#define FF_PICTURE_MEAN_FINER   1

/* At most 8 x 8 texels. */
typedef struct ff_picture_part {
    unsigned x, y, width, height;
} ff_picture_part;

/* Texels before what is left is added. ff_picture_expect.c */
void ff_picture_expect(const ff_picture *p, ff_picture_part part, uint8_t rgb[64][3]);
/* The same of texels of roots on a line between two corners. */
void ff_picture_between(const ff_picture *p, ff_picture_part part, uint8_t rgb[64][3]);
/* Where texel (x, y) from the south-west is in an image. */
static inline size_t ff_picture_at(const ff_picture *p, unsigned x, unsigned y)
{
    return ((size_t)(p->side - 1 - y) * p->side + x) * 3;
}

static inline int16_t ff_picture_coefficient(int32_t value, int32_t step_q4)
{
    int32_t whole = value * step_q4;
    return (int16_t)(whole < -INT16_MAX ? -INT16_MAX : whole > INT16_MAX ? INT16_MAX : whole);
}

static inline uint8_t ff_picture_byte(int32_t value)
{
    return (uint8_t)(value < 0 ? 0 : value > 255 ? 255 : value);
}

/* Adds what is left, Y, Co and Cg, to what was expected. */
static inline void ff_picture_add(const uint8_t from[3], int32_t luma, int32_t co, int32_t cg,
                                  uint8_t rgb[3])
{
    rgb[0] = ff_picture_byte(from[0] + luma + co - cg);
    rgb[1] = ff_picture_byte(from[1] + luma + cg);
    rgb[2] = ff_picture_byte(from[2] + luma - co - cg);
}

/* What is left of 8 x 8 texels, and of 8 in a line, from coefficients in steps of 1/16.
 * ff_picture_cosine.c */
void ff_picture_block(const int16_t coefficient[64], int32_t left[64]);
void ff_picture_line(const int16_t coefficient[8], int32_t left[8]);

/* Numbers, and a block's, to and from the range coder; of a block's how many are told, by those of
 * the blocks west and south, NULL where there are none. ff_picture_numbers.c */
extern const uint8_t ff_picture_zigzag[64];
unsigned ff_picture_decide(ff_picture *p, uint16_t *one, unsigned bit);
int32_t ff_picture_number(ff_picture *p, unsigned kind, unsigned scale, int32_t value);
unsigned ff_picture_scale(const ff_picture *p, unsigned row, const int32_t known[FF_PICTURE_KNOWN]);
unsigned ff_picture_numbers(ff_picture *p, unsigned plane, const ff_picture_sizes *west,
                            const ff_picture_sizes *south, int32_t value[64],
                            ff_picture_sizes *here);
void ff_picture_see(const ff_picture *p, unsigned row, const int32_t known[FF_PICTURE_KNOWN],
                    int32_t size);

/* Step of a quality, in 1/16; 0: there is no such quality. */
int32_t ff_picture_step_q4(unsigned quality);
/* Both halves: begins, and goes through all lines and blocks. ff_picture.c */
int ff_picture_begin(ff_picture *p, unsigned log2, unsigned quality, ff_picture_above above);
void ff_picture_go(ff_picture *p);

/* Encoder: the numbers of a part of the source, in steps. ff_picture_put.c */
void ff_picture_count_block(const ff_picture *p, ff_picture_part part, uint8_t expected[64][3],
                            int32_t value[3][64]);
void ff_picture_count_line(const ff_picture *p, ff_picture_part part, uint8_t expected[64][3],
                           int32_t value[3][64]);
void ff_picture_count_corner(const ff_picture *p, ff_picture_part part, uint8_t expected[64][3],
                             int32_t value[3][64]);
/* What is left of a block's texels, each channel times 4, as numbers; dead_256: of a step, besides
 * its half, that becomes 0. */
void ff_picture_steps(const ff_picture *p, int32_t left[64][3], int dead_256, int32_t value[3][64]);
/* The same as coefficients, in sixteenths times 2^FF_PICTURE_ONE_LOG2. */
#define FF_PICTURE_ONE_LOG2 15 /* the transform's rows, squared */
void ff_picture_coefficients(int32_t left[64][3], int64_t whole[3][64]);
/* As ff_picture_encode, by other tables, and for who trains. */
int ff_picture_put(const ff_picture_tables *by, const ff_picture_eye *eye, const uint8_t *source,
                   unsigned log2, ff_picture_above above, unsigned quality, ff_picture_room *room,
                   uint8_t *rgb, uint8_t *out, size_t limit);

#endif
