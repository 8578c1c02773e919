#include "client_fixture.h"

#include "../../protocol/picture/ff_paint.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#define METRE       FF_WU_PER_METRE
#define FACE_ROWS   20
#define FACE_BLOCKS 3

/* ---- the server's end ---- */

static void end_session(client_rig *rig)
{
    ff_session_destroy(rig->session);
    rig->session = NULL;
    rig->inbox_count = 0;
}

static void begin_session(client_rig *rig)
{
    ff_session_desc desc = { .pack = &rig->pack, .lacks = rig->lacks };
    rig->session = ff_session_create(&desc);
    assert(rig->session);
    rig->connections++;
}

static void look_away(void *context, unsigned column, unsigned row, uint8_t rgb[64][3])
{
    (void)context, (void)column, (void)row, (void)rgb;
}

static int make_face(const ff_face_job *job, uint8_t *out, size_t capacity)
{
    static uint8_t rgb[FF_FACE_SIZE_MAX * 8 * FACE_BLOCKS * 3],
        there[FF_FACE_SIZE_MAX / 8 * FACE_BLOCKS], paint[1 << 16],
        columns[4 * FF_FACE_SIZE_MAX + 8];
    static uint64_t room[8192];
    const ff_paint_source source = { job->request.face_size / 8u, FACE_BLOCKS, there, rgb };
    static const ff_paint_sink nobody = { .block = look_away };
    uint16_t top[FF_FACE_SIZE_MAX], bottom[FF_FACE_SIZE_MAX];
    unsigned size = job->request.face_size;
    ff_message message = { .type = FF_MSG_ANSWER, .kind = FF_KIND_FACE };
    ff_face *face = &message.u.face;
    face->id = job->request.id;
    face->face = job->face;
    face->face_size = (uint16_t)size;
    face->flags = job->last ? FF_FACE_LAST : 0;
    if (job->face >= FF_FACE_UP) {
        face->flags |= FF_FACE_EMPTY;
        return ff_message_encode(&message, out, capacity);
    }
    for (unsigned i = 0; i < size; i++) {
        top[i] = (uint16_t)(i / 8 % FACE_ROWS);
        bottom[i] = FACE_ROWS;
    }
    memset(rgb, 40 * (job->face + 1), sizeof rgb);
    face->top_row = (uint16_t)(size / 2 - FACE_ROWS / 2);
    face->row_count = FACE_ROWS;
    face->columns = columns;
    face->columns_bytes = (uint32_t)ff_face_columns_encode(top, bottom, size, columns,
                                                           sizeof columns);
    memset(there, 1, sizeof there);
    assert(ff_paint_room_bytes(source.columns) <= sizeof room);
    face->image = paint;
    face->image_bytes = (uint32_t)ff_paint_encode(
        &source, job->request.quality, (ff_paint_room *)(void *)room, &nobody, paint, sizeof paint);
    return ff_message_encode(&message, out, capacity);
}

/* A sector with one fin 2 km away. */
static int make_sector(const client_rig *rig, const ff_face_job *job, uint8_t *out, size_t capacity)
{
    uint8_t fins[64] = { 0xFF };
    const ff_fin_vertex fin[2] = { { .distance = 160, .begins = 1 }, { 8, 8, 160, 0 } };
    unsigned sector = job->face;
    int bytes = rig->spoilt >> sector & 1u ? 1 : ff_fins_encode(fin, 2, fins, sizeof fins);
    ff_message message = { .type = FF_MSG_ANSWER, .kind = FF_KIND_FAR };
    message.u.far = (ff_far){ .sector = (uint8_t)sector,
                              .flags = job->last ? FF_FACE_LAST : 0,
                              .fins = fins,
                              .fins_bytes = (uint32_t)bytes };
    return ff_message_encode(&message, out, capacity);
}

