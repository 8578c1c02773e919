/* quantized-mesh tiles, read by a decoder that knows the format's description alone; and the
 * networks of triangles that they are made of. */
#include "../../tools/export/mesh_rtin.h"
#include "../../tools/export/quantized_mesh.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define TILE_BYTES (1u << 22)

/* ---- the decoder ---- */

typedef struct reader {
    const uint8_t *at, *start, *end;
} reader;

typedef struct decoded {
    double centre[3], sphere[3], radius, occlusion[3];
    float low, high;
    uint32_t vertices, triangles, side_count[4];
    int32_t u[100000], v[100000], h[100000];
    uint32_t index[600000], side[4][100000];
    uint8_t oct[200000];
    uint32_t oct_bytes;
} decoded;

static uint64_t take(reader *r, int bytes)
{
    uint64_t value = 0;
    assert_true(r->end - r->at >= bytes);
    for (int i = bytes; i-- > 0;) value = value << 8 | r->at[i];
    r->at += bytes;
    return value;
}

static double take_double(reader *r)
{
    uint64_t bits = take(r, 8);
    double value;
    memcpy(&value, &bits, 8);
    return value;
}

static float take_float(reader *r)
{
    uint32_t bits = (uint32_t)take(r, 4);
    float value;
    memcpy(&value, &bits, 4);
    return value;
}

static void take_values(reader *r, uint32_t count, int32_t *values)
{
    int32_t sum = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t code = (uint32_t)take(r, 2);
        sum += (int32_t)(code >> 1) ^ -(int32_t)(code & 1);
        values[i] = sum;
    }
}

static void take_indices(reader *r, uint32_t count, int bytes, int by_high_water, uint32_t *index)
{
    uint32_t highest = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t code = (uint32_t)take(r, bytes);
        index[i] = by_high_water ? highest - code : code;
        if (by_high_water && !code) highest++;
    }
}

static void decode(const uint8_t *bytes, size_t count, decoded *d)
{
    reader r = { bytes, bytes, bytes + count };
    for (int i = 0; i < 3; i++) d->centre[i] = take_double(&r);
    d->low = take_float(&r);
    d->high = take_float(&r);
    for (int i = 0; i < 3; i++) d->sphere[i] = take_double(&r);
    d->radius = take_double(&r);
    for (int i = 0; i < 3; i++) d->occlusion[i] = take_double(&r);
    d->vertices = (uint32_t)take(&r, 4);
    take_values(&r, d->vertices, d->u);
    take_values(&r, d->vertices, d->v);
    take_values(&r, d->vertices, d->h);
    int wide = d->vertices > 65536 ? 4 : 2;
    while ((r.at - r.start) % wide) take(&r, 1);
    d->triangles = (uint32_t)take(&r, 4);
    take_indices(&r, 3 * d->triangles, wide, 1, d->index);
    for (int s = 0; s < 4; s++) {
        d->side_count[s] = (uint32_t)take(&r, 4);
        take_indices(&r, d->side_count[s], wide, 0, d->side[s]);
    }
    d->oct_bytes = 0;
    if (r.at == r.end) return;
    assert_int_equal(take(&r, 1), 1);
    d->oct_bytes = (uint32_t)take(&r, 4);
    for (uint32_t i = 0; i < d->oct_bytes; i++) d->oct[i] = (uint8_t)take(&r, 1);
    assert_ptr_equal(r.at, r.end);
}

/* ---- a mesh of side x side vertices ---- */

typedef struct fixture {
    quantized_vertex *vertex;
    uint32_t *index;
    quantized_mesh mesh;
    uint8_t *bytes;
    decoded *decoded;
} fixture;

static void make(fixture *f, uint32_t side, quantized_bounds bounds, int has_normals)
{
    uint32_t count = side * side, used = 0, cells = side - 1;
    uint32_t *number = malloc(count * sizeof *number);
    f->vertex = calloc(count, sizeof *f->vertex);
    f->index = malloc(6 * count * sizeof *f->index);
    f->bytes = malloc(TILE_BYTES);
    f->decoded = malloc(sizeof *f->decoded);
    memset(number, 0xff, count * sizeof *number);
    uint32_t *to = f->index;
    for (uint32_t j = 0; j < cells; j++)
        for (uint32_t i = 0; i < cells; i++) {
            uint32_t a = j * side + i,
                     four[6] = { a, a + 1, a + side, a + 1, a + side + 1, a + side };
            for (int n = 0; n < 6; n++) {
                uint32_t p = four[n];
                if (number[p] == UINT32_MAX) {
                    number[p] = used++;
                    quantized_vertex *vertex = &f->vertex[number[p]];
                    vertex->u = (uint16_t)(p % side * QUANTIZED_MESH_MAX / cells);
                    vertex->v = (uint16_t)(p / side * QUANTIZED_MESH_MAX / cells);
                    vertex->h = (uint16_t)((p * 2654435761u >> 7) & QUANTIZED_MESH_MAX);
                    float z = (float)(p % 7) - 3, size = sqrtf(1 + 4 + z * z);
                    vertex->normal[0] = 1 / size;
                    vertex->normal[1] = -2 / size;
                    vertex->normal[2] = z / size;
                }
                *to++ = number[p];
            }
        }
    free(number);
    f->mesh =
        (quantized_mesh){ bounds, f->vertex, count, f->index, 2 * cells * cells, has_normals };
    size_t bytes = quantized_mesh_encode(&f->mesh, f->bytes);
    assert_true(bytes <= quantized_mesh_room(&f->mesh) && bytes <= TILE_BYTES);
    decode(f->bytes, bytes, f->decoded);
}

