#include "ff_error.h"

#include "ff_assert.h"

/* Their numbers run from -1 down to the last without gaps. */
#define X(name, number, text) +1
FF_STATIC_ASSERT((0 FF_ERROR_LIST(X)) == -FF_ERR_LAST);
#undef X

const char *ff_error_text(int error)
{
    switch (error) {
#define X(name, number, text) \
    case name: return text;
        FF_ERROR_LIST(X)
#undef X
        default: return error >= 0 ? "ok" : "unknown error";
    }
}
