#include "ff_packs_entered.h"
#include "../../protocol/ff_entry.h"
#include "../../protocol/ff_image.h"
#include "../../protocol/message/ff_message.h"
#include "../../protocol/shape/ff_shape.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#define IMAGE_BYTES_MAX (FF_MESSAGE_BODY_MAX - 2) /* behind its id */

/* The node that a root is made of: its heights, what is said of it, and what decoding needs. */
typedef struct node {
    ff_decoder *decoder;
    ff_residuals residuals; /* child_error[0] and bit 0 of the marks are the node's */
    int32_t value[FF_REFINED_HEIGHTS_MAX];
    uint16_t heights[FF_NODE_HEIGHTS_MAX], refined[FF_REFINED_HEIGHTS_MAX];
    uint16_t room[FF_CODEC_ROOM_MAX / 2 + 1];
} node;

struct ff_packs_entered {
    ff_pack pack[FF_WELCOME_GROUNDS];
    node node;
    uint16_t decoded[FF_NODE_HEIGHTS_MAX];
    int made; /* bytes of the payload; 0: none has been made */
    uint32_t tile;
    uint8_t payload[FF_PAYLOAD_BYTES_MAX], body[FF_PAYLOAD_BYTES_MAX], image[IMAGE_BYTES_MAX];
    max_align_t decoder_memory[];
};

/* ---- a node's heights ---- */

static int decode_root(node *n, const ff_pack *pack, ff_key key)
{
    const ff_terrain_info *info = &pack->header.info;
    const uint8_t *payload;
    int bytes = ff_pack_record(pack, FF_SECTION_ROOT, key, &payload);
    if (bytes < 0) return bytes;
    n->residuals = (ff_residuals){ .cells = ff_shape_cells(info, key, 0), .value = n->value };
    int rc = ff_decode_root(n->decoder, payload, (size_t)bytes, &n->residuals);
    return rc < 0 ? rc : ff_reconstruct_root(info, &n->residuals, n->heights, n->room);
}

/* The children of the node, all in n->refined. Nothing is known below a stub. */
static int refine(node *n, const ff_pack *pack, ff_key key)
{
    const ff_terrain_info *info = &pack->header.info;
    const ff_cells cells = ff_shape_cells(info, key, 1);
    const uint8_t *payload;
    if (n->residuals.stub & 1u) return FF_ERR_NOT_FOUND;
    if (n->residuals.leaf & 1u) {
        n->residuals = ff_leaf_residuals(info, n->residuals.child_error[0],
                                         n->residuals.filled & 1u);
        ff_predict_children(info, cells, n->heights, n->refined, n->room);
        return FF_OK;
    }
    int bytes = ff_pack_record(pack, FF_SECTION_REFINEMENT, key, &payload);
    if (bytes < 0) return bytes;
    n->residuals = (ff_residuals){ .cells = cells, .value = n->value };
    int rc = ff_decode_refinement(n->decoder, payload, (size_t)bytes, &n->residuals);
    return rc < 0 ? rc
                  : ff_reconstruct_refinement(info, n->heights, &n->residuals, n->refined, n->room);
}

static void take_child(node *n, const ff_terrain_info *info, uint32_t q)
{
    ff_residuals *r = &n->residuals;
    ff_refined_child(info, n->refined, q, n->heights);
    r->child_error[0] = r->child_error[q];
    r->filled = r->filled >> q & 1u;
    r->leaf = r->leaf >> q & 1u;
    r->stub = r->stub >> q & 1u;
}

/* From the root down to the node of that key. */
static int decode_node(node *n, const ff_pack *pack, ff_key key)
{
    uint32_t level = ff_key_level(key), code = ff_key_code(key);
    ff_key at = ff_key_make(ff_key_tile(key), 0, 0);
    int rc = ff_decoder_turn(n->decoder, &pack->header.info);
    if (rc == FF_OK) rc = decode_root(n, pack, at);
    while (rc == FF_OK && level-- > 0) {
        uint32_t q = code >> 2 * level & 3u;
        rc = refine(n, pack, at);
        if (rc == FF_OK) take_child(n, &pack->header.info, q);
        at = ff_key_child(at, q);
    }
    return rc;
}

/* ---- roots ---- */

static int encode(ff_packs_entered *entered, const ff_terrain_info *info, ff_key root)
{
    node *n = &entered->node;
    n->residuals.cells = ff_shape_cells(info, root, 0);
    n->residuals.value = n->value;
    n->residuals.body = entered->body;
    ff_encode_heights(info, NULL, n->heights, NULL, &n->residuals, entered->decoded);
    FF_ASSERT(!memcmp(entered->decoded, n->heights,
                      (size_t)ff_node_side(info) * ff_node_side(info) * sizeof *n->heights));
    return ff_encode_payload(info, NULL, entered->decoded, &n->residuals, entered->payload);
}

/* The last one made is kept: it is asked for more than once while a view is answered. */
static int make_heights(ff_packs_entered *entered, uint32_t tile, const uint8_t **payload)
{
    *payload = entered->payload;
    if (entered->made && entered->tile == tile) return entered->made;
    ff_key root = ff_key_make(tile, 0, 0);
    const ff_pack *pack = ff_pack_of(entered->pack, root);
    const ff_terrain_info *info = &pack->header.info, *whole = &pack->stored->header.info;
    entered->made = 0;
    int rc = decode_node(&entered->node, pack->stored, ff_entry_key(whole, info, root));
    if (rc == FF_OK) rc = encode(entered, info, root);
    if (rc < 0) return rc;
    entered->tile = tile;
    entered->made = rc;
    return rc;
}

