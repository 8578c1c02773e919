/* What a view needs: the client's own selection, run by the server over the pack, so that one
 * answer brings what a client could otherwise only ask for level by level, a round trip each. */
#ifndef FF_VIEW_PARTS_H
#define FF_VIEW_PARTS_H

#include "../../protocol/ff_pack.h"
#include "../../protocol/message/ff_message.h"

#define FF_VIEW_PARTS_MAX 512

typedef struct ff_view_part {
    ff_key key;
    uint8_t kind; /* FF_KIND_ROOT or FF_KIND_REFINEMENT */
} ff_view_part;

/* What `view` names, as it names it, in the pack or not: FF_VIEW_KEYS_MAX at most. Their number. */
int ff_view_named(const ff_get_view *view, ff_view_part *part);
/* The same, and behind it what lies below and the view needs, which is in the pack: parents before
 * children, else the most urgent first. Stops behind the one that passes view->bytes_max. Their
 * number, at most FF_VIEW_PARTS_MAX, or FF_ERR_MEMORY. Takes some milliseconds, 0.1 s at worst. */
int ff_view_parts(const ff_pack *pack, const ff_get_view *view,
                  ff_view_part part[FF_VIEW_PARTS_MAX]);

#endif
