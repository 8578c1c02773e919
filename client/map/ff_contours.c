#include "ff_contours.h"

#include "../../protocol/ff_assert.h"

#define COLOUR       0x1E4A78u /* brown */
#define COLOUR_FIFTH 0x0A2440u
#define COLOUR_PLACE 0xFF2020F0u
#define EVERY        5 /* so many lines there is a darker one */
#define PLACE_PX     7

const int ff_contours_built = 1;

int ff_contours_make(ff_contours *contours, c3d_device *device, c3d_vertex *vertex)
{
    uint16_t index[FF_CONTOUR_INDICES];
    for (unsigned i = 0; i < FF_CONTOUR_INDICES; i++) index[i] = (uint16_t)i;
    *contours = (ff_contours){ .device = device, .vertex = vertex };
    if (!device || !vertex) return FF_OK;
    contours->lines = c3d_lines_make(device, index, FF_CONTOUR_INDICES);
    return contours->lines.id ? FF_OK : FF_ERR_MEMORY;
}

void ff_contours_flush(ff_contours *contours, const c3d_draw *ground)
{
    c3d_draw lines = { .flags = C3D_DRAW_WIREFRAME | C3D_DRAW_ON_TOP | C3D_DRAW_COLOURED,
                       .strip = contours->lines,
                       .xy_scale_wu = 1,
                       .z_scale_q16 = 1u << 16 };
    FF_ASSERT(contours->count <= FF_CONTOUR_INDICES && contours->count % 2 == 0);
    if (!contours->count) return;
    for (int axis = 0; axis < 3; axis++) lines.origin_wu[axis] = ground->origin_wu[axis];
    /* the strip's lines are all drawn: those that are none lie in one point */
    for (uint32_t i = contours->count; i < FF_CONTOUR_INDICES; i++)
        contours->vertex[i] = contours->vertex[0];
    lines.mesh = c3d_mesh_make(contours->device, contours->vertex, FF_CONTOUR_INDICES);
    contours->count = 0;
    if (!lines.mesh.id) return;
    c3d_draw_strip(contours->device, &lines);
    c3d_mesh_free(contours->device, lines.mesh);
}

void ff_contours_point(ff_contours *contours, const int64_t offset_wu[3])
{
    const c3d_vertex here = { .rgba = { 0, 0, 0, 255 } };
    c3d_draw point = { .flags = C3D_DRAW_ON_TOP,
                       .colour = COLOUR_PLACE,
                       .point_px = PLACE_PX,
                       .xy_scale_wu = 1,
                       .z_scale_q16 = 1u << 16 };
    FF_ASSERT(contours->count == 0);
    for (int axis = 0; axis < 3; axis++) point.origin_wu[axis] = offset_wu[axis];
    point.mesh = c3d_mesh_make(contours->device, &here, 1);
    if (!point.mesh.id) return;
    c3d_draw_points(contours->device, &point);
    c3d_mesh_free(contours->device, point.mesh);
}

/* A corner of a triangle: its height, and its place in wu from the frame's origin. */
typedef struct corner {
    int64_t place_wu[3];
    int32_t height_wu;
} corner;

static corner corner_of(const ff_contour_node *node, uint16_t index)
{
    const c3d_vertex *vertex = &node->vertices[index];
    const c3d_draw *ground = node->ground;
    FF_ASSERT(ground->xy_scale_wu > 0);
    return (corner){ .place_wu = { (int64_t)vertex->x * ground->xy_scale_wu,
                                   (int64_t)vertex->y * ground->xy_scale_wu,
                                   ((int64_t)vertex->z * ground->z_scale_q16) >> 16 },
                     .height_wu = ff_height_wu(node->info, node->heights[index]) };
}

static int32_t as_coordinate(int64_t wu)
{
    return wu > INT32_MAX ? INT32_MAX : wu < -INT32_MAX ? -INT32_MAX : (int32_t)wu;
}

/* Where the edge from the lower to the higher corner passes a height. */
static void pass(const corner *lower, const corner *higher, int64_t level_wu, c3d_vertex *vertex)
{
    int64_t part = level_wu - lower->height_wu,
            whole = (int64_t)higher->height_wu - lower->height_wu, at[3];
    FF_ASSERT(part > 0 && part <= whole);
    int64_t share_q24 = c3d_divide_saturated((uint64_t)part << 24, (uint64_t)whole);
    FF_ASSERT(share_q24 >= 0 && share_q24 <= 1 << 24);
    for (int axis = 0; axis < 3; axis++)
        at[axis] = lower->place_wu[axis] +
                   ((higher->place_wu[axis] - lower->place_wu[axis]) * share_q24 >> 24);
    vertex->x = as_coordinate(at[0]);
    vertex->y = as_coordinate(at[1]);
    vertex->z = as_coordinate(at[2]);
}

