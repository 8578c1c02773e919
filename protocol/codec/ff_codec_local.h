/* Private to protocol/: what a codec is made of (a row of ff_codec_list.h), and what all codecs
 * share. */
#ifndef FF_CODEC_LOCAL_H
#define FF_CODEC_LOCAL_H

#include "ff_codec.h"

#define FF_CORNERS           4
#define FF_ERROR_CODE_MAX    208 /* 65536 steps: as far apart as two heights can be, and more */
#define FF_DECODER_ALIGNMENT 16u

/* ff_geometric_error_decode(FF_ERROR_CODE_MAX). */
FF_STATIC_ASSERT((16 + FF_ERROR_CODE_MAX % 16) << (FF_ERROR_CODE_MAX / 16 - 1) == UINT16_MAX + 1);
FF_STATIC_ASSERT((FF_DECODER_ALIGNMENT & (FF_DECODER_ALIGNMENT - 1)) == 0);

/* ---- a codec ---- */

/* What is left of a payload. */
typedef struct ff_payload {
    const uint8_t *at, *end;
} ff_payload;

static inline size_t ff_payload_left(const ff_payload *in)
{
    FF_ASSERT(in->at <= in->end);
    return (size_t)(in->end - in->at);
}

/* What a payload tells. A root: one error code, four corners, residuals; a refinement: four error
 * codes, residuals. */
typedef struct ff_contents {
    uint32_t errors;
    uint32_t corners;
    uint32_t count; /* values in all, corners included */
} ff_contents;

/* Bytes of decoder memory for this terrain; when `memory` (so many bytes, aligned for any type) is
 * given, it is made ready. FF_ERR_MEMORY when it cannot be. */
typedef int32_t ff_memory_fn(const ff_terrain_info *info, void *memory);
/* Takes error codes, corners and residuals off the payload. What it leaves makes the payload one of
 * FF_ERR_FORMAT; out->count is set already, out->value has room for ff_refined_side()^2 values. */
typedef int ff_decode_fn(const ff_decoder *dec, ff_payload *in, const ff_contents *contents,
                         ff_residuals *out);
/* Called once for every new sample, in coding order; returns its decoded height. `at` is its index
 * in the grid. */
typedef uint16_t (*ff_sample_fn)(void *context, uint32_t at, int32_t predicted);
/* Makes a grid's new samples: a root's from its corners, which are in the grid; `parent` not NULL:
 * a refinement's. `way`: which of the codec's predictions, 0 where there is no payload. */
typedef void ff_predict_fn(const ff_terrain_info *info, ff_cells cells, unsigned way,
                           const uint16_t *parent, uint16_t *grid, void *room, ff_sample_fn sample,
                           void *context);
/* `parent` NULL: a root. */
typedef int ff_reconstruct_fn(const ff_terrain_info *info, const uint16_t *parent,
                              const ff_residuals *res, uint16_t *heights, void *room);
/* Bytes written. `decoded`: the heights that the residuals lead to, for contexts. */
typedef size_t ff_encode_fn(const ff_terrain_info *info, const uint16_t *parent,
                            const uint16_t *decoded, const ff_contents *contents,
                            const ff_residuals *res, uint8_t *out);

/* The true grid: heights, and NULL or a byte beside each, not 0 where what is predicted will do. */
typedef struct ff_source_heights {
    const uint16_t *height;
    const uint8_t *between;
} ff_source_heights;
/* Encoder: residuals and heights by prediction out->way, and what is coded of them. A root's
 * corners are there already. out->body_half not 0: where a part of it takes more bytes than that,
 * the rest is not made, and body_bits is UINT32_MAX. */
typedef void ff_make_fn(const ff_terrain_info *info, const uint16_t *parent,
                        const ff_source_heights *source, ff_residuals *out, uint16_t *decoded);

/* A row of the list, without the encoder: that one costs a device nothing. */
typedef struct ff_codec {
    const char *name;
    uint32_t needs; /* enum ff_codec_needs */
    ff_memory_fn *memory;
    ff_decode_fn *decode;
    ff_predict_fn *predict;
    ff_reconstruct_fn *reconstruct;
} ff_codec;

/* NULL, or 0, when no row has this number. They alone stand in ff_codec_table.c, so that a test can
 * link a longer table in place of that file. */
