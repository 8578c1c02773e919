/* A number of all that was asked, in its order: the same for the same flight. */
#include "ff_request_local.h"

#define HASH_PRIME UINT64_C(0x100000001b3)

static void hash_word(uint64_t *hash, uint64_t word) { *hash = (*hash ^ word) * HASH_PRIME; }

static void hash_view(uint64_t *hash, const ff_get_view *view)
{
    for (int i = 0; i < 3; i++) hash_word(hash, (uint32_t)view->position_wu[i]);
    hash_word(hash, (uint32_t)view->yaw << 16 | view->pitch);
    hash_word(hash, view->bytes_max);
    hash_word(hash, view->roots);
    for (unsigned i = 0; i < view->count; i++) hash_word(hash, view->below[i]);
    for (unsigned i = 0; i < view->edge_count; i++) hash_word(hash, view->edge[i]);
}

static void hash_place(uint64_t *hash, const int32_t position_wu[3], const uint8_t *list,
                       unsigned count)
{
    for (int i = 0; i < 3; i++) hash_word(hash, (uint32_t)position_wu[i]);
    for (unsigned i = 0; i < count; i++) hash_word(hash, list[i]);
}

void ff_request_hash(uint64_t *hash, const ff_requests *requests, const ff_request *request)
{
    const ff_ask *ask = request->ask ? ff_requests_ask_of(requests, request) : NULL;
    hash_word(hash, request->kind);
    switch ((enum ff_kind_asks)ff_kind[request->kind].asks) {
        case FF_ASKS_NODE: hash_word(hash, request->key); break;
        case FF_ASKS_VIEW: hash_view(hash, &requests->view); break;
        case FF_ASKS_PANORAMA:
            hash_place(hash, ask->panorama.position_wu, ask->panorama.face,
                       ask->panorama.face_count);
            break;
        case FF_ASKS_FAR:
            hash_place(hash, ask->far.position_wu, ask->far.sector, ask->far.sector_count);
            break;
    }
}
