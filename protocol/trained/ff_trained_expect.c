/* What is expected of new heights, from known ones around them: integers only, the same on every
 * machine (SPEC.md, "Expectation").
 *
 * A doubling is made in a copy of its points with a margin round it. Where a place lies beyond a
 * side, the nearest one on that side stands for it: sides are made first. */
#include "ff_trained.h"

#include <string.h>

#define MARGIN          FF_TRAINED_MARGIN
#define PITCH           FF_TRAINED_PITCH
#define HEIGHT_MAX_Q4   (UINT16_MAX * 16)
#define DISTANCE_MAX_Q4 (1 << 22)
#define SCALE_BIAS      90 /* of 256, of 1/16 step: the first scale's distances begin there */
#define SCALE_LAST      (3 * 24 + 2)
#define HALF_TAP        (1 << (FF_TRAINED_TAPS_LOG2 - 3))

#ifdef __GNUC__
#define FF_ALWAYS_INLINE inline __attribute__((always_inline))
/* No instruction: a long sum is made term by term, not of terms that all are fetched first. */
#define IN_ORDER(sum) __asm__("" : "+r"(sum))
#else
#define FF_ALWAYS_INLINE inline
#define IN_ORDER(sum)    (void)(sum)
#endif

typedef struct walk {
    const ff_weights *by;
    ff_points points;
    const ff_taps *taps;  /* of the class that is made, by bucket */
    const int16_t *trait; /* its weights */
    int is_known;         /* the points that come next are in the grid */
    uint16_t *grid;       /* as the caller has it: `side` points, of which every `step` are made */
    uint16_t *height;     /* the copy's first point */
    uint8_t *error;       /* the same of how far points were from what was expected */
    int32_t last[2];      /* the last column and row, in steps: the sides */
    int32_t coded[2];     /* before these, odd ones are coded */
    uint32_t reciprocal;  /* of the quantum, Q31 */
    uint32_t off_shift;   /* of a distance, Q4 */
    uint32_t always;      /* of a distance: what is the same for all points of a line */
    ff_expected point;    /* the one that is made */
} walk;

static inline int32_t clamped(int32_t value, int32_t low, int32_t high)
{
    return value < low ? low : value > high ? high : value;
}

static inline int32_t size(int32_t value) { return value < 0 ? -value : value; }

static inline int32_t bend(int32_t a, int32_t b, int32_t c) { return size(a - 2 * b + c); }

/* Bits above the highest one that is 1. */
static inline unsigned zeros_of(uint32_t value)
{
    FF_ASSERT(value > 0);
#ifdef __GNUC__
    return (unsigned)__builtin_clz(value);
#else
    unsigned zeros = 0;
    while (!(value << zeros >> 31)) zeros++;
    return zeros;
#endif
}

static inline unsigned log2_of(uint32_t value) { return 31 - zeros_of(value); }

/* By the quantum. */
static inline uint32_t divided(const walk *w, uint32_t value)
{
    FF_ASSERT(value <= UINT32_MAX / 2);
    return (uint32_t)((uint64_t)(2 * value) * w->reciprocal >> 32);
}

/* ---- what is around a point ----
 *
 * Places are told along a side and away from it: `along` and `away` are the steps to the next ones.
 * X(i, a, b): tap i is the height there. The base is the mean of the first ones: two of R, four. */

/* clang-format off */
#define TAPS_R(X) \
    X(0, -1, 0) X(1, 1, 0) X(2, -3, 0) X(3, 3, 0) X(4, -1, 2) X(5, 1, 2) X(6, -3, 2) X(7, 3, 2) \
    X(8, -1, 4) X(9, 1, 4) X(10, -2, 0)
#define TAPS_OF_CENTRE(X) \
    X(0, -1, -1) X(1, 1, -1) X(2, -1, 1) X(3, 1, 1) X(4, -3, -1) X(5, -3, 1) X(6, 3, -1) X(7, 3, 1) \
    X(8, -1, 3) X(9, 1, 3) X(10, -3, 3) X(11, 3, 3)
