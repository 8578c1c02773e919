/* The pools of a terrain: how the block is shared out. */
#include "ff_client_local.h"

#include <string.h>

#define NODES_MAX        16384u
#define NODES_MIN        8u
#define VIEW_ENTRIES_MIN 4u
#define VIEW_ENTRIES_MAX 4096u
#define ITEMS_MAX        24u
#define ITEMS_MIN        4u
#define FACE_SIZE_MIN    64u
#define EXTRA_INDICES    (FF_SKY_INDICES + 36u) /* and faces */
#define IMAGE_SHARE      5u /* images on their way in take at most a fifth of the block */
#define EXTRA_STRIPS     4
#define ECONOMY_STEPS    3
#define TEXTURES_MIN     8u
#define TEXTURES_MAX     512u
#define TEXTURE_ROUNDING 256u
#define TEXT_BYTES       (16u << 10)

/* An image of side * side texels, once as RGB888 and once as 16 bit. */
static int image_fits(const ff_client *client, size_t side)
{
    return side * side * 5 <= client->arena.bytes / IMAGE_SHARE;
}

/* Largest power of two up to `size` whose images take at most a fifth of the block. */
static unsigned fit_face_size(const ff_client *client)
{
    unsigned size = FF_FACE_SIZE_MAX;
    if (!client->desc.panorama.enabled || client->desc.pack || client->economy >= 1) return 0;
    while (size > client->desc.panorama.face_size) size /= 2;
    while (size > FACE_SIZE_MIN && !image_fits(client, size)) size /= 2;
    return size;
}

static int can_have_textures(const ff_client *client)
{
    return client->info.texture_log2 && client->info.texture_levels && !client->desc.no_textures &&
           client->economy < 2 && image_fits(client, (size_t)1 << client->info.texture_log2);
}

static int carve_images(ff_client *client, unsigned face_size)
{
    unsigned texture_side = client->has_textures ? 1u << client->info.texture_log2 : 0;
    size_t texels = (size_t)texture_side * texture_side;
    if ((size_t)face_size * face_size > texels) texels = (size_t)face_size * face_size;
    unsigned slots = !texels ? 0 : texels * 4 <= client->arena.bytes / 16 ? 2 : 1;
    ff_intake *intake = &client->intake;
    intake->rgb_bytes = texels * 3;
    intake->face_size_max = (uint16_t)face_size;
    intake->rgb = texels ? ff_arena_take(&client->arena, intake->rgb_bytes) : NULL;
    intake->columns = face_size
                          ? ff_arena_take(&client->arena, (size_t)face_size * 2 * sizeof(uint16_t))
                          : NULL;

    unsigned side = ff_refined_side(&client->info), values = side * side;
    size_t one = ff_new_data_item_bytes(1, values), share = client->arena.bytes / 10 / one;
    unsigned items = share > ITEMS_MAX   ? ITEMS_MAX
                     : share < ITEMS_MIN ? ITEMS_MIN
                                         : (unsigned)share;
    void *item = ff_arena_take(&client->arena, ff_new_data_item_bytes(items, values));
    void *image = texels ? ff_arena_take(&client->arena, slots * texels * 2) : NULL;
    if (!item || (texels && (!intake->rgb || !image)) || (face_size && !intake->columns))
        return FF_ERR_MEMORY;
    ff_new_data_init(&client->news, items, values, item, slots, texels * 2, image);
    return FF_OK;
}

static int carve_decoder(ff_client *client)
{
    if (!ff_codec_supported(client->info.codec)) return FF_ERR_UNSUPPORTED;
    client->intake.info = client->info;
    size_t bytes = ff_decoder_bytes(&client->info);
    void *memory = ff_arena_take(&client->arena, bytes);
    client->intake.decoder = memory ? ff_decoder_create(&client->info, memory, bytes) : NULL;
    return client->intake.decoder ? FF_OK : FF_ERR_MEMORY;
}

static int carve_textures(ff_client *client)
{
    ff_textures *textures = &client->textures;
    memset(textures, 0, sizeof *textures);
    textures->info = client->info;
    textures->device = client->device;
    if (!client->has_textures) return FF_OK;
    size_t bytes = (size_t)4 << (2 * client->info.texture_log2),
           count = client->arena.bytes / 16 * 5 / bytes;
    textures->slot_count = (uint16_t)(count < TEXTURES_MIN   ? TEXTURES_MIN
                                      : count > TEXTURES_MAX ? TEXTURES_MAX
                                                             : count);
    textures->slot = ff_arena_take(&client->arena, textures->slot_count * sizeof *textures->slot);
    return textures->slot ? FF_OK : FF_ERR_MEMORY;
}

