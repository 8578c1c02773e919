#include "scene_fixture.h"
#include "pack_fixture.h"
#include "terrain_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <math.h>
#include <string.h>
#include <stdlib.h>

static uint16_t flat(void *context, uint32_t x, uint32_t y)
{
    (void)context;
    (void)x;
    (void)y;
    return 0;
}

static void make(scene *s, uint16_t (*height)(void *context, uint32_t x, uint32_t y),
                 uint32_t curve_q60)
{
    memset(s, 0, sizeof *s);
    pack_fixture_desc desc = { .info = pack_fixture_info(3, 4, 4), .height = height };
    desc.info.curve_q60 = curve_q60;
    desc.info.spacing_wu = 512 * FF_WU_PER_METRE;
    size_t bytes;
    s->bytes = pack_fixture_make(&desc, &bytes);
    assert_non_null(s->bytes);
    assert_int_equal(ff_pack_open(&s->pack, s->bytes, bytes), FF_OK);
    assert_int_equal(sim_ground_load(&s->ground, &s->pack, UINT64_MAX), FF_OK);
    s->auditor = sim_auditor_create(&s->ground, &s->pack.header.info, SCENE_STEP_PX);
    assert_non_null(s->auditor);
    s->view.camera = (c3d_camera){ .pos_wu = { 8192 * 256, 8192 * 256, 200 * 256 },
                                   .width = 240,
                                   .height = 320,
                                   .focal_q8 = c3d_focal_q8(65536 / 6, 240) };
    s->view.panorama.front_wu = 1;
    s->view.panorama.back_wu = INT32_MAX;
}

void scene_make(scene *s, uint16_t (*height)(void *context, uint32_t x, uint32_t y))
{
    make(s, height, 0);
}

void scene_flat(scene *s) { make(s, flat, 0); }

void scene_round(scene *s) { make(s, flat, FF_CURVE_MAX); }

void scene_draw(scene *s, uint16_t metres)
{
    for (int i = 0; i < SCENE_SIDE * SCENE_SIDE; i++) s->heights[i] = metres;
    for (uint32_t tile = 0; tile < 16; tile++) {
        s->drawn[tile] = (ff_drawn){ .key = ff_key_make(tile, 0, 0),
                                     .heights = s->heights,
                                     .cell_wu = 512 * 256 };
        fixture_origin(&s->pack.header.info, s->drawn[tile].key, s->drawn[tile].origin_wu);
    }
    s->view.drawn = s->drawn;
    s->view.drawn_count = 16;
}

void scene_panorama(scene *s, unsigned face_size, int32_t west_m, int32_t south_m)
{
    sim_panorama *panorama = &s->view.panorama;
    s->view.faces = 63;
    panorama->face_size = face_size;
    memcpy(panorama->pos_wu, s->view.camera.pos_wu, sizeof panorama->pos_wu);
    panorama->pos_wu[0] -= west_m * FF_WU_PER_METRE;
    panorama->pos_wu[1] -= south_m * FF_WU_PER_METRE;
}

void scene_free(scene *s)
{
    sim_auditor_destroy(s->auditor);
    sim_ground_free(&s->ground);
    free(s->bytes);
}

double scene_border_px(const scene *s, double above_m)
{
    return above_m * (s->view.camera.focal_q8 / 256.0) / 8192;
}

void scene_usual_ground(uint8_t **bytes, ff_pack *pack, sim_ground *ground)
{
    size_t count;
    *bytes = pack_fixture_usual(&count);
    assert_non_null(*bytes);
    assert_int_equal(ff_pack_open(pack, *bytes, count), FF_OK);
    assert_int_equal(sim_ground_load(ground, pack, UINT64_MAX), FF_OK);
}

double scene_uniform(sys_random *random, double low, double high)
{
    return low + (high - low) * sys_random_u32(random) / 4294967296.0;
}

void scene_assert_near(double a, double b)
{
    if (fabs(a - b) > 1e-6 * (1 + fabs(b))) fail_msg("%.12g is not %.12g", a, b);
}