static void count_messages(client_rig *rig, const uint8_t *bytes, size_t count)
{
    ff_message message;
    for (int used; count && (used = ff_message_decode(bytes, count, &message)) > 0;
         bytes += used, count -= (size_t)used) {
        if (message.type == FF_MSG_GET) rig->asked[message.kind]++;
        if (message.type == FF_MSG_GET && message.kind == FF_KIND_REFINEMENT)
            for (unsigned sides = message.u.get.sides; sides; sides &= sides - 1)
                rig->sides_left_out++;
        rig->pings += message.type == FF_MSG_PING;
        if (message.type == FF_MSG_GET_ABOUT && !rig->asked_about++)
            rig->about_at = rig->bytes_down;
    }
}

static void serve(client_rig *rig)
{
    static uint8_t face[1 << 17];
    if (!rig->session) return;
    int taken = ff_session_receive(rig->session, rig->inbox, rig->inbox_count, rig->now_us);
    if (taken > 0) {
        rig->inbox_count -= (size_t)taken;
        memmove(rig->inbox, rig->inbox + taken, rig->inbox_count);
    }
    ff_face_job job;
    while (!rig->no_faces && ff_session_next_face(rig->session, &job)) {
        int bytes = job.kind == FF_KIND_FAR ? make_sector(rig, &job, face, sizeof face)
                                            : make_face(&job, face, sizeof face);
        ff_session_face_done(rig->session, &job, face, bytes);
    }
}

/* ---- the client's end ---- */

/* What the server hears differently from what was said. */
static void mishear(client_rig *rig, uint8_t *bytes, size_t count)
{
    ff_message message;
    for (int used; count && (used = ff_message_decode(bytes, count, &message)) > 0;
         bytes += used, count -= (size_t)used) {
        if (rig->version && message.type == FF_MSG_HELLO) bytes[6] = rig->version;
        if (rig->about_set && message.type == FF_MSG_GET_ABOUT) bytes[2] = rig->about_set;
    }
}

static int rig_send(void *state, const uint8_t *bytes, size_t count)
{
    client_rig *rig = state;
    if (!rig->session) return FF_ERR_CLOSED;
    if (rig->inbox_count + count > sizeof rig->inbox) return 0;
    count_messages(rig, bytes, count);
    memcpy(rig->inbox + rig->inbox_count, bytes, count);
    mishear(rig, rig->inbox + rig->inbox_count, count);
    rig->inbox_count += count;
    serve(rig);
    return (int)count;
}

static int rig_recv(void *state, uint8_t *bytes, size_t capacity)
{
    client_rig *rig = state;
    const uint8_t *output;
    if (!rig->session) return FF_ERR_CLOSED;
    if (rig->bytes_down >= rig->cut_at) {
        rig->cut_at = UINT64_MAX;
        end_session(rig);
        return FF_ERR_CLOSED;
    }
    serve(rig);
    size_t count = ff_session_output(rig->session, &output);
    uint64_t limit = rig->cut_at < rig->silent_at ? rig->cut_at : rig->silent_at;
    if (count > capacity) count = capacity;
    if (rig->chop && count > rig->chop) count = rig->chop;
    if (count > limit - rig->bytes_down) count = (size_t)(limit - rig->bytes_down);
    for (size_t i = 0; i < count; i++)
        bytes[i] = rig->bytes_down + i >= rig->spoil_at ? rig->spoil_with : output[i];
    ff_session_sent(rig->session, count);
    rig->bytes_down += count;
    return (int)count;
}

static void rig_close_stream(void *state)
{
    client_rig *rig = state;
    if (rig->session) end_session(rig);
}

static int rig_reconnect(void *state)
{
    client_rig *rig = state;
    if (rig->refuse) return FF_ERR_SYSTEM;
    begin_session(rig);
    rig->spoil_at = rig->silent_at = UINT64_MAX; /* each fault happens once */
    return FF_OK;
}

/* ---- packs and clients ---- */

static void colour(void *context, int64_t x_wu, int64_t y_wu, uint8_t rgb[3])
{
    (void)context;
    rgb[0] = (uint8_t)(x_wu >> 12);
    rgb[1] = (uint8_t)(y_wu >> 12);
    rgb[2] = 90;
}

#define SAMPLES 129 /* that fill the usual pack's tiles, each way */

