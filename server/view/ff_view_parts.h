/* What a view needs: the client's own selection, run by the server over the pack, so that one
 * answer brings what a client could otherwise only ask for level by level, a round trip each. */
#ifndef FF_VIEW_PARTS_H
#define FF_VIEW_PARTS_H

#include "../../protocol/ff_pack.h"
#include "../../protocol/message/ff_message.h"

typedef struct ff_view_part {
    ff_key key;
    uint8_t kind;   /* FF_KIND_ROOT or FF_KIND_REFINEMENT */
    uint8_t below;  /* as in ff_part */
    uint16_t first; /* the number of the first of those below */
    uint16_t turn;  /* how many others are more urgent */
    uint8_t sent;   /* 1: with its payload */
} ff_view_part;

/* What is told before the parts: how many roots stand first that were not named; the bits of the
 * edge's nodes that stand behind what is named. */
typedef struct ff_view_front {
    uint32_t roots, edge;
} ff_view_front;

/* What `view` names, as it names it, in the pack or not: FF_VIEW_KEYS_MAX at most. Their number. */
int ff_view_named(const ff_get_view *view, ff_view_part *part);
/* The same, what is needed of the edge, or where it names nothing the roots that it needs, and
 * behind it what lies below and the view needs, which is in the pack, in the order of ff_parts.h.
 * What would pass view->bytes_max is left out, the least urgent first. Their number, at most
 * FF_PARTS_MAX, or FF_ERR_MEMORY. Takes some milliseconds, 0.1 s at worst. */
int ff_view_parts(const ff_pack *pack, const ff_get_view *view, ff_view_part part[FF_PARTS_MAX],
                  ff_view_front *front);

#endif
