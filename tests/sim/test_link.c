/* The link models do what their descriptions say: rate, delay, gaps, traces, cuts; they are
 * deterministic, and lose and reorder no byte. */
#include "../../sim/link/sim_link.h"
#include "../../sim/link/sim_stream.h"
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

static sim_link_desc plain(uint32_t bytes_s, uint32_t delay_us, uint32_t jitter_us)
{
    sim_link_way way = {
        .bytes_s = bytes_s, .delay_us = delay_us, .jitter_us = jitter_us, .queue_bytes = 1 << 20
    };
    return (sim_link_desc){ .name = "test", .source = "test", .way = { way, way } };
}

/* Receives at every event until `count` bytes are there; returns the time of the last one. */
static int64_t receive_all(sim_link *link, enum sim_direction way, size_t count, int64_t now_us)
{
    uint8_t bytes[4096];
    size_t received = 0;
    while (received < count) {
        int got = sim_link_recv(link, way, bytes, sizeof bytes, now_us);
        assert_true(got >= 0);
        received += (size_t)got;
        if (received < count && got == 0) {
            int64_t next = sim_link_next_us(link);
            assert_true(next > now_us && next < INT64_MAX);
            now_us = next;
        }
    }
    assert_int_equal(received, count);
    return now_us;
}

static void the_rate_is_exact(void **state)
{
    (void)state;
    static const uint32_t rate[] = { 1, 7, 5500, 48000, 999983, 12500000 };
    static uint8_t bytes[700001];
    for (size_t i = 0; i < sizeof rate / sizeof rate[0]; i++) {
        sim_link_desc desc = plain(rate[i], 1000, 0);
        sim_link *link = sim_link_create(&desc, 1);
        size_t count = rate[i] < 1000 ? 5000 : sizeof bytes;
        int64_t start = 123456789;
        assert_int_equal(sim_link_send(link, SIM_DOWN, bytes, count, start), (int)count);
        int64_t end = receive_all(link, SIM_DOWN, count, start);
        int64_t exact = (int64_t)(((uint64_t)count * 1000000u + rate[i] - 1) / rate[i]);
        assert_int_equal(end - start - 1000, exact);
        sim_link_destroy(link);
    }
}

/* Bytes are sent one by one at exactly the link's rate: rounding builds up no drift. */
static void rounding_does_not_drift(void **state)
{
    (void)state;
    sim_link_desc desc = plain(3000, 0, 0); /* 333.33 us a byte */
    sim_link *link = sim_link_create(&desc, 1);
    uint8_t byte = 0;
    int64_t now = 0, received = 0;
    for (int i = 0; i < 300000; i++) {
        now = (int64_t)i * 1000 / 3;
        assert_int_equal(sim_link_send(link, SIM_UP, &byte, 1, now), 1);
        received += sim_link_recv(link, SIM_UP, &byte, 1, now);
        assert_true(i - received <= 4);
    }
    sim_link_destroy(link);
}

static void delay_and_jitter_are_as_described(void **state)
{
    (void)state;
    sim_link_desc desc = plain(0, 300000, 200000);
    sim_link *link = sim_link_create(&desc, 5);
    int64_t sum = 0, least = INT64_MAX, most = 0;
    uint8_t byte = 1;
    for (int i = 0; i < 2000; i++) {
        int64_t sent = i * SECOND;
        assert_int_equal(sim_link_send(link, SIM_DOWN, &byte, 1, sent), 1);
        int64_t took = receive_all(link, SIM_DOWN, 1, sent) - sent;
        sum += took;
        least = took < least ? took : least;
        most = took > most ? took : most;
    }
    assert_true(least >= 300000 && least < 301000);
    assert_true(most < 500000 && most > 499000);
    /* 200000 / sqrt(12 * 2000) = 1291: four times that */
    assert_true(llabs(sum / 2000 - 400000) < 5000);
    sim_link_destroy(link);
}

static void a_full_queue_takes_no_more(void **state)
{
    (void)state;
    sim_link_desc desc = plain(1000, 0, 0);
    desc.way[SIM_UP].queue_bytes = 2000;
    sim_link *link = sim_link_create(&desc, 1);
    uint8_t bytes[4000] = { 0 };
    assert_int_equal(sim_link_send(link, SIM_UP, bytes, sizeof bytes, 0), 2000);
    assert_int_equal(sim_link_send(link, SIM_UP, bytes, sizeof bytes, 0), 0);
    /* half a second on, the first packet of 512 bytes is with the transmitter */
    assert_int_equal(sim_link_send(link, SIM_UP, bytes, sizeof bytes, SECOND / 2), 512);
    sim_link_destroy(link);
}

