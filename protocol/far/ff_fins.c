/* Fins as bits (SPEC.md, "Fins"): ridges go on as they went, so steps are small. */
#include "ff_bits.h"
#include "ff_far.h"

/* Orders of the codes: of what begins a fin, and of steps within it. */
enum {
    ORDER_FINS = 3,
    ORDER_VERTICES = 1,
    ORDER_FIRST_COLUMN = 5,
    ORDER_FIRST_UP = 5,
    ORDER_FIRST_DISTANCE = 4,
    ORDER_RUN = 2,
    ORDER_UP = 2,
    ORDER_DISTANCE = 1
};

static int vertex_ok(const ff_fin_vertex *vertex)
{
    return vertex->column >= -FF_FAR_COLUMN_MAX && vertex->column <= FF_FAR_COLUMN_MAX &&
           vertex->up_q2 >= -FF_FAR_UP_MAX && vertex->up_q2 <= FF_FAR_UP_MAX &&
           vertex->distance <= FF_FAR_DISTANCE_MAX;
}

/* The fin that begins here: its vertices, 0 when it is none that can be told. */
static uint32_t fin_length(const ff_fin_vertex *vertex, uint32_t count)
{
    uint32_t length = 0;
    while (length < count && vertex[length].begins == (length == 0)) {
        if (!vertex_ok(&vertex[length])) return 0;
        if (length && vertex[length].column <= vertex[length - 1].column) return 0;
        length++;
    }
    return length < 2 ? 0 : length;
}

static void put_fin(ff_bits *bits, const ff_fin_vertex *before, const ff_fin_vertex *vertex,
                    uint32_t length)
{
    ff_bits_put_number(bits, length - 2, ORDER_VERTICES);
    ff_bits_put_signed(bits, vertex->column - before->column, ORDER_FIRST_COLUMN);
    ff_bits_put_signed(bits, vertex->up_q2 - before->up_q2, ORDER_FIRST_UP);
    ff_bits_put_signed(bits, vertex->distance - before->distance, ORDER_FIRST_DISTANCE);
    for (uint32_t i = 1; i < length; i++) {
        const ff_fin_vertex *last = &vertex[i - 1], *here = &vertex[i];
        ff_bits_put_number(bits, (uint32_t)(here->column - last->column - 1), ORDER_RUN);
        ff_bits_put_signed(bits, here->up_q2 - last->up_q2, ORDER_UP);
        ff_bits_put_signed(bits, here->distance - last->distance, ORDER_DISTANCE);
    }
}

int ff_fins_encode(const ff_fin_vertex *vertex, uint32_t count, uint8_t *out, size_t capacity)
{
    ff_bits bits = { .out = out, .limit = 8 * capacity };
    ff_fin_vertex before = { 0 };
    uint32_t fins = 0;
    if (count == 0) return 0;
    if (count > FF_FAR_VERTICES_MAX) return FF_ERR_RANGE;
    for (uint32_t i = 0; i < count; i++) fins += vertex[i].begins;
    if (fins == 0) return FF_ERR_RANGE;
    ff_bits_put_number(&bits, fins - 1, ORDER_FINS);
    for (uint32_t i = 0; i < count;) {
        uint32_t length = fin_length(vertex + i, count - i);
        if (length == 0) return FF_ERR_RANGE;
        put_fin(&bits, &before, vertex + i, length);
        before = vertex[i];
        i += length;
    }
    return ff_bits_written(&bits);
}

/* Adds what was read to what was before; out of range, an error. */
static void step(ff_bits *bits, const ff_fin_vertex *before, int32_t column, int32_t up,
                 int32_t distance, ff_fin_vertex *vertex)
{
    column += before->column;
    up += before->up_q2;
    distance += before->distance;
    if (column < -FF_FAR_COLUMN_MAX || column > FF_FAR_COLUMN_MAX || up < -FF_FAR_UP_MAX ||
        up > FF_FAR_UP_MAX || distance < 0 || distance > FF_FAR_DISTANCE_MAX) {
        bits->error = bits->error == FF_OK ? FF_ERR_RANGE : bits->error;
        return;
    }
    vertex->column = (int16_t)column;
    vertex->up_q2 = (int16_t)up;
    vertex->distance = (uint16_t)distance;
}

static void take_vertex(ff_bits *bits, const ff_fin_vertex *before, int first,
                        ff_fin_vertex *vertex)
{
    int32_t column = first ? ff_bits_take_signed(bits, ORDER_FIRST_COLUMN)
                           : (int32_t)ff_bits_take_number(bits, ORDER_RUN) + 1;
    int32_t up = ff_bits_take_signed(bits, first ? ORDER_FIRST_UP : ORDER_UP);
    int32_t distance = ff_bits_take_signed(bits, first ? ORDER_FIRST_DISTANCE : ORDER_DISTANCE);
    vertex->begins = (uint8_t)first;
    step(bits, before, column, up, distance, vertex);
}

int ff_fins_decode(const uint8_t *bytes, size_t byte_count, ff_fin_vertex *vertex, uint32_t room)
{
    ff_bits bits = { .in = bytes, .limit = 8 * byte_count };
    ff_fin_vertex first = { 0 };
    uint32_t count = 0;
    if (byte_count == 0) return 0;
    for (uint32_t fins = ff_bits_take_number(&bits, ORDER_FINS) + 1; fins > 0; fins--) {
        uint32_t length = ff_bits_take_number(&bits, ORDER_VERTICES) + 2;
        if (bits.error != FF_OK || bits.at > bits.limit) break;
        if (length > FF_FAR_VERTICES_MAX - count) return FF_ERR_RANGE;
        if (length > room - count) return FF_ERR_FULL;
        for (uint32_t i = 0; i < length && bits.error == FF_OK; i++)
            take_vertex(&bits, i ? &vertex[count + i - 1] : &first, i == 0, &vertex[count + i]);
        if (bits.error != FF_OK) break;
        first = vertex[count];
        count += length;
    }
    int rc = ff_bits_end(&bits);
    return rc == FF_OK ? (int)count : rc;
}
