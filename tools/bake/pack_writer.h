/* Writes a pack: sections grow in unnamed temporary files, the pack itself appears whole or not at
 * all.
 *
 * Memory does not depend on the pack's size. The final file is made under a temporary name beside
 * its own (OUT.tmp-PID), synced and renamed; leftovers of killed runs are removed at the next
 * start.
 */
#ifndef PACK_WRITER_H
#define PACK_WRITER_H

#include "../../protocol/ff_pack.h"
#include "bake_blob.h"

typedef struct pack_section_file {
    int data_fd, length_fd; /* unnamed temporary files; u32 lengths of payloads by place */
    uint64_t data_bytes;    /* so far, record CRCs included */
    uint64_t places;        /* so far: those whose parent is stored */
    uint64_t records;       /* of them */
    uint32_t length_max;
} pack_section_file;

typedef struct pack_writer {
    ff_terrain_info info;
    uint32_t section_count;
    uint32_t layers, layer_first[FF_LAYERS_MAX]; /* sections of layers of images, from 1 on */
    pack_section_file section[FF_PACK_SECTIONS_MAX];
    ff_list about; /* what the pack says of itself, set before it is finished; may be empty */
    /* Of parts joined: unless the pack has the checksum of their whole, it says that it is a part.
     */
    int has_whole;
    uint32_t whole;
} pack_writer;

/* Checks that `path` can be written and removes leftovers of killed runs. 0 or -1 (said). */
int pack_writer_prepare(const char *path);
/* Sections in order: root, refinements of level 0.., textures of level 0... 0 or -1 (said). */
int pack_writer_open(pack_writer *writer, const ff_terrain_info *info);
/* Sections of one more layer of images, of so many levels: *first is the number of the first of
 * them. 0 or -1 (said). */
int pack_writer_add_layer(pack_writer *writer, uint32_t levels, uint32_t *first);
/* The same of all layers of another pack. 0 or -1 (said). */
int pack_writer_add_layers(pack_writer *writer, const ff_pack_header *header);
/* Appends records of a tile, or of a part of it, to a section; `above` holds those of their
 * parents, as many or a quarter as many, NULL: roots. Where there is no parent there is no record.
 * 0 or -1 (said). */
int pack_writer_add(pack_writer *writer, uint32_t section, const bake_blob *blob,
                    const bake_blob *above);
/* Puts the sections together as `path`; *file_bytes receives its size. 0 or -1 (said). */
int pack_writer_finish(pack_writer *writer, const char *path, uint64_t *file_bytes);
void pack_writer_close(pack_writer *writer);

#endif
