#include "report_sheet.h"

#include "../../common3d/c3d_text.h"
#include "../../platform/sys.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PATH_BYTES  4096
#define GAP_PX      8
#define TEXT_TIMES  2  /* enlarged */
#define BAND_PX     24 /* above each picture, for text */
#define ROWS        3
#define PAPER       0xF6
#define INK         0xFF202020u
#define SIDE_PX_MAX 4096

typedef struct canvas {
    uint8_t *rgb;
    uint32_t width, height; /* of the sheet */
    uint32_t picture_px[2]; /* of each picture */
    size_t columns;
} canvas;

static int join_path(char path[PATH_BYTES], const char *folder, const char *name)
{
    return (size_t)snprintf(path, PATH_BYTES, "%s/%s", folder, name) < PATH_BYTES;
}

/* Names without a time stand for themselves. */
static void moment_text(const char *name, char *text, size_t bytes)
{
    double seconds = report_moment_s(name);
    if (!isnan(seconds))
        snprintf(text, bytes, "%g S", seconds);
    else
        snprintf(text, bytes, "%.*s", (int)(strlen(name) - 4), name);
}

/* ---- drawing ---- */

static int canvas_make(canvas *c, uint32_t width, uint32_t height, size_t columns)
{
    c->picture_px[0] = width;
    c->picture_px[1] = height;
    c->columns = columns;
    c->width = (uint32_t)columns * (width + GAP_PX) + GAP_PX;
    c->height = ROWS * (height + BAND_PX) + GAP_PX;
    c->rgb = malloc((size_t)c->width * c->height * 3);
    if (c->rgb) memset(c->rgb, PAPER, (size_t)c->width * c->height * 3);
    return c->rgb ? 0 : -1;
}

static uint8_t *cell(const canvas *c, size_t column, size_t row, uint32_t y)
{
    size_t at_x = GAP_PX + column * (c->picture_px[0] + GAP_PX),
           at_y = row * (c->picture_px[1] + BAND_PX) + BAND_PX + y;
    return c->rgb + 3 * (at_y * c->width + at_x);
}

static void put_picture(const canvas *c, size_t column, size_t row, const uint8_t *rgb)
{
    for (uint32_t y = 0; y < c->picture_px[1]; y++)
        memcpy(cell(c, column, row, y), rgb + 3 * (size_t)y * c->picture_px[0],
               3 * (size_t)c->picture_px[0]);
}

/* Writes text into the band above a picture. */
static void put_text(const canvas *c, size_t column, size_t row, const char *text)
{
    enum { WIDTH = SIDE_PX_MAX / TEXT_TIMES, HEIGHT = C3D_TEXT_LINE_PX };
    static uint8_t rgba[WIDTH * HEIGHT * 4];
    int wide = (int)c->picture_px[0] / TEXT_TIMES;
    memset(rgba, 0, sizeof rgba);
    c3d_text(rgba, wide, HEIGHT, 0, 0, INK, text);
    for (int y = 0; y < HEIGHT * TEXT_TIMES; y++) {
        uint8_t *to = cell(c, column, row, 0) - 3 * ((size_t)c->width * (size_t)(BAND_PX - 5 - y));
        for (int x = 0; x < wide * TEXT_TIMES; x++) {
            const uint8_t *from = rgba + 4 * (y / TEXT_TIMES * wide + x / TEXT_TIMES);
            if (from[3]) memcpy(to + 3 * x, from, 3);
        }
    }
}

/* Draws the third row of a column, the difference. Returns the percentage of pixels that differ
 * visibly. */
