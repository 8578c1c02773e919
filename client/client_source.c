/* The sources of a client: made, stepped, closed; what their links and queues say together. Which
 * of several is asked, and how their grounds come together, is said in several/. */
#include "ff_client_local.h"
#include "../protocol/ff_assert.h"

#include <string.h>

int32_t ff_client_reach_wu(const ff_client *client)
{
    const ff_client_desc *desc = &client->desc;
    return desc->more_count || desc->no_entry ? INT32_MAX : desc->quality.view_wu;
}

void ff_source_make(ff_client *client, unsigned number, const ff_source_room *room)
{
    ff_source *source = ff_client_source(client, number);
    const ff_client_desc *desc = &client->desc;
    const ff_source_desc who = ff_client_source_desc(client, number);
    memset(source, 0, sizeof *source);
    source->pack = who.pack;
    source->io = who.stream;
    source->error = FF_ERR_AGAIN;
    source->number = (uint8_t)number;
    ff_requests_init(&source->requests, desc->in_flight_max, room->slots);
    source->intake.requests = &source->requests;
    source->intake.news = &client->news;
    source->intake.source = (uint8_t)number;
    if (!source->io) return;
    ff_stream_init(&source->stream, source->io, &source->intake, desc->in_flight_max,
                   desc->answer_timeout_ms, room->recv, room->recv_bytes);
    source->stream.reach_wu = ff_client_reach_wu(client);
    if (room->about) ff_stream_want_about(&source->stream, desc->about, room->about);
    ff_client_allow(client, source);
}

void ff_client_allow(const ff_client *client, ff_source *source)
{
    const ff_balance_desc *balance = &client->desc.balance;
    unsigned links = ff_budget_links(&client->desc);
    if (!source->io) return;
    FF_ASSERT(links > 0);
    uint32_t bytes_s = balance->mode == FF_BALANCE_ON ? balance->link_bytes_s / links : 0;
    ff_stream_allow(&source->stream, bytes_s);
}

void ff_client_take_pack(const ff_client *client, ff_source *source)
{
    ff_intake *intake = &source->intake;
    intake->ground_count = 0;
    for (const ff_pack *pack = source->pack; pack; pack = pack->next) {
        FF_ASSERT(intake->ground_count < FF_WELCOME_GROUNDS);
        source->ground[intake->ground_count].whole = ff_pack_whole(pack);
        intake->info[intake->ground_count++] = pack->header.info;
    }
    intake->told_count = intake->ground_count;
    ff_pack_layers(source->pack, &source->layers);
    ff_client_choose_layer(client, source);
}

void ff_client_take_welcome(const ff_client *client, ff_source *source)
{
    const ff_stream *stream = &source->stream;
    ff_intake *intake = &source->intake;
    FF_ASSERT(stream->welcome_count >= 1 && stream->welcome_count <= FF_WELCOME_GROUNDS);
    intake->ground_count = intake->told_count = stream->welcome_count;
    for (unsigned i = 0; i < intake->ground_count; i++) {
        source->ground[i].whole = stream->whole[i];
        intake->info[i] = stream->welcome[i];
    }
    source->layers = stream->layers;
    ff_client_choose_layer(client, source);
}

int ff_client_step_source(ff_client *client, ff_source *source, int64_t now_us)
{
    if (source->io) return ff_stream_step(&source->stream, now_us);
    if (!source->serves || client->interrupted) return 0;
    return ff_local_step(&source->intake, source->pack, !ff_client_low_power(client), now_us);
}

static void add_link(ff_stream_shared *sum, const ff_stream_shared *link)
{
    if (link->state == FF_STREAM_UP) sum->state = FF_STREAM_UP;
    sum->received += link->received;
    sum->received_high += link->received_high;
    sum->bytes_down += link->bytes_down;
    sum->bytes_up += link->bytes_up;
    for (unsigned kind = 0; kind < FF_KIND_COUNT; kind++)
        sum->answer_bytes[kind] += link->answer_bytes[kind];
    sum->about_bytes += link->about_bytes;
    sum->protocol_errors += link->protocol_errors;
    sum->reconnects += link->reconnects;
    sum->losses += link->losses;
    sum->bytes_s += link->bytes_s;
    if (link->rtt_us > sum->rtt_us) sum->rtt_us = link->rtt_us;
}

void ff_client_link(ff_client *client, ff_stream_shared *shared)
{
    unsigned links = 0;
    memset(shared, 0, sizeof *shared);
    for (unsigned i = 0; i < client->source_count; i++) {
        ff_source *source = ff_client_source(client, i);
        ff_stream_shared link;
        if (!source->io) continue;
        ff_stream_get_shared(&source->stream, &link);
        if (links++)
            add_link(shared, &link);
        else
            *shared = link;
    }
}

/* All of them are sums, or the most of something: so many at most together. */
FF_STATIC_ASSERT(sizeof(ff_request_counts) % sizeof(uint32_t) == 0);
static void add_counts(ff_request_counts *sum, const ff_request_counts *counts)
{
    uint32_t *to = (uint32_t *)sum;
    const uint32_t *from = (const uint32_t *)counts;
    for (size_t i = 0; i < sizeof *sum / sizeof *to; i++) to[i] += from[i];
}

void ff_client_counts(ff_client *client, ff_request_counts *counts)
{
    ff_requests_get_counts(&client->first.requests, counts, NULL);
    for (unsigned i = 1; i < client->source_count; i++) {
        ff_request_counts more;
        ff_requests_get_counts(&ff_client_source(client, i)->requests, &more, NULL);
        add_counts(counts, &more);
    }
}

int ff_client_waiting(ff_client *client, enum ff_request_class last)
{
    for (unsigned i = 0; i < client->source_count; i++)
        if (ff_requests_waiting(&ff_client_source(client, i)->requests, last)) return 1;
    return 0;
}
