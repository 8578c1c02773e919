#include "sim_talk.h"

static size_t payload_bytes(const ff_message *message)
{
    if (message->type != FF_MSG_ANSWER) return 0;
    switch ((enum ff_kind_brings)ff_kind[message->kind].brings) {
        case FF_BRINGS_PAYLOAD: return message->u.data.byte_count;
        case FF_BRINGS_PARTS: return message->u.part.byte_count;
        case FF_BRINGS_FACE: return message->u.face.columns_bytes + message->u.face.image_bytes;
        case FF_BRINGS_FAR:
            /* where the paint lies lays it out */
            return message->u.far.fins_bytes + (message->u.far.blocks_x ? 4 : 0) +
                   message->u.far.paint_bytes;
    }
    return 0;
}

void sim_talk_down(sim_talk *talk, const ff_message *message, size_t bytes)
{
    size_t framing = bytes - payload_bytes(message);
    talk->framing += (double)framing;
    if (message->type != FF_MSG_ANSWER || ff_kind[message->kind].brings != FF_BRINGS_PAYLOAD)
        return;
    talk->node_answers++;
    talk->node_header_bytes += (double)framing;
}

void sim_talk_up(sim_talk *talk, const ff_message *message, size_t bytes)
{
    if (message->type != FF_MSG_GET || ff_kind[message->kind].asks != FF_ASKS_NODE) return;
    talk->node_requests++;
    talk->node_request_bytes += (double)bytes;
}

unsigned sim_talk_asked(const sim_talk *talk) { return talk->round_trips + 1; }

void sim_talk_answered(sim_talk *talk, unsigned chain)
{
    if (chain > talk->round_trips) talk->round_trips = chain;
}
