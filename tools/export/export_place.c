#include "export_place.h"

#include "../../protocol/shape/ff_shape.h"
#include "../bake/bake_say.h"

#include <math.h>

#define EDGE_POINTS 64 /* along each side of a box that is projected, and inside it */
#define EPSG_WGS84  4326

/* ---- lattices ---- */

static double spacing_m(const ff_terrain_info *info)
{
    return (double)info->spacing_wu / FF_WU_PER_METRE;
}

export_lattice export_lattice_samples(const ff_terrain_info *info, uint32_t level)
{
    uint32_t skip = ff_terrain_levels(info) - 1 - level;
    ff_sheet samples = ff_shape_sheet_samples(info);
    return (export_lattice){ ((samples.x - 1) >> skip) + 1, ((samples.y - 1) >> skip) + 1,
                             spacing_m(info) * (double)(1u << skip) };
}

export_lattice export_lattice_texels(const ff_terrain_info *info, uint32_t level)
{
    ff_sheet samples = ff_shape_sheet_samples(info);
    double texels_a_sample = (double)(((1u << info->texture_log2) - 1)) * (double)(1u << level) /
                             (double)(1u << info->tile_log2);
    return (export_lattice){ (uint32_t)ceil((samples.x - 1) * texels_a_sample) + 1,
                             (uint32_t)ceil((samples.y - 1) * texels_a_sample) + 1,
                             spacing_m(info) / texels_a_sample };
}

void export_place_geotransform(const ff_terrain_info *info, const export_lattice *lattice,
                               const export_window *window, double geotransform[6])
{
    double step = lattice->spacing_m;
    geotransform[0] = (double)info->origin_x_mm / 1000 + (window->left - 0.5) * step;
    geotransform[1] = step;
    geotransform[2] = 0;
    geotransform[3] = (double)info->origin_y_mm / 1000 +
                      ((double)window->bottom + window->height - 0.5) * step;
    geotransform[4] = 0;
    geotransform[5] = -step;
}

/* ---- degrees ---- */

/* From the pack's plane to degrees, or back; NULL after saying why. */
static OGRCoordinateTransformationH transformation(OGRSpatialReferenceH plane, int to_degrees)
{
    OGRSpatialReferenceH wgs84 = OSRNewSpatialReference(NULL);
    OSRImportFromEPSG(wgs84, EPSG_WGS84);
    OSRSetAxisMappingStrategy(wgs84, OAMS_TRADITIONAL_GIS_ORDER);
    CPLErrorReset();
    OGRCoordinateTransformationH made = to_degrees ? OCTNewCoordinateTransformation(plane, wgs84)
                                                   : OCTNewCoordinateTransformation(wgs84, plane);
    OSRDestroySpatialReference(wgs84);
    if (!made) bake_fail_gdal("the pack's reference system cannot be brought to degrees");
    return made;
}

static void widen(export_bounds *bounds, double x, double y)
{
    bounds->west = fmin(bounds->west, x);
    bounds->south = fmin(bounds->south, y);
    bounds->east = fmax(bounds->east, x);
    bounds->north = fmax(bounds->north, y);
}

/* The box round the image of all of a box. Longitudes are taken round `middle`, unless it is NAN.
 * 0, or -1: it has no image. */
static int project_box(OGRCoordinateTransformationH how, const export_bounds *from, double middle,
                       export_bounds *to)
{
    int found = 0;
    *to = (export_bounds){ INFINITY, INFINITY, -INFINITY, -INFINITY };
    for (int j = 0; j <= EDGE_POINTS; j++)
        for (int i = 0; i <= EDGE_POINTS; i++) {
            double x = from->west + (from->east - from->west) * i / EDGE_POINTS,
                   y = from->south + (from->north - from->south) * j / EDGE_POINTS;
            if (!OCTTransform(how, 1, &x, &y, NULL) || !isfinite(x) || !isfinite(y)) continue;
            if (!isnan(middle)) x = middle + remainder(x - middle, 360);
            widen(to, x, y);
            found = 1;
        }
    return found ? 0 : -1;
}

static export_bounds plane_box(const ff_terrain_info *info)
{
    int64_t size_wu[2];
    ff_shape_size_wu(info, size_wu);
    double west = (double)info->origin_x_mm / 1000, south = (double)info->origin_y_mm / 1000;
    return (export_bounds){ west, south, west + (double)size_wu[0] / FF_WU_PER_METRE,
                            south + (double)size_wu[1] / FF_WU_PER_METRE };
}

