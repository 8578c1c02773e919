#include "export_whole.h"

#include "../bake/bake_leftovers.h"
#include "../bake/bake_say.h"

#include <dirent.h>
#include <errno.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define OPEN_FOLDERS 16

static int remove_one(const char *path, const struct stat *status, int kind, struct FTW *place)
{
    (void)status, (void)kind, (void)place;
    return remove(path);
}

static void remove_all(const char *path)
{
    nftw(path, remove_one, OPEN_FOLDERS, FTW_DEPTH | FTW_PHYS);
}

static int is_empty_folder(const char *path)
{
    DIR *folder = opendir(path);
    int entries = 0;
    if (!folder) return 0;
    while (readdir(folder)) entries++;
    closedir(folder);
    return entries <= 2; /* itself and the one above */
}

static int check_there(const export_whole *whole)
{
    struct stat status;
    if (stat(whole->path, &status)) return 0;
    if (!whole->is_folder && !S_ISREG(status.st_mode))
        return bake_fail("%s: not a plain file", whole->path);
    if (whole->is_folder && !is_empty_folder(whole->path))
        return bake_fail("%s: is there already: remove it, or name another folder", whole->path);
    return 0;
}

int export_whole_begin(const char *path, int is_folder, export_whole *whole)
{
    whole->is_folder = is_folder;
    size_t length = strlen(path);
    while (is_folder && length > 1 && path[length - 1] == '/') length--;
    if (length >= sizeof whole->path) return bake_fail("%s: the name is too long", path);
    memcpy(whole->path, path, length);
    whole->path[length] = 0;
    if (bake_temp_name(whole->path, whole->temp, sizeof whole->temp) || check_there(whole))
        return -1;
    bake_leftovers_remove(whole->path, remove_all);
    FILE *file = is_folder ? NULL : fopen(whole->temp, "wb");
    if (is_folder ? mkdir(whole->temp, 0777) : !file)
        return bake_fail("cannot write %s: %s", path, strerror(errno));
    if (file) fclose(file);
    return 0;
}

int export_whole_end(const export_whole *whole, int rc)
{
    if (!rc && rename(whole->temp, whole->path))
        rc = bake_fail("cannot rename to %s: %s", whole->path, strerror(errno));
    if (rc) remove_all(whole->temp);
    return rc;
}
