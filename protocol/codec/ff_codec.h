/* Height codec: a node's children from the node and residuals (SPEC.md, chapter 3).
 *
 * A refinement turns the (2^k+1)^2 heights of a node into the (2^(k+1)+1)^2 heights of its four
 * children. Samples at even row and even column are the node's own, bit for bit. The rest is
 * predicted, residual added:
 *   1. odd column on an even row:  4-point interpolation along that row only (fewer points near its
 *      ends);
 *   2. even column on an odd row:  the same along that column;
 *   3. odd column on an odd row:   from the four new samples around it and the four old ones at its
 *      diagonals.
 * Rows and columns on the rim therefore use rim samples only: both sides of a border decode it
 * alike. A root is the same thing k times over, starting from the four corners, which are coded as
 * absolute values. Residuals are quantised with step 2*max_error+1 against *decoded* heights, so no
 * error grows with depth. protocol/SPEC.md gives every bit.
 *
 * A codec says how residuals become bytes; ff_codec_list.h has a row for each. The first three
 * predict as above and decode to the same heights. Codec trained predicts rims alike, all other
 * samples in an order and by weights of its own (protocol/trained): within max_error of the source,
 * too, but not the same heights, unless that is 0.
 *
 * Decoding has two stages. ff_decode_* runs on the network worker, away from the tree;
 * ff_reconstruct_* runs on the main thread, with the parent's heights. A codec chooses in which of
 * the two it turns bits into residuals. The first three do it in the first and share
 * ff_add_residuals as the second. A codec whose contexts need the parent's heights, or those
 * decoded just before, has FF_NEEDS_PARENT, as trained has: its first stage reads the error codes
 * and carries the rest of the payload in ff_residuals.value (ff_carry); its second stage reads the
 * bits while it predicts. So the list of new data, the tree and the local source do not know which
 * kind they move, the memory of a carried payload is that of the residuals it stands for, and the
 * other codecs pay nothing. The price: the second stage can find the payload bad, so
 * ff_reconstruct_* has an error to give and whoever holds the answer must treat it as undecodable.
 * Carrying such payloads as a kind of new data of their own would have cost a branch and a buffer
 * in each of those places.
 */
#ifndef FF_CODEC_H
#define FF_CODEC_H

#include "../ff_error.h"
#include "../ff_terrain.h"
#include "ff_codec_list.h"

#include <stddef.h>

#define FF_NODE_HEIGHTS_MAX    (33 * 33) /* (2^5+1)^2 */
#define FF_REFINED_HEIGHTS_MAX (65 * 65) /* (2^6+1)^2 */
/* Largest encoded payload of a root or refinement, any codec: callers size buffers with it. */
#define FF_PAYLOAD_BYTES_MAX (3 * FF_REFINED_HEIGHTS_MAX + 64)

FF_STATIC_ASSERT(FF_NODE_HEIGHTS_MAX ==
                 ((1 << FF_NODE_LOG2_MAX) + 1) * ((1 << FF_NODE_LOG2_MAX) + 1));
FF_STATIC_ASSERT(FF_REFINED_HEIGHTS_MAX ==
                 ((2 << FF_NODE_LOG2_MAX) + 1) * ((2 << FF_NODE_LOG2_MAX) + 1));
/* A byte of stubs, one of leaves, one of filled children, four error codes and every residual in 16
 * bits: what codec raw writes, and no other exceeds. */
FF_STATIC_ASSERT(7 + 2 * FF_REFINED_HEIGHTS_MAX <= FF_PAYLOAD_BYTES_MAX);

/* The rows' numbers have no gaps, and fit ff_terrain_info.codec. */
/* clang-format off */
#define ROW(...) +1
FF_STATIC_ASSERT((0 FF_CODEC_LIST(ROW)) == FF_CODEC_COUNT && FF_CODEC_COUNT <= UINT8_MAX + 1);
#undef ROW
/* clang-format on */

/* Geometric error of a node: largest distance between its drawn triangles and any full-resolution
 * sample below it, in height steps, as one byte: 0..31 are exact; above, (16 + (c & 15)) << (c / 16
 * - 1) for c = 32..208. Encoding rounds up, so the decoded error is never smaller than the true
 * one. */
uint8_t ff_geometric_error_encode(uint32_t steps);
uint32_t ff_geometric_error_decode(uint8_t code);
/* What stands for the children of a leaf of this code: half its error, while that is more than the
 * terrain's max_error. */
uint8_t ff_geometric_error_below(const ff_terrain_info *info, uint8_t code);

