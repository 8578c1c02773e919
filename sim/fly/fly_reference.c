#include "fly_reference.h"

#include "../../client/images/ff_texture_map.h"
#include "../../client/terrain/ff_pack_source.h"
#include "../../protocol/ff_image.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SAMPLES          3 /* of a pixel, each way */
#define SIDE_MAX         4096
#define NODES_MAX        (1u << 20)
#define TREE_BYTES_MAX   ((size_t)512 << 20)
#define WISHES           (1u << 14)
#define IMAGE_BYTES      ((size_t)64 << 20) /* of the images on the device */
#define IMAGES_MAX       1024u
#define TEXEL_SAMPLES_Q8 511 /* texels are no smaller than samples */
#define NEAR_WU_MIN      (FF_WU_PER_METRE / 4)
#define NEAR_WU_MAX      (4096 * FF_WU_PER_METRE)

/* ---- memory ---- */

/* Nodes of a ground that have some. */
static uint64_t nodes_of(const ff_terrain_info *info)
{
    const ff_sheet samples = ff_shape_sheet_samples(info);
    uint64_t sum = 0;
    for (uint32_t level = 0; level < ff_terrain_levels(info) && sum < NODES_MAX; level++) {
        uint32_t edge_log2 = info->tile_log2 - level;
        sum += (uint64_t)(((samples.x - 2) >> edge_log2) + 1) *
               (((samples.y - 2) >> edge_log2) + 1);
    }
    return sum;
}

/* Slots for all nodes that have ground, or as many as may be. */
static void choose_slots(fly_reference *reference)
{
    ff_tree_desc *desc = &reference->tree_desc;
    uint64_t sum = 0;
    for (const ff_pack *pack = reference->pack; pack; pack = pack->next)
        sum += nodes_of(&pack->header.info);
    desc->node_count = sum < NODES_MAX ? (uint32_t)(sum < 8 ? 8 : sum) : NODES_MAX;
    while (ff_tree_bytes(desc) > TREE_BYTES_MAX) desc->node_count /= 2;
    reference->holds_all = desc->node_count >= sum;
}

static size_t image_bytes(const ff_terrain_info *info)
{
    size_t side = ((size_t)1 << info->texture_log2) + 2; /* with the rim, see c3d_desc */
    return info->texture_log2 ? (side * side * 4 + 255) / 256 * 256 : 0;
}

static void describe(fly_reference *reference)
{
    const ff_terrain_info *info = &reference->pack->header.info;
    size_t one = image_bytes(info), images = one ? IMAGE_BYTES / one : 0;
    if (images > IMAGES_MAX) images = IMAGES_MAX;
    reference->tree_desc = (ff_tree_desc){ .info = *info,
                                           .wish_count = WISHES,
                                           .hidden = FF_HIDDEN_FETCHED,
                                           .ground_max = ff_pack_source_grounds(reference->pack) };
    choose_slots(reference);
    reference->device_desc =
        (c3d_desc){ .mesh_count = 2, /* of the node being drawn, and of the sky */
                    .strip_count = FF_STRIP_COUNT_MAX + 2, /* the sky, and a part of a node */
                    .texture_count = (uint16_t)images,
                    .mesh_vertices_max = FF_NODE_HEIGHTS_MAX,
                    .strip_indices_max = sizeof((ff_strips *)0)->index / sizeof(uint16_t) +
                                         FF_SKY_INDICES + FF_STRIPS_PART(FF_NODE_HEIGHTS_MAX),
                    .frame_format = C3D_RGBA8888,
                    .width = (uint16_t)(reference->width * reference->samples),
                    .height = (uint16_t)(reference->height * reference->samples),
                    .texture_bytes = (uint32_t)(images * one) };
}

