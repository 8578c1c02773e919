/* Pictures thrown on meshes: every back end against rays in double precision, which go from the eye
 * through a pixel to the mesh, and from there to the projector's picture. */
#include "../rig/picture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>

#define M PICTURE_M

enum { WIDE = 120, HIGH = 90, CELLS = 12, SIDE = 64, STEP = 4, CELL_M = 500, BARE_BLUE = 255 };

typedef struct scene {
    c3d_vertex vertex[(CELLS + 1) * (CELLS + 1)];
    c3d_projector projector; /* its point: from the eye */
    double from_m[3];        /* the mesh's origin, from the eye */
} scene;

static const double row_of[3][3] = { { 1.2, 0.5, 0 }, { 0, 0.5, -1.5 }, { 0, 1, 0 } };

/* Hills before the eye, and a projector that looks north. */
static void make_scene(scene *s, const double point_m[3])
{
    for (int i = 0; i < (CELLS + 1) * (CELLS + 1); i++) {
        int x = i % (CELLS + 1), y = i / (CELLS + 1);
        s->vertex[i] = (c3d_vertex){ .x = x, .y = y, .z = 110 * ((x * 7 + y * 5) % 11) };
        s->vertex[i].rgba[2] = BARE_BLUE;
        s->vertex[i].rgba[3] = 255;
    }
    s->from_m[0] = -CELLS * CELL_M / 2.0;
    s->from_m[1] = 2000;
    s->from_m[2] = -1300;
    for (int i = 0; i < 3; i++) {
        s->projector.origin_wu[i] = (int64_t)(point_m[i] * M);
        for (int axis = 0; axis < 3; axis++)
            s->projector.row_q24[i][axis] = (int32_t)lrint(row_of[i][axis] * (1 << 24));
    }
}

/* Red tells the column, green the row; a quarter has nothing, nor has the rim. */
static int is_bare(int column, int row)
{
    return column == 0 || row == 0 || column == SIDE - 1 || row == SIDE - 1 ||
           (column < 24 && row < 28);
}

static void make_texels(uint8_t texels[SIDE][SIDE][4])
{
    for (int row = 0; row < SIDE; row++)
        for (int column = 0; column < SIDE; column++) {
            uint8_t *texel = texels[row][column];
            texel[0] = (uint8_t)(STEP * column);
            texel[1] = (uint8_t)(STEP * row);
            texel[2] = 0;
            texel[3] = is_bare(column, row) ? 0 : 255;
        }
}

static uint32_t make_strip(uint16_t index[CELLS * (2 * CELLS + 4)])
{
    uint32_t count = 0;
    for (int y = 0; y < CELLS; y++)
        for (int x = 0; x <= CELLS; x++) {
            uint16_t here = (uint16_t)(y * (CELLS + 1) + x);
            if (x == 0 && y > 0) index[count] = index[count - 1], count++;
            if (x == 0 && y > 0) index[count++] = (uint16_t)(here + CELLS + 1);
            index[count++] = (uint16_t)(here + CELLS + 1);
            index[count++] = here;
        }
    return count;
}

/* How far along the ray a triangle is met; 0: it is not. */
static double meet(double corner[3][3], const double ray[3])
{
    double e1[3], e2[3], p[3], q[3];
    for (int i = 0; i < 3; i++)
        e1[i] = corner[1][i] - corner[0][i], e2[i] = corner[2][i] - corner[0][i];
    for (int i = 0; i < 3; i++)
        p[i] = ray[(i + 1) % 3] * e2[(i + 2) % 3] - ray[(i + 2) % 3] * e2[(i + 1) % 3];
    double det = e1[0] * p[0] + e1[1] * p[1] + e1[2] * p[2];
    if (fabs(det) < 1e-9) return 0;
    double u = -(corner[0][0] * p[0] + corner[0][1] * p[1] + corner[0][2] * p[2]) / det;
    for (int i = 0; i < 3; i++)
        q[i] = -corner[0][(i + 1) % 3] * e1[(i + 2) % 3] + corner[0][(i + 2) % 3] * e1[(i + 1) % 3];
    double v = (ray[0] * q[0] + ray[1] * q[1] + ray[2] * q[2]) / det,
           t = (e2[0] * q[0] + e2[1] * q[1] + e2[2] * q[2]) / det;
    return u < 0 || v < 0 || u + v > 1 || t < 0 ? 0 : t;
}

static void corner_of(const scene *s, int i, double place[3])
{
    place[0] = s->from_m[0] + s->vertex[i].x * CELL_M;
    place[1] = s->from_m[1] + s->vertex[i].y * CELL_M;
    place[2] = s->from_m[2] + s->vertex[i].z;
}

