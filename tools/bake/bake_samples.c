#include "bake_samples.h"

#define PIECE 2048 /* samples read at once: more than a block's row has */

int bake_samples_pick(const bake_samples *samples, uint32_t row, uint32_t column,
                      uint32_t apart_log2, size_t count, uint16_t *heights, uint8_t *marks)
{
    uint16_t height[PIECE];
    uint8_t mark[PIECE];
    uint64_t last = samples->width - 1, from = 0, held = 0; /* in `height`, from a column on */
    if (!apart_log2 && column + (uint64_t)count <= last + 1)
        return samples->read(samples, row, column, (uint32_t)count, heights, marks);
    for (size_t i = 0; i < count; i++) {
        uint64_t at = column + ((uint64_t)i << apart_log2);
        if (at > last) at = last;
        if (!held || at >= from + held) {
            from = at;
            held = last + 1 - at < PIECE ? last + 1 - at : PIECE;
            uint64_t wanted = ((uint64_t)(count - i) << apart_log2) + 1;
            if (held > wanted) held = wanted;
            if (samples->read(samples, row, (uint32_t)from, (uint32_t)held, height,
                              marks ? mark : NULL))
                return -1;
        }
        heights[i] = height[at - from];
        if (marks) marks[i] = mark[at - from];
    }
    return 0;
}

/* The samples are the first part. */
static int read(const bake_samples *samples, uint32_t row, uint32_t column, uint32_t count,
                uint16_t *heights, uint8_t *marks)
{
    const bake_grid_samples *s = (const bake_grid_samples *)samples;
    if (bake_grid_read(s->heights, row, column, count, heights)) return -1;
    return marks && bake_grid_read(s->filled, row, column, count, marks) ? -1 : 0;
}

bake_grid_samples bake_samples_of(const bake_grid *heights, const bake_grid *filled)
{
    return (bake_grid_samples){ .samples = { heights->width, heights->height, filled->fd >= 0, read,
                                             NULL },
                                .heights = heights,
                                .filled = filled };
}