enum variant { USUAL, OTHER, FILLED, LEAVES, STUBS, PICTURES, TRAINED };

static void open_pack(client_rig *rig, unsigned texture_log2, unsigned node_log2,
                      enum variant variant, uint32_t samples_x, uint32_t samples_y)
{
    pack_fixture_desc desc = { .info = pack_fixture_info(6, 2, 2),
                               .height = pack_fixture_hills,
                               .filled = variant == FILLED ? pack_fixture_hole : NULL,
                               .colour = colour,
                               .about = rig->about,
                               .leaf_level = variant == LEAVES,
                               .stub_level = variant == STUBS,
                               .bare_level = variant == STUBS };
    size_t bytes;
    desc.info.node_log2 = (uint8_t)node_log2;
    desc.info.texture_log2 = (uint8_t)texture_log2;
    desc.info.texture_levels = texture_log2 ? 3 : 0;
    if (variant == PICTURES) desc.info.flags |= FF_TERRAIN_PICTURES;
    if (variant == TRAINED) desc.info.codec = FF_CODEC_TRAINED;
    desc.info.hoffset_wu = variant == OTHER ? 1000 : 0;
    desc.info.epsg = rig->epsg;
    desc.info.origin_x_mm = rig->origin_mm[0];
    desc.info.origin_y_mm = rig->origin_mm[1];
    desc.info.samples_x = samples_x;
    desc.info.samples_y = samples_y;
    free(rig->pack_bytes);
    rig->pack_bytes = pack_fixture_make(&desc, &bytes);
    assert(rig->pack_bytes);
    int rc = ff_pack_open(&rig->pack, rig->pack_bytes, bytes);
    assert(rc == FF_OK);
    (void)rc;
}

void rig_open(client_rig *rig, unsigned texture_log2)
{
    memset(rig, 0, sizeof *rig);
    open_pack(rig, texture_log2, 3, USUAL, SAMPLES, SAMPLES);
    rig->cut_at = rig->silent_at = rig->spoil_at = UINT64_MAX;
    rig->spoil_with = 0xff;
    rig->stream = (sys_stream){ .state = rig,
                                .send = rig_send,
                                .recv = rig_recv,
                                .close = rig_close_stream,
                                .reconnect = rig_reconnect };
    rig->camera = (c3d_camera){ .pos_wu = { 1500 * METRE, 700 * METRE, 1200 * METRE },
                                .yaw = 3000,
                                .pitch = -2500,
                                .width = 240,
                                .height = 320,
                                .focal_q8 = 208 * 256 };
    rig->desc.no_prefetch = 1;
    rig->now_us = 1000000;
}

void rig_use_node_log2(client_rig *rig, unsigned node_log2, unsigned texture_log2)
{
    open_pack(rig, texture_log2, node_log2, USUAL, SAMPLES, SAMPLES);
}

void rig_use_samples(client_rig *rig, uint32_t samples_x, uint32_t samples_y, unsigned texture_log2)
{
    open_pack(rig, texture_log2, 3, USUAL, samples_x, samples_y);
}

void rig_use_pictures(client_rig *rig, unsigned texture_log2)
{
    open_pack(rig, texture_log2, 3, PICTURES, SAMPLES, SAMPLES);
}

void rig_use_trained(client_rig *rig, uint32_t samples_x, uint32_t samples_y)
{
    open_pack(rig, 0, 3, TRAINED, samples_x, samples_y);
}

void rig_use_filled(client_rig *rig) { open_pack(rig, 0, 3, FILLED, SAMPLES, SAMPLES); }

void rig_use_leaves(client_rig *rig) { open_pack(rig, 0, 3, LEAVES, SAMPLES, SAMPLES); }

void rig_use_stubs(client_rig *rig, unsigned texture_log2)
{
    open_pack(rig, texture_log2, 3, STUBS, SAMPLES, SAMPLES);
}

