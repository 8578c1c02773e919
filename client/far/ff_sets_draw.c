/* Fins as meshes, and paint thrown on what is drawn.
 *
 * Places are taken relative to O as they lie there, where curved ground falls away from O. In the
 * picture it falls away from the viewer: seen from s away the two differ by a tilt of s / R, 0.06
 * pixels of 240 for 2 km, which is let be. */
#include "ff_sets.h"
#include "../terrain/ff_shade.h"
#include "../../protocol/shape/ff_shape.h"

#include <string.h>

#define FOOT_PX      30    /* ground in front of a ridge that coarse ground may lack */
#define TAN_HALF_Q16 13036 /* of 11.25 degrees */

/* ---- fins ---- */

/* A fin's vertex and the foot below it, relative to O. */
static void place(const ff_sets *sets, const ff_set *set, unsigned sector, const ff_fin_vertex *fin,
                  c3d_vertex out[2])
{
    int32_t forward_q30[2], right_q30[2];
    ff_far_axes(sector, forward_q30, right_q30);
    int64_t f = ff_far_distance_wu(fin->distance), r = f * fin->column / set->focal,
            up = f * fin->up_q2 / (4 * (int64_t)set->focal), foot = f * FOOT_PX / set->focal;
    int32_t x = (int32_t)((f * forward_q30[0] + r * right_q30[0]) >> 30),
            y = (int32_t)((f * forward_q30[1] + r * right_q30[1]) >> 30);
    out[0] = out[1] = (c3d_vertex){ .x = x, .y = y, .z = (int32_t)up };
    out[1].z = (int32_t)(up - foot);
    int64_t height_wu = set->position_wu[2] + up + (int64_t)ff_shape_drop_wu(sets->info, x, y);
    ff_shade_ridge(sets->info, (int32_t)(height_wu > INT32_MAX ? INT32_MAX : height_wu),
                   out[0].rgba);
    memcpy(out[1].rgba, out[0].rgba, sizeof out[1].rgba);
}

/* On the device, if there is one. 0: no room. */
static int make_strip(ff_sets *sets, ff_set_sector *made, uint32_t vertices, uint32_t indices)
{
    c3d_strip strip = { 0 };
    if (!sets->device) return 1;
    c3d_mesh mesh = c3d_mesh_make(sets->device, sets->scratch, vertices);
    if (mesh.id) strip = c3d_strip_make(sets->device, sets->indices, indices);
    if (mesh.id && !strip.id) c3d_mesh_free(sets->device, mesh);
    if (!strip.id) return 0;
    made->mesh[made->chunks] = mesh;
    made->strip[made->chunks++] = strip;
    return 1;
}

/* One mesh of `count` fin vertices, with the strip that joins those of one fin. 0: no room. */
static int make_chunk(ff_sets *sets, ff_set *set, unsigned sector, const ff_fin_vertex *fin,
                      uint32_t count)
{
    ff_set_sector *made = &set->sector[sector];
    uint32_t indices = 0;
    for (uint32_t i = 0; i < count; i++) {
        place(sets, set, sector, &fin[i], sets->scratch + 2 * i);
        uint16_t top = (uint16_t)(2 * i), foot = (uint16_t)(top + 1);
        if (i > 0 && fin[i].begins) { /* degenerate triangles lead to the next fin */
            sets->indices[indices] = sets->indices[indices - 1];
            sets->indices[indices + 1] = top;
            indices += 2;
        }
        sets->indices[indices++] = top;
        sets->indices[indices++] = foot;
    }
    if (indices < 4) return 1;
    if (!make_strip(sets, made, 2 * count, indices)) return 0;
    if (sets->watch)
        sets->watch(sets->watch_context, set->key, sector, sets->scratch, 2 * count, sets->indices,
                    indices);
    return 1;
}

int ff_sets_make_fins(ff_sets *sets, ff_set *set, unsigned sector, const ff_fin_vertex *fin,
                      uint32_t count)
{
    uint32_t room = sets->vertices / 2u;
    FF_ASSERT(room >= 2);
    for (uint32_t from = 0; from + 1 < count;) {
        uint32_t part = count - from < room ? count - from : room;
        if (set->sector[sector].chunks == FF_SETS_CHUNKS) return 1; /* as many as it may have */
        if (!make_chunk(sets, set, sector, fin + from, part)) return 0;
        from += part;
        if (from < count && !fin[from].begins) from--; /* a fin that goes on in the next mesh */
    }
    return 1;
}