#define TAPS_N(X) TAPS_OF_CENTRE(X) X(12, 0, -1) X(13, -2, -1) X(14, 2, -1)
#define TAPS_C(X) TAPS_OF_CENTRE(X) \
    X(12, -1, -3) X(13, 1, -3) X(14, -3, -3) X(15, 3, -3) X(16, -2, 0) X(17, 0, -2) X(18, -2, -2) X(19, 2, -2)
#define TAPS_OF_MIDDLE(X) \
    X(0, -1, 0) X(1, 1, 0) X(2, 0, -1) X(3, 0, 1) X(4, -3, 0) X(5, 3, 0) X(6, 0, -3) X(7, 0, 3) \
    X(8, -2, -1) X(9, 2, -1) X(10, -2, 1) X(11, 2, 1) X(12, -1, -2) X(13, 1, -2) X(14, -1, 2) X(15, 1, 2) \
    X(16, -1, -1)
#define TAPS_H(X) TAPS_OF_MIDDLE(X) X(17, 1, -1) X(18, -2, 0) X(19, 0, -2)
#define TAPS_V(X) TAPS_OF_MIDDLE(X) X(17, -1, 1) X(18, 0, -2) X(19, -2, 0)
/* clang-format on */

#define AT(a, b)       (int32_t) at[(a)*along + (b)*away]
#define ERROR(a, b)    (int32_t) error[(a)*along + (b)*away]
#define KEEP(i, a, b)  known[i] = AT(a, b);
#define COUNT(i, a, b) +1
#define WEIGHED(i, a, b)                          \
    sum += (uint32_t)tap[i] * (uint32_t)AT(a, b); \
    IN_ORDER(sum);

/* Measures of roughness, from the third on. They return that by which taps are chosen. */

static FF_ALWAYS_INLINE int32_t traits_of_side(const uint16_t *at, int32_t along, int32_t away,
                                               int32_t trait[FF_TRAINED_TRAITS])
{
    int32_t a = AT(-1, 0), b = AT(1, 0), c = AT(-1, 2), d = AT(1, 2);
    trait[2] = size(AT(-3, 0) - a - b + AT(3, 0));
    trait[3] = size(c + d - AT(-3, 2) - AT(3, 2));
    trait[4] = size(a - b - c + d);
    trait[5] = bend(a, c, AT(-1, 4)) + bend(b, d, AT(1, 4));
    trait[6] = size(a - b);
    return trait[2] + ((trait[3] + trait[4]) >> 1) + (trait[5] >> 2);
}

static FF_ALWAYS_INLINE int32_t traits_of_centre(const uint16_t *at, int32_t along, int32_t away,
                                                 int32_t trait[FF_TRAINED_TRAITS])
{
    int32_t a = AT(-1, -1), b = AT(1, -1), c = AT(-1, 1), d = AT(1, 1);
    trait[2] = size(a + d - b - c);
    trait[3] = bend(AT(-3, -1), a, b) + bend(c, d, AT(3, 1)) + bend(AT(-1, 3), c, a) +
               bend(AT(1, 3), d, b);
    return trait[2] + (trait[3] >> 1);
}

static FF_ALWAYS_INLINE int32_t traits_of_middle(const uint16_t *at, int32_t along, int32_t away,
                                                 int32_t trait[FF_TRAINED_TRAITS])
{
    int32_t a = AT(-1, 0), b = AT(1, 0), c = AT(0, -1), d = AT(0, 1);
    trait[2] = size(a + b - c - d);
    trait[3] = size(a - b) + size(c - d);
    return trait[2];
}

