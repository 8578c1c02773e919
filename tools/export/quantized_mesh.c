#include "quantized_mesh.h"

#include "../../protocol/ff_assert.h"

#include <math.h>
#include <string.h>

#define RADIUS_A_M    6378137.0
#define RADIUS_B_M    6356752.3142451793
#define RADIANS       0.017453292519943295
#define HEADER_BYTES  88
#define NORMALS_ID    1
#define WIDE_VERTICES 65536u /* with more of them indices have 32 bits */
#define FAR_AWAY      100.0  /* radii: for tiles of which some part is always in sight */

/* ---- places ---- */

void quantized_place(double longitude, double latitude, double height_m, double place_m[3])
{
    double e2 = 1 - (RADIUS_B_M * RADIUS_B_M) / (RADIUS_A_M * RADIUS_A_M),
           s = sin(latitude * RADIANS), c = cos(latitude * RADIANS),
           n = RADIUS_A_M / sqrt(1 - e2 * s * s);
    place_m[0] = (n + height_m) * c * cos(longitude * RADIANS);
    place_m[1] = (n + height_m) * c * sin(longitude * RADIANS);
    place_m[2] = (n * (1 - e2) + height_m) * s;
}

static double between(double low, double high, uint16_t part)
{
    return low + (high - low) * part / QUANTIZED_MESH_MAX;
}

static void place_vertex(const quantized_mesh *mesh, uint32_t number, double place_m[3])
{
    const quantized_bounds *b = &mesh->bounds;
    const quantized_vertex *vertex = &mesh->vertex[number];
    quantized_place(between(b->west, b->east, vertex->u), between(b->south, b->north, vertex->v),
                    between(b->low_m, b->high_m, vertex->h), place_m);
}

static double length(const double v[3]) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

/* ---- the header ---- */

/* The sphere round the box that holds all vertices, no larger than they need. Returns its radius.
 */
static double bound(const quantized_mesh *mesh, double centre_m[3])
{
    double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY },
           place[3], radius_m = 0;
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        place_vertex(mesh, i, place);
        for (int a = 0; a < 3; a++) {
            low[a] = fmin(low[a], place[a]);
            high[a] = fmax(high[a], place[a]);
        }
    }
    for (int a = 0; a < 3; a++) centre_m[a] = (low[a] + high[a]) / 2;
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        place_vertex(mesh, i, place);
        for (int a = 0; a < 3; a++) place[a] -= centre_m[a];
        radius_m = fmax(radius_m, length(place));
    }
    return radius_m;
}

/* How far out along `direction`, in the space where the ellipsoid is the unit sphere, a point lies
 * that sees over the horizon whatever sees `place` (K. Ring and P. Cozzi, "Horizon culling 2",
 * 2013). FAR_AWAY: none does. */
static double magnitude(const double place_m[3], const double direction[3])
{
    double p[3] = { place_m[0] / RADIUS_A_M, place_m[1] / RADIUS_A_M, place_m[2] / RADIUS_B_M };
    double far = length(p), cos_a = 0;
    for (int a = 0; a < 3; a++) cos_a += p[a] / far * direction[a];
    double sin_a = sqrt(fmax(0, 1 - cos_a * cos_a));
    far = fmax(far, 1);
    double cos_b = 1 / far, sin_b = sqrt(far * far - 1) * cos_b,
           cosine = cos_a * cos_b - sin_a * sin_b;
    return cosine * FAR_AWAY > 1 ? 1 / cosine : FAR_AWAY;
}

static void find_occlusion(const quantized_mesh *mesh, const double centre_m[3], double point[3])
{
    double direction[3] = { centre_m[0] / RADIUS_A_M, centre_m[1] / RADIUS_A_M,
                            centre_m[2] / RADIUS_B_M },
           size = length(direction), most = 0;
    for (int a = 0; a < 3; a++) direction[a] /= size;
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        double place[3];
        place_vertex(mesh, i, place);
        most = fmax(most, magnitude(place, direction));
    }
    for (int a = 0; a < 3; a++) point[a] = direction[a] * most;
}

/* ---- bytes ---- */

/* Where the next byte goes. */
typedef struct byte_sink {
    uint8_t *start, *at;
} byte_sink;

static void put(byte_sink *sink, uint64_t value, int bytes)
{
    for (int i = 0; i < bytes; i++) *sink->at++ = (uint8_t)(value >> (8 * i));
}

static void put_double(byte_sink *sink, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put(sink, bits, 8);
}

static void put_float(byte_sink *sink, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put(sink, bits, 4);
}

static void put_point(byte_sink *sink, const double point[3])
{
    for (int a = 0; a < 3; a++) put_double(sink, point[a]);
}

