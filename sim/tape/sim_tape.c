/* Playing a tape. Integers only: this runs on the handheld. */
#include "sim_tape_local.h"

#include <string.h>

static uint64_t take(sim_tape_player *player, unsigned bytes)
{
    uint64_t value = 0;
    for (unsigned i = 0; i < bytes; i++) value |= (uint64_t)player->at[i] << (8 * i);
    player->at += bytes;
    return value;
}

static int32_t take_i32(sim_tape_player *player) { return (int32_t)(uint32_t)take(player, 4); }

/* 1 when a record of this letter and at least `bytes` more come next; the letter is taken. */
static int begins(sim_tape_player *player, char letter, size_t bytes)
{
    if ((size_t)(player->end - player->at) < bytes + 1 || *player->at != (uint8_t)letter) return 0;
    player->at++;
    return 1;
}

static int play_send(void *state, const uint8_t *bytes, size_t count)
{
    sim_tape_player *player = state;
    if (player->differs || !begins(player, 'S', 8)) {
        player->differs = 1;
        return FF_ERR_CLOSED;
    }
    int32_t sent = take_i32(player);
    player->differs = (uint32_t)take(player, 4) != sim_tape_hash(bytes, count) ||
                      (sent > 0 && (uint32_t)sent > count);
    return player->differs ? FF_ERR_CLOSED : sent;
}

static int play_recv(void *state, uint8_t *bytes, size_t capacity)
{
    sim_tape_player *player = state;
    if (player->differs) return FF_ERR_CLOSED;
    if (!player->left) {
        if (!begins(player, 'R', 4)) return 0;
        int32_t value = take_i32(player);
        if (value < 0) return value;
        player->left = (uint32_t)value;
    }
    size_t count = player->left < capacity ? player->left : capacity;
    if (count > (size_t)(player->end - player->at)) {
        player->differs = 1;
        return FF_ERR_CLOSED;
    }
    memcpy(bytes, player->at, count);
    player->at += count;
    player->left -= (uint32_t)count;
    return (int)count;
}

static int play_reconnect(void *state)
{
    sim_tape_player *player = state;
    if (!player->differs && begins(player, 'C', 4)) return take_i32(player);
    player->differs = 1;
    return FF_ERR_CLOSED;
}

static void play_close(void *state) { (void)state; }

static void take_head(sim_tape_player *player)
{
    sim_tape_head *head = &player->head;
    ff_quality *q = &head->quality;
    ff_panorama_desc *p = &head->panorama;
    int32_t n[SIM_TAPE_HEAD];
    for (unsigned i = 0; i < SIM_TAPE_HEAD; i++) n[i] = take_i32(player);
    *head = (sim_tape_head){ .memory_bytes = (uint32_t)n[0],
                             .width = (uint16_t)n[1],
                             .height = (uint16_t)n[2],
                             .hidden = n[18] == FF_HIDDEN_FETCHED ? FF_HIDDEN_FETCHED
                                       : n[18] == FF_HIDDEN_DRAWN ? FF_HIDDEN_DRAWN
                                                                  : FF_HIDDEN_LEFT_OUT,
                             .no_views = n[19] != 0,
                             .velocity_wu_s = { n[26], n[27] },
                             .first_answer_ms = (uint32_t)n[28] };
    *q = (ff_quality){ .measure = n[3] == FF_MEASURE_PIXELS ? FF_MEASURE_PIXELS
                                                            : FF_MEASURE_DISTANCE,
                       .c_q8 = n[4],
                       .error_px_q8 = n[5],
                       .depth_max = (uint8_t)n[6],
                       .sigma_q8 = n[7],
                       .view_wu = n[8],
                       .hole_wu = n[9] };
    *p = (ff_panorama_desc){ .enabled = (uint8_t)(n[10] >= 0 && n[10] <= FF_PANORAMA_AUTO ? n[10]
                                                                                          : 0),
                             .back_plane_wu = n[11],
                             .server_back_wu = n[12],
                             .error_px_q8 = n[13],
                             .face_size = (uint16_t)n[14],
                             .quality = (uint8_t)n[15],
                             .hold_back = (uint8_t)n[16] };
    q->triangles_max = (uint32_t)n[17];
    head->far = (ff_far_desc){ .enabled = (uint8_t)(n[20] >= 0 && n[20] <= FF_FAR_AUTO ? n[20] : 0),
                               .front_wu = n[21],
                               .coarse = (uint8_t)n[22],
                               .paint_shift = (uint8_t)n[23],
                               .quality = (uint8_t)n[24],
                               .tolerance_q2 = (uint8_t)n[25] };
}

int sim_tape_open(sim_tape_player *player, const void *bytes, uint64_t count, sys_stream *stream)
{
    memset(player, 0, sizeof *player);
    if (count < SIM_TAPE_MAGIC_BYTES + 4 * SIM_TAPE_HEAD ||
        memcmp(bytes, SIM_TAPE_MAGIC, SIM_TAPE_MAGIC_BYTES) != 0)
        return FF_ERR_FORMAT;
    player->at = (const uint8_t *)bytes + SIM_TAPE_MAGIC_BYTES;
    player->end = (const uint8_t *)bytes + count;
    take_head(player);
    *stream = (sys_stream){ player, play_send, play_recv, play_close, play_reconnect };
    return FF_OK;
}

static void take_camera(sim_tape_player *player, sim_tape_step *step)
{
    c3d_camera *camera = &step->camera;
    for (unsigned axis = 0; axis < 3; axis++) camera->pos_wu[axis] = take_i32(player);
    camera->yaw = take_i32(player);
    camera->pitch = take_i32(player);
    camera->roll = take_i32(player);
    camera->focal_q8 = take_i32(player);
    camera->width = player->head.width;
    camera->height = player->head.height;
    step->flying = (int)take(player, 1);
}

static int take_layer(sim_tape_player *player, sim_tape_step *step)
{
    int32_t count = take_i32(player);
    if (count > FF_LAYER_NAME_MAX || count > player->end - player->at) return FF_ERR_FORMAT;
    step->kind = SIM_TAPE_LAYER;
    step->shows_none = count < 0;
    for (int32_t i = 0; i < count; i++) step->layer[i] = (char)*player->at++;
    return FF_OK;
}

int sim_tape_next(sim_tape_player *player, sim_tape_step *step)
{
    memset(step, 0, sizeof *step);
    if (player->differs || player->left) return FF_ERR_FORMAT;
    if (begins(player, 'W', 8)) {
        step->kind = SIM_TAPE_WORK;
        step->now_us = (int64_t)take(player, 8);
        return FF_OK;
    }
    if (begins(player, 'U', 8 + 7 * 4 + 1)) {
        step->kind = SIM_TAPE_FRAME;
        step->now_us = (int64_t)take(player, 8);
        take_camera(player, step);
        return FF_OK;
    }
    if (begins(player, 'L', 4)) return take_layer(player, step);
    if (begins(player, 'E', 16)) {
        step->kind = SIM_TAPE_END;
        step->geometry_hash = take(player, 8);
        step->request_hash = take(player, 8);
        return FF_OK;
    }
    return FF_ERR_FORMAT;
}
