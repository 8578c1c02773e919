#include "sim_cube.h"

#include <math.h>

/* Each face's axes: forward, and in its image right and up. */
static const double face_axes[FF_FACE_COUNT][3][3] = {
    [FF_FACE_NORTH] = { { 0, 1, 0 }, { 1, 0, 0 }, { 0, 0, 1 } },
    [FF_FACE_EAST] = { { 1, 0, 0 }, { 0, -1, 0 }, { 0, 0, 1 } },
    [FF_FACE_SOUTH] = { { 0, -1, 0 }, { -1, 0, 0 }, { 0, 0, 1 } },
    [FF_FACE_WEST] = { { -1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } },
    [FF_FACE_UP] = { { 0, 0, 1 }, { 1, 0, 0 }, { 0, -1, 0 } },
    [FF_FACE_DOWN] = { { 0, 0, -1 }, { 1, 0, 0 }, { 0, 1, 0 } },
};

static enum ff_face_name face_of(const double direction[3])
{
    static const enum ff_face_name positive[3] = { FF_FACE_EAST, FF_FACE_NORTH, FF_FACE_UP };
    static const enum ff_face_name negative[3] = { FF_FACE_WEST, FF_FACE_SOUTH, FF_FACE_DOWN };
    int axis = 0;
    for (int i = 1; i < 3; i++)
        if (fabs(direction[i]) > fabs(direction[axis])) axis = i;
    return direction[axis] > 0 ? positive[axis] : negative[axis];
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void sim_cube_meet(const double direction[3], unsigned size, sim_cube_place *place)
{
    place->face = face_of(direction);
    const double(*axis)[3] = face_axes[place->face];
    place->reach = dot(direction, axis[0]);
    place->column = (1 + dot(direction, axis[1]) / place->reach) / 2 * size;
    place->row = (1 - dot(direction, axis[2]) / place->reach) / 2 * size;
}

void sim_cube_direction(const sim_cube_place *place, unsigned size, double direction[3])
{
    const double(*axis)[3] = face_axes[place->face];
    double right = 2 * place->column / size - 1, up = 1 - 2 * place->row / size;
    for (int i = 0; i < 3; i++) direction[i] = axis[0][i] + right * axis[1][i] + up * axis[2][i];
}
