/* The limit of triangles: when the cut that view and quality ask for has more in view than the
 * quality allows, the quality in force is a coarser one. There are steps of a sixteenth of an
 * octave: the first DETAIL_STEPS make the measure coarser, the others shorten the reach, too, so
 * that the last one leaves the roots round the viewer and nothing else. A selection tries steps,
 * from the last one's on, until the finest that keeps the limit is found; one that uses nearly all
 * of the limit is good enough, so most selections try one. The same views in the same order give
 * the same cuts, and a still camera keeps its cut.
 *
 * What has not come yet is not drawn and not counted, but once it is here it will be: so wishes
 * have a bound of their own, by how many triangles they will bring. */
#include "ff_tree_local.h"
#include "ff_spread.h"

#define OCTAVE       16
#define DETAIL_STEPS (5 * OCTAVE)
#define STEPS        (DETAIL_STEPS + 12 * OCTAVE)
#define TRIES_MAX    16
/* Triangles grow at least with the root of detail and, nearly always, at most with its square. */
#define COARSER_Q8 (256 * 3 / 2 / OCTAVE)
#define FINER_Q8   (256 * 2 / OCTAVE)
#define RESTS      16 /* selections after a finer step was tried in vain, before it is tried again */

FF_STATIC_ASSERT(STEPS <= UINT16_MAX);

/* 2^(part / OCTAVE), Q16 */
static const uint32_t root_q16[OCTAVE] = { 65536,  68438,  71468,  74632, 77936,  81386,
                                           84990,  88752,  92682,  96785, 101070, 105545,
                                           110218, 115098, 120194, 125515 };

static int32_t scaled(int32_t value, int step, int coarser)
{
    FF_ASSERT(value >= 0 && step >= 0 && step <= STEPS);
    uint64_t whole = (uint64_t)value << 16, root = root_q16[step % OCTAVE];
    uint64_t result = coarser ? ((uint64_t)value * root >> 16) << (step / OCTAVE)
                              : whole / root >> (step / OCTAVE);
    return result > INT32_MAX ? INT32_MAX : (int32_t)result;
}

/* Puts the step's quality into force. */
static void apply(ff_tree *tree)
{
    const ff_quality *finest = &tree->finest;
    int step = tree->limit_step, shorter = step > DETAIL_STEPS ? step - DETAIL_STEPS : 0;
    tree->quality.error_px_q8 = scaled(finest->error_px_q8, step, 1);
    tree->quality.c_q8 = scaled(finest->c_q8, step, 0);
    int32_t view_wu = scaled(finest->view_wu, shorter, 0);
    if (view_wu == tree->quality.view_wu) return;
    tree->quality.view_wu = view_wu;
    ff_window_make(tree);
}

void ff_limit_begin(ff_tree *tree, ff_limit_search *search)
{
    if (!tree->quality.triangles_max) tree->limit_step = 0;
    *search = (ff_limit_search){ .over = -1, .under = STEPS + 1 };
    apply(tree);
}

/* Steps between two numbers of triangles. */
static int steps_between(uint32_t more, uint32_t less, int step_q8)
{
    FF_ASSERT(more >= less && less > 0);
    return (ff_log2_q8(more) - ff_log2_q8(less)) / step_q8 + 1;
}

/* The step to try after one that passes the limit. */
static int coarser_step(const ff_tree *tree, const ff_limit_search *search)
{
    int step = tree->limit_step;
    if (search->under <= STEPS)
        return search->tries >= TRIES_MAX ? search->under : (step + search->under + 1) / 2;
    step += steps_between(tree->stats.triangles, tree->quality.triangles_max, COARSER_Q8)
            << search->tries / 4;
    return step < STEPS ? step : STEPS;
}

/* The step to try after one that keeps the limit, or the same one: it is good enough. */
static int finer_step(ff_tree *tree, const ff_limit_search *search)
{
    int step = tree->limit_step;
    uint32_t limit = tree->quality.triangles_max, used = tree->stats.triangles;
    if (step == 0 || used >= limit - limit / 8 || search->tries >= TRIES_MAX) return step;
    if (search->over >= 0) {
        if (search->over + 1 >= step) tree->limit_rests = RESTS;
        return search->over + 1 >= step ? step : (search->over + step) / 2;
    }
    if (tree->limit_rests && used >= limit - limit / 4) {
        tree->limit_rests--;
        return step;
    }
    step -= steps_between(limit, used ? used : 1, FINER_Q8);
    return step > 0 ? step : 0;
}

