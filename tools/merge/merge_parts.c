#include "merge_parts.h"

#include "../../protocol/ff_image.h"
#include "../../protocol/shape/ff_shape.h"
#include "../bake/bake_say.h"
#include "../bake/pack_append.h"

#include <string.h>

#define PAYLOAD_ROOM ((1u << FF_INDEX_LENGTH_BITS) + 16u) /* with its marks */

typedef uint64_t part_set; /* a bit for each part */
FF_STATIC_ASSERT(MERGE_PACKS_MAX <= 8 * sizeof(part_set));

typedef struct joiner {
    const bake_unpack *unpack;
    uint32_t count;
    const ff_terrain_info *info;
    unsigned layer; /* of images, under way */
    pack_append append;
    uint8_t payload[PAYLOAD_ROOM], other[PAYLOAD_ROOM];
} joiner;

static part_set all_of(uint32_t count)
{
    return count < 8 * sizeof(part_set) ? ((part_set)1 << count) - 1 : ~(part_set)0;
}

/* ---- whether they are parts ---- */

/* A terrain's description as it is stored, but for the checksum. */
static void describe(const bake_unpack *unpack, uint8_t bytes[FF_TERRAIN_BYTES])
{
    ff_terrain_info info = unpack->pack.header.info;
    ff_writer out = { bytes, bytes + FF_TERRAIN_BYTES, FF_OK };
    info.checksum = 0;
    ff_write_terrain(&out, &info);
    FF_ASSERT(out.error == FF_OK);
}

static int same_layers(const bake_unpack *a, const bake_unpack *b)
{
    ff_layers of_a, of_b;
    ff_pack_layers(&a->pack, &of_a);
    ff_pack_layers(&b->pack, &of_b);
    return !memcmp(&of_a, &of_b, sizeof of_a);
}

int merge_parts_are(const bake_unpack unpack[], uint32_t count)
{
    uint8_t first[FF_TERRAIN_BYTES], other[FF_TERRAIN_BYTES];
    uint32_t whole = ff_pack_whole(&unpack[0].pack);
    int parts = 0;
    describe(&unpack[0], first);
    for (uint32_t i = 0; i < count; i++) {
        describe(&unpack[i], other);
        if (memcmp(first, other, sizeof first) || !same_layers(&unpack[0], &unpack[i]) ||
            ff_pack_whole(&unpack[i].pack) != whole)
            return 0;
        parts |= unpack[i].pack.header.info.checksum != whole;
    }
    return parts;
}

/* ---- heights ---- */

static int fail_at(const joiner *j, uint32_t part, const char *what, ff_key key, const char *why)
{
    return bake_fail("%s: the %s of tile %u, level %u, code %u: %s", j->unpack[part].path, what,
                     ff_key_tile(key), ff_key_level(key), ff_key_code(key), why);
}

static const char *const unlike = "not the same in all parts: they are not parts of one pack; "
                                  "packs without parts left out are joined by their samples";

/* One part's record without its stubs, in `out`: its bytes. *marks: all of its marks. */
static int take_heights(joiner *j, uint32_t part, enum ff_section_kind kind, ff_key key,
                        ff_residuals *marks, uint8_t *out)
{
    const uint8_t *payload;
    int root = kind == FF_SECTION_ROOT,
        rc = ff_pack_record(&j->unpack[part].pack, kind, key, &payload), bytes = rc;
    if (rc >= 0) rc = ff_read_marks(j->info, root, payload, (size_t)bytes, marks);
    if (rc >= 0) rc = ff_mark_stubs(j->info, root, payload, (size_t)bytes, 0, out);
    return rc >= 0 ? rc : fail_at(j, part, ff_kind_of_section(kind)->name, key, ff_error_text(rc));
}

/* Puts a root, or a node's refinement, that the parts of `have` hold. below[q]: those that have the
 * refinement of child q, none where it is a leaf; of a root below[0] tells of the root. */
