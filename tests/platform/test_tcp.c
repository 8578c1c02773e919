/* TCP streams of the Common System API: partial sends, refusal, peers that vanish, reconnection,
 * addresses. */
#include "../../platform/sys.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <stdio.h>
#include <string.h>
#include <unistd.h>

typedef struct pair {
    int listener;
    sys_tcp client, peer;
    sys_stream out, in; /* the client's and the peer's ends */
} pair;

static const char *local_address(char text[32], const char *host, uint16_t port)
{
    snprintf(text, 32, "%s:%u", host, port);
    return text;
}

static int accept_soon(int listener)
{
    int fd = FF_ERR_AGAIN;
    for (int i = 0; i < 5000 && fd == FF_ERR_AGAIN; i++) {
        fd = sys_tcp_accept(listener);
        if (fd == FF_ERR_AGAIN) sys_sleep_us(1000);
    }
    return fd;
}

static int reconnect_soon(sys_stream *stream)
{
    int rc = FF_ERR_AGAIN;
    for (int i = 0; i < 5000 && rc == FF_ERR_AGAIN; i++) {
        rc = stream->reconnect(stream->state);
        if (rc == FF_ERR_AGAIN) sys_sleep_us(1000);
    }
    return rc;
}

/* Receives and throws bytes away until recv answers anything but 0 ("nothing yet"). */
static int recv_soon(sys_stream *stream, uint8_t *bytes, size_t capacity)
{
    int got = 0;
    for (int i = 0; i < 5000 && got == 0; i++) {
        got = stream->recv(stream->state, bytes, capacity);
        if (got == 0) sys_sleep_us(1000);
    }
    return got;
}

static void open_pair(pair *p)
{
    char text[32];
    uint16_t port = 0;
    p->listener = sys_tcp_listen("127.0.0.1:0", 1, &port);
    assert_true(p->listener >= 0 && port != 0);
    assert_int_equal(sys_tcp_accept(p->listener), FF_ERR_AGAIN);
    assert_int_equal(sys_tcp_client(&p->client, local_address(text, "127.0.0.1", port), &p->out),
                     FF_OK);
    int fd = accept_soon(p->listener);
    assert_true(fd >= 0);
    sys_tcp_adopt(&p->peer, fd, &p->in);
    assert_null(p->in.reconnect);
    assert_int_equal(reconnect_soon(&p->out), FF_OK);
}

static void close_pair(pair *p)
{
    p->out.close(p->out.state);
    p->in.close(p->in.state);
    close(p->listener);
}

static void bytes_go_both_ways(void **state)
{
    (void)state;
    pair p;
    uint8_t bytes[8];
    open_pair(&p);
    assert_int_equal(p.in.recv(p.in.state, bytes, 8), 0);
    assert_int_equal(p.out.send(p.out.state, (const uint8_t *)"hello", 5), 5);
    assert_int_equal(recv_soon(&p.in, bytes, 8), 5);
    assert_memory_equal(bytes, "hello", 5);
    assert_int_equal(p.in.send(p.in.state, (const uint8_t *)"yes", 3), 3);
    assert_int_equal(p.out.recv(p.out.state, bytes, 0), 0);
    assert_int_equal(recv_soon(&p.out, bytes, 8), 3);
    close_pair(&p);
}

static void a_slow_reader_makes_sends_partial(void **state)
{
    (void)state;
    pair p;
    static uint8_t block[1 << 20], back[1 << 16];
    uint64_t sent = 0, received = 0;
    uint32_t sum_out = 0, sum_in = 0;
    sys_random random;
    sys_random_seed(&random, 5, 5);
    for (size_t i = 0; i < sizeof block; i++) block[i] = (uint8_t)sys_random_u32(&random);
    open_pair(&p);
    int partial = 0, taken;
    do {
        taken = p.out.send(p.out.state, block, sizeof block);
        assert_true(taken >= 0);
        for (int i = 0; i < taken; i++) sum_out = sum_out * 31 + block[i];
        sent += (uint64_t)taken;
        if (taken > 0 && taken < (int)sizeof block) partial = 1;
    } while (taken > 0);
    assert_true(partial);
    p.out.close(p.out.state); /* the bytes that send took still arrive, then the end */
    int got;
    while ((got = recv_soon(&p.in, back, sizeof back)) > 0) {
        for (int i = 0; i < got; i++) sum_in = sum_in * 31 + back[i];
        received += (uint64_t)got;
    }
    assert_int_equal(got, FF_ERR_CLOSED);
    assert_true(sent == received);
    assert_int_equal(sum_out, sum_in);
    close_pair(&p);
}