int fly_reference_open(fly_reference *reference, const ff_pack *pack, uint16_t width,
                       uint16_t height)
{
    const ff_terrain_info *info = &pack->header.info;
    unsigned largest = width > height ? width : height;
    size_t texels = (size_t)1 << (2 * info->texture_log2),
           decoder_bytes = ff_pack_source_decoder_bytes(pack);
    memset(reference, 0, sizeof *reference);
    reference->pack = pack;
    reference->width = width;
    reference->height = height;
    reference->samples = SIDE_MAX / largest < SAMPLES ? SIDE_MAX / largest : SAMPLES;
    describe(reference);
    reference->tree_bytes = ff_tree_bytes(&reference->tree_desc);
    reference->device_bytes = c3d_bytes(c3d_backend_soft(), &reference->device_desc);
    reference->tree_memory = malloc(reference->tree_bytes);
    reference->device_memory = malloc(reference->device_bytes);
    reference->decoder_memory = malloc(decoder_bytes);
    reference->wish = malloc(WISHES * sizeof *reference->wish);
    reference->sampled = malloc((size_t)3 * reference->device_desc.width *
                                reference->device_desc.height);
    reference->slot = malloc(IMAGES_MAX * sizeof *reference->slot);
    reference->image_memory = malloc(ff_pack_images_bytes(pack) + 1);
    reference->image_texels = malloc(texels * sizeof *reference->image_texels);
    if (!reference->tree_memory || !reference->device_memory || !reference->decoder_memory ||
        !reference->wish || !reference->sampled || !reference->slot || !reference->image_memory ||
        !reference->image_texels)
        return FF_ERR_MEMORY;
    ff_pack_images_init(&reference->images, pack, reference->image_memory);
    reference->decoder = ff_decoder_create(info, reference->decoder_memory, decoder_bytes);
    return reference->decoder ? FF_OK : FF_ERR_UNSUPPORTED;
}

void fly_reference_close(fly_reference *reference)
{
    free(reference->tree_memory);
    free(reference->device_memory);
    free(reference->decoder_memory);
    free(reference->wish);
    free(reference->sampled);
    free(reference->slot);
    free(reference->image_memory);
    free(reference->image_texels);
    memset(reference, 0, sizeof *reference);
}

/* ---- ground ---- */

/* Answers the tree's wishes for what is in view: how many, or an error of the pack. The list is
 * copied first, because it may change as nodes come in. */
static int serve_wishes(fly_reference *reference)
{
    const ff_wish *list;
    uint32_t count = ff_tree_wishes(reference->tree, &list);
    int served = 0;
    memcpy(reference->wish, list, count * sizeof *list);
    for (uint32_t i = 0; i < count; i++) {
        const ff_wish *wish = &reference->wish[i];
        if (!wish->in_view) continue;
        int rc = ff_pack_source_serve(reference->pack, reference->decoder, reference->values,
                                      reference->tree, (enum ff_kind)wish->kind, wish->key);
        if (rc == FF_ERR_FULL || rc == FF_ERR_NOT_FOUND) continue;
        if (rc < 0) return rc;
        served++;
    }
    return served;
}

static void set_levels(const fly_reference *reference)
{
    uint32_t number = 0;
    unsigned layer = reference->images.path.layer;
    for (const ff_pack *pack = reference->pack; pack; pack = pack->next)
        ff_tree_show_images(reference->tree, number++, &pack->header.info,
                            ff_pack_image_levels(pack, layer));
}

/* Reads all that is in view until cells are no wider than so many samples. FF_OK; FF_ERR_FULL:
 * there are too many; or an error of the pack. */
static int load_until(fly_reference *reference, uint32_t cell)
{
    uint32_t c_q8 = (uint32_t)reference->view.camera.focal_q8 / cell >>
                    reference->tree_desc.info.node_log2;
    ff_quality quality = { .measure = FF_MEASURE_DISTANCE,
                           .c_q8 = (int32_t)c_q8 + 1,
                           .sigma_q8 = 320,
                           .view_wu = INT32_MAX };
    ff_tree_stats stats;
    reference->tree = ff_tree_create(&reference->tree_desc, reference->tree_memory,
                                     reference->tree_bytes);
    if (!reference->tree) return FF_ERR_MEMORY;
    int rc = ff_pack_source_add(reference->pack, reference->tree);
    if (rc < 0) return rc;
    set_levels(reference);
    for (;;) {
        ff_tree_select(reference->tree, &reference->view, &quality);
        int served = serve_wishes(reference);
        if (served < 0 || (served == 0 && ff_tree_to_make(reference->tree) == 0)) {
            ff_tree_get_stats(reference->tree, &stats);
            int full = !reference->holds_all && stats.nodes_held + 4 > stats.nodes_capacity;
            return served < 0 ? served : full ? FF_ERR_FULL : FF_OK;
        }
    }
}

