#include "export_pack.h"

#include "../../protocol/ff_image.h"
#include "../../protocol/shape/ff_shape.h"
#include "../bake/bake_leftovers.h"
#include "../bake/bake_say.h"
#include "../bake/pack_append.h"
#include "../bake/raster/bake_reference.h"
#include "export_part.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

/* What a section will hold. */
typedef struct section_count {
    uint64_t places, records, data_bytes;
    uint32_t length_max;
} section_count;

typedef struct cutter {
    const bake_unpack *unpack;
    const ff_terrain_info *info;
    export_part part;
    ff_list about;
    uint8_t about_bytes[FF_ABOUT_BYTES_MAX];
    unsigned layer;     /* of images, under way */
    int is_part;        /* something was left out */
    pack_append append; /* without a writer: sections are counted alone */
    section_count count[FF_PACK_SECTIONS_MAX];
    uint8_t payload[(1u << FF_INDEX_LENGTH_BITS) + 16u]; /* with its marks */
} cutter;

int export_pack_is(const char *path)
{
    const char *dot = strrchr(path, '.');
    return dot && !strcmp(dot, ".ffp");
}

int export_pack_check(const export_options *o)
{
    if (o->images || o->mesh || o->voids == EXPORT_VOIDS_NODATA)
        return bake_fail("a part of a pack has its images and marks: --images, --mesh and --voids "
                         "are for other outputs");
    if (o->estimate) return 0;
    if (bake_same_file(o->pack_path, o->out_path))
        return bake_fail("%s is the input: not overwritten", o->out_path);
    return pack_writer_prepare(o->out_path);
}

/* ---- records ---- */

/* Gives the next place of a section its record; `bytes` 0: it has none. */
static int put(cutter *c, uint32_t section, const uint8_t *payload, size_t bytes)
{
    section_count *count = &c->count[section];
    count->places++;
    count->records += bytes > 0;
    count->data_bytes += bytes ? FF_RECORD_CRC_BYTES + bytes : 0;
    if (bytes > count->length_max) count->length_max = (uint32_t)bytes;
    return c->append.writer ? pack_append_add(&c->append, section, payload, bytes) : 0;
}

static int fail_at(const cutter *c, enum ff_section_kind kind, ff_key key, int rc)
{
    return bake_fail("%s: the %s of tile %u, level %u, code %u: %s", c->unpack->path,
                     ff_kind_of_section(kind)->name, ff_key_tile(key), ff_key_level(key),
                     ff_key_code(key), ff_error_text(rc));
}

/* ---- heights ---- */

/* Which of the children become stubs: those that would have records of their own. */
static uint8_t stubs_below(const cutter *c, ff_key key, const ff_residuals *marks)
{
    uint8_t stub = 0;
    if (ff_key_level(key) + 2 >= ff_terrain_levels(c->info)) return 0;
    for (uint32_t q = 0; q < 4; q++) {
        ff_key child = ff_key_child(key, q);
        if ((marks->leaf | marks->stub) >> q & 1u || !ff_shape_has_ground(c->info, child)) continue;
        if (!export_part_splits(&c->part, child)) stub |= (uint8_t)(1u << q);
    }
    return stub;
}

/* Puts a root, or a node's refinement; *marks are those that the source has. */
static int put_heights(cutter *c, enum ff_section_kind kind, ff_key key, ff_residuals *marks)
{
    int root = kind == FF_SECTION_ROOT;
    const uint8_t *payload;
    int rc = ff_pack_record(&c->unpack->pack, kind, key, &payload), bytes = rc;
    if (rc >= 0) rc = ff_read_marks(c->info, root, payload, (size_t)bytes, marks);
    if (rc < 0) return fail_at(c, kind, key, rc);
    uint8_t stub = root ? !(marks->leaf | marks->stub) && ff_terrain_levels(c->info) > 1 &&
                              !export_part_splits(&c->part, key)
                        : stubs_below(c, key, marks);
    c->is_part |= stub;
    rc = ff_mark_stubs(c->info, root, payload, (size_t)bytes, marks->stub | stub, c->payload);
    if (rc < 0) return fail_at(c, kind, key, rc);
    return put(c, root ? 0 : ff_key_level(key) + 1, c->payload, (size_t)rc);
}

/* All from a node on whose parent's children are stored; `ends`: the source has none of its own. */
static int cut_heights(cutter *c, ff_key key, unsigned ends)
{
    ff_residuals marks = { 0 };
    if (ff_key_level(key) + 1 == ff_terrain_levels(c->info)) return 0;
    if (ends || !ff_shape_has_ground(c->info, key) || !export_part_splits(&c->part, key))
        return put(c, ff_key_level(key) + 1, NULL, 0);
    if (put_heights(c, FF_SECTION_REFINEMENT, key, &marks)) return -1;
    for (uint32_t q = 0; q < 4; q++)
        if (cut_heights(c, ff_key_child(key, q), (marks.leaf | marks.stub) >> q & 1u)) return -1;
    return 0;
}

/* ---- images ---- */

static uint32_t image_levels(const cutter *c)
{
    return ff_pack_image_levels(&c->unpack->pack, c->layer);
}

static uint32_t image_section(const cutter *c, ff_key key)
{
    return ff_pack_layer_first(&c->unpack->pack, c->layer) + ff_key_level(key);
}

