#include "ff_node_draw.h"

#include "../../protocol/ff_assert.h"

#include <string.h>

/* Draws with `draw`, whose strip is any. */
static void draw_strips(ff_terrain_view *view, const ff_drawn *drawn, c3d_draw *draw)
{
    uint8_t strip[5];
    unsigned strips = ff_strips_for(drawn->coarser, strip);
    for (unsigned i = 0; i < strips; i++) {
        FF_ASSERT(strip[i] < FF_STRIP_COUNT_MAX);
        draw->strip = view->strip[strip[i]];
        if (draw->strip.id) c3d_draw_strip(view->device, draw);
    }
}

/* The node's strips without some squares, as one; id 0: nothing is left, or there is no room. */
static c3d_strip make_part(ff_terrain_view *view, const ff_terrain_info *info,
                           const ff_drawn *drawn, ff_squares without)
{
    uint8_t strip[5];
    unsigned strips = ff_strips_for(drawn->coarser, strip);
    uint32_t count = 0;
    for (unsigned i = 0; i < strips; i++)
        count = ff_strips_without(view->index + view->first[strip[i]], view->length[strip[i]],
                                  info->node_log2, without, view->part, count);
    FF_ASSERT(count <= ff_strips_part(view->heights_per_node));
    return count ? c3d_strip_make(view->device, view->part, count) : (c3d_strip){ 0 };
}

/* Dresses a call that draws a node for the squares that wear an image. */
static void dress(const ff_terrain_view *view, const ff_terrain_info *info, const ff_drawn *drawn,
                  ff_key image, c3d_draw *draw)
{
    ff_textures_lay(view->textures, drawn->key, image, draw);
    if (draw->flags & C3D_DRAW_TEXTURED) ff_ground_frame_last(info, drawn, draw);
}

/* Chooses what a node wears, view->wear: how many parts it has. The call is dressed for the first:
 * of several only the last has no image. */
static unsigned choose_outfit(ff_terrain_view *view, const ff_terrain_info *info,
                              const ff_drawn *drawn, c3d_draw *draw)
{
    if (!view->textures) return 0;
    unsigned parts = ff_textures_worn(view->textures, view->tree, drawn, &view->look, view->wear);
    FF_ASSERT(parts <= FF_WEAR_MAX);
    if (parts) dress(view, info, drawn, view->wear[0].image, draw);
    return parts;
}

/* Draws a node in its parts: of several `draw` is dressed for each in turn. */
static void draw_outfit(ff_terrain_view *view, const ff_terrain_info *info, const ff_drawn *drawn,
                        unsigned parts, c3d_draw *draw)
{
    FF_ASSERT(parts <= FF_WEAR_MAX);
    if (parts < 2) draw_strips(view, drawn, draw);
    for (unsigned i = 0; parts > 1 && i < parts; i++) {
        draw->flags = C3D_DRAW_COLOURED;
        for (int axis = 0; axis < 2; axis++)
            draw->tex_first_q16[axis] = draw->tex_last_q16[axis] = 0;
        dress(view, info, drawn, view->wear[i].image, draw);
        draw->strip = make_part(view, info, drawn, ~view->wear[i].squares);
        if (draw->strip.id) c3d_draw_strip(view->device, draw);
        c3d_strip_free(view->device, draw->strip);
    }
}

static void draw_thrown(ff_terrain_view *view, const ff_terrain_info *info, const ff_drawn *drawn,
                        const ff_view_node *entry, unsigned parts, const c3d_draw *draw)
{
    c3d_draw draws[FF_THROWS_MAX];
    const ff_squares *without[FF_THROWS_MAX] = { NULL };
    c3d_strip part = { 0 };
    ff_view_kept *kept = &view->kept[entry ? entry - view->entry : (ptrdiff_t)view->entry_count];
    if (!entry) memset(kept, 0, sizeof *kept);
    draws[0] = *draw;
    unsigned count = view->throws.lay(view->throws.context, info, drawn, kept, draws, without);
    FF_ASSERT(count >= 1 && count <= FF_THROWS_MAX);
    for (unsigned i = 0; i < count; i++) {
        if (!without[i]) {
            if (draws[i].flags & C3D_DRAW_TEXTURED)
                draw_outfit(view, info, drawn, parts, &draws[i]);
            else
                draw_strips(view, drawn, &draws[i]);
            continue;
        }
        if (i == 0 || without[i] != without[i - 1]) {
            c3d_strip_free(view->device, part);
            part = make_part(view, info, drawn, *without[i]);
        }
        draws[i].strip = part;
        if (part.id) c3d_draw_strip(view->device, &draws[i]);
    }
    c3d_strip_free(view->device, part);
}

void ff_node_draw(ff_terrain_view *view, const ff_terrain_info *info, const ff_drawn *drawn,
                  const ff_view_node *entry, c3d_draw *draw)
{
    unsigned parts = choose_outfit(view, info, drawn, draw);
    if (view->throws.lay)
        draw_thrown(view, info, drawn, entry, parts, draw);
    else
        draw_outfit(view, info, drawn, parts, draw);
}

void ff_node_contours(ff_terrain_view *view, const ff_terrain_info *info, const ff_drawn *drawn,
                      const c3d_draw *ground)
{
    const ff_contour_node node = { info, drawn->heights, view->vertices, ground };
    uint8_t strip[5];
    unsigned strips = ff_strips_for(drawn->coarser, strip);
    FF_ASSERT(strips >= 1 && strips <= sizeof strip);
    ff_tree_vertices(view->tree, drawn, 0, view->vertices);
    ff_tree_clear_hidden(view->tree, drawn, view->vertices);
    ff_ground_frame_vertices(&view->frame, info, drawn, view->vertices, view->heights_per_node);
    for (unsigned i = 0; i < strips; i++)
        ff_contours_strip(&view->contours, &node, view->index + view->first[strip[i]],
                          view->length[strip[i]]);
    ff_contours_flush(&view->contours, ground);
}
