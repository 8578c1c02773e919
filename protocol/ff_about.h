/* What a pack says of itself: whose the ground is, and where it lies, for a reader without a table
 * of reference systems (SPEC.md, "About"). A list, stored in the pack's section ABOU and sent in
 * ABOUT to those who ask.
 */
#ifndef FF_ABOUT_H
#define FF_ABOUT_H

#include "ff_layers.h"
#include "ff_list.h"

#define FF_ABOUT_BYTES_MAX      4096 /* of a whole list */
#define FF_ABOUT_PROJECTION_MAX 256

/* clang-format off */
/* X(ENTRY, name, type, form, most): names are those of farfield-info --json, `most` bytes */
#define FF_ABOUT_LIST(X) \
    X(NAME,        name,            1, TEXT,    100) \
    X(ATTRIBUTION, attribution,     2, TEXT,    400) \
    X(LICENCE,     licence,         3, TEXT,    200) \
    X(DATE,        date,            4, TEXT,    40) \
    X(VERTICAL,    vertical_datum,  5, TEXT,    100) \
    X(WKT,         projection_wkt,  6, TEXT,    2500) /* of the origin's reference system, WKT 2 */ \
    X(PROJECTION,  projection,      7, NUMBERS, FF_ABOUT_PROJECTION_MAX) /* ff_about_projection */ \
    X(WHOLE,       part_of,         8, CHECKSUM, 4)   /* u32, of the pack that this one is cut from */ \
    X(LAYERS,      layers,          9, NAMES, FF_LAYERS_NAMES_MAX) /* ff_layers.h: of its images */

enum ff_about_entry {
#define X(entry, name, type, form, most) FF_ABOUT_##entry = type,
    FF_ABOUT_LIST(X)
#undef X
};

/* A set of entries has a bit for each type up to 32. */
#define FF_ABOUT_BIT(type) (UINT32_C(1) << ((type) - 1))
enum ff_about_set {
#define X(entry, name, type, form, most) | FF_ABOUT_BIT(type)
    FF_ABOUT_KNOWN = 0 FF_ABOUT_LIST(X)
#undef X
};
/* clang-format on */
static inline int ff_about_in(uint32_t set, unsigned type)
{
    return type >= 1 && type <= 32 && (set & FF_ABOUT_BIT(type));
}

/* How the reference system is projected. Parameters follow, see ff_about_parameter. */
typedef struct ff_about_projection {
    uint16_t method;            /* EPSG's code of the method, 9807: Transverse Mercator */
    int64_t semi_major_um;      /* of the ellipsoid, micrometres */
    int64_t inverse_flattening; /* times 10^9; 0: a sphere */
    int64_t prime_meridian;     /* east of Greenwich, 10^-9 degrees */
    const uint8_t *parameters;
    uint32_t parameter_count;
} ff_about_projection;

/* Whether bytes from outside are such a list: its form, and that texts are UTF-8 without control
 * characters. FF_OK or an error. */
int ff_about_check(ff_list about);
/* 1 when `byte_count` bytes are UTF-8 without control characters. */
int ff_about_is_text(const uint8_t *bytes, uint32_t byte_count);
/* Most bytes that a list of the entries of a set can have, of those in FF_ABOUT_LIST. */
uint32_t ff_about_bytes_max(uint32_t set);
/* The entries of a set, in `out`: bytes written, or FF_ERR_FULL. */
int ff_about_select(ff_list about, uint32_t set, uint8_t *out, uint32_t capacity);
/* The checksum of the whole pack that the one with this list and this checksum is a part of: its
 * own where it is whole. Of a list that was checked. */
uint32_t ff_about_whole(ff_list about, uint32_t checksum);
/* The list of a part of the pack with this checksum, in `out`: bytes written, or FF_ERR_FULL. */
int ff_about_put_whole(ff_list about, uint32_t checksum, uint8_t *out, uint32_t capacity);
/* Adds words to a text of several packs, "; " between them: those of another text that it does not
 * have yet, as far as each has room. The text's bytes then. */
uint32_t ff_about_add_words(uint8_t *text, uint32_t byte_count, uint32_t room, const uint8_t *from,
                            uint32_t from_bytes);
/* FF_OK, or FF_ERR_NOT_FOUND. Of a list that was checked. */
int ff_about_get_projection(ff_list about, ff_about_projection *projection);
/* The same of the entry's value; parameters stay in it. */
int ff_about_read_projection(const uint8_t *value, int byte_count, ff_about_projection *projection);
/* Parameter `number`: EPSG's code of it, and its value: angles in 10^-9 degrees, lengths in
 * micrometres, factors in 10^-12. */
uint16_t ff_about_parameter(const ff_about_projection *projection, uint32_t number, int64_t *value);

#endif
