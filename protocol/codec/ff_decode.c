/* The two stages of decoding, whatever the codec: payload to residuals (network worker), residuals
 * to heights (main thread). */
#include "../zlib/ff_inflate.h"
#include "../ff_assert.h"
#include "ff_codec_local.h"

#include <string.h>

uint32_t ff_geometric_error_decode(uint8_t code)
{
    FF_ASSERT(code <= FF_ERROR_CODE_MAX);
    return code < 32 ? code : (16u + (code & 15u)) << (code / 16u - 1u);
}

uint8_t ff_geometric_error_encode(uint32_t steps)
{
    uint32_t code = 32, shift = 1;

    if (steps < 32) return (uint8_t)steps;
    if (steps >= 65536) return FF_ERROR_CODE_MAX;
    while (shift < 12 && steps > (31u << shift)) {
        code += 16;
        shift++;
    }
    code += ((steps + (1u << shift) - 1) >> shift) - 16;
    FF_ASSERT(code <= FF_ERROR_CODE_MAX && ff_geometric_error_decode((uint8_t)code) >= steps);
    return (uint8_t)code;
}

uint8_t ff_geometric_error_below(const ff_terrain_info *info, uint8_t code)
{
    uint32_t steps = ff_geometric_error_decode(code);
    uint32_t least = steps < info->max_error ? steps : info->max_error;

    return ff_geometric_error_encode(steps / 2 > least ? steps / 2 : least);
}

const char *ff_codec_name(int codec)
{
    const ff_codec *row = ff_codec_row(codec);

    return row ? row->name : NULL;
}

int ff_codec_supported(int codec)
{
    const ff_codec *row = ff_codec_row(codec);

    return row && (!(row->needs & FF_NEEDS_ZLIB) || ff_inflate_built) &&
           ((row->needs & FF_NEEDS_TRAINED) != FF_NEEDS_TRAINED || ff_trained_built);
}

int32_t ff_no_memory(const ff_terrain_info *info, void *memory)
{
    (void)info, (void)memory;
    return 0;
}

size_t ff_decoder_bytes(const ff_terrain_info *info)
{
    int32_t codec_bytes = ff_codec_row(info->codec)->memory(info, NULL);

    FF_ASSERT(codec_bytes >= 0); /* an error comes of memory that is given only */
    return ff_align_up(sizeof(ff_decoder)) + (size_t)codec_bytes;
}

ff_decoder *ff_decoder_create(const ff_terrain_info *info, void *memory, size_t bytes)
{
    ff_decoder *dec = memory;
    int32_t codec_bytes;

    if (!ff_codec_supported(info->codec) || bytes < ff_decoder_bytes(info)) return NULL;
    dec->info = *info;
    dec->codec = ff_codec_row(info->codec);
    dec->memory = (uint8_t *)memory + ff_align_up(sizeof(ff_decoder));
    codec_bytes = dec->codec->memory(info, dec->memory);
    FF_ASSERT(codec_bytes <= (int64_t)(bytes - ff_align_up(sizeof(ff_decoder))));
    return codec_bytes >= 0 ? dec : NULL;
}

size_t ff_decoder_bytes_any(const ff_terrain_info *info)
{
    ff_terrain_info any = *info;
    size_t most = 0, bytes;

    for (int codec = 0; ff_codec_name(codec); codec++) {
        any.codec = (uint8_t)codec;
        bytes = ff_codec_supported(codec) ? ff_decoder_bytes(&any) : 0;
        most = bytes > most ? bytes : most;
    }
    return most;
}

int ff_decoder_turn(ff_decoder *dec, const ff_terrain_info *info)
{
    int turns = dec->codec != ff_codec_row(info->codec);

    if (!ff_codec_supported(info->codec)) return FF_ERR_UNSUPPORTED;
    dec->info = *info;
    dec->codec = ff_codec_row(info->codec);
    return turns && dec->codec->memory(info, dec->memory) < 0 ? FF_ERR_UNSUPPORTED : FF_OK;
}

