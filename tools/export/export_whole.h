/* Outputs appear whole or not at all: they grow under a temporary name beside their own. */
#ifndef EXPORT_WHOLE_H
#define EXPORT_WHOLE_H

#define EXPORT_PATH_BYTES 4096

typedef struct export_whole {
    char path[EXPORT_PATH_BYTES]; /* without a slash in the end */
    char temp[EXPORT_PATH_BYTES + 32];
    int is_folder;
} export_whole;

/* Refuses what is there and no plain file, or, for a folder, whatever is there but an empty one;
 * removes what runs that were killed left behind; makes the folder. 0 or -1 (said). */
int export_whole_begin(const char *path, int is_folder, export_whole *whole);
/* Gives what was written its name when `rc` is 0, else removes it. 0 or -1 (said). */
int export_whole_end(const export_whole *whole, int rc);

#endif
