/* farfield-report: flights' CSV files become an HTML page with plots and a Markdown table. */
#include "report_page.h"
#include "report_sheet.h"

#include "../../client/farfield.h"

#include <errno.h>
#include <getopt.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define PATH_BYTES        4096
#define WHY_BYTES         8192
#define AGAINST_MAX       8
#define BESIDE_AMPLIFIED  32
#define AGAINST_AMPLIFIED 2

static const char usage[] =
    "Usage: farfield-report [OPTION]... CSV... -o DIR\n"
    "Make a report of flights: DIR/index.html with plots, and DIR/REPORT.md.\n"
    "\n"
    "Each CSV comes from farfield-fly; the page can be read without a network.\n"
    "\n"
    "  -o, --output DIR     folder for the report, made if missing\n"
    "      --title TITLE    heading of the report\n"
    "      --picture FILE   copy a picture into DIR and show it; may be repeated, and\n"
    "                       several files may follow until the next option\n"
    "      --beside NAME=DIR    given twice, for folders of farfield-fly --png: up to five\n"
    "                       pictures of the same moments from both and their difference\n"
    "                       become one, DIR/side-by-side.png\n"
    "      --against DIR=DIR    pictures of a flight and, by the same names, how they should\n"
    "                       look (farfield-fly --png, --reference): a sheet of both\n"
    "                       and where they differ; up to eight times\n"
    "      --instructions TABLE draw the error against instructions: work-precision.csv of\n"
    "                       make bench-handheld\n"
    "      --paper TABLE        put flights named LINK-SPEED-QUALITY-PANORAMA beside those of\n"
    "                       a paper (tools/report/hybrid_table3.csv), and draw the error of\n"
    "                       flights named sweep-SERIES-VALUE against their work\n"
    "      --settle S       seconds of standing still before a flight, default 15\n"
    "      --json           print the summaries as JSON\n"
    "      --help           show this help and exit\n"
    "      --version        show the version and exit\n";

typedef struct options {
    const char *title, *folder;
    const char **csv, **picture; /* argc entries each */
    size_t csv_count, picture_count;
    report_series beside[2];
    size_t beside_count;
    report_series against[AGAINST_MAX][2];
    size_t against_count;
    const char *instructions; /* NULL: none */
    const char *paper;        /* NULL: none */
    double settle_s;
    int json;
} options;

static int fail(const char *format, ...) __attribute__((format(printf, 1, 2)));
static int fail(const char *format, ...)
{
    va_list args;
    va_start(args, format);
    fputs("farfield-report: ", stderr);
    vfprintf(stderr, format, args);
    fputc('\n', stderr);
    va_end(args);
    return -1;
}

/* Parses NAME=DIR; the argument's text is cut in two. */
static int parse_beside(options *o, char *text)
{
    char *equals = strchr(text, '=');
    if (!equals || equals == text || !equals[1]) return fail("--beside: %s is not NAME=DIR", text);
    if (o->beside_count == 2) return fail("--beside: two folders, not more");
    *equals = 0;
    o->beside[o->beside_count++] = (report_series){ text, equals + 1 };
    return 0;
}

/* Parses DIR=DIR; the first folder's name is the flight's. */
static int parse_against(options *o, char *text)
{
    char *equals = strchr(text, '='), *slash;
    if (!equals || equals == text || !equals[1]) return fail("--against: %s is not DIR=DIR", text);
    if (o->against_count == AGAINST_MAX) return fail("--against: more than %d", AGAINST_MAX);
    *equals = 0;
    slash = strrchr(text, '/');
    o->against[o->against_count][0] = (report_series){ slash && slash[1] ? slash + 1 : text, text };
    o->against[o->against_count++][1] = (report_series){ "as it should be", equals + 1 };
    return 0;
}

/* 0: go on, 1: answered, -1: wrong. Arguments in order ("-"): those after --picture are pictures
 * until another option comes. */
static int parse(options *o, int argc, char **argv)
{
    static const struct option list[] = { { "output", required_argument, NULL, 'o' },
                                          { "title", required_argument, NULL, 't' },
                                          { "picture", required_argument, NULL, 'p' },
                                          { "json", no_argument, NULL, 'j' },
                                          { "beside", required_argument, NULL, 'b' },
                                          { "against", required_argument, NULL, 'a' },
                                          { "instructions", required_argument, NULL, 'i' },
                                          { "paper", required_argument, NULL, 'P' },
                                          { "settle", required_argument, NULL, 'S' },
                                          { "help", no_argument, NULL, 'h' },
                                          { "version", no_argument, NULL, 'v' },
                                          { NULL, 0, NULL, 0 } };
    int c, pictures = 0;
    while ((c = getopt_long(argc, argv, "-o:", list, NULL)) != -1) {
        if (c == 1 && !pictures)
            o->csv[o->csv_count++] = optarg;
        else if (c == 'p' || c == 1)
            o->picture[o->picture_count++] = optarg;
        else if (c == 'o')
            o->folder = optarg;
        else if (c == 't')
            o->title = optarg;
        else if (c == 'b') {
            if (parse_beside(o, optarg)) return -1;
        } else if (c == 'a') {
            if (parse_against(o, optarg)) return -1;
        } else if (c == 'i')
            o->instructions = optarg;
        else if (c == 'P')
            o->paper = optarg;
        else if (c == 'S') {
            char *end;
            o->settle_s = strtod(optarg, &end);
            if (end == optarg || *end || !(o->settle_s >= 0 && o->settle_s < 1e6))
                return fail("--settle: %s is not a number of seconds", optarg);
        } else if (c == 'j')
            o->json = 1;
        else if (c == 'h')
            return fputs(usage, stdout), 1;
        else if (c == 'v')
            return puts("farfield-report " FARFIELD_VERSION), 1;
        else
            return fail("try --help");
        if (c != 1) pictures = c == 'p';
    }
    while (optind < argc) o->csv[o->csv_count++] = argv[optind++];
    if (!o->csv_count) return fail("no CSV given; try --help");
    if (!o->folder) return fail("no folder given; use -o DIR");
    if (o->beside_count == 1) return fail("--beside: give two folders");
    return 0;
}