/* What decoding needs beyond the payload. */
enum ff_codec_needs {
    FF_NEEDS_NOTHING = 0,
    FF_NEEDS_ZLIB = 1,   /* ff_inflate.h */
    FF_NEEDS_PARENT = 2, /* residuals are read by the second stage, with the parent's heights */
    FF_NEEDS_TRAINED = FF_NEEDS_PARENT | 4 /* and protocol/trained */
};

/* Name of a codec, or NULL when no row of the list has this number. */
const char *ff_codec_name(int codec);
/* 1 when this build decodes payloads of the codec; without zlib it does not decode
 * FF_CODEC_DEFLATE. */
int ff_codec_supported(int codec);

/* The decoder's working memory: a caller-owned block, nothing else is ever allocated. Here and
 * below, `info` has passed ff_terrain_check. */
typedef struct ff_decoder ff_decoder;
size_t ff_decoder_bytes(const ff_terrain_info *info);
/* NULL when `bytes` is too small or the codec not supported. `memory` aligned for any type. */
ff_decoder *ff_decoder_create(const ff_terrain_info *info, void *memory, size_t bytes);
/* What any terrain with nodes of this size needs, whatever its codec; a decoder that was given so
 * much can be turned to another one. FF_OK or FF_ERR_UNSUPPORTED: this build has no such codec. */
size_t ff_decoder_bytes_any(const ff_terrain_info *info);
int ff_decoder_turn(ff_decoder *dec, const ff_terrain_info *info);

/* Have the sides of a refinement bits of their own in what is carried, and stand their lengths
 * before them, for who leaves some out? Or is it all words? */
enum ff_sides_form { FF_SIDES_NONE, FF_SIDES_BARE, FF_SIDES_MEASURED, FF_SIDES_WORDS };

/* What the first stage makes of a payload. Corner values of a root are absolute. */
typedef struct ff_residuals {
    ff_cells cells; /* given by the caller of ff_decode_* and ff_encode_heights */
    /* geometric error codes of the children, by quadrant; a root uses [0] for itself */
    uint8_t child_error[4];
    /* bit q: below child q (a root: bit 0, itself) are samples that were void and have been filled
     */
    uint8_t filled;
    /* bit q: child q (a root: bit 0, itself) is a leaf: nothing finer is stored, and what is wanted
     * below it is predicted (ff_predict_children) */
    uint8_t leaf;
    /* bit q: child q (a root: bit 0, itself), which is no leaf, is a stub: there is finer ground,
     * but none is stored here */
    uint8_t stub;
    uint8_t way;    /* which of the codec's predictions the residuals are added to */
    uint8_t sides;  /* bit ff_side: not in the payload, the heights of that side are known */
    uint8_t apart;  /* enum ff_sides_form */
    uint16_t count; /* valid entries of value[]; 0 while the payload is carried */
    uint16_t carried_bytes; /* of the payload, in the memory of value[]: FF_NEEDS_PARENT alone */
    uint16_t head_bits;     /* of what is carried, those that the first stage has read */
    /* caller's array of at least ff_refined_side()^2 entries; quantised residuals */
    int32_t *value;
    /* encoder, a codec of several predictions: caller's array of FF_PAYLOAD_BYTES_MAX, which keeps
     * what the first step has coded */
    uint8_t *body;
    uint16_t body_bytes;
    uint16_t body_half; /* bytes of it when a part of the points was made, or 0 */
    uint32_t body_bits; /* of the payload that it makes; UINT32_MAX: the rest is not made */
} ff_residuals;
FF_STATIC_ASSERT(FF_PAYLOAD_BYTES_MAX <= UINT16_MAX);                     /* body_bytes */
FF_STATIC_ASSERT(FF_REFINED_HEIGHTS_MAX * sizeof(int32_t) <= UINT16_MAX); /* carried_bytes */

/* FF_OK, or FF_ERR_TRUNCATED, FF_ERR_FORMAT, FF_ERR_RANGE: payload bytes are never trusted. */
int ff_decode_root(ff_decoder *dec, const uint8_t *payload, size_t bytes, ff_residuals *out);
int ff_decode_refinement(ff_decoder *dec, const uint8_t *payload, size_t bytes, ff_residuals *out);

/* What prediction works in: as many bytes, aligned for uint16_t, of the caller's. */
size_t ff_codec_room(const ff_terrain_info *info);
#define FF_CODEC_ROOM_MAX (3 * (65 + 4) * (65 + 4))

/* Second stage: prediction plus residual times step, clamped to 0..65535 (lossless: modulo 2^16, so
 * that 16 bits hold any residual). `heights` receives ff_node_side()^2 values. FF_OK; with
 * FF_NEEDS_PARENT also the errors of ff_decode_*, and no heights. */
