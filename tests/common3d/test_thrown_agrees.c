/* Pictures thrown on meshes: all back ends against pictures made of rays in double precision
 * (thrown_rig.h); and depths, where backdrops and walls stand. */
#include "thrown_rig.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define M         PICTURE_M
#define TOLERANCE 10
#ifndef FRAMES_OF_ANYTHING
#define FRAMES_OF_ANYTHING 400
#endif
#define PART_MAX 200 /* one pixel in PART_MAX may disagree */

static const char *const kind_name[PICTURE_KINDS] = { "gl", "gles1", "gl over egl", "soft",
                                                      "soft, RGB565" };
static thrown_mesh mesh;
static thrown_pixel pixels[THROWN_PIXELS];
static uint8_t rgb[THROWN_PIXELS * 3], expected[THROWN_PIXELS * 3];

/* ---- scenes ---- */

static void open_kit(picture_kit *kit, int kind)
{
    assert_int_equal(picture_open(kit, (enum picture_kind)kind, THROWN_WIDE, THROWN_HIGH, 1),
                     FF_OK);
    kit->frame.clear_colour = 0xFFE0D0C0u;
}

/* Hills that sink away in the distance, as round ground does. */
static void make_hills(uint32_t side, int32_t rise)
{
    for (uint32_t i = 0; i < side * side; i++) {
        int32_t x = (int32_t)(i % side), y = (int32_t)(i / side);
        double z = rise * (sin(x * 0.9) * cos(y * 0.7) + 0.4 * sin(x * 2.1 + y)) -
                   rise * 0.003 * y * y;
        mesh.vertex[i] = (c3d_vertex){ .x = x, .y = y, .z = (int32_t)lround(z) };
        for (int k = 0; k < 3; k++)
            mesh.vertex[i].rgba[k] = (uint8_t)(127 + 100 * sin(x * (k + 1) * 0.4 + y * 0.3 + k));
        mesh.vertex[i].rgba[3] = 255;
    }
    thrown_join(&mesh, side);
}

/* The mesh from 4 km on before an eye high above it that looks north. */
static c3d_draw hill_draw(picture_kit *kit, int32_t cell_m)
{
    c3d_draw draw = { .mesh = c3d_mesh_make(kit->device, mesh.vertex, mesh.vertices),
                      .strip = c3d_strip_make(kit->device, mesh.index, mesh.indices),
                      .origin_wu = { -(int64_t)cell_m * M * (mesh.side / 2), 4000 * M, -4000 * M },
                      .xy_scale_wu = cell_m * M,
                      .z_scale_q16 = M << 16,
                      .flags = C3D_DRAW_COLOURED,
                      .colour = PICTURE_BLUE };
    kit->frame.camera.pitch = -4500;
    kit->frame.camera.focal_q8 = c3d_focal_q8(10923, THROWN_WIDE);
    kit->frame.camera.near_wu = 50 * M;
    kit->frame.camera.far_wu = 60000 * M;
    assert_true(draw.mesh.id && draw.strip.id);
    return draw;
}

static void compare(const picture_kit *kit, const char *what, int part_max)
{
    for (int i = 0; i < THROWN_PIXELS; i++)
        if (pixels[i].unsure) memcpy(expected + i * 3, rgb + i * 3, 3);
    int strict,
        count = picture_disagreement(expected, rgb, THROWN_WIDE, THROWN_HIGH, TOLERANCE, &strict);
    print_message("# %s, %s: %.3f %% of pixels are wrong (%.3f %% without allowing for edges)\n",
                  what, kind_name[kit->kind], 100.0 * count / THROWN_PIXELS,
                  100.0 * strict / THROWN_PIXELS);
    char path[128];
    (void)snprintf(path, sizeof path, "build/tests/thrown-%s-%d.png", what, (int)kit->kind);
    (void)sys_png_write(path, rgb, THROWN_WIDE, THROWN_HIGH);
    (void)snprintf(path, sizeof path, "build/tests/thrown-%s-expected.png", what);
    (void)sys_png_write(path, expected, THROWN_WIDE, THROWN_HIGH);
    assert_in_range(count, 0, THROWN_PIXELS / part_max);
}

