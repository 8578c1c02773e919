#include "ff_textures.h"

#include "ff_texture_map.h"
#include "../../protocol/ff_assert.h"
#include "../../protocol/shape/ff_shape.h"

#include <string.h>

#define COLOUR_WHITE 0xFFFFFFFFu

FF_STATIC_ASSERT((FF_TEXTURE_HASH & (FF_TEXTURE_HASH - 1)) == 0 && FF_TEXTURE_HASH <= 1u << 8);

const uint8_t ff_textures_built = 1;

static unsigned bucket_of(ff_key key)
{
    return (unsigned)((key * UINT64_C(0x9E3779B97F4A7C15)) >> 56) & (FF_TEXTURE_HASH - 1);
}

static ff_texture_slot *find(const ff_textures *textures, ff_key key)
{
    for (unsigned i = textures->bucket[bucket_of(key)]; i; i = textures->slot[i - 1].next) {
        FF_ASSERT(i <= textures->slot_count && textures->slot[i - 1].held == 1);
        if (textures->slot[i - 1].key == key) return &textures->slot[i - 1];
    }
    return NULL;
}

/* Images that a picture shows of ground whose texels are as large as pixels, in pictures of one
 * image: they lie askew to it, reach beyond it, and have those above them. */
#define IMAGES_A_PICTURE 6u

ff_texel_look ff_textures_look(const ff_textures *textures, const ff_frame *frame,
                               const c3d_camera *camera)
{
    uint64_t pixels = (uint64_t)camera->width * camera->height * IMAGES_A_PICTURE,
             texels = (uint64_t)textures->slot_count << 2 * textures->info.texture_log2;
    int32_t fitting_q8 = (int32_t)c3d_isqrt64((pixels << 16) / (texels ? texels : 1)),
            least_q8 = textures->texel_px_q8;
    return (ff_texel_look){ .frame = *frame,
                            .pos_wu = { camera->pos_wu[0], camera->pos_wu[1], camera->pos_wu[2] },
                            .focal_q8 = camera->focal_q8,
                            .texel_px_q8 = fitting_q8 > least_q8 ? fitting_q8 : least_q8,
                            .across = textures->across };
}

/* The image of a key, or the nearest one above it. */
static ff_texture_slot *find_nearest(const ff_textures *textures, ff_key key)
{
    for (;; key = ff_key_parent(key)) {
        ff_texture_slot *slot = find(textures, key);
        if (slot || ff_key_level(key) == 0) return slot;
    }
}

unsigned ff_textures_wanted(const ff_textures *textures, const ff_tree *tree, const ff_drawn *drawn,
                            const ff_texel_look *look, ff_wear list[FF_WEAR_MAX])
{
    const ff_terrain_info *info = ff_tree_ground(tree, drawn->key);
    return info->texture_log2 == textures->info.texture_log2 ? ff_wear_list(tree, drawn, look, list)
                                                             : 0;
}

unsigned ff_textures_worn(const ff_textures *textures, const ff_tree *tree, const ff_drawn *drawn,
                          const ff_texel_look *look, ff_wear list[FF_WEAR_MAX])
{
    unsigned wanted = ff_textures_wanted(textures, tree, drawn, look, list), count = 0;
    for (unsigned i = 0; i < wanted; i++) {
        const ff_wear part = list[i]; /* its place may be taken */
        const ff_texture_slot *slot = find_nearest(textures, part.image);
        ff_key image = slot && slot->texture.id ? slot->key : FF_KEY_NONE;
        unsigned same = 0;
        while (same < count && list[same].image != image) same++;
        if (same == count) list[count++] = (ff_wear){ image, 0 };
        list[same].squares |= part.squares;
    }
    return count;
}

/* The columns, or rows, of a node on which an image below it lies. */
static void set_range(const ff_terrain_info *info, uint32_t depth, uint32_t place,
                      uint32_t *first_q16, uint32_t *last_q16)
{
    uint32_t cells = 1u << (info->node_log2 - depth);
    *first_q16 = place * cells << 16;
    *last_q16 = (place + 1) * cells << 16;
}

