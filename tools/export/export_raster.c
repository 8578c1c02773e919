#include "export_raster.h"

#include "../bake/bake_say.h"
#include "../bake/raster/bake_view.h"
#include "export_about.h"
#include "export_whole.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COPY_BYTES   (1u << 18)
#define JPEG_SIDE    65500
#define STEP_HIGHEST 65535

static const char *ending_of(const char *path)
{
    const char *dot = strrchr(path, '.');
    return dot && !strchr(dot, '/') ? dot : "";
}

static int is_jpeg(const char *path)
{
    return !strcmp(ending_of(path), ".jpg") || !strcmp(ending_of(path), ".jpeg");
}

int export_raster_is(const char *path)
{
    const char *ending = ending_of(path);
    return !strcmp(ending, ".tif") || !strcmp(ending, ".png") || !strcmp(ending, ".r16") ||
           is_jpeg(path);
}

int export_raster_check(const export_options *o)
{
    if (!o->images && is_jpeg(o->out_path))
        return bake_fail("%s: heights do not fit a JPEG: write .tif, .png or .r16, or --images",
                         o->out_path);
    if (o->images && !strcmp(ending_of(o->out_path), ".r16"))
        return bake_fail("%s: raw samples are heights: write --images as .tif, .png or .jpg",
                         o->out_path);
    if (o->voids == EXPORT_VOIDS_NODATA && strcmp(ending_of(o->out_path), ".tif"))
        return bake_fail("%s: cannot mark voids: --voids nodata needs .tif or map tiles",
                         o->out_path);
    return 0;
}

/* ---- raw ---- */

static int write_raw(const export_whole *whole, const export_ground *ground)
{
    const bake_grid *cells = &ground->cells;
    uint64_t count = (uint64_t)cells->width * cells->height * cells->cell_bytes;
    FILE *file = fopen(whole->temp, "wb");
    uint8_t *buffer = malloc(COPY_BYTES);
    int rc = file && buffer ? 0 : bake_fail("cannot write %s: %s", whole->path, strerror(errno));
    for (uint64_t at = 0; !rc && at < count;) {
        size_t bytes = count - at < COPY_BYTES ? (size_t)(count - at) : COPY_BYTES;
        rc = bake_pread(cells->fd, buffer, bytes, at);
        if (!rc && fwrite(buffer, 1, bytes, file) != bytes)
            rc = bake_fail("cannot write %s: %s", whole->path, strerror(errno));
        at += bytes;
    }
    if (file && fclose(file) && !rc)
        rc = bake_fail("cannot write %s: %s", whole->path, strerror(errno));
    free(buffer);
    return rc;
}

/* ---- GDAL's ---- */

/* Gives filled samples a value that no height has. 0 or -1 (said). */
static int mark_voids(export_ground *ground)
{
    double top = floor((ground->high - ground->offset) / ground->scale),
           bottom = ceil((ground->low - ground->offset) / ground->scale);
    if (top >= STEP_HIGHEST && bottom <= 0)
        return bake_fail("--voids nodata: the pack's heights take all 65536 steps: none is left to "
                         "mark voids");
    uint16_t nodata = top < STEP_HIGHEST ? STEP_HIGHEST : 0;
    uint32_t width = ground->cells.width;
    uint16_t *row = malloc(width * sizeof *row);
    uint8_t *mask = malloc(width);
    int rc = row && mask ? 0 : bake_fail("out of memory");
    for (uint32_t j = 0; !rc && ground->mask.fd >= 0 && j < ground->cells.height; j++) {
        rc = bake_grid_read(&ground->cells, j, 0, width, row) ||
                     bake_grid_read(&ground->mask, j, 0, width, mask)
                 ? -1
                 : 0;
        for (uint32_t i = 0; i < width; i++)
            if (mask[i] == EXPORT_FILLED) row[i] = nodata;
        if (!rc) rc = bake_grid_write(&ground->cells, j, 0, width, row);
    }
    free(row);
    free(mask);
    if (!rc) GDALSetRasterNoDataValue(GDALGetRasterBand(ground->set, 1), nodata);
    return rc;
}

