/* Every link profile against its own description, in long runs: rate, delay and gaps of both ways,
 * cuts and reconnects; recorded links against the recording. */
#include "../../sim/link/sim_link.h"
#include "../../sim/link/sim_trace.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SECOND 1000000LL
#define PACKET 512 /* bytes: SIM_PIPE_PACKET_BYTES */

static uint8_t bytes[1 << 16];

/* What one way of a link delivers for a sender who never stops. */
typedef struct measured {
    uint64_t received;
    int64_t span_us; /* from the first arrival to the last */
    int64_t longest_gap_us, gaps_us;
    unsigned gaps; /* longer than `gap_us` */
} measured;

static measured saturate(const sim_link_desc *desc, enum sim_direction way, uint64_t seed,
                         int64_t end_us, int64_t gap_us)
{
    measured m = { 0 };
    sim_link *link = sim_link_create(desc, seed);
    int64_t now = 0, first = -1, last = -1;
    assert_non_null(link);
    while (now < end_us) {
        for (size_t room; (room = sim_link_room(link, way, now)) > 0;)
            assert_true(sim_link_send(link, way, bytes, room < sizeof bytes ? room : sizeof bytes,
                                      now) > 0);
        int got = sim_link_recv(link, way, bytes, sizeof bytes, now);
        assert_true(got >= 0);
        if (got > 0 && first < 0)
            first = last = now;
        else if (got > 0) {
            m.received += (uint64_t)got;
            m.longest_gap_us = now - last > m.longest_gap_us ? now - last : m.longest_gap_us;
            if (now - last > gap_us) {
                m.gaps++;
                m.gaps_us += now - last;
            }
            last = now;
        }
        int64_t next = sim_link_next_us(link);
        assert_true(next >= now);
        now = next > now ? next : now + 1;
    }
    m.span_us = last - first;
    sim_link_destroy(link);
    return m;
}

static int64_t packet_us(const sim_link_way *way)
{
    return way->bytes_s ? (int64_t)PACKET * SECOND / way->bytes_s : 0;
}

/* ---- rate ---- */

/* Without stalls: the stated bytes a second, and never a gap longer than a packet and the
 * jitter. */
static void profiles_keep_their_rates(void **state)
{
    (void)state;
    for (unsigned i = 0; sim_link_profile_at(i); i++) {
        sim_link_desc desc = *sim_link_profile_at(i);
        desc.stall_every_ms = 0;
        for (int way = 0; way < 2; way++) {
            const sim_link_way *w = &desc.way[way];
            if (!w->bytes_s) continue;
            int64_t end_us = 4000 * packet_us(w) + 10 * (int64_t)(w->delay_us + w->jitter_us);
            measured m = saturate(&desc, (enum sim_direction)way, 3, end_us, INT64_MAX);
            double rate = (double)m.received * SECOND / (double)m.span_us;
            /* the jitter can move either end by this much */
            double share = 0.001 + w->jitter_us / (double)m.span_us;
            assert_true(rate > (1 - share) * w->bytes_s && rate < (1 + share) * w->bytes_s);
            assert_true(m.longest_gap_us <= packet_us(w) + w->jitter_us + 1);
        }
    }
}

/* Each way has its own rate, also while both are full. */
static void ways_do_not_share(void **state)
{
    (void)state;
    const sim_link_desc *desc = sim_link_profile("umts");
    sim_link *link = sim_link_create(desc, 1);
    uint64_t received[2] = { 0, 0 };
    for (int64_t now = 0; now < 100 * SECOND; now += 5000)
        for (int way = 0; way < 2; way++) {
            (void)sim_link_send(link, way, bytes, sizeof bytes, now);
            received[way] += (uint64_t)sim_link_recv(link, way, bytes, sizeof bytes, now);
        }
    assert_in_range(received[SIM_DOWN], 99 * 48000, 100 * 48000);
    assert_in_range(received[SIM_UP], 99 * 8000, 100 * 8000);
    sim_link_destroy(link);
}

/* ---- delay ---- */