/* ---- payload to residuals ---- */

/* Takes a byte of `mark` and one bit a child off when there is one: the bits. */
static uint8_t take_mark(ff_payload *in, uint32_t mark)
{
    if (ff_payload_left(in) < 1 || *in->at <= mark || *in->at > mark + 15) return 0;
    return *in->at++ & 0x0fu;
}

int ff_take_errors(ff_payload *in, unsigned form, uint32_t errors, ff_residuals *out)
{
    uint32_t stored = form == FF_ERRORS_EACH ? errors : form == FF_ERRORS_SAME ? 1 : 0;

    FF_ASSERT(errors == 1 || errors == 4);
    if (form > FF_ERRORS_LEAF) return FF_ERR_FORMAT;
    out->stub = stored ? take_mark(in, FF_STUB) : 0;
    out->leaf = stored ? take_mark(in, FF_LEAF) : 0;
    out->filled = stored ? take_mark(in, FF_FILLED) : 0;
    if (form == FF_ERRORS_LEAF) out->leaf = (uint8_t)((1u << errors) - 1);
    if ((out->stub | out->leaf | out->filled) >> errors || out->stub & out->leaf)
        return FF_ERR_RANGE;
    if (ff_payload_left(in) < stored) return FF_ERR_TRUNCATED;
    memset(out->child_error, 0, 4);
    for (uint32_t i = 0; i < errors && stored > 0; i++) {
        out->child_error[i] = in->at[stored == 1 ? 0 : i];
        if (out->child_error[i] > FF_ERROR_CODE_MAX) return FF_ERR_RANGE;
    }
    in->at += stored;
    return FF_OK;
}

int ff_take_words(ff_payload *in, uint32_t corners, int32_t *value, uint32_t count)
{
    FF_ASSERT(corners <= count && count <= FF_REFINED_HEIGHTS_MAX);
    if (ff_payload_left(in) < 2 * (size_t)count) return FF_ERR_TRUNCATED;
    for (uint32_t i = 0; i < count; i++, in->at += 2) {
        int32_t v = in->at[0] | in->at[1] << 8;
        value[i] = i < corners || v <= INT16_MAX ? v : v - 65536;
    }
    return FF_OK;
}

int ff_carry(const ff_terrain_info *info, ff_payload *in, ff_residuals *out)
{
    size_t bytes = ff_payload_left(in), side = ff_refined_side(info);

    if (bytes > side * side * sizeof(*out->value)) return FF_ERR_RANGE;
    memcpy(out->value, in->at, bytes);
    in->at = in->end;
    out->count = 0;
    out->carried_bytes = (uint16_t)bytes;
    return FF_OK;
}

static int decode(ff_decoder *dec, const uint8_t *payload, size_t bytes,
                  const ff_contents *contents, ff_residuals *out)
{
    ff_payload in = { payload, payload + bytes };
    int rc;

    if (bytes < 1) return FF_ERR_TRUNCATED;
    out->count = (uint16_t)contents->count;
    out->carried_bytes = 0;
    out->sides = out->apart = 0;
    rc = dec->codec->decode(dec, &in, contents, out);
    FF_ASSERT(rc != FF_OK ||
              out->count == (dec->codec->needs & FF_NEEDS_PARENT ? 0 : contents->count));
    return rc == FF_OK && ff_payload_left(&in) > 0 ? FF_ERR_FORMAT : rc;
}

int ff_decode_root(ff_decoder *dec, const uint8_t *payload, size_t bytes, ff_residuals *out)
{
    ff_contents contents = { 1, FF_CORNERS, ff_coded_count(&dec->info, out->cells, 1) };

    return decode(dec, payload, bytes, &contents, out);
}

int ff_decode_refinement(ff_decoder *dec, const uint8_t *payload, size_t bytes, ff_residuals *out)
{
    ff_contents contents = { 4, 0, ff_coded_count(&dec->info, out->cells, 0) };

    return decode(dec, payload, bytes, &contents, out);
}