static int make_folder(const char *path)
{
    char part[PATH_BYTES];
    if ((size_t)snprintf(part, sizeof part, "%s", path) >= sizeof part)
        return fail("path too long: %s", path);
    for (char *slash = strchr(part + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = 0;
        if (mkdir(part, 0777) && errno != EEXIST) return fail("%s: %s", part, strerror(errno));
        *slash = '/';
    }
    if (mkdir(part, 0777) && errno != EEXIST) return fail("%s: %s", part, strerror(errno));
    return 0;
}

static int copy_file(const char *from, const char *to)
{
    sys_mapping mapping;
    int rc = sys_map_file(from, &mapping);
    if (rc < 0) return fail("%s: %s", from, ff_error_text(rc));
    rc = sys_write_file(to, mapping.bytes, (size_t)mapping.size);
    sys_unmap_file(&mapping);
    return rc < 0 ? fail("%s: %s", to, ff_error_text(rc)) : 0;
}

/* Pictures of several flights often share a name: the copy is called FOLDER-NAME, and numbered. */
static char *picture_name(const char *path, size_t number)
{
    const char *base = strrchr(path, '/'), *folder = base;
    char name[PATH_BYTES];
    base = base ? base + 1 : path;
    while (folder && folder > path && folder[-1] != '/') folder--;
    int folder_length = folder ? (int)(base - 1 - folder) : 0;
    snprintf(name, sizeof name, "%02zu-%.*s%s%s", number + 1, folder_length, folder ? folder : "",
             folder_length ? "-" : "", base);
    return strdup(name);
}

static int copy_pictures(const options *o, char **names)
{
    for (size_t i = 0; i < o->picture_count; i++) {
        char to[PATH_BYTES];
        if (!(names[i] = picture_name(o->picture[i], i))) return fail("out of memory");
        if ((size_t)snprintf(to, sizeof to, "%s/%s", o->folder, names[i]) >= sizeof to)
            return fail("path too long: %s", names[i]);
        if (copy_file(o->picture[i], to)) return -1;
    }
    return 0;
}

/* Makes all sheets; their number, or -1. */
static int make_sheets(const options *o, report_sheet sheet[AGAINST_MAX + 1])
{
    char why[WHY_BYTES];
    int count = 0;
    if (o->beside_count) {
        sheet[count] = (report_sheet){ .heading = "Side by side",
                                       .file = "side-by-side.png",
                                       .amplified = BESIDE_AMPLIFIED };
        if (report_sheet_write(o->beside, o->folder, &sheet[count++], why, sizeof why))
            return fail("--beside: %s", why);
    }
    for (size_t i = 0; i < o->against_count; i++) {
        sheet[count] = (report_sheet){ .heading = "As it is and as it should be",
                                       .amplified = AGAINST_AMPLIFIED };
        snprintf(sheet[count].file, sizeof sheet[count].file, "reference-%zu.png", i + 1);
        if (report_sheet_write(o->against[i], o->folder, &sheet[count++], why, sizeof why))
            return fail("--against: %s", why);
    }
    return count;
}

static int make_report(const options *o, report_flight *flight, char **picture)
{
    char why[WHY_BYTES];
    report_content content = { .title = o->title,
                               .folder = o->folder,
                               .flight = flight,
                               .flight_count = o->csv_count,
                               .picture = (const char *const *)picture,
                               .picture_count = o->picture_count,
                               .settle_s = o->settle_s };
    report_paper paper;
    report_sheet sheet[AGAINST_MAX + 1];
    report_work work;
    if (o->instructions && report_work_load(&work, o->instructions, why, sizeof why))
        return fail("%s", why);
    if (o->instructions) content.work = &work;
    if (o->paper && report_paper_load(&paper, o->paper, why, sizeof why)) return fail("%s", why);
    if (o->paper) content.paper = &paper;
    for (size_t i = 0; i < o->csv_count; i++)
        if (report_flight_load(&flight[i], o->csv[i], why, sizeof why)) return fail("%s", why);
    if (make_folder(o->folder) || copy_pictures(o, picture)) return -1;
    int sheets = make_sheets(o, sheet);
    if (sheets < 0) return -1;
    content.sheet = sheet;
    content.sheet_count = (size_t)sheets;
    if (report_page_html(&content, why, sizeof why) ||
        report_page_markdown(&content, why, sizeof why))
        return fail("%s", why);
    if (o->json)
        report_page_json(&content);
    else
        printf("%s/index.html\n%s/REPORT.md\n", o->folder, o->folder);
    return 0;
}

int main(int argc, char **argv)
{
    size_t room = (size_t)argc;
    options o = { .title = "Farfield flights", .settle_s = 15 };
    o.csv = calloc(room, sizeof *o.csv);
    o.picture = calloc(room, sizeof *o.picture);
    report_flight *flight = calloc(room, sizeof *flight);
    char **picture = calloc(room, sizeof *picture);
    int rc = o.csv && o.picture && flight && picture ? parse(&o, argc, argv)
                                                     : fail("out of memory");
    if (rc == 0) rc = make_report(&o, flight, picture);
    for (size_t i = 0; i < room; i++) {
        if (flight) report_flight_free(&flight[i]);
        if (picture) free(picture[i]);
    }
    free(o.csv);
    free(o.picture);
    free(flight);
    free(picture);
    return rc < 0 ? 1 : 0;
}
