/* The real server in several processes: they are killed, stopped, crowded, and sent nonsense. Waits
 * are bounded in tries, never in time. */
#include "../rig/server_harness.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <signal.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#define CLIENTS_MAX 64
#define CROWD       200

static harness_server server;

static int start(void **state)
{
    (void)state;
    return !harness_start(
        &server, "--workers 2 --renderers 2 --render-timeout 2 --panoramas-per-minute 6000");
}

static int stop(void **state)
{
    (void)state;
    return harness_stop(&server) != 0;
}

/* A child that serves none of the clients: a renderer, when the clients keep every worker busy. */
static pid_t some_child_without(const harness_client *const *clients, int count)
{
    pid_t child[HARNESS_CHILDREN_MAX], found = 0;
    int children = harness_children(&server, child);
    for (int i = 0; i < children; i++) {
        int serves = 0;
        for (int c = 0; c < count; c++)
            serves |= harness_served_by(&server, clients[c]) == child[i];
        if (!serves) found = child[i];
    }
    return found;
}

/* Connects until each worker has at least one client; count. */
static int occupy_both_workers(harness_client *clients[CLIENTS_MAX])
{
    pid_t first = 0;
    for (int count = 0; count < CLIENTS_MAX;) {
        clients[count] = harness_connect(&server, 1);
        assert_non_null(clients[count]);
        pid_t by = harness_served_by(&server, clients[count++]);
        assert_true(by > 0);
        if (count == 1) first = by;
        if (by != first) return count;
    }
    return 0;
}

static void close_all(harness_client **clients, int count)
{
    for (int i = 0; i < count; i++) harness_close(clients[i]);
}

static void nodes_and_panoramas_come(void **state)
{
    (void)state;
    harness_client *client = harness_connect(&server, 1);
    assert_non_null(client);
    for (uint16_t id = 1; id <= 50; id++) assert_true(harness_root_comes(client, id));
    assert_int_equal(harness_panorama_comes(client, 51), 1);
    assert_int_equal(harness_panorama_comes(client, 52), 1);
    harness_close(client);
}

static void far_sets_come_sector_by_sector(void **state)
{
    (void)state;
    static const uint8_t wanted[] = { 0, 2, 8 };
    ff_message message = { .type = FF_MSG_GET, .kind = FF_KIND_FAR };
    message.u.get_far = (ff_get_far){ .id = 9,
                                      .position_wu = { 500000, 300000, 500000 },
                                      .front_wu = 100000,
                                      .focal = 64,
                                      .down = 64,
                                      .quality = 40,
                                      .tolerance_q2 = 4,
                                      .sector_count = sizeof wanted,
                                      .sector = { 0, 2, 8 } };
    harness_client *client = harness_connect(&server, 1);
    assert_non_null(client);
    assert_true(harness_tell(client, &message));
    for (size_t i = 0; i < sizeof wanted; i++) {
        assert_int_equal(harness_hear(client, &message), 1);
        assert_int_equal(message.type, FF_MSG_ANSWER);
        assert_int_equal(message.kind, FF_KIND_FAR);
        assert_int_equal(message.u.far.sector, wanted[i]);
        assert_int_equal((message.u.far.flags & FF_FACE_LAST) != 0, i + 1 == sizeof wanted);
        if (i == 0) assert_true(message.u.far.blocks_x > 0);
    }
    harness_close(client);
}

static void killed_worker_is_replaced_and_others_go_on(void **state)
{
    (void)state;
    harness_client *clients[CLIENTS_MAX];
    ff_message message;
    int count = occupy_both_workers(clients);
    assert_true(count > 1);
    pid_t victim = harness_served_by(&server, clients[0]);
    pid_t survivor = harness_served_by(&server, clients[count - 1]);
    assert_int_equal(kill(victim, SIGKILL), 0);
    for (int i = 0; i < count - 1; i++) {
        assert_int_equal(harness_hear(clients[i], &message), 0);
        assert_true(harness_root_comes(clients[count - 1], (uint16_t)(i + 1)));
    }
    assert_true(harness_wait_children(&server, 4, victim));
    assert_int_equal(harness_served_by(&server, clients[count - 1]), survivor);
    assert_int_equal(harness_panorama_comes(clients[count - 1], 77), 1);
    close_all(clients, count);
    /* The new worker serves nodes, and faces through the channels it inherited. */
    count = occupy_both_workers(clients);
    assert_true(count > 1);
    for (int i = 0; i < count; i++) {
        assert_true(harness_root_comes(clients[i], 5));
        assert_int_equal(harness_panorama_comes(clients[i], 6), 1);
    }
    close_all(clients, count);
}

static void killed_renderers_cost_their_panorama_only(void **state)
{
    (void)state;
    harness_client *clients[CLIENTS_MAX];
    int count = occupy_both_workers(clients), good = 0;
    assert_true(count > 1);
    for (int round = 0; round < 3; round++) {
        pid_t victim = some_child_without((const harness_client *const *)clients, count);
        assert_true(victim > 0);
        kill(victim, SIGKILL);
        for (int i = 0; i < count; i++) {
            assert_true(harness_panorama_comes(clients[i], (uint16_t)(100 + i)) >= 0);
            assert_true(harness_root_comes(clients[i], (uint16_t)(200 + i)));
        }
        assert_true(harness_wait_children(&server, 4, victim));
    }
    for (int tries = 0; tries < 20 && !good; tries++)
        good = harness_panorama_comes(clients[0], (uint16_t)(300 + tries)) == 1;
    assert_true(good);
    close_all(clients, count);
}

