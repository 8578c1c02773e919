/* Real links as constants. `source` and the comments name:
 *   Hybrid       Noguera, Segura, Ogayar, Joan-Arinyo 2010, section 9.4: GPRS and UMTS as they
 *                measured them
 *   C&P          Chakravorty, Pratt: Performance issues with general packet radio service, J. of
 *                Communications and Networks 4(4), 2002, doi 10.1109/JCN.2002.6596651; with
 *                Cartwright: Practical experience with TCP over GPRS, IEEE Globecom 2002
 *   ARCchart     report of September 2009 on millions of speed tests from phones, as told in
 *                wirevolution.com/2009/10/01/3g-network-performance-test-results-blackberries-awful
 *   45.002/.003  3GPP TS 45.002 table B.1: multislot class 10, the usual one, receives on 4 slots
 *                and sends on 2, 5 at once; TS 45.003: 9.05 kbit/s a slot with coding scheme CS-1
 *   Sprout       Winstein, Sivaraman, Balakrishnan: Stochastic forecasts achieve high throughput
 *                and low delay over cellular networks, NSDI 2013: 3G and LTE gateways build up
 *                queues of several seconds
 *   tcp(7)       Linux: a socket's send buffer is 16 kB by default (tcp_wmem)
 *   Release 13   3GPP's categories M1 and NB1: peak rates of half-duplex devices
 *   Arduino      docs.arduino.cc, Cat.M1 and NB-IoT with the Portenta: Cat-M1 has a latency of 50
 *                to 100 ms
 *   Ugwuanyi     Ugwuanyi, Paul, Irvine: Survey of IoT for developing countries, Electronics 10(18)
 *                2224, 2021: NB-IoT measured
 *   FFI          Berg, Mjelde: Iridium Certus IP performance in the Arctic, FFI-Report 20/01338,
 *                2020, hdl.handle.net/20.500.12242/2717
 * What has no source says "assumed", and why. A round trip R with spread S is split evenly: each
 * way half of the smallest R and up to half of S on top, uniform. connect_ms is a TCP handshake:
 * one round trip. header_bytes: IPv4 and TCP without options, 20 each (RFC 791, 9293); operators
 * that compress headers on the air take less.
 */
#include "sim_link.h"

