#include "ff_pack_ground.h"
#include "../../client/terrain/ff_pack_source.h"
#include "../../client/images/ff_texture_map.h"

#include <stdlib.h>
#include <string.h>

#define SIGMA_Q8 320
/* a bound for damaged packs: every round refines a level or makes 32 families of leaves, of which
 * the tree holds 1024, or it is the last */
#define LOAD_ROUNDS_MAX 64

void ff_pack_ground_desc(const ff_pack *pack, const sys_surface_api *surface_api, c3d_desc *desc)
{
    uint32_t side = ff_node_side(&pack->header.info);
    *desc = (c3d_desc){ .surface_api = surface_api,
                        .mesh_count = FF_GROUND_NODES,
                        .strip_count = FF_STRIP_COUNT_MAX + 1, /* and a part of a node */
                        .texture_count = FF_GROUND_TEXTURES,
                        .mesh_vertices_max = (uint16_t)(side * side),
                        .strip_indices_max = sizeof((ff_strips *)0)->index / sizeof(uint16_t) +
                                             ff_strips_part(side * side),
                        .use_vertex_buffers = 1 };
}

/* Makes the view and the cache of images; their memory is part of `ground`. */
static int make_view(ff_pack_ground *ground, c3d_device *device)
{
    const ff_terrain_info *info = &ground->pack->header.info;
    ff_strips strips;
    ground->view = (ff_terrain_view){ .device = device,
                                      .entry = ground->entry,
                                      .entry_count = FF_GROUND_NODES,
                                      .vertices = ground->vertices,
                                      .index = ground->index,
                                      .part = ground->part,
                                      .wear = ground->wear,
                                      .heights_per_node = ff_node_side(info) * ff_node_side(info) };
    ground->textures = (ff_textures){ .device = device,
                                      .info = *info,
                                      .slot = ground->slot,
                                      .slot_count = FF_GROUND_TEXTURES,
                                      .texture_count = FF_GROUND_TEXTURES,
                                      .texel_px_q8 = FF_TEXEL_PX_Q8 };
    ff_terrain_view_attach(&ground->view, ground->tree, &ground->textures);
    return ff_terrain_view_strips(&ground->view, info->node_log2, &strips);
}

static int make_texture_memory(ff_pack_ground *ground)
{
    size_t texels = (size_t)1 << (2 * ground->pack->header.info.texture_log2);
    if (ground->pack->header.info.texture_log2 == 0) return FF_OK;
    ground->image_memory = malloc(ff_pack_images_bytes(ground->pack));
    ground->texture_texels = malloc(texels * sizeof *ground->texture_texels);
    if (!ground->image_memory || !ground->texture_texels) return FF_ERR_MEMORY;
    ff_pack_images_init(&ground->images, ground->pack, ground->image_memory);
    return FF_OK;
}

int ff_pack_ground_open(ff_pack_ground *ground, const ff_pack *pack, c3d_device *device,
                        ff_pack_ground_stats *stats)
{
    const ff_terrain_info *info = &pack->header.info;
    ff_tree_desc desc = { .info = *info,
                          .node_count = FF_GROUND_NODES,
                          .wish_count = FF_GROUND_WISHES,
                          .hidden = FF_HIDDEN_FETCHED,
                          .ground_max = ff_pack_source_grounds(pack) };
    size_t tree_bytes = ff_tree_bytes(&desc), decoder_bytes = ff_pack_source_decoder_bytes(pack);
    memset(ground, 0, sizeof *ground);
    ground->pack = pack;
    ground->stats = stats;
    ground->device = device;
    ground->tree_memory = malloc(tree_bytes);
    ground->decoder_memory = malloc(decoder_bytes);
    if (!ground->tree_memory || !ground->decoder_memory) return FF_ERR_MEMORY;
    ground->tree = ff_tree_create(&desc, ground->tree_memory, tree_bytes);
    ground->decoder = ff_decoder_create(info, ground->decoder_memory, decoder_bytes);
    if (!ground->tree || !ground->decoder) return FF_ERR_MEMORY;
    int rc = ff_pack_source_add(pack, ground->tree);
    if (rc == FF_OK) rc = make_texture_memory(ground);
    return rc == FF_OK ? make_view(ground, device) : rc;
}

