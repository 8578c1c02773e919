/* Large triangles under a texture alone: rows of one segment each wherever linear interpolation
 * will do. */
#include "soft_planes.h"

/* Makes state->segment a whole row, interpolated linearly; 0 when that would be off by more than a
 * quarter of a texel (see segment_length in soft_perspective.c). */
static int measure_row(soft_state *state, const soft_planes *planes, const soft_walk *walk)
{
    soft_segment *segment = &state->segment;
    int32_t apart = walk->to - walk->from - 1;
    int lead;
    uint32_t w = soft_plane_at(&planes->of[SOFT_PLANE_W], walk->row, walk->from),
             w_end = w + planes->of[SOFT_PLANE_W].across * (uint32_t)apart;
    uint32_t s_part = soft_plane_at(&planes->of[SOFT_S], walk->row, walk->from),
             t_part = soft_plane_at(&planes->of[SOFT_T], walk->row, walk->from);
    int32_t reciprocal = soft_one_over_w(state, w, &lead);
    int32_t s = soft_quotient(s_part, reciprocal, lead),
            t = soft_quotient(t_part, reciprocal, lead);
    reciprocal = soft_one_over_w(state, w_end, &lead);
    int32_t s_change =
        soft_quotient(s_part + planes->of[SOFT_S].across * (uint32_t)apart, reciprocal, lead) - s;
    int32_t t_change =
        soft_quotient(t_part + planes->of[SOFT_T].across * (uint32_t)apart, reciprocal, lead) - t;
    int32_t least = (int32_t)(w < w_end ? w : w_end), w_change = (int32_t)(w_end - w);
    /* at least the larger of both changes, less than twice it */
    int32_t far = (s_change ^ s_change >> 31) | (t_change ^ t_change >> 31);
    if (apart >= SOFT_EDGE_TABLE || soft_high(far, w_change ^ w_change >> 31) > least >> 16)
        return 0;
    C3D_ASSERT(apart >= 0 && least >= 0);
    segment->first = (uint32_t)(walk->row * state->width + walk->from);
    segment->count = (uint32_t)(apart + 1);
    segment->w = soft_depth_of(w, planes->w_shift);
    segment->value[SOFT_S] = s;
    segment->value[SOFT_T] = t;
    segment->step[SOFT_S] = soft_per_pixel(state, s_change, apart);
    segment->step[SOFT_T] = soft_per_pixel(state, t_change, apart);
    return 1;
}

/* Keeps, for each row, the longest run of covered pixels found so far: soft_find_open_parts need
 * not look for open pixels there. */
static inline void note_covered(soft_state *state, const soft_walk *walk)
{
    C3D_ASSERT(walk->from < walk->to && walk->to <= state->width && walk->row < state->height);
    soft_part *covered = &state->covered[walk->row];
    int32_t from = walk->from, to = walk->to;
    if (from <= covered->to && to >= covered->from) {
        if (from < covered->from) covered->from = (uint16_t)from;
        if (to > covered->to) covered->to = (uint16_t)to;
    } else if (to - from > covered->to - covered->from) {
        covered->from = (uint16_t)from;
        covered->to = (uint16_t)to;
    }
}

void soft_texture_rows(soft_state *state, const soft_planes *planes, soft_walk *walk)
{
    C3D_ASSERT(planes->first == SOFT_S && planes->last == SOFT_T);
    int covers = state->paint.depth == SOFT_DEPTH_TEST && !state->paint.alpha_test;
    do {
        if (covers) note_covered(state, walk);
        if (measure_row(state, planes, walk))
            state->span(state, &state->segment);
        else
            soft_segments(state, planes, walk);
    } while (soft_walk_next(state, walk) && soft_walk_to_pixels(state, walk, 1));
}
