/* What stands behind the rows of ff_budget.h: sizes alone, nothing is taken here. */
#include "ff_client_local.h"
#include "../protocol/ff_assert.h"

#include <string.h>

#define FACE_SIZE_MIN         64u
#define EXTRA_STRIPS          4
#define EXTRA_INDICES         (FF_SKY_INDICES + 36u) /* and faces */
#define TEXTURE_ROUNDING      256u
#define NODES_WITH_FEW_IMAGES 1024u
#define TEXTURE_NAMES         4u /* pictures as they came, for each on the device */

/* faces are halved from the largest down to the smallest */
FF_STATIC_ASSERT(FACE_SIZE_MIN == FF_PANORAMA_FACE_MIN && FACE_SIZE_MIN < FF_FACE_SIZE_MAX);
FF_STATIC_ASSERT((FF_FACE_SIZE_MAX & (FF_FACE_SIZE_MAX - 1)) == 0);
/* and so are entries, each of which may have a mesh: their handles have 16 bits */
FF_STATIC_ASSERT((FF_ENTRIES_MAX & (FF_ENTRIES_MAX - 1)) == 0 && FF_ENTRIES_MIN < FF_ENTRIES_MAX);
FF_STATIC_ASSERT((FF_ENTRIES_MIN & (FF_ENTRIES_MIN - 1)) == 0);
FF_STATIC_ASSERT(FF_ENTRIES_MAX + 2 + FF_PANORAMA_MESHES <= UINT16_MAX);
FF_STATIC_ASSERT(FF_CONTOUR_INDICES <= FF_SKY_VERTICES);
FF_STATIC_ASSERT(FF_SKY_VERTICES <= UINT16_MAX && FF_RECEIVED_MIN < FF_RECEIVED_MAX);
/* all shares of a block together leave an eighth of it, which is the tree's */
#define BLOCK (16u << 20)
FF_STATIC_ASSERT(FF_SHARE_OF_AN_IMAGE(BLOCK) + FF_SHARE_OF_WAITING_IMAGES(BLOCK) +
                     FF_SHARE_OF_ITEMS(BLOCK) + FF_SHARE_OF_TEXTURES(BLOCK) +
                     FF_SHARE_OF_FACES(BLOCK) + FF_SHARE_OF_TEXT(BLOCK) <=
                 BLOCK - BLOCK / 8);

/* ---- what comes ---- */

/* An image, once as RGB888 and once as 16 bit. */
static int texels_fit(const ff_budget *b, size_t texels)
{
    return texels * 5 <= FF_SHARE_OF_AN_IMAGE(b->block);
}

static int image_fits(const ff_budget *b, size_t side) { return texels_fit(b, side * side); }

/* Largest power of two up to the size set whose images fit. */
static unsigned fit_face_size(const ff_budget *b)
{
    unsigned size = FF_FACE_SIZE_MAX;
    if (!b->desc->panorama.enabled || b->desc->pack) return 0;
    while (size > b->desc->panorama.face_size) size /= 2;
    while (size > FACE_SIZE_MIN && !image_fits(b, size)) size /= 2;
    FF_ASSERT(size > 0 && size <= b->desc->panorama.face_size);
    return size;
}

/* Width of the largest picture of a sector, for a view of 60 degrees or more across the width; it
 * is twice as high: seen from high above, far ground reaches far down. */
static unsigned fit_far_side(const ff_budget *b)
{
    unsigned side = 0;
    if (!b->desc->far.enabled || b->desc->pack) return 0;
    side = ff_sets_side((int32_t)b->desc->width * 7 / 8 * 256);
    while (side > FF_SETS_SIDE_MIN && !texels_fit(b, FF_SETS_TEXELS((size_t)side))) side /= 2;
    return texels_fit(b, FF_SETS_TEXELS((size_t)side)) ? side : 0;
}

static int can_have_textures(const ff_budget *b)
{
    int built = ff_picture_built || !(b->info->flags & FF_TERRAIN_PICTURES);
    return built && b->info->texture_log2 && b->info->texture_levels && !b->desc->no_textures &&
           image_fits(b, (size_t)1 << b->info->texture_log2);
}

