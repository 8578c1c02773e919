#include "thrown_rig.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void thrown_join(thrown_mesh *mesh, uint32_t side)
{
    uint32_t count = 0;
    for (uint32_t row = 0; row + 1 < side; row++)
        for (uint32_t column = 0; column < side; column++) {
            uint16_t here = (uint16_t)(row * side + column);
            if (row > 0 && column == 0) { /* degenerate triangles lead to the next row */
                mesh->index[count] = mesh->index[count - 1];
                mesh->index[count + 1] = (uint16_t)(here + side);
                count += 2;
            }
            mesh->index[count++] = (uint16_t)(here + side);
            mesh->index[count++] = here;
        }
    mesh->side = side;
    mesh->vertices = side * side;
    mesh->indices = count;
}

/* ---- pictures ---- */

static uint32_t kept(enum c3d_texture_format format, const uint32_t channel[4])
{
    uint32_t word = 0;
    for (int i = 0; i < 4; i++) {
        uint32_t value = channel[i];
        if (format == C3D_RGBA5551 && i < 3) value = (value >> 3) << 3 | value >> 5;
        if (format == C3D_RGBA5551 && i == 3) value = value >= 128 ? 255 : 0;
        word |= value << (8 * i);
    }
    return word;
}

thrown_picture thrown_waves(enum c3d_texture_format format, int width, int height)
{
    thrown_picture picture = { format, width, height,
                               malloc((size_t)width * (size_t)height * sizeof(uint32_t)) };
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            int edge = x == 0 || y == 0 || x == width - 1 || y == height - 1;
            const uint32_t channel[4] = { (uint32_t)(128 + 100 * sin(x * 0.23)),
                                          (uint32_t)(128 + 100 * sin(y * 0.19)),
                                          (uint32_t)(128 + 100 * sin((x + 2 * y) * 0.05)),
                                          edge ? 0 : 255 };
            picture.rgba[y * width + x] = kept(format, channel);
        }
    return picture;
}

c3d_texture thrown_upload(c3d_device *device, const thrown_picture *picture)
{
    size_t count = (size_t)picture->width * (size_t)picture->height;
    uint16_t *packed = malloc(count * sizeof *packed);
    for (size_t i = 0; i < count; i++) {
        uint32_t rgba = picture->rgba[i];
        packed[i] = (uint16_t)((rgba >> 3 & 31) << 11 | (rgba >> 11 & 31) << 6 |
                               (rgba >> 19 & 31) << 1 | rgba >> 31);
    }
    c3d_texture texture = c3d_texture_make(
        device, picture->format, (uint32_t)picture->width, (uint32_t)picture->height,
        picture->format == C3D_RGBA8888 ? (const void *)picture->rgba : packed);
    free(packed);
    return texture;
}

c3d_projector thrown_projector(const int64_t origin_wu[3], int32_t yaw, const thrown_picture *onto,
                               double focal)
{
    c3d_projector projector = { { origin_wu[0], origin_wu[1], origin_wu[2] }, { { 0 } } };
    double angle = yaw * (2 * 3.14159265358979323846 / 65536), one = 1 << 24;
    const double forward[3] = { sin(angle), cos(angle), 0 },
                 right[3] = { cos(angle), -sin(angle), 0 }, down[3] = { 0, 0, -1 };
    for (int axis = 0; axis < 3; axis++) {
        projector.row_q24[0][axis] = (int32_t)lround(
            one * (0.5 * forward[axis] + focal / onto->width * right[axis]));
        projector.row_q24[1][axis] = (int32_t)lround(
            one * (0.5 * forward[axis] + focal / onto->height * down[axis]));
        projector.row_q24[2][axis] = (int32_t)lround(one * forward[axis]);
    }
    return projector;
}

/* ---- rays ---- */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

typedef struct ray {
    double way[3]; /* as long as 1 along the eye's axis */
    thrown_pixel *pixel;
} ray;

