/* The answer to a view, message by message: which roots it brings, where the request named nothing,
 * or what of its edge, then part after part. The order is that of protocol/message/ff_parts.h, in
 * which children follow far behind their parents; what is less urgent is put off, some parts at a
 * time, so that the picture is right before all has come. */
#ifndef FF_VIEW_ANSWER_H
#define FF_VIEW_ANSWER_H

#include "ff_view_parts.h"

typedef struct ff_view_answer {
    ff_view_part *part; /* FF_PARTS_MAX; NULL until the first view is asked for */
    uint16_t parts;     /* so many are set */
    /* the row of those that were announced and not sent, a ring: their numbers */
    uint16_t row[FF_PARTS_MAX];
    uint16_t first, count;
    uint16_t turns; /* those whose turn is later wait */
    ff_view_front front;
    int tells_roots, tells_edge; /* 1: that is told first */
    int on;                      /* 1: it is not whole yet */
    uint8_t tiles[FF_PARTS_MAX * 5];
} ff_view_answer;

void ff_view_answer_free(ff_view_answer *answer);
/* Finds the parts; deep 0: those that are named alone. FF_OK, FF_ERR_FULL: another one is on, or
 * FF_ERR_MEMORY. */
int ff_view_answer_begin(ff_view_answer *answer, const ff_pack *pack, const ff_get_view *view,
                         int deep);
/* The next message: 1 and *message, which stays valid until the next call, with `less`, or 0: there
 * is none, and the answer is whole. Sides of refinements that parts before have brought are left
 * out. *error: FF_OK, or why this part is empty. */
int ff_view_answer_next(ff_view_answer *answer, const ff_pack *pack,
                        uint8_t less[FF_PAYLOAD_BYTES_MAX], ff_message *message, int *error);
/* Answers with a refinement without those of the `sides` that it has: into `less`, where that is
 * other than what is stored. FF_OK or an error of ff_without_sides. */
int ff_leave_out(const ff_pack *pack, ff_key key, unsigned sides,
                 uint8_t less[FF_PAYLOAD_BYTES_MAX], ff_data *data);
/* It has gone. */
void ff_view_answer_sent(ff_view_answer *answer, const ff_message *message);

#endif