/* A renderer is killed while it draws: its panorama fails long before the timeout, and another
 * renderer draws the next. */
static void panorama_of_a_killed_renderer_fails_at_once(void **state)
{
    (void)state;
    pid_t child[HARNESS_CHILDREN_MAX];
    ff_message message = { .type = FF_MSG_GET, .kind = FF_KIND_FACE };
    message.u.panorama = (ff_get_panorama){ .id = 1,
                                            .position_wu = { 500000, 500000, 400000 },
                                            .front_wu = 50000,
                                            .back_wu = 10000000,
                                            .face_size = FF_FACE_SIZE_MAX,
                                            .quality = 100,
                                            .face_count = 4,
                                            .face = { 0, 1, 2, 3 } };
    assert_true(harness_start(
        &server, "--workers 1 --renderers 1 --render-timeout 20 --panoramas-per-minute 6000"));
    harness_client *client = harness_connect(&server, 1);
    assert_non_null(client);
    assert_int_equal(harness_children(&server, child), 2);
    pid_t worker = harness_served_by(&server, client),
          renderer = child[0] == worker ? child[1] : child[0];
    int failed = 0;
    /* now and then the kill falls between two faces: the renderer's successor draws the rest */
    for (uint16_t id = 1; id < 50 && !failed; id++) {
        message.type = FF_MSG_GET;
        message.kind = FF_KIND_FACE;
        message.u.panorama.id = id;
        ff_get_panorama again = message.u.panorama;
        assert_true(harness_tell(client, &message));
        /* the first face is here, so the renderer now draws the second */
        assert_int_equal(harness_hear(client, &message), 1);
        kill(renderer, SIGKILL);
        while (message.type == FF_MSG_ANSWER && !(message.u.face.flags & FF_FACE_LAST))
            assert_int_equal(harness_hear(client, &message), 1);
        failed = message.type == FF_MSG_FAILED && message.u.failed.error == FF_ERR_SYSTEM;
        assert_true(message.type == FF_MSG_FAILED || message.type == FF_MSG_ANSWER);
        assert_true(harness_wait_children(&server, 2, renderer));
        assert_int_equal(harness_children(&server, child), 2);
        renderer = child[0] == worker ? child[1] : child[0];
        message.u.panorama = again;
    }
    assert_true(failed);
    assert_int_equal(harness_panorama_comes(client, 99), 1);
    harness_close(client);
    assert_int_equal(harness_stop(&server), 0);
}

static void nonsense_closes_its_own_connection_only(void **state)
{
    (void)state;
    static const char *const nonsense[] = { "GET / HTTP/1.1\r\nHost: x\r\n\r\n", "\x16\x03\x01\x02",
                                            "\x02\xff\xff\xff\xff\xff", "\x05\x02xx" };
    harness_client *good = harness_connect(&server, 1);
    assert_non_null(good);
    for (size_t i = 0; i < sizeof nonsense / sizeof *nonsense; i++) {
        harness_client *bad = harness_connect(&server, 0);
        ff_message message;
        assert_non_null(bad);
        assert_true(harness_send(bad, nonsense[i], strlen(nonsense[i])));
        assert_int_equal(harness_hear(bad, &message), 1);
        assert_int_equal(message.type, FF_MSG_GOODBYE);
        assert_int_equal(harness_hear(bad, &message), 0);
        harness_close(bad);
        assert_true(harness_root_comes(good, (uint16_t)i));
    }
    harness_close(good);
}

static void a_crowd_is_served(void **state)
{
    (void)state;
    static harness_client *crowd[CROWD];
    /* every tenth stops in the middle of a message */
    static const uint8_t half[3] = { 2, 5, 1 }; /* GET_NODE */
    for (int i = 0; i < CROWD; i++) {
        crowd[i] = harness_connect(&server, 1);
        assert_non_null(crowd[i]);
        if (i % 10 == 0) assert_true(harness_send(crowd[i], half, sizeof half));
    }
    for (int i = 0; i < CROWD; i++)
        if (i % 10) assert_true(harness_root_comes(crowd[i], (uint16_t)i));
    for (int i = 1; i < CROWD; i += 40) assert_int_equal(harness_panorama_comes(crowd[i], 9), 1);
    close_all(crowd, CROWD);
}

/* A client that asks for much and never reads must not hold up anybody. */
static void a_reader_that_does_not_read(void **state)
{
    (void)state;
    harness_client *deaf = harness_connect(&server, 1), *good = harness_connect(&server, 1);
    ff_message get = { .type = FF_MSG_GET, .kind = FF_KIND_ROOT, .u.get = { 0 } };
    assert_non_null(deaf);
    assert_non_null(good);
    for (int i = 0; i < 3000; i++) assert_true(harness_tell(deaf, &get));
    assert_true(harness_root_comes(good, 1));
    assert_int_equal(harness_panorama_comes(good, 2), 1);
    harness_close(deaf);
    harness_close(good);
}

