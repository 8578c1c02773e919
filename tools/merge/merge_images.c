#include "merge_images.h"

#include "../bake/bake_say.h"
#include "../export/export_ground.h"

/* Images of packs as rasters, each over those before it. */
typedef struct mosaic {
    export_ground ground[MERGE_PACKS_MAX];
    uint32_t count, texture_log2;
    GDALDatasetH set;
} mosaic;

static int open_images(const bake_unpack *unpack, mosaic *m)
{
    static const bake_box everywhere;
    const ff_terrain_info *info = &unpack->pack.header.info;
    if (!info->texture_levels) return 0;
    if (export_ground_open_images(unpack, 0, info->texture_levels - 1u, &everywhere,
                                  &m->ground[m->count]))
        return -1;
    if (info->texture_log2 > m->texture_log2) m->texture_log2 = info->texture_log2;
    m->count++;
    return 0;
}

/* Stable: of texels as fine those of the pack named first come last. */
static void sort_images(mosaic *m)
{
    for (uint32_t i = 1; i < m->count; i++) {
        export_ground moved = m->ground[i];
        uint32_t at = i;
        for (; at > 0 && m->ground[at - 1].lattice.spacing_m < moved.lattice.spacing_m; at--)
            m->ground[at] = m->ground[at - 1];
        m->ground[at] = moved;
    }
}

/* One raster in the finest of the resolutions, with alpha: what no image covers is clear. */
static int join_images(mosaic *m)
{
    char *words[] = { "-resolution", "highest", "-r", "bilinear", "-addalpha", NULL };
    GDALDatasetH set[MERGE_PACKS_MAX];
    for (uint32_t i = 0; i < m->count; i++) set[i] = m->ground[i].set;
    GDALBuildVRTOptions *options = GDALBuildVRTOptionsNew(words, NULL);
    m->set = GDALBuildVRT("", (int)m->count, set, NULL, options, NULL);
    GDALBuildVRTOptionsFree(options);
    return m->set ? 0 : bake_fail_gdal("cannot put the images together");
}

/* Between samples of unlike spacing no colours are known. */
static int lay(const mosaic *m, uint32_t quality, const bake_samples *heights, merge_lattice *l,
               bake_image *image)
{
    double spacing_m = merge_spacing_m(&l->info), east_m = (double)l->info.origin_x_mm / 1000,
           north_m = (double)l->info.origin_y_mm / 1000;
    bake_options options = { .texture_log2 = m->texture_log2, .texture_quality = quality };
    bake_ground ground = { .grid = { .fd = -1, .width = l->width, .height = l->height },
                           .geotransform = { east_m - spacing_m / 2, spacing_m, 0,
                                             north_m + (l->height - 0.5) * spacing_m, 0,
                                             -spacing_m } };
    bake_note("images are made anew, with quality %u", quality);
    return bake_image_lay(&options, m->set, &ground, l->apart_log2 ? NULL : heights, &l->info,
                          image);
}

int merge_images_make(const bake_unpack unpack[], uint32_t count, uint32_t quality,
                      const bake_samples *heights, merge_lattice *lattice, bake_image *image)
{
    mosaic m = { .count = 0 };
    int rc = 0;
    for (uint32_t i = count; !rc && i-- > 0;) rc = open_images(&unpack[i], &m);
    sort_images(&m);
    if (!rc && m.count) rc = join_images(&m);
    if (!rc && m.count) rc = lay(&m, quality, heights, lattice, image);
    if (m.set) GDALClose(m.set);
    for (uint32_t i = 0; i < m.count; i++) export_ground_close(&m.ground[i]);
    return rc;
}
