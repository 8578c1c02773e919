#include "ff_kind.h"

const ff_kind_row ff_kind[FF_WANT_KINDS] = {
#define X(name, ...) [FF_WANT_##name] = ROW(__VA_ARGS__),
#define ROW(asked_by, what, answered_by, section, data, image)      \
    {                                                               \
        asked_by, what, answered_by, section, FF_DATA_##data, image \
    }
    FF_KIND_LIST(X)
#undef X
};

int ff_kind_asked_by(unsigned type, unsigned what)
{
    for (int kind = 0; kind < FF_WANT_KINDS; kind++)
        if (ff_kind[kind].asked_by == type && ff_kind[kind].what == what) return kind;
    return FF_ERR_NOT_FOUND;
}
