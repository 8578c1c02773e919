#include "ff_show.h"

#include "../farfield.h"
#include "../../protocol/ff_assert.h"

#define COLOUR_WIRE   0xFF202020u
#define COLOUR_STITCH 0xFF2020FFu /* red */
#define COLOUR_BORDER 0xFF00E0FFu /* yellow */
#define COLOUR_FILLED 0xFFFF40FFu /* violet */

/* Sides that leave out vertices come after all that do not. */
FF_STATIC_ASSERT(FF_STRIP_SIDE(0, 1) == FF_STRIP_SIDE(FF_SIDE_COUNT - 1, 0) + 1);

static void draw_lines(const ff_terrain_view *view, const c3d_draw *ground, unsigned strip,
                       uint32_t colour)
{
    c3d_draw lines = *ground;
    FF_ASSERT(strip < FF_STRIP_COUNT_MAX);
    lines.flags = C3D_DRAW_WIREFRAME | C3D_DRAW_ON_TOP;
    lines.strip = view->strip[strip];
    lines.colour = colour;
    if (lines.strip.id) c3d_draw_strip(view->device, &lines);
}

static void show_mesh(const ff_terrain_view *view, const ff_drawn *drawn, const c3d_draw *ground,
                      uint32_t colour, uint32_t stitch)
{
    uint8_t strip[5];
    unsigned strips = ff_strips_for(drawn->coarser, strip);
    for (unsigned i = 0; i < strips; i++)
        draw_lines(view, ground, strip[i], strip[i] >= FF_STRIP_SIDE(0, 1) ? stitch : colour);
}

static void show_borders(const ff_terrain_view *view, const c3d_draw *ground)
{
    for (unsigned side = 0; side < FF_SIDE_COUNT; side++)
        draw_lines(view, ground, FF_STRIP_SIDE(side, 0), COLOUR_BORDER);
}

void ff_show_over(const ff_terrain_view *view, const ff_drawn *drawn, const c3d_draw *ground,
                  unsigned show)
{
    if (show & FF_SHOW_WIREFRAME) show_mesh(view, drawn, ground, COLOUR_WIRE, COLOUR_STITCH);
    if (show & FF_SHOW_FILLED && drawn->filled)
        show_mesh(view, drawn, ground, COLOUR_FILLED, COLOUR_FILLED);
    if (show & FF_SHOW_NODE_BORDERS) show_borders(view, ground);
}
