#include "merge_samples.h"

#include "../bake/bake_say.h"
#include "merge_fill.h"

#include <string.h>

#define PIECE 1024 /* places at once */

/* Some places of a row, as they are put together. */
typedef struct stretch {
    uint32_t row, first, end; /* columns first .. end - 1 */
    uint16_t *heights;
    uint8_t *marks;
} stretch;

static uint32_t least(uint32_t a, uint32_t b) { return a < b ? a : b; }
static uint32_t most(uint32_t a, uint32_t b) { return a > b ? a : b; }

/* ---- beyond all packs ---- */

/* The number of the fill's column or row that stands at a place, or -1. */
static int64_t fill_at(uint32_t at, uint32_t last, uint32_t log2)
{
    if (at == last) return (last >> log2) + ((last & ((1u << log2) - 1)) != 0);
    return at & ((1u << log2) - 1) ? -1 : (int64_t)(at >> log2);
}

static int put_fill(const merge_samples *m, const stretch *s)
{
    uint16_t height[PIECE + 2];
    int64_t row = fill_at(s->row, m->lattice->height - 1, m->fill_log2);
    memset(s->marks, BAKE_BETWEEN | BAKE_FILLED, s->end - s->first);
    if (row < 0 || m->fill.fd < 0) return 0;
    uint32_t from = s->first >> m->fill_log2,
             count = least((s->end - 1) >> m->fill_log2, m->fill.width - 2) + 2 - from;
    if (bake_grid_read(&m->fill, (uint32_t)row, from, count, height)) return -1;
    for (uint32_t at = s->first; at < s->end; at++) {
        int64_t column = fill_at(at, m->lattice->width - 1, m->fill_log2);
        if (column < 0) continue;
        s->heights[at - s->first] = height[column - from];
        s->marks[at - s->first] = BAKE_FILLED;
    }
    return 0;
}

/* What is within a pack's reach is between its samples, not filled. */
static void put_reach(const merge_layer *layer, const stretch *s)
{
    const merge_rectangle *r = &layer->reach;
    if (s->row < r->bottom || s->row > r->top) return;
    for (uint32_t at = most(s->first, r->left); at < least(s->end, r->right + 1); at++)
        if (s->marks[at - s->first] == (BAKE_BETWEEN | BAKE_FILLED))
            s->marks[at - s->first] = BAKE_BETWEEN;
}

/* ---- packs ---- */

/* A pack's heights are within what its description says, or it is damaged. */
static int put_height(const merge_layer *layer, uint16_t height, uint16_t *to)
{
    const ff_terrain_info *info = &layer->ground.unpack->pack.header.info;
    if (height < info->height_min || height > info->height_max)
        return bake_fail("%s: a height of %u steps is not from %u to %u, as its header says",
                         layer->ground.unpack->path, height, info->height_min, info->height_max);
    *to = (uint16_t)(height + layer->place.steps);
    return 0;
}

/* The samples `first` and on of a row of a pack, `count` of them. */
static int put_samples(const merge_layer *layer, uint32_t row, uint32_t first, uint32_t count,
                       const stretch *s)
{
    const export_ground *ground = &layer->ground;
    uint16_t height[PIECE];
    uint8_t mask[PIECE];
    uint32_t from_north = ground->cells.height - 1 - row;
    if (bake_grid_read(&ground->cells, from_north, first, count, height)) return -1;
    memset(mask, EXPORT_MEASURED, count);
    if (ground->mask.fd >= 0 && bake_grid_read(&ground->mask, from_north, first, count, mask))
        return -1;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t at = layer->place.left + ((first + i) << layer->place.apart_log2) - s->first;
        int is_filled = mask[i] == EXPORT_FILLED;
        if (is_filled && !(s->marks[at] & BAKE_FILLED)) continue; /* there is other ground */
        if (put_height(layer, height[i], &s->heights[at])) return -1;
        s->marks[at] = is_filled ? BAKE_FILLED : 0;
    }
    return 0;
}

