#include "slow_trained.h"

#include "slow_tail.h"

#include "../../protocol/trained/ff_trained.h"

#include <stdlib.h>
#include <string.h>

#define SIDE_MAX 65

enum { CLASS_R, CLASS_N, CLASS_C, CLASS_H, CLASS_V };

/* A grid in the middle of a doubling, its new points one apart. */
typedef struct doubling {
    int64_t height[SIDE_MAX][SIDE_MAX], off[SIDE_MAX][SIDE_MAX]; /* [y][x]; off: e of SPEC.md */
    int cells;                                                   /* along a side */
    int last_x, last_y;                                          /* E and F */
    int repeated_x, repeated_y; /* the odd column, the odd row that are not told, or -1 */
    int set;                    /* of weights */
    int left_out;               /* sides */
    const uint16_t *known;      /* heights of these */
} doubling;

typedef struct stream {
    int words;
    const uint8_t *bytes; /* a copy of the stream's bits, shifted together */
    int64_t count, taken;
    uint64_t width, code;
    int wrong;
    slow_payload *of; /* sides are read from its tail; NULL: there are none */
    int64_t *length;  /* of sides, or NULL */
} stream;

/* A point, and which way its surroundings count. */
typedef struct place {
    int x, y, along_x, along_y, away_x, away_y;
} place;

typedef struct tap {
    int a, b;
} tap;

typedef struct expected {
    int64_t mean_q4, predicted, likeliest;
    int scale, phase;
} expected;

static const tap taps_r[] = { { -1, 0 }, { 1, 0 }, { -3, 0 }, { 3, 0 }, { -1, 2 }, { 1, 2 },
                              { -3, 2 }, { 3, 2 }, { -1, 4 }, { 1, 4 }, { -2, 0 } };
static const tap taps_n[] = { { -1, -1 }, { 1, -1 }, { -1, 1 }, { 1, 1 },   { -3, -1 },
                              { -3, 1 },  { 3, -1 }, { 3, 1 },  { -1, 3 },  { 1, 3 },
                              { -3, 3 },  { 3, 3 },  { 0, -1 }, { -2, -1 }, { 2, -1 } };
static const tap taps_c[] = { { -1, -1 }, { 1, -1 }, { -1, 1 },  { 1, 1 },   { -3, -1 },
                              { -3, 1 },  { 3, -1 }, { 3, 1 },   { -1, 3 },  { 1, 3 },
                              { -3, 3 },  { 3, 3 },  { -1, -3 }, { 1, -3 },  { -3, -3 },
                              { 3, -3 },  { -2, 0 }, { 0, -2 },  { -2, -2 }, { 2, -2 } };
static const tap taps_h[] = { { -1, 0 }, { 1, 0 },   { 0, -1 },  { 0, 1 },   { -3, 0 },
                              { 3, 0 },  { 0, -3 },  { 0, 3 },   { -2, -1 }, { 2, -1 },
                              { -2, 1 }, { 2, 1 },   { -1, -2 }, { 1, -2 },  { -1, 2 },
                              { 1, 2 },  { -1, -1 }, { 1, -1 },  { -2, 0 },  { 0, -2 } };
static const tap taps_v[] = { { -1, 0 }, { 1, 0 },   { 0, -1 },  { 0, 1 },   { -3, 0 },
                              { 3, 0 },  { 0, -3 },  { 0, 3 },   { -2, -1 }, { 2, -1 },
                              { -2, 1 }, { 2, 1 },   { -1, -2 }, { 1, -2 },  { -1, 2 },
                              { 1, 2 },  { -1, -1 }, { -1, 1 },  { 0, -2 },  { -2, 0 } };
static const struct {
    const tap *tap;
    int taps, base, traits;
} classes[] = { { taps_r, 11, 2, 8 },
                { taps_n, 15, 4, 7 },
                { taps_c, 20, 4, 6 },
                { taps_h, 20, 4, 7 },
                { taps_v, 20, 4, 7 } };

static int64_t within(int64_t least, int64_t value, int64_t most)
{
    return value < least ? least : value > most ? most : value;
}