const ff_codec *ff_codec_row(int codec);
ff_encode_fn *ff_codec_encoder(int codec);
ff_make_fn *ff_codec_maker(int codec);
/* Bytes before the error codes of an encoded payload. */
size_t ff_codec_head(int codec);
/* Predictions that an encoder has to choose from. */
unsigned ff_codec_ways(int codec);

/* clang-format off */
#define ROW(number, constant, name, needs, head, ways, memory, decode, predict, reconstruct, make, encode) \
    ff_memory_fn memory; ff_decode_fn decode; ff_predict_fn predict; ff_reconstruct_fn reconstruct; ff_make_fn make; ff_encode_fn encode;
/* clang-format on */
FF_CODEC_LIST(ROW)
#undef ROW

struct ff_decoder {
    ff_terrain_info info;
    const ff_codec *codec;
    uint8_t *memory; /* the codec's own */
};

static inline size_t ff_align_up(size_t bytes)
{
    return (bytes + FF_DECODER_ALIGNMENT - 1) & ~(size_t)(FF_DECODER_ALIGNMENT - 1);
}

/* 0: the build has left protocol/trained out. */
extern const uint8_t ff_trained_built;
/* Codec trained's ff_without_sides, ff_read_marks and ff_mark_stubs. */
int ff_trained_without_sides(const ff_terrain_info *info, const uint8_t *payload, size_t bytes,
                             unsigned sides, uint8_t *out);
int ff_trained_read_marks(const ff_terrain_info *info, int root, const uint8_t *payload,
                          size_t bytes, ff_residuals *out);
int ff_trained_mark_stubs(const ff_terrain_info *info, int root, const uint8_t *payload,
                          size_t bytes, uint8_t stub, uint8_t *out);

/* ---- parts of payloads that codecs share ---- */

/* How error codes are stored: none (all are 0), one for all, each, or none and all children are
 * leaves. Before codes that are stored may stand a byte of FF_STUB and ff_residuals.stub, then one
 * of FF_LEAF and ff_residuals.leaf, then one of FF_FILLED and ff_residuals.filled. */
enum ff_errors_form { FF_ERRORS_ZERO, FF_ERRORS_SAME, FF_ERRORS_EACH, FF_ERRORS_LEAF };
#define FF_STUB   0xd0u
#define FF_LEAF   0xe0u
#define FF_FILLED 0xf0u
/* Without a bit a byte of FF_STUB is the largest error code. */
FF_STATIC_ASSERT(FF_STUB >= FF_ERROR_CODE_MAX);
FF_STATIC_ASSERT(FF_LEAF == FF_STUB + 16 && FF_FILLED == FF_LEAF + 16);

/* Sets child_error, stub, leaf and filled. */
int ff_take_errors(ff_payload *in, unsigned form, uint32_t errors, ff_residuals *out);
/* 16 bits each, low byte first: `corners` unsigned values, then signed ones, `count` in all. */
int ff_take_words(ff_payload *in, uint32_t corners, int32_t *value, uint32_t count);
/* All that is left, untouched, for the codec's second stage; FF_ERR_RANGE when out->value is too
 * small for it. */
int ff_carry(const ff_terrain_info *info, ff_payload *in, ff_residuals *out);
/* Encoder: the same the other way. Bytes written. */
size_t ff_put_errors(const ff_residuals *res, enum ff_errors_form form, uint32_t errors,
                     uint8_t *out);
/* How they are stored best. */
enum ff_errors_form ff_errors_form_of(const ff_residuals *res, uint32_t errors);
size_t ff_put_words(const int32_t *value, uint32_t count, uint8_t *out);

/* ---- prediction and residuals ---- */

/* The sample half-way between known[i] and known[i+1] of a line of `cells`+1 known samples, which
 * are `step` apart in memory. */
int32_t ff_predict_middle(const uint16_t *known, uint32_t step, uint32_t i, uint32_t cells);
/* Of the points of a line that a doubling makes, `stride` apart from the known ones, those before
 * its ground ends: odd multiples of `stride` below `ground`. */
