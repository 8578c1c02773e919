#include "handheld.h"

#include <stdlib.h>
#include <string.h>

#define WORK_STEPS_MAX    64 /* between two frames, without a link */
#define WAIT_US           2000
#define MEMORY_BYTES      (4u << 20)
#define BLOCK_ALIGN       64 /* so that no byte of the block is lost to alignment, on any machine */
#define SETTLE_FRAMES_MAX 3000 /* of a pack's flight, before it starts: until the ground stands */

static int fail_with(const char *what, const char *why)
{
    fprintf(stderr, "farfield-handheld: %s: %s\n", what, why);
    return -1;
}

static int fail(const char *what, int rc) { return fail_with(what, ff_error_text(rc)); }

/* ---- opening ---- */

static int open_source(handheld *device)
{
    const handheld_options *options = device->options;
    const char *path = options->pack_path ? options->pack_path : options->tape_path;
    int rc;
    if (options->server) {
        rc = sys_tcp_client(&device->tcp, options->server, &device->stream);
        return rc == FF_OK ? 0 : fail(options->server, rc);
    }
    rc = sys_map_file(path, &device->mapping);
    if (rc == FF_OK && options->pack_path)
        rc = ff_pack_open(&device->pack, device->mapping.bytes, device->mapping.size);
    else if (rc == FF_OK)
        rc = sim_tape_open(&device->tape, device->mapping.bytes, device->mapping.size,
                           &device->stream);
    return rc == FF_OK ? 0 : fail_with(path, ff_pack_error_text(&device->pack, rc));
}

static int open_surface(handheld *device)
{
    sys_surface_desc desc = { "farfield-handheld", device->width, device->height, SYS_GL_ES1 };
    if (device->options->no_pictures) return 0;
    device->surface_api = sys_surface_memory();
    int rc = device->surface_api->open(&desc, &device->surface);
    return rc == FF_OK ? 0 : fail("picture", rc);
}

ff_client_desc handheld_client_desc(const handheld *device)
{
    const handheld_options *options = device->options;
    const sim_tape_head *head = options->tape_path ? &device->tape.head : NULL;
    return (ff_client_desc){ .width = device->width,
                             .height = device->height,
                             .quality = head ? head->quality : options->quality,
                             .panorama = head ? head->panorama : options->panorama,
                             .far = head ? head->far : options->far,
                             .surface_api = device->surface_api,
                             .backend = device->surface ? c3d_backend_soft() : NULL,
                             .use_plain_arrays = 1,
                             .use_map = options->map_m > 0,
                             .place_known = head != NULL, /* as of who recorded it */
                             .velocity_wu_s = { head ? head->velocity_wu_s[0] : 0,
                                                head ? head->velocity_wu_s[1] : 0 },
                             .first_answer_ms = head ? head->first_answer_ms : 0,
                             .no_views = head ? head->no_views : 0,
                             .layer = options->layer,
                             .no_textures = (uint8_t)options->no_textures,
                             .hidden = head ? head->hidden : FF_HIDDEN_LEFT_OUT,
                             .balance = options->balance };
}

/* Of a ground that is known. */
static int check_layer(const handheld *device)
{
    const char *layer = device->options->layer;
    return layer && ff_client_layer(device->client) == FF_ERR_NOT_FOUND
               ? fail_with(layer, "the ground has no layer of images of this name")
               : 0;
}

static int open_client(handheld *device)
{
    const handheld_options *options = device->options;
    const sim_tape_head *head = options->tape_path ? &device->tape.head : NULL;
    ff_client_desc desc = handheld_client_desc(device);
    device->memory_bytes = options->memory_bytes ? options->memory_bytes
                           : head                ? head->memory_bytes
                                                 : MEMORY_BYTES;
    device->memory_bytes -= device->memory_bytes % BLOCK_ALIGN;
    device->memory = aligned_alloc(BLOCK_ALIGN, device->memory_bytes);
    if (!device->memory) return fail("memory", FF_ERR_MEMORY);
    desc.memory = device->memory;
    desc.memory_bytes = device->memory_bytes;
    desc.pack = options->pack_path ? &device->pack : NULL;
    desc.stream = options->pack_path ? NULL : &device->stream;
    desc.about = options->hud && !options->tape_path ? handheld_hud_about() : 0;
    if (options->at.given) desc.about |= SIM_WHERE_ABOUT;
    int rc = ff_client_create(&desc, &device->client);
    if (rc == FF_OK) return check_layer(device);
    device->client = NULL;
    return fail("client", rc);
}

int handheld_open(handheld *device, const handheld_options *options)
{
    memset(device, 0, sizeof *device);
    device->options = options;
    if (open_source(device)) return -1;
    device->width = options->tape_path ? device->tape.head.width : options->size.width;
    device->height = options->tape_path ? device->tape.head.height : options->size.height;
    return open_surface(device) ? -1 : open_client(device);
}

void handheld_close(handheld *device)
{
    if (device->client) ff_client_destroy(device->client);
    if (device->options->server && device->stream.close) device->stream.close(device->stream.state);
    if (device->surface) device->surface_api->close(device->surface);
    if (device->mapping.bytes) sys_unmap_file(&device->mapping);
    free(device->memory);
}

/* ---- frames ---- */

