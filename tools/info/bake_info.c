#include "bake_info.h"
#include "bake_info_about.h"
#include "bake_info_cover.h"
#include "bake_info_sides.h"

#include "../../protocol/shape/ff_shape.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Distinct heights of the ground at a level, neighbours' shared rims counted once. */
static uint64_t lattice_samples(const ff_terrain_info *info, uint32_t level)
{
    uint32_t cell_log2 = info->tile_log2 - info->node_log2 - level;
    ff_sheet samples = ff_shape_sheet_samples(info);
    return ((uint64_t)((samples.x - 2) >> cell_log2) + 2) * (((samples.y - 2) >> cell_log2) + 2);
}

static uint64_t source_samples(const ff_terrain_info *info)
{
    ff_sheet samples = ff_shape_sheet_samples(info);
    return (uint64_t)samples.x * samples.y;
}

typedef struct section_sum {
    uint64_t records;
    uint64_t payload_bytes; /* CRCs and index not counted */
    uint64_t new_samples;   /* heights that no coarser level has; 0 for textures */
} section_sum;

/* New heights per level count every lattice point of the ground once. */
static section_sum sum_up(const ff_pack *pack, uint32_t number)
{
    const ff_pack_section *section = &pack->header.section[number];
    const ff_terrain_info *info = &pack->header.info;
    section_sum sum = { 0 };
    sum.records = section->index.records;
    sum.payload_bytes = section->data_bytes - FF_RECORD_CRC_BYTES * sum.records;
    if (section->kind == FF_SECTION_ROOT) sum.new_samples = lattice_samples(info, 0);
    if (section->kind == FF_SECTION_REFINEMENT)
        sum.new_samples = lattice_samples(info, section->level + 1u) -
                          lattice_samples(info, section->level);
    return sum;
}

static uint64_t index_bytes(const ff_pack *pack)
{
    uint64_t bytes = 0;
    for (uint32_t i = 0; i < pack->header.section_count; i++)
        bytes += ff_index_bytes(&pack->header.section[i].index);
    return bytes;
}

static double per(uint64_t bytes, uint64_t count)
{
    return count ? 8.0 * (double)bytes / (double)count : 0;
}

static double metres(int64_t wu) { return (double)wu / FF_WU_PER_METRE; }

/* Of the sphere that falls away alike when light goes straight; 0: flat. */
static double radius_m(const ff_terrain_info *info)
{
    return info->curve_q60 ? ldexp(1, 59) / info->curve_q60 / FF_WU_PER_METRE : 0;
}

/* Where a layer's images end, unless they cover all of the ground. */
static void print_covered(const ff_pack *pack, unsigned layer)
{
    double covered = bake_info_covered(pack, layer);
    if (covered < 1) printf(", over %.2g %% of the ground", 100 * covered);
}

static void print_terrain(const ff_pack *pack)
{
    const ff_terrain_info *info = &pack->header.info;
    double step = info->hscale_q24 / 16777216.0, spacing = metres(info->spacing_wu);
    ff_sheet samples = ff_shape_sheet_samples(info), tiles = ff_shape_sheet_tiles(info);
    printf("samples         %u x %u, %.9g m apart (%.3f x %.3f km)\n", samples.x, samples.y,
           spacing, (samples.x - 1) * spacing / 1000, (samples.y - 1) * spacing / 1000);
    printf("tiles           %u x %u of (2^%u+1)^2 heights, nodes of (2^%u+1)^2, %u levels\n",
           tiles.x, tiles.y, info->tile_log2, info->node_log2, ff_terrain_levels(info));
    printf("heights         %.3f to %.3f m in steps of %.9g m above %.9g m\n",
           info->height_min * step + metres(info->hoffset_wu),
           info->height_max * step + metres(info->hoffset_wu), step, metres(info->hoffset_wu));
    if (info->max_error)
        printf("error           at most %.9g m (%u steps)\n", info->max_error * step,
               info->max_error);
    else
        printf("error           none (lossless)\n");
    if (info->epsg)
        printf("reference       EPSG:%d, origin", info->epsg);
    else
        printf("reference       none, origin");
    printf(" %.3f %.3f\n", (double)info->origin_x_mm / 1000, (double)info->origin_y_mm / 1000);
    if (info->curve_q60)
        printf("curvature       as of a sphere of %.0f km, refraction included\n",
               radius_m(info) / 1000);
    else
        printf("curvature       none (flat)\n");
    if (info->texture_levels) {
        printf("textures        %u x %u texels on levels 0 to %u", 1u << info->texture_log2,
               1u << info->texture_log2, info->texture_levels - 1);
        print_covered(pack, 0);
        putchar('\n');
    } else {
        printf("textures        none\n");
    }
    printf("codec           %s%s\n", ff_codec_name(info->codec),
           info->flags & FF_TERRAIN_DENSIFIED ? "; part of the detail is invented" : "");
    printf("checksum        %08x\n", info->checksum);
}