static FF_ALWAYS_INLINE int32_t look(enum ff_trained_class kind, const uint16_t *at, int32_t along,
                                     int32_t away, int32_t trait[FF_TRAINED_TRAITS])
{
    if (kind == FF_POINT_R) return traits_of_side(at, along, away, trait);
    if (kind == FF_POINT_H || kind == FF_POINT_V) return traits_of_middle(at, along, away, trait);
    if (kind == FF_POINT_N) trait[4] = size(2 * AT(0, -1) - AT(-1, -1) - AT(1, -1));
    return traits_of_centre(at, along, away, trait);
}

/* Those that tell how far points beside were off, in units of 2^error_shift. How many traits there
 * are in all. */
static FF_ALWAYS_INLINE unsigned look_at_errors(enum ff_trained_class kind, const uint8_t *error,
                                                int32_t along, int32_t away,
                                                int32_t trait[FF_TRAINED_TRAITS])
{
    switch (kind) {
        case FF_POINT_R: trait[7] = ERROR(-2, 0); return 8;
        case FF_POINT_N:
            trait[5] = ERROR(0, -1);
            trait[6] = ERROR(-2, -1) + ERROR(2, -1);
            return 7;
        case FF_POINT_C:
            trait[4] = ERROR(-2, 0) + ERROR(0, -2);
            trait[5] = ERROR(-2, -2) + ERROR(2, -2);
            return 6;
        default:
            trait[4] = ERROR(0, -1) + ERROR(0, 1);
            trait[5] = ERROR(-1, -1) + (kind == FF_POINT_V ? ERROR(-1, 1) : ERROR(1, -1));
            trait[6] = ERROR(-2, 0) + ERROR(0, -2);
            return 7;
    }
}

/* The first one of those. */
static FF_ALWAYS_INLINE unsigned errors_from(enum ff_trained_class kind)
{
    return kind == FF_POINT_R ? 7 : kind == FF_POINT_N ? 5 : 4;
}

/* Known heights by their weights, added to `sum`: modulo 2^32, see ff_taps. */
static FF_ALWAYS_INLINE uint32_t weighed(enum ff_trained_class kind, const int16_t *tap,
                                         const uint16_t *at, int32_t along, int32_t away,
                                         uint32_t sum)
{
    switch (kind) {
        case FF_POINT_R: TAPS_R(WEIGHED) break;
        case FF_POINT_N: TAPS_N(WEIGHED) break;
        case FF_POINT_C: TAPS_C(WEIGHED) break;
        case FF_POINT_H: TAPS_H(WEIGHED) break;
        default: TAPS_V(WEIGHED)
    }
    return sum;
}

static FF_ALWAYS_INLINE int32_t base_q2(enum ff_trained_class kind, const uint16_t *at,
                                        int32_t along, int32_t away)
{
    if (kind == FF_POINT_R) return 2 * (AT(-1, 0) + AT(1, 0));
    if (kind == FF_POINT_N || kind == FF_POINT_C)
        return AT(-1, -1) + AT(1, -1) + AT(-1, 1) + AT(1, 1);
    return AT(-1, 0) + AT(1, 0) + AT(0, -1) + AT(0, 1);
}

uint32_t ff_trained_known(const ff_expected *p, int32_t known[FF_TRAINED_TAPS], int32_t *base)
{
    const uint16_t *at = p->height;
    int32_t along = p->along, away = p->away;
    *base = base_q2(p->kind, at, along, away);
    switch (p->kind) {
        case FF_POINT_R: TAPS_R(KEEP) return TAPS_R(COUNT);
        case FF_POINT_N: TAPS_N(KEEP) return TAPS_N(COUNT);
        case FF_POINT_C: TAPS_C(KEEP) return TAPS_C(COUNT);
        case FF_POINT_H: TAPS_H(KEEP) return TAPS_H(COUNT);
        default: TAPS_V(KEEP) return TAPS_V(COUNT);
    }
}

