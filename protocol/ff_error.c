#include "ff_error.h"

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
