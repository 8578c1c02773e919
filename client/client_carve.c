/* The pools of a terrain, taken as the budget says, and what lives in them. */
#include "several/ff_several.h"
#include "../protocol/ff_assert.h"

#include <string.h>

void *ff_client_take(ff_arena *arena, const ff_budget *budget, enum ff_pool_id pool)
{
    FF_ASSERT(pool < FF_POOL_COUNT);
    return budget->pool[pool].count ? ff_arena_take(arena, budget->pool[pool].bytes) : NULL;
}

static void *take(ff_client *client, const ff_budget *budget, enum ff_pool_id pool)
{
    return ff_client_take(&client->arena, budget, pool);
}

static int carve_decoder(ff_client *client, const ff_budget *budget)
{
    void *memory = take(client, budget, FF_POOL_decoder);
    client->first.intake.decoder = ff_decoder_create(&client->info, memory,
                                                     budget->pool[FF_POOL_decoder].bytes);
    return client->first.intake.decoder ? FF_OK : FF_ERR_MEMORY;
}

void ff_client_decode(ff_client *client, ff_source *source)
{
    const ff_intake *first = &client->first.intake;
    source->intake.decoder = first->decoder;
    source->intake.rgb_bytes = first->rgb_bytes;
    source->intake.rgb = first->rgb;
}

static void carve_arriving(ff_client *client, const ff_budget *budget)
{
    ff_intake *intake = &client->first.intake;
    FF_ASSERT(budget->face_size <= FF_FACE_SIZE_MAX);
    FF_ASSERT((size_t)budget->face_size * budget->face_size <= budget->texels);
    FF_ASSERT(budget->pool[FF_POOL_decoded_image].bytes == 3 * budget->texels);
    intake->rgb_bytes = budget->pool[FF_POOL_decoded_image].bytes;
    intake->rgb = take(client, budget, FF_POOL_decoded_image);
    intake->face_size_max = (uint16_t)budget->face_size;
    intake->columns = take(client, budget, FF_POOL_face_columns);
    void *items = take(client, budget, FF_POOL_items);
    void *images = take(client, budget, FF_POOL_images);
    ff_new_data_init(&client->news, budget->pool[FF_POOL_items].count, budget->values, items,
                     budget->pool[FF_POOL_images].count, budget->image_bytes, images);
}

static void carve_textures(ff_client *client, const ff_budget *budget)
{
    ff_textures *textures = &client->textures;
    FF_ASSERT(budget->pool[FF_POOL_textures].count < UINT16_MAX); /* its lists hold slots + 1 */
    memset(textures, 0, sizeof *textures);
    textures->info = client->info;
    textures->texture_count = (uint16_t)budget->pool[FF_POOL_textures].count;
    textures->slot_count = (uint16_t)(textures->texture_count * budget->texture_names);
    textures->texel_px_q8 = FF_TEXEL_PX_Q8;
    textures->slot = take(client, budget, FF_POOL_textures);
    textures->wear = take(client, budget, FF_POOL_wear);
    uint8_t *pictures = take(client, budget, FF_POOL_pictures);
    if (!pictures) return;
    unsigned log2 = client->info.texture_log2;
    textures->texels = (uint16_t *)(void *)pictures;
    ff_held_pictures_init(&textures->pictures, log2, budget->pool[FF_POOL_pictures].count,
                          textures->texture_count * FF_CODED_BYTES(log2),
                          pictures + ((size_t)2 << 2 * log2));
}

static int open_device(ff_client *client, const ff_budget *budget)
{
    size_t mark = client->arena.used;
    void *memory = take(client, budget, FF_POOL_device);
    int rc = c3d_open(client->desc.backend, &budget->device, memory,
                      budget->pool[FF_POOL_device].bytes, &client->device);
    if (rc != FF_OK) ff_arena_back_to(&client->arena, mark);
    return rc;
}

/* Where the graphics library has no buffers the block holds the meshes, and fewer of them. */
static int carve_device(ff_client *client, ff_budget *budget)
{
    FF_ASSERT(!client->device && client->arena.used >= client->fixed_bytes);
    if (!client->desc.backend) return FF_OK;
    int rc = open_device(client, budget);
    if (rc != FF_ERR_MEMORY || client->desc.use_plain_arrays) return rc;
    rc = ff_budget_terrain(budget, 0);
    return rc == FF_OK ? open_device(client, budget) : rc;
}

static int carve_view(ff_client *client, const ff_budget *budget)
{
    ff_terrain_view *view = &client->view;
    memset(view, 0, sizeof *view);
    view->device = client->device;
    view->heights_per_node = budget->heights;
    view->entry_count = budget->pool[FF_POOL_entries].count;
    view->entry = take(client, budget, FF_POOL_entries);
    view->vertices = take(client, budget, FF_POOL_vertices);
    view->wear = client->textures.wear;
    view->part = take(client, budget, FF_POOL_fin_indices);
    view->index = take(client, budget, FF_POOL_strip_indices);
    view->kept = take(client, budget, FF_POOL_kept);
    c3d_vertex *ends = take(client, budget, FF_POOL_contours);
    FF_ASSERT(view->entry_count >= FF_ENTRIES_MIN && view->entry_count <= FF_ENTRIES_MAX);
    if (!client->device) return FF_OK;
    /* a mesh for each entry, one for a node without, and the sky's */
    FF_ASSERT(budget->device.mesh_count >= view->entry_count + 2);
    FF_ASSERT(budget->device.mesh_vertices_max >= view->heights_per_node);
    size_t mark = client->arena.used;
    /* the device copies them: given back at once */
    ff_strips *strips = ff_arena_take(&client->arena, sizeof *strips);
    int rc = strips ? ff_terrain_view_strips(view, client->info.node_log2, strips) : FF_ERR_MEMORY;
    ff_arena_back_to(&client->arena, mark);
    if (rc == FF_OK) rc = ff_contours_make(&view->contours, client->device, ends);
    ff_sky_make(&client->sky, client->device);
    return rc;
}

