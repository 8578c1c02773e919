/* Prediction, shared by both halves of the codec: integers only, the same on every machine
 * (SPEC.md, "Prediction"). */
#include "ff_codec_local.h"

static int32_t clamp_height(int32_t sum, int shift)
{
    if (sum < 0) return 0;
    sum >>= shift;
    return sum > UINT16_MAX ? UINT16_MAX : sum;
}

/* Predicts the sample half-way between known[i] and known[i+1] of a line of `cells`+1 known
 * samples, which are `step` apart in memory. The line read backwards gives the same value, so that
 * neighbours whose axes run against each other agree. */
static int32_t predict_middle(const uint16_t *known, uint32_t step, uint32_t i, uint32_t cells)
{
    int32_t a = known[i * step], b = known[(i + 1) * step];

    FF_ASSERT(i < cells && (cells & (cells - 1)) == 0);
    if (cells == 1) return (a + b + 1) >> 1;
    if (i == 0) return clamp_height(7 * a + 10 * b - known[2 * step] + 8, 4);
    if (i == cells - 1) return clamp_height(7 * b + 10 * a - known[(i - 1) * step] + 8, 4);
    return clamp_height(9 * (a + b) - known[(i - 1) * step] - known[(i + 2) * step] + 8, 4);
}

/* Makes the odd points of one line; `stride` is the distance of its points in memory. */
static void predict_line(uint16_t *grid, uint32_t first, uint32_t stride, uint32_t cells,
                         ff_sample_fn sample, void *context)
{
    FF_ASSERT(first + 2 * cells * stride < FF_REFINED_HEIGHTS_MAX);
    for (uint32_t i = 0; i < cells; i++) {
        uint32_t at = first + (2 * i + 1) * stride;
        grid[at] = sample(context, at, predict_middle(grid + first, 2 * stride, i, cells));
    }
}

/* Predicts a centre: three parts Coons patch, (2 * cross - corners) / 4, to one part mean of the
 * cross. On three DEMs this was the cheapest of eight mixes. */
static int32_t predict_centre(const uint16_t *p, uint32_t dx, uint32_t dy)
{
    const uint16_t *south = p - dy, *north = p + dy;
    int32_t cross = south[0] + north[0] + *(p - dx) + p[dx];
    int32_t corners = *(south - dx) + south[dx] + *(north - dx) + north[dx];

    return clamp_height(7 * cross - 3 * corners + 8, 4);
}

/* One doubling of resolution in place: grid points at even multiples of `stride` are known, points
 * at odd multiples are made. */
static void predict_doubling(uint16_t *grid, uint32_t side, uint32_t stride, ff_sample_fn sample,
                             void *context)
{
    uint32_t cells = (side - 1) / (2 * stride), row = side * stride;

    FF_ASSERT(stride >= 1 && cells >= 1 && cells * 2 * stride == side - 1);
    for (uint32_t j = 0; j <= cells; j++)
        predict_line(grid, 2 * j * row, stride, cells, sample, context);
    for (uint32_t i = 0; i <= cells; i++)
        predict_line(grid, 2 * i * stride, row, cells, sample, context);
    for (uint32_t j = 0; j < cells; j++) {
        for (uint32_t i = 0; i < cells; i++) {
            uint32_t at = (2 * j + 1) * row + (2 * i + 1) * stride;
            grid[at] = sample(context, at, predict_centre(grid + at, stride, row));
        }
    }
}

void ff_predict_root(const ff_terrain_info *info, uint16_t *grid, ff_sample_fn sample,
                     void *context)
{
    for (uint32_t stride = 1u << info->node_log2; stride > 1; stride /= 2)
        predict_doubling(grid, ff_node_side(info), stride / 2, sample, context);
}

void ff_predict_refinement(const ff_terrain_info *info, const uint16_t *parent, uint16_t *grid,
                           ff_sample_fn sample, void *context)
{
    uint32_t node_side = ff_node_side(info), side = ff_refined_side(info);

    FF_ASSERT(side == 2 * node_side - 1);
    for (uint32_t j = 0; j < node_side; j++)
        for (uint32_t i = 0; i < node_side; i++)
            grid[2 * j * side + 2 * i] = parent[j * node_side + i];
    predict_doubling(grid, side, 1, sample, context);
}

uint32_t ff_corner_at(const ff_terrain_info *info, uint32_t corner)
{
    uint32_t side = ff_node_side(info);

    FF_ASSERT(corner < FF_CORNERS);
    return (corner & 1u) * (side - 1) + (corner >> 1) * side * (side - 1);
}
