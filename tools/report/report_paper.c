#include "report_paper.h"

#include "report_csv.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LINE_BYTES 1024

static const char header[] =
    "link,speed_kmh,quality,panorama,fps,triangles,kilobytes,stable_from_s,stable_to_s";
enum { LINK, SPEED, QUALITY, PANORAMA, FPS, TRIANGLES, KILOBYTES, STABLE_FROM, STABLE_TO, FIELDS };

static int read_word(const char *field, char *word)
{
    if (!*field || strlen(field) >= REPORT_PAPER_WORD_BYTES) return -1;
    strcpy(word, field);
    return 0;
}

static int read_number(const char *field, double *value)
{
    char *end;
    *value = *field ? strtod(field, &end) : NAN;
    return *field && (*end || !(*value > 0 && *value < 1e9)) ? -1 : 0;
}

static void make_name(report_paper_row *row)
{
    const char *word[] = { row->link, row->speed_kmh, row->quality, row->panorama };
    for (int i = 0; i < 4; i++) {
        if (i) strcat(row->name, "-");
        strcat(row->name, word[i]);
    }
}

static int read_row(char *line, report_paper_row *row)
{
    char *field[FIELDS];
    double fps;
    if (report_csv_split(line, field, FIELDS) != FIELDS) return -1;
    if (read_word(field[LINK], row->link) || read_word(field[SPEED], row->speed_kmh) ||
        read_word(field[QUALITY], row->quality) || read_word(field[PANORAMA], row->panorama) ||
        read_number(field[FPS], &fps) || read_number(field[TRIANGLES], &row->triangles) ||
        read_number(field[KILOBYTES], &row->kilobytes) ||
        read_number(field[STABLE_FROM], &row->stable_from_s) ||
        read_number(field[STABLE_TO], &row->stable_to_s))
        return -1;
    make_name(row);
    return 0;
}

static int read_rows(report_paper *paper, FILE *in, size_t *number)
{
    char line[LINE_BYTES];
    int have_header = 0;
    for (*number = 1; fgets(line, sizeof line, in); ++*number) {
        if (line[0] == '#') continue;
        line[strcspn(line, "\r\n")] = 0;
        if (!have_header) {
            if (strcmp(line, header)) return -1;
            have_header = 1;
        } else if (paper->row_count == REPORT_PAPER_ROWS_MAX ||
                   read_row(line, &paper->row[paper->row_count++])) {
            return -1;
        }
    }
    return paper->row_count ? 0 : -1;
}

int report_paper_load(report_paper *paper, const char *path, char *why, size_t why_bytes)
{
    size_t number;
    FILE *in = fopen(path, "r");
    memset(paper, 0, sizeof *paper);
    if (!in) {
        snprintf(why, why_bytes, "%s: %s", path, strerror(errno));
        return -1;
    }
    int rc = read_rows(paper, in, &number);
    fclose(in);
    if (rc) snprintf(why, why_bytes, "%s:%zu: not a paper's table of flights", path, number);
    return rc;
}
