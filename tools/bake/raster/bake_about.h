/* What a pack will say of itself (protocol/ff_about.h): as told by options, else as the source has
 * it in its metadata; where neither says anything, neither does the pack. */
#ifndef BAKE_ABOUT_H
#define BAKE_ABOUT_H

#include "../../../protocol/ff_about.h"
#include "bake_gdal.h"

#define BAKE_ABOUT_TEXTS     5    /* the entries from FF_ABOUT_NAME to FF_ABOUT_VERTICAL */
#define BAKE_ABOUT_TEXT_ROOM 2048 /* more of a source's text is not looked at */

typedef struct bake_about {
    char text[BAKE_ABOUT_TEXTS][BAKE_ABOUT_TEXT_ROOM]; /* "": nothing is known */
} bake_about;

/* Texts by their entry, less 1; NULL: not told. */
typedef struct bake_texts {
    const char *text[BAKE_ABOUT_TEXTS];
} bake_texts;
/* Those of options with BAKE_ABOUT_OPTIONS. */
#define BAKE_TEXTS(options)                                                                        \
    ((bake_texts){ { (options)->name, (options)->attribution, (options)->licence, (options)->date, \
                     (options)->vertical_datum } })

/* Most bytes of a text, and the option that tells it, without its dashes. */
uint32_t bake_about_most(enum ff_about_entry entry);
const char *bake_about_option(enum ff_about_entry entry);
/* 0, or -1 (said): an option's text is too long, or none. */
int bake_about_check(const bake_texts *told);
/* Collects texts of options and of a raster's metadata. */
void bake_about_read(const bake_texts *told, GDALDatasetH set, bake_about *about);
/* The list for a pack whose origin lies in `srs` (NULL: nowhere): its bytes. */
uint32_t bake_about_list(const bake_about *about, OGRSpatialReferenceH srs,
                         uint8_t list[FF_ABOUT_BYTES_MAX]);
/* A text of a list for printing, "" when there is none. */
void bake_about_text(ff_list list, enum ff_about_entry entry, char *text, size_t room);

#endif