static double put_difference(const canvas *c, size_t column, int amplified, const uint8_t *a,
                             const uint8_t *b)
{
    size_t apart = 0, at = 0;
    for (uint32_t y = 0; y < c->picture_px[1]; y++) {
        uint8_t *to = cell(c, column, 2, y);
        for (uint32_t x = 0; x < c->picture_px[0]; x++) {
            int most = 0;
            for (int channel = 0; channel < 3; channel++, at++, to++) {
                int off = abs(a[at] - b[at]);
                most = off > most ? off : most;
                *to = (uint8_t)(off * amplified > 255 ? 255 : off * amplified);
            }
            apart += most > REPORT_SHEET_VISIBLE;
        }
    }
    return 100.0 * (double)apart / ((double)c->picture_px[0] * c->picture_px[1]);
}

/* ---- the sheet ---- */

static int load(const report_series *series, const char *name, canvas *c, uint8_t **rgb, char *why,
                size_t why_bytes)
{
    char path[PATH_BYTES];
    uint32_t width, height;
    int rc = join_path(path, series->folder, name) ? sys_png_read(path, rgb, &width, &height)
                                                   : FF_ERR_ARGUMENT;
    if (rc == FF_OK && c->rgb && (width != c->picture_px[0] || height != c->picture_px[1]))
        rc = FF_ERR_RANGE;
    if (rc == FF_OK && !c->rgb)
        rc = width > SIDE_PX_MAX || height > SIDE_PX_MAX ? FF_ERR_RANGE
             : canvas_make(c, width, height, c->columns) ? FF_ERR_MEMORY
                                                         : FF_OK;
    if (rc != FF_OK) snprintf(why, why_bytes, "%s: %s", path, ff_error_text(rc));
    return rc == FF_OK ? 0 : -1;
}

static int put_moment(const report_series series[2], const char *name, canvas *c, size_t column,
                      report_sheet *sheet, char *why, size_t why_bytes)
{
    uint8_t *rgb[2] = { NULL, NULL };
    char text[128], moment[64];
    int rc = load(&series[0], name, c, &rgb[0], why, why_bytes);
    if (!rc) rc = load(&series[1], name, c, &rgb[1], why, why_bytes);
    if (!rc) {
        moment_text(name, moment, sizeof moment);
        for (size_t row = 0; row < 2; row++) {
            snprintf(text, sizeof text, "%s %s", series[row].name, row ? "" : moment);
            put_text(c, column, row, text);
            put_picture(c, column, row, rgb[row]);
        }
        sheet->differ_percent[column] = put_difference(c, column, sheet->amplified, rgb[0], rgb[1]);
        snprintf(text, sizeof text, "X%d %.2f %% > %d/255", sheet->amplified,
                 sheet->differ_percent[column], REPORT_SHEET_VISIBLE);
        put_text(c, column, 2, text);
    }
    free(rgb[0]);
    free(rgb[1]);
    return rc;
}

int report_sheet_write(const report_series series[2], const char *folder, report_sheet *sheet,
                       char *why, size_t why_bytes)
{
    size_t count;
    canvas c = { .rgb = NULL };
    char **name = report_moments(series, &count);
    int rc = 0;
    char path[PATH_BYTES];
    for (int i = 0; i < 2; i++) sheet->name[i] = series[i].name;
    sheet->moments = c.columns = count < REPORT_SHEET_MOMENTS ? count : REPORT_SHEET_MOMENTS;
    if (!count) {
        snprintf(why, why_bytes, "%s and %s have no picture of the same name", series[0].folder,
                 series[1].folder);
        rc = -1;
    }
    for (size_t i = 0; i < c.columns && !rc; i++)
        rc = put_moment(series, name[c.columns < 2 ? 0 : i * (count - 1) / (c.columns - 1)], &c, i,
                        sheet, why, why_bytes);
    if (!rc && !join_path(path, folder, sheet->file)) {
        snprintf(why, why_bytes, "%s: path too long", folder);
        rc = -1;
    }
    if (!rc && (rc = sys_png_write(path, c.rgb, c.width, c.height)) != FF_OK)
        snprintf(why, why_bytes, "%s: %s", path, ff_error_text(rc));
    report_moments_free(name, count);
    free(c.rgb);
    return rc ? -1 : 0;
}
