#include "slow_far.h"

#include <math.h>

typedef struct bit_row {
    const uint8_t *bytes;
    size_t count, next; /* of bits */
    int broken;
} bit_row;

static int one_bit(bit_row *row)
{
    size_t here = row->next++;

    if (here >= row->count) {
        row->broken = 1;
        return 0;
    }
    return row->bytes[here / 8] / (1 << here % 8) % 2;
}

static long number(bit_row *row, int order)
{
    long first = 0, rest = 0, width = 1L << order;
    int ones = 0;

    while (one_bit(row)) {
        first += width;
        width *= 2;
        if (++ones > 16) row->broken = 1;
        if (row->broken) return 0;
    }
    for (long weight = 1; weight < width; weight *= 2) rest += weight * one_bit(row);
    return first + rest;
}

static long with_sign(bit_row *row, int order)
{
    long value = number(row, order);

    return value % 2 ? -(value + 1) / 2 : value / 2;
}

/* Nothing is left but zeros that fill the last byte. */
static int at_end(bit_row *row)
{
    if (row->broken || row->count - row->next > 7) return 0;
    while (row->next < row->count)
        if (one_bit(row)) return 0;
    return 1;
}

static int in_range(const slow_vertex *vertex)
{
    return vertex->column >= -1023 && vertex->column <= 1023 && vertex->height >= -16383 &&
           vertex->height <= 16383 && vertex->distance >= 0 && vertex->distance <= 511;
}

static void first_of_fin(bit_row *row, const slow_vertex *before, slow_vertex *vertex)
{
    vertex->begins = 1;
    vertex->column = before->column + with_sign(row, 5);
    vertex->height = before->height + with_sign(row, 5);
    vertex->distance = before->distance + with_sign(row, 4);
}

static void next_of_fin(bit_row *row, const slow_vertex *before, slow_vertex *vertex)
{
    vertex->begins = 0;
    vertex->column = before->column + number(row, 2) + 1;
    vertex->height = before->height + with_sign(row, 2);
    vertex->distance = before->distance + with_sign(row, 1);
}

int slow_fins(const uint8_t *bytes, size_t count, slow_vertex vertex[SLOW_FAR_VERTICES])
{
    bit_row row = { bytes, 8 * count, 0, 0 };
    slow_vertex start = { 0, 0, 0, 0 };
    int total = 0;
    long fins;

    if (count == 0) return 0;
    fins = number(&row, 3) + 1;
    for (long fin = 0; fin < fins; fin++) {
        long vertices = number(&row, 1) + 2;
        for (long i = 0; i < vertices; i++, total++) {
            if (row.broken || total == SLOW_FAR_VERTICES) return -1;
            if (i == 0) {
                first_of_fin(&row, &start, &vertex[total]);
                start = vertex[total];
            } else {
                next_of_fin(&row, &vertex[total - 1], &vertex[total]);
            }
            if (!in_range(&vertex[total])) return -1;
        }
    }
    return at_end(&row) ? total : -1;
}

int slow_blocks(const uint8_t *bytes, size_t count, int blocks, uint8_t *there)
{
    bit_row row = { bytes, 8 * count, 0, 0 };
    int told = 0, found = 0;

    for (int run = 0; told < blocks; run++) {
        long length = run == 0 ? number(&row, 2) : number(&row, 2) + 1;
        if (row.broken || length > blocks - told) return -1;
        for (long i = 0; i < length; i++) {
            there[told++] = (uint8_t)(run % 2);
            found += run % 2;
        }
    }
    return at_end(&row) && found >= 1 && found <= 4093 ? found : -1;
}

long slow_distance(int step)
{
    double root = floor(65536 * pow(2, step % 32 / 32.0) + 0.5);

    return (long)floor(16384 * root * pow(2, floor(step / 32.0)) / 65536); /* exact: below 2^53 */
}
