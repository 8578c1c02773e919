#include "ff_terrain_view.h"

#include "ff_node_draw.h"
#include "ff_show.h"
#include "../../protocol/ff_assert.h"

#include <string.h>

#define HASH_PRIME UINT64_C(0x100000001b3)

FF_STATIC_ASSERT(FF_STRIP_COUNT_MAX >= FF_STRIP_SIDE(0, FF_NODE_LOG2_MAX + 1));
FF_STATIC_ASSERT(sizeof((ff_strips *)0)->length == FF_STRIP_COUNT_MAX * sizeof(uint16_t));

/* For parts of it. */
static void keep_strip(ff_terrain_view *view, unsigned i, const ff_strips *strips)
{
    if (!view->index) return;
    view->first[i] = strips->first[i];
    view->length[i] = strips->length[i];
    memcpy(view->index + view->first[i], strips->index + strips->first[i],
           strips->length[i] * sizeof *strips->index);
}

int ff_terrain_view_strips(ff_terrain_view *view, unsigned node_log2, ff_strips *strips)
{
    int rc = ff_strips_make(strips, node_log2);
    for (unsigned i = 0; rc == FF_OK && i < strips->count; i++) {
        FF_ASSERT(strips->first[i] + strips->length[i] <= (int)ff_strips_indices(node_log2));
        view->strip[i].id = 0;
        keep_strip(view, i, strips);
        if (strips->length[i] == 0) continue; /* INNER of the smallest nodes */
        view->strip[i] = c3d_strip_make(view->device, strips->index + strips->first[i],
                                        strips->length[i]);
        if (!view->strip[i].id) rc = FF_ERR_MEMORY;
    }
    return rc;
}

static void release(ff_terrain_view *view, ff_view_node *entry)
{
    FF_ASSERT(entry->user != NULL && view->held > 0);
    if (entry->mesh.id) c3d_mesh_free(view->device, entry->mesh);
    entry->mesh.id = 0;
    entry->user = NULL;
    view->held--;
}

static void on_evict(void *context, uint32_t user)
{
    ff_terrain_view *view = context;
    FF_ASSERT(user <= view->entry_count);
    FF_ASSERT(!user || *view->entry[user - 1].user == user); /* the two name each other */
    if (user) release(view, &view->entry[user - 1]);
}

void ff_terrain_view_attach(ff_terrain_view *view, ff_tree *tree, const ff_textures *textures)
{
    FF_ASSERT(view->held == 0); /* no entry is another tree's */
    view->tree = tree;
    view->textures = textures;
    ff_tree_on_evict(tree, on_evict, view);
}

static uint64_t hash_word(uint64_t hash, uint64_t word) { return (hash ^ word) * HASH_PRIME; }

static uint64_t hash_heights(const ff_tree *tree, const ff_drawn *drawn, uint32_t count)
{
    const uint16_t *drop = ff_tree_drop(tree, drawn);
    uint64_t hash = FF_TERRAIN_VIEW_HASH_START;
    FF_ASSERT(count <= FF_NODE_HEIGHTS_MAX);
    for (uint32_t i = 0; i < count; i++) hash = hash_word(hash, drawn->heights[i]);
    for (uint32_t i = 0; drop && i < count; i++) hash = hash_word(hash, drop[i]);
    return hash;
}

/* The drawn node's entry, made when it has none; NULL when every entry belongs to a node of this
 * frame. */
static ff_view_node *entry_of(ff_terrain_view *view, const ff_drawn *drawn)
{
    uint32_t *user = ff_tree_user(view->tree, drawn->node);
    FF_ASSERT(*user <= view->entry_count);
    FF_ASSERT(!*user || view->entry[*user - 1].used == view->stamp); /* marked as it began */
    if (*user) return &view->entry[*user - 1];
    for (uint32_t tries = 0; tries < view->entry_count; tries++) {
        uint32_t place = view->hand;
        ff_view_node *entry = &view->entry[place];
        FF_ASSERT(place < view->entry_count);
        view->hand = view->hand + 1 < view->entry_count ? view->hand + 1 : 0;
        if (entry->user && entry->used == view->stamp) continue;
        if (entry->user) {
            FF_ASSERT(*entry->user == place + 1);
            *entry->user = 0;
            release(view, entry);
        }
        entry->user = user;
        entry->used = view->stamp;
        entry->heights_hash = 0;
        if (view->kept) memset(&view->kept[place], 0, sizeof *view->kept);
        *user = place + 1;
        if (++view->held > view->held_high) view->held_high = view->held;
        FF_ASSERT(view->held <= view->entry_count);
        return entry;
    }
    return NULL;
}

