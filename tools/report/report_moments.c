#include "report_moments.h"

#include "../../platform/sys.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PATH_BYTES 4096

static int is_picture(const struct dirent *entry)
{
    size_t length = strlen(entry->d_name);
    return length > 4 && strcmp(entry->d_name + length - 4, ".png") == 0;
}

static int lies_in(const char *folder, const char *name)
{
    char path[PATH_BYTES];
    sys_mapping mapping;
    if ((size_t)snprintf(path, sizeof path, "%s/%s", folder, name) >= sizeof path) return 0;
    if (sys_map_file(path, &mapping) != FF_OK) return 0;
    sys_unmap_file(&mapping);
    return 1;
}

char **report_moments(const report_series series[2], size_t *count)
{
    struct dirent **list;
    int found = scandir(series[0].folder, &list, is_picture, alphasort);
    char **name = found > 0 ? calloc((size_t)found, sizeof *name) : NULL;
    *count = 0;
    for (int i = 0; i < found; i++) {
        if (name && lies_in(series[1].folder, list[i]->d_name) &&
            (name[*count] = strdup(list[i]->d_name)))
            (*count)++;
        free(list[i]);
    }
    if (found >= 0) free(list);
    return name;
}

void report_moments_free(char **name, size_t count)
{
    for (size_t i = 0; i < count; i++) free(name[i]);
    free(name);
}

double report_moment_s(const char *name)
{
    double seconds;
    return sscanf(name, "frame-%lf", &seconds) == 1 ? seconds : NAN;
}
