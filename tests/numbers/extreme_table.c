#include "extreme_table.h"
#include "../../platform/sys.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define ROWS_MAX   64
#define LINE_BYTES 512
#define NOTE_BYTES 1024

static const char note[] =
    "\nRun time: processor time of the client for each picture that changed (data taken in, selection, drawing with the integer back end), as\n"
    "a multiple of an ordinary picture's, drawn in turns with it in the same run: settled over hills at 200 m, a metre on every frame. Rows\n"
    "with nothing to draw: of a selection, or of a rule's evaluation, against an ordinary one's; near/far: against the narrow ratio's picture.\n";

static extreme_row row_of[ROWS_MAX];
static unsigned rows;

extreme_row *extreme_row_begin(const char *name, const char *measured, const char *unit,
                               double bound)
{
    if (rows == ROWS_MAX) abort();
    extreme_row *row = &row_of[rows++];
    *row = (extreme_row){ .name = name, .measured = measured, .unit = unit, .bound = bound };
    return row;
}

int extreme_row_expect(extreme_row *row, int holds, const char *what)
{
    if (!holds && !row->failed) {
        row->failed = 1;
        snprintf(row->verdict, sizeof row->verdict, "%s", what);
    }
    return holds;
}

void extreme_row_value(extreme_row *row, double value)
{
    if (!(value <= row->worst)) row->worst = value;
    extreme_row_expect(row, value <= row->bound, "above the bound");
}

double extreme_processor_s(void) { return (double)clock() / CLOCKS_PER_SEC; }

/* As a multiple of the ordinary case's. */
static void cost_text(const extreme_cost *cost, char text[16])
{
    if (cost->own_times && cost->ordinary_s > 0)
        snprintf(text, 16, "%.2g",
                 cost->own_s / (double)cost->own_times /
                     (cost->ordinary_s / (double)cost->ordinary_times));
    else
        snprintf(text, 16, "-");
}

int extreme_table_write(const char *path)
{
    size_t capacity = (rows + 4) * LINE_BYTES + NOTE_BYTES, count = 0;
    char *text = malloc(capacity);
    if (!text) return FF_ERR_MEMORY;
    count += (size_t)snprintf(
        text + count, capacity - count,
        "| case | measured | largest | bound | run time | frames | selections | triangles | requests | bytes | audited px | verdict |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (unsigned i = 0; i < rows; i++) {
        const extreme_row *row = &row_of[i];
        const extreme_work *work = &row->work;
        char cost[16];
        cost_text(&row->cost, cost);
        count += (size_t)snprintf(
            text + count, LINE_BYTES,
            "| %s | %s | %.4g %s | %.4g | %s | %llu | %llu | %llu | %llu | %llu | %llu | %s |\n",
            row->name, row->measured, row->worst, row->unit, row->bound, cost,
            (unsigned long long)work->frames, (unsigned long long)work->selects,
            (unsigned long long)work->triangles, (unsigned long long)work->requests,
            (unsigned long long)work->bytes, (unsigned long long)work->audited,
            row->failed ? row->verdict : "holds");
    }
    count += (size_t)snprintf(text + count, NOTE_BYTES, "%s", note);
    int rc = sys_write_file(path, text, count);
    free(text);
    return rc;
}