static int load_ground(fly_reference *reference)
{
    int rc = FF_ERR_FULL;
    for (uint32_t cell = 1; rc == FF_ERR_FULL && cell < 1u << 16; cell *= 2)
        rc = load_until(reference, cell);
    return rc;
}

/* ---- images ---- */

static int fetch_image(fly_reference *reference, ff_key key)
{
    const uint8_t *payload;
    ff_image image = { 0 };
    if (ff_textures_touch(&reference->textures, key)) return FF_OK;
    int rc = ff_pack_image(reference->pack, reference->images.path.layer, &key, &payload);
    if (ff_textures_touch(&reference->textures, key)) return FF_OK;
    if (rc >= 0) rc = ff_image_read(payload, (size_t)rc, &image);
    if (rc >= 0 && image.coded_bytes)
        rc = ff_pack_images_get(&reference->images, reference->pack, key, reference->image_texels);
    if (rc < 0) return rc;
    return ff_textures_put(&reference->textures, key, image.marks,
                           image.coded_bytes ? reference->image_texels : NULL)
               ? FF_OK
               : FF_ERR_MEMORY;
}

/* The images that a node wears. */
static int fetch_images(fly_reference *reference, const ff_drawn *drawn)
{
    const ff_texel_look look = ff_textures_look(&reference->textures, &reference->view.frame,
                                                &reference->view.camera);
    ff_wear wear[FF_WEAR_MAX];
    unsigned count = ff_textures_wanted(&reference->textures, reference->tree, drawn, &look, wear);
    int rc = FF_OK;
    for (unsigned i = 0; rc == FF_OK && i < count; i++) rc = fetch_image(reference, wear[i].image);
    return rc;
}

/* ---- the picture ---- */

/* No ground of the terrain is further away from a place. */
static double farthest(const fly_reference *reference, const ff_terrain_info *info,
                       const int32_t place_wu[3])
{
    int64_t height_wu[2];
    double away = 0;
    ff_terrain_range_wu(info, height_wu);
    ff_box box = ff_shape_bounds(info, &reference->view.frame, height_wu, place_wu);
    for (unsigned axis = 0; axis < 3; axis++)
        away = hypot(away, fmax(fabs((double)box.lo[axis]), fabs((double)box.hi[axis])));
    return away;
}

/* Near and far planes: an eighth of the height above ground, and all of the terrain. */
static void set_planes(const fly_reference *reference, c3d_camera *camera)
{
    int64_t near_wu = 2 * NEAR_WU_MIN;
    uint32_t grounds;
    const ff_terrain_info *info = ff_tree_grounds(reference->tree, &grounds);
    int32_t ground_wu;
    if (ff_tree_drawn_height(reference->tree, camera->pos_wu[0], camera->pos_wu[1], &ground_wu))
        near_wu = ((int64_t)camera->pos_wu[2] - ground_wu) / 8;
    camera->near_wu = near_wu < NEAR_WU_MIN   ? NEAR_WU_MIN
                      : near_wu > NEAR_WU_MAX ? NEAR_WU_MAX
                                              : (int32_t)near_wu;
    double away = 16.0 * camera->near_wu; /* the sky lies within */
    for (uint32_t i = 0; i < grounds; i++)
        away = fmax(away, farthest(reference, &info[i], camera->pos_wu));
    camera->far_wu = away < INT32_MAX ? (int32_t)ceil(away) : INT32_MAX;
}

