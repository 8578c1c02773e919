#include "ff_intake_local.h"
#include "../../protocol/ff_assert.h"
#include "../../protocol/shape/ff_shape.h"

static ff_new_item *begin(ff_intake *intake, const ff_request *request, uint32_t bytes)
{
    FF_ASSERT(request->state == FF_REQUEST_SENT && request->id >= 1);
    ff_new_item *item = ff_new_data_begin(intake->news);
    if (item) {
        item->key = request->key;
        item->id = request->id;
        item->kind = request->kind;
        item->last = 1;
        item->bytes = bytes;
    }
    return item;
}

static int put(ff_intake *intake, ff_new_item *item)
{
    FF_ASSERT(item->last || ff_kind[item->kind].brings == FF_BRINGS_FACE);
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

int ff_intake_root(ff_intake *intake, const ff_message *answer, ff_new_item *item)
{
    FF_ASSERT(ff_key_level(item->key) == 0);
    item->u.residuals.value = item->room;
    item->u.residuals.cells = ff_shape_cells(&intake->info, item->key, 0);
    return ff_decode_root(intake->decoder, answer->u.data.bytes, answer->u.data.byte_count,
                          &item->u.residuals);
}

int ff_intake_refinement(ff_intake *intake, const ff_message *answer, ff_new_item *item)
{
    FF_ASSERT(ff_refined_side(&intake->info) * ff_refined_side(&intake->info) <=
              intake->news->room_words);
    item->u.residuals.value = item->room;
    item->u.residuals.cells = ff_shape_cells(&intake->info, item->key, 1);
    return ff_decode_refinement(intake->decoder, answer->u.data.bytes, answer->u.data.byte_count,
                                &item->u.residuals);
}