/* Bytes of a layer's images, without CRCs and indexes. */
static uint64_t layer_bytes(const ff_pack *pack, unsigned layer)
{
    uint32_t first = ff_pack_layer_first(pack, layer);
    uint64_t bytes = 0;
    for (uint32_t i = 0; i < pack->header.layer_levels[layer]; i++)
        bytes += sum_up(pack, first + i).payload_bytes;
    return bytes;
}

/* One without a name is what the pack has anyway. */
static void print_layers(const ff_pack *pack)
{
    ff_layers layers;
    ff_pack_layers(pack, &layers);
    if (layers.count == 1 && !*layers.name[0]) return;
    for (unsigned i = 0; i < layers.count; i++) {
        printf("layer %u         %s: levels 0 to %u, %" PRIu64 " bytes", i,
               *layers.name[i] ? layers.name[i] : "(no name)", layers.levels[i][0] - 1u,
               layer_bytes(pack, i));
        print_covered(pack, i);
        putchar('\n');
    }
}

static void print_layers_json(const ff_pack *pack)
{
    ff_layers layers;
    ff_pack_layers(pack, &layers);
    printf("\"layers\": [");
    for (unsigned i = 0; i < layers.count; i++) {
        printf("%s{\"name\": ", i ? ", " : "");
        bake_info_print_text((const uint8_t *)layers.name[i], (uint32_t)strlen(layers.name[i]));
        printf(", \"levels\": %u, \"bytes\": %" PRIu64 ", \"covered\": %.6f}", layers.levels[i][0],
               layer_bytes(pack, i), bake_info_covered(pack, i));
    }
    printf("], ");
}

void bake_info_print(const ff_pack *pack, const char *path)
{
    section_sum heights = { 0 }, textures = { 0 };
    printf("%s: Farfield pack, version %d, %" PRIu64 " bytes\n", path, FF_PACK_VERSION, pack->size);
    print_terrain(pack);
    print_layers(pack);
    bake_info_about(pack);
    printf("\nsection     level    records        bytes  bytes/record  bits/new sample\n");
    for (uint32_t i = 0; i < pack->header.section_count; i++) {
        const ff_pack_section *section = &pack->header.section[i];
        section_sum sum = sum_up(pack, i), *total = sum.new_samples ? &heights : &textures;
        total->records += sum.records;
        total->payload_bytes += sum.payload_bytes;
        total->new_samples += sum.new_samples;
        printf("%-10s %6u %10" PRIu64 " %12" PRIu64 " %13.1f",
               ff_kind_of_section(section->kind)->name, section->level, sum.records,
               sum.payload_bytes, per(sum.payload_bytes, sum.records) / 8);
        if (sum.new_samples) printf(" %16.3f", per(sum.payload_bytes, sum.new_samples));
        putchar('\n');
    }
    uint64_t source = source_samples(&pack->header.info), index = index_bytes(pack);
    printf("\nheights   %12" PRIu64
           " bytes, %.3f bits a sample of the source, %.3f where no side is "
           "fetched twice\n",
           heights.payload_bytes, per(heights.payload_bytes, source),
           per(bake_info_sides_once(pack), source));
    printf("textures  %12" PRIu64 " bytes\n", textures.payload_bytes);
    printf("overhead  %12" PRIu64 " bytes (header, indexes, checksums, what is said of it)\n",
           pack->size - heights.payload_bytes - textures.payload_bytes);
    printf("  indexes %12" PRIu64 " bytes, %.2f a record\n", index,
           per(index, heights.records + textures.records) / 8);
}

