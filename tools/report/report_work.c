#include "report_work.h"

#include "report_csv.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LINE_BYTES 1024
#define FIELDS_MAX 64

enum { QUALITY, PANORAMA, INSTRUCTIONS, ERROR, COLUMNS };
static const char *const names[COLUMNS] = { "quality", "panorama", "instructions", "err_px_p95" };

static int read_header(char *line, size_t place[COLUMNS], size_t *fields)
{
    char *field[FIELDS_MAX];
    *fields = report_csv_split(line, field, FIELDS_MAX);
    for (int c = 0; c < COLUMNS; c++) {
        for (place[c] = 0;
             place[c] < *fields && place[c] < FIELDS_MAX && strcmp(field[place[c]], names[c]) != 0;)
            place[c]++;
        if (place[c] >= *fields || place[c] >= FIELDS_MAX) return -1;
    }
    return *fields > FIELDS_MAX ? -1 : 0;
}

static int read_number(const char *text, double *value)
{
    char *end;
    *value = strtod(text, &end);
    return end == text || *end || !(*value >= 0 && *value < 1e15) ? -1 : 0;
}

static int read_row(char *line, const size_t place[COLUMNS], size_t fields, report_work_row *row)
{
    char *field[FIELDS_MAX];
    if (report_csv_split(line, field, FIELDS_MAX) != fields) return -1;
    const char *quality = field[place[QUALITY]], *panorama = field[place[PANORAMA]];
    if (!*quality || strlen(quality) >= sizeof row->quality ||
        strlen(panorama) >= sizeof row->panorama)
        return -1;
    strcpy(row->quality, quality);
    strcpy(row->panorama, panorama);
    return read_number(field[place[INSTRUCTIONS]], &row->instructions) ||
                   read_number(field[place[ERROR]], &row->err_px_p95)
               ? -1
               : 0;
}

int report_work_load(report_work *work, const char *path, char *why, size_t why_bytes)
{
    char line[LINE_BYTES];
    size_t place[COLUMNS], fields = 0, number = 0;
    FILE *in = fopen(path, "r");
    memset(work, 0, sizeof *work);
    if (!in) {
        snprintf(why, why_bytes, "%s: %s", path, strerror(errno));
        return -1;
    }
    int rc = 0;
    while (!rc && fgets(line, sizeof line, in)) {
        number++;
        if (number == 1)
            rc = read_header(line, place, &fields);
        else if (work->row_count == REPORT_WORK_ROWS_MAX)
            rc = -1;
        else
            rc = read_row(line, place, fields, &work->row[work->row_count++]);
    }
    fclose(in);
    if (!rc && work->row_count) return 0;
    snprintf(why, why_bytes, "%s:%zu: not a table of instructions and errors", path, number);
    return -1;
}
