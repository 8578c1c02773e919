/* What the server makes of a pack's far ground: four places at four heights, of two widths. */
#include "../../protocol/shape/ff_shape.h"
#include "../../server/far/ff_far_render.h"
#include "../bake/bake_say.h"
#include "../info/bake_unpack.h"
#include "train_far.h"
#include "train_ground.h"

#include <stdlib.h>
#include <string.h>

#define M       FF_WU_PER_METRE
#define PLACES  4
#define HEIGHTS 4
#define WIDTHS  2
#define FRONT_M 7500
#define ANSWER  (1 << 19)

/* As client/far/ff_sets_plan.c asks. */
typedef struct height_row {
    int32_t clearance_m, life_m, lift_m;
} height_row;
static const height_row height[HEIGHTS] = { { 100, 1800, 150 },
                                            { 600, 3200, 300 },
                                            { 2000, 4400, 400 },
                                            { 12000, 11500, 400 } };
static const uint16_t focal[WIDTHS] = { 208, 554 }; /* of pictures 240 and 640 wide */
static const uint16_t half_height[WIDTHS] = { 160, 240 };

typedef struct keeper {
    train_vistas *vistas;
    const char *path;
    int rc;
} keeper;

static void *copy_of(const void *from, size_t bytes)
{
    void *to = malloc(bytes + 1);
    if (to) memcpy(to, from, bytes);
    return to;
}

static void keep(void *context, const ff_paint_source *paint, const uint8_t *needed,
                 const ff_fin_vertex *vertex, uint32_t count)
{
    keeper *k = context;
    train_vistas *all = k->vistas;
    train_vista v = { .path = k->path, .count = count };
    if (all->count == all->room) {
        all->room = all->room ? 2 * all->room : 256;
        train_vista *grown = realloc(all->vista, all->room * sizeof *grown);
        if (!grown) k->rc = bake_fail("out of memory");
        if (!grown) return;
        all->vista = grown;
    }
    v.vertex = copy_of(vertex, count * sizeof *vertex);
    if (paint) {
        size_t texels = (size_t)paint->columns * paint->rows * 64;
        v.paint = (ff_paint_source){ .columns = paint->columns,
                                     .rows = paint->rows,
                                     .there = copy_of(paint->there, texels / 64),
                                     .rgb = copy_of(paint->rgb, 3 * texels) };
        v.needed = copy_of(needed, texels);
        if (!v.paint.there || !v.paint.rgb || !v.needed) k->rc = bake_fail("out of memory");
    }
    all->vista[all->count++] = v;
}

static ff_get_far request_at(const ff_terrain_info *info, const train_ground *ground,
                             unsigned place, unsigned h, unsigned width)
{
    const height_row *row = &height[h];
    int32_t high_m = row->clearance_m * 4 / 5, front_m = high_m > FRONT_M ? high_m : FRONT_M;
    uint32_t x = ground->width / 4 * (1 + 2 * (place & 1u)) + ground->width / 16 * h,
             y = ground->height / 4 * (1 + 2 * (place >> 1)) - ground->height / 16 * h;
    uint32_t sample = ground->heights[(size_t)y * ground->width + x];
    int64_t size_wu[2];
    ff_shape_size_wu(info, size_wu);
    int32_t lift = focal[width] * row->lift_m / front_m;
    return (ff_get_far){ .position_wu = { (int32_t)(size_wu[0] * x / (ground->width - 1)),
                                          (int32_t)(size_wu[1] * y / (ground->height - 1)),
                                          ff_height_wu(info, sample) +
                                              (row->clearance_m + row->lift_m) * M },
                         .front_wu = front_m * M,
                         .heading = (uint16_t)(place * 16384 + 4096),
                         .behind_m = (uint16_t)(row->life_m / 4 + 300),
                         .ahead_m = (uint16_t)(row->life_m * 3 / 4),
                         .aside_m = (uint16_t)(row->life_m / 6),
                         .low_m = (int16_t)(-row->lift_m - row->life_m / 4),
                         .focal = focal[width],
                         .down = (uint16_t)(half_height[width] + lift + 8),
                         .quality = 50,
                         .tolerance_q2 = 2 };
}

static int look_round(ff_far_renderer *renderer, const ff_terrain_info *info,
                      const train_ground *ground, keeper *k)
{
    uint8_t *answer = malloc(ANSWER);
    int rc = answer ? FF_OK : FF_ERR_MEMORY;
    for (unsigned i = 0; rc >= 0 && !k->rc && i < PLACES * HEIGHTS * WIDTHS; i++) {
        unsigned place = i % PLACES, h = i / PLACES % HEIGHTS;
        ff_get_far request = request_at(info, ground, place, h, i / PLACES / HEIGHTS);
        for (unsigned s = 0; rc >= 0 && s < 2; s++)
            rc = ff_far_render_sector(renderer, &request, (uint8_t)((place * 4 + 1 + s + h) % 16),
                                      0, answer, ANSWER);
    }
    free(answer);
    return rc < 0 ? bake_fail("%s: %s", k->path, ff_error_text(rc)) : k->rc;
}

int train_vistas_add(train_vistas *vistas, const char *path)
{
    train_ground ground;
    bake_unpack unpack;
    ff_far_renderer *renderer = NULL;
    keeper k = { .vistas = vistas, .path = path };
    const ff_far_watch watch = { &k, keep };
    if (train_ground_open(&ground, path)) return -1;
    int rc = bake_unpack_open(&unpack, path);
    if (rc) return train_ground_close(&ground), -1;
    int opened = ff_far_renderer_open(&unpack.pack, &renderer);
    if (opened == FF_OK) {
        ff_far_renderer_watch(renderer, &watch);
        rc = look_round(renderer, &unpack.pack.header.info, &ground, &k);
    } else {
        rc = bake_fail("%s: %s", path, ff_error_text(opened));
    }
    ff_far_renderer_close(renderer);
    bake_unpack_close(&unpack);
    train_ground_close(&ground);
    return rc;
}

void train_vistas_close(train_vistas *vistas)
{
    for (unsigned i = 0; i < vistas->count; i++) {
        free((void *)vistas->vista[i].paint.there);
        free((void *)vistas->vista[i].paint.rgb);
        free(vistas->vista[i].needed);
        free(vistas->vista[i].vertex);
    }
    free(vistas->vista);
}
