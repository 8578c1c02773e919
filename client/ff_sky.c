#include "ff_sky.h"
#include "../protocol/ff_assert.h"

#include <string.h>

#define COLUMNS 8
#define LEVELS  10
#define RADIUS  256

/* Rings of vertices from nadir to zenith: height and distance from the axis in vertex units. Below
 * the horizon the backdrop turns to the colour of bare ground, 10 to 20 degrees down (distant
 * ground above that ends in fog): what shows there is ground that has not come. */
static const struct {
    int16_t radius, z;
    uint8_t rgb[3];
} ring[LEVELS] = { { 0, -256, { 138, 126, 102 } },  { 240, -90, { 138, 126, 102 } },
                   { 252, -45, { 200, 216, 232 } }, { 256, 0, { 200, 216, 232 } },
                   { 252, 45, { 175, 201, 227 } },  { 240, 90, { 150, 186, 222 } },
                   { 201, 158, { 127, 169, 214 } }, { 150, 210, { 104, 152, 206 } },
                   { 78, 244, { 94, 143, 200 } },   { 0, 256, { 84, 134, 194 } } };
FF_STATIC_ASSERT(LEVELS *COLUMNS == FF_SKY_VERTICES);
/* of each band two for every column and the first again, and two between bands */
FF_STATIC_ASSERT((LEVELS - 1) * (2 * (COLUMNS + 1) + 2) - 2 == FF_SKY_INDICES);
static const int8_t circle[COLUMNS][2] = { { 0, 64 },  { 45, 45 },   { 64, 0 },  { 45, -45 },
                                           { 0, -64 }, { -45, -45 }, { -64, 0 }, { -45, 45 } };

static void set_vertex(c3d_vertex *vertex, int level, int column)
{
    FF_ASSERT(level < LEVELS && column < COLUMNS);
    memset(vertex, 0, sizeof *vertex);
    vertex->x = circle[column][0] * ring[level].radius / 64;
    vertex->y = circle[column][1] * ring[level].radius / 64;
    vertex->z = ring[level].z;
    memcpy(vertex->rgba, ring[level].rgb, 3);
    vertex->rgba[3] = 255;
}

/* Bands of quads between neighbouring rings as one strip, bands joined by degenerate triangles. */
static uint32_t make_indices(uint16_t *index)
{
    uint32_t count = 0;
    for (int level = 0; level + 1 < LEVELS; level++) {
        for (int i = 0; i <= COLUMNS; i++) {
            uint16_t low = (uint16_t)(level * COLUMNS + i % COLUMNS);
            if (i == 0 && count) {
                index[count] = index[count - 1];
                count++;
                index[count++] = low;
            }
            index[count++] = low;
            index[count++] = (uint16_t)(low + COLUMNS);
        }
    }
    return count;
}

void ff_sky_make(ff_sky *sky, c3d_device *device)
{
    c3d_vertex vertex[FF_SKY_VERTICES];
    uint16_t index[FF_SKY_INDICES];
    for (int i = 0; i < FF_SKY_VERTICES; i++) set_vertex(&vertex[i], i / COLUMNS, i % COLUMNS);
    uint32_t count = make_indices(index);
    FF_ASSERT(count == FF_SKY_INDICES);
    sky->mesh = c3d_mesh_make(device, vertex, FF_SKY_VERTICES);
    sky->strip = c3d_strip_make(device, index, count);
}

void ff_sky_draw(const ff_sky *sky, c3d_device *device, int32_t near_wu)
{
    if (!sky->mesh.id || !sky->strip.id) return;
    int32_t scale_wu = 4 * (near_wu / RADIUS + 1);
    c3d_draw draw = { .mesh = sky->mesh,
                      .strip = sky->strip,
                      .xy_scale_wu = scale_wu,
                      .z_scale_q16 = (uint32_t)scale_wu << 16,
                      .flags = C3D_DRAW_COLOURED | C3D_DRAW_BACKDROP };
    c3d_draw_strip(device, &draw);
}