#include <errno.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* clang-format off */
static const sim_link_desc profile[] = {
    {
        .name = "gprs",
        .source = "Hybrid 9.4; Chakravorty & Pratt 2002; 3GPP TS 45.002 and 45.003",
        .way = {
            /* Hybrid: best TCP rate down, 5.5 kB/s (ARCchart's mean: 50 kbit/s) */
            [SIM_DOWN] = { .bytes_s = 5500,
                           /* C&P: round trips of 600 ms to more than 1000 ms */
                           .delay_us = 300000,
                           .jitter_us = 200000,
                           /* C&P: round trips grow to tens of seconds; 20 s at 5.5 kB/s */
                           .queue_bytes = 110000 },
            /* 45.002/.003: two slots of CS-1, 2 * 9.05 kbit/s */
            [SIM_UP] = { .bytes_s = 2262,
                         .delay_us = 300000, .jitter_us = 200000,
                         .queue_bytes = 16384 },   /* tcp(7) */
        },
        /* assumed, on the hard side: Hybrid shows stalls in two of its 14 flights (figures 43 and
         * 48), C&P tell lengths only; so every flight of 300 s meets one or two */
        .stall_every_ms = 120000,
        .stall_ms_min = 4000,     /* C&P: 4 to 40 s, also standing still; Hybrid saw up to 30 s */
        .stall_ms_max = 40000,
        .stall_bytes_s = 5,       /* Hybrid: "a few bytes per second" */
        .header_bytes = 40,
        .connect_ms = 1000,
    },
    {
        .name = "edge",
        .source = "ARCchart 2009; 3GPP TS 45.002",
        .way = {
            [SIM_DOWN] = { .bytes_s = 20000,       /* ARCchart: 160 kbit/s */
                           .delay_us = 100000,     /* ARCchart: round trips of 200 to 600 ms */
                           .jitter_us = 200000,
                           /* assumed: 3 s, of the several seconds of Sprout's 3G */
                           .queue_bytes = 65536 },
            [SIM_UP] = { .bytes_s = 10000,         /* 45.002: two slots of the way down's four */
                         /* tcp(7) */
                         .delay_us = 100000, .jitter_us = 200000, .queue_bytes = 16384 },
        },
        .header_bytes = 40,
        .connect_ms = 400,
    },
    {
        .name = "umts",
        .source = "ARCchart 2009; Hybrid 9.4",
        .way = {
            /* 384 kbit/s, the bearer of release 99 in Hybrid's year (ARCchart's mean: 1 Mbit/s) */
            [SIM_DOWN] = { .bytes_s = 48000,
                           /* ARCchart: 336 ms round trip in the mean; jitter of 40 ms assumed, 20
                            * in the mean */
                           .delay_us = 148000,
                           .jitter_us = 40000,
                           /* assumed: 1.4 s, at the lower end of Sprout's queues */
                           .queue_bytes = 65536 },
            /* 64 kbit/s, the bearer that goes with 384 down (ARCchart's means: 62 to 155 kbit/s) */
            [SIM_UP] = { .bytes_s = 8000,
                         /* tcp(7) */
                         .delay_us = 148000, .jitter_us = 40000, .queue_bytes = 16384 },
        },
        .header_bytes = 40,
        .connect_ms = 336,                         /* Hybrid saw no stalls on UMTS */
    },
    {
        .name = "ltem",
        .source = "3GPP release 13, category M1 half duplex: peak rates 300 / 375 kbit/s; "
                  "latency 50 to 100 ms (Arduino)",
        .way = {
            /* assumed queue: 1.7 s */
            [SIM_DOWN] = { .bytes_s = 37500,
                           .delay_us = 25000,
                           .jitter_us = 25000,
                           .queue_bytes = 65536 },
            /* tcp(7) */
            [SIM_UP] = { .bytes_s = 46875,
                         .delay_us = 25000,
                         .jitter_us = 25000,
                         .queue_bytes = 16384 },
        },
        .header_bytes = 40,
        .connect_ms = 100,
    },
    {
        .name = "nbiot",
        .source = "3GPP release 13, category NB1: peak rates 26.15 / 62.5 kbit/s; "
                  "latency 1.6 to 10 s (3GPP TR 45.820's goal)",
        .way = { /* the hard side: Ugwuanyi measured 837 ms in good coverage */
            /* assumed: 20 s, as GPRS */
            [SIM_DOWN] = { .bytes_s = 3268,
                           .delay_us = 800000,
                           .jitter_us = 4200000,
                           .queue_bytes = 65536 },
            /* tcp(7) */
            [SIM_UP] = { .bytes_s = 7812,
                         .delay_us = 800000,
                         .jitter_us = 4200000,
                         .queue_bytes = 16384 },
        },
        .header_bytes = 40,
        .connect_ms = 1600,
    },
    {
        .name = "iridium",
        .source = "Iridium Certus midband (class 100): 88 kbit/s down, 22 up; FFI 20/01338",
        .way = {
            /* 88 kbit/s (Certus 350, for ships: 352, reached in 45 % of FFI's experiments) */
            [SIM_DOWN] = { .bytes_s = 11000,
                           /* assumed: 600 to 800 ms round trip; several satellites, then one of few
                            * gateways */
                           .delay_us = 300000,
                           .jitter_us = 100000,
                           .queue_bytes = 65536 }, /* assumed: 6 s, as Sprout's queues */
            [SIM_UP] = { .bytes_s = 2750,          /* 22 kbit/s */
                         /* tcp(7) */
                         .delay_us = 300000, .jitter_us = 100000, .queue_bytes = 16384 },
        },
        /* assumed: FFI says frequent, without a number; one in a flight of 300 s */
        .stall_every_ms = 300000,
        .stall_ms_min = 2000,     /* assumed: shorter ones do not show beside the round trip */
        .stall_ms_max = 70000,    /* FFI: "up to 70 seconds" in which no packet is served */
        .stall_bytes_s = 0,
        .header_bytes = 40,
        .connect_ms = 800,
    },
    {
        .name = "lan",
        .source = "100 Mbit/s Ethernet (IEEE 802.3u); delay assumed",
        .way = { /* assumed: half a millisecond there and back over a switch; 20 ms of queue */
            [SIM_DOWN] = { .bytes_s = 12500000, .delay_us = 250, .queue_bytes = 262144 },
            [SIM_UP] = { .bytes_s = 12500000, .delay_us = 250, .queue_bytes = 262144 },
        },
        .header_bytes = 40,
        .connect_ms = 1,
    },
    {
        .name = "ideal",
        .source = "no link at all: for comparison",
        .way = { [SIM_DOWN] = { .queue_bytes = 1048576 }, [SIM_UP] = { .queue_bytes = 1048576 } },
    },
};
/* clang-format on */