void ff_budget_economise(ff_budget *b, const ff_terrain_info *info, unsigned economy)
{
    FF_ASSERT(economy < FF_ECONOMY_STEPS);
    b->info = info;
    b->face_size = economy < 1 ? fit_face_size(b) : 0;
    b->far_side = economy < 1 ? fit_far_side(b) : 0;
    b->economy = (uint8_t)economy;
    b->has_textures = (uint8_t)(economy + 1 < FF_ECONOMY_STEPS && can_have_textures(b));
}

/* ---- what is drawn ---- */

static size_t left(const ff_budget *b) { return b->used < b->block ? b->block - b->used : 0; }

uint32_t ff_budget_paint_bytes(const ff_budget *b)
{
    size_t side = (size_t)b->far_side + 2, share = FF_SHARE_OF_FACES(b->block),
           all = FF_SETS_TEXTURES * (FF_SETS_TEXELS(side) * 2 + TEXTURE_ROUNDING);
    if (!b->far_side) return 0;
    return (uint32_t)(all < share ? all : share);
}

/* What a back end without a GL keeps of images: each with a rim of a texel, rounded up; faces and
 * the caller's text by their share. */
static uint32_t texel_bytes(const ff_budget *b)
{
    size_t side = ((size_t)1 << b->info->texture_log2) + 2, face = (size_t)b->face_size + 2,
           share = FF_SHARE_OF_FACES(b->block);
    size_t ground = b->pool[FF_POOL_textures].count * (side * side * 4 + TEXTURE_ROUNDING);
    size_t faces = FF_PANORAMA_MESHES * (face * face * 2 + TEXTURE_ROUNDING);
    faces = !b->face_size ? 0 : faces < share ? faces : share;
    return (uint32_t)(ground + faces + ff_budget_paint_bytes(b) + FF_SHARE_OF_TEXT(b->block));
}

/* Of fins: ridges grow with the picture's width. */
static unsigned fin_meshes(const ff_budget *b)
{
    return FF_SETS_TEXTURES * (1 + b->desc->width * 2 / 3 / (b->heights / 2));
}

static void describe_device(ff_budget *b, uint32_t entries, int buffers)
{
    unsigned faces = b->face_size ? FF_PANORAMA_MESHES : 0, fins = b->far_side ? fin_meshes(b) : 0,
             paint = b->far_side ? FF_SETS_TEXTURES : 0,
             part = b->parts ? ff_strips_part(b->heights) : 0,
             vertices = b->heights > FF_SKY_VERTICES ? b->heights : FF_SKY_VERTICES;
    FF_ASSERT(entries <= FF_ENTRIES_MAX);
    FF_ASSERT(b->pool[FF_POOL_textures].count + 1 + faces + paint <= UINT16_MAX);
    b->entries = entries;
    b->device = (c3d_desc){ .surface_api = b->desc->surface_api,
                            .use_vertex_buffers = (uint8_t)buffers,
                            .mesh_count = (uint16_t)(entries + 1 /* spare */ + 1 /* sky */ + faces +
                                                     fins + b->desc->use_map),
                            .strip_count = (uint16_t)(FF_STRIP_COUNT_MAX + EXTRA_STRIPS + fins +
                                                      (part > 0) + b->desc->use_map),
                            .texture_count = (uint16_t)(b->pool[FF_POOL_textures].count +
                                                        1 /* the caller's text */ + faces + paint),
                            .mesh_vertices_max = (uint16_t)vertices,
                            .strip_indices_max = b->indices + EXTRA_INDICES +
                                                 fins * (b->heights * 3 / 2) + part +
                                                 (b->desc->use_map ? FF_CONTOUR_INDICES : 0),
                            .width = b->desc->width,
                            .height = b->desc->height,
                            .frame_format = b->desc->frame_format,
                            .texture_bytes = texel_bytes(b) };
}

/* Bytes of the device described, or without some of its parts. */
static size_t device_bytes(const ff_budget *b, const c3d_desc *device)
{
    return b->desc->backend ? c3d_bytes(b->desc->backend, device) : 0;
}

/* What the device takes more than `without`, which lacks a part of it. */
static size_t part_bytes(const ff_budget *b, const c3d_desc *without)
{
    size_t whole = device_bytes(b, &b->device), rest = device_bytes(b, without);
    FF_ASSERT(rest <= whole && whole <= b->pool[FF_POOL_device].bytes);
    return whole - rest;
}

