#include "property_draw.h"

#include "property_surface.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define AREA_DEGREES 0.1
#define DEGREE_M     111195.0 /* of the Earth, mean */

/* clang-format off */
static const property_place places[] = {
    { "UTM north",             "EPSG:32632",      6,    1,   12,   83, 0 },
    { "UTM south",             "EPSG:32719",    -72,  -79,  -66,   -1, 0 },
    { "Web Mercator",          "EPSG:3857",    -170,  -75,  170,   75, 0 },
    { "degrees",               "EPSG:4326",    -170,  -75,  170,   75, 0 },
    { "degrees across 180",    "EPSG:4326",   179.9,  -60, 180.1,  60, 0 },
    { "conic 2SP",             "EPSG:2154",       0,   43,    6,   50, 0 },
    { "conic 2SP in feet",     "EPSG:2263",     -74, 40.6, -72.5,  41, 0 },
    { "azimuthal equal area",  "EPSG:3035",       0,   38,   25,   60, 0 },
    { "TM in US feet",         "EPSG:2260",   -75.3,   41, -73.5,  44, 0 },
    { "polar stereographic N", "EPSG:3413",    -180,   66,  180, 89.9, 0 },
    { "polar stereographic S", "EPSG:3031",    -180, -89.9, 180,  -66, 0 },
    { "UPS north",             "EPSG:32661",   -180,   84,  180, 89.9, 0 },
    { "oblique Mercator",      "EPSG:26931",   -134,   55, -131,   58, 0 },
    { "Swiss LV95",            "EPSG:2056",       6,   46,   10, 47.5, 0 },
    { "British grid",          "EPSG:27700",     -5, 50.5,    1,   56, 0 },
    { "Krovak",                "EPSG:5514",      13,   49,   18, 50.5, 0 },
    { "TM south orientated",   "EPSG:2053",      28,  -33,   30,  -23, 0 },
    { "NAD83 degrees",         "EPSG:4269",    -120,   26,  -70,   48, 0 },
    { "NAD27 degrees",         "EPSG:4267",    -120,   26,  -70,   48, 0 },
    { "ETRS89 degrees",        "EPSG:4258",      -5,   40,   25,   65, 0 },
    { "grads from Paris",      "EPSG:4807",       0,   43,    6,   50, 0 },
    { "compound degrees",      "EPSG:4326+5773", -170, -70, 170,   70, 0 },
    { "plate carree",          "EPSG:4087",    -170,  -70,  170,   70, 0 },
    { "sinusoidal",            "+proj=sinu +R=6371007.181 +units=m", -30, -60, 30, 60, 0 },
    { "TM, huge offsets",      "+proj=tmerc +lon_0=20 +k=1 +x_0=40000000 +y_0=-9000000 +datum=WGS84 +units=m", 18, -60, 22, 60, 0 },
    { "Mars degrees",          "+proj=longlat +R=3396190 +no_defs",  -170, -75, 170, 75, 3396190 },
    { "Mars plate carree",     "+proj=eqc +R=3396190 +units=m",      -170, -70, 170, 70, 3396190 },
    { "Moon stereographic",    "+proj=stere +lat_0=-90 +R=1737400 +units=m", -180, -89, 180, -80, 1737400 },
    { "local metres",          NULL, 0, 0, 0, 0, 0 },
    { "no place",              "",   0, 0, 0, 0, 0 },
};
static const char *const transform_names[TRANSFORMS + 1] = {
    "north up", "south up", "westwards", "exchanged", "exchanged backwards", "turned", "turned, mirrored", "sheared", "cells unlike",
    "pixel is point", "fine", "coarse", "cells no multiple of 1/256 m"
};
static const char *const voids_names[VOIDS + 1] = { "none", "nodata", "untagged sentinel", "NaN", "mask", "alpha", "--nodata" };
static const char *const file_names[FILES + 1] = { "GTiff", "VRT", "PNG + world file", "AAIGrid", "raw", "netCDF", "HGT" };
static const char *const option_names[OPTIONS + 1] = {
    "none", "--max-error", "--spacing", "--t-srs", "--densify", "--node-log2, --tile-log2", "--codec", "--jobs", "--no-project",
    "--void-height", "--rim-void-height", "scale and offset"
};
static const char *const factor_names[PROPERTY_FACTORS] = { "place", "geotransform", "type", "voids", "file", "option" };
static const GDALDataType types[] = { GDT_Byte, GDT_Int16, GDT_UInt16, GDT_Int32, GDT_UInt32, GDT_Float32, GDT_Float64 };
static const struct { const char *name; double metres; } units[] = {
    { "", 1 }, { "m", 1 }, { "ft", 0.3048 }, { "US survey foot", 1200.0 / 3937 }, { "dm", 0.1 }, { "km", 1000 }, { "fathom", 1.8288 },
};
/* clang-format on */
enum {
    PLACES = sizeof places / sizeof *places,
    TYPES = sizeof types / sizeof *types,
    UNITS = sizeof units / sizeof *units
};
static const int levels[PROPERTY_FACTORS] = { PLACES, TRANSFORMS, TYPES, VOIDS, FILES, OPTIONS };

