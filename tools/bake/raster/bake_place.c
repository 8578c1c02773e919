#include "bake_place.h"

#include "../bake_say.h"
#include "bake_area.h"

#include <math.h>
#include <string.h>

/* A raster without a reference system whose corners are degrees is taken as WGS84 longitude and
 * latitude. */
static int looks_geographic(const double *gt, uint32_t width, uint32_t height)
{
    bake_area area = bake_area_of(gt, width, height);
    double cell = fmax(fmax(fabs(gt[1]), fabs(gt[2])), fmax(fabs(gt[4]), fabs(gt[5])));
    return cell < 0.5 && area.west >= -181 && area.east <= 361 && area.south >= -91 &&
           area.north <= 91;
}

/* Reads the geotransform: 0, or -1 for one that is none (said). */
static int read_geotransform(const bake_options *o, GDALDatasetH set, bake_ground *ground)
{
    double *gt = ground->geotransform, inverse[6];
    ground->has_place = !o->raw.width && GDALGetGeoTransform(set, gt) == CE_None;
    if (!ground->has_place) {
        double plain[6] = { 0, 1, 0, GDALGetRasterYSize(set), 0, -1 };
        memcpy(gt, plain, sizeof plain);
        return 0;
    }
    for (int i = 0; i < 6; i++)
        if (!isfinite(gt[i]))
            return bake_fail("%s: its georeference is not a number", o->heights_path);
    if (GDALInvGeoTransform(gt, inverse)) return 0;
    return bake_fail("%s: its georeference puts all samples on one line: give it another with "
                     "gdal_translate -a_ullr",
                     o->heights_path);
}

int bake_place_read(const bake_options *o, GDALDatasetH set, bake_ground *ground)
{
    if (read_geotransform(o, set, ground)) return -1;
    if (!ground->has_place) return 0;
    OGRSpatialReferenceH srs = GDALGetSpatialRef(set);
    if (srs) {
        ground->srs = OSRClone(srs);
    } else if (looks_geographic(ground->geotransform, (uint32_t)GDALGetRasterXSize(set),
                                (uint32_t)GDALGetRasterYSize(set)) &&
               !o->no_project) {
        bake_note(
            "%s names no reference system; its corners look like degrees: taken as WGS84 longitude and latitude",
            o->heights_path);
        ground->srs = OSRNewSpatialReference(NULL);
        OSRImportFromEPSG(ground->srs, 4326);
    }
    if (ground->srs) {
        if (OSRIsCompound(ground->srs)) OSRStripVertical(ground->srs);
        OSRSetAxisMappingStrategy(ground->srs, OAMS_TRADITIONAL_GIS_ORDER);
        ground->is_geographic = OSRIsGeographic(ground->srs);
    }
    return 0;
}
