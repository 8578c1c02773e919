/* What a pack holds, in words or as JSON. */
#ifndef BAKE_INFO_H
#define BAKE_INFO_H

#include "../../protocol/ff_pack.h"

void bake_info_print(const ff_pack *pack, const char *path);
void bake_info_print_json(const ff_pack *pack);

#endif
