#include "pack_fixture.h"

#include "../../protocol/shape/ff_shape.h"
#include "../../platform/sys.h"
#include "../../protocol/ff_image.h"
#include "../../protocol/picture/ff_picture.h"

#include <stdlib.h>
#include <string.h>

#define JPEG_QUALITY 92

typedef struct writer {
    const pack_fixture_desc *desc;
    ff_pack_header header;
    uint8_t *bytes;
    size_t count, capacity;
    int failed;
} writer;

static uint8_t *grow(writer *w, size_t more)
{
    if (w->count + more > w->capacity) {
        size_t capacity = 2 * (w->count + more);
        uint8_t *bytes = realloc(w->bytes, capacity);
        if (!bytes) {
            w->failed = 1;
            return NULL;
        }
        w->bytes = bytes;
        w->capacity = capacity;
    }
    memset(w->bytes + w->count, 0, more);
    w->count += more;
    return w->bytes + w->count - more;
}

static void put_le(uint8_t *out, uint64_t value, unsigned bytes)
{
    for (unsigned i = 0; i < bytes; i++) out[i] = (uint8_t)(value >> (8 * i));
}

/* ---- the ground ---- */

/* First finest sample of a node, and its extent in finest cells. */
static uint32_t node_place(const ff_terrain_info *info, ff_key key, uint32_t *x, uint32_t *y)
{
    uint32_t extent = 1u << (info->tile_log2 - ff_key_level(key));
    uint32_t tile = ff_key_tile(key), code = ff_key_code(key);
    *x = ((tile % info->tiles_x) << info->tile_log2) + ff_morton_x(code) * extent;
    *y = ((tile / info->tiles_x) << info->tile_log2) + ff_morton_y(code) * extent;
    return extent;
}

/* Beyond the last sample the rim is repeated. */
static uint16_t height_at(const pack_fixture_desc *desc, uint32_t x, uint32_t y)
{
    uint32_t east = desc->info.samples_x - 1, north = desc->info.samples_y - 1;
    return desc->height(desc->context, x < east ? x : east, y < north ? y : north);
}

static void source_grid(const pack_fixture_desc *desc, ff_key key, uint32_t cells, uint16_t *out)
{
    uint32_t x, y, step = node_place(&desc->info, key, &x, &y) / cells;
    for (uint32_t j = 0; j <= cells; j++)
        for (uint32_t i = 0; i <= cells; i++) *out++ = height_at(desc, x + i * step, y + j * step);
}

/* Height of the drawn cell at fraction (fx, fy)/step, times step: two triangles with their common
 * edge from south-west to north-east. */
static int64_t cell_height(const int64_t h[4], int64_t fx, int64_t fy, int64_t step)
{
    if (fx >= fy) return h[0] * step + (h[1] - h[0]) * fx + (h[3] - h[1]) * fy;
    return h[0] * step + (h[2] - h[0]) * fy + (h[3] - h[2]) * fx;
}

/* Cells in which the ground ends are drawn narrower. */
static uint8_t node_error(const pack_fixture_desc *desc, ff_key key)
{
    uint32_t x0, y0, cells = 1u << desc->info.node_log2;
    uint32_t extent = node_place(&desc->info, key, &x0, &y0), step = extent / cells;
    int64_t worst = 0, east = desc->info.samples_x - 1, north = desc->info.samples_y - 1;
    for (uint32_t y = y0; y < y0 + extent && y < north; y++)
        for (uint32_t x = x0; x < x0 + extent && x < east; x++) {
            uint32_t cx = x0 + (x - x0) / step * step, cy = y0 + (y - y0) / step * step;
            int64_t wide = cx + step < east ? step : east - cx,
                    deep = cy + step < north ? step : north - cy, corner[4];
            for (uint32_t c = 0; c < 4; c++)
                corner[c] = height_at(desc, cx + (c & 1) * step, cy + (c >> 1) * step);
            int64_t drawn = cell_height(corner, (x - cx) * deep, (y - cy) * wide, wide * deep);
            int64_t off = drawn - wide * deep * height_at(desc, x, y);
            off = ((off < 0 ? -off : off) + wide * deep - 1) / (wide * deep);
            worst = off > worst ? off : worst;
        }
    return ff_geometric_error_encode((uint32_t)worst + desc->info.max_error);
}

/* ---- records ---- */