/* ---- one picture ---- */

static void from_the_eye_the_picture_is_seen_as_it_is(void **state)
{
    (void)state;
    enum { SIDE = 64 };
    for (int kind = 0; kind < PICTURE_KINDS; kind++) {
        picture_kit kit;
        assert_int_equal(picture_open(&kit, (enum picture_kind)kind, SIDE, SIDE, 1), FF_OK);
        make_hills(THROWN_SIDE, 200);
        c3d_draw draw = hill_draw(&kit, 500);
        kit.frame.camera.pitch = -5500;
        kit.frame.camera.focal_q8 = 160 * 256;
        thrown_picture picture = thrown_waves(C3D_RGBA5551, SIDE, SIDE);
        c3d_rotation rotation;
        c3d_rotation_from_camera(&kit.frame.camera, &rotation);
        c3d_projector projector = { { 0, 0, 0 }, { { 0 } } };
        for (int axis = 0; axis < 3; axis++) {
            int64_t forward = rotation.m[2][axis];
            projector.row_q24[0][axis] = (int32_t)((forward / 2 + rotation.m[0][axis] * 2.5) / 64);
            projector.row_q24[1][axis] = (int32_t)((forward / 2 - rotation.m[1][axis] * 2.5) / 64);
            projector.row_q24[2][axis] = (int32_t)(forward / 64);
        }
        draw.flags |= C3D_DRAW_PROJECTED;
        draw.texture = thrown_upload(kit.device, &picture);
        draw.projector = &projector;
        picture_render(&kit, &draw, 1, rgb);
        (void)sys_png_write("build/tests/thrown-eye.png", rgb, SIDE, SIDE);
        for (int y = 1; y < SIDE - 1; y++)
            for (int x = 1; x < SIDE - 1; x++) {
                uint8_t texel[3];
                for (int k = 0; k < 3; k++)
                    texel[k] = (uint8_t)(picture.rgba[y * SIDE + x] >> (8 * k));
                assert_in_range(picture_apart(rgb + (y * SIDE + x) * 3, texel), 0, TOLERANCE);
            }
        free(picture.rgba);
        picture_close(&kit);
    }
}

/* Throws on hills from a place beside the eye, under `flags`. */
static void throw_on_hills(const char *what, int cell_m, uint32_t flags, int fog,
                           enum c3d_texture_format format)
{
    for (int kind = 0; kind < PICTURE_KINDS; kind++) {
        picture_kit kit;
        open_kit(&kit, kind);
        make_hills(cell_m > 1000 ? 9 : THROWN_SIDE, cell_m > 1000 ? 600 : 200);
        c3d_draw draw = hill_draw(&kit, cell_m);
        kit.frame.fog_start_wu = 8000 * M;
        kit.frame.fog_end_wu = fog ? 25000 * M : 0;
        kit.frame.fog_colour = 0xFFC0B0A0u;
        int side = format == C3D_RGBA8888 ? 128 : 256;
        thrown_picture picture = thrown_waves(format, side, side);
        const int64_t at[3] = { 1000 * M, -700 * M, 300 * M };
        c3d_projector projector = thrown_projector(at, -700, &picture, side * 0.9);
        draw.flags = flags;
        thrown_hits(&kit.frame, &draw, &mesh, pixels);
        thrown_paint(&projector, &picture, pixels);
        thrown_rgb(&kit.frame, pixels, expected);
        draw.flags |= C3D_DRAW_PROJECTED;
        draw.texture = thrown_upload(kit.device, &picture);
        assert_true(draw.texture.id);
        draw.projector = &projector;
        picture_render(&kit, &draw, 1, rgb);
        compare(&kit, what, PART_MAX);
        free(picture.rgba);
        picture_close(&kit);
    }
}

static void from_aside_every_pixel_is_where_it_must_be(void **state)
{
    (void)state;
    throw_on_hills("aside", 500, C3D_DRAW_COLOURED, 0, C3D_RGBA5551);
    throw_on_hills("one-colour", 500, 0, 0, C3D_RGBA8888);
    throw_on_hills("large-cells", 3000, C3D_DRAW_COLOURED, 0, C3D_RGBA5551);
}