/* The pictures from the whole's root down to the node, each as it is stored, before each but the
 * last how many bytes it has (16 bits, the higher ones first: below 128); before all of them what
 * the node's own tells of its children. */
static int make_image(ff_packs_entered *entered, const ff_pack *pack, unsigned layer, ff_key key,
                      const uint8_t **payload)
{
    uint32_t level = ff_key_level(key);
    uint8_t *end = entered->image + IMAGE_BYTES_MAX, *to = end;
    ff_image image = { 0 };
    ff_image_marks marks = { 0 };
    for (uint32_t i = 0; i <= level; i++, key = ff_key_parent(key)) {
        const uint8_t *stored;
        int rc = ff_pack_layer_record(pack->stored, layer, key, &stored);
        if (rc >= 0) rc = ff_image_read(stored, (size_t)rc, &image);
        if (rc < 0) return rc;
        if (image.coded_bytes + 2 + FF_IMAGE_MARKS_BYTES > (size_t)(to - entered->image) ||
            image.coded_bytes > INT16_MAX)
            return FF_ERR_FULL;
        to -= image.coded_bytes;
        memcpy(to, image.coded, image.coded_bytes);
        if (i == 0) marks = image.marks;
        if (i > 0) *--to = (uint8_t)image.coded_bytes;
        if (i > 0) *--to = (uint8_t)(image.coded_bytes >> 8);
        if (ff_key_level(key) == 0) break;
    }
    uint8_t before[FF_IMAGE_MARKS_BYTES];
    size_t bytes = ff_image_put_marks(marks, before);
    to -= bytes;
    memcpy(to, before, bytes);
    *payload = to;
    return (int)(end - to);
}

/* 1 when the layer's image ends before a node: the nearest image above it, its payload at hand, is
 * not its own. */
static int is_open(ff_key key, ff_key held, const uint8_t *payload, size_t bytes)
{
    ff_image image;
    if (ff_image_read(payload, bytes, &image) != FF_OK) return 0;
    while (ff_key_level(key) > ff_key_level(held) + 1) key = ff_key_parent(key);
    return held != key && image.marks.open >> ff_key_quadrant(key) & 1;
}

static int make_image_root(ff_packs_entered *entered, unsigned layer, uint32_t tile,
                           const uint8_t **payload)
{
    static const uint8_t open = FF_IMAGE_OPEN + 15;
    ff_key root = ff_key_make(tile, 0, 0);
    const ff_pack *pack = ff_pack_of(entered->pack, root);
    ff_key key = ff_entry_key(&pack->stored->header.info, &pack->header.info, root), held = key;
    int bytes = ff_pack_image(pack->stored, layer, &held, payload);
    if (bytes < 0 || !is_open(key, held, *payload, (size_t)bytes))
        return make_image(entered, pack, layer, key, payload);
    *payload = &open;
    return 1;
}

static int make_root(void *context, enum ff_section_kind kind, unsigned layer, uint32_t tile,
                     const uint8_t **payload)
{
    return kind == FF_SECTION_ROOT ? make_heights(context, tile, payload)
                                   : make_image_root(context, layer, tile, payload);
}

/* ---- packs ---- */

/* Not where one is a part of another: its client may have the rest from elsewhere, as it is. */
static int is_entered(const ff_pack *pack, int32_t reach_wu)
{
    int entered = 0;
    for (; pack; pack = pack->next) {
        if (ff_pack_whole(pack) != pack->header.info.checksum) return 0;
        entered |= ff_pack_entry_level(pack, reach_wu) > 0;
    }
    return entered;
}

static int enter(ff_packs_entered *entered, const ff_pack *pack, int32_t reach_wu)
{
    ff_pack *at = entered->pack;
    for (; pack; pack = pack->next, at++) {
        ff_pack_enter(pack, ff_pack_entry_level(pack, reach_wu), make_root, entered, at);
        int rc = at == entered->pack ? FF_OK : ff_pack_join(entered->pack, at);
        if (rc != FF_OK) return rc;
    }
    return FF_OK;
}

int ff_packs_enter(const ff_pack *pack, int32_t reach_wu, ff_packs_entered **entered)
{
    size_t decoder_bytes = ff_decoder_bytes_any(&pack->header.info);
    *entered = NULL;
    if (!is_entered(pack, reach_wu)) return FF_OK;
    ff_packs_entered *made = calloc(1, sizeof *made + decoder_bytes);
    if (!made) return FF_ERR_MEMORY;
    made->node.decoder = ff_decoder_create(&pack->header.info, made->decoder_memory, decoder_bytes);
    int rc = made->node.decoder ? enter(made, pack, reach_wu) : FF_ERR_UNSUPPORTED;
    if (rc == FF_OK)
        *entered = made;
    else
        ff_packs_leave(made);
    return rc;
}

const ff_pack *ff_packs_entered_first(const ff_packs_entered *entered) { return entered->pack; }

void ff_packs_leave(ff_packs_entered *entered) { free(entered); }
