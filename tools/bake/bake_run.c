#include "bake_estimate.h"

#include "../../protocol/shape/ff_shape.h"
#include "../../platform/sys.h"
#include "raster/bake_curve.h"
#include "raster/bake_densify.h"
#include "raster/bake_fill.h"
#include "raster/bake_given.h"
#include "raster/bake_lattice.h"
#include "bake_fault.h"
#include "bake_leftovers.h"
#include "raster/bake_project.h"
#include "raster/bake_reference.h"
#include "raster/bake_voids.h"
#include "tiles/bake_mosaic.h"
#include "bake_say.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>
#include <stdio.h>
#include <stdlib.h>

#define GDAL_CACHE_BYTES (48 << 20)

/* ---- ground ---- */

/* Reads the raster, or puts it together from map tiles. */
static int read_source(const bake_options *o, bake_ground *ground)
{
    bake_mosaic mosaic;
    if (!bake_mosaic_wanted(o)) {
        if (o->bbox.is_given || o->zoom)
            return bake_fail("%s: no map tiles: --bbox and --zoom take a part of map tiles, "
                             "gdal_translate -projwin one of other rasters",
                             o->heights_path);
        return bake_source_read(o, NULL, ground);
    }
    if (bake_mosaic_open(o, &mosaic)) return -1;
    int rc = bake_source_read(o, mosaic.set, ground);
    bake_mosaic_close(&mosaic);
    return rc;
}

/* Fills `count` voids, and remembers where they were. */
static int fill(bake *b, uint64_t count)
{
    if (!count) return 0;
    return bake_voids_mark(&b->ground.grid, &b->marks) || bake_fill_voids(&b->ground.grid) ? -1 : 0;
}

static void say_filled(const bake_ground *ground)
{
    uint64_t all = (uint64_t)ground->source_width * ground->source_height;
    if (ground->voids)
        bake_note("%" PRIu64 " of %" PRIu64 " samples are void; filled from around them",
                  ground->voids, all);
    if (ground->given)
        bake_note("%" PRIu64 " of %" PRIu64 " samples are void; given the height asked for",
                  ground->given, all);
    if (ground->outside)
        bake_note("%" PRIu64
                  " samples lie outside the source after projection; filled from its border",
                  ground->outside);
}

int bake_read(bake *b)
{
    if (read_source(b->options, &b->ground)) return -1;
    if (bake_given_heights(b->options, &b->ground)) return -1;
    return fill(b, b->ground.voids);
}

uint32_t bake_spacing_wu(const bake_options *o, double spacing_m)
{
    return (uint32_t)fmin(nearbyint(spacing_m * FF_WU_PER_METRE / o->densify), UINT32_MAX);
}

static int make_ground(bake *b)
{
    double spacing_m;
    if (bake_read(b)) return -1;
    if (bake_project(b->options, &b->ground, &b->marks, &spacing_m)) return -1;
    if (fill(b, b->ground.outside)) return -1;
    say_filled(&b->ground);
    if (bake_densify(&b->ground.grid, b->ground.geotransform, b->options->densify)) return -1;
    b->info.spacing_wu = bake_spacing_wu(b->options, spacing_m);
    if (bake_steps_choose(b->options, &b->ground, &b->steps)) return -1;
    if (bake_quantise(b->options, &b->ground, &b->steps, &b->info, &b->heights)) return -1;
    int rc = b->marks.fd < 0 ? 0
                             : bake_voids_finish(&b->marks, b->ground.geotransform[5] < 0,
                                                 b->options->densify, &b->filled);
    /* the ground's size and place are still needed, its samples are not */
    bake_grid_close(&b->ground.grid);
    bake_grid_close(&b->marks);
    return rc;
}

/* ---- the terrain's description ---- */

/* 1 when tiles of 2^n along the longer side end where places still fit int32_t. */
static int tiles_fit(uint32_t n, uint32_t samples, uint32_t apart_wu)
{
    uint64_t tiles = ((samples - 2) >> n) + 1;
    return (tiles << n) * apart_wu <= INT32_MAX;
}

uint32_t bake_choose_tile_log2(uint32_t node_log2, uint32_t width, uint32_t height,
                               uint32_t apart_wu)
{
    uint32_t samples = width > height ? width : height, n = node_log2;
    while (n < node_log2 + FF_KEY_LEVEL_MAX && (samples - 2) >> n) n++;
    while (n > node_log2 && !tiles_fit(n, samples, apart_wu)) n--;
    return n;
}

