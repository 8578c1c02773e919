/* Prediction, shared by both halves of the codec: integers only, the same on every machine
 * (SPEC.md, "Prediction"). */
#include "ff_codec_local.h"

static int32_t clamp_height(int32_t sum, int shift)
{
    if (sum < 0) return 0;
    sum >>= shift;
    return sum > UINT16_MAX ? UINT16_MAX : sum;
}

/* The line read backwards gives the same value, so that neighbours whose axes run against each
 * other agree. */
int32_t ff_predict_middle(const uint16_t *known, uint32_t step, uint32_t i, uint32_t cells)
{
    int32_t a = known[i * step], b = known[(i + 1) * step];

    FF_ASSERT(i < cells && (cells & (cells - 1)) == 0);
    if (cells == 1) return (a + b + 1) >> 1;
    if (i == 0) return clamp_height(7 * a + 10 * b - known[2 * step] + 8, 4);
    if (i == cells - 1) return clamp_height(7 * b + 10 * a - known[(i - 1) * step] + 8, 4);
    return clamp_height(9 * (a + b) - known[(i - 1) * step] - known[(i + 2) * step] + 8, 4);
}

/* Makes the first `count` odd points of one line; `stride` is the distance of its points in
 * memory. */
static void predict_line(uint16_t *grid, uint32_t first, uint32_t stride, uint32_t cells,
                         uint32_t count, ff_sample_fn sample, void *context)
{
    FF_ASSERT(first + 2 * cells * stride < FF_REFINED_HEIGHTS_MAX && count <= cells);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t at = first + (2 * i + 1) * stride;
        grid[at] = sample(context, at, ff_predict_middle(grid + first, 2 * stride, i, cells));
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

/* ---- padding ---- */

uint32_t ff_coded_points(uint32_t stride, uint32_t ground)
{
    return ground > stride ? (ground - stride - 1) / (2 * stride) + 1 : 0;
}

uint32_t ff_last_point(uint32_t stride, uint32_t ground)
{
    FF_ASSERT(stride > 0 && (stride & (stride - 1)) == 0);
    return (ground + 2 * stride - 1) & ~(2 * stride - 1);
}

/* The column, or row, whose height stands in column `at` after a doubling. */
static uint32_t shown_at(uint32_t at, uint32_t stride, uint32_t ground, uint32_t last)
{
    return at > last || ((at / stride & 1u) && at >= ground) ? last : at;
}

void ff_repeat_last(uint16_t *grid, uint32_t side, uint32_t stride, ff_cells cells)
{
    uint32_t last_x = ff_last_point(stride, cells.columns),
             last_y = ff_last_point(stride, cells.rows);

    FF_ASSERT(last_x < side && last_y < side);
    if (cells.columns == side - 1 && cells.rows == side - 1) return;
    for (uint32_t y = 0; y < side; y += stride) {
        const uint16_t *from = grid + shown_at(y, stride, cells.rows, last_y) * side;
        for (uint32_t x = 0; x < side; x += stride)
            grid[y * side + x] = from[shown_at(x, stride, cells.columns, last_x)];
    }
}

static uint32_t coded_in_doubling(uint32_t stride, ff_cells cells)
{
    uint32_t columns = ff_coded_points(stride, cells.columns),
             rows = ff_coded_points(stride, cells.rows);

    return columns * (ff_last_point(stride, cells.rows) / (2 * stride) + 1) +
           rows * (ff_last_point(stride, cells.columns) / (2 * stride) + 1) + columns * rows;
}

/* ---- grids ---- */

/* One doubling of resolution in place: grid points at even multiples of `stride` are known, points
 * at odd multiples are made. */
static void predict_doubling(uint16_t *grid, uint32_t side, uint32_t stride, ff_cells ground,
                             ff_sample_fn sample, void *context)
{
    uint32_t cells = (side - 1) / (2 * stride), row = side * stride;
    uint32_t columns = ff_coded_points(stride, ground.columns),
             rows = ff_coded_points(stride, ground.rows);

    FF_ASSERT(stride >= 1 && cells >= 1 && cells * 2 * stride == side - 1);
    for (uint32_t j = 0; j <= ff_last_point(stride, ground.rows) / (2 * stride); j++)
        predict_line(grid, 2 * j * row, stride, cells, columns, sample, context);
    for (uint32_t i = 0; i <= ff_last_point(stride, ground.columns) / (2 * stride); i++)
        predict_line(grid, 2 * i * stride, row, cells, rows, sample, context);
    for (uint32_t j = 0; j < rows; j++) {
        for (uint32_t i = 0; i < columns; i++) {
            uint32_t at = (2 * j + 1) * row + (2 * i + 1) * stride;
            grid[at] = sample(context, at, predict_centre(grid + at, stride, row));
        }
    }
    ff_repeat_last(grid, side, stride, ground);
}

ff_cells ff_cells_of(ff_cells cells, uint32_t side)
{
    FF_ASSERT(cells.columns < side && cells.rows < side);
    if (!cells.columns || !cells.rows) cells.columns = cells.rows = (uint8_t)(side - 1);
    return cells;
}

uint32_t ff_coded_count(const ff_terrain_info *info, ff_cells cells, int root)
{
    uint32_t side = root ? ff_node_side(info) : ff_refined_side(info), count = FF_CORNERS;

    cells = ff_cells_of(cells, side);
    if (!root) return coded_in_doubling(1, cells);
    for (uint32_t stride = (side - 1) / 2; stride >= 1; stride /= 2)
        count += coded_in_doubling(stride, cells);
    FF_ASSERT(count <= side * side);
    return count;
}

void ff_spread_parent(const ff_terrain_info *info, const uint16_t *parent, uint16_t *grid)
{
    uint32_t node_side = ff_node_side(info), side = ff_refined_side(info);

    FF_ASSERT(side == 2 * node_side - 1);
    for (uint32_t j = 0; j < node_side; j++)
        for (uint32_t i = 0; i < node_side; i++)
            grid[2 * j * side + 2 * i] = parent[j * node_side + i];
}

void ff_interpolate(const ff_terrain_info *info, ff_cells cells, unsigned way,
                    const uint16_t *parent, uint16_t *grid, void *room, ff_sample_fn sample,
                    void *context)
{
    uint32_t side = parent ? ff_refined_side(info) : ff_node_side(info);

    (void)room, (void)way;
    cells = ff_cells_of(cells, side);
    if (parent) ff_spread_parent(info, parent, grid);
    for (uint32_t stride = parent ? 1 : (side - 1) / 2; stride >= 1; stride /= 2)
        predict_doubling(grid, side, stride, cells, sample, context);
}

uint32_t ff_corner_at(const ff_terrain_info *info, uint32_t corner)
{
    uint32_t side = ff_node_side(info);

    FF_ASSERT(corner < FF_CORNERS);
    return (corner & 1u) * (side - 1) + (corner >> 1) * side * (side - 1);
}