static int open_device(fly_reference *reference)
{
    const ff_terrain_info *info = &reference->tree_desc.info;
    ff_strips strips;
    int rc = c3d_open(c3d_backend_soft(), &reference->device_desc, reference->device_memory,
                      reference->device_bytes, &reference->device);
    if (rc != FF_OK) return rc;
    uint16_t images = reference->device_desc.texture_count;
    memset(reference->slot, 0, images * sizeof *reference->slot);
    reference->textures = (ff_textures){ .device = reference->device,
                                         .info = *info,
                                         .slot = reference->slot,
                                         .slot_count = images,
                                         .texture_count = images,
                                         .texel_px_q8 = TEXEL_SAMPLES_Q8,
                                         .across = 1 };
    /* no entries: a node's mesh lives as long as it takes to draw it */
    reference->ground = (ff_terrain_view){ .device = reference->device,
                                           .vertices = reference->vertices,
                                           .index = reference->index,
                                           .part = reference->part,
                                           .wear = reference->wear,
                                           .heights_per_node = ff_node_side(info) *
                                                               ff_node_side(info) };
    ff_terrain_view_attach(&reference->ground, reference->tree, &reference->textures);
    ff_sky_make(&reference->sky, reference->device);
    return ff_terrain_view_strips(&reference->ground, info->node_log2, &strips);
}

static int draw_samples(fly_reference *reference)
{
    c3d_frame frame = { .camera = reference->view.camera, .clear_colour = FF_SKY_HORIZON_COLOUR };
    const ff_drawn *list;
    uint32_t count = ff_tree_drawn(reference->tree, &list);
    int rc = FF_OK;
    set_planes(reference, &frame.camera);
    c3d_begin(reference->device, &frame);
    ff_sky_draw(&reference->sky, reference->device, frame.camera.near_wu);
    ff_terrain_view_begin(&reference->ground, list, count);
    for (uint32_t i = 0; rc == FF_OK && i < count; i++) {
        rc = fetch_images(reference, &list[i]);
        ff_terrain_view_draw(&reference->ground, &list[i], 1, &frame.camera, 0);
    }
    c3d_end(reference->device);
    return rc == FF_OK ? c3d_read_rgb(reference->device, reference->sampled) : rc;
}

/* Each pixel is the mean of its samples. */
static void average(const fly_reference *reference, uint8_t *rgb)
{
    unsigned n = reference->samples, all = n * n;
    size_t row = (size_t)3 * n * reference->width;
    for (unsigned y = 0; y < reference->height; y++)
        for (unsigned x = 0; x < reference->width; x++)
            for (unsigned c = 0; c < 3; c++) {
                const uint8_t *from = reference->sampled + y * n * row + (size_t)3 * n * x + c;
                unsigned sum = all / 2;
                for (unsigned i = 0; i < all; i++) sum += from[i / n * row + 3 * (i % n)];
                *rgb++ = (uint8_t)(sum / all);
            }
}

void fly_reference_layer(fly_reference *reference, unsigned layer)
{
    ff_picture_path_layer(&reference->images.path, layer);
}

int fly_reference_draw(fly_reference *reference, const c3d_camera *camera, uint8_t *rgb)
{
    const ff_terrain_info *info = &reference->tree_desc.info;
    ff_view *view = &reference->view;
    view->camera = *camera;
    view->frame = ff_shape_frame(info, camera->pos_wu);
    ff_shape_enter(info, &view->frame, camera->pos_wu, view->camera.pos_wu);
    view->camera.focal_q8 *= (int32_t)reference->samples;
    view->camera.width = reference->device_desc.width;
    view->camera.height = reference->device_desc.height;
    memcpy(view->centre_wu, view->camera.pos_wu, sizeof view->centre_wu);
    int rc = load_ground(reference);
    if (rc == FF_OK) rc = open_device(reference);
    if (rc == FF_OK) rc = draw_samples(reference);
    if (reference->device) c3d_close(reference->device);
    reference->device = NULL;
    if (rc == FF_OK) average(reference, rgb);
    return rc;
}
