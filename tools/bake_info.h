/* What a pack holds, in words or as JSON. */
#ifndef BAKE_INFO_H
#define BAKE_INFO_H

#include "../protocol/ff_pack.h"

/* Numbers of one section. */
typedef struct bake_section_sum {
    uint64_t records;        /* that exist */
    uint64_t payload_bytes;  /* CRCs and index not counted */
    uint64_t new_samples;    /* heights first told here; 0 for textures */
} bake_section_sum;

/* New heights per level count every lattice point of the padded terrain once. */
bake_section_sum bake_section_sum_up(const ff_pack *pack, uint32_t section);

void bake_info_print(const ff_pack *pack, const char *path);
void bake_info_print_json(const ff_pack *pack);

#endif