/* A pack is cut short under the server: a worker dies and says why, another takes its place, and
 * the rest of the pack is still served. */
static void truncated_pack_is_survived(void **state)
{
    (void)state;
    struct stat whole;
    ff_message message = { .type = FF_MSG_GET,
                           .kind = FF_KIND_REFINEMENT,
                           .u.get = { ff_key_make(3, 2, 15) } };
    harness_client *client = harness_connect(&server, 1);
    assert_non_null(client);
    pid_t victim = harness_served_by(&server, client);
    assert_int_equal(stat(server.pack_path, &whole), 0);
    assert_true(whole.st_size > 3 * 4096);
    assert_int_equal(truncate(server.pack_path, 2 * 4096), 0);
    assert_true(harness_tell(client, &message));
    assert_int_equal(harness_hear(client, &message), 0);
    harness_close(client);
    assert_true(harness_wait_children(&server, 4, victim));
    client = harness_connect(&server, 1);
    assert_non_null(client);
    assert_true(harness_root_comes(client, 1));
    harness_close(client);
}

static void stop_leaves_no_process_and_says_goodbye(void **state)
{
    (void)state;
    pid_t child[HARNESS_CHILDREN_MAX];
    ff_message message;
    assert_true(harness_start(&server, "--workers 2 --renderers 1"));
    harness_client *client = harness_connect(&server, 1);
    int count = harness_children(&server, child);
    assert_non_null(client);
    assert_int_equal(count, 3);
    assert_int_equal(kill(server.pid, SIGTERM), 0);
    assert_int_equal(harness_hear(client, &message), 1);
    assert_int_equal(message.type, FF_MSG_GOODBYE);
    harness_close(client);
    assert_int_equal(harness_stop(&server), 0);
    for (int i = 0; i < count; i++) assert_true(harness_gone(child[i]));
}

static void children_die_with_a_killed_master(void **state)
{
    (void)state;
    pid_t child[HARNESS_CHILDREN_MAX];
    assert_true(harness_start(&server, "--workers 2 --renderers 1"));
    int count = harness_children(&server, child);
    assert_int_equal(count, 3);
    assert_int_equal(kill(server.pid, SIGKILL), 0);
    assert_int_equal(harness_stop(&server), -2);
    for (int i = 0; i < count; i++) assert_true(harness_gone(child[i]));
}

static void idle_clients_are_sent_away(void **state)
{
    (void)state;
    static const uint8_t half[2] = { FF_MSG_PING, 4 };
    ff_message message;
    assert_true(harness_start(&server, "--workers 1 --renderers 0 --idle 1"));
    harness_client *client = harness_connect(&server, 1);
    assert_non_null(client);
    assert_true(harness_send(client, half, sizeof half));
    assert_int_equal(harness_hear(client, &message), 1);
    assert_int_equal(message.type, FF_MSG_GOODBYE);
    assert_int_equal(message.u.failed.error, FF_ERR_CLOSED);
    harness_close(client);
    /* Without renderers a panorama fails, and the client is told. */
    client = harness_connect(&server, 1);
    assert_non_null(client);
    assert_int_equal(harness_panorama_comes(client, 1), 0);
    harness_close(client);
    assert_int_equal(harness_stop(&server), 0);
}

static void single_process_serves_too(void **state)
{
    (void)state;
    pid_t child[HARNESS_CHILDREN_MAX];
    assert_true(harness_start(&server, "--single"));
    harness_client *client = harness_connect(&server, 1);
    assert_non_null(client);
    assert_int_equal(harness_children(&server, child), 0);
    assert_true(harness_root_comes(client, 1));
    assert_int_equal(harness_panorama_comes(client, 2), 1);
    harness_close(client);
    assert_int_equal(harness_stop(&server), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(nodes_and_panoramas_come, start, stop),
        cmocka_unit_test_setup_teardown(far_sets_come_sector_by_sector, start, stop),
        cmocka_unit_test_setup_teardown(killed_worker_is_replaced_and_others_go_on, start, stop),
        cmocka_unit_test_setup_teardown(killed_renderers_cost_their_panorama_only, start, stop),
        cmocka_unit_test_setup_teardown(nonsense_closes_its_own_connection_only, start, stop),
        cmocka_unit_test_setup_teardown(a_crowd_is_served, start, stop),
        cmocka_unit_test_setup_teardown(a_reader_that_does_not_read, start, stop),
        cmocka_unit_test_setup_teardown(truncated_pack_is_survived, start, stop),
        cmocka_unit_test(panorama_of_a_killed_renderer_fails_at_once),
        cmocka_unit_test(stop_leaves_no_process_and_says_goodbye),
        cmocka_unit_test(children_die_with_a_killed_master),
        cmocka_unit_test(idle_clients_are_sent_away),
        cmocka_unit_test(single_process_serves_too),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
