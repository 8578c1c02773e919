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
        FF_ASSERT(i <= textures->slot_count && textures->slot[i - 1].tag > 0);
        if (textures->slot[i - 1].key == key && textures->slot[i - 1].tag == textures->layer + 1)
            return &textures->slot[i - 1];
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
             texels = (uint64_t)textures->texture_count << 2 * textures->info.texture_log2;
    int32_t fitting_q8 = (int32_t)c3d_isqrt64((pixels << 16) / (texels ? texels : 1)),
            least_q8 = textures->texel_px_q8;
    return (ff_texel_look){ .frame = *frame,
                            .pos_wu = { camera->pos_wu[0], camera->pos_wu[1], camera->pos_wu[2] },
                            .focal_q8 = camera->focal_q8,
                            .texel_px_q8 = fitting_q8 > least_q8 ? fitting_q8 : least_q8,
                            .across = textures->across };
}

/* The image of a key that is held, or the nearest one above it. */
static ff_texture_slot *find_nearest(const ff_textures *textures, ff_key key)
{
    for (;; key = ff_key_parent(key)) {
        ff_texture_slot *slot = find(textures, key);
        if (slot || ff_key_level(key) == 0) return slot;
    }
}

/* The same of those that can be drawn: pictures are held that are not on the device. */
static ff_texture_slot *find_drawable(const ff_textures *textures, ff_key key)
{
    ff_texture_slot *slot = find_nearest(textures, key);
    while (slot && !slot->texture.id && slot->coded.bytes && ff_key_level(slot->key) > 0)
        slot = find_nearest(textures, ff_key_parent(slot->key));
    return slot;
}

unsigned ff_textures_wanted(const ff_textures *textures, const ff_tree *tree, const ff_drawn *drawn,
                            const ff_texel_look *look, ff_wear list[FF_WEAR_MAX])
{
    const ff_terrain_info *info = ff_tree_ground(tree, drawn->key);
    return info->texture_log2 == textures->info.texture_log2 ? ff_wear_list(tree, drawn, look, list)
                                                             : 0;
}

/* The image of that level on the way to `finest`. */
static ff_key on_the_way(ff_key finest, uint32_t level)
{
    FF_ASSERT(level <= ff_key_level(finest));
    while (ff_key_level(finest) > level) finest = ff_key_parent(finest);
    return finest;
}

/* 1 when the image held nearest above `image`, which is wanted on the node, tells that the ground
 * there shows its own colours. */
static int is_open(const ff_texture_slot *held, ff_key node, ff_key image)
{
    ff_key at = ff_key_level(node) > ff_key_level(image) ? node : image;
    uint32_t level = ff_key_level(held->key);
    if (ff_key_level(at) <= level) return held->marks.open == 15;
    return held->marks.open >> ff_key_quadrant(on_the_way(at, level + 1)) & 1;
}

/* The squares of a node that lie below an image of its own, or a finer one, and show colours. */
static ff_squares open_squares(const ff_textures *textures, const ff_texture_slot *held,
                               ff_key node)
{
    unsigned log2 = textures->info.node_log2;
    ff_squares squares = 0;
    uint32_t level = ff_key_level(held->key) + 1;
    if (level <= ff_key_level(node) || level > ff_key_level(node) + ff_image_depth(log2)) return 0;
    for (unsigned q = 0; q < 4; q++)
        if (held->marks.open >> q & 1)
            squares |= ff_wear_squares(log2, node, ff_key_child(held->key, q));
    return squares;
}

/* What is worn where `part` is wanted; *open: the squares of it that show colours all the same. */
static ff_key worn(const ff_textures *textures, ff_key node, ff_key image, ff_squares *open)
{
    const ff_texture_slot *held = find_nearest(textures, image);
    *open = 0;
    if (!held || is_open(held, node, image)) return FF_KEY_NONE;
    *open = open_squares(textures, held, node);
    const ff_texture_slot *slot = find_drawable(textures, image);
    return slot->texture.id ? slot->key : FF_KEY_NONE;
}

