#include "train_far.h"

#include "../bake/bake_say.h"
#include "train_picture_local.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ROUNDS    2
#define QUALITIES 4
#define BYTES_MAX (1 << 20)

static const unsigned quality[QUALITIES] = { 70, 78, 84, 90 };

static void look_away(void *context, unsigned column, unsigned row, uint8_t rgb[64][3])
{
    (void)context, (void)column, (void)row, (void)rgb;
}

/* How often blocks are there and not, by what is round them. */
static void count_there(const ff_paint_source *paint, double there[FF_PAINT_THERE][2])
{
    for (unsigned row = 0; row < paint->rows; row++)
        for (unsigned column = 0; column < paint->columns; column++) {
            const uint8_t *at = paint->there + row * paint->columns + column,
                          *above = row ? at - paint->columns : NULL;
            unsigned context = (column && at[-1]) | (above && above[0]) << 1 |
                               (above && column && above[-1]) << 2 |
                               (above && column + 1 < paint->columns && above[1]) << 3;
            there[context][*at]++;
        }
}

static void learn_there(const train_vistas *vistas, ff_paint_tables *tables)
{
    double there[FF_PAINT_THERE][2] = { { 0 } };
    for (unsigned i = 0; i < vistas->count; i++) count_there(&vistas->vista[i].paint, there);
    for (unsigned i = 0; i < FF_PAINT_THERE; i++) {
        double part = 65536 * (there[i][1] + 1) / (there[i][0] + there[i][1] + 2);
        tables->there[i] = (uint16_t)fmin(fmax(part, 256), 65280);
    }
}

static int code_all(const train_vistas *vistas, const ff_paint_tables *tables,
                    const ff_picture_eye *eye)
{
    static const ff_paint_sink nobody = { .block = look_away };
    ff_paint_room *room = malloc(ff_paint_room_bytes(FF_FAR_BLOCKS_MAX));
    uint8_t *out = malloc(BYTES_MAX);
    int rc = room && out ? 0 : bake_fail("out of memory");
    for (unsigned i = 0; !rc && i < vistas->count * QUALITIES; i++) {
        const ff_paint_source *paint = &vistas->vista[i / QUALITIES].paint;
        if (!paint->columns) continue;
        (void)ff_paint_put(tables, eye, paint, quality[i % QUALITIES], room, &nobody, out,
                           BYTES_MAX);
    }
    free(room);
    free(out);
    return rc;
}

/* Counted as they adapt, from even chances. */
static void learn_fins(const train_vistas *vistas, uint16_t one[FF_FINS_CONTEXTS])
{
    static uint32_t seen[FF_FINS_CONTEXTS][2];
    static uint8_t out[FF_FAR_FINS_BYTES];
    memset(seen, 0, sizeof seen);
    for (unsigned i = 0; i < FF_FINS_CONTEXTS; i++) one[i] = 32768;
    for (unsigned i = 0; i < vistas->count; i++)
        (void)ff_fins_put(one, seen, vistas->vista[i].vertex, vistas->vista[i].count, out,
                          sizeof out);
    for (unsigned i = 0; i < FF_FINS_CONTEXTS; i++) {
        double part = 65536 * (seen[i][1] + 0.4) / (seen[i][0] + seen[i][1] + 0.8);
        one[i] = (uint16_t)lrint(fmin(fmax(part, 256), 65280));
    }
}

int train_far_learn(const train_vistas *vistas, train_far_tables *tables)
{
    train_picture_sums *sums = malloc(sizeof *sums);
    ff_paint_tables *paint = &tables->paint;
    int rc = sums ? 0 : bake_fail("out of memory");
    train_picture_begin(&paint->numbers);
    learn_there(vistas, paint);
    learn_fins(vistas, tables->fins);
    for (unsigned round = 0; !rc && round <= ROUNDS; round++) {
        const ff_paint_tables by = *paint;
        train_learner l = { &by.numbers, sums };
        const ff_picture_eye eye = train_picture_eye(&l);
        memset(sums, 0, sizeof *sums);
        rc = code_all(vistas, &by, &eye);
        if (round < ROUNDS)
            train_picture_weights(sums, &paint->numbers);
        else
            train_picture_decisions(sums, &paint->numbers);
    }
    free(sums);
    return rc;
}
