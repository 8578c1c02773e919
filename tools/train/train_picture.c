#include "train_picture.h"

#include "../bake/bake_say.h"
#include "train_picture_local.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ROUNDS    2
#define QUALITIES 5
#define RGB       3
#define LARGEST   400 /* of numbers that weights are learned from */

static const unsigned quality[QUALITIES] = { 48, 62, 75, 86, 93 };

/* ---- what is seen ---- */

static void see_number(void *context, unsigned row, const int32_t known[FF_PICTURE_KNOWN],
                       int32_t size)
{
    train_learner *l = context;
    double expected = 0;
    for (unsigned i = 0; i < FF_PICTURE_KNOWN; i++)
        expected += l->tables->weight[row][i] / 256.0 * known[i];
    double about = fmax(expected, 0) + (row >= FF_PICTURE_OF_COUNT(0) ? 2 : 0.3),
           weight = 1 / (about * about);
    if (size > LARGEST) return;
    for (unsigned i = 0; i < FF_PICTURE_KNOWN; i++) {
        for (unsigned j = 0; j < FF_PICTURE_KNOWN; j++)
            l->sums->weight[row][i][j] += weight * known[i] * known[j];
        l->sums->weight[row][i][FF_PICTURE_KNOWN] += weight * known[i] * size;
    }
}

static void see_corner(void *context, unsigned kind, int32_t size)
{
    train_learner *l = context;
    l->sums->corner[kind] += size < 0 ? -size : size;
    l->sums->corners[kind]++;
}

static void see_decision(void *context, unsigned place, unsigned bit)
{
    train_learner *l = context;
    l->sums->decision[place][bit]++;
}

ff_picture_eye train_picture_eye(train_learner *learner)
{
    return (ff_picture_eye){ learner, see_number, see_corner, see_decision };
}

/* ---- coding all of them ---- */

/* Who is told of every picture that is made. */
typedef struct coder {
    const train_pictures *pictures;
    const ff_picture_tables *tables;
    const ff_picture_eye *eye;
    unsigned quality;
    double bytes[TRAIN_PICTURE_LEVELS], squares[TRAIN_PICTURE_LEVELS], texels[TRAIN_PICTURE_LEVELS];
    uint8_t *out, *decoded[TRAIN_PICTURE_LEVELS];
    size_t limit;
} coder;

static void add_squares(coder *c, unsigned level, const uint8_t *source)
{
    size_t values = (size_t)RGB << 2 * c->pictures->log2;
    for (size_t i = 0; i < values; i++) {
        int off = source[i] - c->decoded[level][i];
        c->squares[level] += off * off;
    }
    c->texels[level] += (double)values;
}

static void code(coder *c, unsigned level, uint32_t number, const uint8_t *parent)
{
    static ff_picture_room room;
    const train_pictures *from = c->pictures;
    size_t bytes = (size_t)RGB << 2 * from->log2;
    if (level == from->levels || !from->has[level][number]) return;
    const uint8_t *source = from->rgb[level] + number * bytes;
    ff_picture_above above = { parent, number & 3u };
    int made = ff_picture_put(c->tables, c->eye, source, from->log2, above, c->quality, &room,
                              c->decoded[level], c->out, c->limit);
    if (made < 0) return;
    c->bytes[level] += made;
    add_squares(c, level, source);
    for (uint32_t q = 0; q < 4; q++) code(c, level + 1, 4 * number + q, c->decoded[level]);
}

static int code_all(coder *c)
{
    unsigned texels = 1u << 2 * c->pictures->log2;
    int rc = 0;
    c->limit = 16 * (size_t)texels;
    c->out = malloc(c->limit);
    if (!c->out) rc = bake_fail("out of memory");
    for (unsigned l = 0; !rc && l < c->pictures->levels; l++) {
        c->decoded[l] = malloc((size_t)texels * RGB);
        if (!c->decoded[l]) rc = bake_fail("out of memory");
    }
    for (uint32_t tile = 0; !rc && tile < c->pictures->tiles; tile++) code(c, 0, tile, NULL);
    for (unsigned l = 0; l < c->pictures->levels; l++) free(c->decoded[l]);
    free(c->out);
    return rc;
}

