#include "bake_leftovers.h"

#include "bake_say.h"

#include <dirent.h>
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define MARK       ".tmp-"
#define PATH_BYTES 4096

int bake_temp_name(const char *path, char *temp, size_t room)
{
    int count = snprintf(temp, room, "%s" MARK "%ld", path, (long)getpid());
    return (size_t)count < room ? 0 : bake_fail("%s: the name is too long", path);
}

/* Is it the temporary name of such an output, of a process that is no more? */
static int is_left(const char *name, const char *output)
{
    size_t count = strlen(output);
    if (strncmp(name, output, count) || strncmp(name + count, MARK, strlen(MARK))) return 0;
    long pid = strtol(name + count + strlen(MARK), NULL, 10);
    return pid > 0 && kill((pid_t)pid, 0) && errno == ESRCH;
}

void bake_leftovers_remove(const char *path, void (*discard)(const char *leftover))
{
    char found[PATH_BYTES];
    const char *slash = strrchr(path, '/'), *output = slash ? slash + 1 : path;
    int folder_bytes = (int)(output - path);
    snprintf(found, sizeof found, "%.*s", folder_bytes, path);
    DIR *folder = opendir(slash ? found : ".");
    if (!folder) return;
    for (struct dirent *entry; (entry = readdir(folder)) != NULL;)
        if (is_left(entry->d_name, output) &&
            snprintf(found, sizeof found, "%.*s%s", folder_bytes, path, entry->d_name) < PATH_BYTES)
            discard(found);
    closedir(folder);
}

int bake_same_file(const char *path, const char *other)
{
    struct stat a, b;
    return path && other && !stat(path, &a) && !stat(other, &b) && a.st_dev == b.st_dev &&
           a.st_ino == b.st_ino;
}