int ff_limit_again(ff_tree *tree, ff_limit_search *search)
{
    int step = tree->limit_step, next;
    if (!tree->quality.triangles_max) return 0;
    if (tree->stats.triangles > tree->quality.triangles_max) {
        if (step == STEPS) return 0;
        search->over = step > search->over ? step : search->over;
        next = coarser_step(tree, search);
    } else {
        search->under = step < search->under ? step : search->under;
        next = finer_step(tree, search);
    }
    search->tries++;
    tree->limit_step = (uint16_t)next;
    if (next != step) apply(tree);
    return next != step;
}

/* ---- wishes ---- */

#define BUCKETS       128
#define BUCKET_Q8     32         /* an eighth of an octave of value */
#define ONE_LOG_Q8    (16 * 256) /* of FF_VALUE_ONE */
#define LEVEL_BUCKETS 11         /* a level on, ground is off by 2.6 times less, or so */
#define FINER_LEVELS  4          /* of what has not come, looked forward to */

static unsigned bucket_of(uint32_t value)
{
    FF_ASSERT(value > FF_VALUE_ONE);
    unsigned bucket = (unsigned)(ff_log2_q8(value) - ONE_LOG_Q8) / BUCKET_Q8;
    return bucket < BUCKETS ? bucket : BUCKETS - 1;
}

/* How many children of a node are in view, by the quarters of its box: all of them when it is far
 * away, one when it is seen out of the middle of it. */
static uint32_t quarters_in_view(const ff_tree *tree, const ff_box *box)
{
    const int64_t middle[2] = { box->lo[0] + (box->hi[0] - box->lo[0]) / 2,
                                box->lo[1] + (box->hi[1] - box->lo[1]) / 2 };
    uint32_t count = 0;
    for (unsigned q = 0; q < 4; q++) {
        ff_box quarter = *box;
        for (unsigned axis = 0; axis < 2; axis++)
            *(q >> axis & 1u ? &quarter.lo[axis] : &quarter.hi[axis]) = middle[axis];
        count += !ff_box_beyond_view(tree, &quarter) && ff_box_in_view(tree, &quarter);
    }
    return count ? count : 1;
}

/* Nodes that splits of each value bring into view: those here already, or those to come. Returns
 * how many. */
static uint32_t count_splits(const ff_tree *tree, int here, uint32_t nodes[BUCKETS])
{
    uint32_t count = 0;
    for (uint32_t level = 0; level < FF_LEVELS_MAX; level++) {
        for (uint32_t slot = tree->want_head[level]; slot != FF_SLOT_NONE;
             slot = tree->node[slot].want_next) {
            const ff_node *node = &tree->node[slot];
            ff_box box;
            if (here ? !(node->flags & FF_NODE_SPLIT) : ff_node_has_children(node)) continue;
            ff_node_box(tree, node, &box);
            if (!ff_node_seen(tree, node, &box)) continue;
            unsigned bucket = bucket_of(node->value), levels = here ? 1 : FINER_LEVELS;
            uint32_t quarters = quarters_in_view(tree, &box);
            for (unsigned k = 0;
                 k < levels && level + k + 1 < ff_terrain_levels(ff_ground_of(tree, node->key));
                 k++) {
                uint32_t more = k ? 3 * quarters << 2 * (k - 1) : quarters - 1;
                nodes[bucket] += more;
                count += more;
                if (bucket < LEVEL_BUCKETS) break;
                bucket -= LEVEL_BUCKETS;
            }
        }
    }
    return count;
}

void ff_limit_wishes(ff_tree *tree)
{
    uint32_t nodes[BUCKETS] = { 0 }, limit = tree->quality.triangles_max;
    unsigned bucket = 0;
    tree->wish_value = FF_VALUE_ONE;
    if (!limit) return;
    uint32_t to_come = count_splits(tree, 0, nodes), each = 2u << 2 * tree->ground->node_log2;
    uint64_t triangles = tree->stats.triangles + (uint64_t)to_come * each;
    if (!to_come || triangles <= limit) return;
    (void)count_splits(tree, 1, nodes);
    for (; bucket < BUCKETS && triangles > limit; bucket++) {
        uint64_t less = (uint64_t)nodes[bucket] * each;
        triangles -= less < triangles ? less : triangles;
    }
    uint64_t value = (uint64_t)FF_VALUE_ONE << bucket / 8;
    value = value * root_q16[bucket % 8 * 2] >> 16;
    tree->wish_value = value < FF_VALUE_MAX ? (uint32_t)value : FF_VALUE_MAX;
}
