/* From the device's integers to GL's matrices: the one place where geometry becomes floating
 * point. */
#include "c3d_gl_local.h"

#include <string.h>

#define METRES_PER_WU (1.0f / 256.0f)
/* Bias of C3D_DRAW_ON_TOP: points move this part of their way to the eye, which does not move them
 * in the picture. Unlike glPolygonOffset the bias works for lines, and it grows with distance as
 * the steps of the depth buffer do. */
#define ON_TOP_BIAS (1.0f / 64.0f)
/* Parts of a mesh so much nearer to the projector than its farthest are taken to be behind it. */
#define NEAREST_THROWN (1.0 / 4096.0)

void c3d_gl_colour(float rgba[4], uint32_t colour)
{
    for (int i = 0; i < 4; i++) rgba[i] = (float)(colour >> (8 * i) & 0xFF) * (1.0f / 255.0f);
}

/* x_ndc = x d / z / (width/2): Hybrid's equation 1 with the principal point in the middle. */
static void projection_xy(float matrix[16], const c3d_camera *camera)
{
    float focal_px = (float)camera->focal_q8 * (1.0f / 256.0f);
    memset(matrix, 0, 16 * sizeof *matrix);
    matrix[0] = 2.0f * focal_px / (float)camera->width;
    matrix[5] = 2.0f * focal_px / (float)camera->height;
    matrix[11] = -1.0f;
}

void c3d_gl_projection(float matrix[16], const c3d_camera *camera)
{
    /* Doubles: far - near and far + near differ in their last bits when the ratio is 10^6. */
    double near_m = camera->near_wu / 256.0, far_m = camera->far_wu / 256.0;
    projection_xy(matrix, camera);
    matrix[10] = (float)(-(far_m + near_m) / (far_m - near_m));
    matrix[14] = (float)(-2.0 * far_m * near_m / (far_m - near_m));
}

/* A projection without a far plane and with a near plane of 1 wu: a backdrop may have any size. */
void c3d_gl_backdrop_projection(float matrix[16], const c3d_camera *camera)
{
    projection_xy(matrix, camera);
    /* just inside the far side of the clip volume, whatever the rounding */
    matrix[10] = -0.999999f;
    matrix[14] = -2.0f * METRES_PER_WU;
}

void c3d_gl_modelview(float matrix[16], const c3d_resolved_draw *resolved,
                      const c3d_rotation *rotation)
{
    const c3d_draw *draw = resolved->draw;
    float pull = draw->flags & C3D_DRAW_ON_TOP ? 1.0f - ON_TOP_BIAS : 1.0f;
    float xy = (float)draw->xy_scale_wu * METRES_PER_WU,
          z = (float)draw->z_scale_q16 * (METRES_PER_WU / 65536.0f);
    const float scale[3] = { xy, xy, z };
    for (int row = 0; row < 3; row++) {
        float sign = row == 2 ? -pull : pull; /* GL looks along -z */
        for (int column = 0; column < 3; column++)
            matrix[column * 4 + row] = sign * (float)rotation->m[row][column] *
                                       (1.0f / C3D_ONE_Q30) * scale[column];
        matrix[12 + row] = sign *
                           (float)((double)resolved->eye_q14[row] / (256.0 * (1 << C3D_EYE_SHIFT)));
    }
    matrix[3] = matrix[7] = matrix[11] = 0.0f;
    matrix[15] = 1.0f;
}

void c3d_gl_texture_matrix(float matrix[16], const c3d_draw *draw)
{
    memset(matrix, 0, 16 * sizeof *matrix);
    for (int i = 0; i < 2; i++) {
        matrix[i * 4 + i] = (float)draw->tex_scale_q16[i] * (1.0f / 65536.0f);
        matrix[12 + i] = (float)draw->tex_offset_q16[i] * (1.0f / 65536.0f);
    }
    matrix[15] = 1.0f;
}

/* Row by row: what a vertex's x, y, z and 1 are multiplied with, in wu. */
static void throw_rows(double rows[3][4], const c3d_draw *draw)
{
    const c3d_projector *projector = draw->projector;
    for (int i = 0; i < 3; i++) {
        rows[i][3] = 0;
        for (int axis = 0; axis < 3; axis++) {
            double part = projector->row_q24[i][axis] * (1.0 / (1 << 24));
            rows[i][axis] = part * (axis < 2 ? draw->xy_scale_wu : draw->z_scale_q16 / 65536.0);
            rows[i][3] += part * (double)(draw->origin_wu[axis] - projector->origin_wu[axis]);
        }
    }
}

enum c3d_gl_thrown c3d_gl_throw_matrix(float matrix[16], double plane[4],
                                       const c3d_resolved_draw *resolved)
{
    static const int place[3] = { 0, 1, 3 };
    const c3d_mesh_data *mesh = resolved->mesh;
    double rows[3][4], least, most;
    throw_rows(rows, resolved->draw);
    least = most = rows[2][3];
    for (int axis = 0; axis < 3; axis++) {
        double low = rows[2][axis] * mesh->least[axis], high = rows[2][axis] * mesh->most[axis];
        least += low < high ? low : high;
        most += low < high ? high : low;
    }
    memset(matrix, 0, 16 * sizeof *matrix);
    for (int i = 0; i < 3; i++)
        for (int column = 0; column < 4; column++)
            matrix[column * 4 + place[i]] = (float)(rows[i][column] * (double)METRES_PER_WU);
    for (int i = 0; i < 4; i++) plane[i] = rows[2][i] / most;
    plane[3] -= NEAREST_THROWN;
    return most <= 0                       ? C3D_GL_BEHIND
           : least > most * NEAREST_THROWN ? C3D_GL_BEFORE
                                           : C3D_GL_ACROSS;
}
