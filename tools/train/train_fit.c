#include "train_fit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define WIDEST (FF_TRAINED_TAPS + 1)
#define HALF   32768
#define ENOUGH 100
#define MIX    0.25

/* ---- weights ---- */

void train_begin(ff_trained *tables)
{
    memset(tables, 0, sizeof *tables);
    for (unsigned set = 0; set < FF_TRAINED_SETS; set++)
        for (unsigned kind = 0; kind < FF_POINTS; kind++) {
            int16_t *trait = tables->weights[set].trait[kind];
            trait[0] = trait[1] = 1 << (FF_TRAINED_TRAITS_LOG2 - 3);
            trait[2] = 1 << (FF_TRAINED_TRAITS_LOG2 - 2);
            trait[3] = 1 << (FF_TRAINED_TRAITS_LOG2 - 4);
        }
}

void train_sum(train_sums sums[FF_TRAINED_SETS], const train_point *point)
{
    const ff_expected *p = point->expected;
    train_sums *of = &sums[point->set];
    int32_t known[FF_TRAINED_TAPS], trait[FF_TRAINED_TRAITS], base_q2;
    double scale = p->distance_q4 / 16.0 + 0.5 * p->quantum + 0.3,
           weight = point->share / (scale * scale),
           distance = fabs(point->height - p->mean_q4 / 16.0);
    unsigned taps = ff_trained_known(p, known, &base_q2), traits = ff_trained_traits(p, trait);
    double base = base_q2 / 4.0, off = point->height - base;
    for (unsigned i = 0; i < taps; i++) {
        double *row = of->tap[p->kind][p->bucket][i], x = (known[i] - base) * weight;
        if (x == 0) continue;
        for (unsigned j = 0; j < taps; j++) row[j] += x * (known[j] - base);
        row[FF_TRAINED_TAPS] += x * off;
    }
    for (unsigned i = 0; i < traits; i++) {
        double *row = of->trait[p->kind][i], x = trait[i] * weight;
        for (unsigned j = 0; j < traits; j++) row[j] += x * trait[j];
        row[FF_TRAINED_TRAITS] += x * distance;
    }
}

/* Gauss and Jordan, with a ridge. a[i][n]: the right side, and then the solution. */
static void solve(double a[WIDEST][WIDEST + 1], unsigned n, double ridge)
{
    double trace = 0;
    for (unsigned i = 0; i < n; i++) trace += a[i][i];
    for (unsigned i = 0; i < n; i++) a[i][i] += trace / n * ridge + 1e-6;
    for (unsigned i = 0; i < n; i++) {
        double pivot = a[i][i];
        for (unsigned j = i; j <= n; j++) a[i][j] /= pivot;
        for (unsigned r = 0; r < n; r++) {
            double factor = r == i ? 0 : a[r][i];
            for (unsigned j = i; j <= n && factor != 0; j++) a[r][j] -= factor * a[i][j];
        }
    }
}

static int16_t fixed(double value, unsigned log2)
{
    double steps = round(ldexp(value, (int)log2));
    return (int16_t)(steps < INT16_MIN ? INT16_MIN : steps > INT16_MAX ? INT16_MAX : steps);
}

/* Buckets take a tenth of what their neighbours saw. */
static void fit_taps(const train_sums *sums, unsigned kind, unsigned bucket, ff_taps *taps)
{
    double a[WIDEST][WIDEST + 1];
    for (unsigned i = 0; i < FF_TRAINED_TAPS; i++)
        for (unsigned j = 0; j <= FF_TRAINED_TAPS; j++) {
            a[i][j] = sums->tap[kind][bucket][i][j];
            if (bucket > 0) a[i][j] += 0.1 * sums->tap[kind][bucket - 1][i][j];
            if (bucket + 1 < FF_TRAINED_BUCKETS) a[i][j] += 0.1 * sums->tap[kind][bucket + 1][i][j];
        }
    solve(a, FF_TRAINED_TAPS, 1e-4);
    taps->sum = 0;
    for (unsigned i = 0; i < FF_TRAINED_TAPS; i++) {
        taps->tap[i] = fixed(a[i][FF_TRAINED_TAPS], FF_TRAINED_TAPS_LOG2);
        taps->sum += taps->tap[i];
    }
}

static void fit_traits(const train_sums *sums, unsigned kind, ff_weights *weights)
{
    double a[WIDEST][WIDEST + 1];
    for (unsigned i = 0; i < FF_TRAINED_TRAITS; i++)
        for (unsigned j = 0; j <= FF_TRAINED_TRAITS; j++) a[i][j] = sums->trait[kind][i][j];
    solve(a, FF_TRAINED_TRAITS, 1e-5);
    for (unsigned i = 0; i < FF_TRAINED_TRAITS; i++)
        weights->trait[kind][i] = fixed(a[i][FF_TRAINED_TRAITS], FF_TRAINED_TRAITS_LOG2);
}

/* A set takes a part of what all saw: with little it fits the ground that is at hand, and other
 * ground badly. */
static void mix(train_sums sums[FF_TRAINED_SETS])
{
    size_t count = sizeof *sums / sizeof(double);
    for (size_t i = 0; i < count; i++) {
        double all = 0;
        for (unsigned set = 0; set < FF_TRAINED_SETS; set++) all += ((double *)&sums[set])[i];
        for (unsigned set = 0; set < FF_TRAINED_SETS; set++) ((double *)&sums[set])[i] += MIX * all;
    }
}

