/* Fins of outlines: outlines of neighbouring columns that go on in height and in distance make a
 * chain; a chain becomes a line of few vertices. */
#include "ff_far_outline.h"

#include <stdlib.h>
#include <string.h>

#define GAP_MAX     2                  /* columns from one outline to the next of a chain */
#define STEP_MAX    5                  /* texels that it may rise or fall in a column */
#define RATIO_Q8    333                /* and so many times as near or far may it be */
#define LENGTH_MIN  3                  /* columns of a chain */
#define INVERSE     (INT64_C(1) << 44) /* nearness: this by distance */
#define NEARNESS_OF 32                 /* a vertex may be a 32nd off in nearness */

typedef struct far_chain {
    uint32_t first, last; /* outlines */
    uint32_t columns;
    int32_t distance_wu; /* of its nearest outline */
    uint64_t worth;
    uint32_t vertices; /* how many it became, and where they begin */
    uint32_t vertex;
} far_chain;

typedef struct far_chains {
    const ff_far_outlines *outlines;
    uint32_t *next; /* of each outline: the following one of its chain, plus 1 */
    uint8_t *taken; /* it goes on something */
    far_chain *chain;
    uint32_t count;
} far_chains;

/* ---- chains ---- */

/* How badly `to` goes on `from`; -1: not at all. */
static int64_t misfit(const ff_far_picture *picture, const ff_far_outline *from,
                      const ff_far_outline *to)
{
    int32_t gap = to->column - from->column, rise = to->row - from->row;
    int64_t a = from->distance_wu, b = to->distance_wu;
    if (rise < 0) rise = -rise;
    if (rise > STEP_MAX * gap * picture->fine || a * 256 > b * RATIO_Q8 || b * 256 > a * RATIO_Q8)
        return -1;
    int64_t ratio_q8 = (a > b ? a * 256 / b : b * 256 / a) - 256;
    return (int64_t)rise * 256 / picture->fine + 8 * ratio_q8 + 1024 * (gap - 1);
}

/* The free outline among [from, to) that goes on best; -1: none does. */
static int64_t best_next(const far_chains *chains, const ff_far_picture *picture,
                         const ff_far_spots *spots, uint32_t at, uint32_t from, uint32_t to)
{
    const ff_far_outline *outline = chains->outlines->outline;
    int64_t best = -1, least = INT64_MAX;
    for (uint32_t i = from; i < to; i++) {
        if (!spots->spot[outline[i].spot].seen || chains->taken[i]) continue;
        int64_t by = misfit(picture, &outline[at], &outline[i]);
        if (by < 0 || by >= least) continue;
        least = by;
        best = i;
    }
    return best;
}

static uint32_t column_end(const ff_far_outlines *outlines, uint32_t from)
{
    uint32_t end = from;
    while (end < outlines->count && outlines->outline[end].column == outlines->outline[from].column)
        end++;
    return end;
}

/* What goes on outline `at`: in the next column or the one after it. */
static void link(far_chains *chains, const ff_far_picture *picture, const ff_far_spots *spots,
                 uint32_t at, uint32_t from)
{
    const ff_far_outlines *outlines = chains->outlines;
    while (from < outlines->count &&
           outlines->outline[from].column - outlines->outline[at].column <= GAP_MAX) {
        uint32_t to = column_end(outlines, from);
        int64_t found = best_next(chains, picture, spots, at, from, to);
        if (found >= 0) {
            chains->next[at] = (uint32_t)found + 1;
            chains->taken[found] = 1;
            return;
        }
        from = to;
    }
}

static void link_all(far_chains *chains, const ff_far_picture *picture, const ff_far_spots *spots)
{
    const ff_far_outlines *outlines = chains->outlines;
    for (uint32_t i = 0; i < outlines->count;) {
        uint32_t end = column_end(outlines, i);
        for (; i < end; i++)
            if (spots->spot[outlines->outline[i].spot].seen) link(chains, picture, spots, i, end);
    }
}

/* A jump to the sky is worth more than one to ground twice as far. */
static uint64_t worth_of(const ff_far_outline *outline)
{
    int64_t ratio = outline->behind_wu == FF_FAR_NOTHING
                        ? 8
                        : outline->behind_wu / outline->distance_wu;
    return (uint64_t)(ratio > 8 ? 8 : ratio);
}

static void list_chains(far_chains *chains, const ff_far_spots *spots)
{
    const ff_far_outline *outline = chains->outlines->outline;
    for (uint32_t i = 0; i < chains->outlines->count; i++) {
        far_chain chain = { .first = i, .distance_wu = INT32_MAX };
        if (chains->taken[i] || !spots->spot[outline[i].spot].seen) continue;
        for (uint32_t at = i + 1; at; at = chains->next[at - 1]) {
            chain.last = at - 1;
            chain.worth += worth_of(&outline[at - 1]);
            if (outline[at - 1].distance_wu < chain.distance_wu)
                chain.distance_wu = outline[at - 1].distance_wu;
        }
        chain.columns = (uint32_t)(outline[chain.last].column - outline[i].column) + 1;
        if (chain.columns >= LENGTH_MIN) chains->chain[chains->count++] = chain;
    }
}

/* ---- lines ---- */

static int32_t up_q2_of(const ff_far_picture *picture, const ff_far_outline *outline)
{
    int32_t subs = picture->height / 2 - outline->row, fine = picture->fine;
    return subs >= 0 ? (subs * 4 + fine / 2) / fine : -((-subs * 4 + fine / 2) / fine);
}

