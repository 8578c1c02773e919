#include "ff_kind.h"

#include "ff_assert.h"

const ff_kind_row ff_kind[FF_KIND_COUNT] = {
/* clang-format off */
#define X(kind, name, asked_by, what, asks, answered_by, brings, section, levels, data, has_image, server) \
    [FF_KIND_##kind] = { #name, asked_by, what, FF_ASKS_##asks, answered_by, FF_BRINGS_##brings, \
                         section, FF_DATA_##data, has_image },
    FF_KIND_LIST(X)
#undef X
    /* clang-format on */
};

/* The kind of a thing asked for takes the low half of a byte (GET_NODE). */
/* clang-format off */
#define X(kind, name, asked_by, what, ...) && what < 16
FF_STATIC_ASSERT(1 FF_KIND_LIST(X));
#undef X
/* clang-format on */

const ff_kind_row *ff_kind_of_section(uint32_t section)
{
    unsigned kind = 0;
    while (kind < FF_KIND_COUNT && ff_kind[kind].section != section) kind++;
    FF_ASSERT(section && kind < FF_KIND_COUNT);
    return &ff_kind[kind];
}