const char *property_factor_name(enum property_factor factor) { return factor_names[factor]; }

const char *property_level_name(enum property_factor factor, int level)
{
    if (level >= levels[factor]) return NULL;
    if (factor == PROPERTY_PLACE) return places[level].name;
    if (factor == PROPERTY_TYPE) return GDALGetDataTypeName(types[level]);
    const char *const *names[PROPERTY_FACTORS] = { NULL,        transform_names, NULL,
                                                   voids_names, file_names,      option_names };
    return names[factor][level];
}

/* splitmix64 (Steele, Lea, Flood 2014) */
static uint64_t next(property_draw *d)
{
    uint64_t z = d->chance += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

double property_chance(property_draw *d) { return (double)(next(d) >> 11) / 9007199254740992.0; }

static double between(property_draw *d, double low, double high)
{
    return low + (high - low) * property_chance(d);
}

static int pick(property_draw *d, int count) { return (int)(next(d) % (uint64_t)count); }

int property_has(const property_draw *d, enum property_option option)
{
    return d->options >> option & 1;
}

int property_is_whole(const property_draw *d)
{
    return d->type != GDT_Float32 && d->type != GDT_Float64;
}

OGRSpatialReferenceH property_reference(const char *name)
{
    if (!name || !*name) return NULL;
    OGRSpatialReferenceH srs = OSRNewSpatialReference(NULL);
    if (OSRSetFromUserInput(srs, name) != OGRERR_NONE) {
        OSRDestroySpatialReference(srs);
        return NULL;
    }
    OSRSetAxisMappingStrategy(srs, OAMS_TRADITIONAL_GIS_ORDER);
    return srs;
}

OGRSpatialReferenceH property_degrees(const property_draw *d)
{
    char text[80];
    if (!d->place->srs || !*d->place->srs) return NULL;
    if (d->place->radius_m <= 0) return property_reference("EPSG:4326");
    snprintf(text, sizeof text, "+proj=longlat +R=%.9g +no_defs", d->place->radius_m);
    return property_reference(text);
}

OGRCoordinateTransformationH property_transformation(const property_draw *d,
                                                     OGRSpatialReferenceH from,
                                                     OGRSpatialReferenceH to)
{
    OGRCoordinateTransformationOptionsH options = OCTNewCoordinateTransformationOptions();
    if (d->place->radius_m <= 0 && fabs(d->longitude) < 179)
        OCTCoordinateTransformationOptionsSetAreaOfInterest(
            options, fmax(d->longitude - AREA_DEGREES, -180), fmax(d->latitude - AREA_DEGREES, -90),
            fmin(d->longitude + AREA_DEGREES, 180), fmin(d->latitude + AREA_DEGREES, 90));
    OGRCoordinateTransformationH made = OCTNewCoordinateTransformationEx(from, to, options);
    OCTDestroyCoordinateTransformationOptions(options);
    return made;
}

/* ---- levels ---- */

/* Forces the pair of levels that the number stands for. */
static void force_pair(property_draw *d)
{
    int pairs = 0;
    for (int a = 0; a < PROPERTY_FACTORS; a++)
        for (int b = a + 1; b < PROPERTY_FACTORS; b++) pairs += levels[a] * levels[b];
    /* neighbours in number are far apart in the list: 7919 is a prime, and no factor of it */
    int n = (int)((d->number * 7919ull + d->seed) % (uint64_t)pairs);
    for (int a = 0; a < PROPERTY_FACTORS; a++)
        for (int b = a + 1; b < PROPERTY_FACTORS; b++) {
            if (n >= 0 && n < levels[a] * levels[b]) {
                d->level[a] = n / levels[b];
                d->level[b] = n % levels[b];
            }
            n -= levels[a] * levels[b];
        }
}

static int is_upright(const property_draw *d)
{
    int t = d->level[PROPERTY_TRANSFORM];
    return t == TRANSFORM_NORTH_UP || t == TRANSFORM_POINT || t == TRANSFORM_FINE ||
           t == TRANSFORM_COARSE || t == TRANSFORM_UNEVEN;
}

static int place_of(const char *name)
{
    for (int i = 0; i < PLACES; i++)
        if (!strcmp(places[i].name, name)) return i;
    return 0;
}

/* A header always tells a place, and netCDF knows few projections (CF's). Grads do not survive
 * GDAL's .prj files: they come back as degrees from a meridian that is none. */
static void settle_place(property_draw *d)
{
    static const char *const none[] = { "oblique Mercator", "Swiss LV95", "Krovak", "no place" };
    int *level = d->level, file = level[PROPERTY_FILE];
    const char *place = places[level[PROPERTY_PLACE]].name;
    if (file == FILE_AAIGRID && !strcmp(place, "no place"))
        level[PROPERTY_PLACE] = place_of("local metres");
    if (file == FILE_AAIGRID && !strcmp(place, "grads from Paris"))
        level[PROPERTY_PLACE] = place_of("degrees");
    for (size_t i = 0; i < sizeof none / sizeof *none; i++)
        if (file == FILE_NETCDF && !strcmp(place, none[i]))
            level[PROPERTY_PLACE] = place_of("UTM north");
}

/* What the file's format can hold. */
static void settle_file(property_draw *d)
{
    int *level = d->level, file = level[PROPERTY_FILE];
    int is_plain = file == FILE_PNG || file == FILE_RAW, is_hgt = file == FILE_HGT;
    if (is_plain || file == FILE_AAIGRID || file == FILE_NETCDF || is_hgt)
        if (level[PROPERTY_VOIDS] >= VOIDS_SENTINEL && level[PROPERTY_VOIDS] != VOIDS_OPTION)
            level[PROPERTY_VOIDS] = VOIDS_NODATA;
    if (file == FILE_RAW && level[PROPERTY_VOIDS]) level[PROPERTY_VOIDS] = VOIDS_OPTION;
    if (is_plain) level[PROPERTY_TYPE] = 2; /* UInt16 */
    if (is_hgt) level[PROPERTY_TYPE] = 1;   /* Int16 */
    if (file == FILE_PNG) level[PROPERTY_PLACE] = place_of("local metres");
    if (file == FILE_RAW) level[PROPERTY_PLACE] = place_of("no place");
    if (is_hgt) level[PROPERTY_PLACE] = place_of("degrees");
    settle_place(d);
    /* a header tells one cell size, or one per axis; a world file any cell */
    int t = level[PROPERTY_TRANSFORM],
        fits = (is_upright(d) || t == TRANSFORM_UNLIKE) && t != TRANSFORM_POINT;
    if (file == FILE_PNG) fits = t != TRANSFORM_POINT;
    if (file >= FILE_PNG && (!fits || is_hgt || file == FILE_RAW))
        level[PROPERTY_TRANSFORM] = TRANSFORM_NORTH_UP;
}

static void settle(property_draw *d)
{
    int *level = d->level;
    /* 1201 x 1201 samples take a while */
    if (level[PROPERTY_FILE] == FILE_HGT && pick(d, 8)) level[PROPERTY_FILE] = FILE_GTIFF;
    settle_file(d);
    d->place = &places[level[PROPERTY_PLACE]];
    if (d->place->srs && !*d->place->srs) level[PROPERTY_TRANSFORM] = TRANSFORM_NORTH_UP;
    d->type = types[level[PROPERTY_TYPE]];
    int is_signed = d->type != GDT_Byte && d->type != GDT_UInt16 && d->type != GDT_UInt32;
    if ((level[PROPERTY_VOIDS] == VOIDS_NAN && property_is_whole(d)) ||
        (level[PROPERTY_VOIDS] == VOIDS_SENTINEL && !is_signed))
        level[PROPERTY_VOIDS] = VOIDS_MASK;
}

static int is_metric_plane(const property_draw *d)
{
    OGRSpatialReferenceH srs = property_reference(d->place->srs);
    int metric = !srs || (!OSRIsGeographic(srs) && fabs(OSRGetLinearUnits(srs, NULL) - 1) < 1e-9);
    if (srs) OSRDestroySpatialReference(srs);
    return metric;
}

static void choose_options(property_draw *d)
{
    d->options = 1u << d->level[PROPERTY_OPTION];
    for (int o = 1; o < OPTIONS; o++)
        if (pick(d, 6) == 0) d->options |= 1u << o;
    int has_reference = d->place->srs && *d->place->srs, t = d->level[PROPERTY_TRANSFORM];
    uint32_t never = 1u << OPTION_NONE;
    if (!has_reference || d->place->radius_m > 0) never |= 1u << OPTION_T_SRS;
    /* cells that are no squares, or no multiple of 1/256 m, are not kept as they are */
    if (!has_reference || !is_upright(d) || t >= TRANSFORM_FINE || !is_metric_plane(d))
        never |= 1u << OPTION_NO_PROJECT;
    if (!d->level[PROPERTY_VOIDS]) never |= 1u << OPTION_VOID_HEIGHT | 1u << OPTION_RIM_HEIGHT;
    if (d->level[PROPERTY_FILE] >= FILE_PNG) never |= 1u << OPTION_SCALE;
    if (d->place->srs && !has_reference) never |= 1u << OPTION_SPACING;
    /* 20 million samples take their time */
    if (d->level[PROPERTY_FILE] == FILE_HGT) never |= 1u << OPTION_DENSIFY;
    d->options &= ~never;
    if (property_has(d, OPTION_NO_PROJECT))
        d->options &= ~(1u << OPTION_SPACING | 1u << OPTION_T_SRS);
}

/* ---- the place ---- */

/* Turns a cell along and a cell down into a geotransform round the middle of the raster. */
static void lay_out(property_draw *d, double x, double y, double along, double down)
{
    int t = d->level[PROPERTY_TRANSFORM];
    double a = 0, shear = 0, *gt = d->gt;
    if (t == TRANSFORM_TURNED || t == TRANSFORM_MIRRORED || t == TRANSFORM_SHEARED)
        a = between(d, 0.02, 6.26);
    if (t == TRANSFORM_UNLIKE || t == TRANSFORM_SHEARED) down *= between(d, 0.6, 1.6);
    if (t == TRANSFORM_SHEARED) shear = between(d, -0.4, 0.4) * along;
    if (t == TRANSFORM_SOUTH_UP || t == TRANSFORM_MIRRORED) down = -down;
    if (t == TRANSFORM_WESTWARDS) along = -along;
    gt[1] = along * cos(a);
    gt[4] = along * sin(a);
    gt[2] = shear * cos(a) + down * sin(a);
    gt[5] = shear * sin(a) - down * cos(a);
    if (t == TRANSFORM_EXCHANGED || t == TRANSFORM_EXCHANGED_BACK) {
        double way = t == TRANSFORM_EXCHANGED ? 1 : -1;
        gt[1] = gt[5] = 0;
        gt[2] = way * along;
        gt[4] = -way * down;
    }
    gt[0] = x - gt[1] * d->columns / 2.0 - gt[2] * d->rows / 2.0;
    gt[3] = y - gt[4] * d->columns / 2.0 - gt[5] * d->rows / 2.0;
}

/* A cell's length in metres. */
static double choose_cell(property_draw *d)
{
    static const double usual[] = { 0.5, 1, 2, 5, 10, 12.5, 25, 30, 90 };
    int t = d->level[PROPERTY_TRANSFORM];
    if (t == TRANSFORM_FINE) return between(d, 0.01, 0.3);
    if (t == TRANSFORM_COARSE) return between(d, 150, 900);
    if (t == TRANSFORM_UNEVEN) return between(d, 1, 60);
    return usual[pick(d, sizeof usual / sizeof *usual)];
}

static int lay_on_body(property_draw *d)
{
    OGRSpatialReferenceH srs = property_reference(d->place->srs), degrees = property_degrees(d);
    if (!srs || !degrees) return -1;
    const property_place *at = d->place;
    double cell = choose_cell(d), along, down, x, y;
    d->longitude = x = between(d, at->west, at->east);
    d->latitude = y = between(d, at->south, at->north);
    OGRCoordinateTransformationH to = property_transformation(d, degrees, srs);
    int ok = to && OCTTransform(to, 1, &x, &y, NULL);
    along = down = cell / OSRGetLinearUnits(srs, NULL);
    if (OSRIsGeographic(srs)) {
        double radius = at->radius_m > 0 ? at->radius_m : DEGREE_M * 57.29577951308232;
        along = down = cell / radius / OSRGetAngularUnits(srs, NULL);
        if (pick(d, 2)) along /= cos(d->latitude / 57.29577951308232);
        /* 179.95 and -179.95 lie side by side: one raster goes on beyond 180 */
        if (d->longitude > 175 && x < 0) x += 360;
        if (d->level[PROPERTY_FILE] == FILE_AAIGRID) down = along;
    }
    if (d->level[PROPERTY_FILE] == FILE_HGT) {
        along = down = 1 / 1200.0;
        x = floor(x) + 0.5;
        y = floor(y) + 0.5;
        d->longitude = x;
        d->latitude = y;
    }
    if (ok) lay_out(d, x, y, along, down);
    if (to) OCTDestroyCoordinateTransformation(to);
    OSRDestroySpatialReference(srs);
    OSRDestroySpatialReference(degrees);
    return ok ? 0 : -1;
}

static int lay_on_plane(property_draw *d)
{
    static const double offsets[] = { 5000, 500000, 40000000, 1e9 };
    double cell = choose_cell(d), offset = offsets[pick(d, 4)];
    if (d->place->srs) { /* no place: the middle of the first sample is the origin */
        cell = ceil(cell * 256) / 256;
        double x = (d->columns - 1) * cell / 2, y = (d->rows - 1) * cell / 2;
        d->spacing_m = cell;
        lay_out(d, x, y, cell, cell);
        return 0;
    }
    lay_out(d, offset + between(d, 0, 1000), pick(d, 2) ? -offset : offset, cell, cell);
    return 0;
}

/* ---- heights ---- */

static void value_range(GDALDataType type, double *low, double *high)
{
    *low = type == GDT_Int16 ? -32000 : type == GDT_Int32 ? -2e9 : 2;
    *high = type == GDT_Byte     ? 252
            : type == GDT_Int16  ? 32000
            : type == GDT_UInt16 ? 65000
            : type == GDT_UInt32 ? 4e9
                                 : 2e9;
    if (type == GDT_Float32 || type == GDT_Float64) *low = -1e30, *high = 1e30;
}

static double value_of(const property_draw *d, double metres)
{
    return (metres / d->unit_m - d->offset) / d->scale;
}

/* Heights of a few hundred metres that the type can hold; else plain metres; else what it holds. */
static void choose_heights(property_draw *d)
{
    static const double scales[] = { 1, 0.1, 0.5, 0.01, 2, 1.0 / 3 },
                        offsets[] = { 0, 100, -50.5, 0.123, 1000.05 };
    double low, high;
    int unit = pick(d, UNITS), is_scaled = property_has(d, OPTION_SCALE);
    int has_unit = d->level[PROPERTY_FILE] == FILE_GTIFF || d->level[PROPERTY_FILE] == FILE_VRT;
    d->unit = has_unit ? units[unit].name : "";
    d->unit_m = has_unit ? units[unit].metres : 1;
    d->scale = is_scaled ? scales[pick(d, 6)] : 1;
    d->offset = is_scaled ? offsets[pick(d, 5)] : 0;
    d->swing_m = between(d, 60, 400);
    d->middle_m = between(d, -200, 3000);
    value_range(d->type, &low, &high);
    int fits = value_of(d, d->middle_m - d->swing_m) > low &&
               value_of(d, d->middle_m + d->swing_m) < high;
    int is_smooth = !property_is_whole(d) || d->scale * d->unit_m < d->swing_m / 40;
    if (fits && is_smooth) return;
    d->options &= ~(1u << OPTION_SCALE);
    d->unit = "";
    d->unit_m = d->scale = 1;
    d->offset = 0;
    d->middle_m = d->type == GDT_Byte ? 127 : d->swing_m + 100;
    if (d->type == GDT_Byte) d->swing_m = between(d, 60, 120);
}

/* The value that stands for void. */
static void choose_nodata(property_draw *d)
{
    static const double sentinels[] = { -9999, -32768, -32767 };
    double lowest = d->middle_m - d->swing_m;
    d->nodata = d->type == GDT_Byte || d->type == GDT_UInt16 || d->type == GDT_UInt32 ? 0
                : d->type == GDT_Int16                                                ? -32768
                : d->type == GDT_Int32   ? -2147483648.0
                : d->type == GDT_Float32 ? -FLT_MAX
                                         : -DBL_MAX;
    if (d->level[PROPERTY_VOIDS] == VOIDS_NAN) d->nodata = NAN;
    if (d->level[PROPERTY_VOIDS] == VOIDS_OPTION && !property_is_whole(d)) d->nodata = 4321;
    if (d->level[PROPERTY_FILE] == FILE_AAIGRID && d->nodata < 0) d->nodata = -9999;
    if (d->level[PROPERTY_VOIDS] != VOIDS_SENTINEL) return;
    d->nodata = sentinels[pick(d, 3)];
    double z = (d->nodata * d->scale + d->offset) * d->unit_m;
    if (z > lowest - 200) d->level[PROPERTY_VOIDS] = VOIDS_NODATA;
}

static void choose_surface(property_draw *d)
{
    d->turn[0] = between(d, 0, 3.14);
    d->turn[1] = d->turn[0] + between(d, 1.2, 1.9);
    for (int i = 0; i < 2; i++) {
        d->wave[i] = between(d, 45, 90);
        d->phase[i] = between(d, 0, 6.28);
    }
}

/* ---- options ---- */

static int zone_of(const property_draw *d)
{
    if (d->latitude > 84) return 32661;
    if (d->latitude < -80) return 32761;
    int zone = (int)floor((fmod(d->longitude + 540, 360)) / 6) + 1;
    return (d->latitude < 0 ? 32700 : 32600) + zone;
}

static void choose_numbers(property_draw *d)
{
    double step = d->scale * d->unit_m, top = d->middle_m + d->swing_m + 60,
           own = d->offset * d->unit_m;
    d->max_error_m = property_has(d, OPTION_MAX_ERROR) ? between(d, 0.2, 4) : 0;
    if (property_has(d, OPTION_SPACING)) d->spacing_m = d->cell_m * between(d, 0.75, 1.4);
    d->epsg = property_has(d, OPTION_T_SRS) ? zone_of(d) : 0;
    d->densify = property_has(d, OPTION_DENSIFY) ? 2 << pick(d, 2) : 1;
    d->node_log2 = property_has(d, OPTION_NODES) ? 1 + pick(d, 5) : 0;
    d->tile_log2 = d->node_log2 ? d->node_log2 + pick(d, 4) : 0;
    d->codec = pick(d, 4);
    d->jobs = property_has(d, OPTION_JOBS) ? 1 + pick(d, 5) : 0;
    d->void_m = own + ceil((top - own) / step) * step;
}

int property_draw_make(property_draw *d, uint32_t seed, uint32_t number)
{
    *d = (property_draw){ .seed = seed, .number = number };
    d->chance = (uint64_t)seed << 32 | number;
    for (int f = 0; f < PROPERTY_FACTORS; f++) d->level[f] = pick(d, levels[f]);
    force_pair(d);
    settle(d);
    choose_options(d);
    int is_hgt = d->level[PROPERTY_FILE] == FILE_HGT;
    d->columns = is_hgt ? 1201 : 90 + pick(d, 60);
    d->rows = is_hgt ? 1201 : 80 + pick(d, 50);
    int rc = d->place->srs && *d->place->srs ? lay_on_body(d) : lay_on_plane(d);
    if (rc) return rc;
    choose_heights(d);
    choose_nodata(d);
    choose_surface(d);
    d->cell_m = property_cell_m(d);
    choose_numbers(d);
    return 0;
}