void rig_use_place(client_rig *rig, int32_t epsg, int east_m, int north_m)
{
    rig->epsg = epsg;
    rig->origin_mm[0] = (int64_t)east_m * 1000;
    rig->origin_mm[1] = (int64_t)north_m * 1000;
    open_pack(rig, 0, 3, USUAL, SAMPLES, SAMPLES);
}

void rig_use_about(client_rig *rig, ff_list about)
{
    rig->about = about;
    open_pack(rig, 0, 3, USUAL, SAMPLES, SAMPLES);
}

void rig_change_terrain(client_rig *rig)
{
    if (rig->session) end_session(rig);
    open_pack(rig, 0, 3, OTHER, SAMPLES, SAMPLES);
}

void rig_client_of(client_rig *rig, size_t bytes)
{
    rig->memory = malloc(bytes);
    rig->memory_bytes = bytes;
    assert(rig->memory);
    memset(rig->memory, 0xA5, bytes);
    rig->desc.memory = rig->memory;
    rig->desc.memory_bytes = bytes;
    int rc = ff_client_create(&rig->desc, &rig->client);
    assert(rc == FF_OK);
    (void)rc;
}

void rig_client(client_rig *rig, size_t bytes)
{
    begin_session(rig);
    rig->desc.stream = &rig->stream;
    rig_client_of(rig, bytes);
}

void rig_local_client(client_rig *rig, size_t bytes)
{
    rig->desc.pack = &rig->pack;
    rig_client_of(rig, bytes);
}

void rig_close(client_rig *rig)
{
    ff_client_destroy(rig->client);
    if (rig->session) end_session(rig);
    free(rig->memory);
    free(rig->pack_bytes);
}

/* ---- running ---- */

void rig_step(client_rig *rig, int64_t us)
{
    rig->frame_us += us;
    /* with a thread the server's time stands still here: the worker owns it */
    if (!rig->desc.use_thread) {
        rig->now_us += us;
        ff_client_work(rig->client, rig->now_us);
    }
    rig->updates += (unsigned)ff_client_update(rig->client, rig->frame_us, &rig->camera);
}

uint32_t rig_heights(const client_rig *rig)
{
    ff_session_stats stats;
    ff_session_get_stats(rig->session, &stats);
    return stats.answers[FF_DATA_HEIGHTS];
}

ff_client_stats rig_stats(const client_rig *rig)
{
    ff_client_stats stats;
    ff_client_get_stats(rig->client, &stats);
    return stats;
}

void rig_fly(client_rig *rig, unsigned frames)
{
    for (unsigned i = 0; i < frames; i++) {
        rig->camera.pos_wu[0] += 6 * FF_WU_PER_METRE;
        rig->camera.pos_wu[1] += 6 * FF_WU_PER_METRE;
        rig->camera.yaw += 40;
        rig_step(rig, 50000);
    }
}

int rig_settle(client_rig *rig, unsigned frames)
{
    unsigned calm = 0;
    for (unsigned i = 0; i < frames && calm < 5; i++) {
        rig_step(rig, 50000);
        ff_client_stats stats = rig_stats(rig);
        calm = stats.have_terrain && (stats.link == FF_LINK_UP || stats.link == FF_LINK_NONE) &&
                       !stats.queued && !stats.in_flight
                   ? calm + 1
                   : 0;
    }
    return calm >= 5;
}

int rig_same_picture(const client_rig *a, const client_rig *b)
{
    const ff_drawn *list_a, *list_b;
    const ff_tree *tree_a = ff_client_tree(a->client), *tree_b = ff_client_tree(b->client);
    if (!tree_a || !tree_b) return 0;
    uint32_t count = ff_tree_drawn(tree_a, &list_a), count_b = ff_tree_drawn(tree_b, &list_b);
    unsigned side = ff_node_side(ff_client_terrain(a->client));
    if (!count || count != count_b) return 0;
    for (uint32_t i = 0; i < count; i++)
        if (list_a[i].key != list_b[i].key || list_a[i].coarser != list_b[i].coarser ||
            memcmp(list_a[i].heights, list_b[i].heights, side * side * sizeof(uint16_t)) != 0)
            return 0;
    return 1;
}
