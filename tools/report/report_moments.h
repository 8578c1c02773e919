/* Pictures of the same moments in two folders: a flight drawn twice, or drawn and as it should be.
 * Pictures of a moment have the same name in both. */
#ifndef REPORT_MOMENTS_H
#define REPORT_MOMENTS_H

#include <stddef.h>

/* folder: of farfield-fly --png or --reference */
typedef struct report_series {
    const char *name, *folder;
} report_series;

/* Names of the PNGs that lie in both folders, in order. The caller frees them with
 * report_moments_free; *count is 0 when there are none. */
char **report_moments(const report_series series[2], size_t *count);
void report_moments_free(char **name, size_t count);
/* Seconds since the flight's start: frame-0030.00.png was taken at 30 s. NAN for other names. */
double report_moment_s(const char *name);

#endif