uint32_t ff_coded_points(uint32_t stride, uint32_t ground);
/* The first known point at or beyond the end of the ground. */
uint32_t ff_last_point(uint32_t stride, uint32_t ground);
/* After a doubling: all that lies beyond the ground repeats the last points that do not. */
void ff_repeat_last(uint16_t *grid, uint32_t side, uint32_t stride, ff_cells cells);
/* What a payload says of its ground, 0 standing for all of a grid of this side. */
ff_cells ff_cells_of(ff_cells cells, uint32_t side);
/* A parent's heights at the even points of a refined grid. */
void ff_spread_parent(const ff_terrain_info *info, const uint16_t *parent, uint16_t *grid);

/* How many samples a payload codes, root corners included; never more than the two below. */
uint32_t ff_coded_count(const ff_terrain_info *info, ff_cells cells, int root);
/* Grid index of root corner 0..3: south-west, south-east, north-west, north-east. */
uint32_t ff_corner_at(const ff_terrain_info *info, uint32_t corner);

/* Number of residuals in a payload without padding, root corners included. */
static inline uint32_t ff_root_count(const ff_terrain_info *info)
{
    return ff_node_side(info) * ff_node_side(info);
}
static inline uint32_t ff_refinement_count(const ff_terrain_info *info)
{
    return ff_refined_side(info) * ff_refined_side(info) - ff_root_count(info);
}

/* Quantiser step; roots of an entered terrain are exact (ff_entry.h). */
static inline int32_t ff_quantum(const ff_terrain_info *info, int root)
{
    FF_ASSERT(info->max_error <= INT16_MAX);
    return root && info->entered ? 1 : 2 * (int32_t)info->max_error + 1;
}

/* A height from its prediction and quantised residual. Lossless residuals are differences modulo
 * 2^16, so that 16 bits hold them all; lossy ones are at most 21845 and their sum is clamped, which
 * can only bring it nearer to the source. */
static inline uint16_t ff_dequantise(int32_t quantum, int32_t predicted, int32_t residual)
{
    FF_ASSERT(predicted >= 0 && predicted <= UINT16_MAX && quantum <= UINT16_MAX);
    FF_ASSERT(residual >= INT16_MIN && residual <= INT16_MAX);
    int32_t height = predicted + residual * quantum;
    if (quantum == 1) return (uint16_t)height;
    return (uint16_t)(height < 0 ? 0 : height > UINT16_MAX ? UINT16_MAX : height);
}
/* A corner's value has no sign. */
static inline uint16_t ff_dequantise_corner(int32_t quantum, int32_t value)
{
    FF_ASSERT(value >= 0 && value <= UINT16_MAX && quantum > 0 && quantum <= UINT16_MAX);
    uint32_t height = (uint32_t)value * (uint32_t)quantum;
    return (uint16_t)(height > UINT16_MAX ? UINT16_MAX : height);
}

static inline int32_t ff_quantise(const ff_source_heights *source, uint32_t at, int32_t quantum,
                                  int32_t predicted)
{
    int32_t difference = source->height[at] - predicted, half = quantum / 2;
    if (quantum == 1) /* modulo 2^16: the shorter way round */
        return difference > INT16_MAX   ? difference - 65536
               : difference < INT16_MIN ? difference + 65536
                                        : difference;
    return difference >= 0 ? (difference + half) / quantum : -((half - difference) / quantum);
}

/* Encoder: the height of the point `at`, predicted so, and its residual. */
static inline uint16_t ff_make_height(const ff_source_heights *source, uint32_t at, int32_t quantum,
                                      int32_t predicted, int32_t *residual)
{
    int between = source->between && source->between[at];
    *residual = between ? 0 : ff_quantise(source, at, quantum, predicted);
    uint16_t height = ff_dequantise(quantum, predicted, *residual);
    FF_ASSERT(between || (height - source->height[at] <= quantum / 2 &&
                          source->height[at] - height <= quantum / 2)); /* max_error */
    return height;
}

/* Residuals are coded as 0, 1, 2, 3, ... for 0, -1, 1, -2, ... */
static inline uint32_t ff_zigzag(int32_t v)
{
    FF_ASSERT(v >= INT16_MIN && v <= INT16_MAX);
    return v < 0 ? ~((uint32_t)v << 1) : (uint32_t)v << 1;
}
static inline int32_t ff_unzigzag(uint32_t v)
{
    FF_ASSERT(v <= UINT16_MAX);
    return (int32_t)(v >> 1) ^ -(int32_t)(v & 1u);
}

#endif