static void fog_comes_over_what_is_thrown(void **state)
{
    (void)state;
    throw_on_hills("fog", 500, C3D_DRAW_COLOURED, 1, C3D_RGBA5551);
    throw_on_hills("fog-large-cells", 3000, C3D_DRAW_COLOURED, 1, C3D_RGBA5551);
}

/* Two triangles that lie under and round the projector: half of each is behind it. */
static void nothing_is_thrown_backwards(void **state)
{
    (void)state;
    for (int kind = 0; kind < PICTURE_KINDS; kind++)
        for (int view = 0; view < 6; view++) {
            picture_kit kit;
            open_kit(&kit, kind);
            make_hills(2, 0);
            c3d_draw draw = hill_draw(&kit, 30000);
            draw.origin_wu[0] = draw.origin_wu[1] = -15000 * M;
            draw.flags = C3D_DRAW_COLOURED;
            kit.frame.camera.yaw = view * 65536 / 6;
            kit.frame.camera.pitch = -3000;
            thrown_picture picture = thrown_waves(C3D_RGBA5551, 256, 256);
            const int64_t at[3] = { 2000 * M, 1000 * M, -200 * M };
            c3d_projector projector = thrown_projector(at, 3000, &picture, 150);
            thrown_hits(&kit.frame, &draw, &mesh, pixels);
            thrown_paint(&projector, &picture, pixels);
            thrown_rgb(&kit.frame, pixels, expected);
            draw.flags |= C3D_DRAW_PROJECTED;
            draw.texture = thrown_upload(kit.device, &picture);
            draw.projector = &projector;
            picture_render(&kit, &draw, 1, rgb);
            char what[32];
            (void)snprintf(what, sizeof what, "round-%d", view);
            compare(&kit, what, PART_MAX);
            /* and drawn over the plain ground */
            c3d_draw twice[2] = { draw, draw };
            twice[0].flags &= ~(uint32_t)C3D_DRAW_PROJECTED;
            twice[1].flags |= C3D_DRAW_ALPHA_TEST;
            picture_render(&kit, twice, 2, rgb);
            compare(&kit, what, PART_MAX);
            free(picture.rgba);
            picture_close(&kit);
        }
}

/* ---- large pictures, far away ---- */

#define LARGE 2048 /* texels each way */
#define STEP  16   /* of colour from texel to texel; red tells the column, green the row */

/* A device that has room for a large texture. */
static void open_large(picture_kit *kit)
{
    c3d_desc desc = { .mesh_count = 4,
                      .strip_count = 4,
                      .texture_count = 1,
                      .mesh_vertices_max = THROWN_SIDE * THROWN_SIDE,
                      .strip_indices_max = 4096,
                      .frame_format = C3D_RGBA8888,
                      .width = THROWN_WIDE,
                      .height = THROWN_HIGH,
                      .texture_bytes = (LARGE + 2) * (LARGE + 2) * 4 + 256 };
    open_kit(kit, PICTURE_SOFT);
    c3d_close(kit->device);
    free(kit->memory);
    size_t bytes = c3d_bytes(c3d_backend_soft(), &desc);
    kit->memory = malloc(bytes);
    assert_int_equal(c3d_open(c3d_backend_soft(), &desc, kit->memory, bytes, &kit->device), FF_OK);
}

static thrown_picture make_rule(void)
{
    thrown_picture picture = { C3D_RGBA8888, LARGE, LARGE,
                               malloc(LARGE * LARGE * sizeof(uint32_t)) };
    for (uint32_t i = 0; i < LARGE * LARGE; i++)
        picture.rgba[i] = 0xFFFF0000u | (i / LARGE * STEP & 255) << 8 | (i % LARGE * STEP & 255);
    return picture;
}