/* What a back end without a GL keeps of images: each with a rim of a texel, rounded up; faces and
 * the caller's text by their share. */
static uint32_t texture_bytes(const ff_client *client, unsigned face_size)
{
    size_t side = ((size_t)1 << client->info.texture_log2) + 2, face = (size_t)face_size + 2,
           share = client->arena.bytes / 8;
    size_t ground = client->has_textures
                        ? client->textures.slot_count * (side * side * 4 + TEXTURE_ROUNDING)
                        : 0;
    size_t faces = FF_PANORAMA_MESHES * (face * face * 2 + TEXTURE_ROUNDING);
    faces = !face_size ? 0 : faces < share ? faces : share;
    return (uint32_t)(ground + faces + client->arena.bytes / 16 + TEXT_BYTES);
}

static c3d_desc device_desc(const ff_client *client, unsigned entries, unsigned face_size,
                            int buffers)
{
    unsigned side = ff_node_side(&client->info);
    unsigned texture_share = client->has_textures ? client->textures.slot_count : 0;
    c3d_desc desc = { .surface_api = client->desc.surface_api,
                      .use_vertex_buffers = (uint8_t)buffers };
    /* one spare, the sky */
    desc.mesh_count = (uint16_t)(entries + 1 + 1 + (face_size ? FF_PANORAMA_MESHES : 0));
    desc.strip_count = FF_STRIP_COUNT_MAX + EXTRA_STRIPS;
    desc.texture_count = (uint16_t)(texture_share + 1 /* the caller's text */ +
                                    (face_size ? FF_PANORAMA_MESHES : 0));
    desc.mesh_vertices_max = (uint16_t)(side * side > FF_SKY_VERTICES ? side * side
                                                                      : FF_SKY_VERTICES);
    desc.strip_indices_max = client->view.strip_indices + EXTRA_INDICES;
    desc.width = client->desc.width;
    desc.height = client->desc.height;
    desc.frame_format = client->desc.frame_format;
    desc.texture_bytes = texture_bytes(client, face_size);
    return desc;
}

/* How many indices the strips of this terrain's nodes have. */
static int count_indices(ff_client *client)
{
    size_t mark = client->arena.used;
    ff_strips *strips = ff_arena_take(&client->arena, sizeof *strips);
    int rc = strips ? ff_strips_make(strips, client->info.node_log2) : FF_ERR_MEMORY;
    client->view.strip_indices = 0;
    for (unsigned i = 0; rc == FF_OK && i < strips->count; i++)
        client->view.strip_indices += strips->length[i];
    ff_arena_back_to(&client->arena, mark);
    return rc;
}

/* As many meshes as `share` bytes hold, at most *entries. FF_ERR_MEMORY when buffers were asked for
 * and the library has none. */
static int open_device(ff_client *client, unsigned face_size, unsigned *entries, size_t share,
                       int buffers)
{
    c3d_desc desc = device_desc(client, *entries, face_size, buffers);
    while (*entries > VIEW_ENTRIES_MIN && c3d_bytes(client->desc.backend, &desc) > share) {
        *entries /= 2;
        desc = device_desc(client, *entries, face_size, buffers);
    }
    size_t bytes = c3d_bytes(client->desc.backend, &desc), mark = client->arena.used;
    void *memory = ff_arena_take(&client->arena, bytes);
    int rc = memory ? c3d_open(client->desc.backend, &desc, memory, bytes, &client->device)
                    : FF_ERR_MEMORY;
    if (rc != FF_OK) ff_arena_back_to(&client->arena, mark);
    return rc;
}

/* The device takes what it needs without any mesh (`fixed`), and its meshes at most a third of the
 * bytes that are then left. */
static int carve_device(ff_client *client, unsigned face_size, unsigned *entries)
{
    size_t left = ff_arena_left(&client->arena), share = left / 3;
    *entries = VIEW_ENTRIES_MAX;
    if (!client->desc.backend) {
        while (*entries > VIEW_ENTRIES_MIN && *entries * sizeof(ff_view_node) > share / 8)
            *entries /= 2;
        return FF_OK;
    }
    int rc = count_indices(client);
    if (rc != FF_OK) return rc;
    c3d_desc bare = device_desc(client, 0, face_size, 0);
    size_t fixed = c3d_bytes(client->desc.backend, &bare);
    share = fixed < left ? fixed + (left - fixed) / 3 : left;
    rc = client->desc.use_plain_arrays ? FF_ERR_MEMORY
                                       : open_device(client, face_size, entries, share, 1);
    return rc == FF_ERR_MEMORY ? open_device(client, face_size, entries, share, 0) : rc;
}