static void hit_triangle(const ray *from, double corner[3][3], const c3d_vertex *const vertex[3],
                         const c3d_draw *draw, double near_wu)
{
    double edge1[3], edge2[3], p[3], q[3];
    for (int i = 0; i < 3; i++) {
        edge1[i] = corner[1][i] - corner[0][i];
        edge2[i] = corner[2][i] - corner[0][i];
    }
    cross(from->way, edge2, p);
    double det = dot(edge1, p), back[3] = { -corner[0][0], -corner[0][1], -corner[0][2] };
    if (det == 0) return;
    double u = dot(back, p) / det;
    cross(back, edge1, q);
    double v = dot(from->way, q) / det, z = dot(edge2, q) / det;
    thrown_pixel *pixel = from->pixel;
    if (u < 0 || v < 0 || u + v > 1 || z < near_wu || (pixel->hit && pixel->z_wu < z)) return;
    pixel->hit = 1;
    pixel->z_wu = z;
    for (int i = 0; i < 3; i++) {
        pixel->place_wu[i] = from->way[i] * z;
        pixel->rgb[i] = draw->colour >> (8 * i) & 255;
        if (draw->flags & C3D_DRAW_COLOURED)
            pixel->rgb[i] = vertex[0]->rgba[i] * (1 - u - v) + vertex[1]->rgba[i] * u +
                            vertex[2]->rgba[i] * v;
    }
}

/* The eye's axes, as rows: right and up in pixels at distance 1, forward. */
typedef struct eye {
    double row[3][3];
    double near_wu;
} eye;

static eye eye_of(const c3d_camera *camera)
{
    eye from = { .near_wu = camera->near_wu };
    c3d_rotation rotation;
    c3d_rotation_from_camera(camera, &rotation);
    for (int row = 0; row < 3; row++)
        for (int axis = 0; axis < 3; axis++)
            from.row[row][axis] = rotation.m[row][axis] / (double)C3D_ONE_Q30 *
                                  (row < 2 ? camera->focal_q8 / 256.0 : 1);
    return from;
}

/* Columns and rows that a triangle may cover: all when it reaches behind the eye. */
static void find_part(const eye *from, double corner[3][3], int part[4])
{
    double low[2] = { THROWN_WIDE, THROWN_HIGH }, high[2] = { 0, 0 };
    for (int i = 0; i < 3; i++) {
        double z = dot(from->row[2], corner[i]),
               at[2] = { THROWN_WIDE / 2.0 + dot(from->row[0], corner[i]) / z,
                         THROWN_HIGH / 2.0 - dot(from->row[1], corner[i]) / z };
        for (int k = 0; k < 2; k++) {
            low[k] = z <= 0 ? 0 : fmin(low[k], at[k] - 1);
            high[k] = z <= 0 ? INFINITY : fmax(high[k], at[k] + 1);
        }
    }
    for (int k = 0; k < 2; k++) {
        part[k] = (int)fmax(low[k], 0);
        part[2 + k] = (int)fmin(high[k], k ? THROWN_HIGH : THROWN_WIDE);
    }
}

static void hit_pixels(const eye *from, double corner[3][3], const c3d_vertex *const vertex[3],
                       const c3d_draw *draw, thrown_pixel *pixel)
{
    int part[4];
    double focal_q = dot(from->row[0], from->row[0]);
    find_part(from, corner, part);
    for (int y = part[1]; y < part[3]; y++)
        for (int x = part[0]; x < part[2]; x++) {
            ray along = { .pixel = &pixel[y * THROWN_WIDE + x] };
            double right = (x + 0.5 - THROWN_WIDE / 2.0) / focal_q,
                   up = (THROWN_HIGH / 2.0 - y - 0.5) / focal_q;
            for (int axis = 0; axis < 3; axis++)
                along.way[axis] = from->row[0][axis] * right + from->row[1][axis] * up +
                                  from->row[2][axis];
            hit_triangle(&along, corner, vertex, draw, from->near_wu);
        }
}