/* One byte at a time: at least the delay, at most the jitter more, and half of it in the mean. */
static void profiles_keep_their_delays(void **state)
{
    (void)state;
    for (unsigned i = 0; sim_link_profile_at(i); i++) {
        sim_link_desc desc = *sim_link_profile_at(i);
        desc.stall_every_ms = 0;
        for (int way = 0; way < 2; way++) {
            const sim_link_way *w = &desc.way[way];
            sim_link *link = sim_link_create(&desc, 5);
            int64_t byte_us = w->bytes_s ? (SECOND + w->bytes_s - 1) / w->bytes_s : 0, sum = 0,
                    now = 0, least = INT64_MAX, most = 0;
            for (int n = 0; n < 2000; n++) {
                int64_t sent = now;
                assert_int_equal(sim_link_send(link, (enum sim_direction)way, bytes, 1, now), 1);
                while (sim_link_recv(link, (enum sim_direction)way, bytes, 1, now) == 0)
                    now = sim_link_next_us(link);
                int64_t took = now - sent - byte_us;
                sum += took;
                least = took < least ? took : least;
                most = took > most ? took : most;
                now += SECOND;
            }
            assert_in_range(least + 1, w->delay_us, w->delay_us + w->jitter_us / 200 + 2);
            assert_in_range(most, w->delay_us + w->jitter_us - w->jitter_us / 200,
                            w->delay_us + w->jitter_us + 2);
            /* the mean of 2000: standard deviation jitter / sqrt(12 * 2000), four of them */
            assert_true(llabs(sum / 2000 - w->delay_us - w->jitter_us / 2) <=
                        w->jitter_us / 38 + 1);
            sim_link_destroy(link);
        }
    }
}

/* ---- stalls ---- */

/* Profiles with stalls, for about 400 of them: number and mean length as described; the time
 * between at the full rate. No byte passes during a stall here: the few that do (test_link.c) may
 * complete a packet and make two gaps of one. */
static void profiles_keep_their_stalls(void **state)
{
    (void)state;
    unsigned stalling = 0;
    for (unsigned i = 0; sim_link_profile_at(i); i++) {
        sim_link_desc desc = *sim_link_profile_at(i);
        if (!desc.stall_every_ms) continue;
        stalling++;
        desc.stall_bytes_s = 0;
        int64_t mean_us = 500 * (int64_t)(desc.stall_ms_min + desc.stall_ms_max);
        int64_t end_us = 400 * (mean_us + (int64_t)desc.stall_every_ms * 1000);
        for (int way = 0; way < 2; way++) {
            const sim_link_way *w = &desc.way[way];
            measured m = saturate(&desc, (enum sim_direction)way, 11, end_us,
                                  packet_us(w) + w->jitter_us + SECOND);
            /* 400, standard deviation 400^0.5 * (spacing's share); lengths: (max - min) / 12^0.5 /
             * 20 */
            assert_in_range(m.gaps, 400 - 60, 400 + 60);
            int64_t spread_us = (int64_t)(desc.stall_ms_max - desc.stall_ms_min) * 1000;
            assert_true(llabs(m.gaps_us / m.gaps - mean_us) <
                        spread_us / 69 * 4 + packet_us(w) + w->jitter_us);
            assert_true(m.longest_gap_us <=
                        (int64_t)desc.stall_ms_max * 1000 + packet_us(w) + w->jitter_us + 1);
            double moving_s = (double)(m.span_us - m.gaps_us) / SECOND;
            double rate = (double)m.received / moving_s;
            assert_true(rate > 0.99 * w->bytes_s && rate < 1.02 * w->bytes_s);
        }
    }
    assert_int_equal(stalling, 2); /* GPRS, Iridium */
}

/* ---- cuts ---- */

/* A link is cut about every 10 s while both ways are full. A connection lasts 5 to 15 s, 10 in the
 * mean, after the time it takes to connect; the bytes that arrive over it were sent over it, from
 * its first byte on. */
static void profiles_are_cut_and_come_back(void **state)
{
    (void)state;
    for (unsigned i = 0; sim_link_profile_at(i); i++) {
        sim_link_desc desc = *sim_link_profile_at(i);
        desc.cut_every_ms = 10000;
        sim_link *link = sim_link_create(&desc, 21);
        int64_t now = 0, up_since = 0, lasted = 0, step = 20000;
        for (unsigned cut = 0; cut < 100; cut++) {
            uint8_t sent[2] = { (uint8_t)(cut * 3), (uint8_t)(cut * 5) },
                    expected[2] = { sent[0], sent[1] };
            for (int open = 1; open; now += step)
                for (int way = 0; way < 2 && open; way++) {
                    for (size_t n = 0; n < 64; n++) bytes[n] = (uint8_t)(sent[way] + n);
                    int taken = sim_link_send(link, way, bytes, 64, now);
                    int got = sim_link_recv(link, way, bytes, sizeof bytes, now);
                    open = taken >= 0 && got >= 0;
                    sent[way] = (uint8_t)(sent[way] + (taken > 0 ? taken : 0));
                    for (int n = 0; n < got; n++) assert_int_equal(bytes[n], expected[way]++);
                }
            assert_in_range(now - up_since, 5 * SECOND, 15 * SECOND + 2 * step);
            lasted += now - up_since;
            int64_t down_since = now;
            while (sim_link_reconnect(link, now) == FF_ERR_AGAIN) now = sim_link_next_us(link);
            assert_int_equal(now - down_since, (int64_t)desc.connect_ms * 1000);
            up_since = now;
            assert_int_equal(sim_link_connections(link), cut + 2);
        }
        /* 10 s / 12^0.5 / 10 */
        assert_true(llabs(lasted / 100 - 10 * SECOND) < 4 * 290000 + step);
        sim_link_destroy(link);
    }
}