static size_t meshes_bytes(const ff_budget *b)
{
    c3d_desc without = b->device;
    without.mesh_count = 0;
    return part_bytes(b, &without);
}

static size_t strips_bytes(const ff_budget *b)
{
    c3d_desc without = b->device;
    without.strip_count = 0;
    without.strip_indices_max = 0;
    return part_bytes(b, &without);
}

static size_t textures_bytes(const ff_budget *b)
{
    c3d_desc without = b->device;
    without.texture_count = 0;
    without.texture_bytes = 0;
    return part_bytes(b, &without);
}

/* As many entries, and meshes with them, as their share holds. */
static void choose_entries(ff_budget *b, int buffers)
{
    uint32_t entries = FF_ENTRIES_MAX;
    if (!b->desc->backend) {
        size_t share = FF_SHARE_OF_ENTRIES(left(b));
        while (entries > FF_ENTRIES_MIN && entries * sizeof(ff_view_node) > share) entries /= 2;
        b->entries = entries;
        memset(&b->device, 0, sizeof b->device);
        return;
    }
    describe_device(b, 0, 0);
    size_t bare = device_bytes(b, &b->device), rest = left(b);
    size_t share = bare < rest ? bare + FF_SHARE_OF_MESHES(rest - bare) : rest;
    describe_device(b, entries, buffers);
    while (entries > FF_ENTRIES_MIN && device_bytes(b, &b->device) > share)
        describe_device(b, entries /= 2, buffers);
}

static size_t tree_bytes(const ff_budget *b, uint32_t nodes)
{
    ff_tree_desc desc = { .info = *b->info,
                          .node_count = nodes,
                          .wish_count = FF_TREE_WISHES,
                          .hidden = b->desc->hidden,
                          .ground_max = b->grounds_max,
                          .source_max = 1 + b->desc->more_count };
    return ff_tree_bytes(&desc);
}

/* The most nodes that fit into what is left, below 2^15. */
static uint32_t nodes_left(const ff_budget *b)
{
    uint32_t nodes = 0;
    for (uint32_t bit = 1u << 14; bit; bit /= 2)
        if (ff_arena_cost(tree_bytes(b, nodes + bit)) <= left(b)) nodes += bit;
    return nodes;
}

/* ---- the rows ---- */

static void add(ff_budget *b, enum ff_pool_id pool, uint32_t count, size_t bytes)
{
    FF_ASSERT((count == 0) == (bytes == 0));
    b->pool[pool].count = count;
    b->pool[pool].bytes = bytes;
    b->used += ff_arena_cost(bytes);
}

static uint32_t between(size_t wanted, uint32_t least, uint32_t most)
{
    FF_ASSERT(least <= most);
    return wanted < least ? least : wanted > most ? most : (uint32_t)wanted;
}