uint32_t ff_trained_traits(const ff_expected *p, int32_t trait[FF_TRAINED_TRAITS])
{
    enum ff_trained_class kind = p->kind;
    trait[0] = 4;
    trait[1] = p->quantum;
    look(kind, p->height, p->along, p->away, trait);
    unsigned traits = look_at_errors(kind, p->error + (p->height - p->first), p->along, p->away,
                                     trait);
    for (unsigned i = errors_from(kind); i < traits; i++) trait[i] <<= p->error_shift;
    return traits;
}

/* ---- a point ---- */

/* What taps add to the base: sum of tap * (height - base), of which the base's quarters come in at
 * the end. */
static FF_ALWAYS_INLINE void weigh(const walk *w, enum ff_trained_class kind, const uint16_t *at,
                                   int32_t along, int32_t away, int32_t rough, ff_expected *p)
{
    unsigned bucket = log2_of(divided(w, (uint32_t)(4 * rough + p->quantum)));
    if (bucket >= FF_TRAINED_BUCKETS) bucket = FF_TRAINED_BUCKETS - 1;
    const ff_taps *taps = w->taps + bucket;
    int32_t base = base_q2(kind, at, along, away), quarters = base & 3;
    uint32_t sum = weighed(kind, taps->tap, at, along, away,
                           0 - (uint32_t)(base >> 2) * (uint32_t)taps->sum);
    int32_t more = (int32_t)sum + ((HALF_TAP - quarters * taps->sum) >> 2);
    p->bucket = (uint8_t)bucket;
    p->mean_q4 = clamped(4 * base + (more >> (FF_TRAINED_TAPS_LOG2 - 4)), 0, HEIGHT_MAX_Q4);
}

/* The row of FF_TRAINED_SCALES, three to a doubling, for a distance. */
static inline uint8_t scale_of(const walk *w, int32_t distance_q4)
{
    uint32_t steps_q8 = divided(w, (uint32_t)distance_q4 << 8) + SCALE_BIAS;
    unsigned zeros = zeros_of(steps_q8);
    uint32_t mantissa = steps_q8 << zeros;
    uint32_t row = SCALE_LAST - 3 * zeros + (mantissa >= 0xA1450000u) + (mantissa >= 0xCB300000u);
    return (uint8_t)(row < FF_TRAINED_SCALES ? row : FF_TRAINED_SCALES - 1);
}

#define TERM(i) (uint32_t) weight[i] * (uint32_t)trait[i]

static FF_ALWAYS_INLINE void measure(const walk *w, enum ff_trained_class kind,
                                     const int32_t *trait, ff_expected *p)
{
    const int16_t *weight = w->trait;
    uint32_t sum = w->always + TERM(2) + TERM(3), off;
    if (kind == FF_POINT_R) {
        sum += TERM(4) + TERM(5) + TERM(6);
        off = TERM(7);
    } else if (kind == FF_POINT_N) {
        sum += TERM(4);
        off = TERM(5) + TERM(6);
    } else {
        off = TERM(4) + TERM(5);
        if (kind != FF_POINT_C) off += TERM(6);
    }
    sum += off << p->error_shift;
    p->distance_q4 = clamped((int32_t)sum >> (FF_TRAINED_TRAITS_LOG2 - 4), 1, DISTANCE_MAX_Q4);
    p->scale = scale_of(w, p->distance_q4);
}

/* Where what is expected lies among the heights that residuals lead to: the likeliest one, and in
 * which quarter around it. What a point that is on no side predicts is the likeliest. */
static FF_ALWAYS_INLINE void place_mean(const walk *w, enum ff_trained_class kind, ff_expected *p)
{
    int32_t off_q4 = p->mean_q4 - 16 * p->predicted + 8 * p->quantum, steps = off_q4 >> 4;
    if (kind == FF_POINT_R) {
        p->residual = steps >= 0 ? (int32_t)divided(w, (uint32_t)steps)
                                 : -1 - (int32_t)divided(w, (uint32_t)(-1 - steps));
        p->residual = clamped(p->residual, -INT16_MAX, INT16_MAX);
        off_q4 = clamped(off_q4 - 16 * p->quantum * p->residual, 0, 1 << 26);
    }
    uint32_t phase = divided(w, (uint32_t)off_q4 >> 2);
    p->phase = (uint8_t)(kind == FF_POINT_R && phase > 3 ? 3 : phase);
    FF_ASSERT(p->phase < 4);
}