static void colours_of(const pack_fixture_desc *desc, ff_key key, uint8_t *rgb)
{
    uint32_t texels = 1u << desc->info.texture_log2;
    uint32_t column, row_of;
    int64_t spacing = desc->info.spacing_wu,
            edge = node_place(&desc->info, key, &column, &row_of) * spacing;
    int64_t x = column * spacing, y = row_of * spacing;
    for (uint32_t row = 0; row < texels; row++)
        for (uint32_t i = 0; i < texels; i++)
            desc->colour(desc->context, x + edge * i / (texels - 1),
                         y + edge * (texels - 1 - row) / (texels - 1),
                         rgb + 3 * (row * texels + i));
}

#define PICTURE_SIDE_MAX 32

/* Its parent's is made first: it is a difference to that. */
static int picture(const pack_fixture_desc *desc, ff_key key, uint8_t *decoded, uint8_t *out,
                   size_t capacity)
{
    static ff_picture_room room;
    uint8_t parent[PICTURE_SIDE_MAX * PICTURE_SIDE_MAX * 3],
        rgb[PICTURE_SIDE_MAX * PICTURE_SIDE_MAX * 3];
    ff_picture_above above = { 0 };
    if (ff_key_level(key)) {
        int bytes = picture(desc, ff_key_parent(key), parent, out, capacity);
        if (bytes < 0) return bytes;
        above = (ff_picture_above){ parent, ff_key_quadrant(key) };
    }
    colours_of(desc, key, rgb);
    return ff_picture_encode(rgb, desc->info.texture_log2, above, JPEG_QUALITY, &room, decoded, out,
                             capacity);
}

static int jpeg(const pack_fixture_desc *desc, ff_key key, uint8_t *out, size_t capacity)
{
    uint32_t texels = 1u << desc->info.texture_log2;
    uint8_t *rgb = malloc((size_t)3 * texels * texels);
    if (!rgb) return FF_ERR_MEMORY;
    colours_of(desc, key, rgb);
    int bytes = sys_jpeg_encode(rgb, texels, texels, JPEG_QUALITY, out, capacity);
    free(rgb);
    return bytes;
}

static int texture_payload(const pack_fixture_desc *desc, ff_key key, uint8_t *out, size_t capacity)
{
    uint8_t decoded[PICTURE_SIDE_MAX * PICTURE_SIDE_MAX * 3];
    size_t mark = desc->bare_level && ff_key_level(key) == desc->bare_level;
    if (mark) *out = FF_IMAGE_BARE + 15;
    int bytes = desc->info.flags & FF_TERRAIN_PICTURES
                    ? picture(desc, key, decoded, out + mark, capacity - mark)
                    : jpeg(desc, key, out + mark, capacity - mark);
    return bytes < 0 ? bytes : bytes + (int)mark;
}

/* decoded[]: heights of all nodes of the section's level; a section of refinements replaces them by
 * those of the next level. */
/* 1 when a sample of the node's ground was filled. */
static unsigned node_filled(const pack_fixture_desc *desc, ff_key key)
{
    uint32_t x0, y0, extent = node_place(&desc->info, key, &x0, &y0);
    if (!desc->filled) return 0;
    for (uint32_t y = y0; y <= y0 + extent && y < desc->info.samples_y; y++)
        for (uint32_t x = x0; x <= x0 + extent && x < desc->info.samples_x; x++)
            if (desc->filled(desc->context, x, y)) return 1;
    return 0;
}

static int node_payload(const pack_fixture_desc *desc, enum ff_section_kind kind, ff_key key,
                        uint8_t *out, const uint16_t *decoded, uint16_t *next)
{
    uint32_t node_heights = ff_node_side(&desc->info) * ff_node_side(&desc->info);
    uint64_t number = ((uint64_t)ff_key_tile(key) << 2 * ff_key_level(key)) + ff_key_code(key);
    uint16_t source[FF_REFINED_HEIGHTS_MAX], refined[FF_REFINED_HEIGHTS_MAX];
    int32_t value[FF_REFINED_HEIGHTS_MAX];
    uint8_t body[FF_PAYLOAD_BYTES_MAX];
    ff_residuals res = { .value = value, .body = body };
    if (ff_shape_has_ground(&desc->info, key))
        res.cells = ff_shape_cells(&desc->info, key, kind != FF_SECTION_ROOT);
    if (kind == FF_SECTION_ROOT) {
        source_grid(desc, key, 1u << desc->info.node_log2, source);
        res.child_error[0] = node_error(desc, key);
        res.filled = (uint8_t)node_filled(desc, key);
        ff_encode_heights(&desc->info, NULL, source, NULL, &res, next + number * node_heights);
        return ff_encode_payload(&desc->info, NULL, next + number * node_heights, &res, out);
    }
    for (uint32_t q = 0; q < 4; q++) {
        res.child_error[q] = node_error(desc, ff_key_child(key, q));
        res.filled |= (uint8_t)(node_filled(desc, ff_key_child(key, q)) << q);
    }
    if (desc->leaf_level == ff_key_level(key) + 1u) res.leaf = 15;
    if (desc->stub_level == ff_key_level(key) + 1u) res.stub = 15;
    const uint16_t *parent = decoded + number * node_heights;
    source_grid(desc, key, 2u << desc->info.node_log2, source);
    ff_encode_heights(&desc->info, parent, source, NULL, &res, refined);
    for (uint32_t q = 0; q < 4; q++)
        ff_refined_child(&desc->info, refined, q, next + (4 * number + q) * node_heights);
    return ff_encode_payload(&desc->info, parent, refined, &res, out);
}

