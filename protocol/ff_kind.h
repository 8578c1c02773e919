/* Kinds of things that a client can ask for: the one list. How a kind is asked for, answered,
 * stored, taken in and counted stands in its row; everything else that differs by kind is derived
 * from the list or found by the names in it, and no code compares kinds by their order.
 *
 * A new kind is a row here, and functions of its own, declared by expanding this list in the files
 * named:
 *   ff_intake_NAME         ff_intake_local.h    client, worker: its answer into new data
 *   ff_client_take_NAME    ff_client_local.h    client, main thread: its new data into what is held
 *   ff_session_ask_SERVER  ff_session_local.h   server: what to do when it is asked for
 */
#ifndef FF_KIND_H
#define FF_KIND_H

#include <stdint.h>

/* Four letters as they stand in a file, as a little-endian number. */
#define FF_LETTERS(a, b, c, d) \
    ((uint32_t)(a) | (uint32_t)(b) << 8 | (uint32_t)(c) << 16 | (uint32_t)(d) << 24)

/* clang-format off */
/* X(kind, name, asked_by, what, asks, answered_by, brings, section, levels, data, has_image, server)
 *   asked_by, what   the message that asks for it: its type (SPEC.md, "Messages") and, where kinds
 *                    share a type, which of them. 128: the short forms, of which all three are taken;
 *                    what else belongs to one node has a type of its own, below 64
 *   asks             the body of that message: enum ff_kind_asks
 *   answered_by      the type of the message that answers; the request tells kinds that share one
 *   brings           the body of that message: enum ff_kind_brings
 *   section, levels  where packs keep it: the four letters of its sections, 0 for none, and how many
 *                    of them a terrain `info` has; packs hold sections in the order of this list
 *   data             what statistics and relevance count it as: enum ff_data_class
 *   has_image        1: its answer may hold an image
 *   server           how a session answers it; kinds may share a way */
#define FF_KIND_LIST(X) \
    X(ROOT,       root,     128, 0, NODE,     96, PAYLOAD, FF_LETTERS('R', 'O', 'O', 'T'), 1,                           HEIGHTS, 0, record) \
    X(REFINEMENT, refinement, 128, 1, NODE,   96, PAYLOAD, FF_LETTERS('R', 'E', 'F', 'I'), ff_terrain_levels(info) - 1, HEIGHTS, 0, record) \
    X(TEXTURE,    texture,  128, 2, NODE,     96, PAYLOAD, FF_LETTERS('I', 'M', 'A', 'G'), info->texture_levels,        IMAGES,  1, record) \
    X(VIEW,       view,       9, 0, VIEW,    224, PARTS,   0,                               0,                           HEIGHTS, 0, view)   \
    X(FACE,       face,       4, 0, PANORAMA, 68, FACE,    0,                               0,                           FACES,   1, faces)  \
    X(FAR,        far,       10, 0, FAR,      75, FAR,     0,                               0,                           FAR,     1, far)
/* clang-format on */

enum ff_kind {
#define X(kind, ...) FF_KIND_##kind,
    FF_KIND_LIST(X)
#undef X
        FF_KIND_COUNT
};

/* Letters of sections in packs, for those who read one kind; 0: packs do not hold it. */
enum ff_section_kind {
#define X(kind, name, asked_by, what, asks, answered_by, brings, section, ...) \
    FF_SECTION_##kind = section,
    FF_KIND_LIST(X)
#undef X
};

enum ff_kind_asks {
    FF_ASKS_NODE,     /* ff_get: the thing of one node; the request's key is the node's */
    FF_ASKS_VIEW,     /* ff_get_view: roots and refinements, as many as a view needs; key 0 */
    FF_ASKS_PANORAMA, /* ff_get_panorama; the request's key is a number of the client's own */
    FF_ASKS_FAR       /* ff_get_far; the key likewise */
};
enum ff_kind_brings {
    FF_BRINGS_PAYLOAD, /* ff_data, in one message */
    FF_BRINGS_PARTS,   /* ff_part, in as many messages as the server finds; the last says so */
    FF_BRINGS_FACE,    /* ff_face, in as many messages as faces were asked for; the last says so */
    FF_BRINGS_FAR      /* ff_far, in as many messages as sectors were asked for; the last says so */
};
enum ff_data_class {
    FF_DATA_HEIGHTS,
    FF_DATA_IMAGES,
    FF_DATA_FACES,
    FF_DATA_FAR,      /* fins and paint */
    FF_DATA_OVERHEAD, /* whatever no picture shows, such as greetings */
    FF_DATA_CLASSES
};

typedef struct ff_kind_row {
    const char *name;
    uint8_t asked_by, what, asks;
    uint8_t answered_by, brings;
    uint32_t section;
    uint8_t data;
    uint8_t has_image;
} ff_kind_row;

extern const ff_kind_row ff_kind[FF_KIND_COUNT];

/* The kind that a section of a pack holds; `section` is one of the list's, not 0. */
const ff_kind_row *ff_kind_of_section(uint32_t section);

#endif