static int work(handheld *device, int64_t now_us)
{
    handheld_mark_work();
    int moved = ff_client_work(device->client, now_us);
    handheld_mark_outside();
    return moved;
}

/* The hash is over pixels as values, not bytes: so it is the same on every machine. */
static void hash_picture(handheld *device)
{
    enum c3d_texture_format format;
    const void *pixels = c3d_frame_pixels(ff_client_device(device->client), &format);
    uint64_t hash = device->totals.pictures_hash ? device->totals.pictures_hash
                                                 : UINT64_C(14695981039346656037);
    uint32_t count = pixels ? (uint32_t)device->width * device->height : 0;
    if (format == C3D_RGB565)
        for (uint32_t i = 0; i < count; i++)
            hash = (hash ^ ((const uint16_t *)pixels)[i]) * UINT64_C(1099511628211);
    else
        for (uint32_t i = 0; i < 4 * count; i++)
            hash = (hash ^ ((const uint8_t *)pixels)[i]) * UINT64_C(1099511628211);
    device->totals.pictures_hash = hash;
}

static int one_frame(handheld *device, int64_t now_us, const c3d_camera *camera, int flying)
{
    ff_client_stats stats;
    handheld_mark_update();
    int changed = ff_client_update(device->client, now_us, camera);
    if (changed && ff_client_device(device->client)) {
        handheld_mark_draw();
        ff_client_draw(device->client);
        handheld_mark_outside();
        if (device->options->hud) handheld_hud(device, camera);
        if (device->options->hash && flying) hash_picture(device);
        (void)device->surface_api->present(device->surface);
    }
    handheld_mark_outside();
    if (!flying) return changed;
    ff_client_get_stats(device->client, &stats);
    device->totals.frames++;
    if (!changed) return 0;
    device->totals.drawn++;
    device->totals.triangles += stats.tree.triangles;
    device->totals.submitted += stats.c3d.frame_triangles;
    if (stats.tree.triangles > device->totals.triangles_max)
        device->totals.triangles_max = stats.tree.triangles;
    handheld_mark_frame();
    return 1;
}

static int fly_tape(handheld *device)
{
    sim_tape_step step;
    int flying = 0;
    for (;;) {
        int rc = sim_tape_next(&device->tape, &step);
        if (rc != FF_OK)
            return fail(device->tape.differs
                            ? "tape: this client does something else than the one recorded"
                            : "tape",
                        rc);
        if (step.kind == SIM_TAPE_END) break;
        if (step.kind == SIM_TAPE_WORK) {
            (void)work(device, step.now_us);
            continue;
        }
        if (step.kind == SIM_TAPE_LAYER) {
            (void)ff_client_set_layer(device->client, step.shows_none ? NULL : step.layer);
            continue;
        }
        if (step.flying && !flying) handheld_mark_start();
        flying = step.flying;
        (void)one_frame(device, step.now_us, &step.camera, flying);
    }
    device->totals.same_flight = step.geometry_hash == ff_client_geometry_hash(device->client) &&
                                 step.request_hash == ff_client_request_hash(device->client);
    return device->totals.same_flight
               ? 0
               : fail("tape: another flight than the one recorded", FF_ERR_FORMAT);
}

/* Frame `frame` of the flight; time is real with a server, else counted. 1 when something moved, or
 * -1 with one line on stderr. */
static int step_frame(handheld *device, uint32_t frame, int64_t now_us, int flying)
{
    c3d_camera camera;
    int moved = 1, steps = 0, any = 0;
    while (moved && steps++ < WORK_STEPS_MAX) any |= moved = work(device, now_us);
    if (handheld_way(device, frame, &camera)) return -1;
    return any | one_frame(device, now_us, &camera, flying);
}

static int fly_pack(handheld *device)
{
    int64_t now_us = 0;
    for (unsigned still = 0, i = 0; still < 2 && i < SETTLE_FRAMES_MAX;
         i++, now_us += HANDHELD_FRAME_US) {
        int moved = step_frame(device, 0, now_us, 0);
        if (moved < 0) return -1;
        still = moved ? 0 : still + 1;
    }
    handheld_mark_start();
    for (uint32_t frame = 1; frame <= device->options->frames; frame++, now_us += HANDHELD_FRAME_US)
        if (step_frame(device, frame, now_us, 1) < 0) return -1;
    return 0;
}

static int fly_server(handheld *device)
{
    int64_t start_us = sys_time_us();
    handheld_mark_start();
    for (uint32_t frame = 1; frame <= device->options->frames; frame++) {
        int64_t due_us = start_us + (int64_t)frame * HANDHELD_FRAME_US;
        for (int64_t now_us; (now_us = sys_time_us()) < due_us;)
            if (!work(device, now_us)) sys_sleep_us(WAIT_US);
        if (step_frame(device, frame, due_us, 1) < 0) return -1;
    }
    if (ff_client_terrain(device->client)) return check_layer(device);
    ff_client_stats stats;
    ff_client_get_stats(device->client, &stats);
    return fail(device->options->server, stats.refusal ? stats.refusal : FF_ERR_CLOSED);
}

int handheld_fly(handheld *device)
{
    if (device->options->tape_path) return fly_tape(device);
    return device->options->server ? fly_server(device) : fly_pack(device);
}