/* The index of records of these lengths, all of their places or none, at the end of what is
 * written. */
static void put_index(writer *w, ff_pack_section *s, const uint32_t *length, uint32_t places)
{
    for (uint32_t r = 0; r < s->index.records; r++)
        while (length[r] >> s->index.length_bits) s->index.length_bits++;
    s->index.places = s->kind == FF_SECTION_ROOT ? 0 : places;
    s->index_offset = w->count;
    size_t index_bytes = (size_t)ff_index_bytes(&s->index);
    uint8_t *out = grow(w, index_bytes);
    if (!out) return;
    uint8_t *at = out;
    for (uint32_t r = 0; r < s->index.places; r += FF_INDEX_PLACES, at += FF_INDEX_PRESENCE_BYTES)
        ff_index_put_presence(length + r,
                              places - r < FF_INDEX_PLACES ? places - r : FF_INDEX_PLACES,
                              s->index.records ? r : 0, at);
    uint64_t offset = 0;
    for (uint32_t r = 0; r < s->index.records; at += ff_index_block_bytes(&s->index)) {
        uint32_t count = s->index.records - r < FF_INDEX_RECORDS ? s->index.records - r
                                                                 : FF_INDEX_RECORDS;
        ff_index_put_lengths(&s->index, length + r, count, offset, at);
        for (uint32_t end = r + count; r < end; r++) offset += FF_RECORD_CRC_BYTES + length[r];
    }
    s->index_crc = ff_crc32(0, out, index_bytes);
}

/* 1 when records of this level are not stored. */
static int is_left_out(const pack_fixture_desc *desc, enum ff_section_kind kind, uint32_t level)
{
    if (kind == FF_SECTION_TEXTURE) return desc->bare_level && level > desc->bare_level;
    return kind == FF_SECTION_REFINEMENT && ((desc->leaf_level && level >= desc->leaf_level) ||
                                             (desc->stub_level && level >= desc->stub_level));
}

static void section(writer *w, enum ff_section_kind kind, uint32_t level, const uint16_t *decoded,
                    uint16_t *next)
{
    static uint8_t payload[1 << 18];
    const ff_terrain_info *info = &w->desc->info;
    uint32_t per_tile = 1u << (2 * level), records = info->tiles_x * info->tiles_y * per_tile;
    uint32_t *length = calloc(records, sizeof *length);
    ff_pack_section *s = &w->header.section[w->header.section_count++];
    ff_pack_section_at(info, w->header.section_count - 1, s);
    s->index.records = is_left_out(w->desc, kind, level) ? 0 : records;
    s->data_offset = w->count;
    for (uint32_t r = 0; r < s->index.records && length && !w->failed; r++) {
        ff_key key = ff_key_make(r / per_tile, level, r % per_tile);
        int bytes = kind == FF_SECTION_TEXTURE
                        ? texture_payload(w->desc, key, payload, sizeof payload)
                        : node_payload(w->desc, kind, key, payload, decoded, next);
        uint8_t *out = bytes > 0 ? grow(w, FF_RECORD_CRC_BYTES + (size_t)bytes) : NULL;
        if (!out) {
            w->failed = 1;
            break;
        }
        length[r] = (uint32_t)bytes;
        put_le(out, ff_crc16(payload, (size_t)bytes), FF_RECORD_CRC_BYTES);
        memcpy(out + FF_RECORD_CRC_BYTES, payload, (size_t)bytes);
    }
    s->data_bytes = w->count - s->data_offset;
    s->data_crc = ff_crc32(0, w->bytes + s->data_offset, (size_t)s->data_bytes);
    if (length && !w->failed)
        put_index(w, s, length, level && is_left_out(w->desc, kind, level - 1) ? 0 : records);
    else
        w->failed = 1;
    free(length);
}

