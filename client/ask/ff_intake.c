#include "ff_intake_local.h"
#include "../../protocol/ff_assert.h"
#include "../../protocol/shape/ff_shape.h"

int ff_intake_ground(const ff_intake *intake, ff_key key)
{
    for (int i = 0; i < intake->ground_count; i++)
        if (ff_key_tile(key) - intake->info[i].first_tile < ff_shape_tiles(&intake->info[i]))
            return i;
    return -1;
}

/* The terrain of what was asked for, with the decoder turned to it. */
static const ff_terrain_info *turn_to(ff_intake *intake, ff_key key)
{
    int ground = ff_intake_ground(intake, key);
    FF_ASSERT(ground >= 0); /* nothing else was asked for */
    if (ff_decoder_turn(intake->decoder, &intake->info[ground]) != FF_OK) return NULL;
    return &intake->info[ground];
}

static ff_new_item *begin(ff_intake *intake, const ff_request *request, uint32_t bytes)
{
    FF_ASSERT(request->state == FF_REQUEST_SENT && request->id >= 1);
    ff_new_item *item = ff_new_data_begin(intake->news);
    if (item) {
        item->key = request->key;
        item->id = request->id;
        item->source = intake->source;
        item->kind = request->kind;
        item->layer = request->layer;
        item->last = 1;
        item->bytes = bytes;
    }
    return item;
}

static int put(ff_intake *intake, ff_new_item *item)
{
    if (item->last) /* before the main thread can see the item */
        ff_requests_arrived(intake->requests, item->id, item->bytes);
    ff_new_data_put(intake->news, item);
    return FF_OK;
}

static int decode(ff_intake *intake, const ff_message *answer, ff_new_item *item)
{
    switch ((enum ff_kind)item->kind) {
#define X(kind, name, ...) \
    case FF_KIND_##kind: return ff_intake_##name(intake, answer, item);
        FF_KIND_LIST(X)
#undef X
        case FF_KIND_COUNT: break;
    }
    return FF_ERR_UNSUPPORTED;
}

int ff_intake_answer(ff_intake *intake, const ff_request *request, const ff_message *answer,
                     uint32_t bytes)
{
    int payload = ff_kind[request->kind].brings == FF_BRINGS_PAYLOAD;
    ff_new_item *item = begin(intake, request, payload ? answer->u.data.byte_count : bytes);
    if (!item) return FF_ERR_AGAIN;
    item->error = decode(intake, answer, item);
    if (item->error == FF_ERR_AGAIN) return FF_ERR_AGAIN;
    FF_ASSERT(item->error <= FF_OK && item->error >= FF_ERR_LAST);
    if (item->error != FF_OK) item->pixels = NULL;
    if (!item->last) ff_requests_came(intake->requests, item->id, item->bytes);
    return put(intake, item);
}

int ff_intake_part(ff_intake *intake, const ff_request *request, enum ff_kind kind, ff_key key,
                   const ff_part *part)
{
    ff_request own = *request;
    FF_ASSERT(request->kind == FF_KIND_VIEW && part->byte_count > 0);
    own.kind = (uint8_t)kind;
    own.key = key;
    ff_new_item *item = begin(intake, &own, part->byte_count);
    if (!item) return FF_ERR_AGAIN;
    ff_message answer = { .type = FF_MSG_ANSWER, .kind = kind };
    answer.u.data = (ff_data){ part->bytes, part->byte_count };
    item->last = 0;
    item->error = decode(intake, &answer, item);
    FF_ASSERT(item->error <= FF_OK && item->error >= FF_ERR_LAST && item->error != FF_ERR_AGAIN);
    ff_requests_part(intake->requests, item->id, kind, key, item->bytes);
    return put(intake, item);
}

int ff_intake_failed(ff_intake *intake, const ff_request *request, int error)
{
    ff_new_item *item = begin(intake, request, 0);
    if (!item) return FF_ERR_AGAIN;
    item->refused = 1;
    item->error = error < 0 ? error : FF_ERR_FORMAT;
    return put(intake, item);
}

/* The end of a view's answers. */
int ff_intake_view(ff_intake *intake, const ff_message *answer, ff_new_item *item)
{
    (void)answer;
    ff_request request;
    const ff_get_view *view = &intake->requests->view;
    int known = ff_requests_answered(intake->requests, item->id, &request);
    FF_ASSERT(known);
    item->u.missing = (uint16_t)(known ? ((1u << view->count) - 1) & ~(uint32_t)request.named : 0);
    return FF_OK;
}

int ff_intake_root(ff_intake *intake, const ff_message *answer, ff_new_item *item)
{
    FF_ASSERT(ff_key_level(item->key) == 0);
    const ff_terrain_info *info = turn_to(intake, item->key);
    if (!info) return FF_ERR_UNSUPPORTED;
    item->u.residuals.value = item->room;
    item->u.residuals.cells = ff_shape_cells(info, item->key, 0);
    return ff_decode_root(intake->decoder, answer->u.data.bytes, answer->u.data.byte_count,
                          &item->u.residuals);
}

int ff_intake_refinement(ff_intake *intake, const ff_message *answer, ff_new_item *item)
{
    const ff_terrain_info *info = turn_to(intake, item->key);
    if (!info) return FF_ERR_UNSUPPORTED;
    FF_ASSERT(ff_refined_side(info) * ff_refined_side(info) <= intake->news->room_words);
    item->u.residuals.value = item->room;
    item->u.residuals.cells = ff_shape_cells(info, item->key, 1);
    return ff_decode_refinement(intake->decoder, answer->u.data.bytes, answer->u.data.byte_count,
                                &item->u.residuals);
}
