/* Which node each part of a view's answer is of. Parts do not say so: there is a row of nodes that
 * were announced. First stands what the request named, in its order, and what of its edge the
 * server has told, or the roots of the tiles that it has told. A part is of the node at the front,
 * and says which of the nodes that it makes are refined in this answer, too: those go to the end.
 * So do nodes of which it is said that they come later. When the row is empty the answer is whole.
 */
#ifndef FF_PARTS_H
#define FF_PARTS_H

#include "ff_message.h"

typedef struct ff_parts {
    ff_key key[FF_PARTS_MAX]; /* a ring of `count` from `first` on */
    uint8_t what[FF_PARTS_MAX];
    uint16_t first, count;
    uint16_t announced; /* so far, those that have come included */
    /* what is told before all parts: ROOTS where nothing was named, EDGE where there is one */
    uint8_t awaits_roots, awaits_edge;
    ff_key edge[FF_VIEW_EDGE_MAX];
    uint8_t edge_count;
} ff_parts;

void ff_parts_begin(ff_parts *parts, const ff_get_view *view);
/* The tiles have come. FF_OK, or FF_ERR_FORMAT: they were not asked for. */
int ff_parts_roots(ff_parts *parts, const ff_roots *roots);
/* The same of the edge. */
int ff_parts_edge(ff_parts *parts, uint32_t needed);
/* 1 when there is a node at the front, *named: the request named it; 0: the answer is whole, or
 * does not begin with a part. */
int ff_parts_next(const ff_parts *parts, enum ff_kind *kind, ff_key *key, int *named);
int ff_parts_done(const ff_parts *parts);
/* A part has come; FF_OK, or FF_ERR_FORMAT: none was awaited, it announces nodes that there cannot
 * be, or more than an answer has. */
int ff_parts_take(ff_parts *parts, const ff_part *part);

#endif