static void sections(writer *w)
{
    const ff_terrain_info *info = &w->desc->info;
    uint32_t levels = ff_terrain_levels(info);
    size_t level_heights = (size_t)info->tiles_x * info->tiles_y * ff_node_side(info) *
                           ff_node_side(info);
    uint16_t *decoded = NULL;
    for (uint32_t level = 0; level < levels && !w->failed; level++) {
        uint16_t *next = malloc((level_heights << (2 * level)) * sizeof *next);
        if (!next)
            w->failed = 1;
        else if (level == 0)
            section(w, FF_SECTION_ROOT, 0, NULL, next);
        else
            section(w, FF_SECTION_REFINEMENT, level - 1, decoded, next);
        free(decoded);
        decoded = next;
    }
    free(decoded);
    for (uint32_t level = 0; level < info->texture_levels && !w->failed; level++)
        section(w, FF_SECTION_TEXTURE, level, NULL, NULL);
}

static void about(writer *w)
{
    ff_list list = w->desc->about;
    ff_pack_section *s = &w->header.about;
    if (!list.byte_count) return;
    *s = ff_pack_about_section();
    s->index_offset = s->data_offset = w->count;
    s->data_bytes = list.byte_count;
    s->data_crc = ff_crc32(0, list.bytes, list.byte_count);
    uint8_t *out = grow(w, list.byte_count);
    if (out) memcpy(out, list.bytes, list.byte_count);
}

uint8_t *pack_fixture_make(const pack_fixture_desc *desc, size_t *bytes)
{
    writer w = { .desc = desc, .header.info = desc->info };
    if (ff_terrain_check(&desc->info) < 0) return NULL;
    grow(&w, FF_PACK_HEADER_BYTES);
    sections(&w);
    about(&w);
    if (!w.failed) w.failed = ff_pack_header_encode(&w.header, w.bytes) != FF_OK;
    if (w.failed) {
        free(w.bytes);
        return NULL;
    }
    *bytes = w.count;
    return w.bytes;
}

/* ---- ready-made ground ---- */

ff_terrain_info pack_fixture_info(uint8_t tile_log2, uint32_t tiles_x, uint32_t tiles_y)
{
    ff_terrain_info info = { .node_log2 = 3,
                             .tile_log2 = tile_log2,
                             .codec = FF_CODEC_DEFLATE,
                             .tiles_x = tiles_x,
                             .tiles_y = tiles_y,
                             .spacing_wu = 32 * FF_WU_PER_METRE,
                             .hscale_q24 = 1u << 24,
                             .height_max = 1500 };
    info.samples_x = (tiles_x << tile_log2) + 1;
    info.samples_y = (tiles_y << tile_log2) + 1;
    return info;
}

static uint32_t hash2(uint32_t x, uint32_t y)
{
    uint32_t h = x * 0x9E3779B1u ^ (y * 0x85EBCA77u + 0x27D4EB2Fu);
    h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
    h = (h ^ (h >> 12)) * 0x297A2D39u;
    return h ^ (h >> 15);
}

/* Value noise of lattice width 2^log2 with range 0..range-1, interpolated bilinearly. */
static uint32_t noise(uint32_t x, uint32_t y, uint32_t log2, uint32_t range)
{
    uint32_t cx = x >> log2, cy = y >> log2, size = 1u << log2, fx = x & (size - 1),
             fy = y & (size - 1);
    uint64_t south = (uint64_t)(hash2(cx, cy) % range) * (size - fx) +
                     (uint64_t)(hash2(cx + 1, cy) % range) * fx;
    uint64_t north = (uint64_t)(hash2(cx, cy + 1) % range) * (size - fx) +
                     (uint64_t)(hash2(cx + 1, cy + 1) % range) * fx;
    return (uint32_t)((south * (size - fy) + north * fy) >> (2 * log2));
}

uint16_t pack_fixture_hills(void *context, uint32_t x, uint32_t y)
{
    (void)context;
    return (uint16_t)(noise(x, y, 5, 1000) + noise(x, y, 3, 400) + noise(x, y, 1, 60));
}

int pack_fixture_hole(void *context, uint32_t x, uint32_t y)
{
    (void)context;
    return x >= 40 && x <= 50 && y >= 20 && y <= 30;
}

uint8_t *pack_fixture_usual(size_t *bytes)
{
    pack_fixture_desc desc = { .info = pack_fixture_info(6, 2, 2), .height = pack_fixture_hills };
    return pack_fixture_make(&desc, bytes);
}
