#include "report_slider.h"

#include "report_table.h"

#include "../../platform/sys.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PATH_BYTES   4096
#define ROW_WITHIN_S 0.5

static const char *const file_name[2] = { "slider-left.png", "slider-right.png" };

/* The range lies over both pictures, half a finger wider on either side, so that the middle of its
 * thumb goes from edge to edge; all of it is seen through but the bar that follows it. */
/* clang-format off */
const char report_slider_style[] =
    "header{max-width:max(20em,calc((100vh - 15em)*var(--wide)/var(--high)));margin:0 auto 2em}\n"
    "h1{font-size:clamp(22px,5vw,30px);line-height:1.2;margin:0 0 .6em}\n"
    ".slider{position:relative;overflow:hidden;overflow:clip;border-radius:6px;--at:50%}\n"
    ".slider div{position:relative}.slider img{display:block;width:100%;height:auto}\n"
    ".slider div+div{position:absolute;inset:0;clip-path:inset(0 0 0 var(--at))}\n"
    ".slider span{position:absolute;left:.7em;bottom:.7em;padding:.15em .6em;border-radius:4px;background:#000a;color:#fff;font-size:14px}\n"
    ".slider div+div span{left:auto;right:.7em}\n"
    ".slider input{position:absolute;top:0;left:-22px;width:calc(100% + 44px);height:100%;margin:0;opacity:0;cursor:ew-resize;touch-action:pan-y;-webkit-appearance:none;appearance:none}\n"
    ".slider input::-webkit-slider-thumb{-webkit-appearance:none;width:44px;height:100vh}\n"
    ".slider input::-moz-range-thumb{width:44px;height:100vh;border:0}\n"
    ".slider i{position:absolute;top:0;bottom:0;left:var(--at);width:2px;margin-left:-1px;background:#fff;box-shadow:0 0 4px #0009;pointer-events:none}\n"
    ".slider i::after{content:\"\\2039\\2009\\203a\";position:absolute;top:50%;left:50%;width:36px;height:36px;margin:-18px;border-radius:50%;background:#fff;box-shadow:0 1px 5px #0009;color:#222;font:22px/33px sans-serif;text-align:center}\n"
    ".slider input:focus-visible+i::after{box-shadow:0 0 0 4px #1a66c2}\n"
    ".says{font-size:clamp(17px,4vw,20px);line-height:1.4;margin:.7em 0 .2em}.says+p{color:#666;font-size:13px;margin:0}\n";
/* clang-format on */

/* ---- making ---- */

static int refuse(char *why, size_t why_bytes, const char *path, const char *what)
{
    snprintf(why, why_bytes, "%s: %s", path, what);
    return -1;
}

/* A folder's own name, without a slash behind it. */
static void folder_name(const char *folder, const char **name, size_t *length)
{
    *length = strlen(folder);
    while (*length > 1 && folder[*length - 1] == '/') --*length;
    *name = folder + *length;
    while (*name > folder && (*name)[-1] != '/') --*name;
    *length -= (size_t)(*name - folder);
}

static const report_flight *find_flight(const report_flight *flight, size_t count,
                                        const char *folder)
{
    const char *name;
    size_t length;
    folder_name(folder, &name, &length);
    for (size_t i = 0; i < count; i++)
        if (strlen(flight[i].name) == length && !memcmp(flight[i].name, name, length))
            return &flight[i];
    return NULL;
}

/* The row nearest in time, or NULL. */
static const report_row *find_row(const report_flight *flight, double moment_s)
{
    const report_row *nearest = NULL;
    double least = ROW_WITHIN_S;
    for (size_t i = 0; i < flight->row_count; i++) {
        double off = fabs(flight->row[i].value[REPORT_t_s] - moment_s);
        if (!(off < least)) continue;
        least = off;
        nearest = &flight->row[i];
    }
    return nearest;
}

/* Copies the picture; both must have the same size. */
static int copy_side(const report_series *series, int side, const char *name, const char *folder,
                     report_slider *slider, char *why, size_t why_bytes)
{
    char from[PATH_BYTES], to[PATH_BYTES];
    uint8_t *rgb = NULL;
    uint32_t width, height;
    if ((size_t)snprintf(from, sizeof from, "%s/%s", series->folder, name) >= sizeof from ||
        (size_t)snprintf(to, sizeof to, "%s/%s", folder, file_name[side]) >= sizeof to)
        return refuse(why, why_bytes, folder, "path too long");
    int rc = sys_png_read(from, &rgb, &width, &height);
    if (rc != FF_OK) return refuse(why, why_bytes, from, ff_error_text(rc));
    if (side && (width != slider->width || height != slider->height)) {
        free(rgb);
        return refuse(why, why_bytes, from, "not as large as the other picture");
    }
    slider->width = width;
    slider->height = height;
    rc = sys_png_write(to, rgb, width, height);
    free(rgb);
    return rc == FF_OK ? 0 : refuse(why, why_bytes, to, ff_error_text(rc));
}

