#include "slow_far.h"

#include "../../protocol/far/ff_fins_local.h"

#include <math.h>
#include <stdlib.h>

/* ---- decisions, as in tests/rig/slow_picture.c ---- */

typedef struct stream {
    const uint8_t *bytes;
    size_t count, taken;
    uint64_t width, code;
    int64_t one[FF_FINS_CONTEXTS];
} stream;

static uint64_t next_byte(stream *in) { return in->taken < in->count ? in->bytes[in->taken++] : 0; }

static int chance(stream *in, int64_t probability)
{
    uint64_t part = in->width / 65536 * (uint64_t)probability;
    int is_one = in->code < part;

    if (is_one) in->width = part;
    if (!is_one) in->width -= part;
    if (!is_one) in->code -= part;
    while (in->width < 1u << 24) {
        in->width *= 256;
        in->code = (in->code * 256 + next_byte(in)) % (UINT64_C(1) << 32);
    }
    return is_one;
}

static int decide(stream *in, int at)
{
    int is_one = chance(in, in->one[at]);

    in->one[at] += is_one ? (65536 - in->one[at]) / 32 : -(in->one[at] / 32);
    return is_one;
}

/* ---- numbers ---- */

static long number(stream *in, int sort, int cell)
{
    long value = 1;
    int bits = 0;

    while (bits < 15 && decide(in, 24 + 16 * cell + bits)) bits++;
    for (int i = 0; i < bits; i++)
        value = 2 * value + (i == 0 ? decide(in, 536 + 16 * sort + bits) : chance(in, 32768));
    return value - 1;
}

static long with_sign(stream *in, int sort, int cell, long before)
{
    long size = number(in, sort, cell);
    int sign = before < 0 ? 1 : before > 0 ? 2 : 0;

    return size && decide(in, 9 + 3 * sort + sign) ? -size : size;
}

static int bits_of(long value)
{
    int bits = 0;

    for (long above = labs(value) + 1; above > 1; above /= 2) bits++;
    return bits;
}

static int at_most(int value, int most) { return value < most ? value : most; }

static int in_range(const slow_vertex *vertex)
{
    return vertex->column >= -1023 && vertex->column <= 1023 && vertex->height >= -16383 &&
           vertex->height <= 16383 && vertex->distance >= 0 && vertex->distance <= 511;
}

static slow_vertex first_step(stream *in)
{
    slow_vertex step = { 1, 0, 0, 0 };

    step.column = with_sign(in, 0, 0, 0);
    step.height = with_sign(in, 1, 1, 0);
    step.distance = with_sign(in, 2, 2, 0);
    return step;
}

static slow_vertex next_step(stream *in, const slow_vertex *before)
{
    slow_vertex step = { 0, 0, 0, 0 };
    int run = before->column ? bits_of(before->column - 1) : 0;

    step.column = number(in, 5, 3 + at_most(run, 3)) + 1;
    run = bits_of(step.column - 1);
    step.height = with_sign(in, 3, 7 + 4 * at_most(run, 3) + at_most(bits_of(before->height), 3),
                            before->height);
    step.distance = with_sign(
        in, 4, 23 + 3 * at_most(run, 2) + at_most(bits_of(before->distance), 2), before->distance);
    return step;
}

/* ---- fins ---- */

/* Vertices, -1: nonsense. */
static int fin(stream *in, const slow_vertex *before, slow_vertex *vertex, int room)
{
    slow_vertex step = { 0, 0, 0, 0 };
    int count = 0;

    do {
        const slow_vertex *from = count ? &vertex[count - 1] : before;
        if (count == room) return -1;
        step = count ? next_step(in, &step) : first_step(in);
        vertex[count] = (slow_vertex){ count == 0, from->column + step.column,
                                       from->height + step.height, from->distance + step.distance };
        if (!in_range(&vertex[count])) return -1;
        if (count == 0) step = (slow_vertex){ 0, 0, 0, 0 };
        count++;
    } while (count < 2 || decide(in, 1 + at_most(count - 2, 7)));
    return count;
}

int slow_fins(const uint8_t *bytes, size_t count, slow_vertex vertex[SLOW_FAR_VERTICES])
{
    stream in = { .bytes = bytes, .count = count, .width = UINT32_MAX };
    slow_vertex start = { 0, 0, 0, 0 };
    int total = 0;

    if (count == 0) return 0;
    for (int i = 0; i < FF_FINS_CONTEXTS; i++) in.one[i] = ff_fins_learned[i];
    for (int i = 0; i < 4; i++) in.code = in.code * 256 + next_byte(&in);
    do {
        int made = fin(&in, &start, vertex + total, SLOW_FAR_VERTICES - total);
        if (made < 0) return -1;
        start = vertex[total];
        total += made;
    } while (decide(&in, 0));
    return in.taken == in.count && bytes[count - 1] ? total : -1;
}

long slow_distance(int step)
{
    double root = floor(65536 * pow(2, step % 32 / 32.0) + 0.5);

    return (long)floor(16384 * root * pow(2, floor(step / 32.0)) / 65536); /* exact: below 2^53 */
}
