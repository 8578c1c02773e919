#include "ff_wear.h"

#include "../../protocol/ff_assert.h"

#define ALL          (~(ff_squares)0)
#define TEXEL_Q8_MAX (INT64_C(1) << 54)

FF_STATIC_ASSERT(FF_IMAGE_DEPTH_MAX <= FF_SQUARES_LOG2); /* a square for each image at least */

/* ---- how large texels are ---- */

static int64_t outside(int64_t lo, int64_t hi) { return lo > 0 ? lo : hi < 0 ? -hi : 0; }

static int64_t larger(int64_t a, int64_t b) { return a > b ? a : b; }

/* How much of itself ground in a box shows, of 65536: 1 / d of how high the viewer is above its
 * lowest place, and of what it may lean towards him. */
static uint32_t shown_q16(const ff_box *box, int64_t aside, int64_t distance)
{
    FF_ASSERT(distance >= 1 && aside >= 0);
    int64_t edge = larger(box->hi[0] - box->lo[0], 1), rise = box->hi[2] - box->lo[2];
    int64_t up = larger(-box->lo[2], box->hi[2]);
    int64_t shown = larger(up, 0) + c3d_muldiv64(rise, aside, edge);
    return shown >= distance ? 65536 : (uint32_t)((shown << 16) / distance);
}

/* The side of a texel of a root's image at the nearest place of a box, pixels Q8: one of level l
 * has that / 2^l. */
static int64_t texel_px_q8(const ff_terrain_info *info, const ff_texel_look *look,
                           const ff_box *box)
{
    int64_t aside = c3d_length64(outside(box->lo[0], box->hi[0]), outside(box->lo[1], box->hi[1]),
                                 0);
    int64_t distance = c3d_length64(aside, outside(box->lo[2], box->hi[2]), 0);
    if (distance < 1) distance = 1;
    int64_t across_q8 = (int64_t)ff_node_edge_wu(info, 0) * look->focal_q8 / distance >>
                        info->texture_log2;
    if (across_q8 > TEXEL_Q8_MAX) across_q8 = TEXEL_Q8_MAX;
    if (look->across) return across_q8;
    return across_q8 * c3d_isqrt64(shown_q16(box, aside, distance)) >> 8;
}

/* 1 when texels of a level are larger than they should be. */
static int too_large(const ff_texel_look *look, int64_t root_px_q8, uint32_t level)
{
    FF_ASSERT(level <= FF_KEY_LEVEL_MAX);
    return root_px_q8 > (int64_t)look->texel_px_q8 << level;
}

/* ---- squares ---- */

ff_squares ff_wear_squares(unsigned node_log2, ff_key node, ff_key image)
{
    uint32_t depth = ff_key_level(image) - ff_key_level(node), within = (1u << depth) - 1;
    uint32_t side = (1u << ff_squares_log2(node_log2)) >> depth;
    uint32_t x = (ff_morton_x(ff_key_code(image)) & within) * side,
             y = (ff_morton_y(ff_key_code(image)) & within) * side;
    FF_ASSERT(ff_key_level(image) >= ff_key_level(node) && side > 0);
    ff_squares row = (((ff_squares)1 << side) - 1) << x, all = 0;
    for (uint32_t j = y; j < y + side; j++) all |= row << j * FF_SQUARES_ROW;
    return all;
}

/* ---- the cut ---- */

typedef struct chooser {
    const ff_terrain_info *info;
    const ff_texel_look *look;
    ff_key node;
    int64_t height_wu[2];
    uint32_t last; /* finest level */
    ff_wear *list;
    unsigned count;
} chooser;

/* 1 when texels of the level above an image's are too large somewhere on it. */
static int is_wanted(const chooser *c, ff_key image)
{
    FF_ASSERT(ff_key_level(image) >= 1);
    if (!ff_shape_has_ground(c->info, image)) return 0;
    ff_placed placed = ff_shape_put(c->info, &c->look->frame, image);
    ff_box box = ff_shape_box(c->info, image, &placed, c->height_wu, c->look->pos_wu);
    return too_large(c->look, texel_px_q8(c->info, c->look, &box), ff_key_level(image) - 1);
}

/* An image on the way down, its squares that none below it has, and its child that is next. */
typedef struct step {
    ff_key image;
    ff_squares squares;
    uint32_t quadrant;
} step;

static step step_to(const chooser *c, ff_key image)
{
    FF_ASSERT(ff_key_level(image) - ff_key_level(c->node) <= FF_IMAGE_DEPTH_MAX);
    return (step){ image, ff_wear_squares(c->info->node_log2, c->node, image), 0 };
}

/* The next child of an image that is wanted, or FF_KEY_NONE. */
static ff_key next_wanted(const chooser *c, step *at)
{
    FF_ASSERT(at->quadrant <= 4);
    while (ff_key_level(at->image) < c->last && at->quadrant < 4) {
        ff_key child = ff_key_child(at->image, at->quadrant++);
        if (is_wanted(c, child)) return child;
    }
    return FF_KEY_NONE;
}

/* Lists a node's own image and those below it; they come first. */
static void choose(chooser *c)
{
    step path[FF_IMAGE_DEPTH_MAX + 1];
    path[0] = step_to(c, c->node);
    for (int depth = 0; depth >= 0;) {
        ff_key child = next_wanted(c, &path[depth]);
        if (child != FF_KEY_NONE) {
            FF_ASSERT(depth < FF_IMAGE_DEPTH_MAX);
            path[depth + 1] = step_to(c, child);
            path[depth].squares &= ~path[depth + 1].squares;
            depth++;
            continue;
        }
        FF_ASSERT(c->count < FF_WEAR_MAX || !path[depth].squares);
        if (path[depth].squares)
            c->list[c->count++] = (ff_wear){ path[depth].image, path[depth].squares };
        depth--;
    }
}

/* The image over a node whose texels are not too large, or as far up as the image of a level. */
static ff_key choose_above(const chooser *c, const ff_box *box, ff_key image)
{
    int64_t root_px_q8 = texel_px_q8(c->info, c->look, box);
    while (ff_key_level(image) > 0 && (ff_key_level(image) > c->last ||
                                       !too_large(c->look, root_px_q8, ff_key_level(image) - 1)))
        image = ff_key_parent(image);
    FF_ASSERT(ff_key_level(image) <= ff_key_level(c->node));
    return image;
}

unsigned ff_wear_list(const ff_tree *tree, const ff_drawn *drawn, const ff_texel_look *look,
                      ff_wear list[FF_WEAR_MAX])
{
    chooser c = {
        .info = ff_tree_ground(tree, drawn->key), .look = look, .node = drawn->key, .list = list
    };
    if (!c.info->texture_log2 || !c.info->texture_levels) return 0;
    uint32_t level = ff_key_level(drawn->key), most = level + ff_image_depth(c.info->node_log2);
    c.last = c.info->texture_levels - 1u < most ? c.info->texture_levels - 1u : most;
    ff_tree_heights_wu(c.info, drawn->node, c.height_wu);
    ff_box box = ff_shape_box(c.info, drawn->key, ff_tree_placed(drawn->node), c.height_wu,
                              look->pos_wu);
    ff_key image = choose_above(&c, &box, drawn->key);
    if (image == drawn->key && level < c.last)
        choose(&c);
    else
        list[c.count++] = (ff_wear){ image, ALL };
    FF_ASSERT(c.count <= FF_WEAR_MAX);
    return c.count;
}