static int carve_view(ff_client *client, unsigned entries)
{
    ff_terrain_view *view = &client->view;
    unsigned side = ff_node_side(&client->info);
    memset(view, 0, sizeof *view);
    view->device = client->device;
    view->heights_per_node = side * side;
    view->entry_count = entries;
    view->entry = ff_arena_take(&client->arena, entries * sizeof *view->entry);
    if (!view->entry) return FF_ERR_MEMORY;
    if (!client->device) return FF_OK;
    view->vertices = ff_arena_take(&client->arena, view->heights_per_node * sizeof *view->vertices);
    size_t mark = client->arena.used;
    /* the device copies them: given back at once */
    ff_strips *strips = ff_arena_take(&client->arena, sizeof *strips);
    int rc = view->vertices && strips ? ff_terrain_view_strips(view, client->info.node_log2, strips)
                                      : FF_ERR_MEMORY;
    ff_arena_back_to(&client->arena, mark);
    ff_sky_make(&client->sky, client->device);
    return rc;
}

/* The tree takes what is left: the largest pool that fits. */
static int carve_tree(ff_client *client)
{
    ff_tree_desc desc = { .info = client->info,
                          .node_count = NODES_MAX,
                          .wish_count = FF_TREE_WISHES };
    uint32_t low = 0, high = NODES_MAX + 1;
    while (high - low > 1) {
        desc.node_count = low + (high - low) / 2;
        if (desc.node_count >= NODES_MIN &&
            ff_arena_cost(ff_tree_bytes(&desc)) > ff_arena_left(&client->arena))
            high = desc.node_count;
        else
            low = desc.node_count;
    }
    desc.node_count = low;
    if (low < NODES_MIN) return FF_ERR_MEMORY;
    size_t bytes = ff_tree_bytes(&desc);
    void *memory = ff_arena_take(&client->arena, bytes);
    client->tree = memory ? ff_tree_create(&desc, memory, bytes) : NULL;
    return client->tree ? FF_OK : FF_ERR_MEMORY;
}

static int carve_all(ff_client *client)
{
    unsigned entries = 0, face_size = fit_face_size(client);
    client->has_textures = (uint8_t)can_have_textures(client);
    int rc = carve_decoder(client);
    if (rc == FF_OK) rc = carve_images(client, face_size);
    if (rc == FF_OK) rc = carve_textures(client);
    if (rc == FF_OK) rc = carve_device(client, face_size, &entries);
    client->textures.device = client->device;
    if (rc == FF_OK) rc = carve_view(client, entries);
    if (rc == FF_OK) rc = carve_tree(client);
    if (rc != FF_OK) {
        ff_client_uncarve(client);
        return rc;
    }
    ff_terrain_view_attach(&client->view, client->tree, &client->info,
                           client->has_textures ? &client->textures : NULL);
    ff_panorama_init(&client->panorama, client->device, &client->desc.panorama, &client->info,
                     face_size);
    ff_motion_reset(&client->motion);
    ff_turn_reset(&client->turn);
    memset(&client->refusals, 0, sizeof client->refusals);
    return FF_OK;
}

/* Where memory is short for this terrain, panoramas are left out, then images: coarser, never
 * wrong. */
int ff_client_carve(ff_client *client)
{
    int rc = FF_ERR_MEMORY;
    for (client->economy = 0; rc == FF_ERR_MEMORY && client->economy < ECONOMY_STEPS;
         client->economy++)
        rc = carve_all(client);
    client->economy--;
    if (rc != FF_OK) return rc;
    ff_arena_seal(&client->arena);
    client->have_terrain = client->dirty = 1;
    ff_client_balance_begin(client, 1);
    return FF_OK;
}

void ff_client_uncarve(ff_client *client)
{
    ff_requests_clear(&client->requests);
    if (client->device) c3d_close(client->device); /* meshes and textures go with it */
    client->device = NULL;
    client->tree = NULL;
    client->have_terrain = 0;
    memset(&client->sky, 0, sizeof client->sky);
    memset(&client->view, 0, sizeof client->view);
    ff_arena_back_to(&client->arena, client->fixed_bytes);
}