/* A sender that never stops sees every stall as a gap: the gaps' number, lengths and spacing are
 * those described. */
static void stalls_are_as_described(void **state)
{
    (void)state;
    sim_link_desc desc = plain(5500, 0, 0);
    desc.stall_every_ms = 120000;
    desc.stall_ms_min = 4000;
    desc.stall_ms_max = 40000;
    sim_link *link = sim_link_create(&desc, 42);
    static uint8_t bytes[65536];
    int64_t now = 0, last_down = 0, last_up = 0, stalled = 0, end = 400000 * SECOND;
    int stalls = 0, stalls_up = 0;
    while (now < end) {
        (void)sim_link_send(link, SIM_DOWN, bytes, 4096, now);
        (void)sim_link_send(link, SIM_UP, bytes, 4096, now);
        if (sim_link_recv(link, SIM_DOWN, bytes, sizeof bytes, now) > 0) {
            int64_t gap = now - last_down - 93091; /* 512 bytes at 5500 B/s */
            if (gap > SECOND) {
                assert_true(gap >= 3900000 && gap <= 40000000);
                stalls++;
                stalled += gap;
            }
            last_down = now;
        }
        if (sim_link_recv(link, SIM_UP, bytes, sizeof bytes, now) > 0) {
            stalls_up += now - last_up > SECOND;
            last_up = now;
        }
        now = sim_link_next_us(link);
    }
    /* expected 400000 / (120 + 22) = 2817 stalls of 22 s; standard deviations about 46 stalls and
     * 0.2 s */
    assert_true(abs(stalls - 2817) < 180);
    assert_true(llabs(stalled / stalls - 22 * SECOND) < 800000);
    assert_true(abs(stalls - stalls_up) <= 1);
    sim_link_destroy(link);
}

static void a_stall_lets_its_rate_through(void **state)
{
    (void)state;
    sim_link_desc desc = plain(1000, 0, 0); /* a short time before the first stall */
    desc.stall_every_ms = 1;                /* nearly always stalled */
    desc.stall_ms_min = desc.stall_ms_max = 1000000;
    desc.stall_bytes_s = 5;
    sim_link *link = sim_link_create(&desc, 3);
    static uint8_t bytes[40000];
    int taken = sim_link_send(link, SIM_DOWN, bytes, sizeof bytes, SECOND), received = 0;
    assert_int_equal(taken, 40000);
    for (int i = 0; i < 800; i++)
        received += sim_link_recv(link, SIM_DOWN, bytes, sizeof bytes, (i + 2) * SECOND);
    /* whole packets of 512 bytes, 5 bytes a second */
    assert_in_range(received, 4000 - 512, 4000 + 1);
    sim_link_destroy(link);
}

/* ---- traces ---- */

static void write_trace(char *path, const char *text)
{
    strcpy(path, "/tmp/test_link_trace_XXXXXX");
    int fd = mkstemp(path);
    assert_true(fd >= 0);
    assert_int_equal(write(fd, text, strlen(text)), (ssize_t)strlen(text));
    close(fd);
}

static void a_trace_is_replayed(void **state)
{
    (void)state;
    char path[64];
    write_trace(path, "10\n10\n25\n100\n");
    sim_link_desc desc = plain(1, 0, 0);
    desc.way[SIM_DOWN].trace = path;
    sim_link *link = sim_link_create(&desc, 1);
    assert_non_null(link);
    static uint8_t bytes[100000];
    assert_int_equal(sim_link_send(link, SIM_DOWN, bytes, 30000, 0), 30000);
    /* opportunities of 1500 bytes: 10 10 25 100 | 110 110 125 200 | ... */
    static const struct {
        int ms, total;
    } expect[] = { { 9, 0 },       { 11, 3000 },   { 24, 3000 },  { 26, 4500 },   { 99, 4500 },
                   { 101, 6000 },  { 109, 6000 },  { 111, 9000 }, { 126, 10500 }, { 201, 12000 },
                   { 399, 22500 }, { 401, 24000 }, { 501, 30000 } };
    int total = 0;
    for (size_t i = 0; i < sizeof expect / sizeof expect[0]; i++) {
        total += sim_link_recv(link, SIM_DOWN, bytes, sizeof bytes, expect[i].ms * 1000);
        assert_int_equal(total, expect[i].total);
    }
    /* an unused opportunity is lost: nothing was queued at 510 and 510, so 2000 bytes sent at 511
     * leave at 525 and 600 */
    assert_int_equal(sim_link_send(link, SIM_DOWN, bytes, 2000, 511000), 2000);
    assert_int_equal(sim_link_recv(link, SIM_DOWN, bytes, sizeof bytes, 526000), 1500);
    assert_int_equal(sim_link_recv(link, SIM_DOWN, bytes, sizeof bytes, 599000), 0);
    assert_int_equal(sim_link_recv(link, SIM_DOWN, bytes, sizeof bytes, 601000), 500);
    sim_link_destroy(link);
    unlink(path);
}