unsigned ff_textures_worn(const ff_textures *textures, const ff_tree *tree, const ff_drawn *drawn,
                          const ff_texel_look *look, ff_wear list[FF_WEAR_MAX])
{
    unsigned wanted = ff_textures_wanted(textures, tree, drawn, look, list), count = 0;
    ff_squares colours = 0;
    for (unsigned i = 0; i < wanted; i++) {
        const ff_wear part = list[i]; /* its place may be taken */
        ff_squares open;
        ff_key image = worn(textures, drawn->key, part.image, &open);
        if (image == FF_KEY_NONE) open = part.squares;
        colours |= part.squares & open;
        if (!(part.squares & ~open)) continue;
        unsigned same = 0;
        while (same < count && list[same].image != image) same++;
        if (same == count) list[count++] = (ff_wear){ image, 0 };
        list[same].squares |= part.squares & ~open;
    }
    FF_ASSERT(count < FF_WEAR_MAX || !colours);
    if (colours) list[count++] = (ff_wear){ FF_KEY_NONE, colours };
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
    if (slot) slot->used = slot->drawn = textures->stamp;
    return slot != NULL;
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

static const ff_texture_wish *find_wish(const ff_texture_wish *list, uint32_t count, ff_key key)
{
    for (uint32_t i = 0; i < count; i++)
        if (list[i].key == key) return &list[i];
    return NULL;
}

/* One that is not there yet. */
static void insert(ff_texture_wish *list, uint32_t *count, uint32_t capacity, ff_texture_wish wish)
{
    FF_ASSERT(*count <= capacity);
    uint32_t at = *count;
    if (at == capacity && (!capacity || list[at - 1].priority >= wish.priority)) return;
    if (*count < capacity)
        ++*count;
    else
        at--;
    while (at > 0 && list[at - 1].priority < wish.priority) {
        list[at] = list[at - 1];
        at--;
    }
    list[at] = wish;
    FF_ASSERT(at + 1 == *count || list[at + 1].priority < wish.priority);
}

/* ---- slots ---- */

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

static void free_texture(ff_textures *textures, ff_texture_slot *slot)
{
    if (!slot->texture.id) return;
    FF_ASSERT(textures->made > 0);
    c3d_texture_free(textures->device, slot->texture);
    slot->texture.id = 0;
    textures->made--;
}

/* What came of those behind it moves up. */
static void forget_coded(ff_textures *textures, ff_texture_slot *slot)
{
    const ff_coded coded = slot->coded;
    if (!coded.bytes) return;
    ff_held_pictures_cut(&textures->pictures, slot->key, coded);
    slot->coded.bytes = 0;
    for (unsigned i = 0; i < textures->slot_count; i++)
        if (textures->slot[i].tag && textures->slot[i].coded.at > coded.at)
            textures->slot[i].coded.at -= coded.bytes;
}

static void drop(ff_textures *textures, ff_texture_slot *slot)
{
    unlink_slot(textures, slot);
    free_texture(textures, slot);
    forget_coded(textures, slot);
    slot->tag = 0;
    textures->held--;
}

/* Among those not in use the one longest out of use, of several the finest: no picture goes before
 * one that is a difference to it. NULL: all are in use. */
static ff_texture_slot *oldest_slot(const ff_textures *textures)
{
    ff_texture_slot *oldest = NULL;
    for (unsigned i = 0; i < textures->slot_count; i++) {
        ff_texture_slot *slot = &textures->slot[i];
        if (!slot->tag || slot->used == textures->stamp) continue;
        uint32_t age = textures->stamp - slot->used,
                 most = oldest ? textures->stamp - oldest->used : 0;
        if (age > most ||
            (oldest && age == most && ff_key_level(slot->key) > ff_key_level(oldest->key)))
            oldest = slot;
    }
    return oldest;
}

/* A free slot, and room for so many bytes as they came; NULL: there is none. */
static ff_texture_slot *take_slot(ff_textures *textures, uint32_t coded_bytes)
{
    const ff_held_pictures *pictures = &textures->pictures;
    while (textures->held == textures->slot_count ||
           coded_bytes > pictures->coded_size - pictures->coded_used) {
        ff_texture_slot *oldest = oldest_slot(textures);
        if (!oldest) return NULL;
        drop(textures, oldest);
    }
    for (unsigned i = 0;; i++) {
        FF_ASSERT(i < textures->slot_count);
        if (!textures->slot[i].tag) return &textures->slot[i];
    }
}

/* Holds an image by name. NULL: there is no room. */
static ff_texture_slot *hold(ff_textures *textures, ff_key key, ff_image_marks marks,
                             uint32_t coded_bytes)
{
    ff_texture_slot *slot = take_slot(textures, coded_bytes);
    if (!slot) {
        textures->full++;
        return NULL;
    }
    *slot = (ff_texture_slot){ .key = key,
                               .tag = (uint8_t)(textures->layer + 1),
                               .marks = marks,
                               .used = textures->stamp,
                               .drawn = textures->stamp,
                               .next = textures->bucket[bucket_of(key)] };
    textures->bucket[bucket_of(key)] = (uint16_t)(slot - textures->slot + 1);
    if (++textures->held > textures->high) textures->high = textures->held;
    FF_ASSERT(textures->held <= textures->slot_count);
    return slot;
}

/* ---- on the device ---- */

/* Makes room for a texture. Of images that are no pictures nothing is left without. */
static int make_room(ff_textures *textures)
{
    ff_texture_slot *oldest = NULL;
    if (textures->made < textures->texture_count) return 1;
    for (unsigned i = 0; i < textures->slot_count; i++) {
        ff_texture_slot *slot = &textures->slot[i];
        if (!slot->tag || !slot->texture.id || slot->drawn == textures->stamp) continue;
        if (!oldest || textures->stamp - slot->drawn > textures->stamp - oldest->drawn)
            oldest = slot;
    }
    if (!oldest) return 0;
    if (oldest->coded.bytes)
        free_texture(textures, oldest);
    else
        drop(textures, oldest);
    return 1;
}

static int make_texture(ff_textures *textures, ff_texture_slot *slot, const uint16_t *texels)
{
    uint32_t side = 1u << textures->info.texture_log2;
    if (make_room(textures))
        slot->texture = c3d_texture_make(textures->device, C3D_RGB565, side, side, texels);
    textures->made += slot->texture.id != 0;
    if (textures->made > textures->made_high) textures->made_high = textures->made;
    textures->full += slot->texture.id == 0;
    return slot->texture.id != 0;
}

static ff_coded find_coded(const void *context, ff_key key)
{
    const ff_texture_slot *slot = find(context, key);
    return slot ? slot->coded : (ff_coded){ 0, 0 };
}

const uint8_t *ff_textures_picture(ff_textures *textures, const ff_terrain_info *info, ff_key key,
                                   int *error)
{
    return ff_held_pictures_get(&textures->pictures, info, key, find_coded, textures, error);
}

/* Decodes a picture that is held and puts it on the device. 1, or 0: it is not there. */
static int put_on_device(ff_textures *textures, const ff_terrain_info *info, ff_key key)
{
    int error;
    const uint8_t *rgb = ff_textures_picture(textures, info, key, &error);
    ff_texture_slot *slot = find(textures, key);
    if (!rgb || !slot) return 0;
    ff_texture_texels(&textures->info, rgb, textures->texels);
    if (!make_texture(textures, slot, textures->texels)) return 0;
    slot->drawn = textures->stamp;
    return 1;
}

/* ---- taking in ---- */

static int take_picture(ff_textures *textures, const ff_terrain_info *info, ff_new_item *item)
{
    const uint8_t *bytes = (const uint8_t *)item->pixels;
    uint32_t level = ff_key_level(item->key), count = item->u.texture.coded_bytes;
    if (!textures->pictures.rgb)
        return ff_textures_put(textures, item->key, item->u.texture.marks, NULL);
    if (find(textures, item->key)) return 0;
    if (level && !find(textures, ff_key_parent(item->key))) {
        textures->apart++;
        return 0;
    }
    ff_texture_slot *slot = hold(textures, item->key, item->u.texture.marks, count);
    if (!slot) return 0;
    slot->coded = ff_held_pictures_add(&textures->pictures, bytes, count);
    (void)ff_textures_picture(textures, info, item->key, &item->error);
    if (item->error != FF_OK) {
        drop(textures, slot);
        return 0;
    }
    return put_on_device(textures, info, item->key);
}

int ff_textures_take(ff_textures *textures, const ff_terrain_info *info, ff_new_item *item)
{
    FF_ASSERT(item->width == 1u << textures->info.texture_log2);
    if (item->u.texture.coded_bytes) return take_picture(textures, info, item);
    return ff_textures_put(textures, item->key, item->u.texture.marks,
                           item->u.texture.marks.open == 15 ? NULL : item->pixels);
}

int ff_textures_put(ff_textures *textures, ff_key key, ff_image_marks marks, const uint16_t *texels)
{
    if (find(textures, key)) return 0;
    ff_texture_slot *slot = hold(textures, key, marks, 0);
    if (!slot || !textures->device || !texels) return slot != NULL;
    if (make_texture(textures, slot, texels)) return 1;
    drop(textures, slot);
    return 0;
}

void ff_textures_set_layer(ff_textures *textures, uint8_t layer)
{
    if (textures->layer == layer) return;
    textures->layer = layer;
    ff_held_pictures_forget(&textures->pictures);
}

void ff_textures_doubt(ff_textures *textures)
{
    for (unsigned i = 0; i < textures->slot_count; i++) textures->slot[i].marks.bare = 0;
}

/* ---- wishes ---- */

/* What wishes are made of. */
typedef struct wisher {
    ff_textures *textures;
    const ff_tree *tree;
    const ff_view *view;
    const ff_quality *quality;
    ff_texture_wish *list;
    uint32_t count, capacity;
    uint32_t in_use, bytes_in_use, drawn; /* held; as they came; on the device */
    ff_texture_wish missing;              /* the most urgent one that is held and not there */
} wisher;

/* Marks an image and those above it, without which those below could not be decoded. */
static void use(wisher *w, ff_key key)
{
    for (;; key = ff_key_parent(key)) {
        ff_texture_slot *slot = find(w->textures, key);
        if (slot && slot->used == w->textures->stamp) return;
        if (slot) {
            slot->used = w->textures->stamp;
            w->in_use++;
            w->bytes_in_use += slot->coded.bytes;
        }
        if (ff_key_level(key) == 0 || !w->textures->pictures.rgb) return;
    }
}

static ff_texture_wish wish_of(const wisher *w, ff_key key)
{
    return (ff_texture_wish){ key,
                              priority_of(ff_tree_ground(w->tree, key), key, w->view, w->quality) };
}

/* Marks what is drawn where an image is wanted; what is held of it and not drawn is missing. */
static void draw(wisher *w, const ff_texture_slot *held)
{
    ff_texture_slot *slot = find_drawable(w->textures, held->key);
    if (slot && slot->drawn != w->textures->stamp) {
        slot->drawn = w->textures->stamp;
        w->drawn += slot->texture.id != 0;
    }
    if (slot == held && (slot->texture.id || !slot->coded.bytes)) return;
    ff_texture_wish missing = wish_of(w, held->key);
    if (missing.priority > w->missing.priority) w->missing = missing;
}

/* All on the way to `finest` from a level on are wished for, down to level `to`, so that they come
 * in one round trip: none before those above it. */
static void wish_down(wisher *w, ff_key finest, uint32_t from, uint32_t to)
{
    uint32_t least = UINT32_MAX;
    FF_ASSERT(from <= to && to <= ff_key_level(finest));
    for (uint32_t level = from; level <= to; level++) {
        ff_key key = on_the_way(finest, level);
        const ff_texture_wish *there = find_wish(w->list, w->count, key);
        ff_texture_wish wish = there ? *there : wish_of(w, key);
        if (wish.priority > least) wish.priority = least;
        least = wish.priority;
        if (!there) insert(w->list, &w->count, w->capacity, wish);
    }
}

/* The last level that is wished for on the way to an image that a node of level `most` wants, from
 * level `next` on. Below those that the ground has all images of only the image above one tells
 * that it is there; below the node's own who draws its children knows better what shows. */
static uint32_t last_level(const wisher *w, ff_key finest, uint32_t next, uint32_t most)
{
    uint32_t whole = ff_tree_ground(w->tree, finest)->images_whole, level = ff_key_level(finest);
    if (level >= whole) level = whole ? whole - 1 : 0;
    if (level > most) level = most;
    return level > next ? level : next;
}

/* What is lacking on the way to an image that a node wants is wished for: 1 when there is such. */
static int look_for(wisher *w, ff_key finest, ff_key node)
{
    const ff_texture_slot *held = find_nearest(w->textures, finest);
    if (held) {
        use(w, held->key);
        if (!is_open(held, node, finest)) draw(w, held);
        if (held->key == finest) return 0;
    }
    uint32_t next = held ? ff_key_level(held->key) + 1 : 0;
    if (held && ff_image_ends(held->marks, ff_key_quadrant(on_the_way(finest, next)))) return 0;
    wish_down(w, finest, next, last_level(w, finest, next, ff_key_level(node)));
    return 1;
}

/* How many more images find a place: by name, on the device, and as they come. */
static uint32_t room_for(const wisher *w)
{
    const ff_textures *textures = w->textures;
    const ff_held_pictures *pictures = &textures->pictures;
    FF_ASSERT(w->in_use <= textures->slot_count);
    uint32_t names = textures->slot_count - w->in_use,
             device = w->drawn < textures->texture_count ? textures->texture_count - w->drawn : 0,
             room = names < device ? names : device;
    if (!pictures->rgb) return room;
    uint32_t coded = (pictures->coded_size - w->bytes_in_use) /
                     FF_CODED_BYTES(textures->info.texture_log2);
    return coded < room ? coded : room;
}

uint32_t ff_textures_wishes(ff_textures *textures, const ff_tree *tree, const ff_drawn *drawn,
                            uint32_t drawn_count, const ff_view *view, const ff_quality *quality,
                            ff_texture_wish *list, uint32_t capacity, int *changed)
{
    const ff_texel_look look = ff_textures_look(textures, &view->frame, &view->camera);
    wisher w = { textures, tree, view, quality, list, 0, capacity, 0, 0, 0, { FF_KEY_NONE, 0 } };
    textures->stamp++;
    textures->lacking = 0;
    for (uint32_t i = 0; i < drawn_count; i++) {
        unsigned parts = ff_textures_wanted(textures, tree, &drawn[i], &look, textures->wear);
        int lacks = 0;
        for (unsigned part = 0; part < parts; part++)
            lacks |= look_for(&w, textures->wear[part].image, drawn[i].key);
        textures->lacking += (unsigned)lacks;
    }
    FF_ASSERT(w.in_use <= textures->held && textures->held <= textures->slot_count);
    /* what would find no place is not asked for */
    uint32_t room = room_for(&w);
    textures->waits = w.drawn < textures->texture_count && w.missing.key != FF_KEY_NONE &&
                      put_on_device(textures, ff_tree_ground(tree, w.missing.key), w.missing.key);
    *changed |= textures->waits;
    return w.count < room ? w.count : room;
}

int ff_textures_is_worn(const ff_textures *textures, ff_key image)
{
    const ff_texture_slot *slot = find(textures, image);
    return slot && slot->drawn == textures->stamp;
}
