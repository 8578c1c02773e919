/* What the sectors of a far set are made of: places, fins, blocks of paint.
 *
 * The horizon round O is cut into sixteen sectors of 22.5 degrees. Sector s looks level along the
 * azimuth of s sixteenths of a turn, 0 north, 4 east. Its picture plane is upright: a place that
 * lies f forward of O, r to the right and u up (f > 0) stands at column x = focal * r / f and at
 * height y = focal * u / f, both in texels from the sector's middle and from O's horizon. Ground
 * falls away from O as curved ground does (SPEC.md, curve_q60), so u is what is left of its height.
 *
 * Fins are outlines of ridges, each a line of vertices from left to right: column in whole texels,
 * height in quarters of a texel, distance f in steps of 2^(1/32). Far ones come before near ones.
 *
 * Paint is a picture in blocks of 8 x 8 texels (protocol/picture/ff_paint.h); only blocks that are
 * seen are there. With paint_shift its texels are 2^shift as large as those of the fins: focal is
 * then focal >> shift. The picture is 8 * blocks_x texels wide, and its middle column is the
 * sector's: it reaches at least a texel beyond 11.25 degrees to either side. */
#ifndef FF_FAR_H
#define FF_FAR_H

#include "../ff_error.h"

#include <stddef.h>
#include <stdint.h>

#define FF_FAR_SECTORS      16
#define FF_FAR_FOCAL_MIN    16
#define FF_FAR_FOCAL_MAX    2048
#define FF_FAR_SHIFT_MAX    3 /* of paint_shift */
#define FF_FAR_BLOCK        8
#define FF_FAR_BLOCKS_MAX   128                        /* along a row */
#define FF_FAR_ROWS_MAX     255                        /* of blocks */
#define FF_FAR_VERTICES_MAX 1024                       /* of a sector's fins */
#define FF_FAR_FINS_BYTES   (16 * FF_FAR_VERTICES_MAX) /* of those as ground has them, coded */
#define FF_FAR_DISTANCE_MAX 511
#define FF_FAR_COLUMN_MAX   1023 /* of a fin, either way */
#define FF_FAR_UP_MAX       16383

/* Half the width of a sector at a focal length, texels: focal * tan(11.25 degrees), rounded up, and
 * one more. */
static inline int32_t ff_far_half(int32_t focal) { return (focal * 13036 + 65535) / 65536 + 1; }
/* Blocks along a row of the picture: an even number, since the sector's middle is their middle. */
static inline int32_t ff_far_blocks_x(int32_t focal)
{
    return 2 * ((ff_far_half(focal) + FF_FAR_BLOCK - 1) / FF_FAR_BLOCK);
}
/* Unit vectors of a sector in world axes, Q30: forward and right, x east and y north. */
void ff_far_axes(unsigned sector, int32_t forward_q30[2], int32_t right_q30[2]);

typedef struct ff_fin_vertex {
    int16_t column;    /* texels, -half..half */
    int16_t up_q2;     /* quarter texels above O's horizon */
    uint16_t distance; /* 0..FF_FAR_DISTANCE_MAX: see ff_far_distance_wu */
    uint8_t begins;    /* 1: a fin's first vertex; every fin has two at least */
} ff_fin_vertex;

/* 64 m * 2^(step / 32), rounded down to wu. */
int32_t ff_far_distance_wu(unsigned step);
/* The nearest step, within 0..FF_FAR_DISTANCE_MAX. */
unsigned ff_far_distance_step(int32_t distance_wu);

/* Bytes written, or FF_ERR_FULL, FF_ERR_RANGE. No vertices: no bytes. FF_FAR_FINS_BYTES
 * are enough unless they leap about. */
int ff_fins_encode(const ff_fin_vertex *vertex, uint32_t count, uint8_t *out, size_t capacity);
/* Vertices, at most `room`; or FF_ERR_FORMAT, FF_ERR_RANGE, FF_ERR_FULL. Columns
 * of a fin ascend. */
int ff_fins_decode(const uint8_t *bytes, size_t byte_count, ff_fin_vertex *vertex, uint32_t room);

#endif
