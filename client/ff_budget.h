/* The budget: who gets how much of the client's block. Every pool is one row of the lists below, in
 * the order in which the block is shared out. client_carve.c takes the pools as the rows say;
 * client_figures.c reads from the same rows how much of them is used, for the HUD,
 * farfield-handheld and `make size`. A new pool is a row here, and the code that uses it.
 *
 * X(pool, when, wanted, least, most, bytes, held, high, why)
 *   when         0: this client needs none of it (no link, no images, no pictures)
 *   wanted       how many: a sum of those who hold one each, or a share of the block
 *   least, most  `wanted` is brought between them
 *   bytes        of `n` of them together
 *   held, high   in use now, and the most ever at once: the pool's own counters
 *   why          what is in it, and why so many
 * PART(pool, n, bytes, held, high, why) lies inside the device: told, not taken.
 *
 * `b` is the ff_budget as far as the rows above have made it, `from` an ff_readings. Where the
 * least do not fit, panoramas are left out, then images; a terrain that does not fit even so is
 * refused.
 */
#ifndef FF_BUDGET_H
#define FF_BUDGET_H

#include "farfield.h"

/* A message of the server: any node fits into the least, and common images; any message at all into
 * the most. A longer one than fits passes by unread. */
#define FF_RECEIVED_MIN (20u << 10)
#define FF_RECEIVED_MAX (FF_MESSAGE_BODY_MAX + FF_MESSAGE_HEADER_MAX)
/* The largest image that comes, once in RGB888 and once in 16 bits, may take so much of the block:
 * faces are made smaller until it does; larger images of the ground are not asked for. */
#define FF_SHARE_OF_AN_IMAGE(block) ((block) / 5)
/* Two images may wait where both, in 16 bits, take so much at most. */
#define FF_SHARE_OF_WAITING_IMAGES(block) ((block) / 16)
#define FF_SHARE_OF_ITEMS(block)          ((block) / 10)
/* Images of the ground, 4 bytes a texel on the device, a fifth more where they are pictures: the
 * largest share, they are most of what is seen. */
#define FF_SHARE_OF_TEXTURES(block) ((block) / 16 * 5)
/* Of a device without a GL: texels of faces, and of the caller's text. */
#define FF_SHARE_OF_FACES(block) ((block) / 8)
#define FF_SHARE_OF_TEXT(block)  ((block) / 16 + (16u << 10))
/* Meshes, of what is left besides what the device needs without any: the rest is for the tree,
 * which holds several nodes for each one drawn. Without pictures an entry is all there is of a
 * mesh. */
#define FF_SHARE_OF_MESHES(left)  ((left) / 3)
#define FF_SHARE_OF_ENTRIES(left) ((left) / 3 / 8)
#define FF_ENTRIES_MIN            4u
#define FF_ENTRIES_MAX            4096u

/* clang-format off */
/* What outlives a terrain. */
#define FF_POOLS_FIXED(X, PART) \
    X(client, 1, 1, 1, 1, \
      sizeof(ff_client), 1, 1, \
      "all that is no pool: settings, state, what waits to be sent") \
    X(sources, b->desc->more_count != 0, \
      b->desc->more_count, 1, FF_SOURCES_MAX - 1, \
      n * sizeof(ff_source), b->desc->more_count, b->desc->more_count, \
      "packs and servers besides the first: what is asked of each") \
    X(received, b->links != 0, \
      b->desc->memory_bytes / 32, FF_RECEIVED_MIN * b->links, FF_RECEIVED_MAX * b->links, \
      n, from->link.received, from->link.received_high, \
      "bytes of messages that have not come whole yet, as many for each link") \
    X(requests, 1, \
      (b->desc->in_flight_max + FF_REQUESTS_QUEUED_MAX) * (1 + b->desc->more_count), 1, UINT32_MAX, \
      ff_requests_bytes(b->desc->in_flight_max) * (1 + b->desc->more_count), from->requests_held, from->requests.held_high, \
      "those sent and unanswered, and behind them all that a ranking can want") \
    X(about, b->links != 0 && b->desc->about != 0, \
      ff_about_bytes_max(b->desc->about) * b->links, 1, FF_ABOUT_BYTES_MAX * FF_SOURCES_MAX, \
      n, from->link.about_bytes, from->link.about_bytes, \
      "bytes of what the pack says of itself, of the entries that the program shows")

