/* Kinds of things a client asks for, a row each: what asks for it, what answers, where a pack keeps
 * it. Requests, sources, sessions and statistics read this table; none of them compares kinds by
 * their order. */
#ifndef FF_KIND_H
#define FF_KIND_H

#include "../ff_pack.h"
#include "ff_message.h"

/* clang-format off */
#define FF_KIND_LIST(X) \
    /* name, asked for by, what of it, answered by, section of a pack, data, holds an image */ \
    X(ROOT,       FF_MSG_GET_NODE,     FF_GET_ROOT,       FF_MSG_NODE,    FF_SECTION_ROOT,       HEIGHTS, 0) \
    X(REFINEMENT, FF_MSG_GET_NODE,     FF_GET_REFINEMENT, FF_MSG_NODE,    FF_SECTION_REFINEMENT, HEIGHTS, 0) \
    X(TEXTURE,    FF_MSG_GET_TEXTURE,  0,                 FF_MSG_TEXTURE, FF_SECTION_TEXTURE,    IMAGES,  1) \
    X(PANORAMA,   FF_MSG_GET_PANORAMA, 0,                 FF_MSG_FACE,    FF_SECTION_NONE,       FACES,   1)
/* clang-format on */

enum ff_kind {
#define X(name, ...) FF_WANT_##name,
    FF_KIND_LIST(X)
#undef X
        FF_WANT_KINDS
};

/* What an answer carries: for whoever takes it in, and for statistics. */
enum ff_data_class { FF_DATA_HEIGHTS, FF_DATA_IMAGES, FF_DATA_FACES, FF_DATA_CLASSES };

typedef struct ff_kind_row {
    uint8_t asked_by, what; /* enum ff_message_type; enum ff_get_what, 0 where there is but one */
    uint8_t answered_by;    /* enum ff_message_type */
    uint8_t section;        /* enum ff_section_kind; FF_SECTION_NONE: no pack holds it */
    uint8_t data;           /* enum ff_data_class */
    uint8_t has_image;
} ff_kind_row;

extern const ff_kind_row ff_kind[FF_WANT_KINDS];

/* The kind that a request of this message type and `what` asks for, or FF_ERR_NOT_FOUND. */
int ff_kind_asked_by(unsigned type, unsigned what);

#endif