#define X(name, when, wanted, least, most, bytes_of_n, held, high, why)             \
    {                                                                               \
        const uint32_t n = (when) ? between((size_t)(wanted), (least), (most)) : 0; \
        add(b, FF_POOL_##name, n, n ? (size_t)(bytes_of_n) : 0);                    \
    }
#define PART(name, n, bytes_of_n, held, high, why)            \
    {                                                         \
        b->pool[FF_POOL_##name].count = (n);                  \
        b->pool[FF_POOL_##name].bytes = (size_t)(bytes_of_n); \
    }

size_t ff_budget_pictures(const ff_budget *b, uint32_t decoded)
{
    size_t coded = b->pool[FF_POOL_textures].count * FF_CODED_BYTES(b->info->texture_log2);
    return ((size_t)2 << 2 * b->info->texture_log2) +
           ff_held_pictures_bytes(b->info->texture_log2, decoded, coded);
}

unsigned ff_budget_links(const ff_client_desc *desc)
{
    unsigned links = desc->stream != NULL;
    for (unsigned i = 0; i < desc->more_count; i++) links += desc->more[i].stream != NULL;
    return links;
}

/* Another server may tell of several, a pack on this device has what it was joined with. */
uint32_t ff_budget_grounds(const ff_client_desc *desc, uint32_t first)
{
    uint32_t grounds = first;
    for (unsigned i = 0; ff_grounds_built && i < desc->more_count; i++) {
        const ff_pack *pack = desc->more[i].pack;
        if (!pack) grounds += FF_WELCOME_GROUNDS;
        for (; pack; pack = pack->next) grounds++;
    }
    return grounds < FF_GROUNDS_MAX ? grounds : FF_GROUNDS_MAX;
}

void ff_budget_fixed(ff_budget *b, const ff_client_desc *desc, size_t block)
{
    memset(b, 0, sizeof *b);
    b->desc = desc;
    b->block = block;
    b->links = ff_budget_links(desc);
    b->grounds_max = ff_budget_grounds(desc, 1);
    FF_POOLS_FIXED(X, PART)
    b->fixed = b->used;
}

void ff_budget_sky(ff_budget *b)
{
    FF_ASSERT(b->desc->backend && b->fixed >= sizeof(ff_client));
    b->device = (c3d_desc){ .surface_api = b->desc->surface_api,
                            .mesh_count = 1,
                            .strip_count = 1,
                            .texture_count = 1,
                            .mesh_vertices_max = FF_SKY_VERTICES,
                            .strip_indices_max = FF_SKY_INDICES,
                            .use_vertex_buffers = !b->desc->use_plain_arrays,
                            .width = b->desc->width,
                            .height = b->desc->height,
                            .frame_format = b->desc->frame_format,
                            .texture_bytes = FF_SHARE_OF_TEXT(b->block) };
}

static void add_arriving(ff_budget *b)
{
    size_t texture_side = b->has_textures ? (size_t)1 << b->info->texture_log2 : 0,
           side = b->face_size > texture_side ? b->face_size : texture_side,
           far = FF_SETS_TEXELS((size_t)b->far_side);
    b->texels = far > side * side ? far : side * side;
    b->image_bytes = b->texels * sizeof(uint16_t) + (b->far_side ? FF_NEW_FINS_BYTES : 0);
    /* an entered root's picture brings those above it: a byte a texel is more than any takes */
    size_t row = ((size_t)b->info->entered + 1) << 2 * b->info->texture_log2;
    if (b->has_textures && b->info->entered && b->image_bytes < row) b->image_bytes = row;
    b->pictures = b->has_textures && b->desc->backend && b->info->flags & FF_TERRAIN_PICTURES;
    b->texture_names = b->pictures ? TEXTURE_NAMES : 1;
    b->texture_bytes = (size_t)4 << 2 * b->info->texture_log2;
    if (b->pictures)
        b->texture_bytes += TEXTURE_NAMES * sizeof(ff_texture_slot) +
                            FF_CODED_BYTES(b->info->texture_log2) +
                            ((size_t)3 << 2 * b->info->texture_log2) / 8;
    b->heights = ff_node_side(b->info) * ff_node_side(b->info);
    b->indices = ff_strips_indices(b->info->node_log2);
    b->parts = b->far_side || (b->has_textures && b->desc->backend);
    b->values = ff_refined_side(b->info) * ff_refined_side(b->info);
    FF_POOLS_ARRIVING(X, PART)
}

int ff_budget_terrain(ff_budget *b, int buffers)
{
    FF_ASSERT(b->fixed >= sizeof(ff_client)); /* ff_budget_fixed was called */
    b->used = b->fixed;
    add_arriving(b);
    choose_entries(b, buffers);
    FF_POOLS_DRAWN(X, PART)
    /* the tree's place holds the strips first, while the device makes its own of them */
    size_t scratch = b->desc->backend ? ff_arena_cost(sizeof(ff_strips)) : 0,
           before_tree = b->used - ff_arena_cost(b->pool[FF_POOL_nodes].bytes);
    FF_ASSERT(before_tree >= b->fixed);
    /* fewer images are of use where there is ground to lay them on */
    if (b->has_textures && b->economy > 1 && b->pool[FF_POOL_nodes].count < NODES_WITH_FEW_IMAGES)
        return FF_ERR_MEMORY;
    return b->used <= b->block && before_tree + scratch <= b->block ? FF_OK : FF_ERR_MEMORY;
}
