#include "bake_place.h"

#include "../bake_say.h"
#include "bake_area.h"

#include <math.h>
#include <string.h>

#define UNITS_MAX 1e12 /* of any plane: no reckoning with such numbers overflows */

int bake_place_looks_geographic(const double *gt, uint32_t width, uint32_t height)
{
    bake_area area = bake_area_of(gt, width, height);
    double cell = fmax(fmax(fabs(gt[1]), fabs(gt[2])), fmax(fabs(gt[4]), fabs(gt[5])));
    return cell < 0.5 && area.west >= -181 && area.east <= 361 && area.south >= -91 &&
           area.north <= 91;
}

int bake_place_check(const char *path, GDALDatasetH set)
{
    static const struct {
        const char *domain, *what, *flag;
    } model[] = { { "RPC", "a sensor model (RPC)", "-rpc " },
                  { "GEOLOCATION", "arrays of longitudes and latitudes", "-geoloc " } };
    if (GDALGetGCPCount(set) > 0)
        return bake_fail("%s is placed by ground control points: make a grid of it first with "
                         "gdalwarp -r cubic",
                         path);
    for (size_t i = 0; i < sizeof model / sizeof *model; i++)
        if (GDALGetMetadata(set, model[i].domain))
            return bake_fail("%s is placed by %s: make a grid of it first with gdalwarp %s-r cubic",
                             path, model[i].what, model[i].flag);
    return 0;
}

/* Whether there is a geotransform, the raster's own or one that its control points agree on. */
static int has_geotransform(GDALDatasetH set, double *gt)
{
    if (GDALGetGeoTransform(set, gt) == CE_None) return 1;
    int count = GDALGetGCPCount(set);
    return count > 2 && GDALGCPsToGeoTransform(count, GDALGetGCPs(set), gt, FALSE);
}

/* Reads the geotransform: 0, or -1 for one that is none (said). */
static int read_geotransform(const bake_options *o, GDALDatasetH set, bake_ground *ground)
{
    double *gt = ground->geotransform, inverse[6];
    ground->has_place = !o->raw.width && has_geotransform(set, gt);
    if (!ground->has_place) {
        if (!o->raw.width && !o->no_project && bake_place_check(o->heights_path, set)) return -1;
        double plain[6] = { 0, 1, 0, GDALGetRasterYSize(set), 0, -1 };
        memcpy(gt, plain, sizeof plain);
        return 0;
    }
    for (int i = 0; i < 6; i++)
        if (!(fabs(gt[i]) <= UNITS_MAX))
            return bake_fail("%s: its georeference, %g, is no place", o->heights_path, gt[i]);
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
    if (!srs) srs = GDALGetGCPSpatialRef(set);
    if (srs) {
        ground->srs = OSRClone(srs);
    } else if (bake_place_looks_geographic(ground->geotransform, (uint32_t)GDALGetRasterXSize(set),
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