void ff_terrain_view_begin(ff_terrain_view *view, const ff_drawn *list, uint32_t count)
{
    view->stamp++;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t user = *ff_tree_user(view->tree, list[i].node);
        FF_ASSERT(user <= view->entry_count);
        if (user) view->entry[user - 1].used = view->stamp;
    }
}

uint64_t ff_terrain_view_hash(ff_terrain_view *view, const ff_drawn *list, uint32_t count)
{
    uint64_t hash = FF_TERRAIN_VIEW_HASH_START;
    for (uint32_t i = 0; i < count; i++) {
        const ff_drawn *drawn = &list[i];
        ff_view_node *entry = entry_of(view, drawn);
        FF_ASSERT(drawn->coarser < 1u << FF_SIDE_COUNT);
        if (entry && !entry->heights_hash)
            entry->heights_hash = hash_heights(view->tree, drawn, view->heights_per_node);
        hash = hash_word(hash, drawn->key);
        hash = hash_word(hash, drawn->coarser);
        for (int axis = 0; axis < 3; axis++)
            hash = hash_word(hash, (uint32_t)drawn->origin_wu[axis]);
        hash = hash_word(hash, entry ? entry->heights_hash
                                     : hash_heights(view->tree, drawn, view->heights_per_node));
    }
    return hash;
}

static c3d_mesh make_mesh(ff_terrain_view *view, const ff_terrain_info *info, const ff_drawn *drawn)
{
    FF_ASSERT(view->frame.set == 1);
    ff_tree_vertices(view->tree, drawn, 1, view->vertices);
    ff_ground_frame_vertices(&view->frame, info, drawn, view->vertices, view->heights_per_node);
    return c3d_mesh_make(view->device, view->vertices, view->heights_per_node);
}

static void free_meshes(ff_terrain_view *view)
{
    for (uint32_t i = 0; i < view->entry_count; i++) {
        FF_ASSERT(!view->entry[i].mesh.id || view->entry[i].user != NULL);
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

/* The node's mesh, its entry's or one for this call. */
static c3d_mesh mesh_of(ff_terrain_view *view, const ff_terrain_info *info, const ff_drawn *drawn,
                        ff_view_node *entry)
{
    c3d_mesh mesh = entry && entry->mesh.id ? entry->mesh : make_mesh(view, info, drawn);
    if (!mesh.id && free_one_mesh(view)) mesh = make_mesh(view, info, drawn);
    if (entry) entry->mesh = mesh;
    return mesh;
}

void ff_terrain_view_new_frame(ff_terrain_view *view) { view->frame.set = 0; }

void ff_terrain_view_draw(ff_terrain_view *view, const ff_drawn *list, uint32_t count,
                          const c3d_camera *camera, unsigned show)
{
    c3d_draw ground = { .flags = C3D_DRAW_COLOURED };
    uint32_t ground_count;
    const ff_terrain_info *grounds = ff_tree_grounds(view->tree, &ground_count), *last = NULL;
    if (ff_ground_frame_follow(&view->frame, grounds, ground_count, camera)) free_meshes(view);
    if (view->textures)
        view->look = ff_textures_look(view->textures, ff_tree_frame(view->tree), camera);
    for (uint32_t i = 0; i < count; i++) {
        const ff_drawn *drawn = &list[i];
        const ff_terrain_info *info = ff_tree_ground(view->tree, drawn->key);
        if (info != last) ff_ground_frame_draw(&view->frame, info, camera, &ground);
        FF_ASSERT((uint32_t)ground.tex_columns * ground.tex_columns == view->heights_per_node);
        last = info;
        ff_view_node *entry = entry_of(view, drawn);
        c3d_draw draw = ground;
        c3d_mesh mesh = draw.mesh = mesh_of(view, info, drawn, entry);
        ff_node_draw(view, info, drawn, entry, &draw);
        if (show) ff_show_over(view, drawn, &draw, show);
        if (view->contours.interval_wu) ff_node_contours(view, info, drawn, &ground);
        if (!entry && mesh.id) c3d_mesh_free(view->device, mesh);
    }
}
