#include "ff_view_parts.h"
#include "../../client/terrain/ff_pack_source.h"

#include <stdlib.h>
#include <string.h>

#define NODES    4096u /* slots of the tree: bounds memory and work */
#define WISHES   256u
#define SIGMA_Q8 320
#define NEAR_WU  64
/* every round refines a level or makes a list of leaves, or it is the last */
#define ROUNDS_MAX 64
#define AGAIN_MAX  4 /* what hidden ground leaves room for is looked for so often */

typedef struct search {
    const ff_pack *pack;
    const ff_get_view *view;
    ff_view_part part[FF_PARTS_MAX]; /* as they were found */
    uint32_t count;
    uint64_t bytes;
    int full;
    uint8_t needed[FF_PARTS_MAX];
    ff_tree *tree;
    ff_decoder *decoder;
    void *tree_memory, *decoder_memory;
    ff_wish wish[WISHES];
    int32_t values[FF_REFINED_HEIGHTS_MAX];
} search;

/* No more than the terrain has, and than the tree takes. */
static uint32_t nodes_for(const ff_terrain_info *info)
{
    uint64_t level = ff_shape_tiles(info), all = 8;
    for (uint32_t l = 0; l < ff_terrain_levels(info) && all < NODES; l++, level *= 4) all += level;
    return all < NODES ? (uint32_t)all : NODES;
}

static int search_open(search *s)
{
    const ff_terrain_info *info = &s->pack->header.info;
    ff_tree_desc desc = { .info = *info,
                          .node_count = s->pack->next ? NODES : nodes_for(info),
                          .wish_count = WISHES,
                          .ground_max = ff_pack_source_grounds(s->pack) };
    size_t tree_bytes = ff_tree_bytes(&desc), decoder_bytes = ff_pack_source_decoder_bytes(s->pack);
    s->tree_memory = malloc(tree_bytes);
    s->decoder_memory = malloc(decoder_bytes);
    if (!s->tree_memory || !s->decoder_memory) return FF_ERR_MEMORY;
    s->tree = ff_tree_create(&desc, s->tree_memory, tree_bytes);
    s->decoder = ff_decoder_create(info, s->decoder_memory, decoder_bytes);
    return s->tree && s->decoder ? ff_pack_source_add(s->pack, s->tree) : FF_ERR_MEMORY;
}

static void search_close(search *s)
{
    free(s->tree_memory);
    free(s->decoder_memory);
}

static ff_quality quality_of(const ff_get_view *view)
{
    return (ff_quality){ .measure = view->measure == FF_VIEW_BY_PIXELS ? FF_MEASURE_PIXELS
                                                                       : FF_MEASURE_DISTANCE,
                         .c_q8 = view->allowed_q8,
                         .error_px_q8 = view->allowed_q8,
                         .depth_max = view->depth_max,
                         .sigma_q8 = SIGMA_Q8,
                         .view_wu = view->reach_wu,
                         .fine_wu = view->fine_wu,
                         .coarse = view->coarse,
                         .triangles_max = view->triangles_max };
}

static ff_view view_of(const ff_terrain_info *info, const ff_get_view *asked)
{
    ff_view view = { .frame = ff_shape_frame(info, asked->position_wu) };
    c3d_camera *camera = &view.camera;
    ff_shape_enter(info, &view.frame, asked->position_wu, camera->pos_wu);
    memcpy(view.centre_wu, camera->pos_wu, sizeof view.centre_wu);
    camera->yaw = asked->yaw;
    camera->pitch = (int16_t)asked->pitch;
    camera->roll = asked->roll;
    camera->focal_q8 = asked->focal_q8;
    camera->width = asked->width;
    camera->height = asked->height;
    camera->near_wu = NEAR_WU;
    camera->far_wu = INT32_MAX;
    return view;
}