static void describe_place(const bake_ground *ground, ff_terrain_info *info)
{
    const double *gt = ground->geotransform;
    double south = gt[5] < 0 ? gt[3] + gt[5] * ground->grid.height : gt[3];
    if (!ground->has_place || ground->is_geographic) return;
    info->origin_x_mm = (int64_t)nearbyint((gt[0] + gt[1] / 2) * 1000);
    info->origin_y_mm = (int64_t)nearbyint((south + fabs(gt[5]) / 2) * 1000);
    if (!ground->srs) return;
    info->epsg = bake_reference_epsg(ground->srs);
    if (!info->epsg) bake_note("the reference system has no EPSG code: the pack will not name it");
}

int bake_describe(bake *b)
{
    const bake_options *o = b->options;
    ff_terrain_info *info = &b->info;
    uint32_t width = b->heights.width, height = b->heights.height;
    info->node_log2 = (uint8_t)o->node_log2;
    info->tile_log2 = (uint8_t)(o->tile_log2 ? o->tile_log2
                                             : bake_choose_tile_log2(o->node_log2, width, height,
                                                                     info->spacing_wu));
    info->codec = (uint8_t)o->codec;
    if (o->densify > 1) info->flags |= FF_TERRAIN_DENSIFIED;
    ff_shape_cover(info, width, height);
    describe_place(&b->ground, info);
    info->curve_q60 = bake_curve_q60(o, &b->ground);
    char fault[200];
    if (bake_fault(info, fault, sizeof fault))
        return bake_fail("%u x %u samples of %g m in tiles of 2^%u do not make a terrain: %s",
                         width, height, (double)info->spacing_wu / FF_WU_PER_METRE, info->tile_log2,
                         fault);
    if (ff_terrain_check(info)) return bake_fail("codec %d is no codec of this build", info->codec);
    return 0;
}

/* ---- tiles ---- */

static int take_records(void *context, uint32_t section, const bake_blob *records,
                        const bake_blob *above)
{
    bake *b = context;
    return pack_writer_add(&b->writer, section, records, above);
}

static int take_layer(void *context, uint32_t section, const bake_blob *records,
                      const bake_blob *above)
{
    bake *b = context;
    return pack_writer_add(&b->writer, b->layer_at + section, records, above);
}

typedef int take_fn(void *context, uint32_t section, const bake_blob *records,
                    const bake_blob *above);

/* Also how far decoded heights are from their samples: b->rms_m. */
static int make_tiles(bake *b, const bake_image *image, take_fn *take)
{
    bake_grid_samples samples = bake_samples_of(&b->heights, &b->filled);
    bake_off off = { 0, 0 };
    bake_tiles tiles = { .info = &b->info,
                         .samples = &samples.samples,
                         .image = image,
                         .texture_quality = (int)b->options->texture_quality,
                         .images_only = b->layer_at > 0,
                         .block_log2 = BAKE_BLOCK_LOG2,
                         .jobs = b->options->jobs,
                         .off = &off,
                         .context = b,
                         .take = take };
    int rc = bake_tiles_make(&tiles);
    if (!rc && !tiles.images_only)
        b->rms_m = sqrt(off.squares / (double)off.samples) * b->steps.step_m;
    return rc;
}

static int drop_records(void *context, uint32_t section, const bake_blob *records,
                        const bake_blob *above)
{
    (void)context, (void)section, (void)records, (void)above;
    return 0;
}

#define BY_GROWTH 4 /* tries: as a rule they are all */

/* What to try between an error that fits and one that does not. Errors are spread evenly while they
 * are smaller than the ground is rough, so their mean grows with the largest: `guess`. Where it
 * does not grow so, a fourth of what is between is ruled out each time. */
static uint32_t between(uint32_t fits, uint32_t fails, double guess, int by_growth)
{
    uint32_t quarter = by_growth ? 0 : (fails - fits) / 4, least = fits + (quarter ? quarter : 1),
             most = fails - (quarter ? quarter : 1);
    return (uint32_t)fmin(fmax(guess, least), most);
}

/* The largest error with which the root mean square is within what was asked for; no larger than
 * the ground is high. */
static int choose_error(bake *b)
{
    static const bake_image no_image = { .levels = 0 };
    double wanted_m = b->options->rms_error_m, guess = wanted_m / b->steps.step_m * sqrt(3);
    uint32_t relief = b->info.height_max - b->info.height_min, fits = 0,
             fails = (relief < INT16_MAX ? relief : INT16_MAX) + 1, tries = 0;
    if (wanted_m <= 0) return 0;
    while (fails - fits > 1) {
        uint32_t steps = between(fits, fails, guess, tries++ < BY_GROWTH);
        bake_set_error(&b->info, steps);
        if (make_tiles(b, &no_image, drop_records)) return -1;
        *(b->rms_m <= wanted_m ? &fits : &fails) = steps;
        guess = b->rms_m > 0 ? steps * wanted_m / b->rms_m : fails;
    }
    bake_set_error(&b->info, fits);
    if (!fits)
        bake_note(
            "--rms-error %g m is less than that of an error of one height step of %g m: lossless",
            wanted_m, b->steps.step_m);
    return 0;
}

