#include "export_run.h"

#include "../bake/bake_say.h"
#include "export_mesh.h"
#include "export_pack.h"
#include "export_pyramid.h"
#include "export_raster.h"
#include "export_store.h"

#include <string.h>

#define GDAL_CACHE_BYTES (48 << 20)

static int is_pack(const export_options *o) { return o->estimate || export_pack_is(o->out_path); }

/* The number of the layer asked for, or of the first; -1 (said). */
static int choose_layer(const export_options *o, const ff_pack *pack)
{
    ff_layers layers;
    if (!o->layer) return 0;
    ff_pack_layers(pack, &layers);
    int number = ff_layers_find(&layers, o->layer);
    return number >= 0
               ? number
               : bake_fail("--layer %s: %s has no layer of this name", o->layer, o->pack_path);
}

/* The level asked for, or the finest, of heights or of a layer of images. 0 or -1 (said). */
static int choose_level(const export_options *o, const ff_pack *pack, unsigned layer,
                        uint32_t *level)
{
    uint32_t levels = o->images ? ff_pack_image_levels(pack, layer)
                                : ff_terrain_levels(&pack->header.info);
    if (!levels) return bake_fail("--images: %s has none", o->pack_path);
    *level = o->has_level ? o->level : levels - 1;
    if (*level < levels) return 0;
    return bake_fail("--level %u: %s has levels 0 to %u%s", *level, o->pack_path, levels - 1,
                     o->images ? " of images" : "");
}

static int write_ground(const export_options *o, export_ground *ground)
{
    if (o->mesh) return export_mesh_write(o, ground);
    if (export_raster_is(o->out_path)) return export_raster_write(o, ground);
    return export_pyramid_write(o, ground);
}

/* Temporary files lie beside the output, which may be a folder that is not there yet. */
static void set_temp_folder(const char *out_path)
{
    char path[EXPORT_PATH_BYTES];
    size_t length = strnlen(out_path, sizeof path - 1);
    while (length > 1 && out_path[length - 1] == '/') length--;
    memcpy(path, out_path, length);
    path[length] = 0;
    bake_temp_setup(path);
}

static int export_pack(const export_options *o, const bake_unpack *unpack)
{
    export_ground ground;
    uint32_t level = 0;
    int layer = choose_layer(o, &unpack->pack);
    if (layer < 0 || choose_level(o, &unpack->pack, (unsigned)layer, &level)) return -1;
    if (is_pack(o)) return export_pack_write(o, unpack, level);
    int is_raster = export_raster_is(o->out_path);
    if (!is_raster && !o->mesh && export_pyramid_check(o, &unpack->pack.header.info)) return -1;
    if (o->images ? export_ground_open_images(unpack, (unsigned)layer, level, &o->region, &ground)
                  : export_ground_open(unpack, level, &o->region, &ground))
        return -1;
    int rc = write_ground(o, &ground);
    export_ground_close(&ground);
    return rc;
}

static int check_output(const export_options *o)
{
    if (is_pack(o)) return export_pack_check(o);
    if (o->mesh) return export_mesh_check(o);
    if (export_raster_is(o->out_path)) return export_raster_check(o);
    if (export_store_kind_of(o->out_path) != EXPORT_STORE_NONE) return 0;
    return bake_fail(
        "%s: the ending must be .tif, .png, .jpg, .r16, .ffp, .pmtiles, .mbtiles, or a slash "
        "for a folder of map tiles",
        o->out_path);
}

int export_run(const export_options *o)
{
    bake_unpack unpack;
    GDALAllRegister();
    GDALSetCacheMax(GDAL_CACHE_BYTES);
    CPLSetErrorHandler(CPLQuietErrorHandler);
    if (o->out_path) set_temp_folder(o->out_path);
    if (check_output(o) || bake_unpack_open(&unpack, o->pack_path)) return -1;
    int rc = export_pack(o, &unpack);
    bake_unpack_close(&unpack);
    return rc;
}
