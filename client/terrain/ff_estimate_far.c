/* The estimate of far ground: the same squares, those beyond a front alone. */
#include "ff_gaze.h"

#include <string.h>

#define ERROR_MOST_Q8     (50 * 256)
#define ERROR_MOST_LOG_Q8 (14 * 256)
#define ROOT_2_Q12        5793
#define NOTHING           UINT32_MAX

typedef struct ff_far_sum {
    int64_t begin[FF_FAR_RUNGS]; /* of each rung, in units of ff_gaze.h */
    uint64_t pixels_q4[FF_FAR_RUNGS], error;
    uint32_t skyline_q8[FF_GAZE_SECTORS]; /* NOTHING: no far ground meets the sky there */
} ff_far_sum;

static uint32_t error_of(int32_t log_q8)
{
    if (log_q8 < 0) return 0;
    uint32_t error_q8 = ff_exp2_q8(log_q8 < ERROR_MOST_LOG_Q8 ? log_q8 : ERROR_MOST_LOG_Q8);
    return error_q8 < ERROR_MOST_Q8 ? error_q8 : ERROR_MOST_Q8;
}

void ff_gaze_far(ff_gaze *at, const ff_square *s, uint32_t pixels_q4, int32_t error_log_q8)
{
    ff_far_sum *sum = at->far;
    int64_t x = size_of(s->middle[0]), y = size_of(s->middle[1]), away = x > y ? x : y;
    unsigned sector = ff_gaze_sector(s), rung = 0;
    sum->skyline_q8[sector] = NOTHING;
    if (away < sum->begin[0]) return;
    while (rung + 1 < FF_FAR_RUNGS && away >= sum->begin[rung + 1]) rung++;
    uint32_t error_q8 = error_of(error_log_q8);
    sum->pixels_q4[rung] += pixels_q4;
    if (rung < FF_FAR_NEARER) return;
    sum->skyline_q8[sector] = error_q8;
    sum->error += (uint64_t)pixels_q4 * error_q8;
}

static void sum_up(const ff_far_sum *sum, ff_far_ground *far)
{
    uint64_t pixels_q4 = 0, squares = 0;
    uint32_t sectors = 0;
    for (unsigned rung = FF_FAR_RUNGS; rung-- > 0;) {
        pixels_q4 += sum->pixels_q4[rung];
        far->pixels[rung] = (uint32_t)(pixels_q4 >> 4);
    }
    if (far->pixels[FF_FAR_NEARER])
        far->error_q8 = (uint32_t)((sum->error >> 4) / far->pixels[FF_FAR_NEARER]);
    for (unsigned i = 0; i < FF_GAZE_SECTORS; i++) {
        if (sum->skyline_q8[i] == NOTHING) continue;
        squares += (uint64_t)sum->skyline_q8[i] * sum->skyline_q8[i];
        sectors++;
    }
    if (sectors) far->skyline_q8 = (uint32_t)c3d_isqrt64(squares / sectors);
}

void ff_estimate_far(const ff_tree *tree, int32_t front_wu, ff_far_ground *far)
{
    ff_gaze at;
    ff_far_sum sum = { .begin = { front_wu >> (FF_GAZE_UNIT_LOG2 + FF_FAR_NEARER / 2) } };
    memset(far, 0, sizeof *far);
    if (!tree->has_view) return;
    for (unsigned i = 1; i < FF_FAR_RUNGS; i++) sum.begin[i] = sum.begin[i - 1] * ROOT_2_Q12 >> 12;
    for (unsigned i = 0; i < FF_GAZE_SECTORS; i++) sum.skyline_q8[i] = NOTHING;
    ff_gaze_open(&at, tree);
    at.far = &sum;
    for (uint32_t i = 0; i < tree->drawn_count; i++) {
        ff_box box;
        ff_node_box(tree, tree->drawn[i].node, &box);
        far->far_nodes += box.lo[0] > front_wu || box.hi[0] < -front_wu || box.lo[1] > front_wu ||
                          box.hi[1] < -front_wu;
        ff_gaze_node(&at, &tree->drawn[i]);
    }
    far->nodes = tree->drawn_count;
    sum_up(&sum, far);
}