static void colour(c3d_vertex *vertex, int32_t number)
{
    uint32_t rgb = number % EVERY ? COLOUR : COLOUR_FIFTH;
    for (unsigned i = 0; i < 3; i++) vertex->rgba[i] = (uint8_t)(rgb >> 8 * i);
    vertex->rgba[3] = 255;
}

/* Corners from the lowest to the highest. */
static void sort(corner corners[3])
{
    for (int i = 0; i < 3; i++) {
        int a = i == 1, b = a + 1; /* 0 and 1, 1 and 2, 0 and 1 */
        if (corners[a].height_wu <= corners[b].height_wu) continue;
        corner higher = corners[a];
        corners[a] = corners[b];
        corners[b] = higher;
    }
    FF_ASSERT(corners[0].height_wu <= corners[1].height_wu);
    FF_ASSERT(corners[1].height_wu <= corners[2].height_wu);
}

/* 1 when all of a triangle lies under another ground. */
static int is_hidden(const ff_contour_node *node, const uint16_t index[3])
{
    return !(node->vertices[index[0]].rgba[3] | node->vertices[index[1]].rgba[3] |
             node->vertices[index[2]].rgba[3]);
}

static int32_t floor_divide(int32_t n, int32_t d)
{
    FF_ASSERT(d > 0);
    return n / d - (n % d < 0);
}

/* 1 when the middle corner lies left of the way from the lowest to the highest one. */
static int is_left(const corner c[3])
{
    int64_t up_x = c[2].place_wu[0] - c[0].place_wu[0], up_y = c[2].place_wu[1] - c[0].place_wu[1],
            x = c[1].place_wu[0] - c[0].place_wu[0], y = c[1].place_wu[1] - c[0].place_wu[1];
    return up_x * y > up_y * x;
}

/* Lines whose height is above the lowest corner's, and not above the highest one's. Returns the
 * height of the line below the lowest corner. */
static int64_t add_triangle(ff_contours *contours, const ff_contour_node *node,
                            const uint16_t index[3])
{
    corner c[3] = { corner_of(node, index[0]), corner_of(node, index[1]),
                    corner_of(node, index[2]) };
    sort(c);
    int32_t first = floor_divide(c[0].height_wu, contours->interval_wu) + 1,
            last = floor_divide(c[2].height_wu, contours->interval_wu);
    FF_ASSERT(first <= last + 1);
    /* each begins where another ends, higher ground to its right: a GL leaves out a line's last
     * pixel */
    int left = is_left(c);
    if (last - first >= FF_CONTOURS_OF_ONE) last = first - 1;
    for (int32_t number = first; number <= last; number++) {
        int64_t level_wu = (int64_t)number * contours->interval_wu;
        if (contours->count == FF_CONTOUR_INDICES) ff_contours_flush(contours, node->ground);
        c3d_vertex *line = contours->vertex + contours->count, *end = line + left;
        pass(&c[0], &c[2], level_wu, line + !left);
        if (level_wu > c[1].height_wu)
            pass(&c[1], &c[2], level_wu, end);
        else
            pass(&c[0], &c[1], level_wu, end);
        colour(&line[0], number);
        colour(&line[1], number);
        contours->count += 2;
    }
    return (int64_t)(first - 1) * contours->interval_wu;
}

void ff_contours_strip(ff_contours *contours, const ff_contour_node *node, const uint16_t *index,
                       uint32_t count)
{
    int64_t band_wu = 0; /* a height that lines have: of those last met the one below */
    int inside = 0;      /* so many of the last vertices lie between it and the next */
    FF_ASSERT(contours->vertex != NULL && contours->interval_wu > 0);
    for (uint32_t i = 0; i < count; i++) {
        int64_t above_wu = ff_height_wu(node->info, node->heights[index[i]]) - band_wu;
        inside = above_wu >= 0 && above_wu < contours->interval_wu ? inside + 1 : 0;
        if (i < 2 || inside >= 3) continue;
        const uint16_t *t = index + i - 2;
        if (t[0] == t[1] || t[1] == t[2] || t[0] == t[2] || is_hidden(node, t)) continue;
        int64_t below_wu = add_triangle(contours, node, t);
        if (below_wu != band_wu) inside = 0;
        band_wu = below_wu;
    }
}
