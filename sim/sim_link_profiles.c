/* Real links as constants. Where a number has no source it says "assumed" and why; `source` names the papers:
 *   Hybrid                 Noguera, Segura, Ogayar, Joan-Arinyo 2010, section 9.4: GPRS and UMTS as they measured them
 *   Chakravorty & Pratt    Performance issues with general packet radio service, J. of Communications and Networks 4(4), 2002
 *   ARCchart 2009          round trips of EDGE (200-600 ms) and UMTS (336 ms), rate of EDGE
 *   3GPP TS 45.003         9.05 kbit/s a slot with coding scheme CS-1
 *   FFI 20/01338           Iridium Certus IP performance in the Arctic, Norwegian Defence Research Establishment 2020
 * A round trip R with spread S is split evenly: each way half of the smallest R and up to half of S on top, uniform.
 */
#include "sim_link.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static const sim_link_desc profile[] = {
    {
        .name = "gprs",
        .source = "Hybrid 9.4; Chakravorty & Pratt 2002; 3GPP TS 45.003",
        .way = {
            [SIM_DOWN] = { .bytes_s = 5500,        /* Hybrid: best TCP rate down, 5.5 kB/s */
                           .delay_us = 300000,     /* Chakravorty & Pratt: round trips of 600 ms to more than 1000 ms */
                           .jitter_us = 200000,
                           .queue_bytes = 110000 },/* the same: queues of tens of seconds; 20 s at 5.5 kB/s */
            [SIM_UP] = { .bytes_s = 2262,          /* two slots of CS-1, 2 * 9.05 kbit/s: multislot class 10 sends on two */
                         .delay_us = 300000, .jitter_us = 200000,
                         .queue_bytes = 16384 },   /* assumed: a phone's send buffer */
        },
        .stall_every_ms = 120000, /* assumed: Hybrid figures 43 and 48 show a few in 300 s */
        .stall_ms_min = 4000,     /* Chakravorty & Pratt: 4 to 40 s, also standing still; Hybrid saw up to 30 s */
        .stall_ms_max = 40000,
        .stall_bytes_s = 5,       /* Hybrid: "a few bytes per second" */
        .connect_ms = 1000,       /* a TCP handshake is one round trip */
    },
    {
        .name = "edge",
        .source = "ARCchart 2009",
        .way = {
            [SIM_DOWN] = { .bytes_s = 20000,       /* 160 kbit/s */
                           .delay_us = 100000,     /* round trip 200 to 600 ms */
                           .jitter_us = 200000,
                           .queue_bytes = 65536 }, /* assumed: 3 s */
            [SIM_UP] = { .bytes_s = 10000,         /* assumed: half the slots of the way down */
                         .delay_us = 100000, .jitter_us = 200000, .queue_bytes = 16384 },
        },
        .connect_ms = 400,
    },
    {
        .name = "umts",
        .source = "ARCchart 2009; Hybrid 9.4",
        .way = {
            [SIM_DOWN] = { .bytes_s = 48000,       /* 384 kbit/s nominal */
                           .delay_us = 148000,     /* with the jitter's mean of 20 ms: 336 ms round trip */
                           .jitter_us = 40000,
                           .queue_bytes = 65536 }, /* assumed: 1.4 s */
            [SIM_UP] = { .bytes_s = 8000,          /* assumed: the usual 64 kbit/s bearer beside 384 down */
                         .delay_us = 148000, .jitter_us = 40000, .queue_bytes = 16384 },
        },
        .connect_ms = 336,                         /* Hybrid saw no stalls on UMTS */
    },
    {
        .name = "ltem",
        .source = "3GPP release 13, category M1 half duplex: peak rates 300 / 375 kbit/s, 10-15 ms nominal",
        .way = {
            [SIM_DOWN] = { .bytes_s = 37500, .delay_us = 5000, .jitter_us = 2500, .queue_bytes = 65536 },
            [SIM_UP] = { .bytes_s = 46875, .delay_us = 5000, .jitter_us = 2500, .queue_bytes = 65536 },
        },
        .connect_ms = 15,
    },
    {
        .name = "nbiot",
        .source = "3GPP release 13, category NB1: peak rates 26 / 62 kbit/s; latency 1.6 to 10 s (3GPP TR 45.820's goal)",
        .way = {
            [SIM_DOWN] = { .bytes_s = 3250, .delay_us = 800000, .jitter_us = 4200000, .queue_bytes = 65536 },
            [SIM_UP] = { .bytes_s = 7750, .delay_us = 800000, .jitter_us = 4200000, .queue_bytes = 16384 },
        },
        .connect_ms = 1600,
    },
    {
        .name = "iridium",
        .source = "Iridium Certus midband 88 kbit/s down; FFI 20/01338",
        .way = {
            [SIM_DOWN] = { .bytes_s = 11000,       /* 88 kbit/s */
                           .delay_us = 300000,     /* assumed: 600 to 800 ms round trip by way of the gateway */
                           .jitter_us = 100000, .queue_bytes = 65536 },
            [SIM_UP] = { .bytes_s = 2750,          /* assumed: a quarter, 22 kbit/s */
                         .delay_us = 300000, .jitter_us = 100000, .queue_bytes = 16384 },
        },
        .stall_every_ms = 300000, /* assumed: FFI says often, without a number */
        .stall_ms_min = 2000, /* assumed */
        .stall_ms_max = 70000,/* FFI: "up to 70 seconds" in which no packet is served */
        .stall_bytes_s = 0,
        .connect_ms = 800,
    },
    {
        .name = "lan",
        .source = "100 Mbit/s Ethernet; delay assumed",
        .way = {
            [SIM_DOWN] = { .bytes_s = 12500000, .delay_us = 250, .queue_bytes = 262144 },
            [SIM_UP] = { .bytes_s = 12500000, .delay_us = 250, .queue_bytes = 262144 },
        },
        .connect_ms = 1,
    },
    {
        .name = "ideal",
        .source = "no link at all: for comparison",
        .way = { [SIM_DOWN] = { .queue_bytes = 1048576 }, [SIM_UP] = { .queue_bytes = 1048576 } },
    },
};

