/* Recorded flights: where a viewer was at which time, read from a CSV file.
 *
 * The first line names the columns; those known are, in any order:
 *   t_s               seconds since the flight began, rising from line to line
 *   x_m, y_m          metres to the east and north of the terrain's south-west corner
 *   lat_deg, lon_deg  where there are none: degrees north and east, of ground that says where on
 *                     Earth it lies
 *   z_m or h_m        metres above the terrain's zero, or above its ground
 *   heading_deg       0 north, 90 east; without it: where the next line lies. heading_true_deg:
 * from true north, with lat_deg pitch_deg         up; without it: -6 Other columns are passed over,
 * so that the CSV of an earlier farfield-fly is a recording. Between two lines all values change
 * evenly, the heading by the shorter turn; before the first and after the last line the viewer
 * stands.
 */
#ifndef FLY_RECORDING_H
#define FLY_RECORDING_H

#include "../../protocol/geo/ff_geo.h"

#include <stddef.h>

typedef struct fly_fix {
    double t_s, x_m, y_m, up_m, heading_deg, pitch_deg;
} fly_fix;

typedef struct fly_recording {
    fly_fix *fix;
    size_t count;     /* 0: no recording */
    int above_ground; /* up_m is h_m */
    int on_earth;     /* x_m and y_m are degrees still, east and north */
} fly_recording;

/* 0, or -1 with one line on stderr. */
int fly_recording_read(fly_recording *recording, const char *path);
/* Makes metres of the degrees of one that has them. 0, or -1 with one line on stderr. */
int fly_recording_place(fly_recording *recording, const char *path, const ff_geo *geo);
void fly_recording_free(fly_recording *recording);
void fly_recording_at(const fly_recording *recording, double t_s, fly_fix *fix);

#endif