/* What comes, on its way to the tree and the device. */
#define FF_POOLS_ARRIVING(X, PART) \
    X(decoder, 1, 1, 1, 1, \
      b->grounds_max > 1 ? ff_decoder_bytes_any(b->info) : ff_decoder_bytes(b->info), 1, 1, \
      "the network worker's state of the height codec: where several grounds may come, of any") \
    X(decoded_image, b->texels != 0, 1, 1, 1, \
      b->texels * 3, 1, 1, \
      "the one image that the network worker decodes, RGB888") \
    X(face_columns, b->face_size != 0, 2, 2, 2, \
      n * b->face_size * sizeof(uint16_t), 2, 2, \
      "tops and bottoms of the columns of the one face that the network worker decodes") \
    X(items, 1, \
      FF_SHARE_OF_ITEMS(b->block) / ff_new_data_item_bytes(1, b->values), 4, 24, \
      ff_new_data_item_bytes(n, b->values), from->news.items, from->news.items_high, \
      "answers with their residuals, decoded and not taken in; a full list stops the worker") \
    X(images, b->texels != 0, \
      b->texels * 4 <= FF_SHARE_OF_WAITING_IMAGES(b->block) ? 2 : 1, 1, 2, \
      n * b->image_bytes, from->news.images, from->news.images_high, \
      "images decoded and not taken in, 16 bits a texel, fins with them: one waits while the next is decoded") \
    X(textures, b->has_textures, \
      FF_SHARE_OF_TEXTURES(b->block) / b->texture_bytes >> (b->economy > 1 ? b->economy - 1 : 0), 8, 512, \
      n * b->texture_names * sizeof(ff_texture_slot), from->client->textures.made, from->client->textures.made_high, \
      "images of the ground that are drawn, and of pictures four times as many, by name: their texels are the device's") \
    X(wear, b->has_textures, \
      FF_WEAR_MAX, FF_WEAR_MAX, FF_WEAR_MAX, \
      n * sizeof(ff_wear), FF_WEAR_MAX, FF_WEAR_MAX, \
      "images that the one node wears that is looked at") \
    X(pictures, b->pictures, \
      b->pool[FF_POOL_textures].count / 8, FF_DECODED_MIN, FF_DECODED_MAX, \
      ff_budget_pictures(b, n), from->client->textures.pictures.decoded_count, from->client->textures.pictures.decoded_count, \
      "pictures as they came, 1/4 of a byte a texel; those decoded lately, which those below are differences to; texels of one")

/* What is drawn; the tree takes what is left. */
#define FF_POOLS_DRAWN(X, PART) \
    X(device, b->desc->backend != NULL, 1, 1, 1, \
      c3d_bytes(b->desc->backend, &b->device), from->client->device != NULL, 1, \
      "the back end: the picture and its depths where no GL has them, and what follows") \
    PART(meshes, b->device.mesh_count, \
      meshes_bytes(b), from->c3d.mesh_held, from->c3d.mesh_high, \
      "one for each entry, one that lives for a frame, the sky, two panoramas of six faces, fins") \
    PART(strips, b->device.strip_count, \
      strips_bytes(b), from->c3d.strip_held, from->c3d.strip_high, \
      "the masks of a node, four for sky, faces and the caller, one for each mesh of fins") \
    PART(device_textures, b->device.texture_count, \
      textures_bytes(b), from->c3d.texture_held, from->c3d.texture_high, \
      "images of the ground, two panoramas of six faces, sectors of paint, the caller's text") \
    X(entries, 1, \
      b->entries, FF_ENTRIES_MIN, FF_ENTRIES_MAX, \
      n * sizeof(ff_view_node), from->client->view.held, from->client->view.held_high, \
      "nodes drawn lately, with their meshes: halved from the most until they fit their share") \
    X(vertices, b->desc->backend != NULL || b->far_side != 0, \
      b->heights, 1, UINT16_MAX, \
      n * sizeof(c3d_vertex), b->heights, b->heights, \
      "of the one mesh that is being made") \
    X(far_sets, b->far_side != 0, 1, 1, 1, \
      sizeof(ff_sets), 1, 1, \
      "the set that is drawn and the one that is coming, by name: meshes and texels are the device's") \
    X(fin_indices, b->parts, \
      ff_strips_part(b->heights), 1, UINT16_MAX, \
      n * sizeof(uint16_t), ff_strips_part(b->heights), ff_strips_part(b->heights), \
      "of the one strip that is being made, of fins or of a part of a node") \
    X(strip_indices, b->parts || b->desc->use_map, \
      b->indices, 1, UINT16_MAX, \
      n * sizeof(uint16_t), b->indices, b->indices, \
      "the masks of a node, for parts of them and for contours") \
    X(contours, b->desc->use_map, \
      FF_CONTOUR_INDICES, FF_CONTOUR_INDICES, FF_CONTOUR_INDICES, \
      n * sizeof(c3d_vertex), FF_CONTOUR_INDICES, FF_CONTOUR_INDICES, \
      "ends of lines of equal height that are being drawn") \
    X(kept, b->far_side != 0, \
      b->entries + 1, 1, FF_ENTRIES_MAX + 1, \
      n * sizeof(ff_view_kept), from->client->view.held, from->client->view.held_high, \
      "of each entry what ridges hide of it from the points that sets were taken from") \
    X(nodes, 1, \
      nodes_left(b), 8, 16384, \
      tree_bytes(b, n), from->tree.nodes_held, from->tree.nodes_high, \
      "the tree's, with their heights and its lists: all that is left; at least two families")