void ff_textures_lay(const ff_textures *textures, ff_key node, ff_key image, c3d_draw *draw)
{
    const ff_texture_slot *slot = image == FF_KEY_NONE ? NULL : find(textures, image);
    if (!slot || !slot->texture.id) return;
    draw->flags = C3D_DRAW_TEXTURED;
    draw->colour = COLOUR_WHITE;
    draw->texture = slot->texture;
    ff_texture_map(&textures->info, node, image, draw->tex_scale_q16, draw->tex_offset_q16);
    if (ff_key_level(image) <= ff_key_level(node)) return;
    uint32_t depth = ff_key_level(image) - ff_key_level(node), within = (1u << depth) - 1;
    set_range(&textures->info, depth, ff_morton_x(ff_key_code(image)) & within,
              &draw->tex_first_q16[0], &draw->tex_last_q16[0]);
    set_range(&textures->info, depth, ff_morton_y(ff_key_code(image)) & within,
              &draw->tex_first_q16[1], &draw->tex_last_q16[1]);
}

int ff_textures_touch(ff_textures *textures, ff_key key)
{
    ff_texture_slot *slot = find(textures, key);
    textures->stamp++;
    if (slot) slot->used = textures->stamp;
    return slot != NULL;
}

/* The image of that level on the way to `finest`. */
static ff_key on_the_way(ff_key finest, uint32_t level)
{
    FF_ASSERT(level <= ff_key_level(finest));
    while (ff_key_level(finest) > level) finest = ff_key_parent(finest);
    return finest;
}

/* 1/f of Hybrid eq. 3 for the ground the image covers, Q8: the scale of the tree's wishes. */
static uint32_t priority_of(const ff_terrain_info *info, ff_key key, const ff_view *view,
                            const ff_quality *quality)
{
    int32_t edge_wu = ff_node_edge_wu(info, ff_key_level(key));
    ff_placed placed = ff_shape_put(info, &view->frame, key);
    int64_t way[3];
    ff_shape_to_middle(info, key, &placed, view->camera.pos_wu[2], view->camera.pos_wu, way);
    int64_t distance = c3d_length64(way[0], way[1], 0); /* as if the ground lay at our height */
    FF_ASSERT(edge_wu > 0 && distance >= 0 && distance < INT64_C(1) << 34);
    int64_t c_q8 = quality->c_q8 > 0 ? quality->c_q8 : 3 * 256;
    int64_t value = (int64_t)edge_wu * c_q8 / (distance > edge_wu / 2 ? distance : edge_wu / 2 + 1);
    return value > UINT32_MAX ? UINT32_MAX : (uint32_t)value;
}

/* A list of wishes in the making. */
typedef struct wishes {
    ff_textures *textures;
    const ff_tree *tree;
    const ff_view *view;
    const ff_quality *quality;
    ff_texture_wish *list;
    uint32_t count, capacity;
    uint32_t in_use; /* images that are drawn */
} wishes;

static void insert(wishes *w, ff_texture_wish wish)
{
    ff_texture_wish *list = w->list;
    FF_ASSERT(w->count <= w->capacity);
    for (uint32_t i = 0; i < w->count; i++)
        if (list[i].key == wish.key) return;
    uint32_t at = w->count;
    if (at == w->capacity && (!w->capacity || list[at - 1].priority >= wish.priority)) return;
    if (w->count < w->capacity)
        w->count++;
    else
        at--;
    while (at > 0 && list[at - 1].priority < wish.priority) {
        list[at] = list[at - 1];
        at--;
    }
    list[at] = wish;
    FF_ASSERT(at + 1 == w->count || list[at + 1].priority < wish.priority);
}

/* All from `from` down to `finest`, so that they come in one round trip: each stands behind those
 * above it. */
