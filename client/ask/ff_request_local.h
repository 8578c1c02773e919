/* Shared by ff_request*.c only. */
#ifndef FF_REQUEST_LOCAL_H
#define FF_REQUEST_LOCAL_H

#include "ff_request.h"
#include "../../protocol/ff_assert.h"

#define FF_REQUEST_HASH_START UINT64_C(0xcbf29ce484222325)

static inline unsigned ff_request_level(const ff_request *request)
{
    FF_ASSERT(request->kind < FF_KIND_COUNT);
    return ff_kind[request->kind].asks == FF_ASKS_NODE ? ff_key_level(request->key) : 0;
}
/* ff_request_sizes.c, under the mutex: before any answer, and one that came. */
void ff_request_guess_bytes(ff_requests *requests);
void ff_request_learn_bytes(ff_requests *requests, const ff_request *request, uint32_t bytes);
/* What a request of that priority is worth for the bytes its answer is expected to take. */
uint32_t ff_request_value(const ff_requests *requests, unsigned kind, unsigned level,
                          uint32_t priority);
/* Takes a request that is sent into the hash. */
void ff_request_hash(uint64_t *hash, const ff_requests *requests, const ff_request *request);

#endif