/* A cliff of side x side vertices, each way as wide as an eighth of its distance. */
static c3d_draw make_cliff(picture_kit *kit, uint32_t side, int32_t away_m)
{
    int32_t unit_wu = away_m / 8, cell = 256 / ((int32_t)side - 1); /* M is 256, too */
    for (uint32_t i = 0; i < side * side; i++) {
        int32_t x = (int32_t)(i % side), z = (int32_t)(i / side);
        mesh.vertex[i] =
            (c3d_vertex){ .x = cell * x, .y = cell / 8 * ((x * 5 + z * 3) % 4), .z = cell * z };
    }
    thrown_join(&mesh, side);
    return (c3d_draw){ .mesh = c3d_mesh_make(kit->device, mesh.vertex, mesh.vertices),
                       .strip = c3d_strip_make(kit->device, mesh.index, mesh.indices),
                       .origin_wu = { -(int64_t)away_m * M / 16, (int64_t)away_m * M,
                                      -(int64_t)away_m * M / 16 },
                       .xy_scale_wu = unit_wu,
                       .z_scale_q16 = (uint32_t)unit_wu << 16 };
}

/* How far a colour is from that of a texture coordinate, texels; -1 where colours begin anew. */
static double texels_off(uint8_t colour, double texel)
{
    double at = fmod(texel - 0.5, 256 / STEP);
    return at < 2 || at > 256 / STEP - 3 ? -1 : fabs(colour - at * STEP) / STEP;
}

static void judge_rule(const c3d_projector *projector, const thrown_picture *picture,
                       const char *what)
{
    int judged = 0, wrong = 0;
    double sum = 0;
    for (int i = 0; i < THROWN_PIXELS; i++) {
        double st[2];
        if (!pixels[i].hit || !thrown_texel(projector, picture, pixels[i].place_wu, st)) continue;
        for (int k = 0; k < 2; k++) {
            double off = texels_off(rgb[i * 3 + k], st[k]);
            if (off < 0) continue;
            judged++;
            wrong += off > 0.25;
            sum += off * off;
        }
    }
    assert_true(judged > 15000);
    print_message("# %s: %.3f texels off (rms), more than a quarter in %.2f %%\n", what,
                  sqrt(sum / judged), 100.0 * wrong / judged);
    assert_in_range(wrong, 0, judged / 100); /* edges of the cliff's parts */
}

static void large_pictures_lie_right_far_away(void **state)
{
    (void)state;
    static const int32_t away_m[4] = { 5000, 20000, 80000, 300000 },
                         aside_m[3] = { 0, 2000, 20000 };
    picture_kit kit;
    thrown_picture picture = make_rule();
    for (int way = 0; way < 4 * 3 * 2; way++) {
        int32_t away = away_m[way / 6], aside = aside_m[way % 6 / 2];
        char what[64];
        if (aside > away) continue;
        open_large(&kit);
        c3d_draw draw = make_cliff(&kit, way & 1 ? 5 : THROWN_SIDE, away);
        /* a pixel is a texel */
        kit.frame.camera.focal_q8 = 2400 * 256;
        kit.frame.camera.near_wu = 10 * M;
        kit.frame.camera.far_wu = 2 * away * M;
        const int64_t at[3] = { (int64_t)aside * M, (int64_t)aside / 3 * M,
                                (int64_t)aside / 20 * M };
        c3d_projector projector = thrown_projector(
            at, (int32_t)lround(atan2(-aside, away - aside / 3) * 10430.4), &picture, 2400);
        thrown_hits(&kit.frame, &draw, &mesh, pixels);
        draw.flags = C3D_DRAW_PROJECTED;
        draw.texture = thrown_upload(kit.device, &picture);
        draw.projector = &projector;
        picture_render(&kit, &draw, 1, rgb);
        (void)snprintf(what, sizeof what, "%d km, %d km aside, %d", (int)away / 1000,
                       (int)aside / 1000, way & 1);
        judge_rule(&projector, &picture, what);
        picture_close(&kit);
    }
    free(picture.rgba);
}

/* ---- several pictures ---- */

/* Two pictures that overlap by few texels, over hills whose own colour shows nowhere between them:
 * by colours, and after images on the hills; near planes as over high and low ground. */
