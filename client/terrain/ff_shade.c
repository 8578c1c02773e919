/* Hypsometric ramp and hill shading in integers. */
#include "ff_shade.h"

#include "../../common3d/c3d_fixed.h"
#include "../../protocol/ff_assert.h"
#include "../../protocol/shape/ff_shape.h"

#include <stddef.h>

#define SLOPE_MAX_Q8 (64 << 8)
/* Steepness (rise over run) at which ground begins to turn to rock, and from which it is all rock.
 */
#define ROCK_FROM_Q8 160
#define ROCK_TO_Q8   420
/* A ridge of which nothing but its place is known: as steep and as lit as ridges mostly are. */
#define RIDGE_SLOPE_Q8 200
#define RIDGE_LIGHT_Q8 200
FF_STATIC_ASSERT(ROCK_FROM_Q8 < ROCK_TO_Q8 && ROCK_TO_Q8 < SLOPE_MAX_Q8);

static const uint8_t soil_at[][3] = {
    { 86, 125, 70 },  { 118, 148, 82 },  { 164, 168, 100 }, { 196, 172, 112 }, { 178, 140, 96 },
    { 150, 118, 92 }, { 148, 136, 126 }, { 184, 180, 176 }, { 232, 234, 238 }, { 250, 251, 253 },
};
#define RAMP_STEPS (sizeof soil_at / sizeof soil_at[0] - 1)
static const uint8_t rock[3] = { 128, 120, 112 };
static const uint8_t water[3] = { 62, 106, 150 };

/* Rise over run from twice the height difference per cell. */
static int32_t slope_q8(const ff_terrain_info *info, int32_t doubled, int32_t cell_wu)
{
    FF_ASSERT(cell_wu > 0 && doubled >= -UINT16_MAX && doubled <= UINT16_MAX);
    int64_t rise_wu = (int64_t)doubled * (int64_t)info->hscale_q24 / 65536;
    int64_t slope = rise_wu * 128 / cell_wu;
    return slope > SLOPE_MAX_Q8    ? SLOPE_MAX_Q8
           : slope < -SLOPE_MAX_Q8 ? -SLOPE_MAX_Q8
                                   : (int32_t)slope;
}

static void ground_colour(const int32_t ramp[2], int32_t height, uint32_t steep_q8,
                          int32_t colour[3])
{
    int32_t lo = ramp[0];
    uint32_t span = ramp[1] > lo ? (uint32_t)(ramp[1] - lo) : 1u,
             above = height > lo ? (uint32_t)(height - lo) : 0;
    uint32_t at_q8 = above >= span ? RAMP_STEPS << 8
                                   : (uint32_t)(((uint64_t)above * RAMP_STEPS << 8) / span);
    uint32_t step = at_q8 >> 8, part = at_q8 & 255u;
    if (step >= RAMP_STEPS) {
        step = RAMP_STEPS - 1;
        part = 256;
    }
    uint32_t bare = steep_q8 <= ROCK_FROM_Q8 ? 0
                    : steep_q8 >= ROCK_TO_Q8
                        ? 256
                        : (steep_q8 - ROCK_FROM_Q8) * 256 / (ROCK_TO_Q8 - ROCK_FROM_Q8);
    FF_ASSERT(step < RAMP_STEPS && part <= 256 && bare <= 256);
    for (unsigned c = 0; c < 3; c++) {
        int32_t soil = (int32_t)(soil_at[step][c] * (256 - part) + soil_at[step + 1][c] * part) /
                       256;
        colour[c] = (soil * (int32_t)(256 - bare) + rock[c] * (int32_t)bare) / 256;
    }
}

static int is_water(const ff_terrain_info *info, uint32_t height)
{
    int32_t lowest_wu = ff_height_wu(info, info->height_min), step_wu = ff_steps_wu(info, 1) + 1;
    FF_ASSERT(step_wu > 0 && step_wu <= 1 << 15);
    return height <= info->height_min && lowest_wu > -step_wu && lowest_wu < step_wu;
}

/* Light from the north-west at 45 degrees: direction (-1/2, 1/2, 1/sqrt 2). Level ground gets
 * 256. */
static int32_t light_q8(int32_t east_q8, int32_t north_q8)
{
    int64_t length = c3d_isqrt64(
        (uint64_t)(65536 + (int64_t)east_q8 * east_q8 + (int64_t)north_q8 * north_q8));
    /* Q16: slopes of 1/2, and 181/256 for 1/sqrt 2 */
    int64_t facing = (int64_t)(east_q8 - north_q8) * 128 + 181 * 256;
    FF_ASSERT(length >= 256);
    int64_t cosine_q8 = facing / length;
    FF_ASSERT(cosine_q8 <= 256);
    if (cosine_q8 < 0) cosine_q8 = 0;
    return (int32_t)(90 + cosine_q8 * 166 / 181);
}

static void lit(const int32_t colour[3], int32_t light, uint8_t rgba[4])
{
    for (unsigned c = 0; c < 3; c++) {
        int32_t value = colour[c] * light / 256;
        FF_ASSERT(value >= 0);
        rgba[c] = (uint8_t)(value > 255 ? 255 : value);
    }
    rgba[3] = 255;
}

void ff_shade_ridge(const ff_terrain_info *info, int32_t height_wu, uint8_t rgba[4])
{
    int64_t step = (((int64_t)height_wu - info->hoffset_wu) << 16) / (int64_t)info->hscale_q24;
    const int32_t ramp[2] = { info->height_min, info->height_max };
    int32_t colour[3];
    int32_t height = (int32_t)(step < 0 ? 0 : step > UINT16_MAX ? UINT16_MAX : step);
    ground_colour(ramp, height, RIDGE_SLOPE_Q8, colour);
    lit(colour, RIDGE_LIGHT_Q8, rgba);
}

void ff_shade(const ff_shade_grid *grid, uint32_t i, uint32_t j, uint8_t rgba[4])
{
    const ff_terrain_info *info = grid->info;
    size_t stride = ff_node_side(info) + 2;
    FF_ASSERT(i + 2 < stride && j + 2 < stride);
    const uint16_t *here = grid->framed + (j + 1) * stride + i + 1;
    int32_t slope[2] = { slope_q8(info, here[1] - *(here - 1), grid->cell_wu),
                         slope_q8(info, here[stride] - *(here - stride), grid->cell_wu) };
    ff_shape_slopes(info, grid->key, slope);
    int32_t east = slope[0], north = slope[1];
    int32_t colour[3] = { water[0], water[1], water[2] };
    if (!is_water(info, *here)) {
        int64_t steep_square = (int64_t)east * east + (int64_t)north * north;
        ground_colour(grid->ramp, *here, c3d_isqrt64((uint64_t)steep_square), colour);
    }
    lit(colour, light_q8(east, north), rgba);
}
