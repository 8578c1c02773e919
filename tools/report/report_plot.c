#include "report_plot.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define PATH_BYTES      4096
#define GNUPLOT_MISSING 127
#define LOGARITHM_FLOOR 0.01

static const char *const colours[] = { "#1b6ca8", "#c8553d", "#588b3a", "#7a4f9a",
                                       "#b8860b", "#3a8a8a", "#8a3a5e", "#555555" };

/* Writes text inside gnuplot's double quotes. */
static void put_quoted(FILE *out, const char *text)
{
    fputc('"', out);
    for (; *text; text++) {
        if (*text == '"' || *text == '\\') fputc('\\', out);
        if ((unsigned char)*text >= ' ') fputc(*text, out);
    }
    fputc('"', out);
}

static void put_label(FILE *out, const char *what, const char *text)
{
    fprintf(out, "set %s ", what);
    put_quoted(out, text);
    fputs(" noenhanced\n", out);
}

static void put_data(FILE *out, const report_curve *curve, size_t number, int logarithmic_y)
{
    fprintf(out, "$curve%zu << END_OF_CURVE\n", number);
    for (size_t i = 0; i < curve->flight->row_count; i++) {
        double x = curve->flight->row[i].value[curve->x] * curve->x_scale;
        double y = curve->flight->row[i].value[curve->y] * curve->y_scale;
        if (isnan(x) || isnan(y))
            fputs("\n", out); /* a gap */
        else
            fprintf(out, "%.9g %.9g\n", x, logarithmic_y ? fmax(y, LOGARITHM_FLOOR) : y);
    }
    fputs("END_OF_CURVE\n", out);
}

static int write_script(const report_plot *plot, const char *script, const char *picture)
{
    FILE *out = fopen(script, "w");
    if (!out) return -1;
    fputs("set terminal svg size 640,300 dynamic font 'sans-serif,12' linewidth 1.2\nset output ",
          out);
    put_quoted(out, picture);
    fputs(
        "\nset grid linetype 1 linecolor rgb '#dddddd'\nset border 3 linecolor rgb '#888888'\nset tics nomirror\n"
        "set key below center horizontal noenhanced\n",
        out);
    put_label(out, "title", plot->title);
    put_label(out, "xlabel", plot->x_label);
    put_label(out, "ylabel", plot->y_label);
    fputs(plot->logarithmic_y ? "set logscale y\n" : "set yrange [0:*<1e15]\n", out);
    if (plot->x_most > 0) fprintf(out, "set xrange [0:%g]\n", plot->x_most);
    for (size_t i = 0; i < plot->curve_count; i++)
        put_data(out, &plot->curve[i], i, plot->logarithmic_y);
    for (size_t i = 0; i < plot->curve_count; i++) {
        fprintf(out, "%s$curve%zu using 1:2 with %s linecolor rgb '%s' title ", i ? ", " : "plot ",
                i, plot->points ? "linespoints pointtype 7 pointsize 0.5" : "lines",
                colours[i % (sizeof colours / sizeof *colours)]);
        put_quoted(out, plot->curve[i].title);
    }
    fputs("\n", out);
    int bad = ferror(out);
    return fclose(out) || bad ? -1 : 0;
}

/* gnuplot's exit status, GNUPLOT_MISSING when it could not be started. */
static int run_gnuplot(const char *script)
{
    pid_t pid = fork();
    if (pid < 0) return GNUPLOT_MISSING;
    if (pid == 0) {
        execlp("gnuplot", "gnuplot", script, (char *)NULL);
        _exit(GNUPLOT_MISSING);
    }
    int status;
    while (waitpid(pid, &status, 0) < 0)
        if (errno != EINTR) return GNUPLOT_MISSING;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

/* The picture from "<svg" on. */
static char *read_svg(const char *picture)
{
    FILE *in = fopen(picture, "r");
    char *text = NULL, *svg = NULL;
    long size = -1;
    if (!in) return NULL;
    if (!fseek(in, 0, SEEK_END)) size = ftell(in);
    rewind(in);
    if (size > 0) text = calloc(1, (size_t)size + 1);
    if (text && fread(text, 1, (size_t)size, in) == (size_t)size) {
        char *start = strstr(text, "<svg");
        if (start) svg = strdup(start);
    }
    free(text);
    fclose(in);
    return svg;
}

static int draw(const report_plot *plot, const char *folder, char **svg, char *why,
                size_t why_bytes)
{
    char script[PATH_BYTES], picture[PATH_BYTES];
    int status, rc = -1;
    snprintf(script, sizeof script, "%s/plot.gp", folder);
    snprintf(picture, sizeof picture, "%s/plot.svg", folder);
    *svg = NULL;
    if (write_script(plot, script, picture))
        snprintf(why, why_bytes, "%s: %s", script, strerror(errno));
    else if ((status = run_gnuplot(script)) == GNUPLOT_MISSING)
        snprintf(why, why_bytes, "cannot run gnuplot (Debian package gnuplot-nox)");
    else if (status || !(*svg = read_svg(picture)))
        snprintf(why, why_bytes, "gnuplot failed (status %d) on %s", status, plot->title);
    else
        rc = 0;
    remove(script);
    remove(picture);
    return rc;
}

int report_plot_put(FILE *out, const char *folder, const report_plot *plot, char *why,
                    size_t why_bytes)
{
    char *svg;
    if (!plot->curve_count) return 0;
    if (draw(plot, folder, &svg, why, why_bytes)) return -1;
    fprintf(out, "<figure>%s</figure>\n", svg);
    free(svg);
    return 0;
}