static uint64_t bytes_of(const search *s, enum ff_kind kind, ff_key key)
{
    const uint8_t *payload;
    int bytes = ff_pack_record(s->pack, (enum ff_section_kind)ff_kind[kind].section, key, &payload);
    return bytes > 0 ? (uint64_t)bytes : 0;
}

static uint64_t named_bytes(const search *s)
{
    uint64_t bytes = 0;
    for (unsigned i = 0; i < s->view->count; i++)
        bytes += bytes_of(s, s->view->roots >> i & 1u ? FF_KIND_ROOT : FF_KIND_REFINEMENT,
                          s->view->below[i]);
    return bytes;
}

/* Puts it on the list, while there is room; 1 when it stands there. */
static int add(search *s, enum ff_kind kind, ff_key key)
{
    uint64_t bytes = bytes_of(s, kind, key);
    s->full |= s->count == FF_PARTS_MAX || s->bytes + bytes > s->view->bytes_max;
    if (s->full) return 0;
    s->part[s->count++] = (ff_view_part){ .key = key, .kind = (uint8_t)kind };
    s->bytes += bytes;
    return 1;
}

/* Takes one wish from the pack into the tree, and on the list when it is asked for. 1 when it was
 * delivered. */
static int serve(search *s, const ff_wish *wish)
{
    enum ff_kind kind = (enum ff_kind)wish->kind;
    if (ff_pack_source_serve(s->pack, s->decoder, s->values, s->tree, kind, wish->key) != FF_OK)
        return 0;
    if (!ff_view_covers(s->view, kind, wish->key) || ff_view_names(s->view, kind, wish->key))
        return 1;
    return add(s, kind, wish->key);
}

/* Serves what is wished for in view, from a copy of the list, because it changes as nodes come in.
 * How many were delivered. */
static uint32_t serve_wishes(search *s)
{
    const ff_wish *list;
    uint32_t count = ff_tree_wishes(s->tree, &list), delivered = 0;
    memcpy(s->wish, list, count * sizeof *list);
    for (uint32_t i = 0; i < count && !s->full; i++)
        if (s->wish[i].in_view) delivered += (uint32_t)serve(s, &s->wish[i]);
    return delivered;
}

static void find_parts(search *s)
{
    const ff_view view = view_of(&s->pack->header.info, s->view);
    const ff_quality quality = quality_of(s->view);
    for (int round = 0; round < ROUNDS_MAX && !s->full; round++) {
        ff_tree_select(s->tree, &view, &quality);
        if (serve_wishes(s) == 0 && ff_tree_to_make(s->tree) == 0) break;
    }
}

/* Marks what brings a node. 1 when nobody had. */
static int mark(search *s, ff_key node)
{
    int root = ff_key_level(node) == 0;
    ff_key key = root ? node : ff_key_parent(node);
    for (uint32_t i = 0; i < s->count; i++)
        if (s->part[i].key == key && (s->part[i].kind == FF_KIND_ROOT) == root) {
            int first = !s->needed[i];
            s->needed[i] = 1;
            return first;
        }
    return 0;
}

/* Marks all that a node needs to be drawn: what is above it, and beside each of these the nodes of
 * its level, without which it could not be split off (the cut is restricted). */
static void need(search *s, ff_key node)
{
    for (;; node = ff_key_parent(node)) {
        const ff_terrain_info *info = ff_tree_ground(s->tree, node);
        for (unsigned side = 0; side < FF_SIDE_COUNT && ff_key_level(node) > 0; side++) {
            ff_key beside = ff_shape_neighbour(info, node, (enum ff_side)side).key;
            if (beside != FF_KEY_NONE && mark(s, beside)) need(s, ff_key_parent(beside));
        }
        (void)mark(s, node);
        if (ff_key_level(node) == 0) return;
    }
}