enum { PROFILE_COUNT = sizeof profile / sizeof profile[0] };

const sim_link_desc *sim_link_profile_at(unsigned index)
{
    return index < PROFILE_COUNT ? &profile[index] : NULL;
}

const sim_link_desc *sim_link_profile(const char *name)
{
    for (unsigned i = 0; i < PROFILE_COUNT; i++)
        if (!strcmp(profile[i].name, name))
            return &profile[i];
    return NULL;
}

/* ---- "gprs,cut_every_ms=10000" ---- */

static uint32_t *field(sim_link_desc *desc, const char *key)
{
    sim_link_way *down = &desc->way[SIM_DOWN], *up = &desc->way[SIM_UP];
    const struct { const char *key; uint32_t *value; } table[] = {
        { "down.bytes_s", &down->bytes_s },         { "up.bytes_s", &up->bytes_s },
        { "down.delay_us", &down->delay_us },       { "up.delay_us", &up->delay_us },
        { "down.jitter_us", &down->jitter_us },     { "up.jitter_us", &up->jitter_us },
        { "down.queue_bytes", &down->queue_bytes }, { "up.queue_bytes", &up->queue_bytes },
        { "stall_every_ms", &desc->stall_every_ms },{ "stall_ms_min", &desc->stall_ms_min },
        { "stall_ms_max", &desc->stall_ms_max },    { "stall_bytes_s", &desc->stall_bytes_s },
        { "cut_every_ms", &desc->cut_every_ms },    { "connect_ms", &desc->connect_ms },
    };
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++)
        if (!strcmp(table[i].key, key))
            return table[i].value;
    return NULL;
}

static int set_field(sim_link_desc *desc, char *assignment)
{
    char *value = strchr(assignment, '='), *end;
    if (!value || value[1] < '0' || value[1] > '9')
        return FF_ERR_ARGUMENT;
    *value++ = '\0';
    errno = 0;
    unsigned long number = strtoul(value, &end, 10);
    uint32_t *target = field(desc, assignment);
    if (!target || errno || *end || number > UINT32_MAX)
        return FF_ERR_ARGUMENT;
    *target = (uint32_t)number;
    return FF_OK;
}

int sim_link_parse(const char *spec, sim_link_desc *desc)
{
    char copy[512], *rest = NULL;
    if (strlen(spec) >= sizeof copy)
        return FF_ERR_ARGUMENT;
    memcpy(copy, spec, strlen(spec) + 1);
    char *part = strtok_r(copy, ",", &rest);
    const sim_link_desc *base = part ? sim_link_profile(part) : NULL;
    if (!base)
        return FF_ERR_NOT_FOUND;
    *desc = *base;
    while ((part = strtok_r(NULL, ",", &rest)) != NULL) {
        int rc = set_field(desc, part);
        if (rc != FF_OK)
            return rc;
    }
    return FF_OK;
}
