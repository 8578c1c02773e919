/* Strips under a projector: what of a triangle it can reach.
 *
 * A triangle beside the picture is drawn without it, or not at all. One that reaches behind the
 * projector, or so far beside it that its corners have no s and t, is drawn without it, and then
 * its part within the picture over that: parts have corners of their own, which leave cracks to
 * their neighbours. */
#include "soft_edge.h"

/* How the triangles of a draw are drawn. */
typedef struct ways {
    soft_paint bare, thrown, over;
} ways;

static inline void use(soft_state *state, const soft_paint *paint)
{
    if (state->paint.thrown == paint->thrown && state->paint.alpha_test == paint->alpha_test)
        return;
    state->paint = *paint;
    soft_choose_span(state);
}

static inline int first_row(const soft_vertex *vertex) { return soft_first_row(vertex->y); }

/* By how much to shift down what is below 2^32, so that it takes 16 bits. */
static inline int to_16_bits(uint32_t any)
{
    int lead = soft_leading_zeros(any);
    return lead < 16 ? 16 - lead : 0;
}

/* 1 when s and t may be interpolated linearly, because that is off by at most a quarter of a texel:
 * with r = greatest c * w / least c * w it is off by (r - 1)/4 of their largest difference. */
static int is_flat(const soft_vertex *a, const soft_vertex *b, const soft_vertex *c)
{
    int c_shift = to_16_bits((uint32_t)(a->c | b->c | c->c)),
        w_shift = to_16_bits(a->w | b->w | c->w);
    uint32_t least = ((uint32_t)a->c >> c_shift) * (a->w >> w_shift), most = least,
             of_b = ((uint32_t)b->c >> c_shift) * (b->w >> w_shift),
             of_c = ((uint32_t)c->c >> c_shift) * (c->w >> w_shift);
    int32_t low_s = a->s, high_s = a->s, low_t = a->t, high_t = a->t;
    C3D_ASSERT(a->c >= SOFT_THROWN_C && b->c >= SOFT_THROWN_C && c->c >= SOFT_THROWN_C);
    least = of_b < least ? of_b : least, most = of_b > most ? of_b : most;
    least = of_c < least ? of_c : least, most = of_c > most ? of_c : most;
    low_s = b->s < low_s ? b->s : low_s, high_s = b->s > high_s ? b->s : high_s;
    low_s = c->s < low_s ? c->s : low_s, high_s = c->s > high_s ? c->s : high_s;
    low_t = b->t < low_t ? b->t : low_t, high_t = b->t > high_t ? b->t : high_t;
    low_t = c->t < low_t ? c->t : low_t, high_t = c->t > high_t ? c->t : high_t;
    int32_t range = high_s - low_s > high_t - low_t ? high_s - low_s : high_t - low_t;
    C3D_ASSERT(range >= 0 && range <= 1 << 29);
    return (uint64_t)(most - least) * (uint32_t)(range >> 13) <= (uint64_t)least * 8;
}

/* In the ways of small triangles, where one will do; 0 where none does. */
static int draw_small(soft_state *state, const soft_vertex *a, const soft_vertex *b,
                      const soft_vertex *c)
{
    if (!is_flat(a, b, c)) return 0;
    state->off_texture = ((a->off | b->off | c->off) & SOFT_OFF_SIDES) != 0;
    int tiny = !state->off_texture && state->span == soft_span_thrown && !state->paint.fog;
    int drawn = (tiny && soft_thrown_tiny(state, a, b, c)) || soft_small(state, a, b, c);
    state->off_texture = 1;
    return drawn;
}

void soft_thrown_triangle(soft_state *state, const soft_vertex *a, const soft_vertex *b,
                          const soft_vertex *c)
{
    const soft_vertex *swap;
    C3D_ASSERT(!((a->out | b->out | c->out) & SOFT_MUST_CLIP));
    C3D_ASSERT(!((a->off | b->off | c->off) & SOFT_MUST_CUT));
    if (b->y < a->y) swap = a, a = b, b = swap;
    if (c->y < b->y) swap = b, b = c, c = swap;
    if (b->y < a->y) swap = a, a = b, b = swap;
    if (first_row(a) == first_row(c)) return; /* between two rows of centres */
    int32_t left = a->x < b->x ? a->x : b->x, right = a->x < b->x ? b->x : a->x;
    if (c->x < left) left = c->x;
    if (c->x > right) right = c->x;
    if (soft_first_row(left) == soft_first_row(right)) return; /* between two columns of centres */
    if (draw_small(state, a, b, c)) return;
    int64_t area = (int64_t)(c->x - a->x) * (b->y - a->y) - (int64_t)(b->x - a->x) * (c->y - a->y);
    if (area != 0) soft_thrown_rows(state, a, b, c, area);
}

static void draw_bare(soft_state *state, const ways *by, const soft_vertex *a, const soft_vertex *b,
                      const soft_vertex *c)
{
    use(state, &by->bare);
    if ((a->out | b->out | c->out) & SOFT_MUST_CLIP)
        soft_clip(state, a, b, c);
    else if (!state->tiny_colours || !soft_tiny_colours(state, a, b, c))
        soft_triangle(state, a, b, c);
}

static void draw_thrown(soft_state *state, const soft_vertex *a, const soft_vertex *b,
                        const soft_vertex *c)
{
    if ((a->out | b->out | c->out) & SOFT_MUST_CLIP)
        soft_clip(state, a, b, c);
    else
        soft_thrown_triangle(state, a, b, c);
}

static void draw(soft_state *state, const ways *by, const soft_vertex *a, const soft_vertex *b,
                 const soft_vertex *c)
{
    int over = by->thrown.alpha_test, beside = a->off & b->off & c->off & SOFT_OFF_SIDES,
        cut = (a->off | b->off | c->off) & SOFT_MUST_CUT;
    if (a->out & b->out & c->out) return;
    if ((beside || cut) && !over) draw_bare(state, by, a, b, c);
    if (beside) return;
    use(state, cut ? &by->over : &by->thrown);
    if (cut)
        soft_clip_thrown(state, a, b, c);
    else
        draw_thrown(state, a, b, c);
}

void soft_thrown_strip(soft_state *state, const uint16_t *indices, uint32_t count)
{
    C3D_ASSERT(count >= 3 && state->paint.thrown && state->paint.texture);
    ways by = { state->paint, state->paint, state->paint };
    by.bare.thrown = 0;
    by.bare.texture = NULL;
    by.over.alpha_test = by.over.white = 1;
    state->off_texture = 1; /* pixels may lie off it, but for those that draw_small finds */
    const soft_vertex *vertices = state->vertices, *a, *b = &vertices[indices[0]],
                      *c = &vertices[indices[1]];
    int32_t row_a, row_b = first_row(b), row_c = first_row(c);
    for (uint32_t i = 2; i < count; i++) {
        a = b, b = c, c = &vertices[indices[i]];
        row_a = row_b, row_b = row_c, row_c = first_row(c);
        if (row_a == row_b && row_b == row_c) continue; /* between two rows of centres */
        if (a == b || b == c || a == c) continue;
        draw(state, &by, a, b, c);
    }
}
