#include "ff_local.h"
#include "../../protocol/ff_assert.h"

#define ANSWERS_A_STEP 32 /* a step stays short */

static int answer(ff_intake *intake, const ff_pack *pack, const ff_request *request)
{
    enum ff_section_kind section = (enum ff_section_kind)ff_kind[request->kind].section;
    if (!section) /* a server makes it, and there is none */
        return ff_intake_failed(intake, request, FF_ERR_UNSUPPORTED);
    ff_message message = { .type = FF_MSG_ANSWER, .kind = (enum ff_kind)request->kind };
    const uint8_t **at = &message.u.data.bytes;
    int bytes = section == FF_SECTION_TEXTURE
                    ? ff_pack_layer_record(pack, request->layer, request->key, at)
                    : ff_pack_record(pack, section, request->key, at);
    if (bytes < 0) return ff_intake_failed(intake, request, bytes);
    message.u.data.byte_count = (uint32_t)bytes;
    return ff_intake_answer(intake, request, &message, (uint32_t)bytes);
}

int ff_local_step(ff_intake *intake, const ff_pack *pack, int prefetch, int64_t now_us)
{
    int moved = 0;
    for (int i = 0; i < ANSWERS_A_STEP; i++) {
        ff_request request;
        if (!ff_new_data_room(intake->news, intake->rgb_bytes != 0)) break;
        if (!ff_requests_next(intake->requests, now_us, 1, 0, prefetch, &request)) break;
        moved = answer(intake, pack, &request) == FF_OK;
        FF_ASSERT(moved); /* there is room: it cannot fail */
    }
    return moved;
}