/* Leaves out what was asked for before a ridge was there that hides it; 1 when there was any. */
static int leave_out_hidden(search *s)
{
    const ff_drawn *drawn;
    const ff_view view = view_of(&s->pack->header.info, s->view);
    const ff_quality quality = quality_of(s->view);
    ff_tree_select(s->tree, &view, &quality);
    uint32_t count = ff_tree_drawn(s->tree, &drawn), kept = 0;
    for (uint32_t i = 0; i < count; i++) need(s, drawn[i].key);
    for (uint32_t i = 0; i < s->count; i++)
        if (s->needed[i]) s->part[kept++] = s->part[i];
    int fewer = kept < s->count;
    s->count = kept;
    memset(s->needed, 0, sizeof s->needed);
    return fewer;
}

static void find_needed(search *s)
{
    for (int round = 0; round < AGAIN_MAX; round++) {
        find_parts(s);
        if (!leave_out_hidden(s) || !s->full) return;
        s->full = 0;
        s->bytes = named_bytes(s);
        for (uint32_t i = 0; i < s->count; i++)
            s->bytes += bytes_of(s, (enum ff_kind)s->part[i].kind, s->part[i].key);
    }
}

int ff_view_named(const ff_get_view *view, ff_view_part *part)
{
    for (unsigned i = 0; i < view->count; i++)
        part[i] = (ff_view_part){ .key = view->below[i],
                                  .kind = view->roots >> i & 1u ? FF_KIND_ROOT
                                                                : FF_KIND_REFINEMENT };
    return view->count;
}

/* Takes it off those that were found: its place among them, or -1. */
static int take(search *s, enum ff_kind kind, ff_key key)
{
    for (uint32_t i = 0; i < s->count; i++)
        if (s->part[i].key == key && s->part[i].kind == kind) {
            s->part[i].kind = FF_KIND_COUNT;
            return (int)i;
        }
    return -1;
}

/* Each behind what stands above it, breadth first. */
static uint32_t arrange(search *s, ff_view_part *out, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        int root = out[i].kind == FF_KIND_ROOT;
        out[i].first = (uint16_t)count;
        if (!root && ff_key_level(out[i].key) == FF_KEY_LEVEL_MAX) continue;
        for (unsigned q = 0; q < (root ? 1u : 4u); q++) {
            ff_key key = root ? out[i].key : ff_key_child(out[i].key, q);
            int turn = take(s, FF_KIND_REFINEMENT, key);
            if (turn < 0) continue;
            out[i].below |= (uint8_t)(1u << q);
            out[count++] =
                (ff_view_part){ .key = key, .kind = FF_KIND_REFINEMENT, .turn = (uint16_t)turn };
        }
    }
    return count;
}

/* What comes first: what is named and of the edge, or the roots that were found. */
static uint32_t first_parts(search *s, ff_view_part *out, ff_view_front *front)
{
    const ff_get_view *view = s->view;
    uint32_t count = (uint32_t)ff_view_named(view, out);
    for (unsigned i = 0; i < view->edge_count; i++) {
        int turn = take(s, FF_KIND_REFINEMENT, view->edge[i]);
        if (turn < 0) continue;
        front->edge |= 1u << i;
        out[count++] = (ff_view_part){ .key = view->edge[i],
                                       .kind = FF_KIND_REFINEMENT,
                                       .turn = (uint16_t)turn };
    }
    for (uint32_t i = 0; view->count == 0 && i < s->count; i++)
        if (s->part[i].kind == FF_KIND_ROOT) out[count++] = s->part[i];
    if (view->count == 0) front->roots = count;
    return count;
}

int ff_view_parts(const ff_pack *pack, const ff_get_view *view, ff_view_part part[FF_PARTS_MAX],
                  ff_view_front *front)
{
    search *s = calloc(1, sizeof *s);
    *front = (ff_view_front){ 0 };
    if (!s) return FF_ERR_MEMORY;
    s->pack = pack;
    s->view = view;
    s->bytes = named_bytes(s);
    int rc = search_open(s);
    if (rc == FF_OK) {
        find_needed(s);
        rc = (int)arrange(s, part, first_parts(s, part, front));
    }
    search_close(s);
    free(s);
    return rc;
}