int ff_reconstruct_root(const ff_terrain_info *info, const ff_residuals *res, uint16_t *heights,
                        void *room);
/* `parent` ff_node_side()^2 values, `refined` receives ff_refined_side()^2 values. FF_ERR_FORMAT
 * also where sides are left out. */
int ff_reconstruct_refinement(const ff_terrain_info *info, const uint16_t *parent,
                              const ff_residuals *res, uint16_t *refined, void *room);
/* The same, and of the sides in res->sides `refined` has the heights already, from the refinement
 * of the node beside it. */
int ff_reconstruct_beside(const ff_terrain_info *info, const uint16_t *parent,
                          const ff_residuals *res, uint16_t *refined, void *room);
/* A refinement's payload without those of the `sides` that it has, and without what only serves to
 * leave some out: nothing else changes. Bytes written to `out` (capacity at least
 * FF_PAYLOAD_BYTES_MAX), 0: it stays as it is, since its codec leaves out none, or an error of
 * ff_decode_*. */
int ff_without_sides(const ff_terrain_info *info, const uint8_t *payload, size_t bytes,
                     unsigned sides, uint8_t *out);
/* What stands for the payload of a leaf of this error code: its children are leaves, filled when it
 * is, with the code ff_geometric_error_below. Without values. */
ff_residuals ff_leaf_residuals(const ff_terrain_info *info, uint8_t code, int filled);
/* The heights of those children, in place of ff_reconstruct_refinement. */
void ff_predict_children(const ff_terrain_info *info, ff_cells cells, const uint16_t *parent,
                         uint16_t *refined, void *room);
/* Cuts the child in `quadrant` out of a refined grid. */
void ff_refined_child(const ff_terrain_info *info, const uint16_t *refined, uint32_t quadrant,
                      uint16_t *child);

/* Encoder, for tools (build switch FF_ENCODER; zlib allocates, so not for devices). Two steps,
 * because a payload tells geometric errors, which are measured on decoded heights.
 *
 * First the closed loop: residuals of `source` (the true grid: ff_node_side()^2 samples of a root,
 * ff_refined_side()^2 of a refinement) against predictions from `parent`, the *decoded* parent
 * (NULL: a root). `between`, NULL or a byte beside each of `source`, is not 0 where the source has
 * no sample and what is predicted will do; corners of a root have one. `out->value` receives the
 * residuals, `decoded` what every decoder will see. Where the codec has several predictions,
 * out->way is the one of the shortest payload. */
void ff_encode_heights(const ff_terrain_info *info, const uint16_t *parent, const uint16_t *source,
                       const uint8_t *between, ff_residuals *out, uint16_t *decoded);
/* 1: what ff_predict_children would make; this may be left out, below a leaf. */
int ff_is_as_predicted(const ff_residuals *res);
/* Then the payload, `res->child_error`, `filled`, `leaf` and `stub` set by the caller; the rest as
 * the first step had it. Bytes written to `out` (capacity at least FF_PAYLOAD_BYTES_MAX), or
 * FF_ERR_RANGE for an error code above 208. */
int ff_encode_payload(const ff_terrain_info *info, const uint16_t *parent, const uint16_t *decoded,
                      const ff_residuals *res, uint8_t *out);
/* Error codes and marks alone: out->value may be NULL. FF_OK or an error of ff_decode_*. */
int ff_read_marks(const ff_terrain_info *info, int root, const uint8_t *payload, size_t bytes,
                  ff_residuals *out);
/* A payload in which the children of the bits in `stub`, and no others, are marked as stubs;
 * nothing else changes, and the residuals are not read. Bytes written to `out` (capacity at least
 * FF_PAYLOAD_BYTES_MAX), or an error of ff_decode_*; FF_ERR_RANGE: one is a leaf. */
int ff_mark_stubs(const ff_terrain_info *info, int root, const uint8_t *payload, size_t bytes,
                  uint8_t stub, uint8_t *out);
/* What stands for the children of a stub where ground of their level is wanted: heights on the
 * stub's triangles, rounded up. */
void ff_interpolate_children(const ff_terrain_info *info, ff_cells cells, const uint16_t *parent,
                             uint16_t *refined);
/* Both, where the error codes are known beforehand. */
int ff_encode_root(const ff_terrain_info *info, const uint16_t *source, uint8_t error_code,
                   uint8_t *out, uint16_t *decoded);
int ff_encode_refinement(const ff_terrain_info *info, const uint16_t *parent,
                         const uint16_t *source, const uint8_t child_error[4], uint8_t *out,
                         uint16_t *decoded);

#endif
