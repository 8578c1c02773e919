#include "ff_intake_local.h"

ff_new_item *ff_intake_begin(ff_intake *intake, const ff_request *request, int image,
                             uint32_t bytes)
{
    ff_new_item *item = ff_new_data_begin(intake->news, image);
    if (item) {
        item->key = request->key;
        item->id = request->id;
        item->kind = request->kind;
        item->last = 1;
        item->bytes = bytes;
    }
    return item;
}

int ff_intake_put(ff_intake *intake, ff_new_item *item)
{
    int last = item->last;
    uint16_t id = item->id;
    uint32_t bytes = item->bytes;
    if (last) /* before the main thread can see the item */
        ff_requests_arrived(intake->requests, id, bytes);
    ff_new_data_put(intake->news, item);
    return FF_OK;
}

int ff_intake_node(ff_intake *intake, const ff_request *request, const uint8_t *payload,
                   uint32_t bytes)
{
    ff_new_item *item = ff_intake_begin(intake, request, 0, bytes);
    if (!item) return FF_ERR_AGAIN;
    item->error = request->kind == FF_WANT_ROOT
                      ? ff_decode_root(intake->decoder, payload, bytes, &item->residuals)
                      : ff_decode_refinement(intake->decoder, payload, bytes, &item->residuals);
    return ff_intake_put(intake, item);
}

int ff_intake_record(ff_intake *intake, const ff_request *request, const uint8_t *payload,
                     uint32_t bytes)
{
    if (ff_kind[request->kind].data == FF_DATA_IMAGES)
        return ff_intake_texture(intake, request, payload, bytes);
    return ff_intake_node(intake, request, payload, bytes);
}

int ff_intake_failed(ff_intake *intake, const ff_request *request, int error)
{
    ff_new_item *item = ff_intake_begin(intake, request, 0, 0);
    if (!item) return FF_ERR_AGAIN;
    item->error = error < 0 ? error : FF_ERR_FORMAT;
    return ff_intake_put(intake, item);
}