/* What an image's driver is to do, and what it may say of whose the image is. */
static char **settings_of(const export_options *o, const export_about *about, const char *driver)
{
    char quality[16];
    char **list = NULL;
    snprintf(quality, sizeof quality, "%u", o->jpeg_quality);
    if (!strcmp(driver, "COG")) {
        list = CSLSetNameValue(list, "COMPRESS", "DEFLATE");
        list = CSLSetNameValue(list, "PREDICTOR", "YES");
        list = CSLSetNameValue(list, "OVERVIEW_RESAMPLING", "AVERAGE");
        list = CSLSetNameValue(list, "BIGTIFF", "IF_SAFER");
    }
    if (!strcmp(driver, "JPEG")) {
        list = CSLSetNameValue(list, "QUALITY", quality);
        if (*about->attribution) list = CSLSetNameValue(list, "COMMENT", about->attribution);
    }
    if (!strcmp(driver, "PNG")) {
        list = CSLSetNameValue(list, "TITLE", about->name);
        if (*about->attribution) list = CSLSetNameValue(list, "COPYRIGHT", about->attribution);
    }
    return list;
}

/* The data set to be written: colours without their alpha where they have none to tell, or `opaque`
 * says so; what is not ground->set is to be closed. NULL: GDAL's error. */
static GDALDatasetH image_of(const export_ground *ground, int opaque)
{
    static const char *const colours[] = { "-b", "1", "-b", "2", "-b", "3", NULL };
    if (ground->bands == 1 || (ground->has_open && !opaque)) return ground->set;
    return bake_view(ground->set, CSLDuplicate((char **)colours));
}

static int write_image(const export_options *o, const export_about *about,
                       const export_whole *whole, export_ground *ground)
{
    const char *ending = ending_of(whole->path), *driver = !strcmp(ending, ".tif")   ? "COG"
                                                           : !strcmp(ending, ".png") ? "PNG"
                                                                                     : "JPEG";
    if (!strcmp(driver, "JPEG") && fmax(ground->cells.width, ground->cells.height) > JPEG_SIDE)
        return bake_fail("%s: %u x %u texels do not fit a JPEG: write .tif, or give --level or "
                         "--region",
                         whole->path, ground->cells.width, ground->cells.height);
    GDALDatasetH set = image_of(ground, !strcmp(driver, "JPEG"));
    if (!set) return bake_fail_gdal("cannot write %s", whole->path);
    char **settings = settings_of(o, about, driver);
    /* nothing beside the image: no .aux.xml */
    CPLSetConfigOption("GDAL_PAM_ENABLED", "NO");
    CPLErrorReset();
    GDALDatasetH copy = GDALCreateCopy(GDALGetDriverByName(driver), whole->temp, set, 0, settings,
                                       NULL, NULL);
    CSLDestroy(settings);
    if (copy) GDALClose(copy);
    if (set != ground->set) GDALClose(set);
    if (copy && CPLGetLastErrorType() < CE_Failure) return 0;
    return bake_fail_gdal("cannot write %s", whole->path);
}

int export_raster_write(const export_options *o, export_ground *ground)
{
    export_about about;
    export_whole whole;
    export_about_ground(ground, &about);
    export_about_tag(&about, &ground->unpack->pack, ground->set);
    if (o->voids == EXPORT_VOIDS_NODATA && mark_voids(ground)) return -1;
    if (export_whole_begin(o->out_path, 0, &whole)) return -1;
    int rc = strcmp(ending_of(o->out_path), ".r16") ? write_image(o, &about, &whole, ground)
                                                    : write_raw(&whole, ground);
    rc = export_whole_end(&whole, rc);
    if (!rc)
        bake_note("%s: %u x %u %s%s%s", o->out_path, ground->cells.width, ground->cells.height,
                  ground->bands == 1 ? "samples" : "texels", *about.error ? "; " : "", about.error);
    return rc;
}
