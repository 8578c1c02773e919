#include "bake_say.h"

#include "raster/bake_gdal.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define BAR_CELLS 40

static const char *program_name = "farfield";
static int quiet_run;
static int bar_shown;

void bake_say_setup(const char *program, int quiet)
{
    program_name = program;
    quiet_run = quiet;
}

/* Wipes an unfinished bar, so that no message is glued to it. */
static void wipe_bar(void)
{
    if (bar_shown) fprintf(stderr, "\r%*s\r", BAR_CELLS + 30, "");
    bar_shown = 0;
}

static void say(const char *format, va_list args, const char *more)
{
    char line[800];
    vsnprintf(line, sizeof line, format, args);
    wipe_bar();
    fprintf(stderr, "%s: %s%s%s\n", program_name, line, *more ? ": " : "", more);
}

int bake_fail(const char *format, ...)
{
    va_list args;
    va_start(args, format);
    say(format, args, "");
    va_end(args);
    return -1;
}

int bake_fail_gdal(const char *format, ...)
{
    char more[400];
    snprintf(more, sizeof more, "%s", CPLGetLastErrorMsg());
    more[strcspn(more, "\n")] = 0;
    va_list args;
    va_start(args, format);
    say(format, args, more);
    va_end(args);
    return -1;
}

void bake_note(const char *format, ...)
{
    if (quiet_run) return;
    va_list args;
    va_start(args, format);
    say(format, args, "");
    va_end(args);
}

void bake_progress(const char *stage, uint64_t done, uint64_t total)
{
    static int last_percent = -1;
    if (quiet_run || !total || !isatty(STDERR_FILENO)) return;
    int percent = (int)(done * 100 / total);
    if (percent == last_percent && done < total) return;
    last_percent = percent;
    char bar[BAR_CELLS + 1];
    memset(bar, ' ', BAR_CELLS);
    memset(bar, '#', (size_t)(percent * BAR_CELLS / 100));
    bar[BAR_CELLS] = 0;
    fprintf(stderr, "\r%-12s [%s] %3d %%", stage, bar, percent);
    bar_shown = 1;
    if (done >= total) wipe_bar();
    fflush(stderr);
}
