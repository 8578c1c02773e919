#include "merge_run.h"

#include "../../protocol/shape/ff_shape.h"
#include "../bake/bake_fault.h"
#include "../bake/bake_leftovers.h"
#include "../bake/bake_run.h"
#include "../bake/bake_say.h"
#include "../bake/bake_tiles.h"
#include "../bake/pack_writer.h"
#include "../bake/raster/bake_quantise.h"
#include "../bake/raster/bake_reference.h"
#include "merge_about.h"
#include "merge_images.h"
#include "merge_parts.h"
#include "merge_samples.h"

#include <inttypes.h>
#include <stdio.h>

#define GDAL_CACHE_BYTES (48 << 20)

/* One per run. */
typedef struct merge {
    const merge_options *options;
    uint32_t count;
    bake_unpack unpack[MERGE_PACKS_MAX];
    merge_place place[MERGE_PACKS_MAX];
    merge_lattice lattice;
    merge_samples samples;
    bake_image image;
    pack_writer writer;
    uint8_t list[FF_ABOUT_BYTES_MAX];
    int64_t started_us;
} merge;

/* ---- the packs ---- */

/* Makes sure that the pack can be written, and writes over no input. */
static int prepare(const merge_options *o)
{
    if (o->pack.count < 2) return bake_fail("two packs or more are wanted; try --help");
    for (size_t i = 0; i < o->pack.count; i++)
        if (bake_same_file(o->path[i], o->out_path))
            return bake_fail("%s is an input: not overwritten", o->out_path);
    return pack_writer_prepare(o->out_path);
}

static int open_packs(merge *m)
{
    for (; m->count < m->options->pack.count; m->count++)
        if (bake_unpack_open(&m->unpack[m->count], m->options->path[m->count])) return -1;
    return 0;
}

static double step_m(const ff_terrain_info *info)
{
    double own_m, base_m;
    bake_steps_of(info, &own_m, &base_m);
    return own_m;
}

/* How one pack's source is baked so that it joins the first. */
static int refuse(const merge *m, uint32_t which, const char *why)
{
    const char *path = m->unpack[which].path, *first = m->unpack[0].path;
    return bake_fail("%s and %s %s: bake the one's source anew, farfield-bake HEIGHTS --lattice %s "
                     "-o OUT.ffp",
                     path, first, why, first);
}

static int refuse_fault(const merge *m, uint32_t which, enum merge_fault fault)
{
    const ff_terrain_info *info = &m->unpack[which].pack.header.info,
                          *first = &m->unpack[0].pack.header.info;
    char why[160];
    switch (fault) {
        case MERGE_FITS: return 0;
        case MERGE_SYSTEM: return refuse(m, which, "have different reference systems");
        case MERGE_CURVE:
            return refuse(m, which, "fall away differently (--flat, --refraction or ellipsoid)");
        case MERGE_SPACING:
            snprintf(why, sizeof why, "have spacings of %.9g and %.9g m, no power of two apart",
                     merge_spacing_m(info), merge_spacing_m(first));
            return refuse(m, which, why);
        case MERGE_PLACES:
            return refuse(m, which, "have samples between each other's places, on unlike lattices");
        case MERGE_STEP:
            snprintf(why, sizeof why, "have heights in steps of %.9g and %.9g m%s", step_m(info),
                     step_m(first),
                     info->hscale_q24 == first->hscale_q24 ? " from unlike heights" : "");
            return refuse(m, which, why);
        case MERGE_RANGE:
            return bake_fail(
                "%s: its heights and those before span more than 65536 steps of %g m: bake "
                "all in coarser steps, farfield-bake HEIGHTS --hscale M -o OUT.ffp",
                m->unpack[which].path, step_m(info));
        case MERGE_NODES:
            return refuse(m, which, "have nodes of unlike size or codec (--node-log2, --codec)");
        case MERGE_LOSSY:
            return bake_fail(
                "%s has an error of %.9g m, and its heights would not stay as they are: "
                "merge packs baked with --max-error 0, or bake all sources in one, "
                "gdalbuildvrt ALL.vrt HEIGHTS... and farfield-bake ALL.vrt --max-error M "
                "-o OUT.ffp",
                m->unpack[which].path, info->max_error * step_m(info));
        case MERGE_FAR: break;
    }
    return bake_fail("%s and %s lie too far from each other for one terrain", m->unpack[which].path,
                     m->unpack[0].path);
}

static int find_lattice(merge *m)
{
    const ff_terrain_info *info[MERGE_PACKS_MAX];
    uint32_t which = 0;
    for (uint32_t i = 0; i < m->count; i++) {
        info[i] = &m->unpack[i].pack.header.info;
        if (!merge_about_same_system(&m->unpack[i].pack, &m->unpack[0].pack))
            return refuse_fault(m, i, MERGE_SYSTEM);
    }
    OGRSpatialReferenceH srs = bake_reference_of(&m->unpack[0].pack);
    if (!srs) bake_note("the packs name no reference system: taken as places of one plane");
    if (srs) OSRDestroySpatialReference(srs);
    enum merge_fault fault = merge_lattice_find(info, m->count, &m->lattice, m->place, &which);
    return fault ? refuse_fault(m, which, fault) : 0;
}