/* ---- paint ---- */

static void aim(const ff_set *set, c3d_projector projectors[FF_FAR_SECTORS],
                const c3d_camera *camera)
{
    int32_t focal = set->focal >> set->paint_shift;
    for (unsigned s = 0; s < FF_FAR_SECTORS; s++) {
        const ff_set_sector *sector = &set->sector[s];
        c3d_projector *projector = &projectors[s];
        int32_t forward_q30[2], right_q30[2];
        if (!sector->paint.id) continue;
        memset(projector, 0, sizeof *projector);
        ff_far_axes(s, forward_q30, right_q30);
        for (int axis = 0; axis < 3; axis++)
            projector->origin_wu[axis] = (int64_t)set->position_wu[axis] - camera->pos_wu[axis];
        for (int axis = 0; axis < 2; axis++) {
            int64_t f = forward_q30[axis], r = right_q30[axis];
            projector->row_q24[0][axis] =
                (int32_t)((f * sector->middle + r * focal) / sector->width >> 6);
            projector->row_q24[1][axis] = (int32_t)(f * sector->top / sector->height >> 6);
            projector->row_q24[2][axis] = (int32_t)(f >> 6);
        }
        projector->row_q24[1][2] = (int32_t)(-((int64_t)focal << 24) / sector->height);
    }
}

void ff_sets_aim(ff_sets *sets, const c3d_camera *camera)
{
    if (sets->under >= 0) aim(&sets->set[sets->under], sets->projector[sets->under], camera);
    if (sets->active >= 0) aim(&sets->set[sets->active], sets->projector[sets->active], camera);
}

/* Whether ground between x, y = lo and hi, relative to O, lies in a sector's wedge; a little more
 * than that. */
static int in_wedge(unsigned sector, const ff_box *box)
{
    int32_t forward_q30[2], right_q30[2];
    int before = 0, left = 1, right = 1;
    ff_far_axes(sector, forward_q30, right_q30);
    for (unsigned corner = 0; corner < 4; corner++) {
        int64_t x = (corner & 1u ? box->hi : box->lo)[0], y = (corner & 2u ? box->hi : box->lo)[1];
        int64_t f = ((x >> 4) * forward_q30[0] + (y >> 4) * forward_q30[1]) >> 26,
                r = ((x >> 4) * right_q30[0] + (y >> 4) * right_q30[1]) >> 26,
                half = (f * TAN_HALF_Q16) >> 16;
        before |= f > 0;
        left &= r < -half;
        right &= r > half;
    }
    return before && !left && !right;
}

/* What is thrown of a set: some sectors, on all but some squares of a node. */
typedef struct cast {
    unsigned sectors;
    const ff_squares *without; /* NULL: on all */
} cast;

/* Throws a set's paint on what draws[0] draws, over the pictures that are thrown on it already.
 * `through`: how much of those is seen. How many draws there are now. */
static unsigned throw_set(const ff_sets *sets, int index, const cast *of, uint8_t through,
                          c3d_draw draws[FF_THROWS_MAX], const ff_squares *without[FF_THROWS_MAX],
                          unsigned count)
{
    const uint32_t pictures = C3D_DRAW_TEXTURED | C3D_DRAW_PROJECTED;
    for (unsigned s = 0; s < FF_FAR_SECTORS; s++) {
        c3d_texture paint = sets->set[index].sector[s].paint;
        if (!paint.id || !(of->sectors >> s & 1u)) continue;
        c3d_draw draw = draws[0];
        int first = !through && !of->without && !(draw.flags & pictures);
        draw.flags = (draw.flags & ~pictures) | C3D_DRAW_PROJECTED |
                     (first ? 0 : C3D_DRAW_ALPHA_TEST);
        draw.texture = paint;
        draw.projector = &sets->projector[index][s];
        draw.through = through;
        if (!first && count == FF_THROWS_MAX) return count;
        without[first ? 0 : count] = of->without;
        draws[first ? 0 : count++] = draw;
    }
    return count;
}