static int put_layer(const merge_layer *layer, const stretch *s)
{
    const merge_place *p = &layer->place;
    uint32_t apart = 1u << p->apart_log2, row = (s->row - p->bottom) >> p->apart_log2;
    if (s->row < p->bottom || (s->row - p->bottom) & (apart - 1) || row >= p->rows) return 0;
    uint32_t first = s->first > p->left ? (s->first - p->left + apart - 1) >> p->apart_log2 : 0,
             end = s->end > p->left
                       ? least((s->end - p->left - 1) >> p->apart_log2, p->columns - 1) + 1
                       : 0;
    return first < end ? put_samples(layer, row, first, end - first, s) : 0;
}

/* The samples are the first part. */
static int read_row(const bake_samples *samples, uint32_t row, uint32_t column, uint32_t count,
                    uint16_t *heights, uint8_t *marks)
{
    const merge_samples *m = (const merge_samples *)samples;
    uint8_t unwanted[PIECE];
    for (uint32_t done = 0; done < count; done += PIECE) {
        uint32_t first = column + done, some = least(count - done, PIECE);
        stretch s = { row, first, first + some, heights + done, marks ? marks + done : unwanted };
        memset(s.heights, 0, some * sizeof *s.heights);
        if (put_fill(m, &s)) return -1;
        for (uint32_t i = 0; i < m->count; i++) {
            if (put_layer(&m->layer[i], &s)) return -1;
            put_reach(&m->layer[i], &s);
        }
    }
    return 0;
}

static uint32_t apart_log2(const bake_samples *samples, uint32_t column, uint32_t row,
                           uint32_t side_log2)
{
    const merge_samples *m = (const merge_samples *)samples;
    uint64_t right = column + ((uint64_t)1 << side_log2), top = row + ((uint64_t)1 << side_log2);
    uint32_t apart = m->lattice->apart_log2;
    for (uint32_t i = 0; i < m->count; i++) {
        const merge_rectangle *r = &m->layer[i].reach;
        if (r->left > right || r->right < column || r->bottom > top || r->top < row) continue;
        apart = least(apart, m->layer[i].place.apart_log2);
    }
    return apart;
}

/* ---- all ---- */

static int open_layer(const bake_unpack *unpack, const merge_place *place,
                      const merge_lattice *lattice, merge_layer *layer)
{
    static const bake_box everywhere;
    uint32_t finest = ff_terrain_levels(&unpack->pack.header.info) - 1;
    layer->place = *place;
    layer->reach = merge_place_reach(lattice, place);
    return export_ground_open(unpack, finest, &everywhere, &layer->ground);
}

/* named[i]: the pack of layer i. A pack holds over as many as its layer's number. */
static void order_layers(const merge_place place[], uint32_t count, uint32_t named[])
{
    for (uint32_t i = 0; i < count; i++) {
        uint32_t under = 0;
        for (uint32_t j = 0; j < count; j++) under += (uint32_t)merge_place_precedes(place, i, j);
        named[under] = i;
    }
}

/* Marks cost time: there are none where all places have a measured sample. */
static int needs_marks(const merge_samples *m)
{
    for (uint32_t i = 0; i < m->count; i++)
        if (m->layer[i].ground.mask.fd >= 0) return 1;
    return m->lattice->apart_log2 || m->gap > 0;
}

int merge_samples_open(const bake_unpack unpack[], const merge_place place[], uint32_t count,
                       const merge_lattice *lattice, merge_samples *m)
{
    uint32_t named[MERGE_PACKS_MAX];
    *m = (merge_samples){ .samples = { lattice->width, lattice->height, 1, read_row, apart_log2 },
                          .lattice = lattice,
                          .fill = BAKE_GRID_CLOSED };
    order_layers(place, count, named);
    for (; m->count < count; m->count++)
        if (open_layer(&unpack[named[m->count]], &place[named[m->count]], lattice,
                       &m->layer[m->count]))
            return -1;
    m->gap = merge_lattice_gap(lattice, place, count);
    if (m->gap > 0 && merge_fill_make(m)) return -1;
    m->samples.has_marks = needs_marks(m);
    return 0;
}

void merge_samples_close(merge_samples *m)
{
    for (uint32_t i = 0; i < m->count; i++) export_ground_close(&m->layer[i].ground);
    bake_grid_close(&m->fill);
    m->count = 0;
}