int export_place_degrees(OGRSpatialReferenceH srs, const export_bounds *plane,
                         export_bounds *bounds)
{
    OGRCoordinateTransformationH how = transformation(srs, 1);
    if (!how) return -1;
    double x = (plane->west + plane->east) / 2, y = (plane->south + plane->north) / 2;
    int rc = !OCTTransform(how, 1, &x, &y, NULL) || !isfinite(x) ||
                     project_box(how, plane, x, bounds)
                 ? bake_fail("the pack's place cannot be told in degrees")
                 : 0;
    OCTDestroyCoordinateTransformation(how);
    if (rc) return rc;
    double turns = 360 * floor((bounds->west + 180) / 360);
    bounds->west -= turns;
    bounds->east -= turns;
    return 0;
}

/* ---- a region ---- */

/* The part of the region that is within the bounds, widened by a little since bounds are those of
 * points; a region of both ends of the map may have two parts, and all between them is taken. 0, or
 * -1: none. */
static int clip_region(const bake_box *region, const export_bounds *bounds, export_bounds *part)
{
    double width = bounds->east - bounds->west, height = bounds->north - bounds->south,
           slack_x = width / EDGE_POINTS, slack_y = height / EDGE_POINTS;
    double west = region->west, east = region->east <= west ? region->east + 360 : region->east;
    *part = (export_bounds){ INFINITY, fmax(region->south, bounds->south - slack_y), -INFINITY,
                             fmin(region->north, bounds->north + slack_y) };
    for (int turn = -360; turn <= 360; turn += 360) {
        double from = fmax(west + turn, bounds->west - slack_x),
               to = fmin(east + turn, bounds->east + slack_x);
        if (from >= to) continue;
        part->west = fmin(part->west, from);
        part->east = fmax(part->east, to);
    }
    return part->west < part->east && part->south < part->north ? 0 : -1;
}

/* Points low..high of an axis that hold from..to, at least two of `count`. 0, or -1: none. */
static int choose_points(double from, double to, uint32_t count, uint32_t *low, uint32_t *points)
{
    double first = fmax(floor(from), 0), last = fmin(ceil(to), count - 1.0);
    if (first > count - 1.0 || last < 0) return -1;
    if (last <= first && last + 1 < count) last = first + 1;
    if (last <= first) first = last - 1;
    *low = (uint32_t)first;
    *points = (uint32_t)(last - first) + 1;
    return 0;
}

static int choose_window(const ff_terrain_info *info, const export_lattice *lattice,
                         OGRSpatialReferenceH srs, const bake_box *region, export_window *window)
{
    export_bounds all = plane_box(info), bounds, part, plane;
    if (export_place_degrees(srs, &all, &bounds)) return -1;
    int rc = clip_region(region, &bounds, &part);
    if (!rc) {
        OGRCoordinateTransformationH how = transformation(srs, 0);
        if (!how) return -1;
        rc = project_box(how, &part, NAN, &plane);
        OCTDestroyCoordinateTransformation(how);
    }
    double west = (double)info->origin_x_mm / 1000, south = (double)info->origin_y_mm / 1000,
           step = lattice->spacing_m;
    if (!rc)
        rc = choose_points((plane.west - west) / step, (plane.east - west) / step, lattice->width,
                           &window->left, &window->width);
    if (!rc)
        rc = choose_points((plane.south - south) / step, (plane.north - south) / step,
                           lattice->height, &window->bottom, &window->height);
    if (!rc) return 0;
    return bake_fail("--region lies beside the pack, which covers %.5f,%.5f,%.5f,%.5f", bounds.west,
                     bounds.south, remainder(bounds.east, 360), bounds.north);
}

int export_place_window(const ff_terrain_info *info, OGRSpatialReferenceH srs,
                        const export_lattice *lattice, const bake_box *region,
                        export_window *window)
{
    *window = (export_window){ 0, 0, lattice->width, lattice->height };
    if (!region->is_given) return 0;
    if (!srs)
        return bake_fail(
            "--region needs a pack whose reference system is known: this one's is not");
    return choose_window(info, lattice, srs, region, window);
}
