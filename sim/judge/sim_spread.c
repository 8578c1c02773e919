#include "sim_spread.h"

#include <math.h>
#include <stdlib.h>

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

sim_spread sim_spread_of(double *list, size_t count)
{
    double sum = 0;
    if (!count) return (sim_spread){ 0 };
    qsort(list, count, sizeof *list, by_value);
    for (size_t i = 0; i < count; i++) sum += list[i] * list[i];
    return (sim_spread){ .rms = sqrt(sum / (double)count),
                         .p95 = list[(count - 1) * 95 / 100],
                         .max = list[count - 1] };
}
