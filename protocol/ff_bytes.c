#include "ff_bytes.h"

#include "ff_assert.h"
#include "ff_error.h"

#include <string.h>

const uint8_t *ff_read_span(ff_reader *in, size_t count)
{
    const uint8_t *span = in->at;

    FF_ASSERT(in->at <= in->end);
    if (in->error == FF_OK && (size_t)(in->end - in->at) < count) in->error = FF_ERR_TRUNCATED;
    if (in->error != FF_OK) return NULL;
    in->at += count;
    return span;
}

uint64_t ff_read_bytes(ff_reader *in, unsigned count)
{
    const uint8_t *bytes = ff_read_span(in, count);
    uint64_t value = 0;

    FF_ASSERT(count <= 8);
    for (unsigned i = 0; bytes && i < count; i++) value |= (uint64_t)bytes[i] << (8 * i);
    return value;
}

int64_t ff_read_signed(ff_reader *in, unsigned count)
{
    FF_ASSERT(count >= 1 && count <= 8);
    uint64_t value = ff_read_bytes(in, count), sign = (uint64_t)1 << (8 * count - 1);

    return value & sign ? -(int64_t)(2 * sign - 1 - value) - 1 : (int64_t)value;
}

uint32_t ff_read_varint(ff_reader *in)
{
    uint32_t value = 0;

    for (unsigned shift = 0; shift < 35; shift += 7) {
        uint32_t byte = (uint32_t)ff_read_bytes(in, 1);
        if (in->error != FF_OK) return 0;
        if ((shift == 28 && byte > 15) || (shift > 0 && byte == 0)) break;
        FF_ASSERT((byte & 127u) <= UINT32_MAX >> shift);
        value |= (byte & 127u) << shift;
        if (byte < 128) return value;
    }
    in->error = FF_ERR_RANGE;
    return 0;
}

void ff_write_span(ff_writer *out, const uint8_t *bytes, size_t count)
{
    FF_ASSERT(out->at <= out->end);
    if (out->error == FF_OK && (size_t)(out->end - out->at) < count) out->error = FF_ERR_FULL;
    if (out->error != FF_OK || count == 0) return;
    memcpy(out->at, bytes, count);
    out->at += count;
}

void ff_write_bytes(ff_writer *out, uint64_t value, unsigned count)
{
    uint8_t bytes[8];

    FF_ASSERT(count <= sizeof(bytes));
    for (unsigned i = 0; i < count; i++) bytes[i] = (uint8_t)(value >> (8 * i));
    ff_write_span(out, bytes, count);
}

void ff_write_varint(ff_writer *out, uint32_t value)
{
    for (; value > 127; value >>= 7) ff_write_bytes(out, value | 128u, 1);
    ff_write_bytes(out, value, 1);
}

unsigned ff_varint_bytes(uint32_t value)
{
    unsigned count = 1;

    for (; value > 127; value >>= 7) count++;
    FF_ASSERT(count <= 5);
    return count;
}

void ff_read_terrain(ff_reader *in, ff_terrain_info *info)
{
    info->node_log2 = (uint8_t)ff_read_bytes(in, 1);
    info->tile_log2 = (uint8_t)ff_read_bytes(in, 1);
    info->codec = (uint8_t)ff_read_bytes(in, 1);
    info->flags = (uint8_t)ff_read_bytes(in, 1);
    info->texture_log2 = (uint8_t)ff_read_bytes(in, 1);
    info->texture_levels = (uint8_t)ff_read_bytes(in, 1);
    info->height_min = (uint16_t)ff_read_bytes(in, 2);
    info->height_max = (uint16_t)ff_read_bytes(in, 2);
    info->max_error = (uint16_t)ff_read_bytes(in, 2);
    info->tiles_x = (uint32_t)ff_read_bytes(in, 4);
    info->tiles_y = (uint32_t)ff_read_bytes(in, 4);
    info->samples_x = (uint32_t)ff_read_bytes(in, 4);
    info->samples_y = (uint32_t)ff_read_bytes(in, 4);
    info->spacing_wu = (uint32_t)ff_read_bytes(in, 4);
    info->hscale_q24 = (uint32_t)ff_read_bytes(in, 4);
    info->hoffset_wu = (int32_t)ff_read_signed(in, 4);
    info->epsg = (int32_t)ff_read_signed(in, 4);
    info->origin_x_mm = ff_read_signed(in, 8);
    info->origin_y_mm = ff_read_signed(in, 8);
    info->curve_q60 = (uint32_t)ff_read_bytes(in, 4);
    info->checksum = (uint32_t)ff_read_bytes(in, 4);
    info->first_tile = info->entered = info->images_whole = 0;
    info->west_wu = info->south_wu = 0;
    if (in->error == FF_OK) in->error = ff_terrain_check(info);
}

void ff_write_terrain(ff_writer *out, const ff_terrain_info *info)
{
    ff_write_bytes(out, info->node_log2, 1);
    ff_write_bytes(out, info->tile_log2, 1);
    ff_write_bytes(out, info->codec, 1);
    ff_write_bytes(out, info->flags, 1);
    ff_write_bytes(out, info->texture_log2, 1);
    ff_write_bytes(out, info->texture_levels, 1);
    ff_write_bytes(out, info->height_min, 2);
    ff_write_bytes(out, info->height_max, 2);
    ff_write_bytes(out, info->max_error, 2);
    ff_write_bytes(out, info->tiles_x, 4);
    ff_write_bytes(out, info->tiles_y, 4);
    ff_write_bytes(out, info->samples_x, 4);
    ff_write_bytes(out, info->samples_y, 4);
    ff_write_bytes(out, info->spacing_wu, 4);
    ff_write_bytes(out, info->hscale_q24, 4);
    ff_write_bytes(out, (uint32_t)info->hoffset_wu, 4);
    ff_write_bytes(out, (uint32_t)info->epsg, 4);
    ff_write_bytes(out, (uint64_t)info->origin_x_mm, 8);
    ff_write_bytes(out, (uint64_t)info->origin_y_mm, 8);
    ff_write_bytes(out, info->curve_q60, 4);
    ff_write_bytes(out, info->checksum, 4);
}