static void side_by_side_pictures_leave_no_gap(void **state)
{
    (void)state;
    static const int32_t near_wu[3] = { 50 * M, 2 * M, M / 4 };
    for (int kind = 0; kind < PICTURE_KINDS; kind++)
        for (int way = 0; way < 6; way++) {
            picture_kit kit;
            int images = way & 1;
            open_kit(&kit, kind);
            make_hills(THROWN_SIDE, 200);
            c3d_draw draw[3];
            draw[0] = hill_draw(&kit, 500);
            kit.frame.camera.near_wu = near_wu[way / 2];
            draw[0].flags = 0;
            thrown_hits(&kit.frame, draw, &mesh, pixels);
            thrown_picture picture = thrown_waves(C3D_RGBA5551, 128, 128);
            for (int i = 0; i < 128 * 128; i++)
                picture.rgba[i] = (picture.rgba[i] & 0xFF000000u) | 0xFF;
            c3d_projector projector[2];
            for (int i = 0; i < 2; i++) {
                const int64_t at[3] = { -900 * M, 400 * M, -3000 * M };
                /* 45 degrees and a little in 126 texels */
                projector[i] = thrown_projector(at, i ? 4096 : -4096, &picture, 148);
                thrown_paint(&projector[i], &picture, pixels);
                draw[i + images] = draw[0];
                draw[i + images].flags = C3D_DRAW_PROJECTED |
                                         (images || i ? C3D_DRAW_ALPHA_TEST : 0);
                draw[i + images].projector = &projector[i];
            }
            draw[images].texture = draw[images + 1].texture = thrown_upload(kit.device, &picture);
            if (images) {
                uint16_t image[32 * 32];
                memset(image, 0x1F, sizeof image);
                for (int i = 0; i < 32 * 32; i++) image[i] = 0x001F;
                draw[0] = draw[1];
                draw[0].projector = NULL;
                draw[0].flags = C3D_DRAW_TEXTURED;
                draw[0].colour = PICTURE_WHITE;
                draw[0].texture = c3d_texture_make(kit.device, C3D_RGB565, 32, 32, image);
                draw[0].tex_columns = THROWN_SIDE;
                draw[0].tex_scale_q16[0] = draw[0].tex_scale_q16[1] = 65536 / (THROWN_SIDE - 1);
            }
            thrown_rgb(&kit.frame, pixels, expected);
            picture_render(&kit, draw, 2 + (size_t)images, rgb);
            char what[48];
            (void)snprintf(what, sizeof what, "pair-%d", way);
            compare(&kit, what, PART_MAX);
            int gaps = 0, red = 0;
            for (int i = 0; i < THROWN_PIXELS; i++) {
                int inside = expected[i * 3] == 255;
                for (int k = 1; inside && k < 4; k++) /* not at the ground's outline */
                    inside = i >= k * THROWN_WIDE + k && i + k * THROWN_WIDE + k < THROWN_PIXELS &&
                             expected[(i - k) * 3] == 255 && expected[(i + k) * 3] == 255 &&
                             expected[(i - k * THROWN_WIDE) * 3] == 255 &&
                             expected[(i + k * THROWN_WIDE) * 3] == 255;
                red += inside;
                gaps += inside && rgb[i * 3] < 128;
            }
            print_message("# %s %s: %d gaps of %d\n", what, kind_name[kind], gaps, red);
            assert_true(red > 5000);
            assert_in_range(gaps, 0, red / 2000); /* where hills are seen edge-on */
            free(picture.rgba);
            picture_close(&kit);
        }
}

/* Two pictures over each other, of the upper one a share: as much of the lower one shows through.
 */
