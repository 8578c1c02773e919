/* farfield-report: flights' CSV files become an HTML page with plots and a Markdown table. */
#include "report_page.h"
#include "report_sheet.h"
#include "report_slider.h"

#include "../../client/farfield.h"
#include "../../platform/options/sys_options.h"

#include <errno.h>
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

/* NAME=DIR or DIR=DIR, cut at the `=`. */
typedef struct report_pairs {
    size_t count, room; /* the program sets room before parsing */
    struct {
        char left[PATH_BYTES];
        const char *right;
    } pair[AGAINST_MAX];
} report_pairs;

static int take_pair(const sys_option *option, const char *text, void *field)
{
    report_pairs *pairs = field;
    size_t left = strcspn(text, "=");
    (void)option;
    if (!left || left >= PATH_BYTES || !text[left] || !text[left + 1]) return SYS_NOT_ONE;
    if (pairs->count == pairs->room) return SYS_TOO_MANY;
    memcpy(pairs->pair[pairs->count].left, text, left);
    pairs->pair[pairs->count].left[left] = '\0';
    pairs->pair[pairs->count++].right = text + left + 1;
    return 0;
}

static int pair_range(const sys_option *option, char *text, size_t room)
{
    return snprintf(text, room, "%s", option->value);
}

static const sys_option_type report_pairs_option = { "", pair_range, take_pair };

/* clang-format off */
#define REPORT_OPTIONS(OPTION) \
    OPTION(sys_texts, csv, NULL, "CSV", NULL, SYS_FLAGS(SYS_NEEDED | SYS_REPEATABLE), \
           "of a flight, from farfield-fly") \
    OPTION(sys_text, folder, "output", "DIR", NULL, SYS_FLAGS(SYS_NEEDED | SYS_LETTER), \
           "folder for the report, made if missing") \
    OPTION(sys_text, title, "title", "TITLE", "Farfield flights", SYS_ANY, \
           "heading of the report") \
    OPTION(sys_texts, picture, "picture", "FILE", NULL, SYS_FLAGS(SYS_REPEATABLE | SYS_FOLLOWED), \
           "copies a picture into DIR and shows it; several files may follow until the next " \
           "option") \
    OPTION(report_pairs, slider, "slider", "NAME=DIR", NULL, SYS_FLAGS(SYS_REPEATABLE), \
           "given twice, for a flight's folder of farfield-fly --png and for that of its " \
           "--reference: the page opens with their last picture, a slider between the two, and " \
           "what the CSV that is named as the first folder tells of that moment") \
    OPTION(sys_text, owner, "attribution", "TEXT", NULL, SYS_ANY, \
           "whose ground it is, below those pictures") \
    OPTION(report_pairs, beside, "beside", "NAME=DIR", NULL, SYS_FLAGS(SYS_REPEATABLE), \
           "given twice, for folders of farfield-fly --png: up to five pictures of the same " \
           "moments from both and their difference become one, DIR/side-by-side.png") \
    OPTION(report_pairs, against, "against", "DIR=DIR", NULL, SYS_FLAGS(SYS_REPEATABLE), \
           "pictures of a flight and, by the same names, how they should look (farfield-fly " \
           "--png, --reference): a sheet of both and where they differ; up to eight times") \
    OPTION(sys_text, instructions, "instructions", "TABLE", NULL, SYS_ANY, \
           "draws the error against instructions: work-precision.csv of make bench-handheld") \
    OPTION(sys_text, paper, "paper", "TABLE", NULL, SYS_ANY, \
           "puts flights named LINK-SPEED-QUALITY-PANORAMA beside those of a paper " \
           "(tools/report/hybrid_table3.csv), and draws the error of flights named " \
           "sweep-SERIES-VALUE against their work") \
    OPTION(sys_real, settle_s, "settle", "S", "15", SYS_REAL(0, 1e6, "s"), \
           "standing still before a flight") \
    OPTION(sys_flag, json, "json", NULL, NULL, SYS_ANY, "prints the summaries as JSON")
/* clang-format on */

typedef struct options {
    REPORT_OPTIONS(SYS_FIELD)
} options;

#define ROW(type, field, name, value, fallback, range, help) \
    SYS_OPTION(options, type, field, name, value, fallback, help, range)
static const sys_option row[] = { REPORT_OPTIONS(ROW) };
#undef ROW