void thrown_hits(const c3d_frame *frame, const c3d_draw *draw, const thrown_mesh *mesh,
                 thrown_pixel *pixel)
{
    eye from = eye_of(&frame->camera);
    memset(pixel, 0, THROWN_PIXELS * sizeof *pixel);
    for (uint32_t i = 2; i < mesh->indices; i++) {
        const uint16_t *index = mesh->index + i - 2;
        const c3d_vertex *vertex[3];
        double corner[3][3];
        if (index[0] == index[1] || index[1] == index[2] || index[0] == index[2]) continue;
        for (int k = 0; k < 3; k++) {
            vertex[k] = &mesh->vertex[index[k]];
            corner[k][0] = (double)draw->origin_wu[0] + (double)vertex[k]->x * draw->xy_scale_wu;
            corner[k][1] = (double)draw->origin_wu[1] + (double)vertex[k]->y * draw->xy_scale_wu;
            corner[k][2] = (double)draw->origin_wu[2] +
                           vertex[k]->z * (draw->z_scale_q16 / 65536.0);
        }
        hit_pixels(&from, corner, vertex, draw, pixel);
    }
}

/* ---- colours ---- */

int thrown_texel(const c3d_projector *projector, const thrown_picture *picture,
                 const double place_wu[3], double st[2])
{
    double sum[3] = { 0 };
    for (int row = 0; row < 3; row++)
        for (int axis = 0; axis < 3; axis++)
            sum[row] += projector->row_q24[row][axis] *
                        (place_wu[axis] - (double)projector->origin_wu[axis]);
    if (sum[2] <= 0) return 0;
    st[0] = sum[0] / sum[2] * picture->width;
    st[1] = sum[1] / sum[2] * picture->height;
    return st[0] >= 0 && st[1] >= 0 && st[0] < picture->width && st[1] < picture->height;
}

static void sample(const thrown_picture *picture, const double st[2], double out[4])
{
    double s = st[0] - 0.5, t = st[1] - 0.5;
    int column = (int)floor(s), row = (int)floor(t);
    memset(out, 0, 4 * sizeof *out);
    for (int k = 0; k < 4; k++) {
        int x = column + (k & 1), y = row + (k >> 1);
        double weight = (k & 1 ? s - column : column + 1 - s) * (k >> 1 ? t - row : row + 1 - t);
        x = x < 0 ? 0 : x >= picture->width ? picture->width - 1 : x;
        y = y < 0 ? 0 : y >= picture->height ? picture->height - 1 : y;
        for (int i = 0; i < 4; i++)
            out[i] += weight * (picture->rgba[y * picture->width + x] >> (8 * i) & 255);
    }
}

void thrown_paint(const c3d_projector *projector, const thrown_picture *picture,
                  thrown_pixel *pixel)
{
    for (int i = 0; i < THROWN_PIXELS; i++, pixel++) {
        double st[2], texel[4];
        if (!pixel->hit || !thrown_texel(projector, picture, pixel->place_wu, st)) continue;
        sample(picture, st, texel);
        if (texel[3] > 0 && texel[3] < 255) pixel->unsure = 1;
        if (texel[3] >= 127.5) memcpy(pixel->rgb, texel, sizeof pixel->rgb);
    }
}

void thrown_rgb(const c3d_frame *frame, const thrown_pixel *pixel, uint8_t *rgb)
{
    double start = frame->fog_start_wu, end = frame->fog_end_wu;
    for (int i = 0; i < THROWN_PIXELS; i++, pixel++)
        for (int k = 0; k < 3; k++) {
            double clear = end > 0 ? (end - pixel->z_wu) / (end - start) : 1,
                   fog = frame->fog_colour >> (8 * k) & 255;
            clear = clear < 0 ? 0 : clear > 1 ? 1 : clear;
            double value = pixel->hit ? fog + (pixel->rgb[k] - fog) * clear
                                      : (frame->clear_colour >> (8 * k) & 255);
            rgb[i * 3 + k] = (uint8_t)lround(value);
        }
}