static void as_much_shows_through_as_is_said(void **state)
{
    (void)state;
    static double below[THROWN_PIXELS][3];
    for (int kind = 0; kind < PICTURE_KINDS; kind++)
        for (int through = 0; through < 256; through += 85) {
            picture_kit kit;
            open_kit(&kit, kind);
            make_hills(THROWN_SIDE, 200);
            c3d_draw draw[2] = { hill_draw(&kit, 500) };
            if (through & 1) kit.frame.fog_start_wu = 8000 * M, kit.frame.fog_end_wu = 25000 * M;
            const int64_t at[3] = { 1000 * M, -700 * M, 300 * M };
            thrown_picture picture = thrown_waves(C3D_RGBA5551, 256, 256);
            c3d_projector projector[2] = { thrown_projector(at, -700, &picture, 230),
                                           thrown_projector(at, 2500, &picture, 230) };
            thrown_hits(&kit.frame, draw, &mesh, pixels);
            thrown_paint(&projector[0], &picture, pixels);
            for (int i = 0; i < THROWN_PIXELS; i++) memcpy(below[i], pixels[i].rgb, sizeof *below);
            thrown_paint(&projector[1], &picture, pixels);
            for (int i = 0; i < THROWN_PIXELS; i++)
                for (int k = 0; k < 3; k++)
                    pixels[i].rgb[k] += (below[i][k] - pixels[i].rgb[k]) * through / 256;
            thrown_rgb(&kit.frame, pixels, expected);
            draw[0].flags |= C3D_DRAW_PROJECTED;
            draw[0].texture = thrown_upload(kit.device, &picture);
            draw[1] = draw[0];
            draw[1].flags |= C3D_DRAW_ALPHA_TEST;
            draw[1].through = (uint8_t)through;
            for (int i = 0; i < 2; i++) draw[i].projector = &projector[i];
            picture_render(&kit, draw, 2, rgb);
            char what[48];
            (void)snprintf(what, sizeof what, "through-%d", through);
            compare(&kit, what, PART_MAX);
            free(picture.rgba);
            picture_close(&kit);
        }
}

/* ---- anything ---- */

static int32_t any(sys_random *random, int bits)
{
    uint32_t size = sys_random_u32(random) >> (32 - 1 - sys_random_below(random, (uint32_t)bits));
    return sys_random_u32(random) & 1 ? -(int32_t)size : (int32_t)size;
}

/* A projector and a mesh of any size anywhere, seen from anywhere: what is asserted is
 * asserted within the back end. */
static void throw_anything(picture_kit *kit, sys_random *random, c3d_texture texture)
{
    c3d_projector projector;
    int side = 2 + (int)sys_random_below(random, 6),
        scale_bits = 4 + (int)sys_random_below(random, 13);
    for (int i = 0; i < side * side; i++) {
        mesh.vertex[i] = (c3d_vertex){ .x = i % side, .y = i / side, .z = any(random, 10) };
        memset(mesh.vertex[i].rgba, (int)sys_random_below(random, 256), 4);
    }
    thrown_join(&mesh, (uint32_t)side);
    int origin_bits = 10 + (int)sys_random_below(random, 18);
    c3d_draw draw = { .mesh = c3d_mesh_make(kit->device, mesh.vertex, mesh.vertices),
                      .strip = c3d_strip_make(kit->device, mesh.index, mesh.indices),
                      .xy_scale_wu = any(random, scale_bits + 4) | 1,
                      .z_scale_q16 = (uint32_t)(any(random, scale_bits + 12) | 1) & INT32_MAX,
                      .flags = C3D_DRAW_PROJECTED | (sys_random_u32(random) & C3D_DRAW_COLOURED) |
                               (sys_random_u32(random) & C3D_DRAW_ALPHA_TEST) |
                               (sys_random_u32(random) & C3D_DRAW_ON_TOP),
                      .texture = texture,
                      .through = (uint8_t)sys_random_u32(random),
                      .projector = &projector };
    assert_true(draw.mesh.id && draw.strip.id);
    for (int axis = 0; axis < 3; axis++) {
        draw.origin_wu[axis] = any(random, origin_bits);
        projector.origin_wu[axis] = (int64_t)any(random, origin_bits) *
                                    (sys_random_u32(random) & 7 ? 1 : 32);
        for (int i = 0; i < 3; i++)
            projector.row_q24[i][axis] = any(random, 31 - (int)sys_random_below(random, 12));
    }
    kit->frame.camera.yaw = any(random, 17);
    kit->frame.camera.pitch = any(random, 14);
    int far_log2 = 15 + (int)sys_random_below(random, 15);
    kit->frame.camera.far_wu = 1 << far_log2;
    kit->frame.camera.near_wu = 1 << (10 + sys_random_below(random, (uint32_t)far_log2 - 10));
    kit->frame.fog_end_wu = sys_random_u32(random) & 1 ? kit->frame.camera.far_wu : 0;
    picture_render(kit, &draw, 1, rgb);
    c3d_mesh_free(kit->device, draw.mesh);
    c3d_strip_free(kit->device, draw.strip);
}