static void drop(fixture *f)
{
    free(f->vertex);
    free(f->index);
    free(f->bytes);
    free(f->decoded);
}

static const quantized_bounds alps = { 7, 46, 7.02, 46.02, 400, 4500 };

static void same_again(const fixture *f)
{
    const decoded *d = f->decoded;
    assert_int_equal(d->vertices, f->mesh.vertex_count);
    assert_int_equal(d->triangles, f->mesh.triangle_count);
    for (uint32_t i = 0; i < d->vertices; i++) {
        assert_int_equal(d->u[i], f->vertex[i].u);
        assert_int_equal(d->v[i], f->vertex[i].v);
        assert_int_equal(d->h[i], f->vertex[i].h);
    }
    for (uint32_t i = 0; i < 3 * d->triangles; i++) assert_int_equal(d->index[i], f->index[i]);
}

static void vertices_and_triangles_come_back(void **state)
{
    (void)state;
    fixture f;
    make(&f, 33, alps, 0);
    same_again(&f);
    assert_true(f.decoded->low == 400.0f && f.decoded->high == 4500.0f);
    drop(&f);
}

static void more_than_65536_vertices_have_wide_indices(void **state)
{
    (void)state;
    fixture f;
    make(&f, 257, alps, 0);
    same_again(&f);
    drop(&f);
}

static void sides_are_told_west_south_east_north(void **state)
{
    (void)state;
    fixture f;
    make(&f, 17, alps, 0);
    const decoded *d = f.decoded;
    for (int s = 0; s < 4; s++) {
        assert_int_equal(d->side_count[s], 17);
        for (uint32_t i = 0; i < d->side_count[s]; i++) {
            const int32_t *place = s & 1 ? d->v : d->u;
            assert_int_equal(place[d->side[s][i]], s < 2 ? 0 : QUANTIZED_MESH_MAX);
        }
    }
    drop(&f);
}

/* Of a vertex, by the textbook. */
static void place_of(const fixture *f, uint32_t i, double place[3])
{
    const quantized_bounds *b = &f->mesh.bounds;
    const double a = 6378137, flat = 1 / 298.257223563, e2 = flat * (2 - flat),
                 radian = acos(-1) / 180;
    double longitude = (b->west + (b->east - b->west) * f->vertex[i].u / 32767) * radian,
           latitude = (b->south + (b->north - b->south) * f->vertex[i].v / 32767) * radian,
           height = b->low_m + (b->high_m - b->low_m) * f->vertex[i].h / 32767;
    double n = a / sqrt(1 - e2 * sin(latitude) * sin(latitude));
    place[0] = (n + height) * cos(latitude) * cos(longitude);
    place[1] = (n + height) * cos(latitude) * sin(longitude);
    place[2] = (n * (1 - e2) + height) * sin(latitude);
}

static double distance(const double a[3], const double b[3])
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                (a[2] - b[2]) * (a[2] - b[2]));
}

static void the_sphere_holds_all_vertices_and_little_more(void **state)
{
    (void)state;
    fixture f;
    double farthest = 0;
    make(&f, 33, alps, 0);
    for (uint32_t i = 0; i < f.mesh.vertex_count; i++) {
        double place[3];
        place_of(&f, i, place);
        farthest = fmax(farthest, distance(place, f.decoded->sphere));
    }
    assert_true(farthest <= f.decoded->radius + 1e-3 && farthest > f.decoded->radius - 1e-3);
    assert_true(distance(f.decoded->centre, f.decoded->sphere) < f.decoded->radius);
    drop(&f);
}