/* clang-format on */

#define FF_POOL_LIST(X, PART) \
    FF_POOLS_FIXED(X, PART)   \
    FF_POOLS_ARRIVING(X, PART) FF_POOLS_DRAWN(X, PART)

enum ff_pool_id {
#define X(pool, when, wanted, least, most, bytes, held, high, why) FF_POOL_##pool,
#define PART(pool, n, bytes, held, high, why)                      FF_POOL_##pool,
    FF_POOL_LIST(X, PART)
#undef X
#undef PART
        FF_POOL_COUNT
};

typedef struct ff_budget {
    const ff_client_desc *desc;  /* defaults filled in */
    const ff_terrain_info *info; /* NULL: only what outlives a terrain */
    size_t block, used, fixed;   /* fixed: used by what outlives a terrain */
    /* what depends on the economy: 1 leaves out panoramas and far sets, 2 has half as many images
     * of the ground, 3 a quarter, 4 none */
    uint8_t economy;
    unsigned face_size; /* 0: no panoramas */
    unsigned far_side;  /* 0: no far sets */
    uint8_t has_textures;
    uint8_t parts; /* 1: nodes are drawn in parts, under far sets and images of finer levels */
    /* what rows have in common */
    unsigned links;       /* sources that are servers */
    uint32_t grounds_max; /* that may come: ff_budget_fixed reckons with one of the first source */
    size_t texels;        /* of the largest image that comes; 0: none does */
    size_t image_bytes;   /* of its texels, in 16 bits, and of a sector's fins */
    size_t texture_bytes; /* of an image of the ground, with those on the device */
    uint32_t texture_names; /* that are held for each of them */
    uint8_t pictures;       /* 1: images are pictures, and there is a device */
    uint32_t heights;       /* of a node */
    uint32_t indices;       /* of all strips of a node */
    uint32_t values;        /* residuals of a refinement */
    uint32_t entries;
    c3d_desc device;
    struct {
        uint32_t count;
        size_t bytes;
    } pool[FF_POOL_COUNT];
} ff_budget;

#define FF_ECONOMY_STEPS 5

/* Sources that are servers. */
unsigned ff_budget_links(const ff_client_desc *desc);
/* Grounds that may come of all sources, when the first has so many. */
uint32_t ff_budget_grounds(const ff_client_desc *desc, uint32_t first);
/* The pools that outlive a terrain, in a block of so many bytes. */
void ff_budget_fixed(ff_budget *budget, const ff_client_desc *desc, size_t block);
/* What of panoramas and images a block can have at a step of economy. */
void ff_budget_economise(ff_budget *budget, const ff_terrain_info *info, unsigned economy);
/* The device alone that draws the sky, and the caller's text, until a terrain is known: described
 * in budget->device, after ff_budget_fixed. */
void ff_budget_sky(ff_budget *budget);
/* All pools, after the fixed ones and the economy; `buffers`: a GL holds the meshes. FF_OK or
 * FF_ERR_MEMORY. */
int ff_budget_terrain(ff_budget *budget, int buffers);
/* Bytes of pictures that are held, with so many places for decoded ones. */
size_t ff_budget_pictures(const ff_budget *budget, uint32_t decoded);
/* Of the device's texels what the paint of far sets may have; 0: no far sets. */
uint32_t ff_budget_paint_bytes(const ff_budget *budget);

#endif