/* ---- recorded links ---- */

/* Replays a trace for a turn and a half at a sender who never stops: each second brings what the
 * recording delivered in it. */
static void replay(const char *path)
{
    sim_trace trace;
    sim_link_way way = { .bytes_s = 1, .queue_bytes = 1 << 18, .trace = path };
    sim_link_desc desc = { .name = "test", .source = "test", .way = { way, way } };
    assert_int_equal(sim_trace_read(&trace, path), FF_OK);
    desc.way[SIM_UP].trace = NULL;
    sim_link *link = sim_link_create(&desc, 1);
    assert_non_null(link);
    int64_t seconds = (int64_t)(trace.period_ms * 3 / 2000), longest_us = 0, last_us = 0,
            recorded_us = 0;
    for (size_t i = 1; i < trace.count; i++)
        if ((int64_t)(trace.at_ms[i] - trace.at_ms[i - 1]) * 1000 > recorded_us)
            recorded_us = (int64_t)(trace.at_ms[i] - trace.at_ms[i - 1]) * 1000;
    uint64_t passed = sim_trace_find(&trace, 0);
    for (int64_t second = 0; second < seconds; second++) {
        uint64_t received = 0, expected;
        for (int64_t now = second * SECOND; now < (second + 1) * SECOND; now += 1000) {
            while (sim_link_send(link, SIM_DOWN, bytes, sizeof bytes, now) > 0)
                ;
            int got = sim_link_recv(link, SIM_DOWN, bytes, sizeof bytes, now + 1);
            for (int more = got; more > 0; got += more)
                more = sim_link_recv(link, SIM_DOWN, bytes, sizeof bytes, now + 1);
            received += (uint64_t)got;
            if (got > 0 && now - last_us > longest_us) longest_us = now - last_us;
            last_us = got > 0 ? now : last_us;
        }
        uint64_t next = sim_trace_find(&trace, (second + 1) * SECOND);
        expected = (next - passed) * SIM_TRACE_OPPORTUNITY_BYTES;
        passed = next;
        assert_int_equal(received, expected);
    }
    assert_true(llabs(longest_us - recorded_us) <= 1000 ||
                (int64_t)trace.at_ms[0] * 1000 >= recorded_us);
    sim_link_destroy(link);
    sim_trace_free(&trace);
}

/* A drive made here: seconds of 0 to 60 packets, gaps of up to 8 s. */
static void a_drive_is_replayed(void **state)
{
    (void)state;
    char path[] = "/tmp/test_link_profiles_XXXXXX";
    sys_random random;
    sys_random_seed(&random, 4, 1);
    int fd = mkstemp(path);
    assert_true(fd >= 0);
    FILE *file = fdopen(fd, "w");
    for (uint32_t second = 0, ms = 0; second < 400; second++) {
        uint32_t packets = second % 50 < 8 && second > 8 ? 0 : sys_random_below(&random, 61);
        for (uint32_t n = 0; n < packets; n++)
            if (second * 1000 + n * 16 >= ms) fprintf(file, "%u\n", ms = second * 1000 + n * 16);
    }
    fclose(file);
    replay(path);
    unlink(path);
}

/* Links recorded on the road, if the machine has such recordings. */
static void recorded_drives_are_replayed(void **state)
{
    (void)state;
    static const char *const name[] = { "TMobile-UMTS-driving", "Verizon-EVDO-driving",
                                        "ATT-LTE-driving-2016" };
    char path[256];
    for (size_t i = 0; i < sizeof name / sizeof name[0]; i++)
        for (int up = 0; up < 2; up++) {
            snprintf(path, sizeof path, "../shared/data/traces/%s.%s", name[i], up ? "up" : "down");
            if (access(path, R_OK) != 0) skip();
            replay(path);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(profiles_keep_their_rates),
        cmocka_unit_test(ways_do_not_share),
        cmocka_unit_test(profiles_keep_their_delays),
        cmocka_unit_test(profiles_keep_their_stalls),
        cmocka_unit_test(profiles_are_cut_and_come_back),
        cmocka_unit_test(a_drive_is_replayed),
        cmocka_unit_test(recorded_drives_are_replayed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
