/* Private to protocol/codec: what the two halves of the height codec share. */
#ifndef FF_CODEC_LOCAL_H
#define FF_CODEC_LOCAL_H

#include "ff_codec.h"

/* First byte of a FF_CODEC_DEFLATE or FF_CODEC_RICE payload (SPEC.md, "Payload"). */
#define FF_HEAD_BODY   0x03u /* enum ff_body */
#define FF_HEAD_ERRORS 0x0cu /* enum ff_errors_form, shifted by 2 */
/* From this bit on, the head says how many low bits of every value are stored plainly (for
 * FF_BODY_PACKED that number less one). */
#define FF_HEAD_DETAIL_SHIFT 4

enum ff_body { FF_BODY_ZERO, FF_BODY_PACKED, FF_BODY_DEFLATE, FF_BODY_UNARY };
enum ff_errors_form { FF_ERRORS_ZERO, FF_ERRORS_SAME, FF_ERRORS_EACH };

#define FF_CORNERS        4
#define FF_ERROR_CODE_MAX 208 /* 65536 steps: more than two heights can be apart */

/* Called once for every new sample, in coding order; returns its decoded height. `at` is its index
 * in the grid. */
typedef uint16_t (*ff_sample_fn)(void *context, uint32_t at, int32_t predicted);

/* Makes a root from its corners, which are already in the grid: node_log2 doublings. */
void ff_predict_root(const ff_terrain_info *info, uint16_t *grid, ff_sample_fn sample,
                     void *context);
/* Spreads a parent over the even points of a refined grid, then one doubling. */
void ff_predict_refinement(const ff_terrain_info *info, const uint16_t *parent, uint16_t *grid,
                           ff_sample_fn sample, void *context);
/* Grid index of root corner 0..3: south-west, south-east, north-west, north-east. */
uint32_t ff_corner_at(const ff_terrain_info *info, uint32_t corner);

/* Bytes of `count` values of `bits` bits each, packed. */
static inline size_t ff_packed_bytes(uint32_t count, uint32_t bits)
{
    return ((size_t)count * bits + 7) / 8;
}

/* Number of residuals in a payload, root corners included. */
static inline uint32_t ff_root_count(const ff_terrain_info *info)
{
    return ff_node_side(info) * ff_node_side(info);
}
static inline uint32_t ff_refinement_count(const ff_terrain_info *info)
{
    return ff_refined_side(info) * ff_refined_side(info) - ff_root_count(info);
}

/* Quantiser step. */
static inline int32_t ff_quantum(const ff_terrain_info *info)
{
    return 2 * (int32_t)info->max_error + 1;
}

/* A height from its prediction and quantised residual. Lossless residuals are differences modulo
 * 2^16, so that 16 bits hold them all. Lossy residuals are at most 21845, and the height is
 * clamped, which can only bring it nearer to the source. */
static inline uint16_t ff_dequantise(int32_t quantum, int32_t predicted, int32_t residual)
{
    int64_t height = predicted + (int64_t)residual * quantum;

    if (quantum == 1) return (uint16_t)height;
    return (uint16_t)(height < 0 ? 0 : height > UINT16_MAX ? UINT16_MAX : height);
}

/* log2 of the window of the deflate streams: the smallest window that covers a payload's plane of
 * high parts, one byte a value. */
static inline int ff_window_bits(const ff_terrain_info *info)
{
    int bits = 9;

    while ((1u << bits) < ff_refinement_count(info)) bits++;
    return bits;
}

#endif