/* A sender that always has bytes gets 1500 times the opportunities, over several turns. */
static void a_trace_s_rate_is_its_packets(void **state)
{
    (void)state;
    char path[64], text[4096] = "";
    uint32_t ms = 0, lines = 0;
    sys_random random;
    sys_random_seed(&random, 9, 1);
    for (; strlen(text) < 3900; lines++) {
        char line[16];
        ms += sys_random_below(&random, 40);
        snprintf(line, sizeof line, "%u\n", ms);
        strcat(text, line);
    }
    write_trace(path, text);
    sim_link_desc desc = plain(1, 5000, 0);
    desc.way[SIM_UP].trace = path;
    sim_link *link = sim_link_create(&desc, 1);
    static uint8_t bytes[100000];
    uint64_t received = 0;
    for (int64_t now = 0; now <= (int64_t)ms * 3000 + 5001; now += 997) {
        (void)sim_link_send(link, SIM_UP, bytes, sizeof bytes, now);
        received += (uint64_t)sim_link_recv(link, SIM_UP, bytes, sizeof bytes, now);
    }
    uint64_t opportunities = received / SIM_TRACE_OPPORTUNITY_BYTES;
    assert_true(opportunities >= 3u * lines - 2 && opportunities <= 3u * lines + 1);
    sim_link_destroy(link);
    unlink(path);
}

static void bad_traces_are_refused(void **state)
{
    (void)state;
    static const char *const bad[] = { "",     "x\n", "5\n4\n", "-1\n", "99999999999999999999\n",
                                       "1 2\n" };
    sim_trace trace;
    char path[64];
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        write_trace(path, bad[i]);
        assert_int_equal(sim_trace_read(&trace, path), FF_ERR_FORMAT);
        unlink(path);
    }
    assert_int_equal(sim_trace_read(&trace, "/nonexistent/trace"), FF_ERR_NOT_FOUND);
    sim_link_desc desc = plain(1, 0, 0);
    desc.way[SIM_UP].trace = "/nonexistent/trace";
    assert_null(sim_link_create(&desc, 1));
    write_trace(path, "0\n");
    assert_int_equal(sim_trace_read(&trace, path), FF_OK);
    assert_int_equal(sim_trace_time_us(&trace, sim_trace_find(&trace, 12345600)), 12346000);
    sim_trace_free(&trace);
    unlink(path);
}

/* ---- any profile: bytes come whole, in order, the same for the same seed ---- */

typedef struct run_result {
    uint64_t hash, received;
} run_result;

static void mix(run_result *result, uint64_t value)
{
    result->hash = (result->hash ^ value) * 1099511628211u;
}

/* Sends a counting byte sequence both ways in bursts; `looks` extra receive calls with no capacity
 * must not change anything. */
static run_result run_profile(const sim_link_desc *desc, uint64_t seed, int looks)
{
    run_result result = { 14695981039346656037u, 0 };
    sim_link *link = sim_link_create(desc, seed);
    uint64_t sent[2] = { 0, 0 }, received[2] = { 0, 0 };
    uint8_t bytes[4096];
    for (int64_t step = 0; step < 6000; step++) {
        int64_t now = step * 10000;
        for (int way = 0; way < 2; way++) {
            size_t burst = step % 7 == way ? (size_t)(step * 37 % 900) : 0;
            for (size_t i = 0; i < burst; i++) bytes[i] = (uint8_t)((sent[way] + i) * 31 >> 3);
            sent[way] += (uint64_t)sim_link_send(link, way, bytes, burst, now);
            for (int look = 0; look < looks; look++)
                (void)sim_link_recv(link, way, bytes, 0, now + look * 1000);
        }
        for (int way = 0; way < 2; way++) {
            int got = sim_link_recv(link, way, bytes, sizeof bytes, now + 9000);
            for (int i = 0; i < got; i++)
                assert_int_equal(bytes[i], (uint8_t)((received[way] + (uint64_t)i) * 31 >> 3));
            received[way] += (uint64_t)got;
            mix(&result, (uint64_t)got << 32 | (uint64_t)step << 1 | (uint64_t)way);
        }
    }
    for (int way = 0; way < 2; way++) { /* an hour later everything is there */
        int got;
        while ((got = sim_link_recv(link, way, bytes, sizeof bytes, 3600 * SECOND)) > 0)
            received[way] += (uint64_t)got;
        assert_int_equal(received[way], sent[way]);
        result.received += received[way];
    }
    sim_link_destroy(link);
    return result;
}