/* `middle`: of a side, what it predicts itself. */
static FF_ALWAYS_INLINE void make_point(walk *w, enum ff_trained_class kind, uint16_t *height,
                                        uint8_t *error, int32_t along, int32_t away, int32_t middle)
{
    int32_t trait[FF_TRAINED_TRAITS];
    ff_expected *p = &w->point;
    p->height = height;
    weigh(w, kind, height, along, away, look(kind, height, along, away, trait), p);
    p->predicted = kind == FF_POINT_R ? middle : (p->mean_q4 + 8) >> 4;
    look_at_errors(kind, error, along, away, trait);
    measure(w, kind, trait, p);
    place_mean(w, kind, p);
    *height = kind == FF_POINT_R && w->is_known ? w->grid[ff_expected_at(p)]
                                                : w->points.height(w->points.context, p);
    uint32_t off = (uint32_t)(size(16 * *height - p->mean_q4) + 8) >> w->off_shift;
    *error = (uint8_t)(off < 255 ? off : 255);
}

/* ---- a doubling ---- */

static int begin(const walk *w, unsigned side, uint32_t points)
{
    FF_ASSERT(side <= FF_SIDE_COUNT);
    return w->points.side ? w->points.side(w->points.context, side, points) : 0;
}

/* Before lines of a class. */
static void begin_class(walk *w, enum ff_trained_class kind, int32_t along, int32_t away)
{
    w->taps = w->by->taps[kind];
    w->trait = w->by->trait[kind];
    w->point.residual = 0;
    w->point.kind = (uint8_t)kind;
    w->point.along = along;
    w->point.away = away;
    w->always = 4 * (uint32_t)w->trait[0] + (uint32_t)w->trait[1] * (uint32_t)w->point.quantum;
}

/* Every second point from `column` and `row` on, before `end`, along an axis. A side's are
 * predicted along it. */
static FF_ALWAYS_INLINE void make_line(walk *w, enum ff_trained_class kind, int32_t column,
                                       int32_t row, unsigned axis, int32_t end, int32_t along,
                                       int32_t away)
{
    int32_t index = row * PITCH + column, next = axis ? 2 * PITCH : 2, i = axis ? row : column;
    uint16_t *height = w->height + index;
    uint8_t *error = w->error + index;
    uint32_t apart = 2 * w->point.step * (axis ? w->point.side : 1),
             cells = (w->point.side - 1) / (2 * w->point.step);
    uint32_t first = ((uint32_t)row * w->point.side + (uint32_t)column) * w->point.step - apart / 2;

    for (; i < end; i += 2, height += next, error += next)
        make_point(w, kind, height, error, along, away,
                   kind == FF_POINT_R
                       ? ff_predict_middle(w->grid + first, apart, (uint32_t)i / 2, cells)
                       : 0);
}

/* New points of a side, which lies `beside` the other axis's beginning. */
static void make_side(walk *w, enum ff_side side, unsigned axis, int32_t beside, int inward)
{
    int32_t along = axis ? PITCH : 1, away = axis ? inward : inward * PITCH;
    FF_ASSERT(beside == 0 || beside == w->last[!axis]);
    w->is_known = begin(w, side, (uint32_t)w->coded[axis] / 2);
    begin_class(w, FF_POINT_R, along, away);
    make_line(w, FF_POINT_R, axis ? beside : 1, axis ? 1 : beside, axis, w->coded[axis], along,
              away);
}