void ff_pack_ground_close(ff_pack_ground *ground)
{
    free(ground->tree_memory);
    free(ground->decoder_memory);
    free(ground->image_memory);
    free(ground->texture_texels);
    memset(ground, 0, sizeof *ground);
}

/* ---- loading ---- */

/* Answers the tree's wishes from the pack; returns how many nodes were delivered. The list of
 * wishes is copied first, because it may change as nodes come in. */
static uint32_t serve_wishes(ff_pack_ground *ground)
{
    const ff_wish *list;
    uint32_t count = ff_tree_wishes(ground->tree, &list), delivered = 0;
    if (count > FF_GROUND_WISHES) count = FF_GROUND_WISHES;
    memcpy(ground->wishes, list, count * sizeof *list);
    for (uint32_t i = 0; i < count; i++) {
        const ff_wish *wish = &ground->wishes[i];
        int rc = ff_pack_source_serve(ground->pack, ground->decoder, ground->values, ground->tree,
                                      (enum ff_kind)wish->kind, wish->key);
        if (rc == FF_OK) {
            ground->stats->nodes_read++;
            delivered++;
        } else if (rc != FF_ERR_FULL && rc != FF_ERR_NOT_FOUND) {
            ground->stats->nodes_damaged++;
        }
    }
    return delivered;
}

static void show_layer(ff_pack_ground *ground, unsigned layer)
{
    uint32_t number = 0;
    if (ground->textures.layer == layer) return;
    ff_textures_set_layer(&ground->textures, (uint8_t)layer);
    ff_picture_path_layer(&ground->images.path, layer);
    for (const ff_pack *pack = ground->pack; pack; pack = pack->next)
        ff_tree_show_images(ground->tree, number++, &pack->header.info,
                            ff_pack_image_levels(pack, layer));
}

void ff_pack_ground_load(ff_pack_ground *ground, const ff_ground_look *look)
{
    ff_quality quality = { .measure = FF_MEASURE_PIXELS,
                           .c_q8 = 256,
                           .error_px_q8 = look->error_px_q8,
                           .sigma_q8 = SIGMA_Q8,
                           .view_wu = look->view_wu,
                           .hole_wu = look->hole_wu };
    ff_view view = { .frame = look->frame, .camera = look->camera };
    memcpy(view.centre_wu, look->camera.pos_wu, sizeof view.centre_wu);
    if (!look->bare) show_layer(ground, look->layer);
    for (int round = 0; round < LOAD_ROUNDS_MAX; round++) {
        ff_tree_select(ground->tree, &view, &quality);
        if (serve_wishes(ground) == 0 && ff_tree_to_make(ground->tree) == 0) break;
    }
    /* what came last, or found no room, may have driven out what was to be drawn */
    ff_tree_select(ground->tree, &view, &quality);
}

/* ---- seeing ---- */

/* Exact: what is drawn of a node lies between its lowest and highest vertex. */
static int node_seen(const ff_pack_ground *ground, const ff_drawn *drawn,
                     const ff_ground_look *look)
{
    if (!look->sees) return 1;
    const ff_terrain_info *info = ff_tree_ground(ground->tree, drawn->key);
    uint32_t count = ff_node_side(info) * ff_node_side(info);
    uint16_t lowest = UINT16_MAX, highest = 0;
    for (uint32_t i = 0; i < count; i++) {
        lowest = drawn->heights[i] < lowest ? drawn->heights[i] : lowest;
        highest = drawn->heights[i] > highest ? drawn->heights[i] : highest;
    }
    const int64_t height_wu[2] = { ff_height_wu(info, lowest), ff_height_wu(info, highest) };
    ff_box box = ff_shape_box(info, drawn->key, ff_tree_placed(drawn->node), height_wu,
                              look->camera.pos_wu);
    return look->sees(look->context, &box);
}

int ff_pack_ground_seen(const ff_pack_ground *ground, const ff_ground_look *look)
{
    const ff_drawn *list;
    uint32_t count = ff_tree_drawn(ground->tree, &list);
    for (uint32_t i = 0; i < count; i++)
        if (node_seen(ground, &list[i], look)) return 1;
    return 0;
}

/* ---- drawing ---- */