/* The nearest place of the mesh on a ray; 0: there is none. */
static int find(const scene *s, const double ray[3], double place[3])
{

    double best = 0;
    for (int cell = 0; cell < CELLS * (CELLS + 1); cell++)
        for (int half = 0; half < 2 && cell % (CELLS + 1) < CELLS; half++) {
            /* the strip's diagonals run from north-west to south-east */
            static const int strip[2][3] = { { CELLS + 1, 0, CELLS + 2 }, { 0, CELLS + 2, 1 } };
            double corner[3][3];

            for (int c = 0; c < 3; c++) corner_of(s, cell + strip[half][c], corner[c]);
            double t = meet(corner, ray);
            if (t > 0 && (best == 0 || t < best)) best = t;
        }
    for (int i = 0; i < 3; i++) place[i] = ray[i] * best;
    return best > 0;
}

/* What a place should show: 1 thrown, with column and row, 0 bare, -1 too near to an edge between
 * the two to tell. */
static int expect(const scene *s, const double place[3], double texel[2])
{
    double sum[3] = { 0, 0, 0 };
    for (int i = 0; i < 3; i++)
        for (int axis = 0; axis < 3; axis++)
            sum[i] += row_of[i][axis] * (place[axis] - s->projector.origin_wu[axis] / (double)M);
    if (sum[2] <= 0) return 0;
    texel[0] = sum[0] / sum[2] * SIDE - 0.5;
    texel[1] = sum[1] / sum[2] * SIDE - 0.5;
    int all = -1;
    for (int i = 0; i < 9; i++) {
        double column = texel[0] + i % 3 - 1, row = texel[1] + i / 3 - 1;
        int inside = column > 0 && row > 0 && column < SIDE - 1 && row < SIDE - 1 &&
                     !is_bare((int)lrint(column), (int)lrint(row));
        if (all >= 0 && all != inside) return -1;
        all = inside;
    }
    return all;
}

typedef struct counts {
    int thrown, bare, wrong;
    double most; /* texels off */
} counts;

static void judge(const scene *s, const c3d_camera *camera, const uint8_t *rgb, counts *tally)
{
    double focal = camera->focal_q8 / 256.0;
    for (int y = 1; y + 1 < HIGH; y++)
        for (int x = 1; x + 1 < WIDE; x++) {
            const uint8_t *pixel = rgb + 3 * (y * WIDE + x);
            const double ray[3] = { (x + 0.5 - WIDE / 2.0) / focal, 1,
                                    (HIGH / 2.0 - y - 0.5) / focal };
            double place[3], texel[2];
            if (!find(s, ray, place)) continue;
            int is = expect(s, place, texel);
            if (is < 0) continue;
            double off = fmax(fabs(pixel[0] - STEP * texel[0]), fabs(pixel[1] - STEP * texel[1])) /
                         STEP;
            if (is == 0) tally->bare++, tally->wrong += pixel[2] < BARE_BLUE - 8;
            if (is == 1) tally->thrown++, tally->wrong += off > 1 || pixel[2] > 8;
            if (is == 1 && off <= 1 && off > tally->most) tally->most = off;
        }
}

static void draw_scene(picture_kit *kit, const scene *s, int twice, uint8_t *rgb)
{
    static uint8_t texels[SIDE][SIDE][4];
    static uint16_t index[CELLS * (2 * CELLS + 4)];
    make_texels(texels);
    uint32_t count = make_strip(index);
    c3d_draw draw = { .mesh = c3d_mesh_make(kit->device, s->vertex,
                                            sizeof s->vertex / sizeof *s->vertex),
                      .strip = c3d_strip_make(kit->device, index, count),
                      .xy_scale_wu = CELL_M * M,
                      .z_scale_q16 = M << 16,
                      .flags = C3D_DRAW_COLOURED | (twice ? 0 : C3D_DRAW_PROJECTED),
                      .texture = c3d_texture_make(kit->device, C3D_RGBA8888, SIDE, SIDE, texels),
                      .projector = &s->projector };
    assert_true(draw.mesh.id && draw.strip.id && draw.texture.id);
    for (int i = 0; i < 3; i++) draw.origin_wu[i] = (int64_t)(s->from_m[i] * M);
    c3d_begin(kit->device, &kit->frame);
    c3d_draw_strip(kit->device, &draw);
    draw.flags = C3D_DRAW_COLOURED | C3D_DRAW_PROJECTED | C3D_DRAW_ALPHA_TEST;
    if (twice) c3d_draw_strip(kit->device, &draw);
    c3d_end(kit->device);
    assert_int_equal(c3d_read_rgb(kit->device, rgb), FF_OK);
    c3d_mesh_free(kit->device, draw.mesh);
    c3d_strip_free(kit->device, draw.strip);
    c3d_texture_free(kit->device, draw.texture);
}

static const double points_m[][3] = { { 0, 0, 0 },
                                      { 900, -700, 400 },
                                      { -1500, 1200, 800 },
                                      { 0, 30000, 0 } };
enum { POINTS = sizeof points_m / sizeof *points_m };

