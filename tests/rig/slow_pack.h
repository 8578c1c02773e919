/* A second reader of packs and lists, written from protocol/SPEC.md and sharing no code with
 * protocol/: while both find the same bytes, the reader does what the specification says. */
#ifndef SLOW_PACK_H
#define SLOW_PACK_H

#include <stddef.h>
#include <stdint.h>

/* The payload of a node in the section of those four letters: its bytes, or -1 when the
 * specification says that there is none, or that the pack is not to be read. Of layer n of images:
 * `level` is 256 n more. */
long slow_pack_record(const uint8_t *pack, size_t bytes, const char *letters, unsigned level,
                      uint64_t tile, uint32_t code, const uint8_t **payload);
/* Name and levels of a layer in rows of such: 0, or -1. */
int slow_layer(const uint8_t *rows, size_t bytes, unsigned number, unsigned grounds, char name[32],
               uint8_t *levels);
/* The value of a type in a list, -1: there is none; -2: the list breaks a rule. */
long slow_list_find(const uint8_t *list, size_t bytes, unsigned type, const uint8_t **value);
/* What stands in WELCOME of a terrain, as the 68 bytes of its description: 0; -1: it breaks a rule.
 */
int slow_terrain(const uint8_t *value, size_t bytes, uint8_t plain[68]);

#endif
