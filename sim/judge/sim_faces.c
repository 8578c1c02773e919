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

/* Does the ray through a texel's middle meet ground between front and back? */
static int texel_shows(const sim_faces *faces, enum ff_face_name face, unsigned column,
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
    return sim_ground_cast(faces->ground, from, along,
                           ((double)of->back_wu - of->front_wu) / FF_WU_PER_METRE, &t);
}

/* First row with ground in a column of a level face, sought from a row near it. All rows below it
 * have ground: they look at the same places, and lower. */
static unsigned first_row(const sim_faces *faces, enum ff_face_name face, unsigned column,
                          unsigned near)
{
    unsigned size = faces->of.face_size, stride = 1;
    int sky = -1, ground = (int)size, row = (int)near;
    while (row > sky && row < ground) {
        int shows = texel_shows(faces, face, column, (unsigned)row);
        *(shows ? &ground : &sky) = row;
        row += (int)(shows ? -stride : stride);
        stride *= 2;
    }
    while (ground - sky > 1) {
        row = (sky + ground) / 2;
        *(texel_shows(faces, face, column, (unsigned)row) ? &ground : &sky) = row;
    }
    return (unsigned)ground;
}

static void find_skyline(sim_faces *faces, enum ff_face_name face)
{
    unsigned near = faces->of.face_size / 2;
    for (unsigned column = 0; column < faces->of.face_size; column++) {
        near = first_row(faces, face, column, near);
        faces->top[face][column] = (uint16_t)near;
        if (near == faces->of.face_size) near--;
    }
    faces->known |= 1u << face;
}

int sim_faces_show(sim_faces *faces, const double direction[3])
{
    double last = faces->of.face_size - 1;
    sim_cube_place at;
    sim_cube_meet(direction, faces->of.face_size, &at);
    unsigned column = (unsigned)fmin(fmax(floor(at.column), 0), last),
             row = (unsigned)fmin(fmax(floor(at.row), 0), last);
    if (at.face == FF_FACE_UP || at.face == FF_FACE_DOWN)
        return texel_shows(faces, at.face, column, row);
    if (!(faces->known >> at.face & 1u)) find_skyline(faces, at.face);
    return row >= faces->top[at.face][column];
}