static void throw_from_everywhere(enum picture_kind kind, int twice)
{
    static scene s;
    static uint8_t rgb[WIDE * HIGH * 3];
    picture_kit kit;
    if (picture_open(&kit, kind, WIDE, HIGH, 1) != FF_OK) return;
    kit.frame.camera.focal_q8 = 100 * 256;
    kit.frame.camera.near_wu = 100 * M;
    kit.frame.camera.far_wu = 40000 * M;
    for (int i = 0; i < POINTS; i++) {
        counts tally = { 0, 0, 0, 0 };
        make_scene(&s, points_m[i]);
        draw_scene(&kit, &s, twice, rgb);
        judge(&s, &kit.frame.camera, rgb, &tally);
        print_message("kind %d, point %d: %d thrown, %d bare, %d wrong, %.2f texels off\n", kind, i,
                      tally.thrown, tally.bare, tally.wrong, tally.most);
        assert_true(tally.thrown + tally.bare > 2000);
        assert_true(i >= 3 || tally.thrown > 200);
        assert_in_range(tally.wrong, 0, (tally.thrown + tally.bare) / 100); /* edges of hills */
        assert_true(tally.most <= 0.4);
    }
    picture_close(&kit);
}

static void a_thrown_picture_lies_where_rays_say(void **state)
{
    (void)state;
    for (int kind = 0; kind < PICTURE_KINDS; kind++)
        if (kind != PICTURE_SOFT_565) throw_from_everywhere((enum picture_kind)kind, 0);
}

static void thrown_over_plain_ground_it_is_the_same(void **state)
{
    (void)state;
    for (int kind = 0; kind < PICTURE_KINDS; kind++)
        if (kind != PICTURE_SOFT_565) throw_from_everywhere((enum picture_kind)kind, 1);
}

static void without_texture_or_projector_ground_is_plain(void **state)
{
    static scene s;
    static uint8_t rgb[WIDE * HIGH * 3], plain[WIDE * HIGH * 3];
    picture_kit kit;
    c3d_stats stats;
    (void)state;
    assert_int_equal(picture_open(&kit, PICTURE_SOFT, WIDE, HIGH, 1), FF_OK);
    c3d_draw draw = picture_square(&kit, PICTURE_LEVEL, -4000 * M, 1000 * M, -300 * M, 8000 * M,
                                   PICTURE_RED);
    picture_render(&kit, &draw, 1, plain);
    make_scene(&s, points_m[0]);
    draw.flags |= C3D_DRAW_PROJECTED;
    picture_render(&kit, &draw, 1, rgb);
    assert_memory_equal(rgb, plain, sizeof rgb);
    draw.projector = &s.projector; /* and no texture */
    picture_render(&kit, &draw, 1, rgb);
    assert_memory_equal(rgb, plain, sizeof rgb);
    c3d_get_stats(kit.device, &stats);
    assert_int_equal(stats.stale_handles, 2);
    picture_close(&kit);
}

static void depths_are_read_as_they_are(void **state)
{
    static int32_t depth_wu[WIDE * HIGH];
    static uint8_t rgb[WIDE * HIGH * 3];
    picture_kit kit;
    (void)state;
    assert_int_equal(picture_open(&kit, PICTURE_SOFT, WIDE, HIGH, 1), FF_OK);
    c3d_draw draw = picture_square(&kit, PICTURE_LEVEL, -4000 * M, 100 * M, -300 * M, 3000 * M,
                                   PICTURE_RED);
    draw.origin_wu[0] = -1500 * M;
    picture_render(&kit, &draw, 1, rgb);
    assert_int_equal(c3d_read_depth(kit.device, depth_wu), FF_OK);
    double focal = kit.frame.camera.focal_q8 / 256.0;
    for (int y = 0; y < HIGH; y++) {
        double down = (y + 0.5 - HIGH / 2.0) / focal, away_m = down > 0 ? 300 / down : INFINITY;
        int32_t found = depth_wu[y * WIDE + WIDE / 2];
        if (away_m > 3200 || away_m < 50)
            assert_int_equal(found, INT32_MAX);
        else if (away_m < 3000 && away_m > 120)
            assert_true(fabs(found / (double)M - away_m) <= away_m / 500 + 0.1);
    }
    picture_close(&kit);
    if (picture_open(&kit, PICTURE_GL, WIDE, HIGH, 1) != FF_OK) return;
    assert_int_equal(c3d_read_depth(kit.device, depth_wu), FF_ERR_ARGUMENT);
    picture_render(&kit, &draw, 0, rgb);
    assert_int_equal(c3d_read_depth(kit.device, depth_wu), FF_ERR_UNSUPPORTED);
    picture_close(&kit);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_thrown_picture_lies_where_rays_say),
        cmocka_unit_test(thrown_over_plain_ground_it_is_the_same),
        cmocka_unit_test(without_texture_or_projector_ground_is_plain),
        cmocka_unit_test(depths_are_read_as_they_are),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
