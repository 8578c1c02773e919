/* A second reader of packs and lists, written from protocol/SPEC.md and sharing no code with
 * protocol/: while both find the same bytes, the reader does what the specification says. */
#ifndef SLOW_PACK_H
#define SLOW_PACK_H

#include <stddef.h>
#include <stdint.h>

/* The payload of a node in the section of those four letters: its bytes, or -1 when the
 * specification says that there is none, or that the pack is not to be read. */
long slow_pack_record(const uint8_t *pack, size_t bytes, const char *letters, unsigned level,
                      uint64_t tile, uint32_t code, const uint8_t **payload);
/* The value of a type in a list, -1: there is none; -2: the list breaks a rule. */
long slow_list_find(const uint8_t *list, size_t bytes, unsigned type, const uint8_t **value);
/* What stands in WELCOME of a terrain, as the 68 bytes of its description: 0; -1: it breaks a rule.
 */
int slow_terrain(const uint8_t *value, size_t bytes, uint8_t plain[68]);

#endif
