#include "ff_link_estimate.h"
#include "../../../protocol/ff_assert.h"

#define INTERVAL_US_MIN  100000
#define WINDOW_BYTES_MAX (1u << 24)

FF_STATIC_ASSERT(FF_WINDOW_BYTES_MIN < WINDOW_BYTES_MAX);
FF_STATIC_ASSERT((uint64_t)UINT32_MAX * 1000000u < INT64_MAX); /* take_sample */

const uint8_t ff_link_built = 1;

void ff_link_estimate_reset(ff_link_estimate *link)
{
    link->bytes_s = link->rtt_us = 0;
    link->since_us = INT64_MIN;
    link->interval_bytes = 0;
    link->window_full = 0;
}

void ff_link_estimate_sent(ff_link_estimate *link, int64_t now_us)
{
    if (link->since_us != INT64_MIN) return;
    link->since_us = now_us + link->rtt_us;
    link->unbegun = link->rtt_us == 0;
    link->interval_bytes = 0;
    link->window_full = 0;
}

static void take_sample(ff_link_estimate *link, int64_t interval_us)
{
    FF_ASSERT(interval_us > 0);
    uint64_t sample = (uint64_t)link->interval_bytes * 1000000u / (uint64_t)interval_us;
    if (sample > UINT32_MAX / 2) sample = UINT32_MAX / 2;
    if (link->bytes_s == 0)
        link->bytes_s = (uint32_t)sample;
    else if (sample > link->bytes_s)
        link->bytes_s += ((uint32_t)sample - link->bytes_s + 1) / 2;
    else if (link->window_full)
        link->bytes_s -= (link->bytes_s - (uint32_t)sample) / 8;
}

void ff_link_estimate_received(ff_link_estimate *link, uint32_t bytes, int outstanding,
                               int64_t now_us)
{
    if (link->since_us == INT64_MIN) return;
    if (link->unbegun)
        link->since_us = now_us; /* how long these took on their way is not known */
    else
        link->interval_bytes += bytes;
    link->unbegun = 0;
    int64_t interval_us = now_us - link->since_us;
    int64_t wanted_us = link->rtt_us > INTERVAL_US_MIN ? link->rtt_us : INTERVAL_US_MIN;
    if (interval_us >= wanted_us || (!outstanding && interval_us >= INTERVAL_US_MIN)) {
        take_sample(link, interval_us);
        link->since_us = now_us;
        link->interval_bytes = 0;
        link->window_full = 0;
    }
    if (!outstanding) link->since_us = INT64_MIN;
}

void ff_link_estimate_answer(ff_link_estimate *link, int64_t sent_us, int64_t now_us)
{
    int64_t sample = now_us - sent_us;
    if (sample < 1) sample = 1;
    if (sample > INT32_MAX) sample = INT32_MAX;
    if (link->rtt_us == 0 || sample < link->rtt_us)
        link->rtt_us = (uint32_t)sample;
    else
        link->rtt_us += ((uint32_t)sample - link->rtt_us) / 16;
    FF_ASSERT(link->rtt_us >= 1 && link->rtt_us <= INT32_MAX);
}

uint32_t ff_link_estimate_window(const ff_link_estimate *link)
{
    FF_ASSERT(link->bytes_s <= UINT32_MAX / 2); /* times rtt_us, which has 31 bits, it fits */
    if (!link->bytes_s) return FF_WINDOW_BYTES_UNTIMED;
    uint64_t bytes = 2 * ((uint64_t)link->bytes_s * link->rtt_us / 1000000u);
    if (bytes > WINDOW_BYTES_MAX) bytes = WINDOW_BYTES_MAX;
    return bytes > FF_WINDOW_BYTES_MIN ? (uint32_t)bytes : FF_WINDOW_BYTES_MIN;
}