/* Describes the joint terrain as a bake would. */
static int describe(merge *m)
{
    merge_lattice *l = &m->lattice;
    ff_terrain_info *info = &l->info;
    char fault[200];
    info->tile_log2 = (uint8_t)bake_choose_tile_log2(info->node_log2, l->width, l->height,
                                                     info->spacing_wu);
    ff_shape_cover(info, l->width, l->height);
    const char *why = bake_fault(info, fault, sizeof fault) ? fault
                      : l->apart_log2 > info->tile_log2     ? "spacings are too far apart"
                                                            : NULL;
    if (why)
        return bake_fail("%u x %u samples of %g m do not make a terrain: %s", l->width, l->height,
                         merge_spacing_m(info), why);
    return 0;
}

/* ---- what is made ---- */

static int take_records(void *context, uint32_t section, const bake_blob *records,
                        const bake_blob *above)
{
    merge *m = context;
    return pack_writer_add(&m->writer, section, records, above);
}

static int make_tiles(merge *m)
{
    bake_tiles tiles = { .info = &m->lattice.info,
                         .samples = &m->samples.samples,
                         .image = &m->image,
                         .texture_quality = (int)m->options->texture_quality,
                         .block_log2 = BAKE_BLOCK_LOG2,
                         .jobs = m->options->jobs,
                         .context = m,
                         .take = take_records };
    return bake_tiles_make(&tiles);
}

/* Parts cut from a pack have stubs, and only that pack's other parts know what is below. */
static int check_whole(const merge *m)
{
    for (uint32_t i = 0; i < m->samples.count; i++) {
        const export_ground *ground = &m->samples.layer[i].ground;
        if (ground->error.samples_m > 0)
            return bake_fail(
                "%s is a part cut from a pack, and joins with other parts of that pack "
                "alone: join those first, or merge the pack itself",
                ground->unpack->path);
    }
    return 0;
}

static void report(const merge *m, uint64_t file_bytes)
{
    const ff_terrain_info *info = &m->lattice.info;
    uint64_t sum = 0;
    double seconds = (double)(sys_time_us() - m->started_us) / 1e6;
    for (uint32_t i = 0; i < m->count; i++) sum += m->unpack[i].pack.size;
    bake_note("%s: %u x %u places of %g m; %" PRIu64 " bytes, %.1f %% of the packs' %" PRIu64
              ", %.1f s",
              m->options->out_path, m->lattice.width, m->lattice.height, merge_spacing_m(info),
              file_bytes, 100.0 * (double)file_bytes / (double)sum, sum, seconds);
    if (!m->options->json) return;
    printf("{\"packs\": %u, \"samples_x\": %u, \"samples_y\": %u, \"spacing_m\": %.9g, "
           "\"uncovered\": %.6f, \"texture_levels\": %u, \"packs_bytes\": %" PRIu64
           ", \"file_bytes\": %" PRIu64 ", \"seconds\": %.3f}\n",
           m->count, m->lattice.width, m->lattice.height, merge_spacing_m(info), m->samples.gap,
           info->texture_levels, sum, file_bytes, seconds);
}

/* Parts of one pack go by records, all else by samples. */
static int join_parts(merge *m)
{
    m->lattice.info = m->unpack[0].pack.header.info;
    ff_sheet samples = ff_shape_sheet_samples(&m->lattice.info);
    m->lattice.width = samples.x;
    m->lattice.height = samples.y;
    if (pack_writer_open(&m->writer, &m->lattice.info) ||
        pack_writer_add_layers(&m->writer, &m->unpack[0].pack.header))
        return -1;
    m->writer.has_whole = 1;
    m->writer.whole = ff_pack_whole(&m->unpack[0].pack);
    return merge_parts_write(m->unpack, m->count, &m->writer);
}

static void say_layers(const merge *m)
{
    int more = 0;
    for (uint32_t i = 0; i < m->count; i++) more |= m->unpack[i].pack.header.layers > 1;
    if (more)
        bake_note(
            "the first layer of images alone is joined: only parts of one pack keep all of them");
}

static int join_samples(merge *m)
{
    say_layers(m);
    if (find_lattice(m) || describe(m)) return -1;
    if (merge_samples_open(m->unpack, m->place, m->count, &m->lattice, &m->samples) ||
        check_whole(m))
        return -1;
    if (m->samples.gap > 0)
        bake_note("no pack covers %.2g %% of the rectangle round them: filled from around it",
                  100 * m->samples.gap);
    if (merge_images_make(m->unpack, m->count, m->options->texture_quality, &m->samples.samples,
                          &m->lattice, &m->image))
        return -1;
    return pack_writer_open(&m->writer, &m->lattice.info) || make_tiles(m) ? -1 : 0;
}

static int make_pack(merge *m)
{
    uint64_t file_bytes;
    ff_list about;
    if (merge_about_make(m->options, m->unpack, m->count, m->list, &about)) return -1;
    if (merge_parts_are(m->unpack, m->count) ? join_parts(m) : join_samples(m)) return -1;
    m->writer.about = about;
    if (pack_writer_finish(&m->writer, m->options->out_path, &file_bytes)) return -1;
    report(m, file_bytes);
    return 0;
}

int merge_run(const merge_options *options)
{
    static merge m;
    m = (merge){ .options = options,
                 .started_us = sys_time_us(),
                 .samples.fill = BAKE_GRID_CLOSED };
    bake_temp_setup(options->out_path);
    GDALAllRegister();
    GDALSetCacheMax64(GDAL_CACHE_BYTES);
    CPLSetErrorHandler(CPLQuietErrorHandler);
    int rc = prepare(options) || open_packs(&m) || make_pack(&m) ? -1 : 0;
    pack_writer_close(&m.writer);
    bake_image_close(&m.image);
    merge_samples_close(&m.samples);
    while (m.count > 0) bake_unpack_close(&m.unpack[--m.count]);
    return rc;
}
