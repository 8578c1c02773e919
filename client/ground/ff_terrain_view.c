#include "ff_terrain_view.h"

#include "ff_show.h"

#define HASH_PRIME UINT64_C(0x100000001b3)

int ff_terrain_view_strips(ff_terrain_view *view, unsigned node_log2, ff_strips *strips)
{
    int rc = ff_strips_make(strips, node_log2);
    for (unsigned i = 0; rc == FF_OK && i < strips->count; i++) {
        view->strip[i].id = 0;
        if (strips->length[i] == 0) continue; /* INNER of the smallest nodes */
        view->strip[i] = c3d_strip_make(view->device, strips->index + strips->first[i],
                                        strips->length[i]);
        if (!view->strip[i].id) rc = FF_ERR_MEMORY;
    }
    return rc;
}

static void release(ff_terrain_view *view, ff_view_node *entry)
{
    if (entry->mesh.id) c3d_mesh_free(view->device, entry->mesh);
    entry->mesh.id = 0;
    entry->user = NULL;
    view->held--;
}

static void on_evict(void *context, uint32_t user)
{
    ff_terrain_view *view = context;
    if (user) release(view, &view->entry[user - 1]);
}

void ff_terrain_view_attach(ff_terrain_view *view, ff_tree *tree, const ff_terrain_info *info,
                            const ff_textures *textures)
{
    view->tree = tree;
    view->info = info;
    view->textures = textures;
    ff_tree_on_evict(tree, on_evict, view);
}

static uint64_t hash_word(uint64_t hash, uint64_t word) { return (hash ^ word) * HASH_PRIME; }

static uint64_t hash_heights(const ff_drawn *drawn, uint32_t count)
{
    uint64_t hash = FF_TERRAIN_VIEW_HASH_START;
    for (uint32_t i = 0; i < count; i++) hash = hash_word(hash, drawn->heights[i]);
    return hash;
}

/* The drawn node's entry, made when it has none; NULL when every entry belongs to a node of this
 * frame. */
static ff_view_node *entry_of(ff_terrain_view *view, const ff_drawn *drawn)
{
    uint32_t *user = ff_tree_user(view->tree, drawn->node);
    if (*user) return &view->entry[*user - 1];
    for (uint32_t tries = 0; tries < view->entry_count; tries++) {
        uint32_t place = view->hand;
        ff_view_node *entry = &view->entry[place];
        view->hand = view->hand + 1 < view->entry_count ? view->hand + 1 : 0;
        if (entry->user && entry->used == view->stamp) continue;
        if (entry->user) {
            *entry->user = 0;
            release(view, entry);
        }
        entry->user = user;
        entry->used = view->stamp;
        entry->heights_hash = 0;
        *user = place + 1;
        if (++view->held > view->held_high) view->held_high = view->held;
        return entry;
    }
    return NULL;
}

void ff_terrain_view_begin(ff_terrain_view *view, const ff_drawn *list, uint32_t count)
{
    view->stamp++;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t user = *ff_tree_user(view->tree, list[i].node);
        if (user) view->entry[user - 1].used = view->stamp;
    }
}

uint64_t ff_terrain_view_hash(ff_terrain_view *view, const ff_drawn *list, uint32_t count)
{
    uint64_t hash = FF_TERRAIN_VIEW_HASH_START;
    for (uint32_t i = 0; i < count; i++) {
        const ff_drawn *drawn = &list[i];
        ff_view_node *entry = entry_of(view, drawn);
        if (entry && !entry->heights_hash)
            entry->heights_hash = hash_heights(drawn, view->heights_per_node);
        hash = hash_word(hash, drawn->key);
        hash = hash_word(hash, drawn->coarser);
        for (int axis = 0; axis < 3; axis++)
            hash = hash_word(hash, (uint32_t)drawn->origin_wu[axis]);
        hash = hash_word(hash,
                         entry ? entry->heights_hash : hash_heights(drawn, view->heights_per_node));
    }
    return hash;
}

static c3d_mesh make_mesh(ff_terrain_view *view, const ff_drawn *drawn)
{
    ff_tree_vertices(view->tree, drawn, 1, view->vertices);
    ff_ground_frame_vertices(&view->frame, view->info, drawn, view->vertices,
                             view->heights_per_node);
    return c3d_mesh_make(view->device, view->vertices, view->heights_per_node);
}

static void free_meshes(ff_terrain_view *view)
{
    for (uint32_t i = 0; i < view->entry_count; i++) {
        if (view->entry[i].mesh.id) c3d_mesh_free(view->device, view->entry[i].mesh);
        view->entry[i].mesh.id = 0;
    }
}

/* Some node's mesh that this frame does not need gives way. 1 when one was found. */
static int free_one_mesh(ff_terrain_view *view)
{
    for (uint32_t i = 0; i < view->entry_count; i++) {
        ff_view_node *entry = &view->entry[i];
        if (entry->user && entry->mesh.id && entry->used != view->stamp) {
            c3d_mesh_free(view->device, entry->mesh);
            entry->mesh.id = 0;
            return 1;
        }
    }
    return 0;
}

static void draw_strips(ff_terrain_view *view, const ff_drawn *drawn, c3d_draw draw)
{
    uint8_t strip[5];
    unsigned strips = ff_strips_for(drawn->coarser, strip);
    for (unsigned i = 0; i < strips; i++) {
        draw.strip = view->strip[strip[i]];
        if (draw.strip.id) c3d_draw_strip(view->device, &draw);
    }
}

void ff_terrain_view_new_frame(ff_terrain_view *view) { view->frame.set = 0; }

void ff_terrain_view_draw(ff_terrain_view *view, const ff_drawn *list, uint32_t count,
                          const c3d_camera *camera, unsigned show)
{
    c3d_draw ground = { .flags = C3D_DRAW_COLOURED };
    if (ff_ground_frame_follow(&view->frame, view->info, camera)) free_meshes(view);
    ff_ground_frame_draw(&view->frame, view->info, camera, &ground);
    for (uint32_t i = 0; i < count; i++) {
        const ff_drawn *drawn = &list[i];
        ff_view_node *entry = entry_of(view, drawn);
        c3d_draw draw = ground;
        draw.mesh = entry && entry->mesh.id ? entry->mesh : make_mesh(view, drawn);
        if (!draw.mesh.id && free_one_mesh(view)) draw.mesh = make_mesh(view, drawn);
        if (entry) entry->mesh = draw.mesh;
        if (view->textures) ff_textures_lay(view->textures, drawn->key, &draw);
        draw_strips(view, drawn, draw);
        if (show) ff_show_over(view, drawn, &draw, show);
        if (!entry && draw.mesh.id) c3d_mesh_free(view->device, draw.mesh);
    }
}
