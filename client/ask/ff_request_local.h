/* Shared by ff_request*.c only. */
#ifndef FF_REQUEST_LOCAL_H
#define FF_REQUEST_LOCAL_H

#include "ff_request.h"

#define FF_REQUEST_HASH_START UINT64_C(0xcbf29ce484222325)

/* Takes a request that is sent into the hash. */
void ff_request_hash(uint64_t *hash, const ff_requests *requests, const ff_request *request);

#endif
