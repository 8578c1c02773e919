/* Recording a flight's tape. */
#include "sim_tape_local.h"

#include <string.h>

static void put(FILE *file, uint64_t value, unsigned bytes)
{
    for (unsigned i = 0; i < bytes; i++) fputc((int)(value >> (8 * i) & 0xFF), file);
}

static void put_record(FILE *file, char letter, int32_t value)
{
    fputc(letter, file);
    put(file, (uint32_t)value, 4);
}

static int record_send(void *state, const uint8_t *bytes, size_t count)
{
    sim_tape_recorder *recorder = state;
    int sent = recorder->inner.send(recorder->inner.state, bytes, count);
    put_record(recorder->file, 'S', sent);
    put(recorder->file, sim_tape_hash(bytes, count), 4);
    return sent;
}

static int record_recv(void *state, uint8_t *bytes, size_t capacity)
{
    sim_tape_recorder *recorder = state;
    int count = recorder->inner.recv(recorder->inner.state, bytes, capacity);
    if (count != 0) put_record(recorder->file, 'R', count);
    if (count > 0) fwrite(bytes, 1, (size_t)count, recorder->file);
    return count;
}

static int record_reconnect(void *state)
{
    sim_tape_recorder *recorder = state;
    int rc = recorder->inner.reconnect(recorder->inner.state);
    put_record(recorder->file, 'C', rc);
    return rc;
}

static void record_close(void *state)
{
    sim_tape_recorder *recorder = state;
    recorder->inner.close(recorder->inner.state);
}

static void put_head(FILE *file, const sim_tape_head *head)
{
    const ff_quality *q = &head->quality;
    const ff_panorama_desc *p = &head->panorama;
    const ff_far_desc *f = &head->far;
    const int32_t number[SIM_TAPE_HEAD] = { (int32_t)head->memory_bytes,
                                            head->width,
                                            head->height,
                                            (int32_t)q->measure,
                                            q->c_q8,
                                            q->error_px_q8,
                                            q->depth_max,
                                            q->sigma_q8,
                                            q->view_wu,
                                            q->hole_wu,
                                            p->enabled,
                                            p->back_plane_wu,
                                            p->server_back_wu,
                                            p->error_px_q8,
                                            p->face_size,
                                            p->quality,
                                            p->hold_back,
                                            (int32_t)q->triangles_max,
                                            (int32_t)head->hidden,
                                            head->no_views,
                                            f->enabled,
                                            f->front_wu,
                                            f->coarse,
                                            f->paint_shift,
                                            f->quality,
                                            f->tolerance_q2,
                                            head->velocity_wu_s[0],
                                            head->velocity_wu_s[1],
                                            (int32_t)head->first_answer_ms };
    fwrite(SIM_TAPE_MAGIC, 1, SIM_TAPE_MAGIC_BYTES, file);
    for (unsigned i = 0; i < SIM_TAPE_HEAD; i++) put(file, (uint32_t)number[i], 4);
}

int sim_tape_record(sim_tape_recorder *recorder, const char *path, const sim_tape_head *head,
                    sys_stream *stream)
{
    recorder->file = fopen(path, "wb");
    if (!recorder->file) return FF_ERR_SYSTEM;
    put_head(recorder->file, head);
    recorder->inner = *stream;
    stream->state = recorder;
    stream->send = record_send;
    stream->recv = record_recv;
    stream->close = stream->close ? record_close : NULL;
    stream->reconnect = stream->reconnect ? record_reconnect : NULL;
    return FF_OK;
}

void sim_tape_work(sim_tape_recorder *recorder, int64_t now_us)
{
    fputc('W', recorder->file);
    put(recorder->file, (uint64_t)now_us, 8);
}

void sim_tape_frame(sim_tape_recorder *recorder, int64_t now_us, const c3d_camera *camera,
                    int flying)
{
    const int32_t number[7] = { camera->pos_wu[0], camera->pos_wu[1], camera->pos_wu[2],
                                camera->yaw,       camera->pitch,     camera->roll,
                                camera->focal_q8 };
    fputc('U', recorder->file);
    put(recorder->file, (uint64_t)now_us, 8);
    for (unsigned i = 0; i < 7; i++) put(recorder->file, (uint32_t)number[i], 4);
    put(recorder->file, flying != 0, 1);
}

void sim_tape_layer(sim_tape_recorder *recorder, const char *name)
{
    size_t count = name ? strlen(name) : 0;
    put_record(recorder->file, 'L', name ? (int32_t)count : -1);
    if (name) fwrite(name, 1, count, recorder->file);
}

int sim_tape_finish(sim_tape_recorder *recorder, uint64_t geometry_hash, uint64_t request_hash)
{
    fputc('E', recorder->file);
    put(recorder->file, geometry_hash, 8);
    put(recorder->file, request_hash, 8);
    int bad = ferror(recorder->file) != 0;
    bad |= fclose(recorder->file) != 0;
    recorder->file = NULL;
    return bad ? FF_ERR_SYSTEM : FF_OK;
}