static int64_t floored(int64_t value, int64_t divisor)
{
    int64_t whole = value / divisor;

    return whole * divisor > value ? whole - 1 : whole;
}

static int highest_bit(int64_t value)
{
    int bit = 0;

    while (value >> bit > 1) bit++;
    return bit;
}

static int64_t divided(int64_t value, int64_t step)
{
    return value * ((INT64_C(1) << 31) / step + 1) / (INT64_C(1) << 31);
}

static int64_t bend(int64_t x, int64_t y, int64_t z) { return llabs(x - 2 * y + z); }

/* ---- surroundings ---------------------------------------------------------------------------- */

static int x_of(const doubling *d, const place *at, int a, int b)
{
    return (int)within(0, at->x + a * at->along_x + b * at->away_x, d->last_x);
}

static int y_of(const doubling *d, const place *at, int a, int b)
{
    return (int)within(0, at->y + a * at->along_y + b * at->away_y, d->last_y);
}

static int64_t height_of(const doubling *d, const place *at, int a, int b)
{
    return d->height[y_of(d, at, a, b)][x_of(d, at, a, b)];
}

static int64_t off_of(const doubling *d, const place *at, int a, int b)
{
    return d->off[y_of(d, at, a, b)][x_of(d, at, a, b)];
}

/* ---- what is expected ------------------------------------------------------------------------ */

/* Traits from number 2 on. Returns the roughness. */
static int64_t traits_of(const doubling *d, const place *at, int class, const int64_t *h,
                         int64_t *t)
{
    if (class == CLASS_R) {
        t[2] = llabs(h[2] - h[0] - h[1] + h[3]);
        t[3] = llabs(h[4] + h[5] - h[6] - h[7]);
        t[4] = llabs(h[0] - h[1] - h[4] + h[5]);
        t[5] = bend(h[0], h[4], h[8]) + bend(h[1], h[5], h[9]);
        t[6] = llabs(h[0] - h[1]);
        t[7] = off_of(d, at, -2, 0);
        return t[2] + (t[3] + t[4]) / 2 + t[5] / 4;
    }
    if (class == CLASS_N || class == CLASS_C) {
        t[2] = llabs(h[0] + h[3] - h[1] - h[2]);
        t[3] = bend(h[4], h[0], h[1]) + bend(h[2], h[3], h[7]) + bend(h[8], h[2], h[0]) +
               bend(h[9], h[3], h[1]);
        if (class == CLASS_N) {
            t[4] = llabs(2 * h[12] - h[0] - h[1]);
            t[5] = off_of(d, at, 0, -1);
            t[6] = off_of(d, at, -2, -1) + off_of(d, at, 2, -1);
        } else {
            t[4] = off_of(d, at, -2, 0) + off_of(d, at, 0, -2);
            t[5] = off_of(d, at, -2, -2) + off_of(d, at, 2, -2);
        }
        return t[2] + t[3] / 2;
    }
    t[2] = llabs(h[0] + h[1] - h[2] - h[3]);
    t[3] = llabs(h[0] - h[1]) + llabs(h[2] - h[3]);
    t[4] = off_of(d, at, 0, -1) + off_of(d, at, 0, 1);
    t[5] = off_of(d, at, -1, -1) + (class == CLASS_H ? off_of(d, at, 1, -1) : off_of(d, at, -1, 1));
    t[6] = off_of(d, at, -2, 0) + off_of(d, at, 0, -2);
    return t[2];
}

static int64_t mean_of(int set, int class, int bucket, const int64_t *h)
{
    int64_t base = 0;
    int64_t sum = 0;

    for (int i = 0; i < classes[class].base; i++) base += h[i];
    if (class == CLASS_R) base *= 2;
    for (int i = 0; i < classes[class].taps; i++)
        sum += (int64_t)ff_trained_tables.weights[set].taps[class][bucket].tap[i] *
               (4 * h[i] - base);
    return within(0, 4 * base + floored((1 << 11) + sum, 1 << 12), 16 * 65535);
}