/* 1 when the Earth hides `to` from `from`, both in the space where the Earth is the unit sphere. */
static int is_hidden(const double from[3], const double to[3])
{
    double way[3] = { to[0] - from[0], to[1] - from[1], to[2] - from[2] }, ww = 0, fw = 0, ff = 0;
    for (int a = 0; a < 3; a++) {
        ww += way[a] * way[a];
        fw += from[a] * way[a];
        ff += from[a] * from[a];
    }
    double under = fw * fw - ww * (ff - 1);
    if (under <= 0) return 0;
    double near = (-fw - sqrt(under)) / ww;
    return near > 0 && near < 1 - 1e-9;
}

static void no_vertex_is_seen_when_the_occlusion_point_is_hidden(void **state)
{
    (void)state;
    fixture f;
    const double radius[3] = { 6378137, 6378137, 6356752.3142 };
    double eye[3], place[3];
    unsigned seed = 1, hidden = 0, seen = 0;
    make(&f, 9, (quantized_bounds){ 5, 40, 11, 46, -100, 4800 }, 0);
    for (int n = 0; n < 20000; n++) {
        double size = 0;
        for (int a = 0; a < 3; a++) {
            seed = seed * 1664525 + 1013904223;
            eye[a] = (double)(seed >> 8) / (1 << 23) - 1 + f.decoded->occlusion[a];
            size += eye[a] * eye[a];
        }
        for (int a = 0; a < 3; a++) eye[a] *= (1.0002 + 0.05 * (n % 10)) / sqrt(size);
        int all_hidden = 1;
        for (uint32_t i = 0; i < f.mesh.vertex_count; i++) {
            place_of(&f, i, place);
            for (int a = 0; a < 3; a++) place[a] /= radius[a];
            all_hidden &= is_hidden(eye, place);
        }
        if (is_hidden(eye, f.decoded->occlusion)) {
            assert_true(all_hidden);
            hidden++;
        } else
            seen++;
    }
    assert_true(hidden > 1000 && seen > 1000);
    drop(&f);
}

static void half_the_earth_is_never_hidden_from_in_front_of_it(void **state)
{
    (void)state;
    fixture f;
    make(&f, 9, (quantized_bounds){ -180, -90, 0, 90, 0, 1 }, 0);
    double size = 0;
    for (int a = 0; a < 3; a++) size += f.decoded->occlusion[a] * f.decoded->occlusion[a];
    assert_true(size > 50 * 50);
    drop(&f);
}

static void normals_come_back_in_two_bytes(void **state)
{
    (void)state;
    fixture f;
    make(&f, 9, alps, 1);
    assert_int_equal(f.decoded->oct_bytes, 2 * f.mesh.vertex_count);
    for (uint32_t i = 0; i < f.mesh.vertex_count; i++) {
        double x = f.decoded->oct[2 * i] / 255.0 * 2 - 1,
               y = f.decoded->oct[2 * i + 1] / 255.0 * 2 - 1, z = 1 - fabs(x) - fabs(y), from_x = x;
        if (z < 0) {
            x = (1 - fabs(y)) * (from_x < 0 ? -1 : 1);
            y = (1 - fabs(from_x)) * (y < 0 ? -1 : 1);
        }
        double size = sqrt(x * x + y * y + z * z);
        const float *normal = f.vertex[i].normal;
        assert_true((x * normal[0] + y * normal[1] + z * normal[2]) / size > 0.9998);
    }
    drop(&f);
}

/* ---- networks ---- */

static float rough(int i, int j, unsigned seed)
{
    unsigned x = (unsigned)i * 73856093u ^ (unsigned)j * 19349663u ^ seed * 83492791u;
    x ^= x >> 13;
    x *= 0x5bd1e995u;
    return 300 * sinf((float)i / 9) * cosf((float)j / 13) +
           (i > 40 ? 40 * (float)((x >> 8) & 255) / 255 : 0);
}

static const double flat_cell[MESH_SIDE] = { 0 };

static void measure(mesh_rtin *rtin, float *height, int shift)
{
    for (int j = 0; j < MESH_SIDE; j++)
        for (int i = 0; i < MESH_SIDE; i++) height[j * MESH_SIDE + i] = rough(i + shift, j, 3);
    mesh_rtin_measure(height, flat_cell, 0, rtin);
}

