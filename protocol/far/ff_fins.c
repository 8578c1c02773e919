/* Fins as decisions of a range coder (SPEC.md, "Fins"): ridges go on as they went, so steps are
 * small. One way and the other are the same walk. */
#include "ff_fins_local.h"

#include <string.h>

#define HALF 32768u
#define RATE 5

/* Sorts of numbers, and the first of the cells that each has. */
enum sort { FIRST_COLUMN, FIRST_UP, FIRST_DISTANCE, UP, DISTANCE, RUN };
#define CELL_FIRST    0u  /* 1 for each of a fin's first vertex */
#define CELL_RUN      3u  /* 4: by the run before */
#define CELL_UP       7u  /* 4 x 4: by the run, and the step before */
#define CELL_DISTANCE 23u /* 3 x 3: by the run, and the step before */

typedef struct fins {
    uint16_t one[FF_FINS_CONTEXTS];
    ff_range range;
    int error;
    /* the encoder's; NULL: this is the decoder */
    ff_range_writer *to;
    uint32_t (*seen)[2];
} fins;

/* ---- decisions ---- */

static unsigned coin(fins *f, uint32_t one, unsigned bit)
{
#ifdef FF_ENCODER
    if (f->to) {
        ff_range_put(f->to, one, bit);
        return bit;
    }
#endif
    (void)bit;
    return ff_range_take(&f->range, one);
}

static unsigned decide(fins *f, unsigned place, unsigned bit)
{
    uint16_t *one = &f->one[place];
    FF_ASSERT(place < FF_FINS_CONTEXTS);
    bit = coin(f, *one, bit);
    *one = (uint16_t)(bit ? *one + ((65536u - *one) >> RATE) : *one - ((unsigned)*one >> RATE));
#ifdef FF_ENCODER
    if (f->seen) f->seen[place][bit]++;
#endif
    return bit;
}

/* Bits of value + 1 below its highest. */
static unsigned length_of(uint32_t value)
{
    unsigned length = 0;
    while ((value + 1) >> length >> 1) length++;
    return length;
}

/* At most 65534. */
static uint32_t number(fins *f, enum sort sort, unsigned cell, uint32_t value)
{
    unsigned want = length_of(value), length = 0, place = FF_FINS_LENGTH + cell * FF_FINS_BITS;
    uint32_t made = 1;
    FF_ASSERT(sort <= RUN);
    while (length < FF_FINS_BITS - 1 && decide(f, place + length, want > length)) length++;
    for (unsigned i = length; i-- > 0;) {
        unsigned bit = (value + 1) >> i & 1u;
        if (i + 1 == length)
            bit = decide(f, FF_FINS_FIRST + (unsigned)sort * FF_FINS_BITS + length, bit);
        else
            bit = coin(f, HALF, bit);
        made = made << 1 | bit;
    }
    return made - 1;
}

/* `before`: the same of the vertex before. */
static int32_t signed_number(fins *f, enum sort sort, unsigned cell, int32_t before, int32_t value)
{
    int32_t size = (int32_t)number(f, sort, cell, (uint32_t)(value < 0 ? -value : value));
    unsigned by = before < 0 ? 1 : before > 0 ? 2 : 0;
    FF_ASSERT(size >= 0);
    if (size && decide(f, FF_FINS_SIGN + 3 * (unsigned)sort + by, value < 0)) return -size;
    return size;
}

/* ---- vertices ---- */

static uint32_t size_of(int32_t value) { return (uint32_t)(value < 0 ? -value : value); }

static unsigned least(unsigned a, unsigned b) { return a < b ? a : b; }

/* From one vertex to the next. */
typedef struct step {
    int32_t column, up, distance;
} step;

static void first_step(fins *f, step *s)
{
    s->column = signed_number(f, FIRST_COLUMN, CELL_FIRST, 0, s->column);
    s->up = signed_number(f, FIRST_UP, CELL_FIRST + 1, 0, s->up);
    s->distance = signed_number(f, FIRST_DISTANCE, CELL_FIRST + 2, 0, s->distance);
}

static void next_step(fins *f, const step *before, step *s)
{
    unsigned run = before->column > 0 ? length_of((uint32_t)before->column - 1) : 0,
             up = length_of(size_of(before->up)), far = length_of(size_of(before->distance));
    s->column = (int32_t)number(f, RUN, CELL_RUN + least(run, 3), (uint32_t)s->column - 1) + 1;
    FF_ASSERT(s->column >= 1);
    run = length_of((uint32_t)s->column - 1);
    s->up = signed_number(f, UP, CELL_UP + 4 * least(run, 3) + least(up, 3), before->up, s->up);
    s->distance = signed_number(f, DISTANCE, CELL_DISTANCE + 3 * least(run, 2) + least(far, 2),
                                before->distance, s->distance);
}

static int vertex_ok(int32_t column, int32_t up, int32_t distance)
{
    return column >= -FF_FAR_COLUMN_MAX && column <= FF_FAR_COLUMN_MAX && up >= -FF_FAR_UP_MAX &&
           up <= FF_FAR_UP_MAX && distance >= 0 && distance <= FF_FAR_DISTANCE_MAX;
}