static int carve_tree(ff_client *client, const ff_budget *budget)
{
    ff_tree_desc desc = { .info = client->info,
                          .node_count = budget->pool[FF_POOL_nodes].count,
                          .wish_count = FF_TREE_WISHES,
                          .hidden = client->desc.hidden,
                          .ground_max = budget->grounds_max,
                          .source_max = client->source_count };
    void *memory = take(client, budget, FF_POOL_nodes);
    client->tree = ff_tree_create(&desc, memory, budget->pool[FF_POOL_nodes].bytes);
    return client->tree ? FF_OK : FF_ERR_MEMORY;
}

static int carve_all(ff_client *client, unsigned economy)
{
    ff_budget budget;
    FF_ASSERT(client->arena.used == client->fixed_bytes);
    ff_budget_fixed(&budget, &client->desc, client->arena.bytes);
    FF_ASSERT(budget.fixed == client->fixed_bytes);
    budget.grounds_max = ff_budget_grounds(&client->desc, client->first.intake.ground_count);
    ff_budget_economise(&budget, &client->info, economy);
    int rc = ff_budget_terrain(&budget, !client->desc.use_plain_arrays);
    if (rc == FF_OK) rc = carve_decoder(client, &budget);
    if (rc == FF_OK) carve_arriving(client, &budget);
    if (rc == FF_OK) carve_textures(client, &budget);
    if (rc == FF_OK) rc = carve_device(client, &budget);
    client->textures.device = client->device;
    if (rc == FF_OK) rc = carve_view(client, &budget);
    ff_sets *sets = rc == FF_OK ? take(client, &budget, FF_POOL_far_sets) : NULL;
    if (rc == FF_OK) rc = carve_tree(client, &budget);
    if (rc != FF_OK) {
        ff_client_uncarve(client);
        return rc;
    }
    FF_ASSERT(client->arena.used == budget.used);
    client->has_textures = budget.has_textures;
    ff_terrain_view_attach(&client->view, client->tree,
                           client->has_textures ? &client->textures : NULL);
    ff_panorama_init(&client->panorama, client->device, &client->desc.panorama, &client->info,
                     budget.face_size);
    client->sets = sets;
    if (sets) {
        ff_sets_init(sets, client->device, &client->desc.far, &client->info, budget.far_side);
        ff_sets_scratch(sets, client->view.vertices, client->view.part,
                        client->view.heights_per_node);
        sets->paint_bytes = ff_budget_paint_bytes(&budget);
        sets->watch = client->fins_made;
        sets->watch_context = client->fins_context;
    }
    client->view.throws = (ff_throws){ budget.far_side && client->device ? ff_sets_lay : NULL,
                                       sets };
    client->fine_wu = client->coarse = 0;
    client->far_asked = 0;
    client->far_turns = 0;
    ff_client_auto_begin(client);
    ff_motion_reset(&client->motion);
    ff_turn_reset(&client->turn);
    ff_several_join(client);
    return FF_OK;
}

void ff_client_serve(ff_client *client, ff_source *source)
{
    source->serves = 1;
    source->error = FF_OK;
    source->no_views = 0;
    memset(&source->refusals, 0, sizeof source->refusals);
    client->unranked = 1;
}

/* Where memory is short for this terrain, panoramas are left out, then images are fewer, then none:
 * coarser, never wrong. */
int ff_client_carve(ff_client *client)
{
    FF_ASSERT(!client->have_terrain);
    if (!ff_codec_supported(client->info.codec)) return FF_ERR_UNSUPPORTED;
    int rc = FF_ERR_MEMORY;
    for (client->economy = 0; rc == FF_ERR_MEMORY && client->economy < FF_ECONOMY_STEPS;
         client->economy++)
        rc = carve_all(client, client->economy);
    client->economy--;
    FF_ASSERT(client->economy < FF_ECONOMY_STEPS);
    if (rc != FF_OK) return rc;
    ff_arena_seal(&client->arena);
    client->have_terrain = client->dirty = 1;
    ff_client_balance_begin(client, 1);
    return FF_OK;
}

void ff_client_carve_sky(ff_client *client)
{
    ff_budget budget;
    FF_ASSERT(!client->have_terrain && !client->device);
    if (!client->desc.backend) return;
    ff_budget_fixed(&budget, &client->desc, client->arena.bytes);
    ff_budget_sky(&budget);
    size_t mark = client->arena.used, bytes = c3d_bytes(client->desc.backend, &budget.device);
    void *memory = ff_arena_take(&client->arena, bytes);
    if (memory &&
        c3d_open(client->desc.backend, &budget.device, memory, bytes, &client->device) == FF_OK) {
        ff_sky_make(&client->sky, client->device);
        return;
    }
    client->device = NULL;
    ff_arena_back_to(&client->arena, mark);
}

void ff_client_uncarve(ff_client *client)
{
    /* without a terrain only what was asked for with the greeting is out, and still to come */
    for (unsigned i = 0; client->have_terrain && i < client->source_count; i++) {
        ff_requests_clear(&ff_client_source(client, i)->requests);
        ff_client_source(client, i)->serves = 0;
    }
    if (client->device) c3d_close(client->device); /* meshes and textures go with it */
    client->device = NULL;
    client->tree = NULL;
    client->sets = NULL;
    client->have_terrain = 0;
    memset(&client->sky, 0, sizeof client->sky);
    memset(&client->view, 0, sizeof client->view);
    ff_arena_back_to(&client->arena, client->fixed_bytes);
}
