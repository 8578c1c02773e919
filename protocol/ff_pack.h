/* Pack format: one file, one terrain (protocol/SPEC.md, "Pack"). Pure bytes: the caller maps the
 * file, or gives a function that reads parts of it.
 *
 * Sections: heights level 0 (roots), refinements of level 0, of level 1, ..., textures of level 0,
 * 1, ... Within a section records lie in order of tile, then Morton code; the sections' indexes
 * (ff_index.h) give any record's place in a step for each level above it. Every record is preceded
 * by its CRC, checked whenever it is read. What the pack says of itself is a section of its own.
 * Sections that this reader does not know are passed over, or the pack is refused where the section
 * says that it is needed.
 */
#ifndef FF_PACK_H
#define FF_PACK_H

#include "codec/ff_codec.h"
#include "ff_about.h"
#include "ff_index.h"
#include "ff_kind.h"

#define FF_PACK_VERSION      9
#define FF_PACK_HEADER_BYTES 4096 /* with the directory of sections; the sections follow */
#define FF_PACK_SECTIONS_MAX 79   /* that this reader knows, but for what it says of itself */
#define FF_PACK_LISTED_MAX   80   /* with those that it does not */
#define FF_PACK_ABOUT        FF_LETTERS('A', 'B', 'O', 'U')
/* Roots and refinements are a section for each level of the deepest tile, textures one for each
 * level of a key. */
FF_STATIC_ASSERT(FF_TILE_LOG2_MAX + FF_KEY_LEVEL_MAX + 1 <= FF_PACK_SECTIONS_MAX);

typedef struct ff_pack_section {
    uint32_t kind;      /* enum ff_section_kind, or FF_PACK_ABOUT */
    uint8_t version;    /* of the section's layout */
    uint8_t codec;      /* of its records: the terrain's for heights; of images their layer */
    uint8_t level;      /* of the node refined, or textured */
    uint8_t flags;      /* enum ff_pack_section_flags */
    uint32_t index_crc; /* CRC-32 of the index bytes */
    uint32_t data_crc;  /* of the data bytes */
    /* its places follow from the records of the level above, and are not stored; what the pack says
     * of itself has no index */
    ff_index index;
    uint64_t index_offset; /* where the index lies in the file */
    /* where the records lie in the file. A record is the CRC-16 of its payload (2 bytes,
     * little-endian) and the payload; what the pack says of itself is bytes alone */
    uint64_t data_offset, data_bytes;
} ff_pack_section;

enum ff_pack_section_flags { FF_PACK_NEEDED = 1 /* who does not know the section cannot read */ };

typedef struct ff_pack_header {
    ff_terrain_info info;
    /* layers of images, and the levels of each: the first one's are info's; 0: no images */
    uint8_t layers, layer_levels[FF_LAYERS_MAX];
    uint32_t section_count; /* of the kinds in ff_kind.h */
    ff_pack_section section[FF_PACK_SECTIONS_MAX];
    ff_pack_section about; /* of kind 0: the pack says nothing of itself */
} ff_pack_header;

/* Reads `count` bytes from `offset` on, all of them: FF_OK or an error. */
typedef int ff_pack_read_fn(void *context, uint64_t offset, void *out, size_t count);

/* Makes the root of a tile that is no stored one (ff_pack_enter), or, where images are pictures,
 * its image of a layer: bytes of *payload, which stands until the next one is made, or an error. */
typedef int ff_pack_root_fn(void *context, enum ff_section_kind kind, unsigned layer, uint32_t tile,
                            const uint8_t **payload);

/* A view on a pack: plain data that owns nothing. A mapping must outlive its view; any number of
 * threads may read through one view of a mapping at once, and one through a view that reads. */
typedef struct ff_pack {
    const uint8_t *bytes;  /* the mapping, or NULL: */
    ff_pack_read_fn *read; /* parts are read into `room`, each over the one before */
    void *context;
    uint8_t *room;
    size_t room_bytes;
    uint64_t size;
    ff_pack_header header;
    uint32_t tiles;       /* of its terrain */
    char refusal[112];    /* why it was not opened, where the error alone does not say; else "" */
    struct ff_pack *next; /* another ground's, see ff_pack_join; NULL */
    /* entered below its top: the terrain as it is stored, and who makes roots; else NULL */
    const struct ff_pack *stored;
    ff_pack_root_fn *make_root;
    void *root_context;
} ff_pack;

#define FF_PACKS_JOINED_MAX 14 /* with the first; a server tells of FF_WELCOME_GROUNDS at most */

/* Checks magic, version, checksum and ranges, and that all sections lie inside `size`. FF_OK or a
 * negative error: FORMAT (not a pack), VERSION, TRUNCATED, CHECKSUM, RANGE, UNSUPPORTED (a section
 * that is needed and not known). */
int ff_pack_open(ff_pack *pack, const void *bytes, uint64_t size);
/* The same where no file can be mapped: `room` takes the header, then each payload, and lies
 * somewhere until the view is done with. FULL: it has fewer than FF_PACK_HEADER_BYTES. */