static void begin(fins *f, const uint16_t one[FF_FINS_CONTEXTS])
{
    memcpy(f->one, one, sizeof f->one);
}

/* ---- decoder ---- */

static int take_vertex(const ff_fin_vertex *from, const step *s, unsigned begins,
                       ff_fin_vertex *vertex)
{
    int32_t column = from->column + s->column, up = from->up_q2 + s->up,
            distance = from->distance + s->distance;
    if (!vertex_ok(column, up, distance)) return FF_ERR_RANGE;
    *vertex = (ff_fin_vertex){ (int16_t)column, (int16_t)up, (uint16_t)distance, (uint8_t)begins };
    return FF_OK;
}

/* Vertices of a fin, or an error. */
static int take_fin(fins *f, const ff_fin_vertex *before, ff_fin_vertex *vertex, uint32_t room)
{
    step s = { 0, 0, 0 }, last = { 0, 0, 0 };
    uint32_t count = 0;
    do {
        if (count == room) return FF_ERR_FULL;
        if (count == 0)
            first_step(f, &s);
        else
            next_step(f, &last, &s);
        int rc = take_vertex(count ? &vertex[count - 1] : before, &s, count == 0, &vertex[count]);
        if (rc != FF_OK) return rc;
        last = count ? s : (step){ 0, 0, 0 };
        count++;
    } while (count < 2 || decide(f, FF_FINS_ON + least(count - 2, 7), 0));
    FF_ASSERT(count >= 2 && count <= room);
    return (int)count;
}

int ff_fins_decode(const uint8_t *bytes, size_t byte_count, ff_fin_vertex *vertex, uint32_t room)
{
    fins f = { .error = FF_OK };
    ff_fin_vertex first = { 0 };
    uint32_t count = 0;
    if (byte_count == 0) return 0;
    if (room > FF_FAR_VERTICES_MAX) room = FF_FAR_VERTICES_MAX;
    begin(&f, ff_fins_learned);
    ff_range_read(&f.range, bytes, byte_count);
    do {
        int made = take_fin(&f, &first, vertex + count, room - count);
        if (made < 0) return made;
        first = vertex[count];
        count += (uint32_t)made;
        FF_ASSERT(count <= room);
    } while (decide(&f, FF_FINS_MORE, 0));
    /* a stream has no byte that says nothing */
    return ff_range_is_read(&f.range) && bytes[byte_count - 1] ? (int)count : FF_ERR_FORMAT;
}

/* ---- encoder ---- */

#ifdef FF_ENCODER

/* The fin that begins here: its vertices, 0 when it is none that can be told. */
static uint32_t fin_length(const ff_fin_vertex *vertex, uint32_t count)
{
    uint32_t length = 0;
    while (length < count && vertex[length].begins == (length == 0)) {
        const ff_fin_vertex *v = &vertex[length];
        if (!vertex_ok(v->column, v->up_q2, v->distance)) return 0;
        if (length && v->column <= v[-1].column) return 0;
        length++;
    }
    return length < 2 ? 0 : length;
}

static void put_fin(fins *f, const ff_fin_vertex *before, const ff_fin_vertex *vertex,
                    uint32_t length)
{
    step last = { 0, 0, 0 };
    FF_ASSERT(length >= 2);
    for (uint32_t i = 0; i < length; i++) {
        const ff_fin_vertex *from = i ? &vertex[i - 1] : before, *to = &vertex[i];
        step s = { to->column - from->column, to->up_q2 - from->up_q2,
                   to->distance - from->distance };
        if (i)
            next_step(f, &last, &s);
        else
            first_step(f, &s);
        if (i) last = s;
        if (i > 0) (void)decide(f, FF_FINS_ON + least(i - 1, 7), i + 1 < length);
    }
}

int ff_fins_put(const uint16_t one[FF_FINS_CONTEXTS], uint32_t (*seen)[2],
                const ff_fin_vertex *vertex, uint32_t count, uint8_t *out, size_t capacity)
{
    ff_range_writer to;
    fins f = { .to = &to, .seen = seen };
    ff_fin_vertex before = { 0 };
    if (count == 0) return 0;
    if (count > FF_FAR_VERTICES_MAX) return FF_ERR_RANGE;
    begin(&f, one);
    ff_range_write(&to, out, capacity);
    for (uint32_t i = 0; i < count;) {
        uint32_t length = fin_length(vertex + i, count - i);
        if (length == 0) return FF_ERR_RANGE;
        put_fin(&f, &before, vertex + i, length);
        before = vertex[i];
        i += length;
        (void)decide(&f, FF_FINS_MORE, i < count);
    }
    int bytes = ff_range_end(&to);
    return bytes < 0 ? FF_ERR_FULL : bytes;
}

int ff_fins_encode(const ff_fin_vertex *vertex, uint32_t count, uint8_t *out, size_t capacity)
{
    return ff_fins_put(ff_fins_learned, NULL, vertex, count, out, capacity);
}

#endif
