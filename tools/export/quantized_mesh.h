/* A tile of terrain in Cesium's format quantized-mesh 1.0
 * (https://github.com/CesiumGS/quantized-mesh).
 *
 * A tile covers a rectangle of degrees. Its vertices are 16-bit integers: u from west to east, v
 * from south to north, h from the lowest to the highest, each 0 .. 32767. Its header places it on
 * the WGS84 ellipsoid: the middle, a sphere that holds it, and the point from whose disappearance
 * below the horizon the whole tile's follows. Skirts are the reader's business. Pure: bytes from
 * numbers.
 */
#ifndef QUANTIZED_MESH_H
#define QUANTIZED_MESH_H

#include <stddef.h>
#include <stdint.h>

#define QUANTIZED_MESH_MAX 32767 /* of u, v and h */

typedef struct quantized_bounds {
    double west, south, east, north; /* degrees */
    double low_m, high_m;            /* above the ellipsoid */
} quantized_bounds;

typedef struct quantized_vertex {
    uint16_t u, v, h;
    float normal[3]; /* of unit length, in Earth-centred axes; used with has_normals */
} quantized_vertex;

typedef struct quantized_mesh {
    quantized_bounds bounds;
    const quantized_vertex *vertex;
    uint32_t vertex_count;
    /* Three vertices a triangle, counter-clockwise from above; a vertex's first use comes after
     * that of all before it. */
    const uint32_t *index;
    uint32_t triangle_count;
    int has_normals; /* with the extension octvertexnormals */
} quantized_mesh;

/* WGS84: Earth-centred metres of a place in degrees. */
void quantized_place(double longitude, double latitude, double height_m, double place_m[3]);
/* How many bytes the tile takes at most. */
size_t quantized_mesh_room(const quantized_mesh *mesh);
/* Writes the tile; returns its bytes. */
size_t quantized_mesh_encode(const quantized_mesh *mesh, uint8_t *bytes);

#endif
