#include "export_about.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void export_about_add(export_about *about, const char *format, ...)
{
    size_t used = strlen(about->error);
    va_list list;
    va_start(list, format);
    vsnprintf(about->error + used, sizeof about->error - used, format, list);
    va_end(list);
}

/* The file's name without folders and ending. */
static void take_name(const char *path, char name[EXPORT_NAME_BYTES])
{
    const char *slash = strrchr(path, '/');
    snprintf(name, EXPORT_NAME_BYTES, "%s", slash ? slash + 1 : path);
    char *dot = strrchr(name, '.');
    if (dot && dot != name) *dot = 0;
}

void export_about_ground(const export_ground *ground, export_about *about)
{
    *about = (export_about){ .error_m = ground->error.samples_m };
    take_name(ground->unpack->path, about->name);
    if (ground->bands != 1) return;
    if (about->error_m > 0)
        export_about_add(about, "heights within %.4g m of those the pack was made from",
                         about->error_m);
    else
        export_about_add(about, "heights are those the pack was made from");
    export_about_add(about, ", in steps of %.4g m", ground->scale);
    if (ground->error.between_m > ground->error.samples_m)
        export_about_add(about, ", ground between them within %.4g m (level %u)",
                         ground->error.between_m, ground->level);
}

void export_about_tag(const export_about *about, GDALDatasetH set)
{
    char text[32];
    GDALSetMetadataItem(set, "name", about->name, NULL);
    if (*about->attribution) GDALSetMetadataItem(set, "attribution", about->attribution, NULL);
    if (!*about->error) return;
    snprintf(text, sizeof text, "%.6g", about->error_m);
    GDALSetMetadataItem(set, "error", about->error, NULL);
    GDALSetMetadataItem(set, "error_m", text, NULL);
}
