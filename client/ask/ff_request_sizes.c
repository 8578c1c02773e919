/* How long answers are: guessed, then learned from those that came, for each kind and level; and
 * what a request is worth for its bytes. */
#include "ff_request_local.h"
#include "../../protocol/ff_assert.h"

#define ANSWER_BYTES_START 200u /* before the first answer of a kind: Hybrid's 9x9 node is 182 */
#define SEVERAL            16u  /* so many times that of a face, or of a view's answers together */
#define SOME               3u   /* of a texture, or of a sector */

/* answer_q4 has a mean for every level of a key */
FF_STATIC_ASSERT(sizeof((ff_requests *)0)->answer_q4[0] ==
                 (FF_KEY_LEVEL_MAX + 1) * sizeof(uint32_t));
/* a message at its longest, Q4, before an eighth of it is taken */
FF_STATIC_ASSERT((uint64_t)(FF_MESSAGE_BODY_MAX + FF_MESSAGE_HEADER_MAX) * 16 <= UINT32_MAX);

static uint32_t times_a_node(unsigned kind)
{
    int brings = ff_kind[kind].brings;
    if (brings == FF_BRINGS_PARTS || brings == FF_BRINGS_FACE) return SEVERAL;
    return ff_kind[kind].has_image ? SOME : 1;
}

void ff_request_guess_bytes(ff_requests *requests)
{
    for (unsigned kind = 0; kind < FF_KIND_COUNT; kind++)
        for (unsigned level = 0; level <= FF_KEY_LEVEL_MAX; level++)
            requests->answer_q4[kind][level] = 16 * ANSWER_BYTES_START * times_a_node(kind);
}

uint32_t ff_request_value(const ff_requests *requests, unsigned kind, unsigned level,
                          uint32_t priority)
{
    FF_ASSERT(level <= FF_KEY_LEVEL_MAX && kind < FF_KIND_COUNT);
    uint64_t value = ((uint64_t)priority << 12) / (requests->answer_q4[kind][level] + 1u);
    return value > UINT32_MAX ? UINT32_MAX : (uint32_t)value;
}

uint32_t ff_requests_answer_bytes(ff_requests *requests, enum ff_kind kind, unsigned level)
{
    FF_ASSERT(level <= FF_KEY_LEVEL_MAX);
    sys_mutex_lock(&requests->mutex);
    uint32_t bytes = requests->answer_q4[kind][level] >> 4;
    sys_mutex_unlock(&requests->mutex);
    return bytes;
}

/* What is guessed before anything has come is far off for some, and a window full of guesses is
 * empty: the first answer counts at once, for all levels of which there was none. */
void ff_request_learn_bytes(ff_requests *requests, const ff_request *request, uint32_t bytes)
{
    unsigned at = ff_request_level(request), kind = request->kind;
    FF_ASSERT(bytes > 0 && kind < FF_KIND_COUNT);
    uint32_t *mean_q4 = requests->answer_q4[kind];
    if (ff_kind[kind].asks == FF_ASKS_NODE && !(requests->met[kind] >> at & 1u))
        for (unsigned level = 0; level <= FF_KEY_LEVEL_MAX; level++)
            if (!(requests->met[kind] >> level & 1u)) mean_q4[level] = bytes * 16u;
    requests->met[kind] |= (uint16_t)(1u << at);
    mean_q4[at] -= mean_q4[at] >> 3;
    mean_q4[at] += bytes * 16u >> 3;
}
