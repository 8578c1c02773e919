/* What a pack says of itself, in words or as JSON. */
#ifndef BAKE_INFO_ABOUT_H
#define BAKE_INFO_ABOUT_H

#include "../../protocol/ff_pack.h"

/* A line for each entry; nothing where the pack says nothing. */
void bake_info_about(const ff_pack *pack);
/* "about": an object of the entries there are. */
void bake_info_about_json(const ff_pack *pack);

/* A text as JSON has it. */
void bake_info_print_text(const uint8_t *text, uint32_t byte_count);

#endif
