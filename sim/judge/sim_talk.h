/* What the talk itself costs: bytes on the wire that bring nothing to draw, and round trips. Fed
 * with every message both ways by the relevance's tap (sim_relevance.h). */
#ifndef SIM_TALK_H
#define SIM_TALK_H

#include "../../protocol/message/ff_message.h"

/* Since the start. */
typedef struct sim_talk {
    double framing; /* bytes down that are no payload: of ground, of images, of far ground */
    /* requests for one node's heights or image, and their bytes */
    double node_requests, node_request_bytes;
    /* what answers them, and its bytes before the payload */
    double node_answers, node_header_bytes;
    /* the longest chain of what was asked for and what was asked for only when that had come */
    unsigned round_trips;
} sim_talk;

/* A message of `bytes` that came down. */
void sim_talk_down(sim_talk *talk, const ff_message *message, size_t bytes);
/* One that went up. */
void sim_talk_up(sim_talk *talk, const ff_message *message, size_t bytes);
/* The chain's length of what is asked for now; and once such an answer has come. */
unsigned sim_talk_asked(const sim_talk *talk);
void sim_talk_answered(sim_talk *talk, unsigned chain);

#endif