int train_pictures_code(const train_pictures *pictures, const ff_picture_tables *tables,
                        unsigned at_quality, train_coded *coded)
{
    coder c = { .pictures = pictures, .tables = tables, .quality = at_quality };
    int rc = code_all(&c);
    memcpy(coded->bytes, c.bytes, sizeof c.bytes);
    for (unsigned l = 0; l < pictures->levels; l++) coded->squares[l] = c.squares[l] / c.texels[l];
    return rc;
}

/* ---- learning ---- */

/* Gauss and Jordan, with a ridge. */
static void solve(double a[FF_PICTURE_KNOWN][FF_PICTURE_KNOWN + 1])
{
    for (unsigned i = 0; i < FF_PICTURE_KNOWN; i++) a[i][i] += 1e-4 * a[i][i] + 1e-3;
    for (unsigned i = 0; i < FF_PICTURE_KNOWN; i++) {
        double pivot = a[i][i];
        for (unsigned j = i; j <= FF_PICTURE_KNOWN; j++) a[i][j] /= pivot;
        for (unsigned r = 0; r < FF_PICTURE_KNOWN; r++) {
            double factor = r == i ? 0 : a[r][i];
            for (unsigned j = i; j <= FF_PICTURE_KNOWN && factor != 0; j++)
                a[r][j] -= factor * a[i][j];
        }
    }
}

void train_picture_weights(train_picture_sums *sums, ff_picture_tables *tables)
{
    for (unsigned row = 0; row < FF_PICTURE_ROWS; row++) {
        solve(sums->weight[row]);
        for (unsigned i = 0; i < FF_PICTURE_KNOWN; i++) {
            double weight = sums->weight[row][i][FF_PICTURE_KNOWN] * 256;
            tables->weight[row][i] = (int16_t)lrint(fmin(fmax(weight, -32767), 32767));
        }
    }
    for (unsigned kind = 0; kind < FF_PICTURE_KINDS; kind++) {
        double mean = sums->corner[kind] / fmax(sums->corners[kind], 1);
        tables->corner[kind] = (uint8_t)fmin(fmax(3 * log2(mean + 0.02) + 13, 0),
                                             FF_PICTURE_SCALES - 1);
    }
}

void train_picture_decisions(const train_picture_sums *sums, ff_picture_tables *tables)
{
    for (unsigned place = 0; place < FF_PICTURE_CONTEXTS; place++) {
        double zero = sums->decision[place][0], one = sums->decision[place][1],
               part = 65536 * (one + 0.4) / (zero + one + 0.8);
        tables->one[place] = (uint16_t)lrint(fmin(fmax(part, 32), 65504));
    }
}

void train_picture_begin(ff_picture_tables *tables)
{
    for (unsigned row = 0; row < FF_PICTURE_ROWS; row++) {
        static const int16_t number[FF_PICTURE_KNOWN] = { 12, 50, 25, 25, 25 },
                             count[FF_PICTURE_KNOWN] = { 128, 100, 100, 0, 0 };
        memcpy(tables->weight[row], row >= FF_PICTURE_OF_COUNT(0) ? count : number, sizeof number);
    }
    for (unsigned kind = 0; kind < FF_PICTURE_KINDS; kind++) tables->corner[kind] = 13;
    for (unsigned place = 0; place < FF_PICTURE_CONTEXTS; place++) tables->one[place] = 32768;
}

int train_pictures_learn(const train_pictures *pictures, unsigned count, ff_picture_tables *tables)
{
    train_picture_sums *sums = malloc(sizeof *sums);
    int rc = sums ? 0 : bake_fail("out of memory");
    train_picture_begin(tables);
    for (unsigned round = 0; !rc && round <= ROUNDS; round++) {
        const ff_picture_tables by = *tables;
        train_learner l = { &by, sums };
        const ff_picture_eye eye = train_picture_eye(&l);
        memset(sums, 0, sizeof *sums);
        for (unsigned i = 0; !rc && i < count * QUALITIES; i++) {
            coder c = { .pictures = &pictures[i / QUALITIES],
                        .tables = &by,
                        .eye = &eye,
                        .quality = quality[i % QUALITIES] };
            rc = code_all(&c);
        }
        if (round < ROUNDS)
            train_picture_weights(sums, tables);
        else
            train_picture_decisions(sums, tables);
    }
    free(sums);
    return rc;
}