int report_slider_make(const report_series series[2], const report_flight *flight,
                       size_t flight_count, const char *folder, report_slider *slider, char *why,
                       size_t why_bytes)
{
    const report_flight *own = find_flight(flight, flight_count, series[0].folder);
    size_t count;
    int rc = 0;
    if (!own) return refuse(why, why_bytes, series[0].folder, "no CSV is named as this folder");
    char **name = report_moments(series, &count);
    const char *last = count ? name[count - 1] : "";
    *slider = (report_slider){ .name = { series[0].name, series[1].name } };
    if (!count)
        rc = refuse(why, why_bytes, series[1].folder, "no picture of the same name");
    else if (!(slider->row = find_row(own, report_moment_s(last))))
        rc = refuse(why, why_bytes, last, "no row of the CSV is of its moment");
    for (int side = 0; side < 2 && !rc; side++)
        rc = copy_side(&series[side], side, last, folder, slider, why, why_bytes);
    report_moments_free(name, count);
    return rc;
}

/* ---- writing ---- */

typedef void put_text(FILE *out, const char *text);

/* What the bytes came as; what did not come is left out. */
static void put_parts(FILE *out, const report_row *row)
{
    static const struct {
        enum report_column column;
        const char *what;
    } part[] = { { REPORT_bytes_heights, "heights" },
                 { REPORT_bytes_images, "images" },
                 { REPORT_bytes_faces, "panoramas" },
                 { REPORT_bytes_far, "sets of far ground" } };
    for (size_t i = 0; i < sizeof part / sizeof *part; i++)
        if (row->value[part[i].column] > 0)
            fprintf(out, ", %.1f kB as %s", row->value[part[i].column] / 1000, part[i].what);
}

static void put_sentence(FILE *out, const report_slider *slider, put_text *put)
{
    const double *value = slider->row->value;
    fprintf(out, "%.1f kB came ", value[REPORT_bytes_down] / 1000);
    put(out, slider->name[0]);
    fprintf(out, " in %.0f s", value[REPORT_t_s]);
    put_parts(out, slider->row);
    if (!isnan(value[REPORT_err_px_rms]))
        fprintf(out, ": the picture is %.2f px off (rms)", value[REPORT_err_px_rms]);
    if (!isnan(value[REPORT_err_px_rms]) && !isnan(value[REPORT_skyline_px_rms]))
        fprintf(out, ", its skyline %.2f px", value[REPORT_skyline_px_rms]);
    fputs(".", out);
}

static void put_side(FILE *out, const report_slider *slider, int side)
{
    fprintf(out, "<div><img src=\"%s\" width=\"%u\" height=\"%u\" alt=\"The ground ",
            file_name[side], slider->width, slider->height);
    report_put_html(out, slider->name[side]);
    fputs("\"><span>", out);
    report_put_html(out, slider->name[side]);
    fputs("</span></div>\n", out);
}

void report_slider_html(FILE *out, const report_slider *slider, const char *title,
                        const char *owner)
{
    fprintf(out, "<header style=\"--wide:%u;--high:%u\">\n<h1>", slider->width, slider->height);
    report_put_html(out, title);
    fputs("</h1>\n<figure class=\"slider\">\n", out);
    put_side(out, slider, 0);
    put_side(out, slider, 1);
    fputs("<input type=\"range\" value=\"50\" autocomplete=\"off\" aria-label=\"How much is shown ",
          out);
    report_put_html(out, slider->name[0]);
    fputs(", in percent\" oninput=\"this.parentNode.style.setProperty('--at',this.value+'%')\">"
          "<i></i>\n</figure>\n<p class=\"says\">",
          out);
    put_sentence(out, slider, report_put_html);
    fputs("</p>\n<p>Drag across the picture, or use the arrow keys.", out);
    if (owner) {
        fputs(" Ground: ", out);
        report_put_html(out, owner);
    }
    fputs("</p>\n</header>\n", out);
}

void report_slider_markdown(FILE *out, const report_slider *slider, const char *owner)
{
    fputs("\n", out);
    for (int side = 0; side < 2; side++) {
        fputs("![The ground ", out);
        report_put_markdown(out, slider->name[side]);
        fprintf(out, "](%s)\n", file_name[side]);
    }
    fputs("\n", out);
    put_sentence(out, slider, report_put_markdown);
    if (owner) {
        fputs(" Ground: ", out);
        report_put_markdown(out, owner);
    }
    fputs("\n", out);
}