static int put_heights(joiner *j, enum ff_section_kind kind, ff_key key, part_set have,
                       part_set below[4])
{
    int root = kind == FF_SECTION_ROOT, bytes = 0;
    uint8_t stub = 15;
    memset(below, 0, 4 * sizeof *below);
    for (uint32_t p = 0; p < j->count; p++) {
        ff_residuals marks = { 0 };
        if (!(have >> p & 1)) continue;
        int some = take_heights(j, p, kind, key, &marks, bytes ? j->other : j->payload);
        if (some < 0) return -1;
        if (bytes && (some != bytes || memcmp(j->other, j->payload, (size_t)bytes)))
            return fail_at(j, p, ff_kind_of_section(kind)->name, key, unlike);
        bytes = some;
        stub &= marks.stub;
        for (uint32_t q = 0; q < 4; q++)
            if (!((marks.leaf | marks.stub) >> q & 1)) below[q] |= (part_set)1 << p;
    }
    bytes = ff_mark_stubs(j->info, root, j->payload, (size_t)bytes, stub, j->other);
    FF_ASSERT(bytes > 0);
    return pack_append_add(&j->append, root ? 0 : ff_key_level(key) + 1, j->other, (size_t)bytes);
}

/* All from a node on whose parent's children are stored. */
static int join_heights(joiner *j, ff_key key, part_set have)
{
    part_set below[4];
    if (ff_key_level(key) + 1 == ff_terrain_levels(j->info)) return 0;
    if (!have || !ff_shape_has_ground(j->info, key))
        return pack_append_add(&j->append, ff_key_level(key) + 1, NULL, 0);
    if (put_heights(j, FF_SECTION_REFINEMENT, key, have, below)) return -1;
    for (uint32_t q = 0; q < 4; q++)
        if (join_heights(j, ff_key_child(key, q), below[q])) return -1;
    return 0;
}

/* ---- images ---- */

static uint32_t image_section(const joiner *j, ff_key key)
{
    return ff_pack_layer_first(&j->unpack->pack, j->layer) + ff_key_level(key);
}

/* Puts a node's image that the parts of `have` hold. */
static int put_image(joiner *j, ff_key key, part_set have, part_set below[4])
{
    ff_image first = { 0 }, image;
    memset(below, 0, 4 * sizeof *below);
    for (uint32_t p = 0; p < j->count; p++) {
        const uint8_t *payload;
        if (!(have >> p & 1)) continue;
        int rc = ff_pack_layer_record(&j->unpack[p].pack, j->layer, key, &payload);
        if (rc >= 0) rc = ff_image_read(payload, (size_t)rc, &image);
        if (rc < 0) return fail_at(j, p, "texture", key, ff_error_text(rc));
        if (!first.coded) first = image;
        if (image.marks.open != first.marks.open || image.coded_bytes != first.coded_bytes ||
            memcmp(image.coded, first.coded, first.coded_bytes))
            return fail_at(j, p, "texture", key, unlike);
        first.marks.bare &= image.marks.bare;
        for (uint32_t q = 0; q < 4; q++)
            if (!ff_image_ends(image.marks, q)) below[q] |= (part_set)1 << p;
    }
    size_t before = ff_image_put_marks(first.marks, j->payload);
    memcpy(j->payload + before, first.coded, first.coded_bytes);
    return pack_append_add(&j->append, image_section(j, key), j->payload,
                           before + first.coded_bytes);
}

/* All from a node on that has ground, or whose parent has an image. */
static int join_images(joiner *j, ff_key key, part_set have)
{
    part_set below[4];
    if (ff_key_level(key) == ff_pack_image_levels(&j->unpack->pack, j->layer)) return 0;
    if (!have || !ff_shape_has_ground(j->info, key))
        return pack_append_add(&j->append, image_section(j, key), NULL, 0);
    if (put_image(j, key, have, below)) return -1;
    for (uint32_t q = 0; q < 4; q++)
        if (join_images(j, ff_key_child(key, q), below[q])) return -1;
    return 0;
}

/* ---- all ---- */

int merge_parts_write(const bake_unpack unpack[], uint32_t count, pack_writer *writer)
{
    static joiner j;
    j = (joiner){ .unpack = unpack,
                  .count = count,
                  .info = &unpack[0].pack.header.info,
                  .append.writer = writer };
    int rc = 0;
    for (uint32_t tile = 0; !rc && tile < ff_shape_tiles(j.info); tile++) {
        ff_key root = ff_key_make(tile, 0, 0);
        part_set below[4];
        rc = put_heights(&j, FF_SECTION_ROOT, root, all_of(count), below);
        if (!rc) rc = join_heights(&j, root, below[0]);
        for (j.layer = 0; !rc && j.layer < unpack->pack.header.layers; j.layer++)
            rc = join_images(&j, root, all_of(count));
        bake_progress("joining", tile + 1, ff_shape_tiles(j.info));
    }
    if (!rc) rc = pack_append_end(&j.append);
    pack_append_close(&j.append);
    return rc;
}