static void a_vanished_peer_is_closed_and_reconnects(void **state)
{
    (void)state;
    pair p;
    uint8_t bytes[4] = { 1, 2, 3, 4 };
    open_pair(&p);
    p.in.close(p.in.state);
    assert_int_equal(recv_soon(&p.out, bytes, 4), FF_ERR_CLOSED);
    assert_int_equal(p.out.recv(p.out.state, bytes, 4), FF_ERR_CLOSED);
    assert_int_equal(p.out.send(p.out.state, bytes, 4), FF_ERR_CLOSED); /* and no SIGPIPE */
    assert_int_equal(reconnect_soon(&p.out), FF_OK);
    int fd = accept_soon(p.listener);
    assert_true(fd >= 0);
    sys_tcp_adopt(&p.peer, fd, &p.in);
    assert_int_equal(p.out.send(p.out.state, bytes, 4), 4);
    assert_int_equal(recv_soon(&p.in, bytes, 4), 4);
    assert_int_equal(p.in.send(p.in.state, bytes, 4), 4);
    assert_int_equal(recv_soon(&p.out, bytes, 4), 4);
    /* The client's own decision: close, and connect anew. */
    p.out.close(p.out.state);
    assert_int_equal(recv_soon(&p.in, bytes, 4), FF_ERR_CLOSED);
    assert_int_equal(reconnect_soon(&p.out), FF_OK);
    close_pair(&p);
}

static void sending_to_a_vanished_peer_ends(void **state)
{
    (void)state;
    pair p;
    uint8_t bytes[256] = { 0 };
    open_pair(&p);
    p.in.close(p.in.state);
    int rc = 0;
    for (int i = 0; i < 5000 && rc >= 0; i++) {
        rc = p.out.send(p.out.state, bytes, sizeof bytes);
        sys_sleep_us(100);
    }
    assert_int_equal(rc, FF_ERR_CLOSED);
    close_pair(&p);
}

static void a_refused_connection_is_closed(void **state)
{
    (void)state;
    char text[32];
    uint16_t port = 0;
    sys_tcp tcp;
    sys_stream stream;
    uint8_t byte;
    int listener = sys_tcp_listen("127.0.0.1:0", 0, &port);
    assert_true(listener >= 0);
    close(listener);
    assert_int_equal(sys_tcp_client(&tcp, local_address(text, "127.0.0.1", port), &stream), FF_OK);
    assert_int_equal(recv_soon(&stream, &byte, 1), FF_ERR_CLOSED);
    assert_true(reconnect_soon(&stream) < 0);
    assert_int_equal(stream.send(stream.state, &byte, 1), FF_ERR_CLOSED);
    stream.close(stream.state);
}

static void ports_are_shared_only_when_asked(void **state)
{
    (void)state;
    char text[32];
    uint16_t port = 0, same = 0;
    int first = sys_tcp_listen("127.0.0.1:0", 1, &port);
    local_address(text, "127.0.0.1", port);
    int second = sys_tcp_listen(text, 1, &same);
    assert_true(first >= 0 && second >= 0);
    assert_int_equal(port, same);
    assert_int_equal(sys_tcp_listen(text, 0, &same), FF_ERR_SYSTEM);
    close(first);
    close(second);
}

static void ipv6_addresses_have_brackets(void **state)
{
    (void)state;
    char text[32];
    uint16_t port = 0;
    sys_tcp tcp;
    sys_stream stream;
    int listener = sys_tcp_listen("[::1]:0", 0, &port);
    if (listener < 0) skip(); /* a machine without IPv6 */
    assert_int_equal(sys_tcp_client(&tcp, local_address(text, "[::1]", port), &stream), FF_OK);
    assert_int_equal(reconnect_soon(&stream), FF_OK);
    stream.close(stream.state);
    close(listener);
}

static void bad_addresses_are_told(void **state)
{
    (void)state;
    static const char *const bad[] = { "",           "host",        ":",      "host:",   "host:x",
                                       "host:65536", "host:123456", "::1:80", "[::1:80", "[]:80",
                                       "host:-1",    "host: 1",     ":80" };
    sys_tcp tcp;
    sys_stream stream;
    uint16_t port;
    char endless[400];
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(sys_tcp_client(&tcp, bad[i], &stream), FF_ERR_ARGUMENT);
    memset(endless, 'a', sizeof endless);
    memcpy(endless + sizeof endless - 4, ":80", 4);
    assert_int_equal(sys_tcp_client(&tcp, endless, &stream), FF_ERR_ARGUMENT);
    assert_int_equal(sys_tcp_listen("nonsense", 0, &port), FF_ERR_ARGUMENT);
    /* not an address of ours */
    assert_int_equal(sys_tcp_listen("192.0.2.1:0", 0, &port), FF_ERR_SYSTEM);
    int any = sys_tcp_listen(":0", 0, &port);
    assert_true(any >= 0);
    close(any);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bytes_go_both_ways),
        cmocka_unit_test(a_slow_reader_makes_sends_partial),
        cmocka_unit_test(a_vanished_peer_is_closed_and_reconnects),
        cmocka_unit_test(sending_to_a_vanished_peer_ends),
        cmocka_unit_test(a_refused_connection_is_closed),
        cmocka_unit_test(ports_are_shared_only_when_asked),
        cmocka_unit_test(ipv6_addresses_have_brackets),
        cmocka_unit_test(bad_addresses_are_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