static void put_header(byte_sink *sink, const quantized_mesh *mesh)
{
    const quantized_bounds *b = &mesh->bounds;
    double middle[3], centre[3], occlusion[3];
    quantized_place((b->west + b->east) / 2, (b->south + b->north) / 2, (b->low_m + b->high_m) / 2,
                    middle);
    double radius_m = bound(mesh, centre);
    find_occlusion(mesh, middle, occlusion);
    put_point(sink, middle);
    put_float(sink, (float)b->low_m);
    put_float(sink, (float)b->high_m);
    put_point(sink, centre);
    put_double(sink, radius_m);
    put_point(sink, occlusion);
}

/* A difference of two numbers: small ones of either sign become small ones. */
static uint16_t zigzag(int difference)
{
    return (uint16_t)(difference < 0 ? -2 * difference - 1 : 2 * difference);
}

static void put_vertices(byte_sink *sink, const quantized_mesh *mesh)
{
    put(sink, mesh->vertex_count, 4);
    for (int axis = 0; axis < 3; axis++) {
        int last = 0;
        for (uint32_t i = 0; i < mesh->vertex_count; i++) {
            const quantized_vertex *vertex = &mesh->vertex[i];
            int value = axis == 0 ? vertex->u : axis == 1 ? vertex->v : vertex->h;
            put(sink, zigzag(value - last), 2);
            last = value;
        }
    }
}

static int index_bytes(const quantized_mesh *mesh)
{
    return mesh->vertex_count > WIDE_VERTICES ? 4 : 2;
}

/* Each index as its distance from the highest one so far: 0 for a new vertex. */
static void put_triangles(byte_sink *sink, const quantized_mesh *mesh)
{
    int bytes = index_bytes(mesh);
    uint32_t next = 0;
    while ((sink->at - sink->start) % bytes) put(sink, 0, 1);
    put(sink, mesh->triangle_count, 4);
    for (uint32_t i = 0; i < 3 * mesh->triangle_count; i++) {
        FF_ASSERT(mesh->index[i] <= next);
        put(sink, next - mesh->index[i], bytes);
        if (mesh->index[i] == next) next++;
    }
}

/* The vertices of the tile's sides: west, south, east, north. */
static void put_sides(byte_sink *sink, const quantized_mesh *mesh)
{
    for (int side = 0; side < 4; side++) {
        uint8_t *count_at = sink->at;
        uint32_t count = 0;
        put(sink, 0, 4);
        for (uint32_t i = 0; i < mesh->vertex_count; i++) {
            uint16_t place = side & 1 ? mesh->vertex[i].v : mesh->vertex[i].u;
            if (place != (side < 2 ? 0 : QUANTIZED_MESH_MAX)) continue;
            put(sink, i, index_bytes(mesh));
            count++;
        }
        byte_sink at = { sink->start, count_at };
        put(&at, count, 4);
    }
}

/* A direction in two bytes: the octahedron it points to, unfolded (Q. Meyer et al., "On
 * floating-point normal vectors", 2010). */
static void put_normal(byte_sink *sink, const float normal[3])
{
    float sum = fabsf(normal[0]) + fabsf(normal[1]) + fabsf(normal[2]);
    float x = normal[0] / sum, y = normal[1] / sum;
    if (normal[2] < 0) {
        float folded = (1 - fabsf(y)) * (x < 0 ? -1.0f : 1.0f);
        y = (1 - fabsf(x)) * (y < 0 ? -1.0f : 1.0f);
        x = folded;
    }
    put(sink, (uint64_t)lrintf((x * 0.5f + 0.5f) * 255), 1);
    put(sink, (uint64_t)lrintf((y * 0.5f + 0.5f) * 255), 1);
}

size_t quantized_mesh_room(const quantized_mesh *mesh)
{
    size_t wide = (size_t)index_bytes(mesh);
    return HEADER_BYTES + 64 + (size_t)mesh->vertex_count * (8 + 4 * wide) +
           3 * wide * mesh->triangle_count;
}

size_t quantized_mesh_encode(const quantized_mesh *mesh, uint8_t *bytes)
{
    byte_sink sink = { bytes, bytes };
    put_header(&sink, mesh);
    put_vertices(&sink, mesh);
    put_triangles(&sink, mesh);
    put_sides(&sink, mesh);
    if (mesh->has_normals) {
        put(&sink, NORMALS_ID, 1);
        put(&sink, 2 * (uint64_t)mesh->vertex_count, 4);
        for (uint32_t i = 0; i < mesh->vertex_count; i++) put_normal(&sink, mesh->vertex[i].normal);
    }
    FF_ASSERT((size_t)(sink.at - bytes) <= quantized_mesh_room(mesh));
    return (size_t)(sink.at - bytes);
}