static void fit_set(const train_sums *sums, ff_weights *weights)
{
    for (unsigned kind = 0; kind < FF_POINTS; kind++) {
        for (unsigned bucket = 0; bucket < FF_TRAINED_BUCKETS; bucket++)
            fit_taps(sums, kind, bucket, &weights->taps[kind][bucket]);
        fit_traits(sums, kind, weights);
    }
}

void train_weights(train_sums sums[FF_TRAINED_SETS], ff_trained *tables)
{
    mix(sums);
    for (unsigned set = 0; set < FF_TRAINED_SETS; set++) fit_set(&sums[set], &tables->weights[set]);
}

static double sizes(const int16_t *weight, unsigned count)
{
    double sum = 0;
    for (unsigned i = 0; i < count; i++) sum += abs(weight[i]);
    return sum;
}

int train_weights_fit(const ff_trained *tables)
{
    int fit = 1;
    for (unsigned set = 0; set < FF_TRAINED_SETS; set++)
        for (unsigned kind = 0; kind < FF_POINTS; kind++) {
            const ff_weights *by = &tables->weights[set];
            for (unsigned bucket = 0; bucket < FF_TRAINED_BUCKETS; bucket++)
                fit &= sizes(by->taps[kind][bucket].tap, FF_TRAINED_TAPS) <= INT16_MAX;
            fit &= 65536.0 * sizes(by->trait[kind], 2) +
                       FF_TRAINED_TRAIT_MAX * sizes(by->trait[kind] + 2, FF_TRAINED_TRAITS - 2) <=
                   INT32_MAX;
        }
    return fit;
}

/* ---- probabilities ---- */

/* Counts what became of a decision; `one`: its place in the first odds. */
static void count(train_counts *counts, const ff_expected *p, const uint16_t *one, unsigned way,
                  double share)
{
    size_t decision = (size_t)(one - &ff_trained_tables.odds->zero);
    counts->of[p->scale][decision][way] += share;
}

void train_count(train_counts *counts, const train_point *point)
{
    const ff_expected *p = point->expected;
    double share = point->share;
    int32_t value = point->residual - p->residual;
    uint32_t size = (uint32_t)(value < 0 ? -value : value);
    unsigned bits = 0;
    const ff_odds *odds = ff_trained_tables.odds; /* for its members' places */
    count(counts, p, &odds->zero, value == 0, share);
    if (!value) return;
    count(counts, p, &odds->below[p->phase], value < 0, share);
    while (size >> bits >> 1) bits++;
    for (unsigned i = 0; i < bits; i++) count(counts, p, &odds->beyond[i], 1, share);
    if (bits < FF_TRAINED_CLASSES - 1) count(counts, p, &odds->beyond[bits], 0, share);
    if (bits > 0) count(counts, p, &odds->second[bits], size >> (bits - 1) & 1u, share);
    if (bits > 1)
        count(counts, p, &odds->third[2 * bits + (size >> (bits - 1) & 1u)],
              size >> (bits - 2) & 1u, share);
}

/* Of 65536; `before`: what it is taken for until there are counts. */
static uint16_t share(const double count[2], uint16_t before)
{
    double p = (count[1] + 2 * before / 65536.0) / (count[0] + count[1] + 2) * 65536;
    return (uint16_t)(p < 32 ? 32 : p > 65503 ? 65503 : lrint(p));
}

/* Of a decision; a scale where it hardly ever was goes by the one beside it where it was. */
static void shares(const train_counts *counts, size_t decision, ff_trained *tables)
{
    unsigned first = 0;
    for (; first + 1 < FF_TRAINED_SCALES; first++) {
        const double *of = counts->of[first][decision];
        if (of[0] + of[1] >= ENOUGH) break;
    }
    uint16_t before = share(counts->of[first][decision], HALF);
    for (unsigned i = 0; i < FF_TRAINED_SCALES; i++) {
        if (i >= first) before = share(counts->of[i][decision], before);
        ((uint16_t *)&tables->odds[i])[decision] = before;
    }
}

void train_probabilities(train_counts *counts, ff_trained *tables)
{
    for (size_t i = 0; i < FF_TRAINED_DECISIONS; i++) shares(counts, i, tables);
}

static double bits_of(uint16_t probability, int is_one)
{
    static double bits[65536];
    if (bits[1] == 0)
        for (unsigned i = 1; i < 65536; i++) bits[i] = -log2(i / 65536.0);
    return bits[is_one ? probability : 65536 - probability];
}

double train_bits(const ff_trained *tables, const ff_expected *p, int32_t residual)
{
    int32_t value = residual - p->residual;
    uint32_t size = (uint32_t)(value < 0 ? -value : value);
    unsigned bits = 0;
    const ff_odds *odds = &tables->odds[p->scale];
    double sum = bits_of(odds->zero, value == 0);
    if (!value) return sum;
    sum += bits_of(odds->below[p->phase], value < 0);
    while (size >> bits >> 1) sum += bits_of(odds->beyond[bits++], 1);
    if (bits < FF_TRAINED_CLASSES - 1) sum += bits_of(odds->beyond[bits], 0);
    if (bits > 0) sum += bits_of(odds->second[bits], size >> (bits - 1) & 1u);
    if (bits > 1)
        sum += bits_of(odds->third[2 * bits + (size >> (bits - 1) & 1u)], size >> (bits - 2) & 1u);
    return bits > 2 ? sum + bits - 2 : sum;
}