int ff_pack_open_reader(ff_pack *pack, ff_pack_read_fn *read, void *context, uint64_t size,
                        void *room, size_t room_bytes);
/* The error of ff_pack_open, or of what came before it, in words for people: which section, and
 * what to do about an old pack. */
const char *ff_pack_error_text(const ff_pack *pack, int error);

/* Has `other` go with `pack`, and what was joined to it before, as one more ground: the tiles of
 * its keys are numbered on, and whatever takes `pack` has both. FF_OK, or an error of
 * ff_terrain_join; FF_ERR_ARGUMENT: it holds ground of one that is there already, whole or a part;
 * FF_ERR_FORMAT: layers of images of the same number have different names; FF_ERR_FULL. Both stay
 * where they are. */
int ff_pack_join(ff_pack *pack, ff_pack *other);
/* The checksum of the whole pack that this one is a part of: its own where it is none. */
uint32_t ff_pack_whole(const ff_pack *pack);
/* The one of those joined that has the key's tile, or NULL. */
static inline const ff_pack *ff_pack_of(const ff_pack *pack, ff_key key)
{
    while (pack && ff_key_tile(key) - pack->header.info.first_tile >= pack->tiles)
        pack = pack->next;
    return pack;
}

/* The level at which a pack may be entered for views that reach so far along each axis
 * (ff_entry_level), no deeper than every node has an image where there are images; 0: the top. A
 * part of another pack may lack ground there. */
uint32_t ff_pack_entry_level(const ff_pack *pack, int32_t reach_wu);
/* Levels 0..that-1 have an image wherever there is ground; 0: the root's may be missing. */
uint32_t ff_pack_images_whole(const ff_pack *pack);
/* A view on `whole`, which stays where it is, with the nodes of a level as tiles: for reading
 * records and what it says of itself, and to be joined with others. */
void ff_pack_enter(const ff_pack *whole, uint32_t level, ff_pack_root_fn *make_root, void *context,
                   ff_pack *entered);

/* Reads record `key` of a kind; *payload points into the mapping, or into the room, where it stands
 * until the next record is read. Payload bytes (1 or more) or NOT_FOUND, CHECKSUM, RANGE; FULL: it
 * does not fit the room; what a reader returned. Root: key level 0. Refinement: key of the node to
 * refine. */
int ff_pack_record(const ff_pack *pack, enum ff_section_kind kind, ff_key key,
                   const uint8_t **payload);

/* The same of an image of a layer; of the first one it is the record TEXTURE. */
int ff_pack_layer_record(const ff_pack *pack, unsigned layer, ff_key key, const uint8_t **payload);
/* The image over a node: its own, or that of the nearest ancestor that has one, whose key *key is
 * then. As ff_pack_record. */
int ff_pack_image(const ff_pack *pack, unsigned layer, ff_key *key, const uint8_t **payload);
/* Levels of images of a layer, below where the pack is entered; 0: the pack has no such layer. */
static inline uint32_t ff_pack_image_levels(const ff_pack *pack, unsigned layer)
{
    uint32_t levels = layer < pack->header.layers ? pack->header.layer_levels[layer] : 0,
             entered = pack->header.info.entered;
    return levels > entered ? levels - entered : 0;
}
/* The number of the first section of a layer of the pack's own images. */
uint32_t ff_pack_layer_first(const ff_pack *pack, unsigned layer);
/* The layers of a pack and those joined to it, which have the same names as far as they have them:
 * `levels` of each ground, of FF_LAYER_GROUNDS at most. */
void ff_pack_layers(const ff_pack *pack, ff_layers *layers);

/* What the pack says of itself, in the mapping or the room, checked. FF_OK, NOT_FOUND: nothing;
 * CHECKSUM, RANGE, TRUNCATED; FULL. */
int ff_pack_about(const ff_pack *pack, ff_list *about);

/* What section `number` of this terrain's packs holds: fills all but places, counts and CRCs. 1, or
 * 0: they have fewer sections. */
int ff_pack_section_at(const ff_terrain_info *info, uint32_t number, ff_pack_section *section);

/* The section of a level of a layer other than the first, likewise: such follow all others. */
ff_pack_section ff_pack_layer_section(unsigned layer, unsigned level);

/* Checks indexes, data and every record of every section; *bad receives the number of damaged
 * records. FF_OK or error. */
int ff_pack_verify(const ff_pack *pack, uint64_t *bad);

/* The same for the section of what a pack says of itself, which has no records. */
ff_pack_section ff_pack_about_section(void);

/* Header to bytes, for writers; `out` has FF_PACK_HEADER_BYTES. The function sets info.checksum,
 * whatever it was, and the places of the sections' indexes: the checksum is a CRC over the header,
 * which by index_crc and data_crc stands for everything in the pack. FF_OK or FF_ERR_RANGE. */
int ff_pack_header_encode(ff_pack_header *header, uint8_t *out);

/* CRC-32 (zlib's polynomial), crc 0 to start. */
uint32_t ff_crc32(uint32_t crc, const void *bytes, size_t count);

#endif
