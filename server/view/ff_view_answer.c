#include "ff_view_answer.h"
#include "../../protocol/ff_bytes.h"
#include "../../protocol/shape/ff_shape.h"

#include <assert.h>
#include <stdlib.h>

#define TURNS 8 /* so many parts go in the row's order, whatever their urgency */

void ff_view_answer_free(ff_view_answer *answer) { free(answer->part); }

static void append(ff_view_answer *answer, uint32_t number)
{
    assert(answer->count < FF_PARTS_MAX);
    answer->row[(answer->first + answer->count++) % FF_PARTS_MAX] = (uint16_t)number;
}

static uint16_t take_front(ff_view_answer *answer)
{
    uint16_t number = answer->row[answer->first];
    answer->first = (uint16_t)((answer->first + 1u) % FF_PARTS_MAX);
    answer->count--;
    return number;
}

int ff_view_answer_begin(ff_view_answer *answer, const ff_pack *pack, const ff_get_view *view,
                         int deep)
{
    if (answer->on) return FF_ERR_FULL;
    if (!answer->part) answer->part = malloc(FF_PARTS_MAX * sizeof *answer->part);
    if (!answer->part) return FF_ERR_MEMORY;
    answer->front = (ff_view_front){ 0 };
    int count = deep ? ff_view_parts(pack, view, answer->part, &answer->front)
                     : ff_view_named(view, answer->part);
    if (count < 0) return count;
    answer->first = answer->count = 0;
    answer->parts = (uint16_t)count;
    answer->turns = TURNS;
    answer->tells_roots = view->count == 0;
    answer->tells_edge = view->edge_count > 0;
    answer->on = 1;
    for (uint32_t i = 0; i < view->count + answer->front.roots; i++) append(answer, i);
    for (uint32_t edge = answer->front.edge, i = view->count; edge; edge &= edge - 1)
        append(answer, i++);
    return FF_OK;
}

static void tell_roots(ff_view_answer *answer, ff_message *message)
{
    ff_writer out = { answer->tiles, answer->tiles + sizeof answer->tiles, FF_OK };
    for (uint32_t i = 0; i < answer->front.roots; i++)
        ff_write_varint(&out, ff_key_tile(answer->part[i].key));
    assert(out.error == FF_OK);
    *message = (ff_message){ .type = FF_MSG_ROOTS,
                             .u.roots = { answer->tiles, (uint32_t)(out.at - answer->tiles) } };
}

/* How many at the front wait for their turn; not all of them. */
static unsigned waiting(ff_view_answer *answer)
{
    for (;; answer->turns += TURNS)
        for (unsigned i = 0; i < answer->count; i++) {
            uint16_t number = answer->row[(answer->first + i) % FF_PARTS_MAX];
            if (answer->part[number].turn < answer->turns) return i;
        }
}

int ff_leave_out(const ff_pack *pack, ff_key key, unsigned sides,
                 uint8_t less[FF_PAYLOAD_BYTES_MAX], ff_data *data)
{
    int bytes = ff_without_sides(&ff_pack_of(pack, key)->header.info, data->bytes, data->byte_count,
                                 sides, less);
    if (bytes > 0) *data = (ff_data){ less, (uint32_t)bytes };
    return bytes < 0 ? bytes : FF_OK;
}

/* Sides that refinements have which went before. */
static unsigned sides_sent(const ff_view_answer *answer, const ff_pack *pack, ff_key key)
{
    unsigned sides = 0;
    for (unsigned side = 0; side < FF_SIDE_COUNT; side++) {
        ff_key beside =
            ff_shape_neighbour(&ff_pack_of(pack, key)->header.info, key, (enum ff_side)side).key;
        for (uint32_t i = 0; beside != FF_KEY_NONE && i < answer->parts; i++)
            if (answer->part[i].sent && answer->part[i].key == beside) sides |= 1u << side;
    }
    return sides;
}

/* The payload of a part, as it goes. FF_OK or an error. */
static int fetch(const ff_view_answer *answer, const ff_pack *pack, const ff_view_part *part,
                 uint8_t less[FF_PAYLOAD_BYTES_MAX], ff_data *data)
{
    int bytes = ff_pack_record(pack, (enum ff_section_kind)ff_kind[part->kind].section, part->key,
                               &data->bytes);
    if (bytes < 0) return bytes;
    data->byte_count = (uint32_t)bytes;
    return part->kind == FF_KIND_REFINEMENT
               ? ff_leave_out(pack, part->key, sides_sent(answer, pack, part->key), less, data)
               : FF_OK;
}

int ff_view_answer_next(ff_view_answer *answer, const ff_pack *pack,
                        uint8_t less[FF_PAYLOAD_BYTES_MAX], ff_message *message, int *error)
{
    *error = FF_OK;
    if (answer->tells_roots) {
        tell_roots(answer, message);
        return 1;
    }
    if (answer->tells_edge) {
        *message = (ff_message){ .type = FF_MSG_EDGE, .u.edge = { answer->front.edge } };
        return 1;
    }
    if (!answer->count) return answer->on = 0;
    *message = (ff_message){ .type = FF_MSG_ANSWER, .kind = FF_KIND_VIEW };
    unsigned later = waiting(answer);
    if (later) {
        message->u.part.later = (uint8_t)(later < FF_PARTS_LATER_MAX ? later : FF_PARTS_LATER_MAX);
        return 1;
    }
    const ff_view_part *part = &answer->part[answer->row[answer->first]];
    ff_data data = { NULL, 0 };
    *error = fetch(answer, pack, part, less, &data);
    if (*error == FF_OK)
        message->u.part =
            (ff_part){ .below = part->below, .bytes = data.bytes, .byte_count = data.byte_count };
    return 1;
}

void ff_view_answer_sent(ff_view_answer *answer, const ff_message *message)
{
    if (message->type == FF_MSG_ROOTS) answer->tells_roots = 0;
    if (message->type == FF_MSG_EDGE) answer->tells_edge = 0;
    if (message->type != FF_MSG_ANSWER) return;
    const ff_part *sent = &message->u.part;
    for (unsigned i = 0; i < sent->later; i++) append(answer, take_front(answer));
    if (sent->later) return;
    ff_view_part *part = &answer->part[take_front(answer)];
    uint32_t number = part->first;
    part->sent = part->kind == FF_KIND_REFINEMENT && sent->byte_count > 0;
    for (unsigned q = 0; q < 4; q++)
        if (sent->below >> q & 1u) append(answer, number++);
}