/* ---- what was made ---- */

/* Ends the summary with the shift between datums: no name, 0 m where there is none; an accuracy
 * that is not known is null. */
static void print_shift(const bake_shift *shift)
{
    printf("\"datum_shift\": \"%s\", \"datum_shift_m\": ", shift->name);
    if (shift->accuracy_m >= 0)
        printf("%.9g}\n", shift->accuracy_m);
    else
        printf("null}\n");
}

static void report(const bake *b, uint64_t file_bytes)
{
    const ff_terrain_info *info = &b->info;
    ff_sheet source = ff_shape_sheet_samples(info), tiles = ff_shape_sheet_tiles(info);
    uint64_t height_bytes = 0, texture_bytes = 0, samples = (uint64_t)source.x * source.y;
    for (uint32_t i = 0; i < b->writer.section_count; i++)
        *(i < ff_terrain_levels(info) ? &height_bytes : &texture_bytes) +=
            b->writer.section[i].data_bytes - FF_RECORD_CRC_BYTES * b->writer.section[i].records;
    double seconds = (double)(sys_time_us() - b->started_us) / 1e6,
           bits = 8.0 * (double)height_bytes / (double)samples;
    double spacing_m = (double)info->spacing_wu / FF_WU_PER_METRE;
    bake_note(
        "%s: %u x %u samples of %g m, step %g m, %u x %u tiles of 2^%u; %.3f bits a sample, %" PRIu64
        " bytes of textures, "
        "%" PRIu64 " bytes in all, %.1f s",
        b->options->out_path, source.x, source.y, spacing_m, b->steps.step_m, tiles.x, tiles.y,
        info->tile_log2, bits, texture_bytes, file_bytes, seconds);
    if (!b->options->json) return;
    printf(
        "{\"samples_x\": %u, \"samples_y\": %u, \"spacing_m\": %.9g, \"hscale_m\": %.9g, \"hoffset_m\": %.9g, "
        "\"max_error_m\": %.9g, \"rms_error_m\": %.9g, \"height_min_m\": %.9g, \"height_max_m\": %.9g, \"tiles_x\": %u, \"tiles_y\": %u, "
        "\"tile_log2\": %u, \"node_log2\": %u, \"epsg\": %d, \"voids\": %" PRIu64
        ", \"given\": %" PRIu64 ", \"outside\": %" PRIu64
        ", \"resampled\": %s, \"texture_levels\": %u, \"height_bytes\": %" PRIu64
        ", \"bits_per_sample\": %.4f, "
        "\"texture_bytes\": %" PRIu64 ", \"file_bytes\": %" PRIu64 ", \"seconds\": %.3f, ",
        source.x, source.y, spacing_m, b->steps.step_m, (double)info->hoffset_wu / FF_WU_PER_METRE,
        info->max_error * b->steps.step_m, b->rms_m, b->steps.min_m, b->steps.max_m, tiles.x,
        tiles.y, info->tile_log2, info->node_log2, info->epsg, b->ground.voids, b->ground.given,
        b->ground.outside, b->ground.resampled ? "true" : "false", info->texture_levels,
        height_bytes, bits, texture_bytes, file_bytes, seconds);
    print_shift(&b->ground.shift);
}

ff_list bake_about_of(bake *b, const bake_ground *ground)
{
    int is_placed = ground->has_place && !ground->is_geographic;
    uint32_t bytes = bake_about_list(&ground->about, is_placed ? ground->srs : NULL, b->about);
    if (b->layers.count > 1 || *b->layers.name[0]) {
        uint8_t names[FF_LAYERS_NAMES_MAX];
        ff_writer rows = { names, names + sizeof names, FF_OK },
                  list = { b->about + bytes, b->about + sizeof b->about, FF_OK };
        ff_layers_write(&rows, &b->layers, 0);
        ff_list_write(&list, FF_ABOUT_LAYERS, names, (uint32_t)(rows.at - names));
        FF_ASSERT(rows.error == FF_OK && list.error == FF_OK); /* all entries fit together */
        bytes = (uint32_t)(list.at - b->about);
    }
    return (ff_list){ b->about, bytes };
}

/* Images of one more layer, into sections of their own. */
static int add_layer(bake *b, const char *path)
{
    bake_options own = *b->options;
    const bake_options *told = b->options;
    ff_terrain_info first = b->info;
    bake_image image = { .levels = 0 };
    own.color_path = path;
    b->options = &own;
    bake_grid_samples heights = bake_samples_of(&b->heights, &b->filled);
    int rc = bake_image_make(&own, &b->ground, &heights.samples, &b->info, &image);
    if (!rc) rc = pack_writer_add_layer(&b->writer, image.levels, &b->layer_at);
    b->layer_at -= ff_terrain_levels(&b->info);
    if (!rc) rc = make_tiles(b, &image, take_layer);
    b->options = told;
    b->info = first;
    b->layer_at = 0;
    bake_image_close(&image);
    return rc;
}