static int scale_of(int set, int class, const int64_t *t, int64_t step)
{
    int64_t sum = 0;
    int64_t distance, y;
    uint64_t first;
    int n;

    for (int i = 0; i < classes[class].traits; i++)
        sum += (int64_t)ff_trained_tables.weights[set].trait[class][i] * t[i];
    distance = within(1, floored(sum, 1 << 8), 1 << 22);
    y = divided(256 * distance, step) + 90;
    n = highest_bit(y);
    first = (uint64_t)y << (31 - n);
    return (int)within(0, 3 * (n - 8) + 5 + (first >= 0xA1450000) + (first >= 0xCB300000), 47);
}

static int64_t rounded_q4(int64_t sum) { return within(0, floored(sum + 8, 16), 65535); }

/* What SPEC.md, "Order and prediction", says of a new point of a row or column. */
static int64_t line_prediction(const doubling *d, const place *at)
{
    int64_t v[SIDE_MAX];
    int c = d->cells / 2, i = (at->along_x ? at->x : at->y) / 2;

    for (int j = 0; j <= c; j++)
        v[j] = at->along_x ? d->height[at->y][2 * j] : d->height[2 * j][at->x];
    if (c == 1) return (v[0] + v[1] + 1) / 2;
    if (i == 0) return rounded_q4(7 * v[0] + 10 * v[1] - v[2]);
    if (i == c - 1) return rounded_q4(7 * v[c] + 10 * v[c - 1] - v[c - 2]);
    return rounded_q4(9 * (v[i] + v[i + 1]) - v[i - 1] - v[i + 2]);
}

static expected expect(const doubling *d, const place *at, int class, int64_t step)
{
    int64_t h[20], t[8] = { 4, step }, o, v;
    expected is;

    for (int i = 0; i < classes[class].taps; i++)
        h[i] = height_of(d, at, classes[class].tap[i].a, classes[class].tap[i].b);
    v = divided(4 * traits_of(d, at, class, h, t) + step, step);
    is.mean_q4 = mean_of(d->set, class, (int)within(0, highest_bit(within(1, v, v)), 6), h);
    is.predicted = class == CLASS_R ? line_prediction(d, at)
                                    : within(0, floored(is.mean_q4 + 8, 16), 65535);
    is.scale = scale_of(d->set, class, t, step);
    o = is.mean_q4 - 16 * is.predicted + 8 * step;
    v = floored(o, 16);
    is.likeliest = class != CLASS_R ? 0 : v < 0 ? -1 - divided(-1 - v, step) : divided(v, step);
    is.likeliest = within(-32767, is.likeliest, 32767);
    v = within(0, floored(o - 16 * step * is.likeliest, 4), 1 << 24);
    is.phase = (int)within(0, divided(v, step), 3);
    return is;
}

/* ---- the stream ------------------------------------------------------------------------------ */

static unsigned next_byte(stream *s)
{
    unsigned byte = s->taken < s->count ? s->bytes[s->taken] : 0;

    s->taken++;
    return byte;
}

static void open_stream(stream *s, const uint8_t *bytes, int64_t count)
{
    s->bytes = bytes;
    s->count = count;
    s->taken = 0;
    s->width = 0xFFFFFFFF;
    s->code = 0;
    for (int i = 0; i < 4 && !s->words; i++) s->code = s->code * 256 + next_byte(s);
}

static int decision(stream *s, unsigned probability)
{
    uint64_t part = s->width / 65536 * probability;
    int one = s->code < part;

    s->width = one ? part : s->width - part;
    if (!one) s->code -= part;
    while (s->width < 1 << 24) {
        s->width *= 256;
        s->code = (s->code * 256 + next_byte(s)) % (UINT64_C(1) << 32);
    }
    return one;
}

static int64_t streamed(stream *s, const expected *is)
{
    const ff_odds *odds = &ff_trained_tables.odds[is->scale];
    int negative, bits = 0, second = 0;
    int64_t value = 1;

    if (decision(s, odds->zero)) return is->likeliest;
    negative = decision(s, odds->below[is->phase]);
    while (bits < 15 && decision(s, odds->beyond[bits])) bits++;
    for (int i = 0; i < bits; i++) {
        int bit = decision(s, i == 0   ? odds->second[bits]
                              : i == 1 ? odds->third[2 * bits + second]
                                       : 32768);
        if (i == 0) second = bit;
        value = 2 * value + bit;
    }
    return negative ? is->likeliest - value : is->likeliest + value;
}

