/* What the link can carry, measured from its own traffic: the window of bytes in flight is rate
 * times round trip, not a constant.
 *
 *   rate        bytes that came while requests were out, per interval of a round trip (at least 100
 *               ms), counted from when the first of them can be here; running mean, quick to rise
 * (1/2), slow to fall (1/8), so that a stall of GPRS does not forget what the link can do. An
 * interval in which the window was not full says nothing about the link's limit and cannot lower
 * the mean. round trip  request to answer, of what packs hold (drawing panoramas takes time); falls
 * at once, rises by 1/16: nearly the minimum, so that our own queue in the network is not taken for
 * distance. window      2 * rate * round trip, at least FF_WINDOW_BYTES_MIN
 * (FF_WINDOW_BYTES_UNTIMED until the first rate): twice, because a window of just the product could
 * never find out that the link carries more. */
#ifndef FF_LINK_ESTIMATE_H
#define FF_LINK_ESTIMATE_H

#include <stdint.h>

#define FF_WINDOW_BYTES_MIN     2048u
#define FF_WINDOW_BYTES_UNTIMED 8192u /* while nothing is known of the link */

/* 0: all that concerns the network is left out of this build */
extern const uint8_t ff_link_built;

typedef struct ff_link_estimate {
    uint32_t bytes_s, rtt_us; /* 0: not known */
    int64_t since_us;         /* start of the interval; INT64_MIN: none */
    uint32_t interval_bytes;
    uint8_t window_full;
    uint8_t unbegun; /* 1: the interval starts when something comes */
} ff_link_estimate;

void ff_link_estimate_reset(ff_link_estimate *link);
/* Something was sent that will be answered. */
void ff_link_estimate_sent(ff_link_estimate *link, int64_t now_us);
/* `bytes` came; `outstanding`: answers are still awaited. */
void ff_link_estimate_received(ff_link_estimate *link, uint32_t bytes, int outstanding,
                               int64_t now_us);
void ff_link_estimate_answer(ff_link_estimate *link, int64_t sent_us, int64_t now_us);
uint32_t ff_link_estimate_window(const ff_link_estimate *link);

#endif