enum { PROFILE_COUNT = sizeof profile / sizeof profile[0] };

const sim_link_desc *sim_link_profile_at(unsigned index)
{
    return index < PROFILE_COUNT ? &profile[index] : NULL;
}

const sim_link_desc *sim_link_profile(const char *name)
{
    for (unsigned i = 0; i < PROFILE_COUNT; i++)
        if (!strcmp(profile[i].name, name)) return &profile[i];
    return NULL;
}

/* ---- "gprs,cut_every_ms=10000" ---- */

/* clang-format off */
#define DOWN(member) offsetof(sim_link_desc, way[SIM_DOWN].member)
#define UP(member)   offsetof(sim_link_desc, way[SIM_UP].member)
#define BOTH(member) offsetof(sim_link_desc, member)
static const struct {
    const char *name;
    size_t field;
} key[] = {
    { "down.bytes_s",     DOWN(bytes_s) },
    { "up.bytes_s",       UP(bytes_s) },
    { "down.delay_us",    DOWN(delay_us) },
    { "up.delay_us",      UP(delay_us) },
    { "down.jitter_us",   DOWN(jitter_us) },
    { "up.jitter_us",     UP(jitter_us) },
    { "down.queue_bytes", DOWN(queue_bytes) },
    { "up.queue_bytes",   UP(queue_bytes) },
    { "stall_every_ms",   BOTH(stall_every_ms) },
    { "stall_ms_min",     BOTH(stall_ms_min) },
    { "stall_ms_max",     BOTH(stall_ms_max) },
    { "stall_bytes_s",    BOTH(stall_bytes_s) },
    { "cut_every_ms",     BOTH(cut_every_ms) },
    { "connect_ms",       BOTH(connect_ms) },
    { "header_bytes",     BOTH(header_bytes) },
};
/* clang-format on */

enum { KEY_COUNT = sizeof key / sizeof key[0] };

const char *sim_link_key_at(unsigned index) { return index < KEY_COUNT ? key[index].name : NULL; }

static uint32_t *field(sim_link_desc *desc, const char *name)
{
    for (unsigned i = 0; i < KEY_COUNT; i++)
        if (!strcmp(key[i].name, name)) return (uint32_t *)(void *)((char *)desc + key[i].field);
    return NULL;
}

static int set_field(sim_link_desc *desc, char *assignment)
{
    char *value = strchr(assignment, '='), *end;
    if (!value || value[1] < '0' || value[1] > '9') return FF_ERR_ARGUMENT;
    *value++ = '\0';
    errno = 0;
    unsigned long number = strtoul(value, &end, 10);
    uint32_t *target = field(desc, assignment);
    if (!target || errno || *end || number > UINT32_MAX) return FF_ERR_ARGUMENT;
    *target = (uint32_t)number;
    return FF_OK;
}

int sim_link_parse(const char *spec, sim_link_desc *desc)
{
    char copy[512], *rest = NULL;
    if (strlen(spec) >= sizeof copy) return FF_ERR_ARGUMENT;
    memcpy(copy, spec, strlen(spec) + 1);
    char *part = strtok_r(copy, ",", &rest);
    const sim_link_desc *base = part ? sim_link_profile(part) : NULL;
    if (!base) return FF_ERR_NOT_FOUND;
    *desc = *base;
    while ((part = strtok_r(NULL, ",", &rest)) != NULL) {
        int rc = set_field(desc, part);
        if (rc != FF_OK) return rc;
    }
    return FF_OK;
}