/* Centres beside a side. */
static void make_near(walk *w, unsigned axis, int32_t beside, int inward)
{
    int32_t along = axis ? PITCH : 1, away = axis ? inward : inward * PITCH;
    int32_t to = w->last[axis] - (axis ? 2 : 0);
    if (beside >= w->coded[!axis]) return;
    if (to > w->coded[axis]) to = w->coded[axis];
    begin_class(w, FF_POINT_N, along, away);
    make_line(w, FF_POINT_N, axis ? beside : 1, axis ? 3 : beside, axis, to, along, away);
}

static void make_centres(walk *w)
{
    int32_t end = w->coded[0] < w->last[0] - 2 ? w->coded[0] : w->last[0] - 2;
    make_near(w, 0, 1, 1);
    if (w->last[1] > 2) make_near(w, 0, w->last[1] - 1, -1);
    make_near(w, 1, 1, 1);
    if (w->last[0] > 2) make_near(w, 1, w->last[0] - 1, -1);
    begin_class(w, FF_POINT_C, 1, PITCH);
    for (int32_t row = 3; row < w->coded[1] && row < w->last[1] - 2; row += 2)
        make_line(w, FF_POINT_C, 3, row, 0, end, 1, PITCH);
}

static void make_middles(walk *w)
{
    for (int32_t row = 1; row < w->last[1]; row++) {
        if (row % 2 == 0) {
            begin_class(w, FF_POINT_H, 1, PITCH);
            make_line(w, FF_POINT_H, 1, row, 0, w->coded[0], 1, PITCH);
        } else if (row < w->coded[1]) {
            begin_class(w, FF_POINT_V, PITCH, 1);
            make_line(w, FF_POINT_V, 2, row, 0, w->last[0], PITCH, 1);
        }
    }
}

/* ---- the copy ---- */

/* Points of an odd line that is not coded, until the doubling ends: the height of the last line, or
 * between their four corners. */
static void fill_line(const walk *w, unsigned axis)
{
    int32_t line = w->last[axis] - 1, on = axis ? PITCH : 1, along = axis ? 1 : PITCH;
    uint16_t *at = w->height + line * on;
    if (line < w->coded[axis]) return;
    for (int32_t i = 0; i <= w->last[!axis]; i++, at += along)
        *at = i % 2 == 0 ? at[on]
                         : (uint16_t)((at[-on - along] + at[along - on] + at[on - along] +
                                       at[on + along] + 2) >>
                                      2);
}

/* Points of the margin are the nearest ones of the sides. */
static void fill_margin(const walk *w)
{
    size_t count = (size_t)w->last[0] + 1 + 2 * MARGIN;
    for (int32_t row = 0; row <= w->last[1]; row++) {
        uint16_t *first = w->height + row * PITCH, *last = first + w->last[0];
        first[-1] = first[-2] = *first;
        last[1] = last[2] = *last;
    }
    for (int32_t i = 1; i <= MARGIN; i++) {
        uint16_t *first = w->height - MARGIN, *last = first + w->last[1] * PITCH;
        memcpy(first - i * PITCH, first, count * sizeof *first);
        memcpy(last + i * PITCH, last, count * sizeof *last);
    }
}

/* Of how far points were off two columns beside the sides are looked at. */
static void fill_error_margin(const walk *w)
{
    for (int32_t row = 0; row <= w->last[1]; row++) {
        uint8_t *first = w->error + row * PITCH, *last = first + w->last[0];
        first[-1] = first[-2] = *first;
        last[1] = last[2] = *last;
    }
    for (int32_t column = 0; column <= w->last[0]; column++) {
        uint8_t *first = w->error + column, *last = first + w->last[1] * PITCH;
        *(first - PITCH) = *(first - 2 * PITCH) = *first;
        last[PITCH] = last[2 * PITCH] = *last;
    }
}