static int64_t residual(stream *s, const expected *is)
{
    int64_t value;

    if (s->words) {
        value = next_byte(s);
        value += 256 * next_byte(s);
        return value >= 32768 ? value - 65536 : value;
    }
    value = streamed(s, is);
    if (value < -32768 || value > 32767) s->wrong = 1;
    return within(-32768, value, 32767);
}

/* Whether it has been read to its last 1, and no byte could be left out. */
static int is_whole(const stream *s, const slow_payload *p)
{
    int64_t zeros = 0, bits = 8 * p->count - p->tail;

    if (s->wrong) return 0;
    if (s->words) return s->taken == s->count;
    while (zeros < bits && !(s->bytes[(bits - 1 - zeros) / 8] >> (7 - (bits - 1 - zeros) % 8) & 1))
        zeros++;
    return zeros < 8 && bits - zeros <= 8 * s->taken;
}

/* ---- points in their order ------------------------------------------------------------------- */

static int64_t moved(int64_t predicted, int64_t residual_value, int64_t step)
{
    int64_t height = predicted + residual_value * step;

    if (step == 1) return ((height % 65536) + 65536) % 65536;
    return within(0, height, 65535);
}

static void make(doubling *d, stream *s, int64_t step, int class, place at)
{
    expected is;
    int64_t value, off, coarse = INT64_C(1) << within(0, highest_bit(step) - 4, 16);

    if (at.x == d->repeated_x || at.y == d->repeated_y) return;
    is = expect(d, &at, class, step);
    value = moved(is.predicted, residual(s, &is), step);
    off = (llabs(16 * value - is.mean_q4) + 8) / 16 / coarse;
    d->height[at.y][at.x] = value;
    d->off[at.y][at.x] = within(0, off, 255) * coarse;
}

/* The same of a point whose height is known. */
static void meet(doubling *d, int64_t step, place at)
{
    expected is;
    int64_t off, coarse = INT64_C(1) << within(0, highest_bit(step) - 4, 16);

    if (at.x == d->repeated_x || at.y == d->repeated_y) return;
    d->height[at.y][at.x] = d->known[at.y * (d->cells + 1) + at.x];
    is = expect(d, &at, CLASS_R, step);
    off = (llabs(16 * d->height[at.y][at.x] - is.mean_q4) + 8) / 16 / coarse;
    d->off[at.y][at.x] = within(0, off, 255) * coarse;
}

static void begin_side(stream *s)
{
    static uint8_t bytes[4096];
    int64_t count = (8 * s->of->count - s->of->tail + 7) / 8;

    memset(bytes, 0, sizeof(bytes));
    if (count < 0) count = 0;
    if (count > 1000) count = 1000;
    for (int64_t i = 0; i < 8 * count; i++)
        bytes[i / 8] |= (uint8_t)(slow_tail_bit(s->of, s->of->tail + i) << (7 - i % 8));
    open_stream(s, bytes, count);
}

/* Bits that are not the stream's own, of those that have been read: they could be all 0 or all 1.
 */
static int is_decided(const stream *s, int own)
{
    uint64_t others = 0, most = (UINT64_C(1) << (32 - own)) - 1;

    for (int i = 0; i < 32 - own; i++) {
        int64_t bit = 8 * s->taken - (32 - own) + i;
        int is = bit < 8 * s->count ? s->bytes[bit / 8] >> (7 - bit % 8) & 1 : 0;
        others = 2 * others + (unsigned)is;
    }
    return s->code >= others && s->code - others + most < s->width;
}