/* Makes texture_texels of a node's image. FF_OK, or why they are not there. */
static int make_texels(ff_pack_ground *ground, ff_key key)
{
    uint32_t size = 1u << ground->textures.info.texture_log2;
    int rc = ff_pack_images_get(&ground->images, ground->pack, key, ground->texture_texels);
    if (rc < 0) return rc;
    for (uint32_t i = 0; i < size * size; i++)
        ground->texture_texels[i] = ff_ground_not_key(ground->texture_texels[i]);
    return FF_OK;
}

/* Puts an image, or the nearest one above it, into the cache; the least recently used image makes
 * room. A damaged image is remembered as such until its slot is needed. */
static void fetch_image(ff_pack_ground *ground, ff_key key)
{
    const uint8_t *payload;
    ff_image image = { 0 };
    if (ff_textures_touch(&ground->textures, key)) return;
    int rc = ff_pack_image(ground->pack, ground->images.path.layer, &key, &payload);
    if (ff_textures_touch(&ground->textures, key)) return;
    if (rc >= 0) rc = ff_image_read(payload, (size_t)rc, &image);
    if (rc >= 0 && image.coded_bytes) rc = make_texels(ground, key);
    if (rc < 0) ground->stats->nodes_damaged++;
    ff_textures_put(&ground->textures, key, image.marks,
                    rc < 0 || !image.coded_bytes ? NULL : ground->texture_texels);
}

static void fetch_images(ff_pack_ground *ground, const ff_drawn *drawn, const ff_texel_look *look)
{
    ff_wear wear[FF_WEAR_MAX];
    unsigned count = ff_textures_wanted(&ground->textures, ground->tree, drawn, look, wear);
    for (unsigned i = 0; i < count; i++) fetch_image(ground, wear[i].image);
}

static int by_key(const void *a, const void *b)
{
    ff_key ka = ((const ff_drawn *)a)->key, kb = ((const ff_drawn *)b)->key;
    return ka < kb ? -1 : ka > kb;
}

/* Lists the nodes seen, in an order that does not depend on what was drawn before: where two
 * triangles are equally deep, the first one stays. */
static uint32_t list_seen(ff_pack_ground *ground, const ff_ground_look *look)
{
    const ff_drawn *list;
    uint32_t count = ff_tree_drawn(ground->tree, &list), seen = 0;
    for (uint32_t i = 0; i < count; i++)
        if (node_seen(ground, &list[i], look)) ground->seen[seen++] = list[i];
    qsort(ground->seen, seen, sizeof *ground->seen, by_key);
    return seen;
}

/* Pictures from one place share a frame of coordinates, and no others do: what one shows must not
 * depend on who asked before. */
static void choose_frame(ff_pack_ground *ground, const ff_ground_look *look)
{
    const int32_t *pos_wu = look->camera.pos_wu;
    if (memcmp(ground->position_wu, pos_wu, sizeof ground->position_wu) == 0 &&
        ff_shape_same_frame(&ground->pack->header.info, &look->frame, &ground->drawn_frame))
        return;
    memcpy(ground->position_wu, pos_wu, sizeof ground->position_wu);
    ground->drawn_frame = look->frame;
    ff_terrain_view_new_frame(&ground->view);
}

void ff_pack_ground_draw(ff_pack_ground *ground, const ff_ground_look *look)
{
    c3d_frame frame = { .camera = look->camera, .clear_colour = FF_GROUND_KEY_ABGR };
    c3d_stats stats;
    uint32_t count = list_seen(ground, look);
    choose_frame(ground, look);
    c3d_begin(ground->device, &frame);
    ground->view.textures = look->bare ? NULL : &ground->textures;
    ff_terrain_view_begin(&ground->view, ground->seen, count);
    const ff_texel_look texels = ff_textures_look(&ground->textures, ff_tree_frame(ground->tree),
                                                  &look->camera);
    for (uint32_t i = 0; i < count; i++) {
        if (!look->bare) fetch_images(ground, &ground->seen[i], &texels);
        ff_terrain_view_draw(&ground->view, &ground->seen[i], 1, &frame.camera, 0);
    }
    ground->stats->nodes_drawn += count;
    c3d_end(ground->device);
    c3d_get_stats(ground->device, &stats);
    ground->stats->triangles += stats.frame_triangles;
}