/* ---- residuals to heights ---- */

typedef struct reconstruction {
    const int32_t *next;
    int32_t quantum;
} reconstruction;

static uint16_t add_residual(void *context, uint32_t at, int32_t predicted)
{
    reconstruction *r = context;

    (void)at;
    return ff_dequantise(r->quantum, predicted, *r->next++);
}

int ff_add_residuals(const ff_terrain_info *info, const uint16_t *parent, const ff_residuals *res,
                     uint16_t *heights, void *room)
{
    reconstruction r = { res->value, ff_quantum(info, !parent) };

    FF_ASSERT(res->count == ff_coded_count(info, res->cells, !parent));
    for (uint32_t corner = 0; !parent && corner < FF_CORNERS; corner++)
        heights[ff_corner_at(info, corner)] = ff_dequantise_corner(r.quantum, *r.next++);
    ff_interpolate(info, res->cells, 0, parent, heights, room, add_residual, &r);
    FF_ASSERT(r.next == res->value + res->count);
    return FF_OK;
}

static int reconstruct(const ff_terrain_info *info, const uint16_t *parent, const ff_residuals *res,
                       uint16_t *heights, void *room)
{
    const ff_codec *codec = ff_codec_row(info->codec);

    FF_ASSERT(!(codec->needs & FF_NEEDS_PARENT) || res->count == 0);
    return codec->reconstruct(info, parent, res, heights, room);
}

int ff_reconstruct_root(const ff_terrain_info *info, const ff_residuals *res, uint16_t *heights,
                        void *room)
{
    return reconstruct(info, NULL, res, heights, room);
}

int ff_reconstruct_beside(const ff_terrain_info *info, const uint16_t *parent,
                          const ff_residuals *res, uint16_t *refined, void *room)
{
    return reconstruct(info, parent, res, refined, room);
}

int ff_reconstruct_refinement(const ff_terrain_info *info, const uint16_t *parent,
                              const ff_residuals *res, uint16_t *refined, void *room)
{
    return res->sides ? FF_ERR_FORMAT : reconstruct(info, parent, res, refined, room);
}

int ff_without_sides(const ff_terrain_info *info, const uint8_t *payload, size_t bytes,
                     unsigned sides, uint8_t *out)
{
    FF_ASSERT(sides < 1u << FF_SIDE_COUNT);
    return info->codec == FF_CODEC_TRAINED
               ? ff_trained_without_sides(info, payload, bytes, sides, out)
               : 0;
}

ff_residuals ff_leaf_residuals(const ff_terrain_info *info, uint8_t code, int filled)
{
    ff_residuals all = { .filled = filled ? 15 : 0, .leaf = 15 };

    memset(all.child_error, ff_geometric_error_below(info, code), sizeof(all.child_error));
    return all;
}

static uint16_t take_prediction(void *context, uint32_t at, int32_t predicted)
{
    (void)context, (void)at;
    return (uint16_t)predicted;
}

void ff_predict_children(const ff_terrain_info *info, ff_cells cells, const uint16_t *parent,
                         uint16_t *refined, void *room)
{
    ff_codec_row(info->codec)
        ->predict(info, cells, 0, parent, refined, room, take_prediction, NULL);
}

void ff_refined_child(const ff_terrain_info *info, const uint16_t *refined, uint32_t quadrant,
                      uint16_t *child)
{
    uint32_t side = ff_node_side(info), refined_side = ff_refined_side(info);
    const uint16_t *from = refined + (quadrant & 1u) * (side - 1) +
                           (quadrant >> 1) * (side - 1) * refined_side;

    FF_ASSERT(quadrant < 4 && refined_side == 2 * side - 1);
    for (uint32_t j = 0; j < side; j++)
        memcpy(child + j * side, from + j * refined_side, side * sizeof(*child));
}