static void every_profile_repeats_itself(void **state)
{
    (void)state;
    for (unsigned i = 0; sim_link_profile_at(i); i++) {
        const sim_link_desc *desc = sim_link_profile_at(i);
        assert_ptr_equal(sim_link_profile(desc->name), desc);
        assert_true(strlen(desc->source) > 0);
        run_result one = run_profile(desc, 7, 0), same = run_profile(desc, 7, 0),
                   looked = run_profile(desc, 7, 3);
        assert_true(one.received > 0);
        assert_int_equal(one.hash, same.hash);
        assert_int_equal(one.hash, looked.hash);
        if (desc->way[SIM_DOWN].jitter_us)
            assert_int_not_equal(one.hash, run_profile(desc, 8, 0).hash);
    }
    assert_null(sim_link_profile("carrier pigeon"));
}

static void links_are_parsed(void **state)
{
    (void)state;
    sim_link_desc desc;
    assert_int_equal(sim_link_parse("gprs,cut_every_ms=5000,down.bytes_s=10", &desc), FF_OK);
    assert_int_equal(desc.cut_every_ms, 5000);
    assert_int_equal(desc.way[SIM_DOWN].bytes_s, 10);
    assert_int_equal(desc.way[SIM_UP].bytes_s, sim_link_profile("gprs")->way[SIM_UP].bytes_s);
    assert_int_equal(sim_link_parse("", &desc), FF_ERR_NOT_FOUND);
    assert_int_equal(sim_link_parse("telex", &desc), FF_ERR_NOT_FOUND);
    assert_int_equal(sim_link_parse("gprs,speed=1", &desc), FF_ERR_ARGUMENT);
    assert_int_equal(sim_link_parse("gprs,connect_ms", &desc), FF_ERR_ARGUMENT);
    assert_int_equal(sim_link_parse("gprs,connect_ms=-1", &desc), FF_ERR_ARGUMENT);
    assert_int_equal(sim_link_parse("gprs,connect_ms=4294967296", &desc), FF_ERR_ARGUMENT);
}

/* ---- cuts ---- */

static void a_cut_is_reconnected(void **state)
{
    (void)state;
    sim_link_desc desc = plain(1000, 100000, 0);
    desc.cut_every_ms = 10000;
    desc.connect_ms = 500;
    sim_link *link = sim_link_create(&desc, 11);
    int64_t now = 0, up_since = 0;
    uint8_t bytes[256] = { 0 };
    assert_int_equal(sim_link_connections(link), 1);
    for (unsigned cut = 0; cut < 50; cut++) {
        while (sim_link_send(link, SIM_UP, bytes, 1, now) >= 0) now += 1000;
        assert_in_range(now - up_since, 5 * SECOND, 15 * SECOND + 1000);
        assert_int_equal(sim_link_recv(link, SIM_DOWN, bytes, sizeof bytes, now), FF_ERR_CLOSED);
        assert_int_equal(sim_link_reconnect(link, now), FF_ERR_AGAIN);
        assert_int_equal(sim_link_send(link, SIM_UP, bytes, 1, now + 400000), FF_ERR_CLOSED);
        assert_int_equal(sim_link_reconnect(link, now + 499999), FF_ERR_AGAIN);
        assert_int_equal(sim_link_next_us(link), now + 500000);
        up_since = now += 500000;
        assert_int_equal(sim_link_reconnect(link, now), FF_OK);
        assert_int_equal(sim_link_connections(link), cut + 2);
        /* bytes under way are lost */
        assert_int_equal(sim_link_recv(link, SIM_UP, bytes, sizeof bytes, now), 0);
    }
    sim_link_destroy(link);
}

