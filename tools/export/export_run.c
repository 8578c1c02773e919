#include "export_run.h"

#include "../bake/bake_say.h"
#include "export_raster.h"

#define GDAL_CACHE_BYTES (48 << 20)

/* The level asked for, or the finest, of heights or of images. 0 or -1 (said). */
static int choose_level(const export_options *o, const ff_terrain_info *info, uint32_t *level)
{
    uint32_t levels = o->images ? info->texture_levels : ff_terrain_levels(info);
    if (!levels) return bake_fail("--images: %s has none", o->pack_path);
    *level = o->has_level ? o->level : levels - 1;
    if (*level < levels) return 0;
    return bake_fail("--level %u: %s has levels 0 to %u%s", *level, o->pack_path, levels - 1,
                     o->images ? " of images" : "");
}

static int write_ground(const export_options *o, export_ground *ground)
{
    return export_raster_write(o, ground);
}

static int export_pack(const export_options *o, const bake_unpack *unpack)
{
    export_ground ground;
    uint32_t level = 0;
    if (choose_level(o, &unpack->pack.header.info, &level)) return -1;
    bake_temp_setup(o->out_path);
    if (o->images ? export_ground_open_images(unpack, level, &o->region, &ground)
                  : export_ground_open(unpack, level, &o->region, &ground))
        return -1;
    int rc = write_ground(o, &ground);
    export_ground_close(&ground);
    return rc;
}

int export_run(const export_options *o)
{
    bake_unpack unpack;
    GDALAllRegister();
    GDALSetCacheMax(GDAL_CACHE_BYTES);
    CPLSetErrorHandler(CPLQuietErrorHandler);
    if (!export_raster_is(o->out_path))
        return bake_fail("%s: the ending must be .tif, .png, .jpg or .r16", o->out_path);
    if (export_raster_check(o) || bake_unpack_open(&unpack, o->pack_path)) return -1;
    int rc = export_pack(o, &unpack);
    bake_unpack_close(&unpack);
    return rc;
}