/* `points`: 0, and it has no bits. */
static void end_side(stream *s, int side, int points, int most)
{
    int own = 33 - highest_bit((int64_t)s->width);
    int64_t bits = points ? 8 * (s->taken - 4) + own : 0;

    if (points && !is_decided(s, own)) s->wrong = 1;
    if ((s->length && s->length[side] != bits) || bits > most) s->wrong = 1;
    s->of->tail += bits;
    if (s->of->tail > 8 * s->of->count) s->wrong = 1;
}

/* South, east, north, west; a refinement has a stream for each. */
static void make_sides(doubling *d, stream *s, int64_t step, int most)
{
    const int e = d->last_x, f = d->last_y;
    const place first[4] = {
        { 1, 0, 1, 0, 0, 1 }, { e, 1, 0, 1, -1, 0 }, { 1, f, 1, 0, 0, -1 }, { 0, 1, 0, 1, 1, 0 }
    };

    for (int side = 0; side < 4; side++) {
        int points = 0, apart = s->of && !(d->left_out >> side & 1);
        if (apart) begin_side(s);
        for (place at = first[side]; at.x <= e && at.y <= f;
             at.x += 2 * at.along_x, at.y += 2 * at.along_y) {
            if (d->left_out >> side & 1) {
                meet(d, step, at);
                continue;
            }
            points += at.x != d->repeated_x && at.y != d->repeated_y;
            make(d, s, step, CLASS_R, at);
        }
        if (apart) end_side(s, side, points, most);
    }
}

static void make_beside_sides(doubling *d, stream *s, int64_t step)
{
    int e = d->last_x, f = d->last_y;

    for (int x = 1; x < e; x += 2) make(d, s, step, CLASS_N, (place){ x, 1, 1, 0, 0, 1 });
    for (int x = 1; x < e && f > 2; x += 2)
        make(d, s, step, CLASS_N, (place){ x, f - 1, 1, 0, 0, -1 });
    for (int y = 3; y <= f - 3; y += 2) make(d, s, step, CLASS_N, (place){ 1, y, 0, 1, 1, 0 });
    for (int y = 3; y <= f - 3 && e > 2; y += 2)
        make(d, s, step, CLASS_N, (place){ e - 1, y, 0, 1, -1, 0 });
}

static void make_centres(doubling *d, stream *s, int64_t step)
{
    for (int y = 3; y <= d->last_y - 3; y += 2)
        for (int x = 3; x <= d->last_x - 3; x += 2)
            make(d, s, step, CLASS_C, (place){ x, y, 1, 0, 0, 1 });
}

static void make_between(doubling *d, stream *s, int64_t step)
{
    for (int y = 1; y < d->last_y; y++)
        for (int x = 1; x < d->last_x; x++) {
            if (x % 2 == 1 && y % 2 == 0) make(d, s, step, CLASS_H, (place){ x, y, 1, 0, 0, 1 });
            if (x % 2 == 0 && y % 2 == 1) make(d, s, step, CLASS_V, (place){ x, y, 0, 1, 1, 0 });
        }
}

/* ---- padding --------------------------------------------------------------------------------- */

static int64_t mean_of_corners(const doubling *d, int x, int y)
{
    return (d->height[y - 1][x - 1] + d->height[y - 1][x + 1] + d->height[y + 1][x - 1] +
            d->height[y + 1][x + 1] + 2) /
           4;
}

static void make_provisional(doubling *d)
{
    for (int y = 0; y <= d->last_y && d->repeated_x > 0; y++)
        d->height[y][d->repeated_x] = y % 2 == 0 ? d->height[y][d->last_x]
                                                 : mean_of_corners(d, d->repeated_x, y);
    for (int x = 0; x <= d->last_x && d->repeated_y > 0; x++)
        d->height[d->repeated_y][x] = x % 2 == 0 ? d->height[d->last_y][x]
                                                 : mean_of_corners(d, x, d->repeated_y);
}

static void repeat(doubling *d)
{
    for (int y = 0; y <= d->cells; y++)
        for (int x = 0; x <= d->cells; x++) {
            int from_x = x == d->repeated_x || x > d->last_x ? d->last_x : x;
            int from_y = y == d->repeated_y || y > d->last_y ? d->last_y : y;
            if (x % 2 == 1 || y % 2 == 1) d->height[y][x] = d->height[from_y][from_x];
        }
}