static int add_layers(bake *b)
{
    for (uint32_t i = 1; i < b->layers.count; i++)
        if (add_layer(b, b->layer_path[i])) return -1;
    return 0;
}

static int make_pack(bake *b)
{
    uint64_t file_bytes;
    if (make_ground(b) || bake_describe(b) || choose_error(b)) return -1;
    bake_grid_samples heights = bake_samples_of(&b->heights, &b->filled);
    if (b->options->color_path &&
        bake_image_make(b->options, &b->ground, &heights.samples, &b->info, &b->image))
        return -1;
    if (pack_writer_open(&b->writer, &b->info)) return -1;
    if (make_tiles(b, &b->image, take_records)) return -1;
    bake_image_close(&b->image);
    if (add_layers(b)) return -1;
    b->writer.about = bake_about_of(b, &b->ground);
    if (pack_writer_finish(&b->writer, b->options->out_path, &file_bytes)) return -1;
    report(b, file_bytes);
    return 0;
}

/* Makes sure that the pack can be written, and writes over no input. */
static int prepare(const bake_options *o)
{
    if (bake_same_file(o->heights_path, o->out_path) ||
        bake_same_file(o->color_path, o->out_path) || bake_same_file(o->lattice_path, o->out_path))
        return bake_fail("%s is the input: not overwritten", o->out_path);
    return pack_writer_prepare(o->out_path);
}

/* Names and files of the layers: --color's has no name; without it the first --layer is the first
 * one. 0 or -1 (said). */
static int take_layers(bake *b, bake_options *o)
{
    ff_layers *layers = &b->layers;
    if (o->color_path) b->layer_path[layers->count++] = o->color_path;
    for (size_t i = 0; i < o->layers.count; i++) {
        const char *text = o->layers.text[i], *end = strchr(text, '=');
        size_t bytes = end ? (size_t)(end - text) : 0;
        if (layers->count == FF_LAYERS_MAX)
            return bake_fail("a pack has at most %d layers of images", FF_LAYERS_MAX);
        if (!bytes || bytes > FF_LAYER_NAME_MAX || !end[1])
            return bake_fail("--layer %s: it is NAME=IMAGE, the name 1 to %d bytes", text,
                             FF_LAYER_NAME_MAX);
        char *name = layers->name[layers->count];
        memcpy(name, text, bytes);
        if (!ff_layer_name_ok(name)) return bake_fail("--layer %s: the name is no text", text);
        if (ff_layers_find(layers, name) >= 0)
            return bake_fail("--layer %s: there is a layer of this name", name);
        b->layer_path[layers->count++] = end + 1;
    }
    o->color_path = b->layer_path[0];
    for (uint32_t i = 0; i < layers->count; i++)
        if (o->out_path && bake_same_file(b->layer_path[i], o->out_path))
            return bake_fail("%s is the input: not overwritten", o->out_path);
    if (o->estimate && layers->count > 1)
        bake_note("--estimate counts the first of %u layers of images", layers->count);
    return 0;
}

/* Takes over what has to be alike so that packs can be joined. 0 or -1 (said). */
static int take_lattice(bake_options *o, bake_lattice *lattice)
{
    if (!o->lattice_path) return 0;
    if (bake_lattice_open(o->lattice_path, lattice)) return -1;
    o->lattice = lattice;
    o->node_log2 = lattice->info.node_log2;
    o->codec = lattice->info.codec;
    return 0;
}

int bake_run(const bake_options *told)
{
    bake_options own = *told, *options = &own;
    bake_lattice lattice = { .srs = NULL };
    bake b = { .options = options, .started_us = sys_time_us() };
    b.ground.grid = b.heights = b.marks = b.filled = BAKE_GRID_CLOSED;
    bake_temp_setup(options->out_path ? options->out_path : "/tmp/");
    if (take_layers(&b, options)) return -1;
    if (!options->estimate && prepare(options)) return -1;
    GDALAllRegister();
    GDALSetCacheMax64(GDAL_CACHE_BYTES);
    CPLSetErrorHandler(CPLQuietErrorHandler);
    int rc = take_lattice(options, &lattice);
    if (!rc) rc = options->estimate ? bake_estimate(&b) : make_pack(&b);
    pack_writer_close(&b.writer);
    bake_image_close(&b.image);
    bake_grid_close(&b.heights);
    bake_grid_close(&b.marks);
    bake_grid_close(&b.filled);
    bake_ground_close(&b.ground);
    bake_lattice_close(&lattice);
    return rc;
}