static const sys_program program = {
    .name = "farfield-report",
    .version = FARFIELD_VERSION,
    .usage = "[OPTION]... CSV... -o DIR",
    .about = "Makes a report of flights: DIR/index.html with plots, and DIR/REPORT.md. The page "
             "can be read without a network.",
    .option = row,
    .option_count = sizeof row / sizeof *row
};

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
    for (size_t i = 0; i < o->picture.count; i++) {
        char to[PATH_BYTES];
        if (!(names[i] = picture_name(o->picture.text[i], i))) return fail("out of memory");
        if ((size_t)snprintf(to, sizeof to, "%s/%s", o->folder, names[i]) >= sizeof to)
            return fail("path too long: %s", names[i]);
        if (copy_file(o->picture.text[i], to)) return -1;
    }
    return 0;
}

/* The two folders of --slider or --beside. */
static void series_of(const report_pairs *pairs, report_series both[2])
{
    for (int i = 0; i < 2; i++)
        both[i] = (report_series){ pairs->pair[i].left, pairs->pair[i].right };
}

/* Makes all sheets; their number, or -1. */
static int make_sheets(const options *o, report_sheet sheet[AGAINST_MAX + 1])
{
    char why[WHY_BYTES];
    int count = 0;
    if (o->beside.count) {
        report_series both[2];
        series_of(&o->beside, both);
        sheet[count] = (report_sheet){ .heading = "Side by side",
                                       .file = "side-by-side.png",
                                       .amplified = BESIDE_AMPLIFIED };
        if (report_sheet_write(both, o->folder, &sheet[count++], why, sizeof why))
            return fail("--beside: %s", why);
    }
    for (size_t i = 0; i < o->against.count; i++) {
        const char *flight = o->against.pair[i].left, *slash = strrchr(flight, '/');
        report_series both[2] = { { slash && slash[1] ? slash + 1 : flight, flight },
                                  { "as it should be", o->against.pair[i].right } };
        sheet[count] = (report_sheet){ .heading = "As it is and as it should be",
                                       .amplified = AGAINST_AMPLIFIED };
        snprintf(sheet[count].file, sizeof sheet[count].file, "reference-%zu.png", i + 1);
        if (report_sheet_write(both, o->folder, &sheet[count++], why, sizeof why))
            return fail("--against: %s", why);
    }
    return count;
}

static int make_report(const options *o, report_flight *flight, char **picture)
{
    char why[WHY_BYTES];
    report_content content = { .title = o->title,
                               .folder = o->folder,
                               .owner = o->owner,
                               .flight = flight,
                               .flight_count = o->csv.count,
                               .picture = (const char *const *)picture,
                               .picture_count = o->picture.count,
                               .settle_s = o->settle_s };
    report_paper paper;
    report_sheet sheet[AGAINST_MAX + 1];
    report_series both[2];
    report_slider slider;
    report_work work;
    if (o->instructions && report_work_load(&work, o->instructions, why, sizeof why))
        return fail("%s", why);
    if (o->instructions) content.work = &work;
    if (o->paper && report_paper_load(&paper, o->paper, why, sizeof why)) return fail("%s", why);
    if (o->paper) content.paper = &paper;
    for (size_t i = 0; i < o->csv.count; i++)
        if (report_flight_load(&flight[i], o->csv.text[i], why, sizeof why)) return fail("%s", why);
    if (make_folder(o->folder) || copy_pictures(o, picture)) return -1;
    series_of(&o->slider, both);
    if (o->slider.count &&
        report_slider_make(both, flight, o->csv.count, o->folder, &slider, why, sizeof why))
        return fail("--slider: %s", why);
    if (o->slider.count) content.slider = &slider;
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

static int parse(options *o, int argc, char **argv)
{
    int rc = sys_options_parse(&program, o, argc, argv);
    if (rc) return rc;
    if (o->slider.count == 1) return fail("--slider: give two folders");
    return o->beside.count == 1 ? fail("--beside: give two folders") : 0;
}

int main(int argc, char **argv)
{
    static options o = { .slider.room = 2, .beside.room = 2, .against.room = AGAINST_MAX };
    size_t room = (size_t)argc;
    const char **words = calloc(2 * room, sizeof *words);
    report_flight *flight = calloc(room, sizeof *flight);
    char **picture = calloc(room, sizeof *picture);
    int rc = -1, usage = 0;
    if (words && flight && picture) {
        o.csv = (sys_texts){ .text = words, .room = room };
        o.picture = (sys_texts){ .text = words + room, .room = room };
        usage = parse(&o, argc, argv);
        rc = usage ? usage : make_report(&o, flight, picture);
    } else {
        fail("out of memory");
    }
    for (size_t i = 0; i < room; i++) {
        if (flight) report_flight_free(&flight[i]);
        if (picture) free(picture[i]);
    }
    free(words);
    free(flight);
    free(picture);
    return usage < 0 ? SYS_EXIT_USAGE : rc < 0 ? SYS_EXIT_FAILED : SYS_EXIT_DONE;
}
