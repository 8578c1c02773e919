#include "fly_recording.h"

#include "../../protocol/ff_error.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PITCH_DEG (-6.0)
#define STILL_M   0.1 /* nearer fixes tell no direction */
#define FIXES_MAX 10000000u

enum column {
    COLUMN_T,
    COLUMN_X,
    COLUMN_Y,
    COLUMN_Z,
    COLUMN_H,
    COLUMN_HEADING,
    COLUMN_PITCH,
    COLUMN_LAT,
    COLUMN_LON,
    COLUMN_TRUE,
    COLUMN_COUNT,
    COLUMN_OTHER
};
enum { COLUMNS_MAX = 128 };

typedef struct reader {
    const char *path;
    unsigned line;
    enum column column[COLUMNS_MAX];
    unsigned columns;
    int has[COLUMN_COUNT], on_earth;
    size_t capacity;
} reader;

static int wrong(const reader *r, const char *why)
{
    fprintf(stderr, "farfield-fly: %s:%u: %s\n", r->path, r->line, why);
    return -1;
}

/* Cuts the next field off `*rest`, without its line's end; NULL when there is none. */
static char *next_field(char **rest)
{
    char *field = *rest;
    if (!field) return NULL;
    char *end = field + strcspn(field, ",\r\n");
    *rest = *end == ',' ? end + 1 : NULL;
    *end = '\0';
    return field;
}

static int read_header(reader *r, char *line)
{
    static const char *const name[COLUMN_COUNT] = {
        "t_s",         "x_m",       "y_m",     "z_m",     "h_m",
        "heading_deg", "pitch_deg", "lat_deg", "lon_deg", "heading_true_deg"
    };
    for (char *field; (field = next_field(&line)) != NULL;) {
        enum column column = COLUMN_OTHER;
        for (int i = 0; i < COLUMN_COUNT; i++)
            if (!strcmp(field, name[i])) column = (enum column)i;
        if (r->columns == COLUMNS_MAX || (column != COLUMN_OTHER && r->has[column]))
            return wrong(r, "too many columns, or one twice");
        if (column != COLUMN_OTHER) r->has[column] = 1;
        r->column[r->columns++] = column;
    }
    int in_metres = r->has[COLUMN_X] && r->has[COLUMN_Y],
        in_degrees = r->has[COLUMN_LAT] && r->has[COLUMN_LON];
    if (!r->has[COLUMN_T] || !(in_metres || in_degrees) || r->has[COLUMN_Z] + r->has[COLUMN_H] < 1)
        return wrong(r, "needs columns t_s, x_m, y_m (or lat_deg, lon_deg) and z_m or h_m");
    r->on_earth = !in_metres;
    return 0;
}

static int read_fix(const reader *r, char *line, fly_fix *fix)
{
    double value[COLUMN_COUNT] = {
        [COLUMN_HEADING] = NAN, [COLUMN_PITCH] = PITCH_DEG, [COLUMN_TRUE] = NAN
    };
    for (unsigned i = 0; i < r->columns; i++) {
        char *field = next_field(&line), *end;
        if (!field) return wrong(r, "too few columns");
        if (r->column[i] == COLUMN_OTHER || (r->column[i] >= COLUMN_LAT && !r->on_earth)) continue;
        double number = strtod(field, &end);
        if (end == field || *end || !(fabs(number) <= 8e6))
            return wrong(r, "not a number, or one beyond 8 000 000");
        value[r->column[i]] = number;
    }
    enum column x = r->on_earth ? COLUMN_LON : COLUMN_X, y = r->on_earth ? COLUMN_LAT : COLUMN_Y,
                up = r->has[COLUMN_Z] ? COLUMN_Z : COLUMN_H,
                heading = r->on_earth ? COLUMN_TRUE : COLUMN_HEADING;
    *fix = (fly_fix){ value[COLUMN_T], value[x],       value[y],
                      value[up],       value[heading], value[COLUMN_PITCH] };
    return line ? wrong(r, "too many columns") : 0;
}

static int append(reader *r, fly_recording *recording, const fly_fix *fix)
{
    if (recording->count && fix->t_s <= recording->fix[recording->count - 1].t_s)
        return wrong(r, "t_s does not rise");
    if (recording->count == r->capacity) {
        size_t more = r->capacity ? r->capacity * 2 : 256;
        fly_fix *grown = more <= FIXES_MAX ? realloc(recording->fix, more * sizeof *grown) : NULL;
        if (!grown) return wrong(r, "out of memory");
        recording->fix = grown;
        r->capacity = more;
    }
    recording->fix[recording->count++] = *fix;
    return 0;
}

