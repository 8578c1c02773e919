/* Numbers as decisions of the range coder (SPEC.md, 5.2): one way and the other are the same walk.
 */
#include "ff_picture_local.h"

#include <string.h>

#define HALF     32768u
#define RATE     5
#define BITS_MAX 15
#define UNKNOWN  8 /* coefficients of a block before the first */
#define WIDE     10

/* ---- decisions ---- */

#ifdef FF_ENCODER
/* 256ths of a bit that a decision takes, of such a probability. */
static uint32_t cost_of(uint32_t part)
{
    uint32_t cost = 256, over;
    for (; part < 32768; part *= 2) cost += 256;
    over = part - 32768;
    /* log2(1 + x) is about x + 11/32 x (1 - x) */
    return cost - (over >> 7) - ((over >> 4) * ((32768 - over) >> 4) * 88 >> 22);
}
#endif

static unsigned coin(ff_picture *p, uint32_t one, unsigned bit)
{
#ifdef FF_ENCODER
    if (p->cost) {
        *p->cost += cost_of(bit ? one : 65536 - one);
        return bit;
    }
    if (p->to) {
        ff_range_put(p->to, one, bit);
        return bit;
    }
#endif
    (void)bit;
    return ff_range_take(&p->range, one);
}

unsigned ff_picture_decide(ff_picture *p, uint16_t *one, unsigned bit)
{
    bit = coin(p, *one, bit);
#ifdef FF_ENCODER
    if (p->cost) return bit;
#endif
    if (bit)
        *one = (uint16_t)(*one + ((65536u - *one) >> RATE));
    else
        *one = (uint16_t)(*one - (*one >> RATE));
    return bit;
}

static unsigned decide(ff_picture *p, unsigned place, unsigned bit)
{
    FF_ASSERT(place < FF_PICTURE_CONTEXTS);
    bit = ff_picture_decide(p, &p->one[place], bit);
#ifdef FF_ENCODER
    if (p->eye && !p->cost) p->eye->decision(p->eye->context, place, bit);
#endif
    return bit;
}

void ff_picture_see(const ff_picture *p, unsigned row, const int32_t known[FF_PICTURE_KNOWN],
                    int32_t size)
{
#ifdef FF_ENCODER
    if (p->eye && !p->cost) p->eye->number(p->eye->context, row, known, size < 0 ? -size : size);
#endif
    (void)p, (void)row, (void)known, (void)size;
}

/* ---- how large a number is expected ---- */

static int32_t expected(const ff_picture *p, unsigned row, const int32_t known[FF_PICTURE_KNOWN])
{
    const int16_t *weight = p->by->weight[row];
    int32_t sum = 0;
    for (unsigned i = 0; i < FF_PICTURE_KNOWN; i++) sum += weight[i] * known[i];
    return sum;
}

unsigned ff_picture_scale(const ff_picture *p, unsigned row, const int32_t known[FF_PICTURE_KNOWN])
{
    /* from 256 * 2^((i - 13) / 3) - 5 on */
    static const int16_t from[FF_PICTURE_SCALES] = { 0,   11,  15,  20,   27,   35,   46,   59,
                                                     76,  97,  123, 156,  198,  251,  318,  401,
                                                     507, 640, 808, 1019, 1285, 1621, 2043, 2575 };
    int32_t sum = expected(p, row, known);
    unsigned scale = 0;
    for (unsigned half = 16; half; half /= 2)
        if (scale + half < FF_PICTURE_SCALES && sum >= from[scale + half]) scale += half;
    return scale;
}

static unsigned count_scale(const ff_picture *p, unsigned kind,
                            const int32_t known[FF_PICTURE_KNOWN])
{
    /* from 256 * 2^((i - 3) / 2) - 5 on */
    static const int16_t from[FF_PICTURE_COUNTS] = { 0,    123,  177,   251,  358,  507,
                                                     720,  1019, 1444,  2043, 2892, 4091,
                                                     5788, 8187, 11581, 16379 };
    int32_t sum = expected(p, FF_PICTURE_OF_COUNT(kind), known);
    unsigned scale = 0;
    for (unsigned half = 8; half; half /= 2)
        if (sum >= from[scale + half]) scale += half;
    return scale;
}

/* ---- numbers ---- */

static uint32_t beyond_unary(ff_picture *p, uint32_t rest)
{
    unsigned bits = 0;
    uint32_t value = 1;
    while (bits < BITS_MAX && coin(p, HALF, rest >> bits >> 1 != 0)) bits++;
    for (unsigned i = bits; i-- > 0;) value = value << 1 | coin(p, HALF, rest >> i & 1u);
    return value;
}

static uint32_t size_of(ff_picture *p, unsigned kind, unsigned scale, uint32_t size)
{
    unsigned at = FF_PICTURE_BEYOND + (kind % 3 > 0) * FF_PICTURE_UNARY * FF_PICTURE_SCALES + scale;
    uint32_t n = 1;
    while (n <= FF_PICTURE_UNARY && decide(p, at + (n - 1) * FF_PICTURE_SCALES, size > n)) n++;
    return n <= FF_PICTURE_UNARY ? n : FF_PICTURE_UNARY + beyond_unary(p, size - FF_PICTURE_UNARY);
}

