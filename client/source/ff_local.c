#include "ff_local.h"

#define ANSWERS_A_STEP 32 /* a step stays short */

static int answer(ff_intake *intake, const ff_pack *pack, const ff_request *request)
{
    enum ff_section_kind section = (enum ff_section_kind)ff_kind[request->kind].section;
    if (section == FF_SECTION_NONE) /* nobody here draws panoramas */
        return ff_intake_failed(intake, request, FF_ERR_UNSUPPORTED);
    const uint8_t *payload;
    int bytes = ff_pack_record(pack, section, request->key, &payload);
    if (bytes < 0) return ff_intake_failed(intake, request, bytes);
    return ff_intake_record(intake, request, payload, (uint32_t)bytes);
}

int ff_local_step(ff_intake *intake, const ff_pack *pack, int prefetch, int64_t now_us)
{
    int moved = 0;
    for (int i = 0; i < ANSWERS_A_STEP; i++) {
        ff_request request;
        if (!ff_new_data_room(intake->news, intake->rgb_bytes != 0)) break;
        if (!ff_requests_next(intake->requests, now_us, 1, 0, prefetch, &request)) break;
        (void)answer(intake, pack, &request); /* there is room: it cannot fail */
        moved = 1;
    }
    return moved;
}
