/* Height codec: makes a node's children from the node and residuals (DESIGN.md, chapter 4, "Closed
 * loop, bounded").
 *
 * A refinement turns the (2^k+1)^2 heights of a node into the (2^(k+1)+1)^2 heights of its four
 * children. Samples at even row and even column are the node's own, bit for bit. Every other sample
 * is predicted, and its residual is added:
 *   1. odd column on an even row:  4-point interpolation along that row only (fewer points near its
 *      ends);
 *   2. even column on an odd row:  the same along that column;
 *   3. odd column on an odd row:   from the four new samples around it and the four old ones at its
 *      diagonals.
 * Rows and columns on the rim therefore use rim samples only: both sides of a border decode it
 * alike. A root is made by k such doublings, starting from its four corners, which are coded as
 * absolute values. Residuals are quantised with step 2*max_error+1 against *decoded* heights, so no
 * error grows with depth. protocol/SPEC.md gives every bit.
 */
#ifndef FF_CODEC_H
#define FF_CODEC_H

#include "../ff_error.h"
#include "../ff_terrain.h"

#include <stddef.h>

#define FF_NODE_LOG2_MAX       5
#define FF_NODE_HEIGHTS_MAX    (33 * 33) /* (2^5+1)^2 */
#define FF_REFINED_HEIGHTS_MAX (65 * 65) /* (2^6+1)^2 */
/* Largest encoded payload of a root or refinement, any codec: callers size buffers with it. */
#define FF_PAYLOAD_BYTES_MAX (3 * FF_REFINED_HEIGHTS_MAX + 64)

/* The geometric error of a node is the largest vertical distance between its drawn triangles and
 * any full-resolution sample within it, in height steps. It is coded as one byte c: 0..31 mean
 * themselves, 32..208 mean (16 + (c & 15)) << (c / 16 - 1). Encoding rounds up, so the decoded
 * error is never smaller than the true one. */
uint8_t ff_geometric_error_encode(uint32_t steps);
uint32_t ff_geometric_error_decode(uint8_t code);

/* The decoder's working memory (inflate state and scratch): a caller-owned block, nothing else is
 * ever allocated. */
typedef struct ff_decoder ff_decoder;
size_t ff_decoder_bytes(const ff_terrain_info *info);
/* 1 when this build decodes payloads of the codec (enum ff_codec_id); without zlib it does not
 * decode FF_CODEC_DEFLATE. */
int ff_codec_supported(int codec);
/* NULL when `bytes` is too small or the codec not supported. `memory` aligned for any type. */
ff_decoder *ff_decoder_create(const ff_terrain_info *info, void *memory, size_t bytes);

/* Residuals of one payload, entropy-decoded but not yet added to a prediction: this half needs no
 * parent and runs on the network worker. Corner values of a root are absolute. */
typedef struct ff_residuals {
    /* geometric error codes of the children, by quadrant; a root uses [0] for itself */
    uint8_t child_error[4];
    uint16_t count; /* valid entries of value[] */
    /* caller's array of at least FF_REFINED_HEIGHTS_MAX entries; quantised residuals */
    int32_t *value;
} ff_residuals;

/* FF_OK, or FF_ERR_TRUNCATED, FF_ERR_FORMAT, FF_ERR_RANGE: payload bytes are never trusted. */
int ff_decode_root(ff_decoder *dec, const uint8_t *payload, size_t bytes, ff_residuals *out);
int ff_decode_refinement(ff_decoder *dec, const uint8_t *payload, size_t bytes, ff_residuals *out);

/* The second half of decoding: each height is its prediction plus residual times step, clamped to
 * 0..65535 (lossless: taken modulo 2^16, so that 16 bits hold any residual). `heights` receives
 * ff_node_side()^2 values. */
void ff_reconstruct_root(const ff_terrain_info *info, const ff_residuals *res, uint16_t *heights);
/* `parent` ff_node_side()^2 values, `refined` receives ff_refined_side()^2 values. */
void ff_reconstruct_refinement(const ff_terrain_info *info, const uint16_t *parent,
                               const ff_residuals *res, uint16_t *refined);
/* Cuts the child in `quadrant` out of a refined grid. */
void ff_refined_child(const ff_terrain_info *info, const uint16_t *refined, uint32_t quadrant,
                      uint16_t *child);

/* Encoder, for tools. `source` is the true grid (ff_node_side()^2 heights for a root,
 * ff_refined_side()^2 for a refinement); `parent` is the *decoded* parent; `decoded` receives the
 * heights that every decoder will make. Returns the payload's bytes, written to `out` (capacity at
 * least FF_PAYLOAD_BYTES_MAX), or FF_ERR_RANGE for an error code above 208. Uses zlib, which
 * allocates: not for devices (build switch FF_ENCODER). */
int ff_encode_root(const ff_terrain_info *info, const uint16_t *source, uint8_t error_code,
                   uint8_t *out, uint16_t *decoded);
int ff_encode_refinement(const ff_terrain_info *info, const uint16_t *parent,
                         const uint16_t *source, const uint8_t child_error[4], uint8_t *out,
                         uint16_t *decoded);

#endif