/* A number that is not 0. */
static int32_t signed_size(ff_picture *p, unsigned kind, unsigned scale, int32_t value)
{
    int32_t size = (int32_t)size_of(p, kind, scale, (uint32_t)(value < 0 ? -value : value));
    return coin(p, HALF, value < 0) ? -size : size;
}

int32_t ff_picture_number(ff_picture *p, unsigned kind, unsigned scale, int32_t value)
{
    if (!decide(p, kind * FF_PICTURE_SCALES + scale, value != 0)) return 0;
    return signed_size(p, kind, scale, value);
}

/* ---- a block's ---- */

const uint8_t ff_picture_zigzag[64] = { 0,  1,  8,  16, 9,  2,  3,  10, 17, 24, 32, 25, 18,
                                        11, 4,  5,  12, 19, 26, 33, 40, 48, 41, 34, 27, 20,
                                        13, 6,  7,  14, 21, 28, 35, 42, 49, 56, 57, 50, 43,
                                        36, 29, 22, 15, 23, 30, 37, 44, 51, 58, 59, 52, 45,
                                        38, 31, 39, 46, 53, 60, 61, 54, 47, 55, 62, 63 };

/* How many coefficients there are up to the last that is not 0, in the order of the zigzag. */
static unsigned count_of(ff_picture *p, unsigned kind, unsigned scale, unsigned count)
{
    unsigned at = FF_PICTURE_CLASS + (kind * FF_PICTURE_COUNTS + scale) * FF_PICTURE_CLASSES,
             class = 0, want = 0, value = 1;
    if (count)
        for (want = 1; (count - 1) >> (want - 1); want++)
            ;
    while (class < FF_PICTURE_CLASSES && decide(p, at + class, want > class)) class ++;
    if (class < 3) return class;
    at = FF_PICTURE_BITS + (kind * 8 + class) * 3;
    for (unsigned i = class - 2; i-- > 0;) {
        unsigned bit = (count - 1) >> i & 1u, below = class - 3 - i; /* below the highest */
        if (below < 2)
            bit = decide(p, at + (below ? 1 + (value & 1u) : 0), bit);
        else
            bit = coin(p, HALF, bit);
        value = value << 1 | bit;
    }
    return value + 1;
}

static unsigned take_count(ff_picture *p, unsigned plane, const ff_picture_sizes *west,
                           const ff_picture_sizes *south, const int32_t value[64],
                           const ff_picture_sizes *here)
{
    unsigned kind = plane + p->root, count = 64;
    int32_t known[FF_PICTURE_KNOWN] = { 1 };
    while (p->to && count && !value[ff_picture_zigzag[count - 1]]) count--;
    known[1] = west ? west->count[plane] : south ? south->count[plane] : UNKNOWN;
    known[2] = south ? south->count[plane] : known[1];
    known[3] = plane > 0 ? here->count[0] : 0;
    known[4] = plane > 1 ? here->count[1] : 0;
    ff_picture_see(p, FF_PICTURE_OF_COUNT(kind), known, (int32_t)count);
    return count_of(p, kind, count_scale(p, kind, known), count);
}

static uint8_t small(int32_t value)
{
    int32_t size = value < 0 ? -value : value;
    return (uint8_t)(size < 255 ? size : 255);
}

unsigned ff_picture_numbers(ff_picture *p, unsigned plane, const ff_picture_sizes *west,
                            const ff_picture_sizes *south, int32_t value[64],
                            ff_picture_sizes *here)
{
    uint8_t near[WIDE * WIDE] = { 0 };
    unsigned kind = plane + p->root, count = take_count(p, plane, west, south, value, here);
    for (unsigned i = count; i-- > 0;) {
        unsigned z = ff_picture_zigzag[i], at = z / 8 * WIDE + z % 8,
                 weights = FF_PICTURE_OF_BLOCK(kind, z / 8 + z % 8), scale;
        const int32_t known[FF_PICTURE_KNOWN] = { 1, near[at + 1] + near[at + WIDE],
                                                  near[at + WIDE + 1] + near[at + 2] +
                                                      near[at + 2 * WIDE],
                                                  west ? west->size[plane][z] : 0,
                                                  south ? south->size[plane][z] : 0 };
        ff_picture_see(p, weights, known, value[z]);
        scale = ff_picture_scale(p, weights, known);
        value[z] = i + 1 == count ? signed_size(p, kind, scale, value[z])
                                  : ff_picture_number(p, kind, scale, value[z]);
        near[at] = small(value[z]);
    }
    for (unsigned v = 0; v < FF_PICTURE_BLOCK; v++)
        memcpy(here->size[plane] + v * FF_PICTURE_BLOCK, near + v * WIDE, FF_PICTURE_BLOCK);
    here->count[plane] = (uint8_t)count;
    return count;
}