/* Headings look to the next fix; when that lies at the same place, they stay as they were. */
static void fill_headings(fly_recording *recording)
{
    double heading_deg = 0;
    for (size_t i = 0; i < recording->count; i++) {
        fly_fix *fix = &recording->fix[i];
        double dx = i + 1 < recording->count ? fix[1].x_m - fix->x_m : 0,
               dy = i + 1 < recording->count ? fix[1].y_m - fix->y_m : 0;
        if (hypot(dx, dy) >= STILL_M) heading_deg = atan2(dx, dy) * 180 / 3.14159265358979323846;
        if (isnan(fix->heading_deg)) fix->heading_deg = heading_deg;
    }
}

static int read_lines(reader *r, fly_recording *recording, FILE *file)
{
    char line[4096];
    int rc = 0;
    for (r->line = 1; !rc && fgets(line, sizeof line, file); r->line++) {
        fly_fix fix;
        if (strlen(line) == sizeof line - 1) return wrong(r, "too long a line");
        if (r->line == 1)
            rc = read_header(r, line);
        else if (!(rc = read_fix(r, line, &fix)))
            rc = append(r, recording, &fix);
    }
    if (rc) return rc;
    return ferror(file) || !recording->count ? wrong(r, "nothing is recorded here") : 0;
}

int fly_recording_read(fly_recording *recording, const char *path)
{
    reader r = { .path = path };
    *recording = (fly_recording){ 0 };
    FILE *file = fopen(path, "r");
    if (!file) {
        fprintf(
            stderr,
            "farfield-fly: --path: %s is neither diagonal, circle, hover, turn nor a file: %s\n",
            path, strerror(errno));
        return -1;
    }
    int rc = read_lines(&r, recording, file);
    fclose(file);
    if (rc) fly_recording_free(recording);
    recording->above_ground = !r.has[COLUMN_Z];
    recording->on_earth = r.on_earth;
    if (!r.on_earth) fill_headings(recording);
    return rc;
}

/* A fix in degrees becomes one in metres, its heading one from the ground's north. FF_OK or
 * FF_ERR_RANGE. */
static int place_fix(fly_fix *fix, const ff_geo *geo)
{
    const ff_geo_place place = { llround(fix->y_m * 1e9), llround(fix->x_m * 1e9), 0 };
    int32_t wu[3], north;
    int rc = ff_geo_to(geo, &place, wu);
    if (rc == FF_OK) rc = ff_geo_north(geo, wu, &north);
    if (rc != FF_OK) return rc;
    fix->x_m = (double)wu[0] / FF_WU_PER_METRE;
    fix->y_m = (double)wu[1] / FF_WU_PER_METRE;
    fix->heading_deg += north * 360 / 65536.0;
    return FF_OK;
}

int fly_recording_place(fly_recording *recording, const char *path, const ff_geo *geo)
{
    for (size_t i = 0; recording->on_earth && i < recording->count; i++) {
        if (place_fix(&recording->fix[i], geo) == FF_OK) continue;
        fprintf(stderr,
                "farfield-fly: %s:%zu: the projection of the ground does not show this place\n",
                path, i + 2);
        return -1;
    }
    if (recording->on_earth) fill_headings(recording);
    recording->on_earth = 0;
    return 0;
}

void fly_recording_free(fly_recording *recording)
{
    free(recording->fix);
    *recording = (fly_recording){ 0 };
}

void fly_recording_at(const fly_recording *recording, double t_s, fly_fix *fix)
{
    size_t low = 0, high = recording->count; /* the first fix later than t_s */
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (recording->fix[middle].t_s <= t_s)
            low = middle + 1;
        else
            high = middle;
    }
    if (low == 0 || low == recording->count) {
        *fix = recording->fix[low ? low - 1 : 0];
        return;
    }
    const fly_fix *a = &recording->fix[low - 1], *b = a + 1;
    double share = (t_s - a->t_s) / (b->t_s - a->t_s),
           turn_deg = remainder(b->heading_deg - a->heading_deg, 360);
    *fix = (fly_fix){ t_s,
                      a->x_m + share * (b->x_m - a->x_m),
                      a->y_m + share * (b->y_m - a->y_m),
                      a->up_m + share * (b->up_m - a->up_m),
                      a->heading_deg + share * turn_deg,
                      a->pitch_deg + share * (b->pitch_deg - a->pitch_deg) };
}