static void wish_down(wishes *w, ff_key from, ff_key finest)
{
    ff_texture_wish wish = { from, UINT32_MAX };
    for (uint32_t level = ff_key_level(from); level <= ff_key_level(finest); level++) {
        wish.key = on_the_way(finest, level);
        uint32_t own = priority_of(ff_tree_ground(w->tree, wish.key), wish.key, w->view,
                                   w->quality);
        if (own < wish.priority) wish.priority = own;
        insert(w, wish);
    }
}

/* Marks what is drawn where an image is wanted, and wishes for what is lacking on the way to it: 1
 * when there is any. */
static int look_for(wishes *w, ff_key finest)
{
    ff_textures *textures = w->textures;
    ff_texture_slot *held = find_nearest(textures, finest);
    if (held) {
        w->in_use += held->used != textures->stamp;
        held->used = textures->stamp;
        if (held->key == finest) return 0;
    }
    ff_key next = on_the_way(finest, held ? ff_key_level(held->key) + 1 : 0);
    if (held && held->bare >> ff_key_quadrant(next) & 1u) return 0;
    wish_down(w, next, finest);
    return 1;
}

uint32_t ff_textures_wishes(ff_textures *textures, const ff_tree *tree, const ff_drawn *drawn,
                            uint32_t drawn_count, const ff_view *view, const ff_quality *quality,
                            ff_texture_wish *list, uint32_t capacity)
{
    const ff_texel_look look = ff_textures_look(textures, &view->frame, &view->camera);
    wishes w = { textures, tree, view, quality, list, 0, capacity, 0 };
    ff_wear wear[FF_WEAR_MAX];
    textures->stamp++;
    textures->lacking = 0;
    for (uint32_t i = 0; i < drawn_count; i++) {
        unsigned parts = ff_textures_wanted(textures, tree, &drawn[i], &look, wear);
        int lacks = 0;
        for (unsigned part = 0; part < parts; part++) lacks |= look_for(&w, wear[part].image);
        textures->lacking += (unsigned)lacks;
    }
    FF_ASSERT(w.in_use <= textures->held && textures->held <= textures->slot_count);
    /* what would find no place is not asked for */
    uint32_t room = textures->slot_count - w.in_use;
    return w.count < room ? w.count : room;
}

int ff_textures_is_worn(const ff_textures *textures, ff_key image)
{
    const ff_texture_slot *slot = find(textures, image);
    return slot && slot->used == textures->stamp;
}

static void unlink_slot(ff_textures *textures, ff_texture_slot *slot)
{
    uint16_t *link = &textures->bucket[bucket_of(slot->key)];
    uint16_t number = (uint16_t)(slot - textures->slot + 1);
    while (*link != number) {
        FF_ASSERT(*link > 0 && *link <= textures->slot_count); /* a held slot is in its chain */
        link = &textures->slot[*link - 1].next;
    }
    *link = slot->next;
}

/* A free slot, or the one longest out of use; NULL when all are drawn. */
static ff_texture_slot *take_slot(ff_textures *textures)
{
    ff_texture_slot *oldest = NULL;
    for (unsigned i = 0; i < textures->slot_count; i++) {
        ff_texture_slot *slot = &textures->slot[i];
        if (!slot->held) return slot;
        if (slot->used != textures->stamp &&
            (!oldest || textures->stamp - slot->used > textures->stamp - oldest->used))
            oldest = slot;
    }
    FF_ASSERT(textures->held == textures->slot_count);
    if (!oldest) return NULL;
    unlink_slot(textures, oldest);
    if (oldest->texture.id) c3d_texture_free(textures->device, oldest->texture);
    oldest->held = 0;
    textures->held--;
    return oldest;
}

/* ---- pictures ---- */

static size_t picture_bytes(const ff_textures *textures)
{
    return (size_t)3 << 2 * textures->info.texture_log2;
}

