/* What killed runs left behind: outputs grow under a temporary name beside their own. */
#ifndef BAKE_LEFTOVERS_H
#define BAKE_LEFTOVERS_H

#include <stddef.h>

/* The temporary name of an output of this process. 0, or -1 (said): it is too long. */
int bake_temp_name(const char *path, char *temp, size_t room);
/* Calls `discard` for temporary names of this output whose processes are no more. */
void bake_leftovers_remove(const char *path, void (*discard)(const char *leftover));

/* 1 when both paths, NULL for none, lead to one file. */
int bake_same_file(const char *path, const char *other);

#endif
