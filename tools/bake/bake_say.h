/* What the tools say: one-line errors, notes and a progress bar, all on stderr. */
#ifndef BAKE_SAY_H
#define BAKE_SAY_H

#include <stdint.h>

/* Sets the name in front of every line ("farfield-bake"); `quiet` drops notes and progress, never
 * errors. */
void bake_say_setup(const char *program, int quiet);

/* Prints "program: message" and returns -1, so that callers write `return bake_fail(...)`. */
int bake_fail(const char *format, ...) __attribute__((format(printf, 1, 2)));
/* The same with GDAL's own last words appended. */
int bake_fail_gdal(const char *format, ...) __attribute__((format(printf, 1, 2)));

void bake_note(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Draws "stage [####    ] 42 %" when stderr is a terminal and the percentage changed; done == total
 * ends the line. */
void bake_progress(const char *stage, uint64_t done, uint64_t total);

#endif