static ff_fin_vertex vertex_of(const ff_far_picture *picture, const ff_far_outline *outline)
{
    return (ff_fin_vertex){ .column = outline->column,
                            .up_q2 = (int16_t)up_q2_of(picture, outline),
                            .distance = (uint16_t)ff_far_distance_step(outline->distance_wu) };
}

/* A straight line in space is one in the picture, and its nearness is linear there. */
static int on_line(const ff_far_picture *picture, const ff_fin_vertex *a, const ff_fin_vertex *b,
                   const ff_far_outline *between, int32_t tolerance_q2)
{
    int64_t whole = b->column - a->column, part = between->column - a->column;
    int64_t off = (int64_t)a->up_q2 * (whole - part) + (int64_t)b->up_q2 * part -
                  (int64_t)(picture->height / 2 - between->row) * 4 * whole / picture->fine;
    if (off > tolerance_q2 * whole || off < -tolerance_q2 * whole) return 0;
    int64_t near_a = INVERSE / ff_far_distance_wu(a->distance),
            near_b = INVERSE / ff_far_distance_wu(b->distance),
            here = INVERSE / between->distance_wu,
            line = (near_a * (whole - part) + near_b * part) / whole;
    int64_t apart = line > here ? line - here : here - line;
    return apart * NEARNESS_OF <= here;
}

/* The farthest outline to which a line goes from `at`, plus 1; the last one is chain->last. */
static uint32_t reach(const far_chains *chains, const ff_far_picture *picture, uint32_t at,
                      int32_t tolerance_q2)
{
    const ff_far_outline *outline = chains->outlines->outline;
    const ff_fin_vertex a = vertex_of(picture, &outline[at]);
    uint32_t best = chains->next[at];
    unsigned failed = 0;
    for (uint32_t end = best; end && failed < 12; end = chains->next[end - 1]) {
        const ff_fin_vertex b = vertex_of(picture, &outline[end - 1]);
        uint32_t i = chains->next[at];
        while (i != end && on_line(picture, &a, &b, &outline[i - 1], tolerance_q2))
            i = chains->next[i - 1];
        if (i == end)
            best = end, failed = 0;
        else
            failed++;
    }
    return best;
}

/* Vertices written, 0 when there is no room for all of them. */
static uint32_t draw_line(const far_chains *chains, const ff_far_picture *picture,
                          const far_chain *chain, int32_t tolerance_q2, ff_fin_vertex *vertex,
                          uint32_t room)
{
    uint32_t count = 0;
    for (uint32_t at = chain->first + 1; at; at = reach(chains, picture, at - 1, tolerance_q2)) {
        if (count == room) return 0;
        vertex[count] = vertex_of(picture, &chains->outlines->outline[at - 1]);
        vertex[count].begins = count == 0;
        count++;
    }
    return count;
}

static int by_worth(const void *a, const void *b)
{
    const far_chain *ca = a, *cb = b;
    if (ca->worth != cb->worth) return ca->worth < cb->worth ? 1 : -1;
    return ca->first < cb->first ? -1 : ca->first > cb->first;
}

static int by_distance(const void *a, const void *b)
{
    const far_chain *ca = a, *cb = b;
    if (ca->distance_wu != cb->distance_wu) return ca->distance_wu < cb->distance_wu ? 1 : -1;
    return ca->first < cb->first ? -1 : ca->first > cb->first;
}

/* Those worth most find room first; then they are put in order. */
static int draw_lines(far_chains *chains, const ff_far_picture *picture, int32_t tolerance_q2,
                      ff_fin_vertex *vertex)
{
    static const size_t bytes = FF_FAR_VERTICES_MAX * sizeof *vertex;
    ff_fin_vertex *drawn = malloc(bytes);
    uint32_t count = 0, out = 0;
    if (!drawn) return FF_ERR_MEMORY;
    qsort(chains->chain, chains->count, sizeof *chains->chain, by_worth);
    for (uint32_t i = 0; i < chains->count; i++) {
        far_chain *chain = &chains->chain[i];
        chain->vertex = count;
        chain->vertices = draw_line(chains, picture, chain, tolerance_q2, drawn + count,
                                    FF_FAR_VERTICES_MAX - count);
        count += chain->vertices;
    }
    qsort(chains->chain, chains->count, sizeof *chains->chain, by_distance);
    for (uint32_t i = 0; i < chains->count; i++) {
        const far_chain *chain = &chains->chain[i];
        memcpy(vertex + out, drawn + chain->vertex, chain->vertices * sizeof *vertex);
        out += chain->vertices;
    }
    free(drawn);
    return (int)out;
}

int ff_far_fins_make(const ff_far_outlines *outlines, const ff_far_picture *picture,
                     const ff_far_spots *spots, uint8_t tolerance_q2, ff_fin_vertex *vertex)
{
    if (outlines->count == 0) return 0;
    far_chains chains = { .outlines = outlines,
                          .next = calloc(outlines->count, sizeof *chains.next),
                          .taken = calloc(outlines->count, 1),
                          .chain = calloc(outlines->count, sizeof *chains.chain) };
    int rc = FF_ERR_MEMORY;
    if (chains.next && chains.taken && chains.chain) {
        link_all(&chains, picture, spots);
        list_chains(&chains, spots);
        rc = draw_lines(&chains, picture, tolerance_q2, vertex);
    }
    free(chains.next);
    free(chains.taken);
    free(chains.chain);
    return rc;
}