/* ---- grids ----------------------------------------------------------------------------------- */

/* Where the ground ends, of points `apart` cells of the whole grid. */
static void set_ground(doubling *d, int columns, int rows, int apart)
{
    d->last_x = 0;
    d->last_y = 0;
    while (d->last_x * apart < columns) d->last_x += 2;
    while (d->last_y * apart < rows) d->last_y += 2;
    d->repeated_x = (d->last_x - 1) * apart >= columns ? d->last_x - 1 : -1;
    d->repeated_y = (d->last_y - 1) * apart >= rows ? d->last_y - 1 : -1;
}

static void spread(doubling *d)
{
    static int64_t known[SIDE_MAX][SIDE_MAX];

    memcpy(known, d->height, sizeof(known));
    memset(d->off, 0, sizeof(d->off));
    for (int y = 0; y <= d->cells; y++)
        for (int x = 0; x <= d->cells; x++) d->height[2 * y][2 * x] = known[y][x];
    d->cells *= 2;
}

/* ---- payloads -------------------------------------------------------------------------------- */

static int grid(const ff_terrain_info *info, int columns, int rows, const uint16_t *parent,
                slow_payload *p, const slow_head *is, uint16_t *heights)
{
    static doubling d;
    static uint8_t bytes[65536];
    int64_t step = 2 * (int64_t)info->max_error + 1, length[4], corner[4];
    int node = 1 << info->node_log2, cells = parent ? 2 * node : node, most = 16 << info->node_log2;
    stream s = { .words = is->form == 2 };

    for (int i = 0; i < 4 && !parent; i++) corner[i] = slow_tail_bits(p, 16);
    d.set = is->set;
    d.left_out = 0;
    d.known = heights;
    if (parent && is->form == 0) {
        int told = (int)slow_tail_bits(p, 4), measured = told == 15 && !slow_tail_bits(p, 1);
        for (int i = 0; i < 4 && measured; i++)
            length[i] = slow_tail_number(p, info->node_log2 + 1);
        s.of = p;
        s.length = measured ? length : NULL;
        d.left_out = measured ? 0 : told;
    }
    if (p->tail > 8 * p->count) return -1;
    if (s.words) open_stream(&s, p->bytes, p->count - (p->tail + 7) / 8);
    if (!s.words && !s.of) open_stream(&s, bytes, slow_stream_of(p, bytes));
    d.cells = parent ? node : 1;
    for (int y = 0; y <= d.cells; y++)
        for (int x = 0; x <= d.cells; x++)
            d.height[y][x] = parent ? parent[y * (node + 1) + x]
                                    : moved(0, corner[2 * y + x], step);
    while (d.cells < cells) {
        spread(&d);
        set_ground(&d, columns, rows, cells / d.cells);
        make_provisional(&d);
        if ((d.left_out & 2 && d.last_x < cells) || (d.left_out & 4 && d.last_y < cells)) return -1;
        make_sides(&d, &s, step, most);
        if (s.wrong) return -1;
        if (s.of) open_stream(&s, bytes, slow_stream_of(p, bytes));
        make_beside_sides(&d, &s, step);
        make_centres(&d, &s, step);
        make_between(&d, &s, step);
        repeat(&d);
    }
    for (int y = 0; y <= cells; y++)
        for (int x = 0; x <= cells; x++) heights[y * (cells + 1) + x] = (uint16_t)d.height[y][x];
    return is_whole(&s, p) ? 0 : -1;
}

int slow_trained(const ff_terrain_info *info, int columns, int rows, const uint16_t *parent,
                 const uint8_t *bytes, long count, uint16_t *heights)
{
    slow_payload p = { bytes, count, 0 };
    slow_head is;

    if (slow_head_of(&p, !parent, info->max_error, &is) || p.tail > 8 * p.count) return -1;
    if (grid(info, columns, rows, parent, &p, &is, heights)) return -1;
    return 256 * is.stub + 16 * is.leaf + is.filled;
}