/* Of the children that have an image, those that lose it. */
static uint8_t bare_below(const cutter *c, ff_key key, ff_image_marks marks)
{
    uint8_t bare = 0;
    if (ff_key_level(key) + 1 == image_levels(c)) return 0;
    for (uint32_t q = 0; q < 4; q++) {
        ff_key child = ff_key_child(key, q);
        if (ff_shape_has_ground(c->info, child) && !export_part_pictures(&c->part, child) &&
            !ff_image_ends(marks, q))
            bare |= (uint8_t)(1u << q);
    }
    return bare;
}

static int put_image(cutter *c, ff_key key, ff_image_marks *marks)
{
    const uint8_t *payload;
    ff_image image;
    int rc = ff_pack_layer_record(&c->unpack->pack, c->layer, key, &payload);
    if (rc >= 0) rc = ff_image_read(payload, (size_t)rc, &image);
    if (rc < 0) return fail_at(c, FF_SECTION_TEXTURE, key, rc);
    uint8_t bare = bare_below(c, key, image.marks);
    *marks = image.marks;
    marks->bare |= bare & 15u;
    c->is_part |= bare;
    size_t before = ff_image_put_marks(*marks, c->payload);
    memcpy(c->payload + before, image.coded, image.coded_bytes);
    return put(c, image_section(c, key), c->payload, before + image.coded_bytes);
}

/* All from a node on that has ground, or whose parent has an image; `ends`: it has none. */
static int cut_images(cutter *c, ff_key key, unsigned ends)
{
    ff_image_marks marks = { 0 };
    if (ff_key_level(key) == image_levels(c)) return 0;
    if (ends || !ff_shape_has_ground(c->info, key)) return put(c, image_section(c, key), NULL, 0);
    if (put_image(c, key, &marks)) return -1;
    for (uint32_t q = 0; q < 4; q++)
        if (cut_images(c, ff_key_child(key, q), (unsigned)ff_image_ends(marks, q))) return -1;
    return 0;
}

/* ---- all ---- */

static int cut_tiles(cutter *c)
{
    for (uint32_t tile = 0; tile < ff_shape_tiles(c->info); tile++) {
        ff_key root = ff_key_make(tile, 0, 0);
        ff_residuals marks = { 0 };
        if (put_heights(c, FF_SECTION_ROOT, root, &marks) ||
            cut_heights(c, root, marks.leaf | marks.stub))
            return -1;
        for (c->layer = 0; c->layer < c->unpack->pack.header.layers; c->layer++)
            if (cut_images(c, root, 0)) return -1;
    }
    return c->append.writer ? pack_append_end(&c->append) : 0;
}

/* What the pack said of itself, and of which whole it is a part now. */
static int tell_whole(cutter *c)
{
    if (!c->is_part) return 0;
    int bytes = ff_about_put_whole(c->about, ff_about_whole(c->about, c->info->checksum),
                                   c->about_bytes, sizeof c->about_bytes);
    if (bytes < 0)
        return bake_fail("%s: what it says of itself leaves no room to say what it is a part of",
                         c->unpack->path);
    c->about = (ff_list){ c->about_bytes, (uint32_t)bytes };
    return 0;
}

/* The file that the sections make. */
static uint64_t file_bytes(const cutter *c)
{
    uint64_t bytes = FF_PACK_HEADER_BYTES + c->about.byte_count;
    uint32_t sections = c->unpack->pack.header.section_count;
    for (uint32_t s = 0; s < sections; s++) {
        const section_count *count = &c->count[s];
        ff_index index = { .places = s ? count->places : 0, .records = (uint32_t)count->records };
        while (count->length_max >> index.length_bits) index.length_bits++;
        bytes += ff_index_bytes(&index) + count->data_bytes;
    }
    return bytes;
}

static int write_part(cutter *c, const char *path)
{
    pack_writer writer;
    uint64_t bytes;
    if (pack_writer_open(&writer, c->info) ||
        pack_writer_add_layers(&writer, &c->unpack->pack.header))
        return -1;
    c->append.writer = &writer;
    int rc = cut_tiles(c);
    if (!rc) rc = tell_whole(c);
    writer.about = c->about;
    if (!rc) rc = pack_writer_finish(&writer, path, &bytes);
    pack_writer_close(&writer);
    pack_append_close(&c->append);
    return rc;
}

static int choose_part(cutter *c, const bake_box *region, uint32_t level)
{
    const ff_pack *pack = &c->unpack->pack;
    export_lattice lattice = export_lattice_samples(c->info, ff_terrain_levels(c->info) - 1);
    export_window window;
    OGRSpatialReferenceH srs = bake_reference_of(pack);
    int rc = export_place_window(c->info, srs, &lattice, region, &window);
    if (srs) OSRDestroySpatialReference(srs);
    if (rc) return rc;
    export_part_make(c->info, &window, level, &c->part);
    rc = ff_pack_about(pack, &c->about);
    if (rc == FF_OK) return 0;
    c->about = (ff_list){ 0 };
    return rc == FF_ERR_NOT_FOUND
               ? 0
               : bake_fail("%s: what it says of itself: %s", c->unpack->path, ff_error_text(rc));
}

int export_pack_write(const export_options *o, const bake_unpack *unpack, uint32_t level)
{
    static cutter c;
    c = (cutter){ .unpack = unpack, .info = &unpack->pack.header.info };
    if (choose_part(&c, &o->region, level)) return -1;
    if (!o->estimate) return write_part(&c, o->out_path);
    if (cut_tiles(&c) || tell_whole(&c)) return -1;
    printf("size            %" PRIu64 " bytes, %.1f %% of %s\n", file_bytes(&c),
           100.0 * (double)file_bytes(&c) / (double)unpack->pack.size, unpack->path);
    return 0;
}