/* The sectors of a set in which a node lies, beyond the set's front. */
static unsigned sectors_of(const ff_set *set, const ff_terrain_info *info, const ff_drawn *drawn)
{
    static const int64_t level_wu[2] = { 0, 0 };
    ff_box box = ff_shape_box(info, drawn->key, ff_tree_placed(drawn->node), level_wu,
                              set->position_wu);
    unsigned sectors = 0;
    if (box.lo[0] < set->front_wu && box.hi[0] > -set->front_wu && box.lo[1] < set->front_wu &&
        box.hi[1] > -set->front_wu)
        return 0;
    for (unsigned s = 0; s < FF_FAR_SECTORS; s++)
        if (set->sector[s].paint.id && in_wedge(s, &box)) sectors |= 1u << s;
    return sectors;
}

/* What of a set is thrown on a node. What was found hidden is kept until the set has another
 * stamp. */
static cast cast_of(const ff_sets *sets, int index, const ff_terrain_info *info,
                    const ff_drawn *drawn, ff_view_kept *kept)
{
    cast of = { 0, NULL };
    if (index < 0) return of;
    const ff_set *set = &sets->set[index];
    of.sectors = sectors_of(set, info, drawn);
    if (!of.sectors) return of;
    if (kept->about[index] != set->stamp) {
        kept->squares[index] = ff_sets_hidden(set, of.sectors, info, drawn);
        kept->about[index] = set->stamp;
    }
    if (kept->squares[index]) of.without = &kept->squares[index];
    if (!~kept->squares[index]) of.sectors = 0;
    return of;
}

/* Throws what is drawn of both sets on what draws[0] draws: of the drawn one some sectors, of that
 * below it others. Where the drawn one has none, that below it fades out. */
static unsigned throw_both(const ff_sets *sets, const cast *active, const cast *under,
                           c3d_draw draws[FF_THROWS_MAX], const ff_squares *without[FF_THROWS_MAX])
{
    unsigned count = 1;
    if (sets->under >= 0)
        count = throw_set(sets, sets->under, under,
                          active->sectors ? 0 : (uint8_t)(256 - sets->through), draws, without,
                          count);
    return active->sectors
               ? throw_set(sets, sets->active, active, sets->through, draws, without, count)
               : count;
}

unsigned ff_sets_lay(const void *context, const ff_terrain_info *info, const ff_drawn *drawn,
                     ff_view_kept *kept, c3d_draw draws[FF_THROWS_MAX],
                     const ff_squares *without[FF_THROWS_MAX])
{
    const ff_sets *sets = context;
    cast active = cast_of(sets, sets->active, info, drawn, kept),
         under = cast_of(sets, sets->under, info, drawn, kept);
    return throw_both(sets, &active, &under, draws, without);
}

/* ---- fins on the screen ---- */

/* A sector's fins; those of either set wear the paint of both. */
static void draw_sector(const ff_sets *sets, int index, unsigned s, const c3d_camera *camera)
{
    const ff_set *set = &sets->set[index];
    const ff_set_sector *sector = &set->sector[s];
    c3d_draw draws[FF_THROWS_MAX] = {
        { .xy_scale_wu = 1, .z_scale_q16 = 65536, .flags = C3D_DRAW_COLOURED, .tex_columns = 1 }
    };
    for (int axis = 0; axis < 3; axis++)
        draws[0].origin_wu[axis] = (int64_t)set->position_wu[axis] - camera->pos_wu[axis];
    int painted = sets->active >= 0 && sets->set[sets->active].sector[s].paint.id;
    const ff_squares *none[FF_THROWS_MAX] = { NULL };
    unsigned count = throw_both(sets, &(cast){ painted ? 1u << s : 0, NULL },
                                &(cast){ 1u << s, NULL }, draws, none);
    for (unsigned i = 0; i < sector->chunks; i++)
        for (unsigned k = 0; k < count; k++) {
            draws[k].mesh = sector->mesh[i];
            draws[k].strip = sector->strip[i];
            c3d_draw_strip(sets->device, &draws[k]);
        }
}

void ff_sets_draw(const ff_sets *sets, const c3d_camera *camera)
{
    if (sets->active < 0 && sets->under < 0) return;
    unsigned seen = ff_sets_in_view(camera);
    for (unsigned s = 0; s < FF_FAR_SECTORS; s++) {
        if (!(seen >> s & 1u)) continue;
        if (sets->under >= 0) draw_sector(sets, sets->under, s, camera);
        if (sets->active >= 0) draw_sector(sets, sets->active, s, camera);
    }
}