/* Checks that triangles cover the square once, and returns how far they are from its points. */
static double worst_of(const mesh_rtin *rtin, const float *height)
{
    double worst = 0, area = 0;
    for (uint32_t t = 0; t < rtin->triangle_count; t++) {
        double x[3], y[3], h[3];
        for (int k = 0; k < 3; k++) {
            uint32_t p = rtin->index[3 * t + (uint32_t)k];
            x[k] = p % MESH_SIDE;
            y[k] = p / MESH_SIDE;
            h[k] = height[p];
        }
        double twice = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
        assert_true(twice > 0);
        area += twice / 2;
        for (int j = 0; j < MESH_SIDE; j++)
            for (int i = 0; i < MESH_SIDE; i++) {
                double b = ((i - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (j - y[0])) / twice,
                       c = ((x[1] - x[0]) * (j - y[0]) - (i - x[0]) * (y[1] - y[0])) / twice;
                if (b < 0 || c < 0 || b + c > 1) continue;
                worst = fmax(worst, fabs(h[0] + b * (h[1] - h[0]) + c * (h[2] - h[0]) -
                                         height[j * MESH_SIDE + i]));
            }
    }
    assert_true(area == MESH_CELLS * MESH_CELLS);
    return worst;
}

static void a_network_has_the_error_asked_for(void **state)
{
    (void)state;
    static mesh_rtin rtin;
    static float height[MESH_POINTS];
    static const float asked[] = { 0, 2, 10, 50 };
    uint32_t before = UINT32_MAX;
    measure(&rtin, height, 0);
    for (size_t n = 0; n < sizeof asked / sizeof *asked; n++) {
        mesh_sides sides;
        mesh_rtin_sides(&rtin, asked[n], &sides);
        mesh_rtin_triangulate(&rtin, asked[n], &sides);
        /* a middle may be off by what is asked, and what lies below it by as much from it */
        assert_true(worst_of(&rtin, height) <= 2 * asked[n]);
        assert_true(rtin.triangle_count < before);
        before = rtin.triangle_count;
    }
    assert_true(before < 1000);
}

/* Heights, from the south, of a network's points in a column. */
static int column_of(const mesh_rtin *rtin, const float *height, uint32_t column, float *out)
{
    int count = 0;
    for (uint32_t row = 0; row < MESH_SIDE; row++) {
        int used = 0;
        for (uint32_t i = 0; i < 3 * rtin->triangle_count; i++)
            used |= rtin->index[i] == row * MESH_SIDE + column;
        if (used) out[count++] = height[row * MESH_SIDE + column];
    }
    return count;
}

static void squares_that_touch_have_the_same_points_on_their_side(void **state)
{
    (void)state;
    static mesh_rtin left, right;
    static float height[2][MESH_POINTS];
    float side[2][MESH_SIDE];
    mesh_sides of_left, of_right;
    measure(&left, height[0], 0);
    measure(&right, height[1], MESH_CELLS);
    mesh_rtin_sides(&left, 20, &of_left);
    mesh_rtin_sides(&right, 20, &of_right);
    int unlike = 0;
    for (int i = 0; i < MESH_SIDE; i++) {
        uint8_t both = of_left.used[MESH_EAST][i] | of_right.used[MESH_WEST][i];
        unlike += of_left.used[MESH_EAST][i] != of_right.used[MESH_WEST][i];
        of_left.used[MESH_EAST][i] = of_right.used[MESH_WEST][i] = both;
    }
    assert_true(unlike > 0); /* else nothing is tried */
    mesh_rtin_triangulate(&left, 20, &of_left);
    mesh_rtin_triangulate(&right, 20, &of_right);
    worst_of(&left, height[0]);
    worst_of(&right, height[1]);
    int count = column_of(&left, height[0], MESH_CELLS, side[0]);
    assert_int_equal(count, column_of(&right, height[1], 0, side[1]));
    assert_memory_equal(side[0], side[1], (size_t)count * sizeof **side);
}

static void level_ground_on_a_sphere_is_no_plane(void **state)
{
    (void)state;
    static mesh_rtin rtin;
    static float height[MESH_POINTS];
    double cell_m[MESH_SIDE];
    mesh_sides sides;
    for (int j = 0; j < MESH_SIDE; j++) cell_m[j] = 20000;
    mesh_rtin_measure(height, cell_m, 20000, &rtin);
    mesh_rtin_sides(&rtin, 1000, &sides);
    mesh_rtin_triangulate(&rtin, 1000, &sides);
    /* a chord of c metres lies c^2 / 8R below its ends: 1000 m with 226 km, 11 cells */
    assert_true(rtin.triangle_count >= 2 * 64 && rtin.triangle_count <= 2 * 256);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vertices_and_triangles_come_back),
        cmocka_unit_test(more_than_65536_vertices_have_wide_indices),
        cmocka_unit_test(sides_are_told_west_south_east_north),
        cmocka_unit_test(the_sphere_holds_all_vertices_and_little_more),
        cmocka_unit_test(no_vertex_is_seen_when_the_occlusion_point_is_hidden),
        cmocka_unit_test(half_the_earth_is_never_hidden_from_in_front_of_it),
        cmocka_unit_test(normals_come_back_in_two_bytes),
        cmocka_unit_test(a_network_has_the_error_asked_for),
        cmocka_unit_test(squares_that_touch_have_the_same_points_on_their_side),
        cmocka_unit_test(level_ground_on_a_sphere_is_no_plane),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