static uint8_t *picture_of(const ff_textures *textures, size_t number)
{
    return textures->rgb + number * picture_bytes(textures);
}

/* The code, in the whole terrain, of a root of an entered one. */
static uint32_t code_above(const ff_terrain_info *info, ff_key root)
{
    ff_sheet at = ff_shape_sheet(info, ff_key_tile(root));
    uint32_t within = (1u << info->entered) - 1u;
    return ff_morton_encode(at.x & within, at.y & within);
}

/* To the place behind those of the slots. */
static int decode(ff_textures *textures, const ff_terrain_info *info, const ff_new_item *item,
                  const ff_texture_slot *parent)
{
    const uint8_t *bytes = (const uint8_t *)item->pixels;
    uint8_t *rgb = picture_of(textures, textures->slot_count);
    unsigned log2 = textures->info.texture_log2;
    if (info->entered && !parent)
        return ff_picture_decode_row(bytes, item->u.texture.coded_bytes, log2, info->entered,
                                     code_above(info, item->key), textures->room, rgb,
                                     picture_of(textures, textures->slot_count + 1u));
    ff_picture_above above = { 0 };
    if (parent)
        above = (ff_picture_above){ picture_of(textures, (size_t)(parent - textures->slot)),
                                    ff_key_quadrant(item->key) };
    return ff_picture_decode(bytes, item->u.texture.coded_bytes, log2, above, textures->room, rgb);
}

static int take_picture(ff_textures *textures, const ff_terrain_info *info, ff_new_item *item)
{
    uint32_t level = ff_key_level(item->key);
    ff_texture_slot *parent = level ? find(textures, ff_key_parent(item->key)) : NULL;
    if (!textures->rgb) return ff_textures_put(textures, item->key, item->u.texture.bare, NULL);
    if (level && !parent) {
        textures->apart++;
        return 0;
    }
    item->error = decode(textures, info, item, parent);
    if (item->error != FF_OK) return 0;
    const uint8_t *rgb = picture_of(textures, textures->slot_count);
    ff_texture_texels(&textures->info, rgb, item->pixels); /* what was coded is done with */
    if (!ff_textures_put(textures, item->key, item->u.texture.bare, item->pixels)) return 0;
    ff_texture_slot *slot = find(textures, item->key);
    memcpy(picture_of(textures, (size_t)(slot - textures->slot)), rgb, picture_bytes(textures));
    return 1;
}

int ff_textures_take(ff_textures *textures, const ff_terrain_info *info, ff_new_item *item)
{
    FF_ASSERT(item->width == 1u << textures->info.texture_log2);
    if (item->u.texture.coded_bytes) return take_picture(textures, info, item);
    return ff_textures_put(textures, item->key, item->u.texture.bare, item->pixels);
}

/* ---- */

void ff_textures_doubt(ff_textures *textures)
{
    for (unsigned i = 0; i < textures->slot_count; i++) textures->slot[i].bare = 0;
}

int ff_textures_put(ff_textures *textures, ff_key key, uint8_t bare, const uint16_t *texels)
{
    if (find(textures, key)) return 0;
    ff_texture_slot *slot = take_slot(textures);
    if (!slot) {
        textures->full++;
        return 0;
    }
    FF_ASSERT(!slot->held && textures->held < textures->slot_count);
    slot->texture.id = 0;
    if (textures->device && texels) {
        uint32_t side = 1u << textures->info.texture_log2;
        slot->texture = c3d_texture_make(textures->device, C3D_RGB565, side, side, texels);
        if (!slot->texture.id) {
            textures->full++;
            return 0;
        }
    }
    slot->key = key;
    slot->held = 1;
    slot->bare = bare;
    slot->used = textures->stamp;
    slot->next = textures->bucket[bucket_of(key)];
    textures->bucket[bucket_of(key)] = (uint16_t)(slot - textures->slot + 1);
    if (++textures->held > textures->high) textures->high = textures->held;
    return 1;
}