static void any_projector_and_mesh_are_drawn(void **state)
{
    (void)state;
    static const enum c3d_texture_format format[2] = { C3D_RGBA5551, C3D_RGBA8888 };
    for (int kind = PICTURE_SOFT; kind <= PICTURE_SOFT_565; kind++) {
        picture_kit kit;
        sys_random random;
        sys_random_seed(&random, 12, (uint32_t)kind);
        open_kit(&kit, kind);
        for (int i = 0; i < 2; i++) {
            thrown_picture picture = thrown_waves(format[i], 64, 32);
            c3d_texture texture = thrown_upload(kit.device, &picture);
            for (int frame = 0; frame < FRAMES_OF_ANYTHING; frame++)
                throw_anything(&kit, &random, texture);
            free(picture.rgba);
        }
        picture_close(&kit);
    }
}

/* ---- depths ---- */

static void depths_are_those_of_what_is_drawn(void **state)
{
    (void)state;
    static int32_t depth[THROWN_PIXELS];
    for (int kind = 0; kind < PICTURE_KINDS; kind++) {
        picture_kit kit;
        open_kit(&kit, kind);
        assert_int_equal(c3d_read_depth(kit.device, depth), FF_ERR_ARGUMENT);
        c3d_draw draws[3] = {
            picture_square(&kit, PICTURE_LEVEL, -8000 * M, -8000 * M, -100 * M, 16000 * M, 0),
            picture_square(&kit, PICTURE_SOUTH, -10 * M, 40 * M, -10 * M, 16 * M, 0),
            picture_square(&kit, PICTURE_SOUTH, -8000 * M, 50 * M, -8000 * M, 16000 * M, 0),
        };
        draws[2].flags = C3D_DRAW_BACKDROP;
        picture_render(&kit, draws, 3, rgb);
        if (kind != PICTURE_SOFT && kind != PICTURE_SOFT_565) {
            assert_int_equal(c3d_read_depth(kit.device, depth), FF_ERR_UNSUPPORTED);
            picture_close(&kit);
            continue;
        }
        assert_int_equal(c3d_read_depth(kit.device, depth), FF_OK);
        int seen[3] = { 0 };
        double focal = kit.frame.camera.focal_q8 / 256.0;
        for (int i = 0; i < THROWN_PIXELS; i++) {
            double x = (i % THROWN_WIDE + 0.5 - THROWN_WIDE / 2.0) / focal,
                   y = (THROWN_HIGH / 2.0 - i / THROWN_WIDE - 0.5) / focal;
            double ground = y < 0 ? -100 * M / y : 1e9, wall_wu = 40 * M,
                   expect = ground < kit.frame.camera.far_wu ? ground : INT32_MAX;
            int wall = x * wall_wu > -10 * M && x * wall_wu < 6 * M && y * wall_wu > -10 * M &&
                       y * wall_wu < 6 * M;
            if (wall) expect = wall_wu;
            if (expect == INT32_MAX && ground < 2.0 * kit.frame.camera.far_wu) continue;
            seen[wall ? 0 : expect == INT32_MAX ? 1 : 2]++;
            double error = fabs(depth[i] - expect);
            assert_true(error <= (wall ? 2 : expect * 0.002));
        }
        assert_true(seen[0] > 500 && seen[1] > 5000 && seen[2] > 5000);
        picture_close(&kit);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(from_the_eye_the_picture_is_seen_as_it_is),
        cmocka_unit_test(from_aside_every_pixel_is_where_it_must_be),
        cmocka_unit_test(fog_comes_over_what_is_thrown),
        cmocka_unit_test(nothing_is_thrown_backwards),
        cmocka_unit_test(large_pictures_lie_right_far_away),
        cmocka_unit_test(side_by_side_pictures_leave_no_gap),
        cmocka_unit_test(as_much_shows_through_as_is_said),
        cmocka_unit_test(any_projector_and_mesh_are_drawn),
        cmocka_unit_test(depths_are_those_of_what_is_drawn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