/* When a link changes, the bytes under way arrive in order and whole, at the new rate and delay;
 * the queue may grow and shrink; a stall ends. */
static void a_changed_link_loses_nothing(void **state)
{
    (void)state;
    sim_link_desc slow = plain(100, 1000, 0), fast = plain(10000, 5000, 0),
                  narrow = plain(10000, 5000, 0);
    slow.way[SIM_DOWN].queue_bytes = 2000;
    slow.stall_every_ms = 1;
    slow.stall_ms_min = slow.stall_ms_max = 1000000;
    fast.way[SIM_DOWN].queue_bytes = 1 << 22;
    narrow.way[SIM_DOWN].queue_bytes = 10;
    static uint8_t sent[10000], got[10000];
    for (size_t i = 0; i < sizeof sent; i++) sent[i] = (uint8_t)(i * 7 + i / 256);
    sim_link *link = sim_link_create(&slow, 1);
    assert_int_equal(sim_link_send(link, SIM_DOWN, sent, sizeof sent, 0), 2000);
    /* stalled */
    assert_int_equal(sim_link_recv(link, SIM_DOWN, got, sizeof got, 100 * SECOND), 0);
    assert_int_equal(sim_link_change(link, &fast, 100 * SECOND), FF_OK);
    assert_int_equal(sim_link_send(link, SIM_DOWN, sent + 2000, sizeof sent - 2000, 100 * SECOND),
                     8000);
    assert_int_equal(sim_link_change(link, &narrow, 100 * SECOND), FF_OK);
    /* more bytes wait than the new queue holds */
    assert_int_equal(sim_link_room(link, SIM_DOWN, 100 * SECOND), 0);
    /* whole packets of 512 */
    assert_int_equal(sim_link_recv(link, SIM_DOWN, got, sizeof got, 101 * SECOND + 4999), 9728);
    assert_int_equal(
        sim_link_recv(link, SIM_DOWN, got + 9728, sizeof got - 9728, 101 * SECOND + 5000), 272);
    assert_memory_equal(sent, got, sizeof sent);
    assert_int_equal(sim_link_room(link, SIM_DOWN, 102 * SECOND), 10);
    sim_link_destroy(link);
}

static void streams_carry_bytes_both_ways(void **state)
{
    (void)state;
    sim_link_desc desc = plain(0, 50000, 0);
    sim_link *link = sim_link_create(&desc, 1);
    int64_t now = 0;
    sim_stream client_end, server_end;
    sys_stream client, server;
    uint8_t bytes[16];
    sim_stream_client(&client_end, link, &now, &client);
    sim_stream_server(&server_end, link, &now, &server);
    assert_int_equal(client.send(client.state, (const uint8_t *)"up", 2), 2);
    assert_int_equal(server.send(server.state, (const uint8_t *)"down", 4), 4);
    now = 50000;
    assert_int_equal(server.recv(server.state, bytes, sizeof bytes), 2);
    assert_memory_equal(bytes, "up", 2);
    assert_int_equal(client.recv(client.state, bytes, sizeof bytes), 4);
    assert_memory_equal(bytes, "down", 4);
    client.close(client.state);
    assert_int_equal(server.recv(server.state, bytes, sizeof bytes), FF_ERR_CLOSED);
    assert_int_equal(client.reconnect(client.state), FF_OK); /* connect_ms 0 */
    assert_null(server.reconnect);
    assert_int_equal(client_end.bytes_sent, 2);
    assert_int_equal(client_end.bytes_received, 4);
    sim_link_destroy(link);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_rate_is_exact),
        cmocka_unit_test(rounding_does_not_drift),
        cmocka_unit_test(delay_and_jitter_are_as_described),
        cmocka_unit_test(a_full_queue_takes_no_more),
        cmocka_unit_test(stalls_are_as_described),
        cmocka_unit_test(a_stall_lets_its_rate_through),
        cmocka_unit_test(a_trace_is_replayed),
        cmocka_unit_test(a_trace_s_rate_is_its_packets),
        cmocka_unit_test(bad_traces_are_refused),
        cmocka_unit_test(every_profile_repeats_itself),
        cmocka_unit_test(links_are_parsed),
        cmocka_unit_test(a_cut_is_reconnected),
        cmocka_unit_test(a_changed_link_loses_nothing),
        cmocka_unit_test(streams_carry_bytes_both_ways),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