static void open_copy(const walk *w)
{
    FF_ASSERT(w->last[0] >= 2 && w->last[1] >= 2);
    memset(w->error - (PITCH + 1), 0, (size_t)(w->last[1] + 2) * PITCH); /* a margin of one */
    for (int32_t row = 0; row <= w->last[1]; row += 2)
        for (int32_t column = 0; column <= w->last[0]; column += 2)
            w->height[row * PITCH + column] =
                w->grid[((uint32_t)row * w->point.side + (uint32_t)column) * w->point.step];
}

static void close_copy(const walk *w)
{
    const uint16_t *from = w->height;
    uint32_t step = w->point.step, count = (uint32_t)w->last[0] + 1;
    for (int32_t row = 0; row <= w->last[1]; row++, from += PITCH) {
        uint16_t *to = w->grid + (uint32_t)row * w->point.side * step;
        if (step == 1)
            memcpy(to, from, count * sizeof *to);
        else
            for (uint32_t column = 0; column < count; column++) to[column * step] = from[column];
    }
}

static void make_doubling(walk *w, uint32_t step, ff_cells ground)
{
    const uint32_t end[2] = { ground.columns, ground.rows };
    unsigned log2 = log2_of(step);
    w->point.step = step;
    for (unsigned axis = 0; axis < 2; axis++) {
        w->last[axis] = (int32_t)(ff_last_point(step, end[axis]) >> log2);
        w->coded[axis] = 2 * (int32_t)ff_coded_points(step, end[axis]);
    }
    open_copy(w);
    for (unsigned axis = 0; axis < 2; axis++) fill_line(w, axis);
    fill_margin(w);
    make_side(w, FF_SIDE_SOUTH, 0, 0, 1);
    make_side(w, FF_SIDE_EAST, 1, w->last[0], -1);
    make_side(w, FF_SIDE_NORTH, 0, w->last[1], -1);
    make_side(w, FF_SIDE_WEST, 1, 0, 1);
    begin(w, FF_SIDE_COUNT, 0);
    fill_margin(w);
    fill_error_margin(w);
    make_centres(w);
    if (step == 1 && w->points.go_on && !w->points.go_on(w->points.context)) return;
    make_middles(w);
    close_copy(w);
    ff_repeat_last(w->grid, w->point.side, step, ground);
}

FF_STATIC_ASSERT(MARGIN == 2); /* fill_margin, fill_error_margin */
FF_STATIC_ASSERT(FF_CODEC_ROOM_MAX == 3 * PITCH * PITCH);

static size_t copied(uint32_t side) { return (side + 2 * MARGIN) * (size_t)PITCH; }

size_t ff_codec_room(const ff_terrain_info *info)
{
    return copied(ff_refined_side(info)) * (sizeof(uint16_t) + 1);
}

void ff_expect(const ff_trained *by, unsigned set, const ff_terrain_info *info, ff_cells cells,
               const uint16_t *parent, uint16_t *grid, void *room, const ff_points *points)
{
    walk w = { .by = &by->weights[set], .points = *points, .grid = grid };
    FF_ASSERT(parent || !points->side);
    int32_t quantum = ff_quantum(info, !parent);
    unsigned log2 = log2_of((uint32_t)quantum);
    w.point.quantum = quantum;
    w.point.error_shift = log2 > 4 ? log2 - 4 : 0;
    w.off_shift = w.point.error_shift + 4;
    w.reciprocal = (UINT32_C(1) << 31) / (uint32_t)quantum + 1;
    w.point.side = parent ? ff_refined_side(info) : ff_node_side(info);
    w.height = (uint16_t *)room + MARGIN * (PITCH + 1);
    w.point.first = w.height;
    w.error = (uint8_t *)room + copied(w.point.side) * sizeof(uint16_t) + MARGIN * (PITCH + 1);
    w.point.error = w.error;
    cells = ff_cells_of(cells, w.point.side);
    if (parent) ff_spread_parent(info, parent, grid);
    for (uint32_t step = parent ? 1 : (w.point.side - 1) / 2; step >= 1; step /= 2)
        make_doubling(&w, step, cells);
}