static void print_terrain_json(const ff_terrain_info *info)
{
    double step = info->hscale_q24 / 16777216.0;
    ff_sheet samples = ff_shape_sheet_samples(info), tiles = ff_shape_sheet_tiles(info);
    printf(
        "\"version\": %d, \"node_log2\": %u, \"tile_log2\": %u, \"levels\": %u, \"codec\": \"%s\", \"flags\": %u, ",
        FF_PACK_VERSION, info->node_log2, info->tile_log2, ff_terrain_levels(info),
        ff_codec_name(info->codec), info->flags);
    printf(
        "\"tiles_x\": %u, \"tiles_y\": %u, \"samples_x\": %u, \"samples_y\": %u, \"spacing_m\": %.9g, ",
        tiles.x, tiles.y, samples.x, samples.y, metres(info->spacing_wu));
    printf(
        "\"hscale_m\": %.9g, \"hoffset_m\": %.9g, \"height_min\": %u, \"height_max\": %u, \"max_error\": %u, ",
        step, metres(info->hoffset_wu), info->height_min, info->height_max, info->max_error);
    printf("\"epsg\": %d, \"origin_x_mm\": %" PRId64 ", \"origin_y_mm\": %" PRId64
           ", \"texture_log2\": %u, "
           "\"texture_levels\": %u, \"effective_radius_m\": %.0f, \"checksum\": \"%08x\", ",
           info->epsg, info->origin_x_mm, info->origin_y_mm, info->texture_log2,
           info->texture_levels, radius_m(info), info->checksum);
}

void bake_info_print_json(const ff_pack *pack)
{
    uint64_t height_bytes = 0, height_index_bytes = 0, texture_bytes = 0;
    uint64_t source = source_samples(&pack->header.info);
    printf("{\"bytes\": %" PRIu64 ", ", pack->size);
    print_terrain_json(&pack->header.info);
    bake_info_about_json(pack);
    print_layers_json(pack);
    printf("\"sections\": [");
    for (uint32_t i = 0; i < pack->header.section_count; i++) {
        const ff_pack_section *section = &pack->header.section[i];
        section_sum sum = sum_up(pack, i);
        *(sum.new_samples ? &height_bytes : &texture_bytes) += sum.payload_bytes;
        if (sum.new_samples) height_index_bytes += ff_index_bytes(&section->index);
        printf("%s{\"kind\": \"%s\", \"level\": %u, \"records\": %" PRIu64 ", \"bytes\": %" PRIu64
               ", \"new_samples\": %" PRIu64 ", \"bits_per_new_sample\": %.4f}",
               i ? ", " : "", ff_kind_of_section(section->kind)->name, section->level, sum.records,
               sum.payload_bytes, sum.new_samples, per(sum.payload_bytes, sum.new_samples));
    }
    printf("], \"height_bytes\": %" PRIu64
           ", \"bits_per_sample\": %.4f, \"bits_per_sample_sides_once\": %.4f, "
           "\"bits_per_sample_with_index\": %.4f, \"texture_bytes\": %" PRIu64 "}\n",
           height_bytes, per(height_bytes, source), per(bake_info_sides_once(pack), source),
           per(height_bytes + height_index_bytes, source), texture_bytes);
}
