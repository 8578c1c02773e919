#include "sim_faces.h"

#include <math.h>
#include <string.h>

void sim_faces_use(sim_faces *faces, const sim_panorama *panorama)
{
    FF_ASSERT(panorama->face_size > 0 && panorama->face_size <= FF_FACE_SIZE_MAX);
    if (memcmp(&faces->of, panorama, sizeof faces->of) == 0) return;
    faces->of = *panorama;
    faces->known = 0;
}

enum met { NOTHING, GROUND, INSIDE };

/* What the ray through a texel's middle meets between front and back. INSIDE: it begins below
 * ground, of which the server has cut off what is nearer, and sees nothing. */
static enum met texel_meets(const sim_faces *faces, enum ff_face_name face, unsigned column,
                            unsigned row)
{
    const sim_panorama *of = &faces->of;
    const sim_cube_place at = { .face = face, .column = column + 0.5, .row = row + 0.5 };
    double along[3], from[3], t;
    sim_cube_direction(&at, of->face_size, along);
    const double front_m = (double)of->front_wu / FF_WU_PER_METRE;
    for (int i = 0; i < 3; i++)
        from[i] = (double)of->pos_wu[i] / FF_WU_PER_METRE + front_m * along[i];
    /* the ground has fallen away from O: at the front the ray stands as much higher above it, and
     * rises by twice that on as much again */
    double drop_m = sim_ground_drop_m(faces->ground, front_m * along[0], front_m * along[1]);
    from[2] += drop_m;
    if (front_m > 0) along[2] += 2 * drop_m / front_m;
    if (!sim_ground_cast(faces->ground, from, along,
                         ((double)of->back_wu - of->front_wu) / FF_WU_PER_METRE, &t))
        return NOTHING;
    return t > 0 ? GROUND : INSIDE;
}

/* The same, looked for from the top: below ground that ends there may be nothing. */
static unsigned first_row_outside(const sim_faces *faces, enum ff_face_name face, unsigned column)
{
    unsigned row = 0;
    while (row < faces->of.face_size && texel_meets(faces, face, column, row) != GROUND) row++;
    return row;
}

/* First row with ground in a column of a level face, sought from a row near it. From over the
 * ground all rows below it meet ground: they look at the same places, and lower. */
static unsigned first_row(const sim_faces *faces, enum ff_face_name face, unsigned column,
                          unsigned near)
{
    unsigned size = faces->of.face_size, stride = 1;
    int sky = -1, ground = (int)size, row = (int)near;
    while (row > sky && row < ground) {
        int shows = texel_meets(faces, face, column, (unsigned)row) != NOTHING;
        *(shows ? &ground : &sky) = row;
        row += (int)(shows ? -stride : stride);
        stride *= 2;
    }
    while (ground - sky > 1) {
        row = (sky + ground) / 2;
        *(texel_meets(faces, face, column, (unsigned)row) ? &ground : &sky) = row;
    }
    return (unsigned)ground;
}

static void find_skyline(sim_faces *faces, enum ff_face_name face)
{
    const int32_t *at_wu = faces->of.pos_wu;
    int over = sim_ground_has(faces->ground, (double)at_wu[0] / FF_WU_PER_METRE,
                              (double)at_wu[1] / FF_WU_PER_METRE);
    unsigned near = faces->of.face_size / 2;
    for (unsigned column = 0; column < faces->of.face_size; column++) {
        near = over ? first_row(faces, face, column, near) : first_row_outside(faces, face, column);
        faces->top[face][column] = (uint16_t)near;
        if (near == faces->of.face_size) near--;
    }
    faces->known |= 1u << face;
}

/* The texel that a direction from O meets. */
static void texel_at(const sim_faces *faces, const double direction[3], sim_cube_place *at,
                     unsigned *column, unsigned *row)
{
    double last = faces->of.face_size - 1;
    sim_cube_meet(direction, faces->of.face_size, at);
    *column = (unsigned)fmin(fmax(floor(at->column), 0), last);
    *row = (unsigned)fmin(fmax(floor(at->row), 0), last);
}

int sim_faces_reach(sim_faces *faces, const double direction[3])
{
    sim_cube_place at;
    unsigned column, row;
    texel_at(faces, direction, &at, &column, &row);
    if (at.face == FF_FACE_UP || at.face == FF_FACE_DOWN)
        return texel_meets(faces, at.face, column, row) != NOTHING;
    if (!(faces->known >> at.face & 1u)) find_skyline(faces, at.face);
    return row >= faces->top[at.face][column];
}

int sim_faces_show(sim_faces *faces, const double direction[3])
{
    sim_cube_place at;
    unsigned column, row;
    texel_at(faces, direction, &at, &column, &row);
    return sim_faces_reach(faces, direction) && texel_meets(faces, at.face, column, row) == GROUND;
}
